//! Directions along which a query compares nodes: separating axes of boxes that move.
//!
//! - A plane with a normal `n`, `n.d = 1`, bounds the gap `h_b - h_a` of a set `a` of the moving body and a set `b` of
//!   the fixed body. The gap is at least the least `n.x` of `b` minus the largest `n.x` of `a`.
//! - The best plane between two boxes is one of 15: its normal is an axis of a box, or orthogonal to an axis of each.
//!   All boxes of one body have the same axes. Therefore the extent of a node along each normal is computed once, and a
//!   pair of nodes needs fifteen sums. The 16th normal is the direction.
//! - Shadows of boxes are disjoint if they are disjoint across the shadow of one of the six axes, `n.d = 0`
//!   (Gottschalk, Lin and Manocha, "`OBBTree`: a hierarchical structure for rapid interference detection", SIGGRAPH
//!   1996, for boxes that do not move).
//! - Cuts make a node smaller than its box. Its extent is measured along `n` for the moving body and along `-n` for the
//!   fixed one. A negative sum of both proves a separation by its absolute value. Rounding:
//!   `docs/theory/solid-rounding.md`.

use glam::{DVec2, DVec3, Vec3Swizzles};

use super::projected::Projected;
use super::scene::{PairFrame, PlacedBody};
use crate::body::cuts::{Depths, NormalDecomposition, depth_table};
use colltrans_convex::body::Aabb;

/// Number of normals that are orthogonal to an axis of each box.
const EDGES: usize = 9;
/// Position of the first axis of the moving and the fixed body among the normals; the direction precedes them.
const AXES: [usize; 2] = [EDGES + 1, EDGES + 4];
/// Number of normals of planes that bound gaps.
const NORMALS: usize = 16;
/// Position of the lines across the shadows of the axes, for the moving and the fixed body. Each line counts as two
/// opposite directions.
const LINES: [usize; 2] = [NORMALS, NORMALS + 3];
/// Number of directions without the reversed lines.
const SHARED: usize = NORMALS + 6;
/// Number of directions with the reversed lines.
const ALL: usize = NORMALS + 12;
/// Cosine to the direction below which planes are too steep to be useful.
const STEEP: f64 = 1.0 / 1024.0;
/// Sine below which two axes count as parallel.
const PARALLEL: f64 = 1e-6;

/// The directions of a query, in the frames of the moving and the fixed body.
pub(crate) struct SeparatingAxes([BodyAxes; 2]);

/// Directions in a body's frame, stored by coordinate.
struct BodyAxes {
    /// Coordinates of the directions. They multiply the centres of boxes, and their absolute values half the extents.
    local: [[f64; SHARED]; 3],
    /// Translation of the body along each direction.
    offset: [f64; SHARED],
    /// Bound on rounding errors along each direction, plus the enlargement of the body.
    slack: [f64; SHARED],
    /// The cuts along each direction and their weights.
    parts: [NormalDecomposition; ALL],
    /// Position of the first axis of the other body.
    others: usize,
    /// Positions of the lines across the shadows of its own axes, and of the other body's.
    lines: [usize; 2],
}

impl BodyAxes {
    fn new(side: &PlacedBody, all: &[DVec3; SHARED], noise: f64) -> Self {
        let turn = if side.moving { 1.0 } else { -1.0 };
        let local = all.map(|n| side.view.transpose() * (n * turn));
        let parts =
            |k: usize| NormalDecomposition::new(if k < SHARED { local[k] } else { -local[k - 6] });
        let [own, other] = if side.moving { [0, 1] } else { [1, 0] };
        Self {
            local: [0, 1, 2].map(|axis| local.map(|n| n[axis])),
            offset: all.map(|n| turn * n.dot(side.view_offset)),
            slack: all.map(|n| 2.0 * noise * n.abs().element_sum() + side.swell * n.length()),
            parts: std::array::from_fn(parts),
            others: AXES[other],
            lines: [LINES[own], LINES[other]],
        }
    }

    /// Computes the extents of a box from its centre and half its size.
    #[inline]
    fn box_reach(&self, middle: DVec3, half: DVec3, reach: &mut [f64; ALL]) {
        let (mut at, mut width) = (self.offset, self.slack);
        for axis in 0..3 {
            let local = &self.local[axis];
            for k in 0..SHARED {
                at[k] += local[k] * middle[axis];
                width[k] += local[k].abs() * half[axis];
            }
        }
        for k in 0..SHARED {
            reach[k] = width[k] + at[k];
        }
        for k in NORMALS..SHARED {
            reach[k + 6] = width[k] - at[k];
        }
    }

    /// Subtracts the space that the cuts leave free. A body's own axes have no cut along them, and directions
    /// orthogonal to one of them only cuts of edges.
    #[inline]
    fn subtract_cuts(&self, depths: &Depths, reach: &mut [f64; ALL]) {
        let [own, other] = self.lines;
        for first in [0, 3, 6, own, own + 6] {
            for (r, p) in reach[first..first + 3].iter_mut().zip(&self.parts[first..first + 3]) {
                *r -= p.edge_support_reduction(depths);
            }
        }
        reach[EDGES] -= self.parts[EDGES].support_reduction(depths);
        for first in [self.others, other, other + 6] {
            for (r, p) in reach[first..first + 3].iter_mut().zip(&self.parts[first..first + 3]) {
                *r -= p.support_reduction(depths);
            }
        }
    }
}

impl SeparatingAxes {
    pub(crate) fn new(scene: &PairFrame) -> Self {
        let axes = |side: &PlacedBody| [side.view.x_axis, side.view.y_axis, side.view.z_axis];
        let (p, q) = (axes(&scene.moving), axes(&scene.fixed));
        let mut all = [DVec3::Z; SHARED];
        let edges = p.into_iter().flat_map(|a| q.map(|b| a.cross(b)));
        let normals = edges.chain([DVec3::Z]).chain(p).chain(q);
        for (n, place) in normals.zip(&mut all) {
            let length = n.length();
            if length > PARALLEL && n.z.abs() > STEEP * length {
                *place = n / n.z;
            }
        }
        for (axis, place) in p.into_iter().chain(q).zip(&mut all[NORMALS..]) {
            *place = axis.xy().perp().try_normalize().unwrap_or(DVec2::X).extend(0.0);
        }
        Self([&scene.moving, &scene.fixed].map(|side| BodyAxes::new(side, &all, scene.noise)))
    }

    /// Computes the extents of a node along all directions.
    #[inline]
    pub(crate) fn node_extents(&self, side: &PlacedBody, projected: &Projected) -> Reach {
        let Aabb { low, high } = projected.local;
        let view = &self.0[usize::from(!side.moving)];
        let mut reach = [0.0; ALL];
        view.box_reach((low + high) * 0.5, (high - low) * 0.5, &mut reach);
        let node = &side.solid.nodes()[projected.node as usize];
        view.subtract_cuts(
            &depth_table(&node.cuts, node.bounds.side_lengths(), side.max_displacement()),
            &mut reach,
        );
        Reach(reach)
    }
}

/// Extents of a node along the directions of a query.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Reach([f64; ALL]);

impl Reach {
    /// Returns a lower bound of all gaps between a node of the moving body and a node of the fixed one.
    #[inline]
    pub(crate) fn least_gap(&self, fixed: &Self) -> f64 {
        -least_sum(&self.0[..NORMALS], &fixed.0[..NORMALS])
    }

    /// Checks whether the shadows are disjoint.
    #[inline]
    pub(crate) fn is_apart(&self, fixed: &Self) -> bool {
        least_sum(&self.0[NORMALS..], &fixed.0[NORMALS..]) < 0.0
    }
}

/// Returns the least sum of two entries, four at a time so that the compiler vectorises it; sums that are NaN are
/// skipped.
#[inline]
fn least_sum(a: &[f64], b: &[f64]) -> f64 {
    let mut least = [f64::INFINITY; 4];
    for (x, y) in a.chunks_exact(4).zip(b.chunks_exact(4)) {
        for k in 0..4 {
            let sum = x[k] + y[k];
            least[k] = if sum < least[k] { sum } else { least[k] };
        }
    }
    least.into_iter().reduce(|a, b| if b < a { b } else { a }).unwrap_or(f64::INFINITY)
}
