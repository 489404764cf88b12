//! Checks proofs about paths without a search, over all vertices.
//!
//! - There is one cover for each pair, from the start of the path.
//! - Planes have their gaps and prove all times between them. A piece that is split has all its parts.
//! - A contact is checked at its place. Containment at the start of the path is decided again.

use glam::DVec3;
use thiserror::Error;

use super::super::proof::TimedPlane;
use super::super::solid::inside;
use super::super::verify::{PlaneListError, check_planes, proves_contact};
use super::link_pair::LinkPair;
use super::mechanism::PathPlace;
use super::proof::{
    CoverStep, PathContactProof, PathCover, PathProof, PathProvenContact, PlaneStretch,
};
use super::shape::Shape;
use super::{PathCast, is_nested_at_start};
use colltrans_convex::answer::CertificateError;

/// The entry of a proof about a path that does not hold.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum PathProofError {
    /// The number of covers differs from that of pairs.
    #[error("the proof has {covers} covers for {pairs} pairs; it needs one for each pair")]
    Pairs {
        /// Number of covers.
        covers: usize,
        /// Number of pairs.
        pairs: usize,
    },
    /// A body that is converted to a solid does not exist.
    #[error("the proof converts a body to a solid that does not exist")]
    Solids,
    /// A cover has invalid steps.
    #[error(
        "the cover of pair {pair} is invalid near row {row}: each step must continue the previous \
         one, normals must have length 1, and a split piece must have all its parts"
    )]
    Order {
        /// Index of the pair.
        pair: usize,
        /// Row near which the cover is invalid.
        row: usize,
    },
    /// A plane has a smaller gap than claimed.
    #[error("a plane of pair {pair} in row {row} proves a gap of {proven}, not {claimed}")]
    Gap {
        /// Index of the pair.
        pair: usize,
        /// Row of the plane.
        row: usize,
        /// Proven gap, in world units.
        proven: f64,
        /// Claimed gap, in world units.
        claimed: f64,
    },
    /// Two planes do not prove the time between them.
    #[error("two planes of pair {pair} do not prove the time between them, from row {row} on")]
    Join {
        /// Index of the pair.
        pair: usize,
        /// Row from which the time is not proven.
        row: usize,
    },
    /// One body contains the other one at the start of the path.
    #[error("one body of pair {pair} is inside the other at the start of the path")]
    Inside {
        /// Index of the pair.
        pair: usize,
    },
    /// A contact is not proven.
    #[error("contact of pair {pair} in row {row} is not proven")]
    Meeting {
        /// Index of the pair.
        pair: usize,
        /// Row of the claimed contact.
        row: usize,
        /// Reason why the proof fails. `None` if its place is invalid, or if the proof holds but does not suffice.
        reason: Option<CertificateError>,
    },
}

/// Checks a proof about a path. Returns the time up to which no two bodies meet, and the time at which two do, or
/// infinity.
pub(super) fn verify(cast: &PathCast, proof: &PathProof) -> Result<[f64; 2], PathProofError> {
    let pairs = cast.pairs.len();
    if proof.covers.len() != pairs {
        return Err(PathProofError::Pairs { covers: proof.covers.len(), pairs });
    }
    let end = PathPlace::at_row(cast.path.last_row());
    let mut reached = end;
    for (pair, cover) in proof.covers.iter().enumerate() {
        let link_pair = cast.link_pair(pair);
        let shapes = cast.shapes_of(pair);
        let check = CoverCheck { link_pair: &link_pair, shapes, pair };
        let up_to = check.check_cover(cover, [0, 0], PathPlace::START, end)?;
        if cover.proves_start() && is_nested_at_start(cast, pair).unwrap_or(true) {
            return Err(PathProofError::Inside { pair });
        }
        reached = reached.earlier_of(up_to);
    }
    let lower = cast.path.time_bounds(reached)[0];
    let Some(meeting) = &proof.meeting else {
        return Ok([lower, f64::INFINITY]);
    };
    let PathProvenContact { pair, place, .. } = *meeting;
    let fails = |reason| PathProofError::Meeting { pair, row: place.row, reason };
    if pair >= pairs || !cast.path.contains(place) || place < reached {
        return Err(fails(None));
    }
    check_contact(cast, meeting)?;
    Ok([lower, cast.path.time_bounds(place)[1]])
}

/// Checks that two bodies meet at the claimed place.
fn check_contact(cast: &PathCast, meeting: &PathProvenContact) -> Result<(), PathProofError> {
    let PathProvenContact { pair, place, how } = meeting;
    let (link_pair, shapes) = (cast.link_pair(*pair), cast.shapes_of(*pair));
    let fails = |reason| PathProofError::Meeting { pair: *pair, row: place.row, reason };
    let are_own = |pieces: &[usize; 2]| {
        (0..2).all(|k| {
            pieces[k] < shapes[k].piece_count() && shapes[k].sub_pieces(pieces[k]).is_empty()
        })
    };
    let holds = match how {
        PathContactProof::Inside => {
            *place == PathPlace::START && is_nested_at_start(cast, *pair).unwrap_or(false)
        }
        PathContactProof::Point { pieces, point } => {
            are_own(pieces) && is_point_inside_both(&link_pair, shapes, *place, *point)
        }
        PathContactProof::Pieces { pieces, met } if are_own(pieces) => {
            let bodies = [shapes[0].piece(pieces[0]), shapes[1].piece(pieces[1])];
            let motion = link_pair.segment_motion(bodies, place.row, [place.share; 2]);
            proves_contact(&motion, place.share, met).map_err(|reason| fails(Some(reason)))?
        }
        PathContactProof::Pieces { .. } => false,
    };
    if holds { Ok(()) } else { Err(fails(None)) }
}

/// Checks whether a point in the frame of the second solid is inside both solids at a place.
fn is_point_inside_both(
    link_pair: &LinkPair,
    shapes: [&Shape; 2],
    place: PathPlace,
    point: [f64; 3],
) -> bool {
    let [Some(p), Some(q)] = shapes.map(Shape::solid) else { return false };
    let (bodies, off) = link_pair.place_solids([p, q], place);
    link_pair.min_gap == 0.0 && inside::is_inside_both(&bodies, off, DVec3::from_array(point))
}

/// A pair whose cover is traversed.
struct CoverCheck<'w> {
    link_pair: &'w LinkPair<'w>,
    shapes: [&'w Shape<'w>; 2],
    pair: usize,
}

impl CoverCheck<'_> {
    /// Checks a cover of two pieces. Returns the place up to which it proves that they do not meet, at most `until`.
    fn check_cover(
        &self,
        cover: &PathCover,
        pieces: [usize; 2],
        from: PathPlace,
        until: PathPlace,
    ) -> Result<PathPlace, PathProofError> {
        let mut reached_place = from;
        for step in &cover.steps {
            match step {
                CoverStep::Planes(stretches) => {
                    if let Some(place) = self.check_stretches(stretches, pieces, reached_place)? {
                        reached_place = place;
                    }
                }
                CoverStep::Parts { which, until, covers } => {
                    let is_pair = *which < 2
                        && self.link_pair.path.contains(*until)
                        && *until >= reached_place;
                    let parts = if is_pair {
                        self.shapes[*which].sub_pieces(pieces[*which])
                    } else {
                        Vec::new()
                    };
                    if parts.is_empty() || parts.len() != covers.len() {
                        return Err(self.order_error(reached_place.row));
                    }
                    let mut reached = until.normalised();
                    for (part, cover) in parts.into_iter().zip(covers) {
                        let mut below = pieces;
                        below[*which] = part;
                        reached = reached.earlier_of(self.check_cover(
                            cover,
                            below,
                            reached_place,
                            *until,
                        )?);
                    }
                    if reached < until.normalised() {
                        return Ok(reached);
                    }
                    reached_place = reached;
                }
            }
        }
        Ok(reached_place.earlier_of(until.normalised()))
    }

    /// Checks planes of two pieces. Returns the place up to which they prove separation, or `None` if there are none.
    fn check_stretches(
        &self,
        stretches: &[PlaneStretch],
        pieces: [usize; 2],
        from: PathPlace,
    ) -> Result<Option<PathPlace>, PathProofError> {
        let bodies = [self.shapes[0].piece(pieces[0]), self.shapes[1].piece(pieces[1])];
        let mut before: Option<(PathPlace, f64)> = None;
        for PlaneStretch { row, planes } in stretches {
            let row = *row;
            let (Some(first), Some(last)) = (planes.first(), planes.last()) else {
                return Err(self.order_error(row));
            };
            let place = |plane: &TimedPlane| PathPlace { row, share: plane.time };
            let is_row = row <= self.link_pair.path.last_row() && first.time >= 0.0;
            if !is_row || planes.iter().any(|plane| plane.alone) {
                return Err(self.order_error(row));
            }
            if place(last).normalised() > PathPlace::at_row(self.link_pair.path.last_row()) {
                return Err(self.order_error(row));
            }
            let follows = match before {
                None => place(first).normalised() == from.normalised(),
                Some((last, gap)) => {
                    place(first) >= last
                        && self.link_pair.gaps_prove_between([last, place(first)], [gap, first.gap])
                }
            };
            if !follows {
                let pair = self.pair;
                return Err(if before.is_none() {
                    self.order_error(row)
                } else {
                    PathProofError::Join { pair, row }
                });
            }
            let motion = self.link_pair.segment_motion(bodies, row, [0.0, 1.0]);
            check_planes(&motion, planes).map_err(|broken| self.plane_list_error(broken, row))?;
            before = Some((place(last), last.gap));
        }
        Ok(before.map(|(place, _)| place.normalised()))
    }

    /// Returns the error for an invalid step in a row.
    fn order_error(&self, row: usize) -> PathProofError {
        PathProofError::Order { pair: self.pair, row }
    }

    /// Converts an error about a list of planes.
    fn plane_list_error(&self, broken: PlaneListError, row: usize) -> PathProofError {
        let pair = self.pair;
        match broken {
            PlaneListError::Plane { .. } => PathProofError::Order { pair, row },
            PlaneListError::Gap { proven, claimed, .. } => {
                PathProofError::Gap { pair, row, proven, claimed }
            }
            PlaneListError::Join { .. } => PathProofError::Join { pair, row },
        }
    }
}
