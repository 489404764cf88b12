//! Cells of displacements of one body against another: cubes of an octree along three axes.
//!
//! A cell contains the displacements `t = x u + y v + z w` with `x, y, z` between two corners. The axes `u`,
//! `v` and `w` follow the walls. They only have to be independent, so that `t` and `(x, y, z)` correspond one
//! to one.
//!
//! `A` is displaced by `t`, `B` is fixed. If an edge `p q` of one body passes through a facet `g` of the
//! other, points of the edge directly behind `g` are inside both bodies. The edge passes through `g` if its
//! ends are strictly on different sides of the plane of `g`, and `s_k = (q - p) . ((g_k - p) x (g_k+1 - p))`
//! has the same sign for `k = 0, 1, 2`. Each of these values is linear in `t`. Therefore one edge and one
//! facet can block a whole cell, including its boundary. Rounding errors are less than `4096 u S^3 + 1024 h
//! S^2`: `docs/theory/displacement-cells.md`.

use glam::{DMat3, DVec3};

use crate::directions::Bodies;

/// Cell of an octree. Its side is that of the octree, halved `depth` times.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct DisplacementCell {
    /// Number of halvings.
    pub depth: u32,
    /// Position in multiples of its side, from the lowest corner of the octree.
    pub at: [u32; 3],
}

/// Maximum number of halvings.
pub(super) const MAX_DEPTH: u32 = 20;

impl DisplacementCell {
    pub(super) const ALL: Self = Self { depth: 0, at: [0; 3] };

    pub(super) fn children(self) -> [Self; 8] {
        let depth = self.depth + 1;
        std::array::from_fn(|k| {
            let at = std::array::from_fn(|axis| 2 * self.at[axis] + (k as u32 >> axis & 1));
            Self { depth, at }
        })
    }

    pub(super) fn parent(self) -> Option<Self> {
        Some(Self { depth: self.depth.checked_sub(1)?, at: self.at.map(|x| x / 2) })
    }

    /// Returns the cell of the same size adjacent to a side. Returns `None` outside the octree.
    pub(super) fn neighbour(self, (axis, upper): CellSide) -> Option<Self> {
        let mut at = self.at;
        at[axis] = if upper { at[axis] + 1 } else { at[axis].checked_sub(1)? };
        (at[axis] < 1 << self.depth).then_some(Self { at, ..self })
    }

    /// Returns the distance from the boundary of the octree, in sides of the smallest cells.
    pub(super) fn boundary_distance(self) -> u32 {
        let last = (1 << self.depth) - 1;
        let nearest = self.at.iter().map(|&x| x.min(last - x)).min().unwrap_or(0);
        nearest << (MAX_DEPTH - self.depth)
    }

    /// Returns the children that touch a side.
    pub(super) fn children_at(self, (axis, upper): CellSide) -> impl Iterator<Item = Self> {
        let touches = move |part: &Self| (part.at[axis] & 1 == 1) == upper;
        self.children().into_iter().filter(touches)
    }
}

/// Axis, and whether its upper side.
pub(super) type CellSide = (usize, bool);

pub(super) const SIDES: [CellSide; 6] =
    [(0, false), (0, true), (1, false), (1, true), (2, false), (2, true)];

/// Frame of the octree.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct DisplacementGrid {
    /// Lowest corner of the octree, in multiples of the axes.
    pub low: DVec3,
    /// Side of the octree, in multiples of the axes.
    pub side: f64,
    /// Axes as columns, of length 1 up to rounding. They need not be orthogonal.
    pub axes: DMat3,
}

impl DisplacementGrid {
    /// Returns an octree around the initial placement. The placement is not on the boundary of a cell.
    pub(super) fn around_origin(reach: f64, axes: DMat3) -> Self {
        let low = DVec3::splat(-reach) + reach * DVec3::new(0.17, 0.23, 0.29) / 3.0;
        Self { low, side: 2.0 * reach, axes }
    }

    /// Checks whether the frame is finite, and its axes have length 1 and are independent.
    pub(super) fn is_valid(&self) -> bool {
        let Self { low, side, axes } = self;
        low.is_finite() && side.is_finite() && *side > 0.0 && are_independent(*axes)
    }

    /// Returns the corners of a cell, in multiples of the axes. The product of a power of two and a side is
    /// exact, therefore adjacent cells have the same corners.
    pub fn corners(&self, cell: DisplacementCell) -> [DVec3; 2] {
        let side = self.side / f64::from(1_u32 << cell.depth.min(31));
        let corner = |by: u32| self.low + DVec3::from(cell.at.map(|x| f64::from(x + by))) * side;
        [corner(0), corner(1)]
    }

    /// Returns the displacements in a cell.
    pub(super) fn displacements(&self, cell: DisplacementCell) -> DisplacementRange {
        let [low, high] = self.corners(cell);
        let half = (high - low) / 2.0;
        let axes = self.axes;
        DisplacementRange {
            middle: axes * ((low + high) / 2.0),
            half: [axes.x_axis * half.x, axes.y_axis * half.y, axes.z_axis * half.z],
        }
    }
}

/// Checks whether three columns have length 1, up to rounding, and a determinant of absolute value at least
/// 0.5.
pub(super) fn are_independent(axes: DMat3) -> bool {
    let columns = [axes.x_axis, axes.y_axis, axes.z_axis];
    columns.iter().all(|axis| (axis.length() - 1.0).abs() < 1e-9) && axes.determinant().abs() >= 0.5
}

/// Parallelepiped of displacements: its center and three half edges.
#[derive(Debug, Clone, Copy)]
pub(super) struct DisplacementRange {
    pub(super) middle: DVec3,
    half: [DVec3; 3],
}

impl DisplacementRange {
    /// Returns the half width of the scalar product with a vector.
    pub(super) fn half_width(&self, along: DVec3) -> f64 {
        self.half.iter().map(|half| along.dot(*half).abs()).sum()
    }

    /// Returns the opposite displacements: those of the other body against this one.
    fn opposite(&self) -> Self {
        Self { middle: DVec3::ZERO - self.middle, half: self.half }
    }
}

/// Edge of one body that passes through a facet of the other one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Crossing {
    /// Whether the edge belongs to the moving body and the facet to the fixed one.
    pub moving: bool,
    /// Triangle with the edge, and the number of the corner at which the edge starts.
    pub edge: (u32, u8),
    /// Triangle that the edge passes through.
    pub facet: u32,
}

/// Two bodies with bounds on their displaced coordinates.
pub(super) struct DisplacedBodies<'a> {
    pub(super) bodies: Bodies<'a>,
    /// Upper bound on the absolute value of a coordinate, displaced or not.
    size: f64,
    /// Upper bound on the error of a coordinate of a vertex.
    noise: f64,
}

impl<'a> DisplacedBodies<'a> {
    pub(super) fn new(bodies: Bodies<'a>, room: DisplacementGrid) -> Self {
        let [reach, noise] = bodies.coordinate_bound();
        let DisplacementGrid { low, side, axes } = room;
        let rows = axes.x_axis.abs() + axes.y_axis.abs() + axes.z_axis.abs();
        let displaced = 1.001 * rows.max_element() * (low.abs().max_element() + side);
        Self { bodies, size: reach + displaced, noise }
    }

    /// Returns the corners of a triangle.
    pub(super) fn triangle_corners(&self, moving: bool, triangle: u32) -> [DVec3; 3] {
        self.bodies
            .triangle_vertices(moving, triangle)
            .map(|vertex| self.bodies.placed_vertex(vertex).at)
    }

    /// Checks whether an edge passes through a facet for all displacements of a cell. Returns `false` if the
    /// edge or the facet does not exist.
    pub(super) fn crossing_blocks(&self, crossing: Crossing, by: &DisplacementRange) -> bool {
        let Crossing { moving, edge: (triangle, first), facet } = crossing;
        let counts = [moving, !moving].map(|moving| self.bodies.triangle_count(moving));
        if triangle >= counts[0] || facet >= counts[1] || first > 2 {
            return false;
        }
        let own = self.triangle_corners(moving, triangle);
        let g = self.triangle_corners(!moving, facet);
        // Displacing the fixed body's edge against the facet is the opposite displacement.
        let by = if moving { *by } else { by.opposite() };
        let ends = [own[usize::from(first)], own[(usize::from(first) + 1) % 3]];
        self.edge_passes(ends, g, &by)
    }

    /// Checks whether an edge, displaced by any displacement of a cell, passes through a facet.
    fn edge_passes(&self, [p, q]: [DVec3; 2], g: [DVec3; 3], by: &DisplacementRange) -> bool {
        const U: f64 = f64::EPSILON / 2.0;
        let size = self.size;
        let error = 4096.0 * U * size.powi(3) + 1024.0 * self.noise * size.powi(2);
        // The sign for all displacements of the cell, or 0.
        let sign = |value: f64, slope: DVec3| {
            let width = by.half_width(slope) + error;
            if value > width {
                1
            } else if value < -width {
                -1
            } else {
                0
            }
        };
        let (p, q) = (p + by.middle, q + by.middle);
        let normal = (g[1] - g[0]).cross(g[2] - g[0]);
        let [from, to] = [p, q].map(|end| sign(normal.dot(end - g[0]), normal));
        if from * to != -1 {
            return false;
        }
        let edge = q - p;
        let sides = [0, 1, 2].map(|k| {
            let (a, b) = (g[k], g[(k + 1) % 3]);
            sign(edge.dot((a - p).cross(b - p)), (a - b).cross(edge))
        });
        sides == [1; 3] || sides == [-1; 3]
    }
}
