//! Options of a plan.

use colltrans::solid::StartOverlap;
use glam::DVec3;

/// Options of a plan.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct PlanOptions {
    /// Treatment of overlaps at the start: overlapping parts move as one body, or only later contacts count.
    pub start: StartOverlap,
    /// Minimum number of sampled directions for parts that no other direction moves; 0 disables sampling.
    pub samples: usize,
    /// Whether to try to prove that no translation separates an interlocked group.
    pub prove: bool,
    /// Effort of each search for a step of several moves: a limit of [`EFFORT_WORK`](Self::EFFORT_WORK) times this
    /// number on the [work](colltrans::removal::path::SearchWork::total). 0 disables these searches. A larger effort
    /// continues the same search, so it finds what a smaller one finds, with equal work.
    pub effort: u32,
    /// Direction opposite to gravity, of any nonzero length. `None` selects that of the
    /// [assembly](crate::Assembly::up).
    pub up: Option<DVec3>,
}

impl Default for PlanOptions {
    fn default() -> Self {
        Self {
            start: StartOverlap::Refuse,
            samples: 162,
            prove: true,
            effort: Self::DEFAULT_EFFORT,
            up: None,
        }
    }
}

impl PlanOptions {
    /// Work of a search for each unit of [`effort`](Self::effort).
    pub const EFFORT_WORK: u64 = 2_000_000;
    /// Default [`effort`](Self::effort).
    pub const DEFAULT_EFFORT: u32 = 3;

    /// Returns the limit of work of a search.
    pub(super) fn work(&self) -> u64 {
        Self::EFFORT_WORK.saturating_mul(u64::from(self.effort))
    }

    /// Returns the options with another treatment of overlaps at the [`start`](Self::start).
    #[must_use]
    pub fn with_start(self, start: StartOverlap) -> Self {
        Self { start, ..self }
    }

    /// Returns the options with another number of [`samples`](Self::samples).
    #[must_use]
    pub fn with_samples(self, samples: usize) -> Self {
        Self { samples, ..self }
    }

    /// Returns the options with another [`effort`](Self::effort).
    #[must_use]
    pub fn with_effort(self, effort: u32) -> Self {
        Self { effort, ..self }
    }

    /// Returns the options with [proofs](Self::prove) enabled or disabled.
    #[must_use]
    pub fn with_proofs(self, prove: bool) -> Self {
        Self { prove, ..self }
    }

    /// Returns the options with another [`up`](Self::up) direction.
    #[must_use]
    pub fn with_up(self, up: DVec3) -> Self {
        Self { up: Some(up), ..self }
    }
}
