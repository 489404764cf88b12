//! Error-free transformations: the rounding error of a sum, a difference or a product as an exact number.

#![expect(clippy::inline_always, reason = "inlining keeps the sums in registers")]

/// Returns the exact rounding error `a + b - s` of the sum `s = fl(a + b)` (Knuth).
#[inline(always)]
pub fn sum_error(a: f64, b: f64, s: f64) -> f64 {
    let b_virtual = s - a;
    let a_virtual = s - b_virtual;
    (a - a_virtual) + (b - b_virtual)
}

/// Returns the exact rounding error of `a - b`, so that `a - b = fl(a - b) + error`.
#[inline]
pub fn difference_error(a: f64, b: f64) -> f64 {
    let difference = a - b;
    let b_virtual = a - difference;
    let a_virtual = difference + b_virtual;
    (a - a_virtual) + (b_virtual - b)
}

/// Returns the exact rounding error `a b - p` of the product `p = fl(a b)` (Dekker).
#[inline]
pub fn product_error(a: f64, b: f64, p: f64) -> f64 {
    let ((a_high, a_low), (b_high, b_low)) = (split_mantissa(a), split_mantissa(b));
    a_low * b_low - (((p - a_high * b_high) - a_low * b_high) - a_high * b_low)
}

/// Splits `a` into a sum of two numbers with at most 26 significant bits (Veltkamp).
#[inline]
pub fn split_mantissa(a: f64) -> (f64, f64) {
    const SPLITTER: f64 = ((1_u64 << 27) + 1) as f64;
    let c = SPLITTER * a;
    let high = c - (c - a);
    (high, a - high)
}

#[cfg(test)]
mod tests {
    use dashu_ratio::RBig;
    use proptest::prelude::*;

    use super::difference_error;
    use crate::tests::{any_number, rational};

    proptest! {
        #[test]
        fn difference_errors_are_exact(a in any_number(), b in any_number()) {
            let sum: RBig = rational(a - b) + rational(difference_error(a, b));
            prop_assert_eq!(sum, rational(a) - rational(b));
        }
    }
}
