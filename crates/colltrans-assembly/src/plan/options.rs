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
    /// Maximum number of moves of a removal path; 1 disables the search for paths.
    pub max_moves: usize,
    /// Whether to try to prove that no translation separates an interlocked group.
    pub prove: bool,
    /// Work limit of each search for removal paths. For each of the `max_moves`, a fortieth of this number of node
    /// pairs may be visited ([`RemovalOptions::looks`](colltrans::removal::path::RemovalOptions::looks)), and 500 casts
    /// may be made.
    pub max_work: u64,
    /// Direction opposite to gravity, of any nonzero length. `None` selects that of the
    /// [assembly](crate::Assembly::up).
    pub up: Option<DVec3>,
}

impl Default for PlanOptions {
    fn default() -> Self {
        Self {
            start: StartOverlap::Refuse,
            samples: 162,
            max_moves: 2,
            prove: true,
            max_work: 20_000_000,
            up: None,
        }
    }
}

impl PlanOptions {
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

    /// Returns the options with another [maximum number of moves](Self::max_moves).
    #[must_use]
    pub fn with_max_moves(self, legs: usize) -> Self {
        Self { max_moves: legs, ..self }
    }

    /// Returns the options with [proofs](Self::prove) enabled or disabled.
    #[must_use]
    pub fn with_proofs(self, prove: bool) -> Self {
        Self { prove, ..self }
    }

    /// Returns the options with another [work limit](Self::max_work).
    #[must_use]
    pub fn with_looks(self, looks: u64) -> Self {
        Self { max_work: looks, ..self }
    }

    /// Returns the options with another [`up`](Self::up) direction.
    #[must_use]
    pub fn with_up(self, up: DVec3) -> Self {
        Self { up: Some(up), ..self }
    }
}
