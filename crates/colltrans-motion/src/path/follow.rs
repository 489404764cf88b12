//! Follows two convex pieces along a path: planes between them, up to a place or to a contact.
//!
//! Pieces far from each other are sampled at places that may be many rows apart: the gaps of two planes prove the time
//! between them. Near each other, the search for two moving bodies runs from row to row.

use super::super::proof::{ContactProof, TimedPlane};
use super::super::sample::{ConvexSampler, Sampler};
use super::super::search::{SpanEnd, SpanResult, prove_span};
use super::link_pair::LinkPair;
use super::mechanism::PathPlace;
use super::proof::PlaneStretch;
use colltrans_convex::body::ConvexPolyhedron;

/// Shares of the gap by which both pieces together may move up to the next sample: first and second attempt.
const LEAP_SHARES: [f64; 2] = [1.5, 0.9];

/// Result of following two pieces.
#[derive(Debug)]
pub(super) enum FollowEnd {
    /// They are separated up to the end.
    Apart,
    /// They meet at this place.
    Met(PathPlace, ContactProof),
    /// They are so near that rounding errors hide whether they meet.
    Indeterminate,
    /// The search took its maximum number of steps.
    Stalled,
}

/// The planes up to a place.
#[derive(Debug, Default)]
pub(super) struct PlanePath {
    pub(super) stretches: Vec<PlaneStretch>,
}

impl PlanePath {
    /// Appends a plane to the planes of its row.
    pub(super) fn append_plane(&mut self, row: usize, plane: TimedPlane) {
        match self.stretches.last_mut() {
            Some(last) if last.row == row => {
                if last.planes.last() != Some(&plane) {
                    last.planes.push(plane);
                }
            }
            _ => self.stretches.push(PlaneStretch { row, planes: vec![plane] }),
        }
    }

    /// Appends a plane that only the gaps connect to the previous one.
    pub(super) fn append_stretch(&mut self, row: usize, plane: TimedPlane) {
        self.stretches.push(PlaneStretch { row, planes: vec![plane] });
    }

    /// Returns the place and the gap of the last plane. Returns `None` if there is no plane.
    pub(super) fn last_plane(&self) -> Option<(PathPlace, f64)> {
        let last = self.stretches.last()?;
        let plane = last.planes.last()?;
        Some((PathPlace { row: last.row, share: plane.time }, plane.gap))
    }
}

/// Two pieces of two bodies.
#[derive(Debug, Clone, Copy)]
pub(super) struct PiecePair<'p> {
    pub(super) link_pair: &'p LinkPair<'p>,
    pub(super) pieces: [&'p ConvexPolyhedron; 2],
}

impl PiecePair<'_> {
    /// Returns the plane between the pieces at a place. Returns `None` if separation is not proven.
    pub(super) fn plane_at(
        &self,
        sampler: &mut ConvexSampler,
        place: PathPlace,
    ) -> Option<TimedPlane> {
        let motion = self.link_pair.segment_motion(self.pieces, place.row, [place.share; 2]);
        let sample = sampler.sample(&motion, place.share);
        let (time, normal, gap) = (place.share, sample.normal, sample.gap);
        sample.is_apart().then_some(TimedPlane { time, normal, gap, alone: false })
    }

    /// Returns the proof that the pieces meet at a place, or `None`.
    pub(super) fn prove_contact(
        &self,
        sampler: &mut ConvexSampler,
        place: PathPlace,
    ) -> Option<ContactProof> {
        let motion = self.link_pair.segment_motion(self.pieces, place.row, [place.share; 2]);
        sampler.prove_contact(&motion, place.share)
    }

    /// Finds a later place with a plane, such that the gaps at both places prove the time between them. Returns the new
    /// place and its plane. Returns `None` if the place would be before `least`, or if no attempt succeeds.
    pub(super) fn leap_by_gaps(
        &self,
        sampler: &mut ConvexSampler,
        (from, gap): (PathPlace, f64),
        least: PathPlace,
        until: PathPlace,
    ) -> Option<(PathPlace, TimedPlane)> {
        let mut tried = None;
        for share in LEAP_SHARES {
            let place = self.link_pair.place_within(from, until, share * gap);
            if place < least || place <= from || tried == Some(place) {
                break;
            }
            tried = Some(place);
            if let Some(plane) = self.plane_at(sampler, place)
                && self.link_pair.gaps_prove_between([from, place], [gap, plane.gap])
            {
                return Some((place, plane));
            }
        }
        None
    }

    /// Follows the pieces from a place to another one, or to a contact.
    pub(super) fn follow_pieces(
        &self,
        sampler: &mut ConvexSampler,
        from: PathPlace,
        until: PathPlace,
    ) -> (PlanePath, FollowEnd) {
        let mut plane_path = PlanePath::default();
        if let Some(plane) = self.plane_at(sampler, from) {
            plane_path.append_plane(from.row, plane);
        }
        loop {
            let (place, gap) = match plane_path.last_plane() {
                Some((place, _)) if place.normalised() >= until.normalised() => {
                    return (plane_path, FollowEnd::Apart);
                }
                Some((place, gap)) => (place.normalised(), gap),
                None => (from, 0.0),
            };
            // Near each other, the search within a row proves more.
            let next = PathPlace::at_row(place.row + 1).earlier_of(until);
            if gap > 0.0
                && let Some((place, plane)) = self.leap_by_gaps(sampler, (place, gap), next, until)
            {
                plane_path.append_stretch(place.row, plane);
                continue;
            }
            match self.follow_row(sampler, place, until, &mut plane_path) {
                FollowEnd::Apart => {}
                other => return (plane_path, other),
            }
        }
    }

    /// Follows the pieces to the end of a row, or to a contact.
    fn follow_row(
        &self,
        sampler: &mut ConvexSampler,
        from: PathPlace,
        until: PathPlace,
        plane_path: &mut PlanePath,
    ) -> FollowEnd {
        let row = from.row;
        let to = if until.row == row { until.share } else { 1.0 };
        let motion = self.link_pair.segment_motion(self.pieces, row, [from.share, to]);
        let SpanResult { planes, end } = prove_span(&motion, sampler);
        for plane in &planes {
            plane_path.append_plane(row, *plane);
        }
        match end {
            SpanEnd::Free => FollowEnd::Apart,
            SpanEnd::Met(share, met) => FollowEnd::Met(PathPlace { row, share }, met),
            SpanEnd::Stalled => FollowEnd::Stalled,
            // Pieces that cannot be separated at the end of a row may meet at the start of the next one.
            SpanEnd::Indeterminate
                if to == 1.0 && row + 1 < self.link_pair.path.last_row() && until.row > row =>
            {
                let next = self.link_pair.segment_motion(self.pieces, row + 1, [0.0, 1.0]);
                match prove_span(&next, sampler) {
                    SpanResult { planes, end: SpanEnd::Met(share, met) } if planes.is_empty() => {
                        FollowEnd::Met(PathPlace { row: row + 1, share }, met)
                    }
                    _ => FollowEnd::Indeterminate,
                }
            }
            SpanEnd::Indeterminate => FollowEnd::Indeterminate,
        }
    }
}
