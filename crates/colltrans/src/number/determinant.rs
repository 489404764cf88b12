//! Determinants without cancellation.

use glam::{DVec2, DVec3, Vec3Swizzles};

use super::error_free::product_error;

/// `a.x b.y - a.y b.x` with an error relative to the result, not to its terms.
#[inline]
pub(crate) fn accurate_det(a: DVec2, b: DVec2) -> f64 {
    let (p, q) = (a.x * b.y, a.y * b.x);
    if (p - q).abs() > 0.25 * (p.abs() + q.abs()) {
        // Little cancels: the roundings of both products are a few of the result's.
        return p - q;
    }
    (p - q) + (product_error(a.x, b.y, p) - product_error(a.y, b.x, q))
}

/// `a x b` with an error relative to each component.
#[inline]
pub(crate) fn accurate_cross(a: DVec3, b: DVec3) -> DVec3 {
    DVec3::new(
        accurate_det(a.yz(), b.yz()),
        accurate_det(a.zx(), b.zx()),
        accurate_det(a.xy(), b.xy()),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::number::tests::rational;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn accurate_determinants_are(a in 0.5..1.0_f64, b in 0.5..1.0_f64, k in 1..1_000_i32) {
            // Nearly parallel: the terms agree to 10 digits or more.
            let tiny = f64::from(k) * 1e-13;
            let (v, w) = (DVec2::new(a, b), DVec2::new(a + tiny, b));
            let exact = rational(v.x) * rational(w.y) - rational(v.y) * rational(w.x);
            let off = (rational(accurate_det(v, w)) - exact.clone()).to_f64().value();
            prop_assert!(off.abs() <= 4.0 * f64::EPSILON * exact.to_f64().value().abs());
        }
    }
}
