//! How far points reach along a normal, with a bound that is one.
//!
//! Notation. `n` is a normal of the world, `R` a body's nine entries, `v` its points; the *height* of
//! `v` is `n . R v`, a sum of nine products of three numbers. It is first computed in the body's
//! frame, as `(R^T n) . v`: off by at most `3 u + 3 u` of `sqrt(3) |n| |R v|`, for which
//! [`HEIGHT`] is a bound with half as much again. Those that may be the highest are computed once
//! more, in twice the usual precision, with a bound on what that lost.

use glam::{DMat3, DVec3};

use super::double::{Double, LEAST_PRODUCT};

/// Error of a rounded height, in multiples of the product of the lengths.
const HEIGHT: f64 = 16.0 * 0.5 * f64::EPSILON;

/// Points of a body, and where it is.
pub type Placed<'a> = (&'a [DVec3], &'a DMat3);

/// At most `min_Q n.q - max_P n.p`, and less by hardly more than a rounding: `Q` is displaced by the
/// sum of `offset`.
#[inline]
pub fn distance(normal: DVec3, fixed: Placed, moving: Placed, offset: [DVec3; 2]) -> f64 {
    let mut sum = Double::ZERO;
    for part in offset {
        add_dot(&mut sum, normal, part);
    }
    for height in [highest(fixed, -normal), highest(moving, normal)] {
        sum.add(-height.high);
        sum.add_low(-height.low);
        sum.error += height.error;
    }
    enclosed(sum)[0]
}

/// The numbers between which `a . b` lies.
#[inline]
pub fn dot(a: DVec3, b: DVec3) -> [f64; 2] {
    let mut sum = Double::ZERO;
    add_dot(&mut sum, a, b);
    enclosed(sum)
}

#[inline]
fn add_dot(sum: &mut Double, a: DVec3, b: DVec3) {
    for k in 0..3 {
        sum.add_product(a[k], b[k]);
    }
}

/// Where a sum of products is, whatever of them underflowed.
#[inline]
fn enclosed(sum: Double) -> [f64; 2] {
    let sum = sum.tidy();
    let error = 1.01 * sum.error + LEAST_PRODUCT;
    // Half a rounding of `high` is more than `low`, and one more than what these sums lose.
    let bound = |sign: f64| sum.high + (sum.low + sign * error);
    [bound(-1.0).next_down(), bound(1.0).next_up()]
}

/// The height of the highest point along `normal`; minus infinity if there are none.
#[inline]
fn highest((points, matrix): Placed, normal: DVec3) -> Double {
    let in_body = matrix.transpose() * normal;
    let reach = points.iter().map(|v| v.length_squared()).fold(0.0, f64::max).sqrt();
    // Both the highest one and another may be off.
    let tie = 2.0 * HEIGHT * reach * normal.length() + LEAST_PRODUCT;
    let top = points.iter().map(|v| in_body.dot(*v)).fold(f64::NEG_INFINITY, f64::max);
    let mut most = Double { high: f64::NEG_INFINITY, ..Double::ZERO };
    let mut error = 0.0_f64;
    for v in points.iter().filter(|v| in_body.dot(**v) >= top - tie) {
        let height = height(matrix, normal, *v);
        error = error.max(height.error);
        if (height.high, height.low) > (most.high, most.low) {
            most = height;
        }
    }
    Double { error, ..most }
}

/// `n . R v`.
#[inline]
fn height(matrix: &DMat3, normal: DVec3, v: DVec3) -> Double {
    let mut sum = Double::ZERO;
    for row in 0..3 {
        let mut coordinate = Double::ZERO;
        for column in 0..3 {
            coordinate.add_product(matrix.col(column)[row], v[column]);
        }
        sum.add_scaled(&coordinate.tidy(), normal[row]);
    }
    sum.tidy()
}

#[cfg(test)]
mod tests {
    use dashu_ratio::RBig;
    use glam::DQuat;
    use proptest::prelude::*;

    use super::*;
    use crate::tests::rational;

    /// Coordinates of one size, with ties.
    fn point() -> impl Strategy<Value = DVec3> {
        let coordinate = || prop_oneof![(-3_i32..=3).prop_map(f64::from), -3.0..3.0_f64];
        [coordinate(), coordinate(), coordinate()].prop_map(DVec3::from_array)
    }

    fn exact(matrix: &DMat3, normal: DVec3, v: DVec3) -> RBig {
        let mut sum = RBig::ZERO;
        for row in 0..3 {
            for column in 0..3 {
                let entry = rational(matrix.col(column)[row]);
                sum += rational(normal[row]) * entry * rational(v[column]);
            }
        }
        sum
    }

    fn turned(by: DVec3) -> DMat3 {
        DMat3::from_quat(DQuat::from_xyzw(by.x, by.y, by.z, 1.0).normalize())
    }

    proptest! {
        #[test]
        fn distances_are_bounds_and_hardly_rounded(
            fixed in prop::collection::vec(point(), 1..12),
            moving in prop::collection::vec(point(), 1..12),
            turns in [point(), point()],
            normal in point(),
            offset in point(),
        ) {
            let turns = turns.map(turned);
            let normal = normal.normalize_or(DVec3::X);
            let offset = [offset, offset * 1e-17];
            let heights = |points: &[DVec3], k: usize| -> Vec<RBig> {
                points.iter().map(|v| exact(&turns[k], normal, *v)).collect()
            };
            let low = heights(&fixed, 0).into_iter().min().unwrap();
            let high = heights(&moving, 1).into_iter().max().unwrap();
            let between = offset.map(|part| exact(&DMat3::IDENTITY, normal, part));
            let truth = low - high + &between[0] + &between[1];
            let found = distance(normal, (&fixed, &turns[0]), (&moving, &turns[1]), offset);
            prop_assert!(rational(found) <= truth);
            let less = truth.to_f64().value() - found;
            prop_assert!(less <= 2.0 * f64::EPSILON * found.abs() + 1e-30, "{less:e}");
        }

        #[test]
        fn products_are_enclosed(a in point(), b in point()) {
            let truth = exact(&DMat3::IDENTITY, a, b);
            let [low, high] = dot(a, b);
            prop_assert!(rational(low) < truth && truth < rational(high));
            prop_assert!(high - low <= 2.0 * f64::EPSILON * high.abs() + 1e-30);
        }
    }
}
