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
//! Rounding. A point's coordinates in the query frame are off by a noise each, and computing how far a
//! node reaches along `n` by less than another `|n|_1` noises: `n` in the body frame is off by
//! `4 u |n|_1`, the box's middle and half extents, products with them and sums with the offset by
//! `15 u |n|_1` times their sizes, the cuts by `8 u |n|_1` times the body's.

use glam::{DVec2, DVec3, Vec3Swizzles};

use super::projected::Projected;
use super::scene::{Scene, Side};
use crate::body::cuts::{Depths, Parts, depths};
use colltrans_convex::body::Aabb;

/// Normals orthogonal to an axis of each box, the direction, and the axes of the moving and the fixed
/// one.
const EDGES: usize = 9;
const AXES: [usize; 2] = [EDGES + 1, EDGES + 4];
/// Normals of planes that bound gaps.
const NORMALS: usize = 16;
/// Lines across the shadows of the axes, in the same order; each is a direction on both sides.
const LINES: [usize; 2] = [NORMALS, NORMALS + 3];
const SHARED: usize = NORMALS + 6;
const ALL: usize = NORMALS + 12;
/// Planes steeper than this say little.
const STEEP: f64 = 1.0 / 1024.0;
/// Sines smaller than this are those of parallel axes.
const PARALLEL: f64 = 1e-6;

/// The directions of a query, as the moving body and the fixed one see them.
pub(crate) struct SeparatingAxes([View; 2]);

/// Directions in a body's frame, by coordinates.
struct View {
    /// Their coordinates, which meet the middles of boxes, and by size half their extents.
    local: [[f64; SHARED]; 3],
    /// The body's offset along each, and what rounding may add.
    offset: [f64; SHARED],
    slack: [f64; SHARED],
    /// Which cuts are along each, and how much of them.
    parts: [Parts; ALL],
    /// The first of the other body's axes, and of the lines of its own and of the other one.
    others: usize,
    lines: [usize; 2],
}

impl View {
    fn new(side: &Side, all: &[DVec3; SHARED], noise: f64) -> Self {
        let turn = if side.moving { 1.0 } else { -1.0 };
        let local = all.map(|n| side.view.transpose() * (n * turn));
        let parts = |k: usize| Parts::new(if k < SHARED { local[k] } else { -local[k - 6] });
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

    /// How far a box reaches, by its middle and half its extents.
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

    /// Takes off what the cuts leave free. A body's own axes are along no cut; what is orthogonal to
    /// one of them is along edges alone.
    #[inline]
    fn cut(&self, depths: &Depths, reach: &mut [f64; ALL]) {
        let [own, other] = self.lines;
        for first in [0, 3, 6, own, own + 6] {
            for (r, p) in reach[first..first + 3].iter_mut().zip(&self.parts[first..first + 3]) {
                *r -= p.edge_gain(depths);
            }
        }
        reach[EDGES] -= self.parts[EDGES].gain(depths);
        for first in [self.others, other, other + 6] {
            for (r, p) in reach[first..first + 3].iter_mut().zip(&self.parts[first..first + 3]) {
                *r -= p.gain(depths);
            }
        }
    }
}

impl SeparatingAxes {
    pub(crate) fn new(scene: &Scene) -> Self {
        let axes = |side: &Side| [side.view.x_axis, side.view.y_axis, side.view.z_axis];
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
        Self([&scene.moving, &scene.fixed].map(|side| View::new(side, &all, scene.noise)))
    }

    /// How far a node reaches along the directions.
    #[inline]
    pub(crate) fn reach(&self, side: &Side, projected: &Projected) -> Reach {
        let Aabb { low, high } = projected.local;
        let view = &self.0[usize::from(!side.moving)];
        let mut reach = [0.0; ALL];
        view.box_reach((low + high) * 0.5, (high - low) * 0.5, &mut reach);
        let node = &side.solid.nodes()[projected.node as usize];
        view.cut(&depths(&node.cuts, node.bounds.size(), side.moved()), &mut reach);
        Reach(reach)
    }
}

/// How far a node reaches along the directions of a query.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Reach([f64; ALL]);

impl Reach {
    /// No gap between a node of the moving body and one of the fixed body is smaller.
    #[inline]
    pub(crate) fn least_gap(&self, fixed: &Self) -> f64 {
        -least_sum(&self.0[..NORMALS], &fixed.0[..NORMALS])
    }

    /// Whether the shadows are apart.
    #[inline]
    pub(crate) fn is_apart(&self, fixed: &Self) -> bool {
        least_sum(&self.0[NORMALS..], &fixed.0[NORMALS..]) < 0.0
    }
}

/// Four at a time, as processors do; sums that are no numbers are none of them.
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
