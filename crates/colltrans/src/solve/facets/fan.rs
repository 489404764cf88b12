//! The directions along which a query compares nodes.
//!
//! A plane with a normal `n`, `n.d = 1`, bounds the gaps between two sets: `h_b - h_a` is at least the
//! least `n.x` over the one less the largest over the other. For two boxes the best of all planes is
//! one of 15: its normal is an axis of a box, or orthogonal to an axis of each. Boxes of one body have
//! the same axes, so these normals are those of the whole query, and how far a node reaches along
//! each is computed once: a pair of nodes is compared by fifteen sums. The 16th is the direction.
//! In the same way shadows of boxes are apart if they are so across the shadow of one of the six axes,
//! from one side or the other: `n.d = 0` (Gottschalk, Lin and Manocha, "A hierarchical structure for
//! rapid interference detection", SIGGRAPH 1996, for boxes that do not move).
//!
//! Nodes are less than boxes by their cuts, which makes both bounds better.
//!
//! A node of the moving body reaches so far along `n`, one of the fixed body along `-n`; less than
//! nothing for both together is by how much they are apart.
//!
//! Rounding. A point's coordinates in the query frame are off by a blur each, and computing how far a
//! node reaches along `n` by less than another `|n|_1` blurs: `n` in the body frame is off by
//! `4 u |n|_1`, products with the box and the offset by `8 u |n|_1` times their sizes, the cuts by
//! `8 u |n|_1` times the body's.

use glam::{DVec2, DVec3, Vec3Swizzles};

use super::bound::Shade;
use super::scene::{Scene, Side};
use crate::body::solid::cuts::{Parts, depths};

/// Normals of planes that bound gaps.
const NORMALS: usize = 16;
/// These, and six lines from both sides.
const ALL: usize = NORMALS + 12;
/// Planes steeper than this say little.
const STEEP: f64 = 1.0 / 1024.0;
/// Sines smaller than this are those of parallel axes.
const PARALLEL: f64 = 1e-6;

/// The directions of a query, as the moving body and the fixed one see them.
pub(super) struct Fan([View; 2]);

/// Directions in a body's frame, by coordinates.
struct View {
    /// The positive parts of their coordinates and the negative ones, which meet the upper and the
    /// lower sides of boxes.
    upper: [[f64; ALL]; 3],
    lower: [[f64; ALL]; 3],
    /// The body's offset along each, and what rounding may add.
    offset: [f64; ALL],
    /// Which cuts are along each, and how much of them.
    parts: [Parts; ALL],
}

impl View {
    fn new(side: &Side, all: &[DVec3; ALL], blur: f64) -> Self {
        let turn = if side.moving { 1.0 } else { -1.0 };
        let local = all.map(|n| side.view.transpose() * (n * turn));
        let offset = |n: DVec3| turn * n.dot(side.view_offset) + 2.0 * blur * n.abs().element_sum();
        Self {
            upper: [0, 1, 2].map(|k| local.map(|n| n[k].max(0.0))),
            lower: [0, 1, 2].map(|k| local.map(|n| n[k].min(0.0))),
            offset: all.map(offset),
            parts: local.map(Parts::new),
        }
    }
}

impl Fan {
    pub(super) fn new(scene: &Scene) -> Self {
        let axes = |side: &Side| [side.view.x_axis, side.view.y_axis, side.view.z_axis];
        let (p, q) = (axes(&scene.moving), axes(&scene.fixed));
        let mut all = [DVec3::Z; ALL];
        let edges = p.into_iter().flat_map(|a| q.map(|b| a.cross(b)));
        for (k, n) in p.into_iter().chain(q).chain(edges).enumerate() {
            let length = n.length();
            if length > PARALLEL && n.z.abs() > STEEP * length {
                all[k] = n / n.z;
            }
        }
        for (k, axis) in p.into_iter().chain(q).enumerate() {
            let line = axis.xy().perp().try_normalize().unwrap_or(DVec2::X).extend(0.0);
            (all[NORMALS + 2 * k], all[NORMALS + 2 * k + 1]) = (line, -line);
        }
        Self([&scene.moving, &scene.fixed].map(|side| View::new(side, &all, scene.blur)))
    }

    /// How far a node reaches along the directions.
    #[inline]
    pub(super) fn reach(&self, side: &Side, shade: &Shade) -> Reach {
        let [low, high] = shade.local;
        let View { upper, lower, offset, parts } = &self.0[usize::from(!side.moving)];
        let mut reach = *offset;
        for axis in 0..3 {
            let (up, down) = (&upper[axis], &lower[axis]);
            for k in 0..ALL {
                reach[k] += up[k] * high[axis] + down[k] * low[axis];
            }
        }
        let node = &side.solid.nodes()[shade.node as usize];
        let depths = depths(&node.cuts, node.high - node.low, side.moved());
        for k in 0..ALL {
            reach[k] -= parts[k].gain(&depths);
        }
        Reach(reach)
    }
}

/// How far a node reaches along the directions of a query.
#[derive(Debug, Clone, Copy)]
pub(super) struct Reach([f64; ALL]);

impl Reach {
    /// No gap between a node of the moving body and one of the fixed body is smaller.
    #[inline]
    pub(super) fn least_gap(&self, fixed: &Self) -> f64 {
        -least_sum(&self.0[..NORMALS], &fixed.0[..NORMALS])
    }

    /// Whether the shadows are apart.
    #[inline]
    pub(super) fn is_apart(&self, fixed: &Self) -> bool {
        least_sum(&self.0[NORMALS..], &fixed.0[NORMALS..]) < 0.0
    }
}

/// Four at a time, as processors do.
#[inline]
fn least_sum(a: &[f64], b: &[f64]) -> f64 {
    let mut least = [f64::INFINITY; 4];
    for (x, y) in a.chunks_exact(4).zip(b.chunks_exact(4)) {
        for k in 0..4 {
            let sum = x[k] + y[k];
            least[k] = if sum < least[k] { sum } else { least[k] };
        }
    }
    let [p, q, r, s] = least;
    p.min(q).min(r.min(s))
}
