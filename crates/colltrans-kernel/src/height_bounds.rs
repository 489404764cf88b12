//! Guaranteed lower bounds of distances along a normal, and enclosures of dot products.
//!
//! Notation. `n` is a normal in the world, `R` the nine entries of a body's pose, and `v` a vertex. The
//! *height* of `v` is `n . R v`, a sum of nine products of three numbers.
//!
//! Algorithm. Heights are first computed in the body frame, as `(R^T n) . v`, with an error bounded by
//! [`HEIGHT_ERROR`]. The heights of vertices that may be the highest are computed again in twice the usual precision
//! ([`Double`]), with a bound on the error. `docs/theory/exact-arithmetic.md` derives `HEIGHT_ERROR`.

use glam::{DMat3, DVec3};

use super::double::{Double, MIN_PRODUCT};

/// Bound on the error of a rounded height, in multiples of the product of the lengths of normal and vertex.
const HEIGHT_ERROR: f64 = 16.0 * 0.5 * f64::EPSILON;

/// Vertices of a body in its frame, and the nine entries of its rotation.
pub type RotatedVertices<'a> = (&'a [DVec3], &'a DMat3);

/// Computes a lower bound of `min_Q n.q - max_P n.p`, where `Q` is displaced by the sum of `offset`. The
/// bound is below the exact distance by little more than one rounding.
#[inline]
pub fn distance_lower_bound(
    normal: DVec3,
    fixed: RotatedVertices,
    moving: RotatedVertices,
    offset: [DVec3; 2],
) -> f64 {
    let mut sum = Double::ZERO;
    for part in offset {
        add_dot_product(&mut sum, normal, part);
    }
    for height in [max_height(fixed, -normal), max_height(moving, normal)] {
        sum.add_number(-height.high);
        sum.add_low(-height.low);
        sum.error += height.error;
    }
    enclosing_bounds(sum)[0]
}

/// Computes lower and upper bounds of `a . b`.
#[inline]
pub fn dot_bounds(a: DVec3, b: DVec3) -> [f64; 2] {
    let mut sum = Double::ZERO;
    add_dot_product(&mut sum, a, b);
    enclosing_bounds(sum)
}

/// Adds `a . b` to a sum.
#[inline]
fn add_dot_product(sum: &mut Double, a: DVec3, b: DVec3) {
    for k in 0..3 {
        sum.add_product(a[k], b[k]);
    }
}

/// Returns lower and upper bounds of a sum of products, of which any may have underflowed.
#[inline]
fn enclosing_bounds(sum: Double) -> [f64; 2] {
    let sum = sum.normalized();
    let error = 1.01 * sum.error + MIN_PRODUCT;
    // Half a rounding of `high` exceeds `low`, and one more rounding exceeds the errors of these sums.
    let bound = |sign: f64| sum.high + (sum.low + sign * error);
    [bound(-1.0).next_down(), bound(1.0).next_up()]
}

/// Computes the height of the highest vertex along `normal`; minus infinity if there are no vertices.
#[inline]
fn max_height((points, matrix): RotatedVertices, normal: DVec3) -> Double {
    let in_body = matrix.transpose() * normal;
    let reach = points.iter().map(|v| v.length_squared()).fold(0.0, f64::max).sqrt();
    // Twice the bound, because the highest vertex and another one both have errors.
    let tie = 2.0 * HEIGHT_ERROR * reach * normal.length() + MIN_PRODUCT;
    let top = points.iter().map(|v| in_body.dot(*v)).fold(f64::NEG_INFINITY, f64::max);
    let mut most = Double { high: f64::NEG_INFINITY, ..Double::ZERO };
    let mut error = 0.0_f64;
    for v in points.iter().filter(|v| in_body.dot(**v) >= top - tie) {
        let height = vertex_height(matrix, normal, *v);
        error = error.max(height.error);
        if (height.high, height.low) > (most.high, most.low) {
            most = height;
        }
    }
    Double { error, ..most }
}

/// Computes the height `n . R v`.
#[inline]
fn vertex_height(matrix: &DMat3, normal: DVec3, v: DVec3) -> Double {
    let mut sum = Double::ZERO;
    for row in 0..3 {
        let mut coordinate = Double::ZERO;
        for column in 0..3 {
            coordinate.add_product(matrix.col(column)[row], v[column]);
        }
        sum.add_scaled(&coordinate.normalized(), normal[row]);
    }
    sum.normalized()
}

#[cfg(test)]
mod tests {
    use dashu_ratio::RBig;
    use glam::DQuat;
    use proptest::prelude::*;

    use super::*;
    use crate::tests::rational;

    /// Points with coordinates of similar magnitude, with ties.
    fn tied_point() -> impl Strategy<Value = DVec3> {
        let coordinate = || prop_oneof![(-3_i32..=3).prop_map(f64::from), -3.0..3.0_f64];
        [coordinate(), coordinate(), coordinate()].prop_map(DVec3::from_array)
    }

    /// Returns the exact height `n . R v`.
    fn exact_height(matrix: &DMat3, normal: DVec3, v: DVec3) -> RBig {
        let mut sum = RBig::ZERO;
        for row in 0..3 {
            for column in 0..3 {
                let entry = rational(matrix.col(column)[row]);
                sum += rational(normal[row]) * entry * rational(v[column]);
            }
        }
        sum
    }

    /// Returns the rotation of the normalised quaternion with imaginary part `by` and real part 1.
    fn rotation_from(by: DVec3) -> DMat3 {
        DMat3::from_quat(DQuat::from_xyzw(by.x, by.y, by.z, 1.0).normalize())
    }

    proptest! {
        #[test]
        fn distances_are_tight_lower_bounds(
            fixed in prop::collection::vec(tied_point(), 1..12),
            moving in prop::collection::vec(tied_point(), 1..12),
            turns in [tied_point(), tied_point()],
            normal in tied_point(),
            offset in tied_point(),
        ) {
            let turns = turns.map(rotation_from);
            let normal = normal.normalize_or(DVec3::X);
            let offset = [offset, offset * 1e-17];
            let heights = |points: &[DVec3], k: usize| -> Vec<RBig> {
                points.iter().map(|v| exact_height(&turns[k], normal, *v)).collect()
            };
            let low = heights(&fixed, 0).into_iter().min().unwrap();
            let high = heights(&moving, 1).into_iter().max().unwrap();
            let between = offset.map(|part| exact_height(&DMat3::IDENTITY, normal, part));
            let truth = low - high + &between[0] + &between[1];
            let found = distance_lower_bound(normal, (&fixed, &turns[0]), (&moving, &turns[1]), offset);
            prop_assert!(rational(found) <= truth);
            let less = truth.to_f64().value() - found;
            prop_assert!(less <= 2.0 * f64::EPSILON * found.abs() + 1e-30, "{less:e}");
        }

        #[test]
        fn dot_product_is_strictly_inside_bounds(a in tied_point(), b in tied_point()) {
            let truth = exact_height(&DMat3::IDENTITY, a, b);
            let [low, high] = dot_bounds(a, b);
            prop_assert!(rational(low) < truth && truth < rational(high));
            prop_assert!(high - low <= 2.0 * f64::EPSILON * high.abs() + 1e-30);
        }
    }
}
