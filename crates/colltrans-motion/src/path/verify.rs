//! Checks of proofs about paths: nothing of the search is used, all vertices are looked at.
//!
//! What is checked: covers are those of all pairs, each from where the path begins; planes have their gaps, and prove
//! what is between them; what is taken apart is so by all of its parts. That bodies meet is checked where they are
//! then, and that none is inside another one where the path begins, anew.

use glam::DVec3;
use thiserror::Error;

use super::super::proof::PlaneAt;
use super::super::solid::inside;
use super::super::verify::{Broken, chain, is_met};
use super::couple::Couple;
use super::mechanism::Place;
use super::proof::{Cover, How, PathMeeting, PathProof, Step, Stretch};
use super::shape::Shape;
use super::{PathCast, nested};
use colltrans_convex::answer::CertificateError;

/// What of a proof about a path is not proven.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum PathProofError {
    /// There is not a cover for each pair.
    #[error("there are {covers} covers for {pairs} pairs")]
    Pairs {
        /// How many there are.
        covers: usize,
        /// How many there have to be.
        pairs: usize,
    },
    /// A body that is taken as a solid does not exist.
    #[error("the proof takes a body as a solid that does not exist")]
    Solids,
    /// A cover is not in order.
    #[error(
        "the cover of pair {pair} is not in order near row {row}: steps follow each other, planes \
         have normals of length 1, and what is taken apart has all its parts"
    )]
    Order {
        /// Of which pair.
        pair: usize,
        /// Where.
        row: usize,
    },
    /// A plane has not the gap that is claimed.
    #[error("a plane of pair {pair} in row {row} proves a gap of {proven}, not {claimed}")]
    Gap {
        /// Of which pair.
        pair: usize,
        /// Where.
        row: usize,
        /// What is proven.
        proven: f64,
        /// What is claimed.
        claimed: f64,
    },
    /// Two planes do not prove what is between them.
    #[error("two planes of pair {pair} do not prove what is between them, from row {row} on")]
    Join {
        /// Of which pair.
        pair: usize,
        /// Where.
        row: usize,
    },
    /// One body is inside another one where the path begins.
    #[error("the bodies of pair {pair} are one inside the other where the path begins")]
    Inside {
        /// Of which pair.
        pair: usize,
    },
    /// That two bodies meet is not proven.
    #[error("that the bodies of pair {pair} meet in row {row} is not proven")]
    Meeting {
        /// Of which pair.
        pair: usize,
        /// Where.
        row: usize,
        /// Why not; nothing if they do too little, or there.
        reason: Option<CertificateError>,
    },
}

pub(super) fn verify(cast: &PathCast, proof: &PathProof) -> Result<[f64; 2], PathProofError> {
    let pairs = cast.pairs.len();
    if proof.covers.len() != pairs {
        return Err(PathProofError::Pairs { covers: proof.covers.len(), pairs });
    }
    let end = Place::at_row(cast.path.last());
    let mut reached = end;
    for (pair, cover) in proof.covers.iter().enumerate() {
        let couple = cast.couple(pair);
        let shapes = cast.shapes_of(pair);
        let walk = Walk { couple: &couple, shapes, pair };
        let up_to = walk.cover(cover, [0, 0], Place::START, end)?;
        if cover.is_of_the_beginning() && nested(cast, pair).unwrap_or(true) {
            return Err(PathProofError::Inside { pair });
        }
        reached = reached.min_of(up_to);
    }
    let lower = cast.path.time(reached)[0];
    let Some(meeting) = &proof.meeting else {
        return Ok([lower, f64::INFINITY]);
    };
    let PathMeeting { pair, place, .. } = *meeting;
    let fails = |reason| PathProofError::Meeting { pair, row: place.row, reason };
    if pair >= pairs || !cast.path.has(place) || place < reached {
        return Err(fails(None));
    }
    meets(cast, meeting)?;
    Ok([lower, cast.path.time(place)[1]])
}

fn meets(cast: &PathCast, meeting: &PathMeeting) -> Result<(), PathProofError> {
    let PathMeeting { pair, place, how } = meeting;
    let (couple, shapes) = (cast.couple(*pair), cast.shapes_of(*pair));
    let fails = |reason| PathProofError::Meeting { pair: *pair, row: place.row, reason };
    let are_own = |pieces: &[usize; 2]| {
        (0..2).all(|k| pieces[k] < shapes[k].count() && shapes[k].parts(pieces[k]).is_empty())
    };
    let holds = match how {
        How::Inside => *place == Place::START && nested(cast, *pair).unwrap_or(false),
        How::Point { pieces, point } => {
            are_own(pieces) && is_inside(&couple, shapes, *place, *point)
        }
        How::Pieces { pieces, met } if are_own(pieces) => {
            let bodies = [shapes[0].piece(pieces[0]), shapes[1].piece(pieces[1])];
            let course = couple.course(bodies, place.row, [place.share; 2]);
            is_met(&course, place.share, met).map_err(|reason| fails(Some(reason)))?
        }
        How::Pieces { .. } => false,
    };
    if holds { Ok(()) } else { Err(fails(None)) }
}

/// Whether a point in the second one's frame is inside both solids at a place.
fn is_inside(couple: &Couple, shapes: [&Shape; 2], place: Place, point: [f64; 3]) -> bool {
    let [Some(p), Some(q)] = shapes.map(Shape::solid) else { return false };
    let (bodies, off) = couple.solids([p, q], place);
    couple.keep == 0.0 && inside::holds(&bodies, off, DVec3::from_array(point))
}

/// A pair whose cover is walked through.
struct Walk<'w> {
    couple: &'w Couple<'w>,
    shapes: [&'w Shape<'w>; 2],
    pair: usize,
}

impl Walk<'_> {
    /// Up to where a cover of two pieces proves that they do not meet, from some place on; at most so far.
    fn cover(
        &self,
        cover: &Cover,
        pieces: [usize; 2],
        from: Place,
        until: Place,
    ) -> Result<Place, PathProofError> {
        let mut here = from;
        for step in &cover.steps {
            match step {
                Step::Planes(stretches) => {
                    if let Some(place) = self.planes(stretches, pieces, here)? {
                        here = place;
                    }
                }
                Step::Parts { which, until, covers } => {
                    let is_pair = *which < 2 && self.couple.path.has(*until) && *until >= here;
                    let parts = if is_pair {
                        self.shapes[*which].parts(pieces[*which])
                    } else {
                        Vec::new()
                    };
                    if parts.is_empty() || parts.len() != covers.len() {
                        return Err(self.order(here.row));
                    }
                    let mut reached = until.settled();
                    for (part, cover) in parts.into_iter().zip(covers) {
                        let mut below = pieces;
                        below[*which] = part;
                        reached = reached.min_of(self.cover(cover, below, here, *until)?);
                    }
                    if reached < until.settled() {
                        return Ok(reached);
                    }
                    here = reached;
                }
            }
        }
        Ok(here.min_of(until.settled()))
    }

    /// Up to where planes prove; nothing, if there are none.
    fn planes(
        &self,
        stretches: &[Stretch],
        pieces: [usize; 2],
        from: Place,
    ) -> Result<Option<Place>, PathProofError> {
        let bodies = [self.shapes[0].piece(pieces[0]), self.shapes[1].piece(pieces[1])];
        let mut before: Option<(Place, f64)> = None;
        for Stretch { row, planes } in stretches {
            let row = *row;
            let (Some(first), Some(last)) = (planes.first(), planes.last()) else {
                return Err(self.order(row));
            };
            let place = |plane: &PlaneAt| Place { row, share: plane.time };
            let is_row = row <= self.couple.path.last() && first.time >= 0.0;
            if !is_row || planes.iter().any(|plane| plane.alone) {
                return Err(self.order(row));
            }
            if place(last).settled() > Place::at_row(self.couple.path.last()) {
                return Err(self.order(row));
            }
            let follows = match before {
                None => place(first).settled() == from.settled(),
                Some((last, gap)) => {
                    place(first) >= last
                        && self.couple.is_near([last, place(first)], [gap, first.gap])
                }
            };
            if !follows {
                let pair = self.pair;
                return Err(if before.is_none() {
                    self.order(row)
                } else {
                    PathProofError::Join { pair, row }
                });
            }
            let course = self.couple.course(bodies, row, [0.0, 1.0]);
            chain(&course, planes).map_err(|broken| self.broken(broken, row))?;
            before = Some((place(last), last.gap));
        }
        Ok(before.map(|(place, _)| place.settled()))
    }

    fn order(&self, row: usize) -> PathProofError {
        PathProofError::Order { pair: self.pair, row }
    }

    fn broken(&self, broken: Broken, row: usize) -> PathProofError {
        let pair = self.pair;
        match broken {
            Broken::Plane { .. } => PathProofError::Order { pair, row },
            Broken::Gap { proven, claimed, .. } => {
                PathProofError::Gap { pair, row, proven, claimed }
            }
            Broken::Join { .. } => PathProofError::Join { pair, row },
        }
    }
}
