//! Choices, and what was done.

use glam::DVec3;

/// Choices of [`WaysOut`](super::WaysOut). More may be added: begin with the default ones.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct WayOptions {
    /// As of a [`Cast`](colltrans_convex::Cast): bodies are shrunk by half of this length; `None`: the largest of the default
    /// ones of their casts.
    pub tolerance: Option<f64>,
    /// At most so many legs, the last one included.
    pub legs: usize,
    /// In which order places are left; `None`: of two bodies those in new regions first, of more the fewest legs.
    pub order: Option<Order>,
    /// At most so many places are left along all directions.
    pub places: usize,
    /// At most so many casts of two bodies, all in all; a little more, as a place is ended once it is begun.
    pub casts: usize,
    /// Pairs of nodes that openings look at, at most, all in all; a little more, as one is ended once it is begun.
    pub looks: u64,
    /// Of two bodies: at most so many cells of displacements to prove that there is no way out, as many for each place that
    /// was left as [`CELLS_FOR_A_PLACE`](Self::CELLS_FOR_A_PLACE), and all of them once there is none left; 0 for no such
    /// proof.
    pub cells: usize,
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
            order: None,
            places: 2_000,
            casts: 200_000,
            looks: 50_000_000,
            cells: 20_000,
            step: 0.02,
            directions: Vec::new(),
        }
    }
}

impl WayOptions {
    /// Places that are left before it is first tried to prove that there is no way, and then at twice as many each time.
    pub const PLACES_FIRST: usize = 25;
    /// Cells of displacements for each place that was left: so neither the search for a way nor that for a proof takes
    /// much longer than it would alone.
    pub const CELLS_FOR_A_PLACE: usize = 20;

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

    /// With an order, or that of the number of bodies.
    #[must_use]
    pub fn with_order(self, order: impl Into<Option<Order>>) -> Self {
        Self { order: order.into(), ..self }
    }

    /// With a number of casts.
    #[must_use]
    pub fn with_casts(self, casts: usize) -> Self {
        Self { casts, ..self }
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

    /// With a number of cells for a proof that there is no way; 0 for none.
    #[must_use]
    pub fn with_cells(self, cells: usize) -> Self {
        Self { cells, ..self }
    }

    /// With a least move, as a share of the largest body's size.
    #[must_use]
    pub fn with_step(self, step: f64) -> Self {
        Self { step, ..self }
    }

    /// With directions to try, none of length 0; they are checked where they are used.
    #[must_use]
    pub fn with_directions(self, directions: Vec<DVec3>) -> Self {
        Self { directions, ..self }
    }
}

/// In which order places are left.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
pub enum Order {
    /// The fewest legs first: breadth first. A way through the cells of a proof, which may have more, is taken only
    /// where no other is found.
    FewestLegs,
    /// Those in regions where few places are, and with few legs: best first.
    NewestFirst,
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
    /// Pairs of bodies of which all free directions were asked for, for a skew last leg.
    pub free_sets: usize,
    /// Whether all places that these moves lead to were left: no limit ended the search.
    pub complete: bool,
}
