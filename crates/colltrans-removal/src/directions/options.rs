//! Options of a search for free directions.

use super::cell::MAX_DEPTH;
use colltrans_solid::cast::{SolidOptions, StartOverlap};

/// Options of [`FreeDirections`](super::FreeDirections). Fields may be added, therefore start from
/// [`Self::DEFAULT`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct FreeOptions {
    /// Both bodies are offset inwards by half of this length. `None` selects the tolerance of a
    /// [`Cast`](colltrans_convex::Cast): 0 if both poses are quarter turns, otherwise a bound on the effect
    /// of rounding on a fit.
    pub tolerance: Option<f64>,
    /// Whether facets that cross at the start count as an overlap, as in a [`Cast`](colltrans_convex::Cast).
    pub start_overlap: StartOverlap,
    /// Maximum number of halvings of a side of the cube, at most 50.
    pub depth: u32,
    /// Limit of node visits of the whole search. A new cone counts as 16 visits, and growing the boxes behind
    /// a pair of facets counts as 4,000. A cell that has been started is finished, so the limit can be
    /// exceeded slightly. Directions that are not decided at the limit remain undecided.
    pub looks: u64,
    /// Maximum number of cones that divide a cell before it is divided into quarters.
    pub cones: usize,
}

impl Default for FreeOptions {
    fn default() -> Self {
        Self::DEFAULT
    }
}

impl FreeOptions {
    /// Default options.
    pub const DEFAULT: Self = Self {
        tolerance: None,
        start_overlap: StartOverlap::Refuse,
        depth: 26,
        looks: 20_000_000,
        cones: 40,
    };

    /// Returns the options with a tolerance of 0.
    #[must_use]
    pub const fn with_no_tolerance(self) -> Self {
        Self { tolerance: Some(0.0), ..self }
    }

    /// Returns the options with a tolerance, a length, or with the default tolerance for `None`. The value is
    /// checked when it is used.
    #[must_use]
    pub fn with_tolerance(self, tolerance: impl Into<Option<f64>>) -> Self {
        Self { tolerance: tolerance.into(), ..self }
    }

    /// Returns the options with a treatment of an overlap at the start.
    #[must_use]
    pub const fn with_start_overlap(self, start_overlap: StartOverlap) -> Self {
        Self { start_overlap, ..self }
    }

    /// Returns the options with a maximum depth, at most 50.
    #[must_use]
    pub fn with_depth(self, depth: u32) -> Self {
        Self { depth: depth.min(MAX_DEPTH), ..self }
    }

    /// Returns the options with a limit of node visits.
    #[must_use]
    pub const fn with_looks(self, looks: u64) -> Self {
        Self { looks, ..self }
    }

    /// Returns the options with a maximum number of cones for a cell.
    #[must_use]
    pub const fn with_cones(self, cones: usize) -> Self {
        Self { cones, ..self }
    }

    /// Returns the options of a cast along one direction.
    pub(super) fn cast_options(&self) -> SolidOptions {
        SolidOptions::default()
            .with_tolerance(self.tolerance)
            .with_start_overlap(self.start_overlap)
    }
}
