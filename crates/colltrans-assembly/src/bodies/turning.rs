//! Queries about two parts of which one moves along a screw, by [`MotionCast`].

use colltrans::motion::{Motion, MotionCast, MotionOutcome};
use colltrans::solid::{SolidCast, SolidOptions, StartOverlap};
use colltrans::{Aabb, Cast, Clearance, Pose, QueryError, Solid};
use glam::DVec3;

use super::Bodies;
use crate::roles::PairTolerance;
use crate::threads::Thread;

/// Shares of a motion at which overlap is tested again, independently of the motion cast.
const RECHECKED_SHARES: [f64; 6] = [0.01, 0.1, 0.3, 0.55, 0.8, 1.0];

/// Outcome of the motion of a part along a screw, and then along a direction, against a fixed part.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum ScrewOutcome {
    /// The parts never meet, neither on the motion nor along the direction from its end. Holds the number of
    /// node pairs that the search visited.
    Free(u64),
    /// The parts meet, or the search is undecided. Holds the fraction of the motion up to which they are proven not
    /// to meet. If only a later test found an overlap, holds the fraction at which they overlap, and no earlier
    /// fraction is claimed to be free. It is 1 if the whole motion is free and the parts meet along the direction
    /// from its end.
    Blocked(f64),
    /// The parts overlap at the start of the motion. Holds the least tolerance that removes the overlap, if
    /// any.
    Overlapping(Option<f64>),
}

impl Bodies<'_> {
    /// Returns the thread of two parts whose screw is tested as its core.
    pub(crate) fn pair_thread(&self, pair: [usize; 2]) -> Option<Thread> {
        self.own_fit(pair).and_then(|own| own.thread)
    }

    /// Returns the best position of the screw in its hole; `None` if the thread has no helix or no profile.
    pub(crate) fn screw_seat(
        &self,
        pair: [usize; 2],
        thread: &Thread,
    ) -> Option<crate::threads::Seat> {
        let [a, b] = [pair[0].min(pair[1]), pair[0].max(pair[1])];
        thread.seat([a, b].map(|part| self.assembly().parts()[part].solid()))
    }

    /// Moves the first part along a motion, and then along `d`, by `end` or forever, against the second one. With a
    /// tolerance, uses the solids of the files, each shrunk by half of the tolerance. Without one, uses the bodies of
    /// this pair.
    ///
    /// # Errors
    /// The motion, the direction or the tolerance is out of range.
    pub(crate) fn screw_outcome(
        &self,
        pair: [usize; 2],
        (motion, d, end): (&Motion, DVec3, Option<f64>),
        tolerance: Option<f64>,
    ) -> Result<ScrewOutcome, QueryError> {
        let [moving, fixed] = self.queried_solids(pair, tolerance);
        let cast = MotionCast::new(moving.with_motion(motion), fixed.at(Pose::IDENTITY))?;
        let cast = match tolerance {
            Some(tolerance) => cast.with_tolerance(tolerance)?,
            None => cast.with_min_gap(self.pair_fit(pair).min_gap())?,
        };
        let pairs = match cast.first_contact()? {
            MotionOutcome::Overlapping(_) => {
                let found = cast.start_overlap()?;
                return Ok(ScrewOutcome::Overlapping(
                    found.and_then(|found| found.least_tolerance),
                ));
            }
            MotionOutcome::Contact(met)
            | MotionOutcome::Grazing(met)
            | MotionOutcome::Undecided(met) => {
                return Ok(ScrewOutcome::Blocked(met.lower));
            }
            MotionOutcome::Free(free) => free.steps.nodes,
            _ => return Ok(ScrewOutcome::Blocked(0.0)),
        };
        // Overlap is tested again at a few places. Callers only report the fraction of a blocked motion.
        for share in RECHECKED_SHARES {
            if self.cast_after_turning(pair, (motion, d), tolerance, share)?.overlaps() {
                return Ok(ScrewOutcome::Blocked(share));
            }
        }
        let mut beyond = self.cast_after_turning(pair, (motion, d), tolerance, 1.0)?;
        if end.is_some() {
            let options = beyond.options().with_before(end);
            beyond = beyond.with_options(options)?;
        }
        let goes_on = matches!(beyond.clearance()?, Clearance::Free(_));
        Ok(if goes_on { ScrewOutcome::Free(pairs) } else { ScrewOutcome::Blocked(1.0) })
    }

    /// Returns the share of a motion up to which the first part does not meet the second one, and the number
    /// of node pairs that the search visited. Returns `None` if the parts overlap at the start or the motion
    /// cannot be evaluated.
    pub(crate) fn contact_share(&self, pair: [usize; 2], motion: &Motion) -> Option<(f64, u64)> {
        let [moving, fixed] = self.queried_solids(pair, None);
        let cast = MotionCast::new(moving.with_motion(motion), fixed.at(Pose::IDENTITY)).ok()?;
        match cast.first_contact().ok()? {
            MotionOutcome::Free(free) => Some((1.0, free.steps.nodes)),
            MotionOutcome::Contact(met)
            | MotionOutcome::Grazing(met)
            | MotionOutcome::Undecided(met) => Some((met.lower, met.steps.nodes)),
            _ => None,
        }
    }

    /// Checks whether the first part is free of the second one along `d` from the end of a motion. The parts
    /// are the bodies of this pair.
    ///
    /// # Errors
    /// The motion or the direction is out of range.
    pub(crate) fn is_free_beyond(
        &self,
        pair: [usize; 2],
        along: (&Motion, DVec3),
    ) -> Result<bool, QueryError> {
        let beyond = self.cast_after_turning(pair, along, None, 1.0)?;
        Ok(matches!(beyond.clearance()?, Clearance::Free(_)))
    }

    /// Returns the given solids of two parts with a tolerance, and the bodies of this pair without one.
    fn queried_solids(&self, pair: [usize; 2], tolerance: Option<f64>) -> [&Solid; 2] {
        match tolerance {
            Some(_) => pair.map(|part| self.assembly().parts()[part].solid()),
            None => self.pair_solids(pair),
        }
    }

    /// Builds the cast along `d` of the first part after a share of the motion.
    fn cast_after_turning(
        &self,
        pair: [usize; 2],
        (motion, d): (&Motion, DVec3),
        tolerance: Option<f64>,
        share: f64,
    ) -> Result<Cast<'_, Solid>, QueryError> {
        let [moving, fixed] = self.queried_solids(pair, tolerance);
        let pose = motion.pose_at(share).map_err(|_| QueryError::Direction { direction: d })?;
        let options = SolidOptions::default()
            .with_tolerance(tolerance.unwrap_or(0.0))
            .with_min_gap(self.pair_fit(pair).min_gap());
        Cast::new(moving.at(pose), fixed.at(Pose::IDENTITY), d)?.with_options(options)
    }

    /// Checks whether a part may meet another one while it turns about an axis and moves along it by up to
    /// twice the diagonal of the assembly. Compares the box of the swept cylinder with the box of the other
    /// part.
    pub(crate) fn may_meet_turning(
        &self,
        [part, other]: [usize; 2],
        [point, axis]: [DVec3; 2],
    ) -> bool {
        let all = self.assembly().bounds();
        let travel = 2.0 * (all.high - all.low).length();
        let Aabb { low, high } = self.bounds(part);
        let corners = (0..8).map(|k| {
            let of = |i: usize| if k >> i & 1 == 0 { low[i] } else { high[i] };
            DVec3::new(of(0), of(1), of(2)) - point
        });
        let (mut radius, mut z) = (0.0_f64, [f64::INFINITY, f64::NEG_INFINITY]);
        for corner in corners {
            let along = corner.dot(axis);
            radius = radius.max((corner - axis * along).length());
            z = [z[0].min(along), z[1].max(along)];
        }
        let ends = [z[0], z[1] + travel].map(|z| point + axis * z);
        let swept = Aabb::from_points(ends).expanded(radius * (1.0 + 1e-9));
        swept.intersects(&self.bounds(other))
    }

    /// Checks whether a plan disregards contacts of two parts for a reason other than their thread.
    pub(crate) fn disregards_other_contacts(
        &self,
        [a, b]: [usize; 2],
        start: StartOverlap,
    ) -> bool {
        !matches!(self.tolerated_contacts([a, b]), Some(PairTolerance::Core(_)))
            && self.disregards_contacts(a, b, start)
    }
}
