//! Times the phases of a query (the paper, table I).

use std::time::Instant;

use super::{Observer, Phase, ShadowFrame};

/// Names of the phases, in the order of [`Phase`].
const PHASE_NAMES: [&str; 7] = [
    "setup",
    "planar problems",
    "cell shift",
    "search region",
    "lower bound",
    "portal refinement",
    "answer",
];

/// An [`Observer`] that measures the time of each phase.
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
/// assert!(clock.profile().total_nanoseconds() > 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Clock {
    last: Option<Instant>,
    /// Nanoseconds, and number of measurements, of each phase.
    spent: [(f64, u32); PHASE_NAMES.len()],
}

/// Time of each phase of one or more queries.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Profile {
    nanoseconds: [f64; PHASE_NAMES.len()],
}

impl Clock {
    /// Builds a stopped clock. It runs while a query is answered.
    pub fn new() -> Self {
        Self { last: None, spent: [(0.0, 0); PHASE_NAMES.len()] }
    }

    /// Returns the measured times, reduced by the time that the measurements took.
    pub fn profile(&self) -> Profile {
        let overhead = clock_overhead();
        let nanoseconds =
            self.spent.map(|(sum, count)| (sum - f64::from(count) * overhead).max(0.0));
        Profile { nanoseconds }
    }
}

impl Default for Clock {
    fn default() -> Self {
        Self::new()
    }
}

impl Observer for Clock {
    fn search_started(&mut self, _: impl FnOnce() -> ShadowFrame) {
        self.last = Some(Instant::now());
    }

    fn phase_ended(&mut self, phase: Phase) {
        if let Some(last) = self.last {
            let (sum, count) = &mut self.spent[phase as usize];
            *sum += last.elapsed().as_nanos() as f64;
            *count += 1;
        }
        self.last = Some(Instant::now());
    }
}

impl Profile {
    /// Returns the name and the time in nanoseconds of each phase, in the order of [`Phase`].
    pub fn phase_times(&self) -> [(&'static str, f64); PHASE_NAMES.len()] {
        std::array::from_fn(|i| (PHASE_NAMES[i], self.nanoseconds[i]))
    }

    /// Returns the time of all phases in nanoseconds.
    pub fn total_nanoseconds(&self) -> f64 {
        self.nanoseconds.iter().sum()
    }
}

/// Measures the shortest time between two readings of the clock, in nanoseconds.
fn clock_overhead() -> f64 {
    let reading = |_| Instant::now().elapsed().as_nanos();
    (0..64).map(reading).min().unwrap_or(0) as f64
}
