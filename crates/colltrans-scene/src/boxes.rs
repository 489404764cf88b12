//! Boxes of placed bodies, and what they prove: how far bodies are apart at least, and before which
//! translation they do not meet.
//!
//! Every number is rounded outwards. `u = 2^-53`; a box holds its body where the nine entries of the pose's
//! matrix and its translation put it, exactly.
//!
//! - *Boxes.* A coordinate is a sum of three products and a translation: off by at most `3 u` of the
//!   products, `2 u` of their sum and `u` of the result, so by `7 u (r + |t|)`, with `r` three times the
//!   largest magnitude of a coordinate, as no entry is above 1 by more than `1e-6`. [`BOX`] is more than
//!   twice that.
//! - *Distances.* Differences, squares, their sum and a root are off by less than `4 u` of the result, as
//!   nothing is taken from anything that is rounded; no square overflows, and one that underflows is less.
//! - *Translations.* A difference over a component of the direction is off by less than `3 u` of itself.
//!
//! All of them grow with the boxes' distance, whatever rounding does: what a box proves, the boxes that it
//! holds prove as well, with the same computation.

use glam::{DMat3, DVec3};

use colltrans_convex::body::{Aabb, ConvexPolyhedron, Pose};
use colltrans_solid::body::Solid;
use colltrans_solid::kinds::{AnyPlaced, ByKind};

/// `u`.
const ROUNDING: f64 = 0.5 * f64::EPSILON;
/// By how much a box is grown, in multiples of the size of its coordinates.
const BOX: f64 = 16.0 * ROUNDING;
/// By how much a bound is lowered, in multiples of itself.
const LOWERED: f64 = 8.0 * ROUNDING;
/// Bodies of more vertices are seen by support points, or by boxes of their own tree.
const FEW: usize = 32;
/// So many boxes of a solid's tree.
const PARTS: usize = 16;

/// Returns a box that holds a placed body.
pub(super) fn of_placed(placed: &AnyPlaced<'_>) -> Aabb {
    match placed {
        ByKind::Convex(placed) => of_convex(placed.body, &placed.pose),
        ByKind::Solid(placed) => of_solid(placed.body, &placed.pose),
    }
}

/// A box that holds a convex body, and the points that it was made from.
fn of_convex(body: &ConvexPolyhedron, pose: &Pose) -> Aabb {
    let excess = body.input_excess();
    if body.vertices().len() <= FEW {
        return of_points(body.vertices(), pose, excess);
    }
    let rows = pose.matrix().transpose();
    let mut bounds = Aabb::EMPTY;
    for (axis, row) in rows.to_cols_array_2d().map(DVec3::from_array).into_iter().enumerate() {
        let reach = |normal: DVec3| {
            let (vertex, beyond) = body.settled(normal, body.support(normal).0);
            // Rows are unit vectors to within a millionth.
            normal.dot(body.vertices()[vertex as usize]) + 1.001 * beyond
        };
        (bounds.low[axis], bounds.high[axis]) = (-reach(-row), reach(row));
    }
    let size = DVec3::splat(3.0 * body.inertia().reach);
    outwards(bounds, size, pose.translation(), excess)
}

/// A box that holds a solid.
fn of_solid(solid: &Solid, pose: &Pose) -> Aabb {
    if solid.vertices().len() <= FEW {
        return of_points(solid.vertices(), pose, 0.0);
    }
    let nodes = solid.nodes();
    let mut parts = [0_u32; PARTS];
    let (mut first, mut count) = (0, 1);
    // Breadth first: the nodes at `first` and behind cover all facets.
    let mut bounds = Aabb::EMPTY;
    let matrix = pose.matrix();
    while first < count {
        let node = &nodes[parts[first] as usize];
        if node.is_leaf() || count + 2 > PARTS {
            bounds = bounds.join(&turned(&node.bounds, &matrix));
        } else {
            let child = parts[first] + node.skip;
            (parts[count], parts[count + 1]) = (child, child + 1);
            count += 2;
        }
        first += 1;
    }
    let Aabb { low, high } = solid.bounds();
    let size = DVec3::splat(3.0 * low.abs().max(high.abs()).max_element());
    outwards(bounds, size, pose.translation(), 0.0)
}

fn of_points(points: &[DVec3], pose: &Pose, excess: f64) -> Aabb {
    let matrix = pose.matrix();
    let (mut bounds, mut size) = (Aabb::EMPTY, DVec3::ZERO);
    for &v in points {
        bounds.add(matrix * v);
        size = size.max(v.abs());
    }
    outwards(bounds, DVec3::splat(3.0 * size.max_element()), pose.translation(), excess)
}

/// The box of a turned box, rounded.
fn turned(bounds: &Aabb, matrix: &DMat3) -> Aabb {
    let (mut low, mut high) = (DVec3::ZERO, DVec3::ZERO);
    for (k, column) in [matrix.x_axis, matrix.y_axis, matrix.z_axis].into_iter().enumerate() {
        let (a, b) = (column * bounds.low[k], column * bounds.high[k]);
        (low, high) = (low + a.min(b), high + a.max(b));
    }
    Aabb { low, high }
}

/// A box of coordinates of so much size at most, moved by a translation and grown by what rounding does, and
/// by what points of the input may lie outside the body; poses may stretch that by a millionth.
fn outwards(bounds: Aabb, size: DVec3, translation: DVec3, excess: f64) -> Aabb {
    let error = (size + translation.abs()) * BOX + 1.001 * excess;
    Aabb { low: bounds.low + translation - error, high: bounds.high + translation + error }
}

/// No point of one box is nearer to one of the other.
#[inline]
pub(super) fn distance(a: &Aabb, b: &Aabb) -> f64 {
    let gap = (b.low - a.high).max(a.low - b.high).max(DVec3::ZERO);
    gap.length() * (1.0 - LOWERED)
}

/// A box that moves along a direction.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sweep {
    moving: Aabb,
    direction: DVec3,
    inverse: DVec3,
}

impl Sweep {
    /// Along a direction that a cast admits.
    pub(super) fn new(moving: Aabb, direction: DVec3) -> Self {
        Self { moving, direction, inverse: direction.recip() }
    }

    /// The moving box meets another one at no translation from 0 to this one, in multiples of the direction:
    /// infinite if at none that is ahead.
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
            first = first.max(a - a.abs() * LOWERED);
            last = last.min(b + b.abs() * LOWERED);
        }
        if first > last { f64::INFINITY } else { first }
    }
}
