//! Determinants of 2 x 2 matrices, cross products and triangle areas without cancellation.

use glam::{DVec2, DVec3, Vec3Swizzles};

use super::double::Double;
use super::error_free::product_error;

/// Computes `a.x b.y - a.y b.x` with an error relative to the result, not to its terms.
#[inline]
pub fn accurate_det(a: DVec2, b: DVec2) -> f64 {
    let (p, q) = (a.x * b.y, a.y * b.x);
    if (p - q).abs() > 0.25 * (p.abs() + q.abs()) {
        // There is little cancellation, so both products are rounded by a few roundings of the result.
        return p - q;
    }
    (p - q) + (product_error(a.x, b.y, p) - product_error(a.y, b.x, q))
}

/// Computes `a x b` with an error relative to each component.
#[inline]
pub fn accurate_cross(a: DVec3, b: DVec3) -> DVec3 {
    DVec3::new(
        accurate_det(a.yz(), b.yz()),
        accurate_det(a.zx(), b.zx()),
        accurate_det(a.xy(), b.xy()),
    )
}

/// Computes twice the area of the triangle `a b c`, positive if counter-clockwise. The error is one rounding of
/// the result, plus about `2^-100` times the product of the triangle's extents. Therefore the area of a sliver
/// is accurate relative to itself, unless it is near `2^-100` of that product.
#[inline]
pub fn triangle_area(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    let mut sum = Double::ZERO;
    for (to_b, to_c, sign) in [
        (Double::exact_difference(b.x, a.x), Double::exact_difference(c.y, a.y), 1.0),
        (Double::exact_difference(b.y, a.y), Double::exact_difference(c.x, a.x), -1.0),
    ] {
        sum.add_double_product(&to_b, &to_c, sign);
    }
    sum.rounded_value()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::rational;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn determinants_of_nearly_parallel_vectors_are_accurate(
            a in 0.5..1.0_f64, b in 0.5..1.0_f64, k in 1..1_000_i32,
        ) {
            // Nearly parallel vectors: the terms agree in 10 digits or more.
            let tiny = f64::from(k) * 1e-13;
            let (v, w) = (DVec2::new(a, b), DVec2::new(a + tiny, b));
            let exact = rational(v.x) * rational(w.y) - rational(v.y) * rational(w.x);
            let off = (rational(accurate_det(v, w)) - exact.clone()).to_f64().value();
            prop_assert!(off.abs() <= 4.0 * f64::EPSILON * exact.to_f64().value().abs());
        }

        #[test]
        fn sliver_areas_are_accurate(
            a in -1.0..1.0_f64, b in -1.0..1.0_f64, k in -30..30_i32, l in -30..30_i32, s in 0.0..2.0_f64,
        ) {
            // Nearly collinear points: the third is a few roundings off the line.
            let off = DVec2::new(f64::from(k), f64::from(l)) * 2.0_f64.powi(-54);
            let [p, q] = [DVec2::new(a, b), DVec2::new(b, -0.7 * a)];
            let r = p.lerp(q, s) + off;
            let d = |to: f64, from: f64| rational(to) - rational(from);
            let exact = d(q.x, p.x) * d(r.y, p.y) - d(q.y, p.y) * d(r.x, p.x);
            let error = (rational(triangle_area(p, q, r)) - exact.clone()).to_f64().value().abs();
            let exact = exact.to_f64().value().abs();
            prop_assert!(error <= 2.0_f64.powi(-98) + f64::EPSILON * exact, "{error:e} of {exact:e}");
        }
    }
}
