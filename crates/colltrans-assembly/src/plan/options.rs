//! Choices.

use colltrans::solid::StartOverlap;
use glam::DVec3;

/// Choices for a plan.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct PlanOptions {
    /// What overlaps at the start mean: parts that overlap move as one, or what they do later counts.
    pub start: StartOverlap,
    /// How many directions to sample for what no other direction moves; 0 for none.
    pub samples: usize,
    /// How many moves, one after another, may take out what no single one does; 1 for none.
    pub legs: usize,
    /// Whether to prove of what is stuck that no translation of a group as one takes it from the others.
    pub prove: bool,
    /// Work for those of what is stuck together, each time: a fortieth of so many pairs of nodes, as of
    /// [`WayOptions`](colltrans::ways::WayOptions), and 500 casts, for each of `legs`.
    pub looks: u64,
    /// Against gravity, of any length but zero; `None` for that of the [assembly](crate::Assembly::up).
    pub up: Option<DVec3>,
}

impl Default for PlanOptions {
    fn default() -> Self {
        Self {
            start: StartOverlap::Refuse,
            samples: 162,
            legs: 2,
            prove: true,
            looks: 20_000_000,
            up: None,
        }
    }
}

impl PlanOptions {
    /// The same with another [`start`](Self::start).
    #[must_use]
    pub fn with_start(self, start: StartOverlap) -> Self {
        Self { start, ..self }
    }

    /// The same with another [`samples`](Self::samples).
    #[must_use]
    pub fn with_samples(self, samples: usize) -> Self {
        Self { samples, ..self }
    }

    /// The same with another number of [`legs`](Self::legs).
    #[must_use]
    pub fn with_legs(self, legs: usize) -> Self {
        Self { legs, ..self }
    }

    /// The same with [proofs](Self::prove) or without.
    #[must_use]
    pub fn with_proofs(self, prove: bool) -> Self {
        Self { prove, ..self }
    }

    /// The same with another amount of [work](Self::looks).
    #[must_use]
    pub fn with_looks(self, looks: u64) -> Self {
        Self { looks, ..self }
    }

    /// The same with another [`up`](Self::up).
    #[must_use]
    pub fn with_up(self, up: DVec3) -> Self {
        Self { up: Some(up), ..self }
    }
}
