//! One body as the planar problem sees it: levels and shadow coordinates.
//!
//! Notation. A point of the body has a *level* (`x` for the moving, `y` for the fixed body) and
//! shadow coordinates `w = (h, g)`; all three are affine in the body frame.

use std::cell::Cell;

use glam::{DVec2, DVec3};

use super::crossing::Chain;
use crate::body::convex::sections::{AxisSections, Search, SectionMap, Turn};
use colltrans_kernel::topology::Topology;

/// Levels that are this many mean edges apart are near (measured).
const NEAR: f64 = 4.0;

/// A mesh vertex: its level and its shadow.
#[derive(Debug, Clone, Copy)]
pub(super) struct Point {
    pub(super) level: f64,
    pub(super) shadow: DVec2,
}

/// A body with its section axis and shadow coordinates.
#[derive(Debug)]
pub(super) struct Side<'a> {
    pub(super) vertices: &'a [DVec3],
    pub(super) topology: &'a Topology,
    pub(super) sections: &'a AxisSections,
    axis: DVec3,
    pub(super) shadow: [DVec3; 2],
    constant: DVec2,
    /// Of the sections onto the shadow plane.
    pub(super) map: SectionMap,
    /// Levels closer than this are a few vertices apart, if these are spread evenly.
    pub(super) near: f64,
    /// The turn that leads up the left chain.
    left_turn: Turn,
    /// Iterations of the loops of planar problems so far: section vertices computed, mesh vertices
    /// climbed over, halvings of a snapshot.
    pub(super) iterations: Cell<u32>,
}

impl<'a> Side<'a> {
    /// The two covectors of the shadow are in the body frame, `constant` is the shadow of its
    /// origin. `along` is the axis' component along the direction.
    pub(super) fn new(
        (vertices, topology, sections): (&'a [DVec3], &'a Topology, &'a AxisSections),
        along: f64,
        shadow: [DVec3; 2],
        constant: DVec2,
    ) -> Self {
        Self {
            vertices,
            topology,
            near: NEAR * sections.of_an_edge,
            sections,
            axis: sections.axis,
            shadow,
            constant,
            map: sections.map(shadow, constant),
            // (level, h, g) is right-handed if the axis points along the direction; then
            // counter-clockwise leads from +h to +g, and from the bottom, at -h, to -g: up the left
            // chain.
            left_turn: if along > 0.0 { Turn::CounterClockwise } else { Turn::Clockwise },
            iterations: Cell::new(0),
        }
    }

    pub(super) fn count(&self, iterations: u32) {
        self.iterations.set(self.iterations.get() + iterations);
    }

    /// A search in the chains at a level, if the body has some.
    pub(super) fn search(&self, x: f64) -> Option<Search<'a, impl Fn(u32) -> f64, impl Fn(u32)>> {
        let chains = self.sections.chains()?;
        let topology = self.topology;
        Some(Search { chains, topology, x, level: |v| self.level(v), count: |n| self.count(n) })
    }

    /// Lowest and highest level.
    pub(super) fn range(&self) -> [f64; 2] {
        self.sections.range
    }

    /// No point of the body has a smaller `h`.
    pub(super) fn least_height(&self) -> f64 {
        let any = self.point(0).shadow.x;
        // The covector's length is at most the sum of its coordinates.
        any - self.shadow[0].abs().element_sum() * self.sections.diameter
    }

    pub(super) fn level(&self, vertex: u32) -> f64 {
        self.level_of(self.vertices[vertex as usize])
    }

    /// The level of a point of the body frame.
    pub(super) fn level_of(&self, point: DVec3) -> f64 {
        self.axis.dot(point)
    }

    /// The height of a point of the body frame.
    pub(super) fn height_of(&self, point: DVec3) -> f64 {
        self.shadow[0].dot(point) + self.constant.x
    }

    /// An edge at a vertex, by its half-edge upwards.
    pub(super) fn edge_at(&self, vertex: u32) -> u32 {
        let h = self.topology.outgoing(vertex)[0];
        let is_up = self.level(self.topology.target(h)) > self.level(vertex);
        if is_up { h } else { self.topology.half_edge(h).twin }
    }

    #[inline]
    pub(super) fn point(&self, vertex: u32) -> Point {
        let v = self.vertices[vertex as usize];
        Point {
            level: self.axis.dot(v),
            shadow: DVec2::new(self.shadow[0].dot(v), self.shadow[1].dot(v)) + self.constant,
        }
    }

    pub(super) fn turn_up(&self, chain: Chain) -> Turn {
        match chain {
            Chain::Left => self.left_turn,
            Chain::Right => self.left_turn.reversed(),
        }
    }
}
