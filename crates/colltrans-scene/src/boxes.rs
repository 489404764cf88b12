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
//! - *Rounded boxes.* A ball of radius `r` that sweeps a box is nearer by `r` and no more than that. Searches use these
//!   bounds, checks of proofs the box around the rounded one.
//!
//! All bounds except [`Sweep::entry`] are monotone, also when rounded: for a box inside another one, the same
//! computation returns at least the bound of the outer box. The bound of a box therefore also holds for the boxes inside
//! it. `Sweep::entry` only bounds what is inside the box that it is given.

use glam::{DMat3, DVec3};

use colltrans_convex::body::{Aabb, ConvexPolyhedron, Placed, Pose};
use colltrans_solid::body::Solid;
use colltrans_solid::kinds::{AnyPlaced, ByKind};

/// Maximum number of steps of Newton's method towards the entry of a rounded box (measured).
const MAX_NEWTON_STEPS: usize = 4;
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

/// A box swept by a ball: it contains a body whose core is in the box.
#[derive(Debug, Clone, Copy)]
pub(super) struct RoundedBox {
    core: Aabb,
    radius: f64,
}

impl RoundedBox {
    /// Returns a box that contains the core of a placed body and its input points, with the radius of the body.
    pub(super) fn of_placed(placed: &AnyPlaced<'_>) -> Self {
        let (core, radius) = match placed {
            ByKind::Convex(Placed { body, pose }) => (bounds_of_convex(body, pose), body.radius()),
            ByKind::Solid(Placed { body, pose }) => (bounds_of_solid(body, pose), body.radius()),
        };
        Self { core, radius }
    }

    /// Returns the box with a radius that is larger by a length, rounded up.
    pub(super) fn widened(self, by: f64) -> Self {
        let sum = self.radius + by;
        let is_exact = self.radius == 0.0 || by == 0.0;
        Self { radius: if is_exact { sum } else { sum.next_up() }, ..self }
    }

    /// Returns a box that contains all points within the radius of the core.
    pub(super) fn outer_box(&self) -> Aabb {
        let Self { core, radius } = *self;
        if radius == 0.0 {
            return core;
        }
        let size = core.low.abs().max(core.high.abs()).max_element() + radius;
        core.expanded(radius + 16.0 * f64::EPSILON * size)
    }

    /// Returns a lower bound of the distance from a box.
    #[inline]
    pub(super) fn distance(&self, other: &Aabb) -> f64 {
        let of_core = box_distance(&self.core, other);
        if self.radius == 0.0 {
            return of_core;
        }
        ((of_core - self.radius) * (1.0 - BOUND_ERROR)).max(0.0)
    }
}

/// Returns a box that contains a placed body and its input points: the box of its core, grown by its radius.
pub(super) fn bounds_of_placed(placed: &AnyPlaced<'_>) -> Aabb {
    RoundedBox::of_placed(placed).outer_box()
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

/// A rounded box that moves along a direction.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sweep {
    moving: RoundedBox,
    outer_box: Aabb,
    direction: DVec3,
    inverse: DVec3,
}

impl Sweep {
    /// Builds the sweep of a rounded box along a direction that is valid for a cast.
    pub(super) fn new(moving: RoundedBox, direction: DVec3) -> Self {
        Self { moving, outer_box: moving.outer_box(), direction, inverse: direction.recip() }
    }

    /// Returns a translation, in multiples of the direction, before which the outer box of the moving one does not meet
    /// another box. Returns 0 if they may overlap at the start, and infinity if they never meet ahead.
    #[inline]
    pub(super) fn entry_of_outer_box(&self, other: &Aabb) -> f64 {
        let (near, far) = (other.low - self.outer_box.high, other.high - self.outer_box.low);
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

    /// Returns a translation, in multiples of the direction, before which the moving box does not meet another box. It
    /// is at least [`Self::entry_of_outer_box`].
    ///
    /// The differences of points of the other box and the core form a box `D`. The boxes meet where the distance of
    /// `t d` from `D` is at most the radius. This distance is a convex function of `t`. Newton's method from a smaller
    /// translation therefore approaches the entry from below. Each step is the bound of the plane through the point of
    /// `D` nearest to `t d` ([`Self::entry_of_plane`]), which is proven for any `t`.
    #[inline]
    pub(super) fn entry(&self, other: &Aabb) -> f64 {
        let mut first = self.entry_of_outer_box(other);
        if self.moving.radius == 0.0 {
            return first;
        }
        let Aabb { low, high } = self.moving.core;
        let (near, far) = (other.low - high, other.high - low);
        for _ in 0..MAX_NEWTON_STEPS {
            if first == f64::INFINITY {
                break;
            }
            let at = self.direction * first;
            let nearest = at.max(near).min(far);
            let next = self.entry_of_plane(nearest, nearest - at);
            if next <= first {
                break;
            }
            first = next;
        }
        first
    }

    /// Returns the translation before which a plane keeps the ball of the radius around `t d` from `D`; 0 if it
    /// proves none or the normal is not longer than the radius, infinity if the plane separates them ahead.
    ///
    /// A component of `normal` may be positive only where `corner` is on the lower side of `D`, and negative only where
    /// it is on the upper one. Therefore no point `y` of `D` is lower: `n.y >= n.corner`. The ball touches `D` at `t`
    /// only if `t n.d >= n.corner - r |n|`. The rounding of `normal` does not matter. The products have an error of at
    /// most `4 u` each, including that of the corner, `r |n|` one of `3.5 u`, and the differences add `2 u`. Together
    /// this is less than [`BOUND_ERROR`] of the sum of the magnitudes. Underflow is negligible: `|n| > r`, and a
    /// radius that is not tiny is far above it, while a tiny one only changes `r |n|`, far below the error allowed.
    #[inline]
    fn entry_of_plane(&self, corner: DVec3, normal: DVec3) -> f64 {
        let (size, length) = (normal.abs(), normal.length());
        if length <= self.moving.radius {
            return 0.0;
        }
        let reach = self.moving.radius * length;
        let ahead = normal.dot(corner) - reach - BOUND_ERROR * (size.dot(corner.abs()) + reach);
        let along = normal.dot(self.direction) + BOUND_ERROR * size.dot(self.direction.abs());
        if ahead.is_nan() || ahead <= 0.0 {
            0.0
        } else if along <= 0.0 {
            f64::INFINITY
        } else {
            ahead / along * (1.0 - BOUND_ERROR)
        }
    }
}
