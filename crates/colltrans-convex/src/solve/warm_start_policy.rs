//! When following the last answer does not pay: a tracker that gives up early.
//!
//! Notation. The *work* of a cast is a count, never a time: supports and portals, weighed as they were
//! measured. `followed` and `scratch` are running averages of it, of casts that followed the last answer and
//! of casts from scratch.
//!
//! Invariant. As long as `followed` is no more than `scratch`, every cast follows. Else the next `pause` casts
//! start from scratch, of which the last is measured, and the one after them tries again; every failure doubles
//! the pause, every clear success halves it. Where `LONGEST` casts followed and were no clear success, one from
//! scratch is measured. So a sequence without coherence costs one failed attempt in
//! `LONGEST`, and one that becomes coherent is followed after `LONGEST` casts at most.

use crate::answer::{StartedFrom, Steps};

/// Whether the next cast should follow the last answer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Pace {
    /// Nothing before the first cast.
    scratch: Option<f32>,
    followed: f32,
    /// Casts from scratch after the next failure, and those still to come of the last one.
    pause: u8,
    left: u8,
    /// Casts that followed since the last clear success, or since one from scratch was measured.
    unclear: u8,
}

impl Default for Pace {
    fn default() -> Self {
        Self { scratch: None, followed: 0.0, pause: 1, left: 0, unclear: 0 }
    }
}

/// The longest pause.
const LONGEST: u8 = 32;

/// The weights of the newest cast in a running average: of one that followed, of an attempt that was lost, and of the
/// one cast from scratch that is measured in a pause.
const WEIGHT: f32 = 0.125;
const WEIGHT_LOST: f32 = 0.25;
const WEIGHT_SCRATCH: f32 = 0.5;

/// The share of the work from scratch that is a clear success; so much following is thought to take until it has
/// been seen, and one cast with more does not end it.
const EXPECTED: f32 = 0.75;

/// A support takes as long as this many portals; the guess that a cast from scratch begins with, and an attempt to follow
/// that is lost, as long as one (measured on bodies of 2,000 to 200,000 vertices).
const SUPPORT: f32 = 3.0;
const GUESS: f32 = 1.0;
const ATTEMPT: f32 = 1.0;

impl Pace {
    /// Whether the next cast follows the last answer.
    #[inline]
    pub(crate) fn follows(&self) -> bool {
        self.left == 0
    }

    /// Takes the work of a cast into account, that followed or did not. One that began from scratch after all has
    /// gained nothing, and cost the attempt.
    #[inline]
    pub(crate) fn note(&mut self, follows: bool, steps: &Steps) {
        if self.left > 1 {
            self.left -= 1;
            return;
        }
        #[expect(clippy::cast_precision_loss, reason = "a running average of counts")]
        let work = SUPPORT * steps.supports as f32 + steps.pivots as f32;
        match &mut self.scratch {
            None => {
                self.scratch = Some(work + GUESS);
                self.followed = EXPECTED * (work + GUESS);
            }
            Some(scratch) if !follows => {
                *scratch += WEIGHT_SCRATCH * (work + GUESS - *scratch);
                (self.left, self.unclear) = (0, 0);
                // What the next attempt is held against.
                self.followed = *scratch;
            }
            Some(scratch) => {
                let lost = steps.started_from == StartedFrom::Scratch;
                let (work, weight) =
                    if lost { (work.max(*scratch) + ATTEMPT, WEIGHT_LOST) } else { (work, WEIGHT) };
                self.followed += weight * (work - self.followed);
                if self.followed > *scratch {
                    self.pause = (2 * self.pause).min(LONGEST);
                    self.left = self.pause;
                } else if self.followed < EXPECTED * *scratch {
                    self.pause = (self.pause / 2).max(1);
                    self.unclear = 0;
                } else {
                    self.unclear = (self.unclear + 1) % LONGEST;
                    self.left = u8::from(self.unclear == 0);
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

    /// Attempts that are lost cost no count, but the sequence has no coherence: hardly one cast in `LONGEST` is one.
    #[test]
    fn attempts_that_are_lost_are_failures() {
        let mut pace = Pace::default();
        let mut attempts = 0;
        for k in 0..10_000 {
            let steps = steps(2, 1 + k % 3, StartedFrom::Scratch);
            let follows = k > 0 && pace.follows();
            attempts += u32::from(follows);
            pace.note(follows, &steps);
        }
        assert!((10_000 / 36..=10_000 / 30).contains(&attempts), "{attempts} attempts");
    }

    /// After casts from scratch that were much work, and are not any more, following is held against what they are now.
    #[test]
    fn what_casts_from_scratch_take_is_not_that_of_long_ago() {
        let mut pace = Pace::default();
        let mut followed = 0;
        for k in 0..2_000 {
            let follows = k > 0 && pace.follows();
            let steps = match (k < 1_000, follows) {
                (true, _) => steps(6, 1, StartedFrom::Scratch),
                (false, false) => steps(2, 1, StartedFrom::Scratch),
                (false, true) => steps(3, 3, StartedFrom::Features),
            };
            followed += u32::from(follows && k >= 1_000);
            pace.note(follows, &steps);
        }
        assert!(followed <= 100, "{followed} of 1,000 followed");
    }
}
