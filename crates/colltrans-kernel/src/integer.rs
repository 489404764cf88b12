//! Exact integers of fixed capacity, for signs that rounded numbers leave uncertain.
//!
//! An [`Integer`] is `limbs 2^(64 base)`. Coordinates are dyadic rationals, so that sums and products of them
//! are exact. Invariants:
//!
//! - Nothing is allocated on the heap.
//! - [`LARGE_LIMBS`] limbs suffice for every determinant of coordinates (`docs/theory/exact-arithmetic.md`).
//! - [`SMALL_LIMBS`] limbs suffice for almost all coordinates. Callers try them first, because copying a number
//!   costs more than multiplying it. A result that may not fit is marked as overflown.

use std::cmp::Ordering;

use crate::visit_counter;

/// Number of limbs for coordinates of usual size.
pub const SMALL_LIMBS: usize = 15;
/// Number of limbs that suffices for every determinant.
pub const LARGE_LIMBS: usize = 48;
/// Number of limbs that suffices for the product of two determinants.
pub const PRODUCT_LIMBS: usize = 2 * LARGE_LIMBS;

/// An integer with a sign, times a power of `2^64`.
#[derive(Clone, Copy)]
pub struct Integer<const N: usize> {
    negative: bool,
    /// Whether the number did not fit; the other fields are meaningless then.
    overflown: bool,
    /// Exponent of the lowest limb, in powers of `2^64`.
    base: i16,
    /// Number of limbs in use; the highest and the lowest are not zero.
    len: u16,
    limbs: [u64; N],
}

impl<const N: usize> Integer<N> {
    pub const ZERO: Self =
        Self { negative: false, overflown: false, base: 0, len: 0, limbs: [0; N] };
    const OVERFLOWN: Self = Self { overflown: true, ..Self::ZERO };

    /// Returns `a b` exactly.
    #[inline]
    pub fn exact_product(a: f64, b: f64) -> Self {
        if a == 0.0 || b == 0.0 {
            return Self::ZERO;
        }
        let ((m, e), (n, f)) = (mantissa_and_exponent(a), mantissa_and_exponent(b));
        let negative = a.is_sign_negative() != b.is_sign_negative();
        let bits = u128::from(m) * u128::from(n);
        let exponent = e + f;
        let mut result =
            Self { negative, base: exponent.div_euclid(64) as i16, len: 3, ..Self::ZERO };
        let bit = exponent.rem_euclid(64);
        let low = u128::from(bits as u64) << bit;
        let high = (u128::from((bits >> 64) as u64) << bit) + (low >> 64);
        (result.limbs[0], result.limbs[1], result.limbs[2]) =
            (low as u64, high as u64, (high >> 64) as u64);
        result.remove_zero_limbs();
        result
    }

    /// Returns `a` exactly.
    #[inline]
    pub fn exact_number(a: f64) -> Self {
        Self::exact_product(a, 1.0)
    }

    /// Removes zero limbs at both ends.
    #[inline]
    fn remove_zero_limbs(&mut self) {
        while self.len > 0 && self.limbs[usize::from(self.len) - 1] == 0 {
            self.len -= 1;
        }
        let used = usize::from(self.len);
        let zeros = self.limbs[..used].iter().take_while(|&&l| l == 0).count();
        if zeros > 0 {
            self.limbs.copy_within(zeros..used, 0);
            self.limbs[used - zeros..used].fill(0);
            self.len -= zeros as u16;
            self.base += zeros as i16;
        }
        if self.len == 0 {
            (self.base, self.negative) = (0, false);
        }
    }

    /// Returns the exponent after the highest limb.
    #[inline]
    fn exponent_end(&self) -> i16 {
        self.base + self.len as i16
    }

    /// Returns the limb with an exponent; 0 outside of the limbs in use.
    #[inline]
    fn limb_at(&self, exponent: i16) -> u64 {
        let k = exponent - self.base;
        if k >= 0 && k < self.len as i16 { self.limbs[k as usize] } else { 0 }
    }

    #[inline]
    fn compare_magnitude(&self, other: &Self) -> Ordering {
        let low = self.base.min(other.base);
        self.exponent_end().cmp(&other.exponent_end()).then_with(|| {
            let exponents = (low..self.exponent_end()).rev();
            exponents
                .map(|e| self.limb_at(e).cmp(&other.limb_at(e)))
                .find(|o| o.is_ne())
                .unwrap_or(Ordering::Equal)
        })
    }

    /// Returns the sum, marked as overflown if it may not fit.
    #[must_use]
    #[inline]
    pub fn add(&self, other: &Self) -> Self {
        self.add_with_sign(other, other.negative)
    }

    /// Returns the difference, marked as overflown if it may not fit.
    #[must_use]
    #[inline]
    pub fn subtract(&self, other: &Self) -> Self {
        self.add_with_sign(other, !other.negative)
    }

    /// Returns `self` plus the magnitude of `other` with the given sign.
    #[inline]
    fn add_with_sign(&self, other: &Self, negative: bool) -> Self {
        if self.overflown || other.overflown {
            return Self::OVERFLOWN;
        }
        if other.len == 0 {
            return *self;
        }
        if self.len == 0 {
            return Self { negative, ..*other };
        }
        if self.negative == negative {
            return self.add_magnitude(other);
        }
        match self.compare_magnitude(other) {
            Ordering::Less => other.subtract_magnitude(self, negative),
            Ordering::Equal => Self::ZERO,
            Ordering::Greater => self.subtract_magnitude(other, self.negative),
        }
    }

    /// Returns the sum of both magnitudes, with the sign of `self`.
    #[inline]
    fn add_magnitude(&self, other: &Self) -> Self {
        let base = self.base.min(other.base);
        let count = (self.exponent_end().max(other.exponent_end()) - base) as usize;
        if count + 1 > N {
            return Self::OVERFLOWN;
        }
        let mut sum = Self { negative: self.negative, base, len: count as u16 + 1, ..Self::ZERO };
        let mut carry = false;
        for (k, limb) in sum.limbs[..count].iter_mut().enumerate() {
            let e = base + k as i16;
            let (s, c) = self.limb_at(e).overflowing_add(other.limb_at(e));
            let (s, d) = s.overflowing_add(u64::from(carry));
            *limb = s;
            carry = c || d;
        }
        sum.limbs[count] = u64::from(carry);
        sum.remove_zero_limbs();
        sum
    }

    /// Returns the magnitude of `self` minus that of `smaller`, with the given sign.
    #[inline]
    fn subtract_magnitude(&self, smaller: &Self, negative: bool) -> Self {
        let base = self.base.min(smaller.base);
        let count = (self.exponent_end() - base) as usize;
        if count > N {
            return Self::OVERFLOWN;
        }
        let mut rest = Self { negative, base, len: count as u16, ..Self::ZERO };
        let mut borrow = false;
        for (k, limb) in rest.limbs[..count].iter_mut().enumerate() {
            let e = base + k as i16;
            let (s, c) = self.limb_at(e).overflowing_sub(smaller.limb_at(e));
            let (s, d) = s.overflowing_sub(u64::from(borrow));
            *limb = s;
            borrow = c || d;
        }
        rest.remove_zero_limbs();
        rest
    }

    /// Returns the product, marked as overflown if it may not fit.
    #[must_use]
    pub fn multiply(&self, other: &Self) -> Self {
        if self.overflown || other.overflown {
            return Self::OVERFLOWN;
        }
        let (m, n) = (usize::from(self.len), usize::from(other.len));
        if m == 0 || n == 0 {
            return Self::ZERO;
        }
        if m + n > N {
            return Self::OVERFLOWN;
        }
        let mut result = Self {
            negative: self.negative != other.negative,
            base: self.base + other.base,
            len: (m + n) as u16,
            ..Self::ZERO
        };
        for i in 0..m {
            let mut carry = 0_u128;
            for j in 0..n {
                let wide = u128::from(self.limbs[i]) * u128::from(other.limbs[j])
                    + u128::from(result.limbs[i + j])
                    + carry;
                result.limbs[i + j] = wide as u64;
                carry = wide >> 64;
            }
            result.limbs[i + n] = carry as u64;
        }
        result.remove_zero_limbs();
        result
    }

    /// Returns the sign; `None` if the number did not fit.
    #[inline]
    pub fn sign(&self) -> Option<Ordering> {
        match (self.overflown, self.len, self.negative) {
            (true, ..) => None,
            (_, 0, _) => Some(Ordering::Equal),
            (_, _, true) => Some(Ordering::Less),
            (_, _, false) => Some(Ordering::Greater),
        }
    }

    /// Returns `(m, e)` so that `m 2^e` equals the number with a relative error of at most `2^-52`.
    #[inline]
    fn leading_bits(&self) -> (f64, i32) {
        if self.len == 0 {
            return (0.0, 0);
        }
        let top = self.exponent_end() - 1;
        let bits = u128::from(self.limb_at(top)) << 64 | u128::from(self.limb_at(top - 1));
        let magnitude = bits as f64;
        (if self.negative { -magnitude } else { magnitude }, 64 * (i32::from(top) - 1))
    }

    /// Returns `self / other` with a relative error of a few roundings; `None` if one of them did not fit. The
    /// result is not finite if `other` is 0.
    #[inline]
    pub fn ratio(&self, other: &Self) -> Option<f64> {
        if self.overflown || other.overflown {
            return None;
        }
        let ((n, i), (d, j)) = (self.leading_bits(), other.leading_bits());
        let (quotient, exponent) = (n / d, i - j);
        let half = exponent / 2;
        Some(quotient * 2.0_f64.powi(half) * 2.0_f64.powi(exponent - half))
    }
}

/// Decomposes a number into mantissa and exponent: `|x| = mantissa 2^exponent`.
#[inline]
pub(crate) fn mantissa_and_exponent(x: f64) -> (u64, i32) {
    let bits = x.to_bits();
    let fraction = bits & ((1 << 52) - 1);
    let exponent = (bits >> 52 & 0x7ff) as i32;
    if exponent == 0 { (fraction, -1074) } else { (fraction | 1 << 52, exponent - 1075) }
}

/// Computes `det[a, b, c]`.
#[inline]
pub fn determinant<const N: usize>(
    a: &[Integer<N>; 3],
    b: &[Integer<N>; 3],
    c: &[Integer<N>; 3],
) -> Integer<N> {
    visit_counter::count_visits(1);
    let mut sum = Integer::ZERO;
    for (k, component) in a.iter().enumerate() {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        let minor = b[i].multiply(&c[j]).subtract(&b[j].multiply(&c[i]));
        sum = sum.add(&component.multiply(&minor));
    }
    sum
}

/// Computes `a - b` for each component.
#[inline]
pub fn difference<const N: usize>(a: &[Integer<N>; 3], b: &[Integer<N>; 3]) -> [Integer<N>; 3] {
    std::array::from_fn(|k| a[k].subtract(&b[k]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use dashu_ratio::RBig;
    use proptest::prelude::*;

    fn rational(x: f64) -> RBig {
        RBig::try_from(x).unwrap()
    }

    /// Random numbers of very different magnitudes, with zeros and ties.
    fn any_number() -> impl Strategy<Value = f64> {
        prop_oneof![
            Just(0.0),
            (-4_i32..=4).prop_map(f64::from),
            -1.0..1.0_f64,
            (-1.0..1.0_f64, -180_i32..180).prop_map(|(x, e)| x * 2.0_f64.powi(e)),
        ]
    }

    proptest! {
        #[test]
        fn sums_of_products_agree_with_rationals(
            a in any_number(), b in any_number(), c in any_number(), d in any_number(),
        ) {
            let expected = rational(a) * rational(b) + rational(c) * rational(d);
            let sign = Some(expected.cmp(&RBig::ZERO));
            let large = Integer::<LARGE_LIMBS>::exact_product(a, b).add(&Integer::exact_product(c, d));
            prop_assert_eq!(large.sign(), sign);
            let small = Integer::<SMALL_LIMBS>::exact_product(a, b).add(&Integer::exact_product(c, d)).sign();
            prop_assert!(small.is_none() || small == sign);
        }

        #[test]
        fn determinants_and_ratios_agree_with_rationals(
            numbers in prop::array::uniform9(any_number()), w in any_number(), z in any_number(),
        ) {
            let coordinate = |k: usize| Integer::<LARGE_LIMBS>::exact_product(numbers[k], w).add(&Integer::exact_number(z));
            let small = |k: usize| Integer::<SMALL_LIMBS>::exact_product(numbers[k], w).add(&Integer::exact_number(z));
            let exact = |k: usize| rational(numbers[k]) * rational(w) + rational(z);
            let row = |r: usize| [coordinate(r), coordinate(r + 1), coordinate(r + 2)];
            let det = determinant(&row(0), &row(3), &row(6));
            let minor = |a: usize, b: usize| exact(3 + a) * exact(6 + b) - exact(3 + b) * exact(6 + a);
            let expected = exact(0) * minor(1, 2) + exact(1) * minor(2, 0) + exact(2) * minor(0, 1);
            let sign = Some(expected.cmp(&RBig::ZERO));
            prop_assert_eq!(det.sign(), sign);
            let row = |r: usize| [small(r), small(r + 1), small(r + 2)];
            let small = determinant(&row(0), &row(3), &row(6)).sign();
            prop_assert!(small.is_none() || small == sign);
            let cube = coordinate(0).multiply(&coordinate(0)).multiply(&coordinate(0));
            let cubed = exact(0) * exact(0) * exact(0);
            if cubed != RBig::ZERO {
                let (found, right) = (det.ratio(&cube).unwrap(), (expected / cubed).to_f64().value());
                let far = !(1e-290..1e290).contains(&right.abs()) && right != 0.0;
                prop_assert!(far || (found - right).abs() <= 1e-14 * right.abs(), "{found} {right}");
            }
        }
    }
}
