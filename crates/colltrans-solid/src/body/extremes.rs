//! Exact boxes around the facets of a node under an inward offset, without a pass over these facets.
//!
//! Under an offset by `e >= 0`, a coordinate `v` of a vertex becomes `f(v, x, e)`, the rounded sum of `v` and of the
//! rounded product `e x`, with tiny results replaced by 0 ([`offset_vertex`]). For the lower sides of a box, `v` and
//! `x` are negated.
//!
//! - `f` increases with `v` and with `x`, or stays equal. The *extreme vertex* of a side has the largest `v`, and among
//!   these vertices the largest `x`.
//! - A vertex `i` with `x_i > x` overtakes the extreme vertex at the earliest when `v + fl(e x) < v_i + fl(e x_i)`. Both
//!   products have errors below `u` times themselves, so this is false up to the amount
//!   `(v - v_i) / ((x_i - x) + 2 u (|x_i| + |x|))`.
//! - Invariant: for amounts from 0 to the limit of a node, its six extreme vertices attain the six exact extremes over
//!   all its facets.
//! - The vertices of a child are bounded together, by its largest `v` and its largest `x`, or by the limit of the child
//!   and its extreme vertex alone. The larger limit holds.

use glam::DVec3;

use super::{OffsetField, Solid, offset_vertex};
use colltrans_convex::body::Aabb;

/// Factor that covers the rounding of a limit, including that to single precision.
const LIMIT_MARGIN: f64 = 1.0 - 1e-6;

/// Maximum amount for which the farthest vertices are known, in multiples of the reach of the body.
const MAX_FAR_AMOUNT: f64 = 1.0 / 1024.0 / 1024.0;
/// Relative distance below the maximum at which a vertex may still be the farthest one, because of rounding.
const FAR_MARGIN: f64 = 1e-12;

/// Extreme vertices of all nodes of a solid, and its farthest vertices.
#[derive(Debug, Clone)]
pub(crate) struct OffsetExtremes {
    nodes: Vec<NodeExtremes>,
    /// Vertices that may be the farthest ones from the origin for some amount up to `max_far_amount`.
    farthest: Vec<u32>,
    max_far_amount: f64,
}

/// Extreme vertices of a node.
#[derive(Debug, Clone, Copy)]
struct NodeExtremes {
    /// Vertices that attain the lower sides of the box, then those of the upper sides.
    vertices: [u32; 6],
    /// Maximum amount for which they do.
    limit: f32,
}

/// Bounds of one side of a box during the computation. For lower sides, coordinates are negated.
#[derive(Clone, Copy)]
struct Side {
    /// The extreme vertex, its coordinate and the coordinate of its displacement.
    vertex: u32,
    v: f64,
    x: f64,
    /// Largest coordinate of a displacement over all vertices.
    max_x: f64,
    /// Maximum amount for which the vertex is extreme.
    limit: f64,
}

impl Side {
    /// Returns the side of two sets of vertices.
    fn joined(self, other: Self) -> Self {
        let is_first = (self.v, self.x) >= (other.v, other.x);
        let (best, rest) = if is_first { (self, other) } else { (other, self) };
        let together = overtaking_limit([best.v, best.x], [rest.v, rest.max_x]);
        let alone = overtaking_limit([best.v, best.x], [rest.v, rest.x]).min(rest.limit);
        let max_x = best.max_x.max(rest.max_x);
        Self { max_x, limit: best.limit.min(together.max(alone)), ..best }
    }
}

/// Returns an amount up to which a vertex stays extreme beside another one that is not beyond it.
fn overtaking_limit([v, x]: [f64; 2], [other_v, other_x]: [f64; 2]) -> f64 {
    if other_x <= x {
        return f64::INFINITY;
    }
    (v - other_v) / ((other_x - x) + f64::EPSILON * (other_x.abs() + x.abs())) * LIMIT_MARGIN
}

impl OffsetExtremes {
    /// Computes the extreme vertices of all nodes, and the farthest vertices.
    pub(super) fn new(solid: &Solid, field: &OffsetField) -> Self {
        let empty = NodeExtremes { vertices: [0; 6], limit: 0.0 };
        let mut nodes = vec![empty; solid.nodes.len()];
        fill_node(solid, field, 0, &mut nodes);
        let max_far_amount = MAX_FAR_AMOUNT * solid.reach;
        let distance = |v: usize| solid.vertices[v].length();
        let moved = |v: usize| field.displacements[v].length() * max_far_amount;
        let count = solid.vertices.len();
        let least = (0..count).map(|v| distance(v) - moved(v)).fold(0.0, f64::max);
        let may_be_farthest = |v: &usize| distance(*v) + moved(*v) >= least * (1.0 - FAR_MARGIN);
        let farthest = (0..count).filter(may_be_farthest).map(|v| v as u32).collect();
        Self { nodes, farthest, max_far_amount }
    }

    pub(super) fn heap_bytes(&self) -> usize {
        self.nodes.capacity() * size_of::<NodeExtremes>()
            + self.farthest.capacity() * size_of::<u32>()
    }
}

/// Fills in the extreme vertices of a node and of those below it. Returns its sides.
fn fill_node(solid: &Solid, field: &OffsetField, at: usize, all: &mut [NodeExtremes]) -> [Side; 6] {
    let node = &solid.nodes[at];
    let sides = if node.is_leaf() {
        let vertices = node.facets().flat_map(|t| solid.triangles[t]);
        let all_sides = vertices.map(|vertex| vertex_sides(solid, field, vertex));
        all_sides.reduce(join_sides).unwrap_or_else(|| vertex_sides(solid, field, 0))
    } else {
        let children = node.child_positions(at as u32);
        let [first, second] = children.map(|child| fill_node(solid, field, child as usize, all));
        join_sides(first, second)
    };
    let limit = sides.iter().map(|side| side.limit).fold(f64::INFINITY, f64::min);
    all[at] = NodeExtremes { vertices: sides.map(|side| side.vertex), limit: stored_limit(limit) };
    sides
}

/// Returns a limit in single precision. [`LIMIT_MARGIN`] covers its rounding in the range of normal numbers.
fn stored_limit(limit: f64) -> f32 {
    if limit == f64::INFINITY {
        return f32::INFINITY;
    }
    if limit < f32::MIN_POSITIVE.into() { 0.0 } else { limit.min(1e38) as f32 }
}

/// Returns the sides of one vertex.
fn vertex_sides(solid: &Solid, field: &OffsetField, vertex: u32) -> [Side; 6] {
    let [at, by] = [solid.vertices[vertex as usize], field.displacements[vertex as usize]];
    std::array::from_fn(|side| {
        let sign = if side < 3 { -1.0 } else { 1.0 };
        let [v, x] = [at, by].map(|of| sign * of[side % 3]);
        Side { vertex, v, x, max_x: x, limit: f64::INFINITY }
    })
}

fn join_sides(a: [Side; 6], b: [Side; 6]) -> [Side; 6] {
    std::array::from_fn(|side| a[side].joined(b[side]))
}

#[doc(hidden)]
impl Solid {
    /// Returns the exact bounding box of the facets of a node under an inward offset by `amount`, in the units of the
    /// body. Returns `None` if the stored vertices do not determine it, because the amount is negative or too large.
    /// The first call with an offset computes the vertices of all nodes, which the solid stores.
    pub fn exact_offset_box(&self, node: usize, amount: f64) -> Option<Aabb> {
        let Some(field) = self.shrinking_by(amount) else {
            return Some(self.nodes[node].bounds);
        };
        let NodeExtremes { vertices, limit } = &self.offset_extremes(field).nodes[node];
        if !(0.0..=f64::from(*limit)).contains(&amount) {
            return None;
        }
        let coordinate = |side: usize| {
            let v = vertices[side] as usize;
            offset_vertex(self.vertices[v], field.displacements[v], amount)[side % 3]
        };
        let low = DVec3::new(coordinate(0), coordinate(1), coordinate(2));
        Some(Aabb { low, high: DVec3::new(coordinate(3), coordinate(4), coordinate(5)) })
    }

    /// Returns the largest computed distance from the origin of the body frame to a vertex under an inward offset by
    /// `amount`. Up to a millionth of the reach, only vertices that may be the farthest ones are examined.
    pub fn offset_reach(&self, amount: f64) -> f64 {
        let Some(field) = self.shrinking_by(amount) else { return self.reach };
        let OffsetExtremes { farthest, max_far_amount, .. } = self.offset_extremes(field);
        let square = |v: usize| {
            offset_vertex(self.vertices[v], field.displacements[v], amount).length_squared()
        };
        let most = if (0.0..=*max_far_amount).contains(&amount) {
            farthest.iter().map(|v| square(*v as usize)).fold(0.0, f64::max)
        } else {
            (0..self.vertices.len()).map(square).fold(0.0, f64::max)
        };
        most.sqrt()
    }

    /// Returns the extreme vertices, computed on first use.
    #[inline]
    fn offset_extremes(&self, field: &OffsetField) -> &OffsetExtremes {
        self.extremes.get_or_init(|| Box::new(OffsetExtremes::new(self, field)))
    }
}
