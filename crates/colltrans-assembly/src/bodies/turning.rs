//! Two parts of which one turns: what is asked of [`MotionCast`].

use colltrans::motion::{Motion, MotionCast, MotionOutcome};
use colltrans::solid::{SolidCast, SolidOptions, StartOverlap};
use colltrans::{Aabb, Cast, Clearance, Pose, QueryError, Solid};
use glam::DVec3;

use super::Bodies;
use crate::roles::Tolerated;
use crate::threads::Thread;

/// Shares of a motion at which bodies are looked at once more.
const PLACES: [f64; 6] = [0.01, 0.1, 0.3, 0.55, 0.8, 1.0];

/// What is said of a part that turns against another one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Turned {
    /// They never meet, neither on the motion nor when the part goes on from its end; so many pairs of parts of them were
    /// looked at.
    Free(u64),
    /// They do not meet before this share of the motion; 1 if they meet when the part goes on from its end.
    Blocked(f64),
    /// They overlap where the motion begins, with the least tolerance with which they would not, if there is one.
    Overlapping(Option<f64>),
}

impl Bodies<'_> {
    /// The thread of two parts of which that is said.
    pub(crate) fn thread(&self, pair: [usize; 2]) -> Option<Thread> {
        self.own_fit(pair).and_then(|own| own.thread)
    }

    /// Where the screw of such a thread sits best.
    pub(crate) fn seat(&self, pair: [usize; 2], thread: &Thread) -> Option<crate::threads::Seat> {
        let [a, b] = [pair[0].min(pair[1]), pair[0].max(pair[1])];
        thread.seat([a, b].map(|part| self.assembly().parts()[part].solid()))
    }

    /// One part on a motion, and then on along `d`, against another one that stays, both as they were given and shrunk by
    /// half of a tolerance; or without one, as they are asked of each other.
    pub(crate) fn turned(
        &self,
        pair: [usize; 2],
        (motion, d): (&Motion, DVec3),
        tolerance: Option<f64>,
    ) -> Result<Turned, QueryError> {
        let [moving, fixed] = self.asked(pair, tolerance);
        let cast = MotionCast::new(moving.along(motion), fixed.at(Pose::IDENTITY))?;
        let cast = match tolerance {
            Some(tolerance) => cast.tolerating(tolerance)?,
            None => cast.keeping(self.fit_of(pair).keep())?,
        };
        let pairs = match cast.first_contact()? {
            MotionOutcome::Overlapping(_) => {
                let found = cast.start_overlap()?;
                return Ok(Turned::Overlapping(found.and_then(|found| found.least_tolerance)));
            }
            MotionOutcome::Contact(met)
            | MotionOutcome::Grazing(met)
            | MotionOutcome::Undecided(met) => {
                return Ok(Turned::Blocked(met.lower));
            }
            MotionOutcome::Free(free) => free.steps.nodes,
            _ => return Ok(Turned::Blocked(0.0)),
        };
        // Looked at once more, in a few places.
        for share in PLACES {
            if self.turned_cast(pair, (motion, d), tolerance, share)?.overlaps() {
                return Ok(Turned::Blocked(share));
            }
        }
        let beyond = self.turned_cast(pair, (motion, d), tolerance, 1.0)?;
        let goes_on = matches!(beyond.clearance()?, Clearance::Free(_));
        Ok(if goes_on { Turned::Free(pairs) } else { Turned::Blocked(1.0) })
    }

    /// Up to which share of a motion the first part does not meet the second one, and how many pairs of parts of them were
    /// looked at; `None` if they overlap where it begins.
    pub(crate) fn stopped(&self, pair: [usize; 2], motion: &Motion) -> Option<(f64, u64)> {
        let [moving, fixed] = self.asked(pair, None);
        let cast = MotionCast::new(moving.along(motion), fixed.at(Pose::IDENTITY)).ok()?;
        match cast.first_contact().ok()? {
            MotionOutcome::Free(free) => Some((1.0, free.steps.nodes)),
            MotionOutcome::Contact(met)
            | MotionOutcome::Grazing(met)
            | MotionOutcome::Undecided(met) => Some((met.lower, met.steps.nodes)),
            _ => None,
        }
    }

    /// Whether the first part is free of the second one along `d` from the end of a motion, as they are asked of each other.
    pub(crate) fn goes_on(
        &self,
        pair: [usize; 2],
        along: (&Motion, DVec3),
    ) -> Result<bool, QueryError> {
        let beyond = self.turned_cast(pair, along, None, 1.0)?;
        Ok(matches!(beyond.clearance()?, Clearance::Free(_)))
    }

    /// Two parts as they were given, or without a tolerance as they are asked of each other.
    fn asked(&self, pair: [usize; 2], tolerance: Option<f64>) -> [&Solid; 2] {
        match tolerance {
            Some(_) => pair.map(|part| self.assembly().parts()[part].solid()),
            None => self.solids(pair),
        }
    }

    /// The same bodies after a share of the motion, and on along `d` from there.
    fn turned_cast(
        &self,
        pair: [usize; 2],
        (motion, d): (&Motion, DVec3),
        tolerance: Option<f64>,
        share: f64,
    ) -> Result<Cast<'_, Solid>, QueryError> {
        let [moving, fixed] = self.asked(pair, tolerance);
        let there = motion.at(share).map_err(|_| QueryError::Direction { direction: d })?;
        let options = SolidOptions::default()
            .with_tolerance(tolerance.unwrap_or(0.0))
            .with_keep(self.fit_of(pair).keep());
        Cast::new(moving.at(there), fixed.at(Pose::IDENTITY), d)?.with_options(options)
    }

    /// Whether a part may come near another one while it turns about an axis and goes along it, as far as parts are.
    pub(crate) fn may_meet_turning(
        &self,
        [part, other]: [usize; 2],
        [point, axis]: [DVec3; 2],
    ) -> bool {
        let all = self.assembly().bounds();
        let way = 2.0 * (all.high - all.low).length();
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
        let ends = [z[0], z[1] + way].map(|z| point + axis * z);
        let swept = Aabb::of_points(ends).grown(radius * (1.0 + 1e-9));
        swept.meets(&self.bounds(other))
    }

    /// Whether a plan passes over what two parts do, by request, but for their thread.
    pub(crate) fn is_let_pass(&self, [a, b]: [usize; 2], start: StartOverlap) -> bool {
        !matches!(self.tolerated([a, b]), Some(Tolerated::Core(_))) && self.lets_pass(a, b, start)
    }
}
