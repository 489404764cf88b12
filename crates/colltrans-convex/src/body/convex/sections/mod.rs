//! Planar sections of a polyhedron across fixed axes: `O(n)` space, logarithmic access (the paper,
//! section III). Made when the paper's algorithm first asks: portal refinement does without. The paper's
//! *drums*, parts of a body between two levels where the section's edges change, are not built:
//! *snapshots*, all crossings of one level, and walks from them take their place.
//!
//! Notation. `level(v) = a . v` for a section axis `a` of the body frame. The section at level `x`
//! is the convex polygon in which the plane `a . v = x` cuts the body; each of its vertices lies on
//! a mesh edge that *crosses* the level.
//!
//! Tie rule, used by every function here: a mesh vertex is *above* if its level is `> x`, else
//! *below*. So a section is the one just above level `x`, it never passes through a mesh vertex,
//! and it exists for `min <= x < max`. A crossing edge is named by its half-edge that runs upwards.
//! Counter-clockwise is meant as seen from the tip of the axis.

mod axes;
mod chains;
mod snapshots;
mod walk;

use glam::DVec3;

pub(crate) use axes::{AXES, AXIS_LENGTH, AxisPair};
pub(crate) use chains::Search;
use colltrans_kernel::topology::Topology;
use snapshots::CHAIN_THRESHOLD;
pub(crate) use snapshots::{AxisSections, SectionMap, Snapshot, Turn};
pub(crate) use walk::{next_clockwise, next_counter_clockwise};

/// The sections of one body across its four section axes; empty for a body of dimension below 3.
#[derive(Debug, Clone, Default)]
pub(crate) struct SectionIndex {
    axes: Vec<AxisSections>,
}

impl SectionIndex {
    /// For the vertices of a body of dimension 3 and its topology.
    pub(crate) fn build(vertices: &[DVec3], topology: &Topology) -> Self {
        let build = |&a| AxisSections::build(vertices, topology, a, CHAIN_THRESHOLD);
        Self { axes: AXES.iter().map(build).collect() }
    }

    /// The same, with chains however few edges sections have.
    #[cfg(test)]
    pub(crate) fn with_chains(vertices: &[DVec3], topology: &Topology) -> Self {
        let build = |&a| AxisSections::build(vertices, topology, a, 0.0);
        Self { axes: AXES.iter().map(build).collect() }
    }

    /// The sections across axis `index` of [`AXES`].
    pub(crate) fn axis(&self, index: usize) -> &AxisSections {
        &self.axes[index]
    }

    /// Bytes on the heap.
    pub(crate) fn heap_bytes(&self) -> usize {
        self.axes.capacity() * size_of::<AxisSections>()
            + self.axes.iter().map(AxisSections::heap_bytes).sum::<usize>()
    }
}
