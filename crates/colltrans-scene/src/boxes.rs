//! Boxes of placed bodies, and lower bounds of distances and translations that they prove.
//!
//! All numbers are rounded outwards. `u = 2^-53` is the unit roundoff. A box contains the body as the numbers of the
//! pose place it without rounding.
//!
//! - *Boxes.* A coordinate is the sum of three products and a translation. Its error is at most `3 u` of the products,
//!   `2 u` of their sum and `u` of the result, together `7 u (r + |t|)`. `r` is three times the largest absolute
//!   coordinate, because no matrix entry exceeds 1 by more than `1e-6`. [`BOX_ERROR`] is more than twice that.
//! - *Distances.* Differences, squares, their sum and its root have a relative error below `4 u`, because no rounded
//!   numbers are subtracted. Squares do not overflow; underflow makes a bound smaller.
//! - *Translations.* A difference divided by a component of the direction has a relative error below `3 u`.
//!
//! All bounds are monotone, also when rounded: for a box inside another one, the same computation returns at least the
//! bound of the outer box. The bound of a box therefore also holds for the boxes inside it.

use glam::{DMat3, DVec3};

use colltrans_convex::body::{Aabb, ConvexPolyhedron, Placed, Pose};
use colltrans_solid::body::Solid;
use colltrans_solid::kinds::{AnyPlaced, ByKind};

/// Unit roundoff `u`.
const ROUNDING: f64 = 0.5 * f64::EPSILON;
/// Margin of a box, relative to the size of its coordinates.
const BOX_ERROR: f64 = 16.0 * ROUNDING;
/// Relative margin of a bound.
const BOUND_ERROR: f64 = 8.0 * ROUNDING;
/// Maximum number of vertices of a body whose vertices are all transformed. Larger bodies use support points, or boxes
/// of their own tree.
const MAX_SCANNED_VERTICES: usize = 32;
/// Maximum number of visited nodes of the tree of a solid.
const MAX_TREE_BOXES: usize = 16;

/// Returns a box that contains a placed body and its input points: the box of its core, grown by its radius.
pub(super) fn bounds_of_placed(placed: &AnyPlaced<'_>) -> Aabb {
    let (bounds, radius) = match placed {
        ByKind::Convex(Placed { body, pose }) => (bounds_of_convex(body, pose), body.radius()),
        ByKind::Solid(Placed { body, pose }) => (bounds_of_solid(body, pose), body.radius()),
    };
    if radius == 0.0 {
        return bounds;
    }
    let size = bounds.low.abs().max(bounds.high.abs()).max_element() + radius;
    bounds.expanded(radius + 16.0 * f64::EPSILON * size)
}

/// Returns a box that contains the core of a convex body and its input points.
fn bounds_of_convex(body: &ConvexPolyhedron, pose: &Pose) -> Aabb {
    let excess = body.input_excess();
    if body.vertices().len() <= MAX_SCANNED_VERTICES {
        return bounds_of_points(body.vertices(), pose, excess);
    }
    let rows = pose.matrix().transpose();
    let mut bounds = Aabb::EMPTY;
    for (axis, row) in rows.to_cols_array_2d().map(DVec3::from_array).into_iter().enumerate() {
        let reach = |normal: DVec3| {
            let (vertex, beyond) = body.support_with_excess(normal, body.support(normal).0);
            // Rows of the matrix are unit vectors up to a relative error of 1e-6.
            normal.dot(body.vertices()[vertex as usize]) + 1.001 * beyond
        };
        (bounds.low[axis], bounds.high[axis]) = (-reach(-row), reach(row));
    }
    let size = DVec3::splat(3.0 * body.inertia().reach);
    enlarged_outwards(bounds, size, pose.translation(), excess)
}

/// Returns a box that contains the core of a solid.
fn bounds_of_solid(solid: &Solid, pose: &Pose) -> Aabb {
    if solid.vertices().len() <= MAX_SCANNED_VERTICES {
        return bounds_of_points(solid.vertices(), pose, 0.0);
    }
    let nodes = solid.nodes();
    let mut open_nodes = [0_u32; MAX_TREE_BOXES];
    let (mut first, mut count) = (0, 1);
    // Breadth first: the nodes from `first` on cover all facets that are not yet included.
    let mut bounds = Aabb::EMPTY;
    let matrix = pose.matrix();
    while first < count {
        let node = &nodes[open_nodes[first] as usize];
        if node.is_leaf() || count + 2 > MAX_TREE_BOXES {
            bounds = bounds.union(&rotated_box(&node.bounds, &matrix));
        } else {
            let child = open_nodes[first] + node.child_offset;
            (open_nodes[count], open_nodes[count + 1]) = (child, child + 1);
            count += 2;
        }
        first += 1;
    }
    let Aabb { low, high } = solid.bounds();
    let size = DVec3::splat(3.0 * low.abs().max(high.abs()).max_element());
    enlarged_outwards(bounds, size, pose.translation(), 0.0)
}

/// Returns a box that contains placed points, enlarged by `excess`.
fn bounds_of_points(points: &[DVec3], pose: &Pose, excess: f64) -> Aabb {
    let matrix = pose.matrix();
    let (mut bounds, mut size) = (Aabb::EMPTY, DVec3::ZERO);
    for &v in points {
        bounds.extend_to(matrix * v);
        size = size.max(v.abs());
    }
    enlarged_outwards(bounds, DVec3::splat(3.0 * size.max_element()), pose.translation(), excess)
}

/// Returns the box of a rotated box, rounded.
fn rotated_box(bounds: &Aabb, matrix: &DMat3) -> Aabb {
    let (mut low, mut high) = (DVec3::ZERO, DVec3::ZERO);
    for (k, column) in [matrix.x_axis, matrix.y_axis, matrix.z_axis].into_iter().enumerate() {
        let (a, b) = (column * bounds.low[k], column * bounds.high[k]);
        (low, high) = (low + a.min(b), high + a.max(b));
    }
    Aabb { low, high }
}

/// Moves a box by a translation and enlarges it. `size` bounds its coordinates; the margin covers rounding errors and
/// the `excess` of input points, which poses may stretch by a relative `1e-6`.
fn enlarged_outwards(bounds: Aabb, size: DVec3, translation: DVec3, excess: f64) -> Aabb {
    let error = (size + translation.abs()) * BOX_ERROR + 1.001 * excess;
    Aabb { low: bounds.low + translation - error, high: bounds.high + translation + error }
}

/// Returns a lower bound of the distance of two boxes.
#[inline]
pub(super) fn box_distance(a: &Aabb, b: &Aabb) -> f64 {
    let gap = (b.low - a.high).max(a.low - b.high).max(DVec3::ZERO);
    gap.length() * (1.0 - BOUND_ERROR)
}

/// A box that moves along a direction.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sweep {
    moving: Aabb,
    direction: DVec3,
    inverse: DVec3,
}

impl Sweep {
    /// Builds the sweep of a box along a direction that is valid for a cast.
    pub(super) fn new(moving: Aabb, direction: DVec3) -> Self {
        Self { moving, direction, inverse: direction.recip() }
    }

    /// Returns a translation, in multiples of the direction, before which the moving box does not meet another box.
    /// Returns 0 if they may overlap at the start, and infinity if they never meet ahead.
    #[inline]
    pub(super) fn entry(&self, other: &Aabb) -> f64 {
        let (near, far) = (other.low - self.moving.high, other.high - self.moving.low);
        let (mut first, mut last) = (0.0_f64, f64::INFINITY);
        for k in 0..3 {
            if self.direction[k] == 0.0 {
                if near[k] > 0.0 || far[k] < 0.0 {
                    return f64::INFINITY;
                }
                continue;
            }
            let (a, b) = (near[k] * self.inverse[k], far[k] * self.inverse[k]);
            let (a, b) = (a.min(b), a.max(b));
            first = first.max(a - a.abs() * BOUND_ERROR);
            last = last.min(b + b.abs() * BOUND_ERROR);
        }
        if first > last { f64::INFINITY } else { first }
    }
}
