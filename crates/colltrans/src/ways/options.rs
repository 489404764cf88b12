//! Choices, and what was done.

use glam::DVec3;

/// Choices of [`WaysOut`](super::WaysOut). More may be added: begin with the default ones.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct WayOptions {
    /// As of a [`Cast`](crate::Cast): bodies are shrunk by half of this length; `None`: the largest of the default
    /// ones of their casts.
    pub tolerance: Option<f64>,
    /// At most so many legs, the last one included.
    pub legs: usize,
    /// At most so many places are left along all directions.
    pub places: usize,
    /// Pairs of nodes that openings look at, at most, all in all; a little more, as one is ended once it is begun.
    pub looks: u64,
    /// A move is worth making if it is this share of the size of the largest body.
    pub step: f64,
    /// Directions to try, with their opposites; none: those of large facets of all bodies, and across two of these.
    pub directions: Vec<DVec3>,
}

impl Default for WayOptions {
    fn default() -> Self {
        Self {
            tolerance: None,
            legs: 12,
            places: 2_000,
            looks: 50_000_000,
            step: 0.02,
            directions: Vec::new(),
        }
    }
}

impl WayOptions {
    /// With a tolerance, a length, or the default one. It is checked where it is used.
    #[must_use]
    pub fn with_tolerance(self, tolerance: impl Into<Option<f64>>) -> Self {
        Self { tolerance: tolerance.into(), ..self }
    }

    /// With a number of legs.
    #[must_use]
    pub fn with_legs(self, legs: usize) -> Self {
        Self { legs, ..self }
    }

    /// With a number of places.
    #[must_use]
    pub fn with_places(self, places: usize) -> Self {
        Self { places, ..self }
    }

    /// With an amount of work.
    #[must_use]
    pub fn with_looks(self, looks: u64) -> Self {
        Self { looks, ..self }
    }

    /// With a least move, as a share of the largest body's size.
    #[must_use]
    pub fn with_step(self, step: f64) -> Self {
        Self { step, ..self }
    }

    /// With directions to try; those of length 0, or not finite, are left out.
    #[must_use]
    pub fn with_directions(self, directions: Vec<DVec3>) -> Self {
        Self { directions, ..self }
    }
}

/// What was searched.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Searched {
    /// Directions that were tried from each place.
    pub directions: usize,
    /// Places that were left along all directions.
    pub places: usize,
    /// Casts of two bodies.
    pub casts: usize,
    /// Pairs of directions of two bodies that were looked at for openings.
    pub openings: usize,
    /// Pairs of nodes looked at for them.
    pub looks: u64,
    /// Whether all places that these moves lead to were left: no limit ended the search.
    pub complete: bool,
}
