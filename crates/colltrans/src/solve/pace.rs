//! When following the last answer does not pay: a tracker that gives up early.
//!
//! Notation. The *work* of a cast is a count, never a time: supports and portals, weighed as they were
//! measured. `followed` and `scratch` are running averages of it, of casts that followed the last answer and
//! of casts from scratch.
//!
//! Invariant. As long as `followed` is no more than `scratch`, every cast follows. Else the next `pause` casts
//! start from scratch, and the one after them tries again; every failure doubles the pause, every clear
//! success shortens it. So a sequence without coherence costs one failed attempt in `LONGEST`, and one that becomes
//! coherent is followed after `LONGEST` casts at most.

use crate::answer::Steps;

/// Whether the next cast should follow the last answer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Pace {
    /// Nothing before the first cast.
    scratch: Option<f32>,
    followed: f32,
    /// Casts from scratch after the next failure, and those still to come of the last one.
    pause: u8,
    left: u8,
}

impl Default for Pace {
    fn default() -> Self {
        Self { scratch: None, followed: 0.0, pause: 1, left: 0 }
    }
}

/// The longest pause.
const LONGEST: u8 = 16;

/// Of the newest cast in a running average.
const WEIGHT: f32 = 0.125;

/// The share of the work from scratch that is a clear success; so much following is thought to take until it has
/// been seen, and one cast with more does not end it.
const EXPECTED: f32 = 0.75;

/// A support takes as long as this many portals, and the guess that a cast from scratch begins with as long as
/// one (measured on bodies of 2,000 to 200,000 vertices).
const SUPPORT: f32 = 3.0;
const GUESS: f32 = 1.0;

impl Pace {
    /// Whether the next cast follows the last answer.
    #[inline]
    pub(crate) fn follows(&self) -> bool {
        self.left == 0
    }

    /// Takes the work of a cast into account, that followed or did not.
    #[inline]
    pub(crate) fn note(&mut self, follows: bool, steps: &Steps) {
        #[expect(clippy::cast_precision_loss, reason = "a running average of counts")]
        let work = SUPPORT * steps.supports as f32 + steps.pivots as f32;
        match &mut self.scratch {
            None => {
                self.scratch = Some(work + GUESS);
                self.followed = EXPECTED * (work + GUESS);
            }
            Some(scratch) if !follows => {
                *scratch += WEIGHT * (work + GUESS - *scratch);
                self.left = self.left.saturating_sub(1);
                // What the next attempt is held against.
                self.followed = *scratch;
            }
            Some(scratch) => {
                self.followed += WEIGHT * (work - self.followed);
                if self.followed > *scratch {
                    self.pause = (2 * self.pause).min(LONGEST);
                    self.left = self.pause;
                } else if self.followed < EXPECTED * *scratch {
                    self.pause = (self.pause - 1).max(1);
                }
            }
        }
    }
}
