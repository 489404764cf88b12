//! Where the time of a query goes (the paper, table I).
//!
//! Code that ends a phase calls `lap`: the time since the last lap belongs to that phase. Without
//! the feature `profile` that is nothing at all.

/// A part of a query's work, in the order of the data.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Phase {
    /// Frames, section axes, and the first guess.
    Setup,
    /// Planar problems.
    Planar,
    /// Pieces, cells and the shift to a cell's best point.
    Cell,
    /// Cuts of the region and centroids.
    Region,
    /// What all pieces prove together.
    Bound,
    /// Portal refinement.
    Finish,
    /// Bounds, witness points and features of the answer.
    Answer,
}

#[cfg(not(feature = "profile"))]
#[inline(always)]
pub(crate) fn lap(_: Phase) {}

#[cfg(feature = "profile")]
pub(crate) use clock::lap;
#[cfg(feature = "profile")]
pub use clock::{Profile, measure};

#[cfg(feature = "profile")]
mod clock {
    use std::cell::Cell;
    use std::time::Instant;

    use super::Phase;

    const NAMES: [&str; 7] = [
        "setup",
        "planar problems",
        "cell shift",
        "search region",
        "lower bound",
        "portal refinement",
        "answer",
    ];

    thread_local! {
        static LAST: Cell<Option<Instant>> = const { Cell::new(None) };
        static SPENT: Cell<[(f64, u32); NAMES.len()]> = const { Cell::new([(0.0, 0); NAMES.len()]) };
    }

    /// Nanoseconds that the phases of one or more queries took on this thread.
    #[derive(Debug, Clone, Copy, PartialEq)]
    pub struct Profile {
        nanoseconds: [f64; NAMES.len()],
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

    /// Runs queries and says where their time went, with the clock's own cost taken off.
    ///
    /// ```
    /// # use colltrans::glam::DVec3;
    /// # use colltrans::{ConvexPolyhedron, Pose, cast, profile};
    /// let body = ConvexPolyhedron::from_points(&[DVec3::X, DVec3::Y, DVec3::Z, DVec3::ZERO])?;
    /// let start = Pose::from_translation(DVec3::new(-5.0, 0.1, 0.1))?;
    /// let (outcome, profile) = profile::measure(|| {
    ///     cast(&body, &start, &body, &Pose::IDENTITY, DVec3::X)
    /// });
    /// outcome?;
    /// assert!(profile.total() > 0.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn measure<T>(queries: impl FnOnce() -> T) -> (T, Profile) {
        SPENT.set([(0.0, 0); NAMES.len()]);
        LAST.set(Some(Instant::now()));
        let result = queries();
        LAST.set(None);
        let cost = clock_cost();
        let nanoseconds = SPENT.get().map(|(sum, laps)| (sum - f64::from(laps) * cost).max(0.0));
        (result, Profile { nanoseconds })
    }

    pub(crate) fn lap(phase: Phase) {
        let Some(last) = LAST.get() else { return };
        let mut spent = SPENT.get();
        let (sum, laps) = &mut spent[phase as usize];
        *sum += last.elapsed().as_nanos() as f64;
        *laps += 1;
        SPENT.set(spent);
        LAST.set(Some(Instant::now()));
    }

    /// The least time between two readings of the clock, in nanoseconds.
    fn clock_cost() -> f64 {
        let once = |_| Instant::now().elapsed().as_nanos();
        (0..64).map(once).min().unwrap_or(0) as f64
    }
}
