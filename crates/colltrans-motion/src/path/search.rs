//! Searches two bodies along a path, by their pieces.
//!
//! Boxes, which contain other pieces, are separated only where that is cheap: in steps that are not short compared with
//! their size. Where they are not separated, the larger one is split. Its parts are covered up to the next sampled
//! place at which both boxes are separated again, down to the pieces of the bodies themselves.
//!
//! Invariant: no two points of the pieces meet up to the end of a cover. A cover ends at its requested end, or where
//! two of the bodies' own pieces meet or may meet.

use super::super::crossing_time::{ContactState, find_crossing_time};
use super::super::curvature::HillClimbing;
use super::super::proof::TimedPlane;
use super::super::relative_motion::RelativeMotion;
use super::super::sample::ConvexSampler;
use super::super::solid::inside::Guesses;
use super::follow::{FollowEnd, PiecePair, PlanePath};
use super::link_pair::LinkPair;
use super::mechanism::PathPlace;
use super::proof::{CoverStep, PathContactProof, PathCover};
use super::shape::Shape;
use colltrans_convex::body::ConvexPolyhedron;
use colltrans_convex::setting::TwoBodies;
use colltrans_kernel::descent::{node_to_split, pair_with_node};
use colltrans_solid::body::Solid;

/// Minimum step of boxes, as a share of their size.
const MIN_STEP_SHARE: f64 = 0.25;

/// Maximum number of pairs of pieces that are tested at one place.
const MAX_PAIRS_AT_PLACE: usize = 1 << 14;

/// The event that ends a search.
#[derive(Debug)]
pub(super) enum Stop {
    /// The bodies are proven to meet at a place.
    Met(PathPlace, PathContactProof),
    /// The bodies are so near that rounding errors hide whether they meet.
    Indeterminate,
    /// The search took its maximum number of steps.
    Stalled,
}

impl Stop {
    /// Checks whether this stop replaces another one that was found at a later place. A possible contact does not
    /// replace a proven one, because the bodies meet no later than the proven contact.
    pub(super) fn replaces(&self, before: &Self) -> bool {
        !matches!((self, before), (Self::Indeterminate, Self::Met(..)))
    }
}

/// A search between two bodies.
pub(super) struct PathSearch<'p> {
    pub(super) link_pair: &'p LinkPair<'p>,
    pub(super) shapes: [&'p Shape<'p>; 2],
    pub(super) sampler: ConvexSampler,
    /// The earliest stop found, with its place. Later places are not searched.
    pub(super) stop: Option<(PathPlace, Stop)>,
    /// Place up to which the pieces of all stops are separated.
    pub(super) reached: PathPlace,
}

impl<'p> PathSearch<'p> {
    pub(super) fn new(
        link_pair: &'p LinkPair<'p>,
        shapes: [&'p Shape<'p>; 2],
        until: PathPlace,
    ) -> Self {
        Self { link_pair, shapes, sampler: ConvexSampler::default(), stop: None, reached: until }
    }

    /// Returns the first stop, replaced by a proven contact soon after it if there is one. Returns `None` if the search
    /// did not stop.
    pub(super) fn with_proven_contact(&mut self) -> Option<(PathPlace, Stop)> {
        let (until, stop) = self.stop.take()?;
        let PathPlace { row, share } = self.reached.normalised();
        let known_contact = match &stop {
            Stop::Stalled => return Some((until, stop)),
            Stop::Met(place, ..) if place.row == row => Some(place.share),
            _ => None,
        };
        if row >= self.link_pair.path.last_row() {
            return Some((until, stop));
        }
        let found = find_crossing_time(share, known_contact, 1.0, |share| {
            self.contact_state(PathPlace { row, share })
        });
        Some(found.map_or((until, stop), |(share, how)| {
            let place = PathPlace { row, share };
            (place, Stop::Met(place, how))
        }))
    }

    /// Returns the state of the bodies at one place.
    fn contact_state(&mut self, place: PathPlace) -> ContactState<PathContactProof> {
        let (mut stack, mut count, mut state) = (vec![[0, 0]], 0, ContactState::Apart);
        let mut interior = InteriorGuesses::new(self, place);
        while let Some(numbers) = stack.pop() {
            count += 1;
            if count > MAX_PAIRS_AT_PLACE {
                return ContactState::Undecided;
            }
            self.sampler.discard_pairs();
            let pieces = self.piece_pair(numbers);
            if let Some(interior) = &mut interior {
                interior.add_pieces(numbers);
            }
            if pieces.plane_at(&mut self.sampler, place).is_some() {
                continue;
            }
            let Some(which) = piece_to_split(self.shapes, numbers) else {
                if let Some(met) = pieces.prove_contact(&mut self.sampler, place) {
                    return ContactState::Met(PathContactProof::Pieces { pieces: numbers, met });
                }
                state = ContactState::Undecided;
                continue;
            };
            stack.extend(
                self.shapes[which]
                    .sub_pieces(numbers[which])
                    .into_iter()
                    .map(|part| pair_with_node(numbers, which, part)),
            );
        }
        match interior.and_then(|interior| interior.interior_point()) {
            Some(how) if matches!(state, ContactState::Undecided) => ContactState::Met(how),
            _ => state,
        }
    }

    /// Covers two pieces from a place to another one, or to the first stop.
    pub(super) fn cover_pieces(
        &mut self,
        pieces: [usize; 2],
        from: PathPlace,
        until: PathPlace,
    ) -> PathCover {
        match piece_to_split(self.shapes, pieces) {
            Some(which) => self.cover_by_parts(pieces, which, from, until),
            None => self.cover_by_planes(pieces, from, until),
        }
    }

    /// Returns two pieces by their numbers.
    fn piece_pair(&self, pieces: [usize; 2]) -> PiecePair<'p> {
        let [p, q] = self.shapes;
        PiecePair { link_pair: self.link_pair, pieces: [p.piece(pieces[0]), q.piece(pieces[1])] }
    }

    /// Returns the earlier of a place and the first stop.
    fn limited_to_stop(&self, until: PathPlace) -> PathPlace {
        self.stop.as_ref().map_or(until, |stop| until.earlier_of(stop.0))
    }

    /// Covers two of the bodies' own pieces by planes.
    fn cover_by_planes(
        &mut self,
        numbers: [usize; 2],
        from: PathPlace,
        until: PathPlace,
    ) -> PathCover {
        // The nearest pairs of other pieces are not valid for these.
        self.sampler.discard_pairs();
        let (plane_path, follow_end) =
            self.piece_pair(numbers).follow_pieces(&mut self.sampler, from, until);
        let reached = plane_path.last_plane().map_or(from, |(place, _)| place);
        let stop = match follow_end {
            FollowEnd::Apart => None,
            FollowEnd::Met(place, met) => {
                Some((place, Stop::Met(place, PathContactProof::Pieces { pieces: numbers, met })))
            }
            FollowEnd::Indeterminate => Some((reached, Stop::Indeterminate)),
            FollowEnd::Stalled => Some((reached, Stop::Stalled)),
        };
        if let Some((place, stop)) = stop {
            let before = self.stop.take().map(|(_, before)| before);
            let stop = before.filter(|before| !stop.replaces(before)).unwrap_or(stop);
            self.stop = Some((place, stop));
            self.reached = self.reached.earlier_of(reached);
        }
        PathCover { steps: vec![CoverStep::Planes(plane_path.stretches)] }
    }

    /// Covers two pieces by planes where possible, and otherwise by the parts of one of them.
    fn cover_by_parts(
        &mut self,
        numbers: [usize; 2],
        which: usize,
        from: PathPlace,
        until: PathPlace,
    ) -> PathCover {
        let pieces = self.piece_pair(numbers);
        let size = pieces.pieces.iter().map(|piece| piece_extent(piece)).fold(0.0, f64::max);
        let (mut steps, mut reached_place) = (Vec::new(), from);
        loop {
            self.sampler.discard_pairs();
            let until = self.limited_to_stop(until);
            let plane_path = self.follow_coarsely(&pieces, size, reached_place, until);
            if let Some((place, _)) = plane_path.last_plane() {
                reached_place = place.normalised();
                steps.push(CoverStep::Planes(plane_path.stretches));
            }
            if reached_place >= until.normalised() && !steps.is_empty() {
                break;
            }
            let next = self.next_separation(&pieces, size, reached_place, until);
            let parts = self.shapes[which].sub_pieces(numbers[which]);
            let covers = parts.into_iter().map(|part| {
                let next = self.limited_to_stop(next);
                self.cover_pieces(pair_with_node(numbers, which, part), reached_place, next)
            });
            let covers = covers.collect();
            steps.push(CoverStep::Parts { which, until: next, covers });
            reached_place = next.normalised();
            if reached_place >= self.limited_to_stop(until).normalised() {
                break;
            }
        }
        PathCover { steps }
    }

    /// Follows two pieces by gaps, in steps that are not short compared with them, or by two planes for such a step.
    fn follow_coarsely(
        &mut self,
        pieces: &PiecePair,
        size: f64,
        from: PathPlace,
        until: PathPlace,
    ) -> PlanePath {
        let mut plane_path = PlanePath::default();
        let Some(plane) = pieces.plane_at(&mut self.sampler, from) else { return plane_path };
        plane_path.append_plane(from.row, plane);
        while let Some((place, gap)) = plane_path.last_plane() {
            let reached_place = place.normalised();
            if reached_place >= until.normalised() {
                break;
            }
            let least = self.link_pair.place_within(reached_place, until, MIN_STEP_SHARE * size);
            if let Some((place, plane)) =
                pieces.leap_by_gaps(&mut self.sampler, (reached_place, gap), least, until)
            {
                plane_path.append_stretch(place.row, plane);
                continue;
            }
            let next = self.link_pair.place_within(reached_place, until, size);
            let next = if next.row == reached_place.row { next.share } else { 1.0 };
            let Some([first, last]) = self.two_planes(pieces, reached_place, next) else { break };
            plane_path.append_plane(reached_place.row, first);
            plane_path.append_plane(reached_place.row, last);
        }
        plane_path
    }

    /// Returns planes at a place and at a later one in the same row that prove the time between them. Returns `None` if
    /// they do not.
    fn two_planes(
        &mut self,
        pieces: &PiecePair,
        from: PathPlace,
        to: f64,
    ) -> Option<[TimedPlane; 2]> {
        if to <= from.share {
            return None;
        }
        let end = PathPlace { row: from.row, share: to };
        let first = pieces.plane_at(&mut self.sampler, from)?;
        let last = pieces.plane_at(&mut self.sampler, end)?;
        let motion = pieces.link_pair.segment_motion(pieces.pieces, from.row, [from.share, to]);
        let ends = [from.share, to].map(|share| motion.instant_at(share));
        motion
            .proves_between([&first, &last], [&ends[0], &ends[1]], &HillClimbing)
            .then_some([first, last])
    }

    /// Returns a later place at which pieces are separated again, found in growing steps, or the end.
    fn next_separation(
        &mut self,
        pieces: &PiecePair,
        size: f64,
        from: PathPlace,
        until: PathPlace,
    ) -> PathPlace {
        let mut step = size;
        loop {
            let place = self.link_pair.place_within(from, until, step);
            let later = place > from;
            if place >= until || later && pieces.plane_at(&mut self.sampler, place).is_some() {
                return place;
            }
            step *= 2.0;
        }
    }
}

/// Guesses of a point inside two solids at a place, from facets that lie above each other.
struct InteriorGuesses<'p> {
    shapes: [&'p Shape<'p>; 2],
    bodies: TwoBodies<'p, Solid>,
    off: f64,
    guesses: Guesses,
}

impl<'p> InteriorGuesses<'p> {
    /// Prepares the guesses of a place. Returns `None` unless both bodies are solids and there is no minimum gap.
    fn new(search: &PathSearch<'p>, place: PathPlace) -> Option<Self> {
        let (link_pair, shapes) = (search.link_pair, search.shapes);
        let solids = [shapes[0].solid()?, shapes[1].solid()?];
        let (bodies, off) = link_pair.place_solids(solids, place);
        let guesses = Guesses::default();
        (link_pair.min_gap == 0.0).then_some(Self { shapes, bodies, off, guesses })
    }

    /// Considers two pieces, if both are facets.
    fn add_pieces(&mut self, pieces: [usize; 2]) {
        let [p, q] = [0, 1].map(|k| self.shapes[k].facet(pieces[k]));
        if let (Some((own, f)), Some((other, g))) = (p, q) {
            let TwoBodies { moving_matrix, fixed_matrix, offset, .. } = self.bodies;
            let [f, g] = [f.map(|v| moving_matrix * v), g.map(|v| fixed_matrix * v + offset)];
            self.guesses.add_facets([own, other], [&f, &g], self.off);
        }
    }

    /// Returns the proof of a point inside both solids, or `None`.
    fn interior_point(&self) -> Option<PathContactProof> {
        let (facets, point) = self.guesses.interior_point(&self.bodies, self.off)?;
        let pieces = [0, 1].map(|k| self.shapes[k].facet_piece(facets[k]));
        Some(PathContactProof::Point { pieces, point: point.to_array() })
    }
}

/// Returns the larger of two pieces, among those that have parts. Returns `None` if none has.
fn piece_to_split(shapes: [&Shape; 2], pieces: [usize; 2]) -> Option<usize> {
    let are_own = [0, 1].map(|k| shapes[k].sub_pieces(pieces[k]).is_empty());
    node_to_split(are_own, |k| piece_extent(shapes[k].piece(pieces[k])))
}

/// Returns the maximum distance of a vertex from the first one.
fn piece_extent(piece: &ConvexPolyhedron) -> f64 {
    let corners = piece.vertices();
    corners.iter().map(|v| v.distance(corners[0])).fold(0.0, f64::max)
}
