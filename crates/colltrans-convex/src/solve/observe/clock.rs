//! Where the time of a query goes (the paper, table I).

use std::time::Instant;

use super::{Observer, Phase, ShadowFrame};

/// Names of the phases, in the order of [`Phase`].
const NAMES: [&str; 7] = [
    "setup",
    "planar problems",
    "cell shift",
    "search region",
    "lower bound",
    "portal refinement",
    "answer",
];

/// An [`Observer`] that reads a clock where a phase ends.
///
/// ```
/// # use colltrans::glam::DVec3;
/// # use colltrans::observe::Clock;
/// # use colltrans::{Cast, ConvexPolyhedron, Pose};
/// let body = ConvexPolyhedron::from_points(&[DVec3::X, DVec3::Y, DVec3::Z, DVec3::ZERO])?;
/// let start = Pose::from_translation(DVec3::new(-5.0, 0.1, 0.1))?;
/// let mut clock = Clock::new();
/// let cast = Cast::new(body.at(start), body.at(Pose::IDENTITY), DVec3::X)?;
/// cast.first_contact_observed(&mut clock)?;
/// assert!(clock.profile().total() > 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Clock {
    last: Option<Instant>,
    /// Nanoseconds and readings of each phase.
    spent: [(f64, u32); NAMES.len()],
}

/// Nanoseconds that the phases of one or more queries took.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Profile {
    nanoseconds: [f64; NAMES.len()],
}

impl Clock {
    /// Stopped; it runs while a query is answered.
    pub fn new() -> Self {
        Self { last: None, spent: [(0.0, 0); NAMES.len()] }
    }

    /// What was measured so far, with the clock's own cost taken off.
    pub fn profile(&self) -> Profile {
        let cost = clock_cost();
        let nanoseconds = self.spent.map(|(sum, laps)| (sum - f64::from(laps) * cost).max(0.0));
        Profile { nanoseconds }
    }
}

impl Default for Clock {
    fn default() -> Self {
        Self::new()
    }
}

impl Observer for Clock {
    fn begun(&mut self, _: impl FnOnce() -> ShadowFrame) {
        self.last = Some(Instant::now());
    }

    fn ended(&mut self, phase: Phase) {
        if let Some(last) = self.last {
            let (sum, laps) = &mut self.spent[phase as usize];
            *sum += last.elapsed().as_nanos() as f64;
            *laps += 1;
        }
        self.last = Some(Instant::now());
    }
}

impl Profile {
    /// Names of the phases, in the order of the data, and the nanoseconds spent in each.
    pub fn phases(&self) -> [(&'static str, f64); NAMES.len()] {
        std::array::from_fn(|i| (NAMES[i], self.nanoseconds[i]))
    }

    /// Nanoseconds of all phases together.
    pub fn total(&self) -> f64 {
        self.nanoseconds.iter().sum()
    }
}

/// The least time between two readings of the clock, in nanoseconds.
fn clock_cost() -> f64 {
    let once = |_| Instant::now().elapsed().as_nanos();
    (0..64).map(once).min().unwrap_or(0) as f64
}
