//! Nearest points of two triangles.
//!
//! `A` and `B` are triangles in one frame, possibly degenerate; `P` and `Q` a pair of nearest points, `v = Q - P`.
//!
//! For disjoint triangles, the shortest vector joins two edges (9 pairs), or a vertex and the interior of a face (6
//! pairs). For triangles that meet, an edge of one pierces the other, or they are coplanar and a former candidate has
//! length 0. Every candidate is an upper bound, because it is a pair of points of `A` and `B`; the answer is the best
//! one. An edge pair ends the search if the third corners are *clearly* outside of the slab between the planes
//! through `P` and `Q` normal to `v` (Larsen et al. 1999). If rounding hides that, all candidates are compared.

use glam::DVec3;

use super::Scale;

/// Three corners.
pub(crate) type Triangle = [DVec3; 3];

/// Relative error of a triangle's normal below which the triangle counts as a segment, which its edges
/// represent.
const DEGENERATE: f64 = 32.0 * f64::EPSILON;

/// Sine of the angle below which a cross product is formed without cancellation. Above, at most four bits are
/// lost.
const NEARLY_PARALLEL: f64 = 0.1;

/// A point of each triangle, and their squared distance.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Nearest {
    pub(crate) squared: f64,
    pub(crate) on_a: DVec3,
    pub(crate) on_b: DVec3,
}

impl Nearest {
    /// Returns a pair of points with their distance.
    fn between(on_a: DVec3, on_b: DVec3) -> Self {
        Self { squared: on_a.distance_squared(on_b), on_a, on_b }
    }

    /// Returns a common point.
    fn common(point: DVec3) -> Self {
        Self { squared: 0.0, on_a: point, on_b: point }
    }

    /// Returns the pair with both triangles exchanged.
    fn swapped(self) -> Self {
        Self { on_a: self.on_b, on_b: self.on_a, ..self }
    }

    /// Returns the nearer one of two pairs.
    fn or_nearer(self, other: Self) -> Self {
        if other.squared < self.squared { other } else { self }
    }
}

/// Returns nearest points of two triangles; distance 0 with a common point if they intersect.
///
/// Slivers: nearest points of two lines are computed from the cross product of their directions, whose error grows
/// with `1 / sin` of the angle, not with its square. Normals are formed without cancellation. A point is inside a
/// face if it is behind its three edges and within the longest edge, because two edges at a sharp corner do not bound
/// it.
pub(crate) fn nearest_of_triangles(a: &Triangle, b: &Triangle, scale: Scale) -> Nearest {
    let (edges_a, edges_b) = (edges(a), edges(b));
    let margin = scale.area_noise();
    let mut best = Nearest::between(a[0], b[0]);
    for (i, edge_a) in edges_a.iter().enumerate() {
        for (j, edge_b) in edges_b.iter().enumerate() {
            let found = edge_a.nearest(edge_b);
            best = best.or_nearer(found);
            let v = found.on_b - found.on_a;
            let third_a = (a[(i + 2) % 3] - found.on_a).dot(v);
            let third_b = (b[(j + 2) % 3] - found.on_b).dot(v);
            if third_a < -margin && third_b > margin {
                return best;
            }
        }
    }
    if let Some(face) = Face::new(a) {
        best = best.or_nearer(face.nearest_corner_or_common(b, best));
    }
    if let Some(face) = Face::new(b) {
        best = best.or_nearer(face.nearest_corner_or_common(a, best.swapped()).swapped());
    }
    best
}

/// Checks whether two triangles have a common point, up to rounding.
pub(crate) fn triangles_intersect(a: &Triangle, b: &Triangle, scale: Scale) -> bool {
    let beside = |a: &Triangle, b: &Triangle| Face::new(a).is_some_and(|f| f.is_beside(b, scale));
    let noise = scale.noise();
    !beside(a, b) && !beside(b, a) && nearest_of_triangles(a, b, scale).squared <= noise * noise
}

/// An edge as a start and a vector.
struct Edge {
    start: DVec3,
    along: DVec3,
    /// The inverse of the squared length; 0 if that is not finite.
    inverse_square: f64,
}

/// Returns the edges of a triangle.
fn edges(t: &Triangle) -> [Edge; 3] {
    [0, 1, 2].map(|i| {
        let along = t[(i + 1) % 3] - t[i];
        Edge { start: t[i], along, inverse_square: inverse_or_zero(along.length_squared()) }
    })
}

/// Returns the inverse of a squared length; 0 if it is 0 or subnormal.
fn inverse_or_zero(square: f64) -> f64 {
    if square >= f64::MIN_POSITIVE { 1.0 / square } else { 0.0 }
}

impl Edge {
    /// Returns the nearest points `start + s along` of both edges, `0 <= s <= 1`: those of the lines, then
    /// clamped in turn. This yields the minimum, because the squared distance is convex.
    #[inline]
    fn nearest(&self, other: &Self) -> Nearest {
        let r = other.start - self.start;
        let normal = self.along.cross(other.along);
        let square = normal.length_squared();
        let cosine = self.along.dot(other.along);
        let (r_self, r_other) = (r.dot(self.along), r.dot(other.along));
        let mut s = 0.0;
        if square > 0.0 {
            s = (r.cross(other.along).dot(normal) / square).clamp(0.0, 1.0);
        }
        let t = ((s * cosine - r_other) * other.inverse_square).clamp(0.0, 1.0);
        s = ((r_self + t * cosine) * self.inverse_square).clamp(0.0, 1.0);
        Nearest::between(self.start + self.along * s, other.start + other.along * t)
    }
}

/// A triangle that is not degenerate.
struct Face<'a> {
    corners: &'a Triangle,
    normal: DVec3,
    square: f64,
}

impl<'a> Face<'a> {
    /// Returns the face; `None` for a degenerate triangle.
    fn new(corners: &'a Triangle) -> Option<Self> {
        let (u, v) = (corners[1] - corners[0], corners[2] - corners[0]);
        let mut normal = u.cross(v);
        let product = u.length_squared() * v.length_squared();
        if normal.length_squared() < NEARLY_PARALLEL * NEARLY_PARALLEL * product {
            normal = accurate_cross(u, v);
        }
        let square = normal.length_squared();
        let enough = (DEGENERATE * DEGENERATE * product).max(f64::MIN_POSITIVE);
        (square > enough).then_some(Self { corners, normal, square })
    }

    /// Returns the heights of the other triangle's corners above the plane, multiplied by the length of
    /// `normal`.
    fn heights(&self, other: &Triangle) -> [f64; 3] {
        other.map(|p| (p - self.corners[0]).dot(self.normal))
    }

    /// Checks whether a triangle is clearly on one side of this face's plane.
    fn is_beside(&self, other: &Triangle, scale: Scale) -> bool {
        let margin = scale.noise() * self.square.sqrt();
        let heights = self.heights(other);
        heights.iter().all(|h| *h > margin) || heights.iter().all(|h| *h < -margin)
    }

    /// Returns a common point where an edge of `other` pierces this face (`A`). If `other` is on one side,
    /// returns its lowest corner and the foot of that corner. Returns `known` if these points are not inside
    /// the face.
    fn nearest_corner_or_common(&self, other: &Triangle, known: Nearest) -> Nearest {
        let h = self.heights(other);
        let low = (0..3).fold(0, |low, i| if h[i].abs() < h[low].abs() { i } else { low });
        if h.iter().all(|h| *h > 0.0) || h.iter().all(|h| *h < 0.0) {
            let corner = other[low];
            if !self.contains(corner) {
                return known;
            }
            let squared = h[low] * (h[low] / self.square);
            let foot = corner - self.normal * (h[low] / self.square);
            return Nearest { squared, on_a: foot, on_b: corner };
        }
        let crossing = |i: usize| {
            let j = (i + 1) % 3;
            if h[i] == 0.0 {
                return Some(other[i]);
            }
            let apart = (h[i] > 0.0) != (h[j] > 0.0);
            apart.then(|| other[i] + (other[j] - other[i]) * (h[i] / (h[i] - h[j])))
        };
        let common = (0..3).filter_map(crossing).find(|p| self.contains(*p));
        common.map_or(known, Nearest::common)
    }

    /// Checks whether the projection of a point on the plane is inside the face.
    fn contains(&self, p: DVec3) -> bool {
        let c = self.corners;
        let along = [c[1] - c[0], c[2] - c[1], c[0] - c[2]];
        let lengths = along.map(DVec3::length_squared);
        let long = (0..3).fold(0, |long, i| if lengths[i] > lengths[long] { i } else { long });
        let beside = (0.0..=lengths[long]).contains(&(p - c[long]).dot(along[long]));
        beside && (0..3).all(|i| (p - c[i]).dot(self.normal.cross(along[i])) >= 0.0)
    }
}

/// Returns a cross product with a relative error of a few units in the last place.
fn accurate_cross(u: DVec3, v: DVec3) -> DVec3 {
    DVec3::new(
        difference_of_products(u.y, v.z, u.z, v.y),
        difference_of_products(u.z, v.x, u.x, v.z),
        difference_of_products(u.x, v.y, u.y, v.x),
    )
}

/// Returns `a b - c d`, from the rounded products and their errors (Dekker 1971).
fn difference_of_products(a: f64, b: f64, c: f64, d: f64) -> f64 {
    let (ab, ab_error) = two_product(a, b);
    let (cd, cd_error) = two_product(c, d);
    (ab - cd) + (ab_error - cd_error)
}

/// Returns a product and its rounding error.
fn two_product(a: f64, b: f64) -> (f64, f64) {
    let split = |x: f64| {
        let c = f64::from((1 << 27) + 1) * x;
        let high = c - (c - x);
        (high, x - high)
    };
    let product = a * b;
    let ((a_high, a_low), (b_high, b_low)) = (split(a), split(b));
    let error = ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low;
    (product, error)
}
