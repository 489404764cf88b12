//! Whole cells of directions that one pair of facets, or of boxes inside, blocks: for proofs about many bodies at once.

use glam::DVec3;

use super::answer::setting;
use super::bodies::Bodies;
use super::cell::Cell;
use super::error::FreeError;
use super::options::FreeOptions;
use super::proof::Fate;
use super::search::{Memory, Search};
use super::verify::{holds, names_exist};
use colltrans_convex::body::Placed;
use colltrans_solid::body::AsSolid;

/// A square cell of directions on a side of the cube around the origin, borders included; its corners are exact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DirectionCell(Cell);

impl DirectionCell {
    /// The six sides of the cube, which are all directions: across `+x`, `-x`, `+y`, ...
    pub fn sphere() -> [Self; 6] {
        Cell::roots().map(Self)
    }

    /// The four cells that it is made of.
    #[must_use]
    pub fn quarters(&self) -> [Self; 4] {
        [0, 1, 2, 3].map(|k| Self(self.0.quarter(k)))
    }

    /// How often a side of the cube was halved to get it.
    pub const fn depth(&self) -> u32 {
        self.0.depth
    }

    /// A direction in its middle, with a largest component of 1 (or -1).
    pub fn center(&self) -> DVec3 {
        self.0.side.direction(self.0.center())
    }
}

/// Which cells of directions one pair of facets of two solids blocks.
pub struct CellBlocker<'a> {
    bodies: Bodies<'a>,
    options: FreeOptions,
    memory: Memory,
}

impl<'a> CellBlocker<'a> {
    /// Of two bodies where they are; of the choices the tolerance and the meaning of an overlap count.
    ///
    /// # Errors
    /// As [`FreeDirections::of`](super::FreeDirections::of).
    pub fn new<A: AsSolid, B: AsSolid>(
        moving: &Placed<'a, A>,
        fixed: &Placed<'a, B>,
        options: FreeOptions,
    ) -> Result<Self, FreeError> {
        let (_, bodies) = setting(moving, fixed, &options)?;
        Ok(Self { bodies, options, memory: Memory::default() })
    }

    /// Whether all directions of a cell are blocked, exactly, by a pair of facets or of boxes inside the bodies that is
    /// found soon: by those of cells asked about before, first.
    pub fn covers(&mut self, cell: &DirectionCell) -> bool {
        Search::covers(&self.bodies, self.options, &cell.0, &mut self.memory)
    }

    /// Whether a pair of facets blocks all directions of a cell, exactly; not if there are no such facets.
    pub fn blocks(&self, cell: &DirectionCell, pair: [u32; 2]) -> bool {
        let fate = Fate::Blocked(pair);
        let none = [const { Vec::new() }; 2];
        names_exist(&self.bodies, &none, &fate) && holds(&self.bodies, &none, &cell.0, &fate)
    }

    /// A pair of facets that blocks all directions of a cell, exactly, if one is found soon: positions in
    /// [`Solid::triangles`](colltrans_solid::Solid::triangles) of the moving and of the fixed body.
    pub fn covering(&self, cell: &DirectionCell) -> Option<[u32; 2]> {
        Search::new(&self.bodies, self.options, None).covering_pair(&cell.0)
    }
}
