//! Options of a search for removal paths, and its amounts of work.

use glam::DVec3;

/// Options of [`RemovalSearch`](super::RemovalSearch). Fields may be added, therefore start from the default options.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct RemovalOptions {
    /// Bodies are offset inwards by half of this length. `None` selects the largest default tolerance of a
    /// [`Cast`](colltrans_convex::Cast) between two of them.
    pub tolerance: Option<f64>,
    /// Maximum number of legs, including the last one.
    pub legs: usize,
    /// Order in which placements are explored. `None` selects [`Order::NewestFirst`] for two bodies and
    /// [`Order::FewestLegs`] for more.
    pub order: Option<Order>,
    /// Maximum number of placements that are explored along all directions.
    pub places: usize,
    /// Limit of casts of the search over placements. It is checked before each placement and before each
    /// group of bodies that moves, so it can be exceeded slightly. The later stages, which shorten a path
    /// through cells of a proof or try last legs in any direction, do not observe it.
    pub casts: usize,
    /// Limit of node visits of all searches for openings. A search that has been started is finished, so the
    /// limit can be exceeded slightly.
    pub looks: u64,
    /// Limit of [`SearchWork::total`]. It is checked like [`casts`](Self::casts). A larger limit continues the same
    /// search, so it finds a path that a smaller one finds, with equal work.
    pub work: u64,
    /// Maximum number of displacement cells of the search for a proof that two bodies have no removal path; 0
    /// disables this search. Up to each attempt, [`CELLS_PER_PLACEMENT`](Self::CELLS_PER_PLACEMENT) cells are
    /// allowed for each explored placement. When no placement is left or a limit is reached, the full number
    /// is allowed.
    pub cells: usize,
    /// Minimum length of a move, as a fraction of the size of the largest body.
    pub step: f64,
    /// Directions of moves, also used with opposite sign. If empty, the search uses normals of large facets
    /// of all bodies and cross products of two of them.
    pub directions: Vec<DVec3>,
}

impl Default for RemovalOptions {
    fn default() -> Self {
        Self {
            tolerance: None,
            legs: 12,
            order: None,
            places: 2_000,
            casts: 200_000,
            looks: 50_000_000,
            work: u64::MAX,
            cells: 20_000,
            step: 0.02,
            directions: Vec::new(),
        }
    }
}

impl RemovalOptions {
    /// Number of explored placements after which the first attempt at a proof is made. It doubles for each
    /// later attempt.
    pub const FIRST_PROOF_PLACEMENTS: usize = 25;
    /// Work after which a search for the fewest legs also follows single groups to places that need many legs.
    pub const FIRST_FOCUSED_WORK: u64 = 10_000_000;
    /// Number of displacement cells for each explored placement. This balances the work of the search and of
    /// the proof.
    pub const CELLS_PER_PLACEMENT: usize = 20;

    /// Returns the options with a tolerance, a length, or with the default tolerance for `None`. The value is
    /// checked when it is used.
    #[must_use]
    pub fn with_tolerance(self, tolerance: impl Into<Option<f64>>) -> Self {
        Self { tolerance: tolerance.into(), ..self }
    }

    /// Returns the options with a maximum number of legs.
    #[must_use]
    pub fn with_legs(self, legs: usize) -> Self {
        Self { legs, ..self }
    }

    /// Returns the options with an order of exploration, or with the default order for `None`.
    #[must_use]
    pub fn with_order(self, order: impl Into<Option<Order>>) -> Self {
        Self { order: order.into(), ..self }
    }

    /// Returns the options with a limit of casts.
    #[must_use]
    pub fn with_casts(self, casts: usize) -> Self {
        Self { casts, ..self }
    }

    /// Returns the options with a maximum number of placements.
    #[must_use]
    pub fn with_places(self, places: usize) -> Self {
        Self { places, ..self }
    }

    /// Returns the options with a limit of node visits.
    #[must_use]
    pub fn with_looks(self, looks: u64) -> Self {
        Self { looks, ..self }
    }

    /// Returns the options with a limit of all work.
    #[must_use]
    pub fn with_work(self, work: u64) -> Self {
        Self { work, ..self }
    }

    /// Returns the options with a maximum number of cells for a proof that no path exists; 0 disables this
    /// proof.
    #[must_use]
    pub fn with_cells(self, cells: usize) -> Self {
        Self { cells, ..self }
    }

    /// Returns the options with a minimum length of a move, as a fraction of the largest body's size.
    #[must_use]
    pub fn with_step(self, step: f64) -> Self {
        Self { step, ..self }
    }

    /// Returns the options with directions of moves, none of length 0. They are checked when they are used.
    #[must_use]
    pub fn with_directions(self, directions: Vec<DVec3>) -> Self {
        Self { directions, ..self }
    }
}

/// Order in which placements are explored.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
pub enum Order {
    /// Fewest legs first (breadth first). A path through the cells of a proof, which may have more legs, is
    /// used only if no other path is found. After [`SearchWork::total`] has reached
    /// [`RemovalOptions::FIRST_FOCUSED_WORK`], half of the work goes to placements that one group alone has reached.
    FewestLegs,
    /// Best first: a placement with few legs in a region with few placements.
    NewestFirst,
}

/// Amounts of work of a search.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct SearchWork {
    /// Number of directions that were tried from each placement: the given ones, and those that the search derived
    /// from walls that stopped bodies.
    pub directions: usize,
    /// Number of placements that were explored along all directions.
    pub places: usize,
    /// Number of casts.
    pub casts: usize,
    /// Number of pairs of directions of two bodies that were searched for openings.
    pub openings: usize,
    /// Number of node visits of these searches, including the comparisons of the boxes of both bodies and look-ups of
    /// known openings, and of tests of facets that were hit before.
    pub looks: u64,
    /// Number of pairs of bodies whose free directions were computed for a last leg in another direction.
    pub free_sets: usize,
    /// Whether all placements that the moves can reach within [`RemovalOptions::legs`] were explored, so that no
    /// limit of work ended the search. A placement that counts as equal to an earlier one with at most as
    /// many legs is not continued.
    pub complete: bool,
}

impl SearchWork {
    /// Number of node visits for which a cast counts in [`total`](Self::total).
    pub const CAST_WORK: u64 = 500;

    /// Returns the work of two searches, of which the second one began when the first one had ended. The directions and
    /// the completeness are those of the second one.
    #[must_use]
    pub const fn followed_by(self, second: Self) -> Self {
        Self {
            directions: second.directions,
            places: self.places + second.places,
            casts: self.casts + second.casts,
            openings: self.openings + second.openings,
            looks: self.looks + second.looks,
            free_sets: self.free_sets + second.free_sets,
            complete: second.complete,
        }
    }

    /// Returns the total work: node visits, and 500 for each cast.
    pub const fn total(&self) -> u64 {
        self.looks + Self::CAST_WORK * self.casts as u64
    }
}
