//! Choices.

use super::cell::DEEPEST;
use colltrans_solid::cast::{SolidOptions, StartOverlap};

/// Choices of [`FreeDirections`](super::FreeDirections). More may be added: begin with the default ones.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct FreeOptions {
    /// As of a [`Cast`](colltrans_convex::Cast): both bodies are shrunk by half of this length; `None` stands for 0 where both
    /// poses turn by quarter turns, and else for what rounding can do to a fit.
    pub tolerance: Option<f64>,
    /// As of a [`Cast`](colltrans_convex::Cast): whether facets that cross now count.
    pub start_overlap: StartOverlap,
    /// The sides of a cube are halved at most so often (and never more than 50 times).
    pub depth: u32,
    /// Pairs of nodes that are looked at, at most, all in all; a little more, as a cell is ended once it is begun.
    /// What is not decided by then stays undecided.
    pub looks: u64,
    /// Cones that a cell may be cut by before it is cut in four.
    pub cones: usize,
}

impl Default for FreeOptions {
    fn default() -> Self {
        Self::DEFAULT
    }
}

impl FreeOptions {
    /// The default ones.
    pub const DEFAULT: Self = Self {
        tolerance: None,
        start_overlap: StartOverlap::Refuse,
        depth: 26,
        looks: 20_000_000,
        cones: 40,
    };

    /// With the bodies as they are.
    #[must_use]
    pub const fn with_no_tolerance(self) -> Self {
        Self { tolerance: Some(0.0), ..self }
    }

    /// With a tolerance, a length, or the default one. It is checked where it is used.
    #[must_use]
    pub fn with_tolerance(self, tolerance: impl Into<Option<f64>>) -> Self {
        Self { tolerance: tolerance.into(), ..self }
    }

    /// With a meaning of an overlap at the start.
    #[must_use]
    pub const fn with_start_overlap(self, start_overlap: StartOverlap) -> Self {
        Self { start_overlap, ..self }
    }

    /// With a greatest depth.
    #[must_use]
    pub fn with_depth(self, depth: u32) -> Self {
        Self { depth: depth.min(DEEPEST), ..self }
    }

    /// With an amount of work.
    #[must_use]
    pub const fn with_looks(self, looks: u64) -> Self {
        Self { looks, ..self }
    }

    /// With a number of cones for a cell.
    #[must_use]
    pub const fn with_cones(self, cones: usize) -> Self {
        Self { cones, ..self }
    }

    /// The choices of a cast along one of the directions.
    pub(super) fn of_cast(&self) -> SolidOptions {
        SolidOptions::default()
            .with_tolerance(self.tolerance)
            .with_start_overlap(self.start_overlap)
    }
}
