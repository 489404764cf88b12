//! Boxes with cut corners and edges: a polytope with 26 sides around facets (Klosowski et al., "Efficient collision
//! detection using bounding volume hierarchies of k-DOPs", IEEE TVCG 4(1), 1998).
//!
//! - A corner of a box is named by its signs `s = (+-1, +-1, +-1)`, an edge by signs of which one is 0.
//! - The *depth* of a corner or edge is the difference of the support values of the box and of the facets along `s`.
//!   It is stored as a share of the extent of the box along `s`, in steps of `1/256`, rounded down.
//! - A normal with `|n_i| >= |n_j| >= |n_k|` is a sum of `|n_i| - |n_j|` times an axis, `|n_j| - |n_k|` times an edge
//!   and `|n_k|` times a corner. Therefore the support value of the facets along the normal is at most that of the
//!   box, minus the depths of this edge and corner times their weights. Derivation: `docs/theory/solid-bounds.md`.

use colltrans_convex::body::Aabb;
use glam::{BVec3, DVec3};

/// Number of cuts: eight corners, and four edges along each axis.
pub(crate) const CUTS: usize = 20;
/// Number of steps of a share.
const SHARE_STEPS: f64 = 256.0;
/// Factor of shares. It covers the rounding errors of their computation and use, but not those of coordinates, which
/// callers add.
const SHARE_ROUNDING: f64 = 1.0 - 1e-9;

/// Maxima of points along the signs of all corners and edges.
#[derive(Debug, Clone, Copy)]
pub(super) struct SignMaxima([f64; CUTS]);

impl SignMaxima {
    pub(super) const NONE: Self = Self([f64::NEG_INFINITY; CUTS]);

    pub(super) fn add(&mut self, p: DVec3) {
        let DVec3 { x, y, z } = p;
        let along = [x + y + z, -x + y + z, x - y + z, -x - y + z];
        for (k, h) in along.into_iter().enumerate() {
            self.raise_to(k, h);
            self.raise_to(7 - k, -h);
        }
        for (axis, [a, b]) in [[y, z], [z, x], [x, y]].into_iter().enumerate() {
            let first = 8 + 4 * axis;
            for (k, h) in [a + b, b - a].into_iter().enumerate() {
                self.raise_to(first + k, h);
                self.raise_to(first + 3 - k, -h);
            }
        }
    }

    pub(super) fn include_maxima(&mut self, other: &Self) {
        for (k, h) in other.0.into_iter().enumerate() {
            self.raise_to(k, h);
        }
    }

    fn raise_to(&mut self, k: usize, height: f64) {
        if height > self.0[k] {
            self.0[k] = height;
        }
    }

    /// Returns the depths of points below the corners and edges of their box, as shares in steps.
    pub(super) fn depth_shares(&self, bounds: &Aabb) -> [u8; CUTS] {
        let sums = extents_along_signs(bounds.side_lengths());
        let mut ends = Self::NONE;
        for c in 0..8 {
            let lower = BVec3::new(c & 1 != 0, c & 2 != 0, c & 4 != 0);
            ends.add(DVec3::select(lower, bounds.low, bounds.high));
        }
        std::array::from_fn(|k| {
            let depth = ends.0[k] - self.0[k];
            // The conversion saturates, and yields 0 if the box has no extent (a quotient that is not a number).
            (depth / sums[k] * (SHARE_STEPS * SHARE_ROUNDING)) as u8
        })
    }
}

/// Returns the extents of a box along the signs of corners and edges.
fn extents_along_signs(e: DVec3) -> [f64; CUTS] {
    let mut sums = [e.element_sum(); CUTS];
    for axis in 0..3 {
        sums[8 + 4 * axis..12 + 4 * axis].fill(e[(axis + 1) % 3] + e[(axis + 2) % 3]);
    }
    sums
}

/// Depths of all corners and edges. The length 32 makes bounds checks of 5-bit indices unnecessary.
pub(crate) type Depths = [f64; 32];

/// Computes the depth of a corner or edge after facets have moved by at most `moved`; at least 0. `cut` is the share,
/// in steps, and `step` the length of one step.
///
/// The depth decreases by at most 5 times `moved`: a corner of the box moves by at most 3 times that distance along its
/// signs, and the facets below it by at most `sqrt(3)` times.
#[inline]
fn reduced_depth(cut: f64, step: f64, moved: f64) -> f64 {
    let rest = step * cut - 5.0 * moved;
    if rest > 0.0 { rest } else { 0.0 }
}

/// Returns all depths of a box with the side lengths `size`, after its facets have moved by at most `moved`.
#[inline]
pub(crate) fn depth_table(cuts: &[u8; CUTS], size: DVec3, moved: f64) -> Depths {
    let extents = extents_along_signs(size * SHARE_STEPS.recip());
    let shares = cuts.map(f64::from);
    let mut depths = [0.0; 32];
    for k in 0..CUTS {
        depths[k] = reduced_depth(shares[k], extents[k], moved);
    }
    depths
}

/// A normal as a sum of an axis, an edge and a corner, as defined in the head of the module.
#[derive(Debug, Clone, Copy)]
pub(crate) struct NormalDecomposition {
    corner: u8,
    edge: u8,
    /// Weights of the corner and of the edge.
    weights: [f64; 2],
}

impl NormalDecomposition {
    #[inline]
    pub(crate) fn new(n: DVec3) -> Self {
        // Without branches, because they would be mispredicted.
        let DVec3 { x, y, z } = n.abs();
        let lower = |a: f64, b: f64| if a < b { a } else { b };
        let upper = |a: f64, b: f64| if a < b { b } else { a };
        let (low, high) = (lower(x, y), upper(x, y));
        let (least, second) = (lower(low, z), lower(high, upper(low, z)));
        let axis = if z < low { 2 } else { u32::from(y < x) };
        // The bits of a corner are its negative signs. Those of an edge belong to the two other axes, in cyclic
        // order.
        let corner = n.is_negative_bitmask();
        let edge = 8 + 4 * axis + ((corner | corner << 3) >> (axis + 1) & 3);
        Self { corner: corner as u8, edge: edge as u8, weights: [least, second - least] }
    }

    /// Returns the amount by which the depths lower the support value of the box along the normal.
    #[inline]
    pub(crate) fn support_reduction(&self, depths: &Depths) -> f64 {
        let [w, v] = self.weights;
        w * depths[usize::from(self.corner & 31)] + v * depths[usize::from(self.edge & 31)]
    }

    /// Returns the part of [`Self::support_reduction`] that the edge contributes.
    #[inline]
    pub(crate) fn edge_support_reduction(&self, depths: &Depths) -> f64 {
        self.weights[1] * depths[usize::from(self.edge & 31)]
    }

    /// Returns [`Self::support_reduction`] for the cuts of a node, with the parameters of [`depth_table`], without
    /// computing a table.
    #[inline]
    pub(crate) fn support_reduction_by_cuts(
        &self,
        cuts: &[u8; CUTS],
        size: DVec3,
        moved: f64,
    ) -> f64 {
        let [w, v] = self.weights;
        let (corner, edge) = (usize::from(self.corner), usize::from(self.edge));
        let all = size.element_sum();
        let of = |k: usize, extent: f64| {
            reduced_depth(f64::from(cuts[k]), extent * SHARE_STEPS.recip(), moved)
        };
        w * of(corner, all) + v * of(edge, all - size[(edge - 8) / 4])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_stay_inside_box_with_cuts() {
        // Points of a tilted ring. It touches the sides of its box, and not the corners.
        let points: Vec<DVec3> = (0..60)
            .map(|k| {
                let (s, c) = (0.1 * f64::from(k)).sin_cos();
                DVec3::new(3.0 * c, 2.0 * s - c, 0.5 * s + 1.5 * c)
            })
            .collect();
        let bounds = Aabb::from_points(points.iter().copied());
        let Aabb { low, high } = bounds;
        let mut reach = SignMaxima::NONE;
        for p in &points {
            reach.add(*p);
        }
        let cuts = reach.depth_shares(&bounds);
        assert!(cuts.iter().any(|&c| c > 64));
        let depths = depth_table(&cuts, high - low, 0.0);
        let mut gained = 0.0;
        for k in 0..400 {
            let (a, b) = (0.37 * f64::from(k), 0.11 * f64::from(k));
            let n = DVec3::new(a.cos() * b.sin(), a.sin() * b.sin(), b.cos());
            for n in [n, -n] {
                let gain = NormalDecomposition::new(n).support_reduction(&depths);
                let end = n.dot(DVec3::select(n.cmpgt(DVec3::ZERO), high, low));
                let farthest = points.iter().map(|p| n.dot(*p)).fold(f64::NEG_INFINITY, f64::max);
                assert!(farthest <= end - gain + 1e-12, "{n}: {farthest} {end} {gain}");
                gained += gain;
            }
        }
        assert!(gained > 100.0, "{gained}");
    }
}
