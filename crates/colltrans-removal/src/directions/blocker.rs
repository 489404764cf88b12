//! Cells of directions that one pair of facets, or of boxes inside the bodies, blocks entirely. Proofs about
//! many bodies use them.

use glam::DVec3;

use super::answer::checked_bodies;
use super::bodies::Bodies;
use super::cell::Cell;
use super::error::FreeError;
use super::options::FreeOptions;
use super::proof::CellState;
use super::search::{Search, SearchMemory};
use super::verify::{claim_holds, names_exist};
use colltrans_convex::body::Placed;
use colltrans_solid::body::AsSolid;

/// Square cell of directions on a side of the cube around the origin, including its boundary. Its corners are
/// exact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DirectionCell(Cell);

impl DirectionCell {
    /// Returns the six sides of the cube, which cover all directions, in the order `+x`, `-x`, `+y`, ...
    pub fn sphere() -> [Self; 6] {
        Cell::root_cells().map(Self)
    }

    /// Returns the four quarters of the cell.
    #[must_use]
    pub fn quarters(&self) -> [Self; 4] {
        [0, 1, 2, 3].map(|k| Self(self.0.quarter(k)))
    }

    /// Returns the number of times that a side of the cube was halved to obtain the cell.
    pub const fn depth(&self) -> u32 {
        self.0.depth
    }

    /// Returns the direction at the center of the cell, with a largest component of 1 or -1.
    pub fn center(&self) -> DVec3 {
        self.0.side.direction_at(self.0.center())
    }
}

/// Decides which cells of directions one pair of facets, or of inner boxes, of two solids blocks.
pub struct CellBlocker<'a> {
    bodies: Bodies<'a>,
    options: FreeOptions,
    memory: SearchMemory,
}

impl<'a> CellBlocker<'a> {
    /// Builds the blocker of two placed bodies. Of the options, only the tolerance and the start overlap are
    /// used.
    ///
    /// # Errors
    /// Returns the errors of [`FreeDirections::compute`](super::FreeDirections::compute).
    pub fn new<A: AsSolid, B: AsSolid>(
        moving: &Placed<'a, A>,
        fixed: &Placed<'a, B>,
        options: FreeOptions,
    ) -> Result<Self, FreeError> {
        let (_, bodies) = checked_bodies(moving, fixed, &options)?;
        Ok(Self { bodies, options, memory: SearchMemory::default() })
    }

    /// Checks whether one pair of facets, or of boxes inside the bodies, blocks all directions of a cell.
    /// Pairs that blocked earlier cells are tried first, then a limited search runs. `true` is exact; `false`
    /// means that the search found no such pair.
    pub fn is_blocked(&mut self, cell: &DirectionCell) -> bool {
        Search::covers_cell(&self.bodies, self.options, &cell.0, &mut self.memory)
    }

    /// Checks exactly whether a pair of facets blocks all directions of a cell. Returns `false` if a facet
    /// does not exist.
    pub fn is_blocked_by(&self, cell: &DirectionCell, pair: [u32; 2]) -> bool {
        let state = CellState::Blocked(pair);
        let none = [const { Vec::new() }; 2];
        names_exist(&self.bodies, &none, &state)
            && claim_holds(&self.bodies, &none, &cell.0, &state)
    }

    /// Returns a pair of facets that blocks all directions of a cell, exactly: indices into
    /// [`Solid::triangles`](colltrans_solid::Solid::triangles) of the moving and the fixed body. Returns
    /// `None` if a limited search finds no such pair.
    pub fn blocking_pair(&self, cell: &DirectionCell) -> Option<[u32; 2]> {
        Search::new(&self.bodies, self.options, None).covering_pair(&cell.0)
    }
}
