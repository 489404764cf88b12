//! A body in section coordinates.
//!
//! Each point of the body has a *level* (`x` for the moving, `y` for the fixed body) and shadow coordinates
//! `w = (h, g)`. All three are affine functions in the body frame.

use std::cell::Cell;

use glam::{DVec2, DVec3};

use super::crossing::Chain;
use crate::body::convex::sections::{AxisSections, ChainSearch, SectionMap, Turn};
use colltrans_kernel::topology::Topology;

/// Distance between two levels that count as near, in mean edges (measured).
const NEAR_EDGES: f64 = 4.0;

/// Level and shadow coordinates of a mesh vertex.
#[derive(Debug, Clone, Copy)]
pub(super) struct LevelPoint {
    pub(super) level: f64,
    pub(super) shadow: DVec2,
}

/// A body with its section axis and shadow coordinates.
#[derive(Debug)]
pub(super) struct SectionedBody<'a> {
    pub(super) vertices: &'a [DVec3],
    pub(super) topology: &'a Topology,
    pub(super) sections: &'a AxisSections,
    axis: DVec3,
    /// Covectors of `h` and `g` in the body frame.
    pub(super) shadow: [DVec3; 2],
    constant: DVec2,
    /// Map of the stored sections onto the shadow plane.
    pub(super) section_map: SectionMap,
    /// Distance of levels below which they are a few vertices apart, if the vertices are spread evenly.
    pub(super) near_distance: f64,
    /// Turn that leads up the left chain.
    left_turn: Turn,
    /// Number of iterations in the loops of planar problems: section vertices computed, mesh vertices climbed
    /// over, bisections of a snapshot.
    pub(super) iterations: Cell<u32>,
}

impl<'a> SectionedBody<'a> {
    /// Builds the section coordinates. The covectors `shadow` are in the body frame, `constant` is the shadow
    /// of its origin. `along` is the component of the section axis along the direction.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "a copy through memory")]
    pub(super) fn new(
        (vertices, topology, sections): (&'a [DVec3], &'a Topology, &'a AxisSections),
        along: f64,
        shadow: [DVec3; 2],
        constant: DVec2,
    ) -> Self {
        Self {
            vertices,
            topology,
            near_distance: NEAR_EDGES * sections.mean_edge_range,
            sections,
            axis: sections.axis,
            shadow,
            constant,
            section_map: sections.map(shadow, constant),
            // (level, h, g) is right-handed if the axis points along the direction. Then the counter-clockwise
            // sense leads from +h to +g, and from the bottom, at -h, to -g: up the left chain.
            left_turn: if along > 0.0 { Turn::CounterClockwise } else { Turn::Clockwise },
            iterations: Cell::new(0),
        }
    }

    pub(super) fn count_iterations(&self, iterations: u32) {
        self.iterations.set(self.iterations.get() + iterations);
    }

    /// Returns a search in the chains at level `x`. `None` if the body has no chains.
    pub(super) fn chain_search(
        &self,
        x: f64,
    ) -> Option<ChainSearch<'a, impl Fn(u32) -> f64, impl Fn(u32)>> {
        let chains = self.sections.chains()?;
        let topology = self.topology;
        Some(ChainSearch {
            chains,
            topology,
            x,
            level: |v| self.vertex_level(v),
            count: |n| self.count_iterations(n),
        })
    }

    /// Returns the lowest and the highest level.
    pub(super) fn level_range(&self) -> [f64; 2] {
        self.sections.range
    }

    /// Returns a lower bound of `h` over the body.
    pub(super) fn height_lower_bound(&self) -> f64 {
        let any = self.level_point(0).shadow.x;
        // The sum of its coordinates bounds the length of the covector.
        any - self.shadow[0].abs().element_sum() * self.sections.diameter
    }

    pub(super) fn vertex_level(&self, vertex: u32) -> f64 {
        self.point_level(self.vertices[vertex as usize])
    }

    /// Returns the level of a point of the body frame.
    pub(super) fn point_level(&self, point: DVec3) -> f64 {
        self.axis.dot(point)
    }

    /// Returns the height of a point of the body frame.
    pub(super) fn point_height(&self, point: DVec3) -> f64 {
        self.shadow[0].dot(point) + self.constant.x
    }

    /// Returns a half-edge upwards of some edge at a vertex.
    pub(super) fn upward_edge_at(&self, vertex: u32) -> u32 {
        let h = self.topology.outgoing_half_edges(vertex)[0];
        let is_up = self.vertex_level(self.topology.target(h)) > self.vertex_level(vertex);
        if is_up { h } else { self.topology.half_edge(h).twin }
    }

    /// Returns the level and the shadow coordinates of a vertex.
    #[inline]
    pub(super) fn level_point(&self, vertex: u32) -> LevelPoint {
        let v = self.vertices[vertex as usize];
        LevelPoint {
            level: self.axis.dot(v),
            shadow: DVec2::new(self.shadow[0].dot(v), self.shadow[1].dot(v)) + self.constant,
        }
    }

    /// Returns the turn that leads up a chain.
    pub(super) fn turn_up_chain(&self, chain: Chain) -> Turn {
        match chain {
            Chain::Left => self.left_turn,
            Chain::Right => self.left_turn.reversed(),
        }
    }
}
