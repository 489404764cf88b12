//! Decides whether the next cast of a tracker starts from the last answer or from scratch.
//!
//! The *work* of a cast is a count, never a time: support points and portals with measured weights. `warm_work` and
//! `scratch_work` are running averages over casts that started from the last answer and over casts from scratch.
//!
//! - While `warm_work <= scratch_work`, each cast starts from the last answer.
//! - Otherwise the next `pause` casts start from scratch. The last of them is measured, and the cast after it tries the
//!   last answer again. Each failure doubles the pause, each clear success halves it.
//! - After `MAX_PAUSE` warm starts without a clear success, one cast from scratch is measured.
//!
//! Therefore a sequence without coherence costs one failed attempt in `MAX_PAUSE` casts. A sequence that becomes
//! coherent is recognised after `MAX_PAUSE` casts at most.

use crate::answer::{StartedFrom, Steps};

/// Policy for the start of the next cast, from the work of earlier ones.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct WarmStartPolicy {
    /// Average work of a cast from scratch. `None` before the first cast.
    scratch_work: Option<f32>,
    /// Average work of a cast that started from the last answer.
    warm_work: f32,
    /// Number of casts from scratch after a failure, before it is doubled.
    pause: u8,
    /// Number of casts from scratch that remain of the current pause.
    pause_left: u8,
    /// Number of warm starts since the last clear success, or since a cast from scratch was measured.
    inconclusive: u8,
}

impl Default for WarmStartPolicy {
    fn default() -> Self {
        Self { scratch_work: None, warm_work: 0.0, pause: 1, pause_left: 0, inconclusive: 0 }
    }
}

/// Maximum length of a pause, in casts.
const MAX_PAUSE: u8 = 32;

/// Weight of the newest warm start in its running average.
const WARM_WEIGHT: f32 = 0.125;
/// Weight of the newest warm start if the cast lost its way and began again from scratch.
const LOST_WEIGHT: f32 = 0.25;
/// Weight of the newest measured cast from scratch in its running average.
const SCRATCH_WEIGHT: f32 = 0.5;

/// Fraction of the work from scratch below which the average of warm starts is a clear success.
///
/// The average of warm starts begins at this fraction, so that a single cast with more work does not cause a pause.
const CLEAR_SUCCESS: f32 = 0.75;

/// Work of a support point, in portals (measured on bodies of 2,000 to 200,000 vertices).
const SUPPORT_WORK: f32 = 3.0;
/// Work of the guess with which a cast from scratch begins, in portals (measured on the same bodies).
const GUESS_WORK: f32 = 1.0;
/// Work of a warm start that is lost, in portals (measured on the same bodies).
const LOST_ATTEMPT_WORK: f32 = 1.0;

impl WarmStartPolicy {
    /// Checks whether the next cast should start from the last answer.
    #[inline]
    pub(crate) fn should_warm_start(&self) -> bool {
        self.pause_left == 0
    }

    /// Records the work of a cast. `warm_started` states whether the cast started from the last answer.
    ///
    /// A warm start that had to begin again from scratch counts as at least the work of a cast from scratch, plus the
    /// lost attempt.
    #[inline]
    pub(crate) fn record_cast(&mut self, warm_started: bool, steps: &Steps) {
        if self.pause_left > 1 {
            self.pause_left -= 1;
            return;
        }
        #[expect(clippy::cast_precision_loss, reason = "a running average of counts")]
        let work = SUPPORT_WORK * steps.supports as f32 + steps.pivots as f32;
        match &mut self.scratch_work {
            None => {
                self.scratch_work = Some(work + GUESS_WORK);
                self.warm_work = CLEAR_SUCCESS * (work + GUESS_WORK);
            }
            Some(scratch) if !warm_started => {
                *scratch += SCRATCH_WEIGHT * (work + GUESS_WORK - *scratch);
                (self.pause_left, self.inconclusive) = (0, 0);
                // The average with which the next attempt begins.
                self.warm_work = *scratch;
            }
            Some(scratch) => {
                let lost = steps.started_from == StartedFrom::Scratch;
                let (work, weight) = if lost {
                    (work.max(*scratch) + LOST_ATTEMPT_WORK, LOST_WEIGHT)
                } else {
                    (work, WARM_WEIGHT)
                };
                self.warm_work += weight * (work - self.warm_work);
                if self.warm_work > *scratch {
                    self.pause = (2 * self.pause).min(MAX_PAUSE);
                    self.pause_left = self.pause;
                } else if self.warm_work < CLEAR_SUCCESS * *scratch {
                    self.pause = (self.pause / 2).max(1);
                    self.inconclusive = 0;
                } else {
                    self.inconclusive = (self.inconclusive + 1) % MAX_PAUSE;
                    self.pause_left = u8::from(self.inconclusive == 0);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn steps(supports: u32, pivots: u32, started_from: StartedFrom) -> Steps {
        Steps { supports, pivots, started_from, ..Steps::default() }
    }

    /// Checks a sequence in which each warm start is lost, with counts as low as those from scratch: only about one
    /// cast in `MAX_PAUSE` is a warm start.
    #[test]
    fn lost_warm_starts_are_retried_after_longest_pause_only() {
        let mut policy = WarmStartPolicy::default();
        let mut warm_starts = 0;
        for k in 0..10_000 {
            let steps = steps(2, 1 + k % 3, StartedFrom::Scratch);
            let warm_started = k > 0 && policy.should_warm_start();
            warm_starts += u32::from(warm_started);
            policy.record_cast(warm_started, &steps);
        }
        assert!(
            (10_000 / 36..=10_000 / 30).contains(&warm_starts),
            "{warm_starts} warm starts, expected one in 30 to 36 casts"
        );
    }

    /// Checks a sequence in which casts from scratch need much work at first and little later: warm starts, which need
    /// more, are compared with the later work.
    #[test]
    fn warm_starts_end_once_scratch_casts_need_less_work() {
        let mut policy = WarmStartPolicy::default();
        let mut warm_starts = 0;
        for k in 0..2_000 {
            let warm_started = k > 0 && policy.should_warm_start();
            let steps = match (k < 1_000, warm_started) {
                (true, _) => steps(6, 1, StartedFrom::Scratch),
                (false, false) => steps(2, 1, StartedFrom::Scratch),
                (false, true) => steps(3, 3, StartedFrom::Features),
            };
            warm_starts += u32::from(warm_started && k >= 1_000);
            policy.record_cast(warm_started, &steps);
        }
        assert!(warm_starts <= 100, "{warm_starts} of 1,000 casts are warm starts");
    }
}
