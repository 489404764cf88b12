//! Displacements of one body against another, in cells: parts of an octree, cubes along axes that may be any three.
//!
//! A cell is where `x, y, z` are between two corners, and the displacements in it are `t = x u + y v + z w`. The axes `u`,
//! `v` and `w` are those that walls have, so that cells lie along them. Nothing but that they are independent is asked of them:
//! displacements and `(x, y, z)` then are one to one, and cells lie side by side in space as they do in the octree.
//!
//! `A` is displaced by `t`, `B` is fixed. An edge `p q` of one of them that passes through a facet `g` of the other from
//! front to back has points of its body right behind `g`, inside of the other: **they overlap**. With the facet's
//! normal `n`, both ends strictly on either side of its plane and
//!
//! ```text
//! s_k = (q - p) . ((g_k - p) x (g_k+1 - p)),   k = 0, 1, 2, all of one sign
//! ```
//!
//! say so. Each is linear in `t`, so its range over a cell is its value at the middle and a half width: one edge and
//! one facet block a whole cell, borders included.
//!
//! *Rounding.* Coordinates are at most `S` and off by at most `h` (what shrinking leaves of exactness), and so is `t`, but
//! for its own `4 u S`; differences of three of them are at most `3 S` and off by `8 u S + 3 h`. A product of three is
//! off by `3 . 9 S^2 (8 u S + 3 h)` and its own two roundings, a sum of six of them by `2430 u S^3 + 486 h S^2`. The slope's
//! components are at most `18 S^2` and off by `132 u S^2 + 36 h S`, half a cell is at most `S / 2`: all that and the range
//! come to less than `4096 u S^3 + 1024 h S^2`.

use glam::{DMat3, DVec3};

use crate::free::Bodies;

/// A cell: its side is that of all cells, halved `depth` times.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RoomCell {
    /// How often the sides are halved.
    pub depth: u32,
    /// Its place, in multiples of its side from the lowest corner.
    pub at: [u32; 3],
}

/// Sides are halved no more often.
pub(super) const DEEPEST: u32 = 20;

impl RoomCell {
    pub(super) const ALL: Self = Self { depth: 0, at: [0; 3] };

    pub(super) fn parts(self) -> [Self; 8] {
        let depth = self.depth + 1;
        std::array::from_fn(|k| {
            let at = std::array::from_fn(|axis| 2 * self.at[axis] + (k as u32 >> axis & 1));
            Self { depth, at }
        })
    }

    pub(super) fn parent(self) -> Option<Self> {
        Some(Self { depth: self.depth.checked_sub(1)?, at: self.at.map(|x| x / 2) })
    }

    /// The cell of the same size on a side (the lower one of an axis, or the upper one), if it is one of all.
    pub(super) fn beside(self, (axis, upper): Side) -> Option<Self> {
        let mut at = self.at;
        at[axis] = if upper { at[axis] + 1 } else { at[axis].checked_sub(1)? };
        (at[axis] < 1 << self.depth).then_some(Self { at, ..self })
    }

    /// How far it is from the border of all cells, in sides of the smallest.
    pub(super) fn to_border(self) -> u32 {
        let last = (1 << self.depth) - 1;
        let nearest = self.at.iter().map(|&x| x.min(last - x)).min().unwrap_or(0);
        nearest << (DEEPEST - self.depth)
    }

    /// The parts that touch a side.
    pub(super) fn parts_at(self, (axis, upper): Side) -> impl Iterator<Item = Self> {
        let touches = move |part: &Self| (part.at[axis] & 1 == 1) == upper;
        self.parts().into_iter().filter(touches)
    }
}

/// An axis, and whether the upper end of it.
pub(super) type Side = (usize, bool);

pub(super) const SIDES: [Side; 6] =
    [(0, false), (0, true), (1, false), (1, true), (2, false), (2, true)];

/// Where cells are.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Room {
    /// The lowest corner of all cells, in multiples of the axes.
    pub low: DVec3,
    /// The side of all of them together, in multiples of the axes.
    pub side: f64,
    /// The axes, of length 1 but for rounding, as columns. They need not be orthogonal.
    pub axes: DMat3,
}

impl Room {
    /// So much around the place where a body is, which is on no border of a cell.
    pub(super) fn around(reach: f64, axes: DMat3) -> Self {
        let low = DVec3::splat(-reach) + reach * DVec3::new(0.17, 0.23, 0.29) / 3.0;
        Self { low, side: 2.0 * reach, axes }
    }

    /// Whether it is finite and its axes are as long as they should be and independent.
    pub(super) fn is_proper(&self) -> bool {
        let Self { low, side, axes } = self;
        low.is_finite() && side.is_finite() && *side > 0.0 && are_independent(*axes)
    }

    /// The corners of a cell, in multiples of the axes. A power of two times a side is exact, so cells that touch have
    /// the same ones.
    pub fn corners(&self, cell: RoomCell) -> [DVec3; 2] {
        let side = self.side / f64::from(1_u32 << cell.depth.min(31));
        let corner = |by: u32| self.low + DVec3::from(cell.at.map(|x| f64::from(x + by))) * side;
        [corner(0), corner(1)]
    }

    /// The displacements in a cell.
    pub(super) fn displacements(&self, cell: RoomCell) -> Displacements {
        let [low, high] = self.corners(cell);
        let half = (high - low) / 2.0;
        let axes = self.axes;
        Displacements {
            middle: axes * ((low + high) / 2.0),
            half: [axes.x_axis * half.x, axes.y_axis * half.y, axes.z_axis * half.z],
        }
    }
}

/// Whether three columns are of length 1, but for rounding, and far from lying in one plane.
pub(super) fn are_independent(axes: DMat3) -> bool {
    let columns = [axes.x_axis, axes.y_axis, axes.z_axis];
    columns.iter().all(|axis| (axis.length() - 1.0).abs() < 1e-9) && axes.determinant().abs() >= 0.5
}

/// A middle, and as far to either side as three vectors lead.
#[derive(Debug, Clone, Copy)]
pub(super) struct Displacements {
    pub(super) middle: DVec3,
    half: [DVec3; 3],
}

impl Displacements {
    /// How far the product with a vector goes to either side of that of the middle.
    pub(super) fn width(&self, along: DVec3) -> f64 {
        self.half.iter().map(|half| along.dot(*half).abs()).sum()
    }

    /// The other body's against this one.
    fn turned(&self) -> Self {
        Self { middle: DVec3::ZERO - self.middle, half: self.half }
    }
}

/// An edge of one body that passes through a facet of the other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Crossing {
    /// Whether the edge is the moving body's, and the facet the fixed one's.
    pub moving: bool,
    /// The triangle whose edge it is, and which: from its corner of this number to the next.
    pub edge: (u32, u8),
    /// The triangle it passes through.
    pub facet: u32,
}

/// Two bodies, ready to be looked at.
pub(super) struct Displaced<'a> {
    pub(super) bodies: Bodies<'a>,
    /// No coordinate is larger, displaced or not.
    size: f64,
    /// How far corners may be from where they are.
    noise: f64,
}

impl<'a> Displaced<'a> {
    pub(super) fn new(bodies: Bodies<'a>, room: Room) -> Self {
        let [reach, noise] = bodies.reach();
        let Room { low, side, axes } = room;
        let rows = axes.x_axis.abs() + axes.y_axis.abs() + axes.z_axis.abs();
        let displaced = 1.001 * rows.max_element() * (low.abs().max_element() + side);
        Self { bodies, size: reach + displaced, noise }
    }

    /// The corners of a triangle.
    pub(super) fn triangle(&self, moving: bool, triangle: u32) -> [DVec3; 3] {
        self.bodies.spots(moving, triangle).map(|spot| self.bodies.corner(spot).at)
    }

    /// Whether an edge passes through a facet in all of a cell; false for numbers of none.
    pub(super) fn blocks(&self, crossing: Crossing, by: &Displacements) -> bool {
        let Crossing { moving, edge: (triangle, first), facet } = crossing;
        let counts = [moving, !moving].map(|moving| self.bodies.count(moving));
        if triangle >= counts[0] || facet >= counts[1] || first > 2 {
            return false;
        }
        let own = self.triangle(moving, triangle);
        let g = self.triangle(!moving, facet);
        // Of the moving body's edge against the facet; or of the facet, which moves, against the edge.
        let by = if moving { *by } else { by.turned() };
        let ends = [own[usize::from(first)], own[(usize::from(first) + 1) % 3]];
        self.passes(ends, g, &by)
    }

    /// Whether an edge, displaced by whatever is in a cell, passes through a facet.
    fn passes(&self, [p, q]: [DVec3; 2], g: [DVec3; 3], by: &Displacements) -> bool {
        const U: f64 = f64::EPSILON / 2.0;
        let size = self.size;
        let error = 4096.0 * U * size.powi(3) + 1024.0 * self.noise * size.powi(2);
        // The sign all over the cell, 0 if there is none.
        let sign = |value: f64, slope: DVec3| {
            let width = by.width(slope) + error;
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
