//! Planar sections of a polyhedron across fixed axes, in `O(n)` space with logarithmic access (the paper, section
//! III). They are built when the paper's algorithm first needs them; portal refinement does not use them.
//!
//! - *level* of `v`: `a . v` for a section axis `a` of the body frame.
//! - *section* at level `x`: the convex polygon in which the plane `a . v = x` cuts the body. Each of its vertices
//!   lies on a mesh edge that *crosses* the level.
//! - *above* and *below*: a mesh vertex is above if its level is `> x`, else below. So a section is the one just
//!   above level `x`, passes through no mesh vertex, and exists for `min <= x < max`.
//! - A crossing edge is given by its half-edge that runs upwards.
//! - Counter-clockwise refers to the view from the tip of the axis.
//!
//! In place of the paper's *drums*, parts of a body between two levels, this module has [`snapshots`] of single
//! levels, and walks from them. Details: `docs/theory/sections.md`.

mod axes;
mod chains;
mod snapshots;
mod walk;

use glam::DVec3;

pub(crate) use axes::{AXES, AXIS_LENGTH, AxisPair};
pub(crate) use chains::ChainSearch;
use colltrans_kernel::topology::Topology;
use snapshots::CHAIN_THRESHOLD;
pub(crate) use snapshots::{AxisSections, SectionMap, Snapshot, Turn};
pub(crate) use walk::{next_clockwise, next_counter_clockwise};

/// The sections of one body across its four section axes. It is empty for a body of dimension below 3.
#[derive(Debug, Clone, Default)]
pub(crate) struct SectionIndex {
    axes: Vec<AxisSections>,
}

impl SectionIndex {
    /// Builds the sections of a body of dimension 3.
    pub(crate) fn build(vertices: &[DVec3], topology: &Topology) -> Self {
        let build = |&a| AxisSections::build(vertices, topology, a, CHAIN_THRESHOLD);
        Self { axes: AXES.iter().map(build).collect() }
    }

    /// Builds the sections of a body of dimension 3, with chains for any number of edges.
    #[cfg(test)]
    pub(crate) fn with_chains(vertices: &[DVec3], topology: &Topology) -> Self {
        let build = |&a| AxisSections::build(vertices, topology, a, 0.0);
        Self { axes: AXES.iter().map(build).collect() }
    }

    /// Returns the sections across axis `index` of [`AXES`].
    pub(crate) fn axis(&self, index: usize) -> &AxisSections {
        &self.axes[index]
    }

    /// Returns the number of bytes on the heap.
    pub(crate) fn heap_bytes(&self) -> usize {
        self.axes.capacity() * size_of::<AxisSections>()
            + self.axes.iter().map(AxisSections::heap_bytes).sum::<usize>()
    }
}
