//! Whole numbers of fixed capacity, for the signs that rounding cannot tell.
//!
//! Coordinates are dyadic rationals: an integer times `2^UNIT` each. The door admits magnitudes
//! from `2^-200` to `2^200` with 53 significant bits, so a product of two spans `2^-505..2^400`,
//! and with barycentric weights that are multiples of `1/64` the unit `2^-512` is fine enough. A
//! coordinate (eight terms) stays below `2^404`: 917 bits. A determinant of three differences has at
//! most `3 * 918 + 3 = 2757` bits, 44 limbs. Nothing is allocated; only the limbs between the lowest
//! and the highest that are not zero are worked on, few for numbers of ordinary size.

use std::cmp::Ordering;

const LIMBS: usize = 48;

/// Exponent of the unit of a coordinate.
const UNIT: i32 = -512;

/// An integer with a sign. Limbs outside `low..high` are zero.
#[derive(Clone, Copy)]
pub(super) struct Wide {
    negative: bool,
    low: usize,
    high: usize,
    limbs: [u64; LIMBS],
}

impl Wide {
    pub(super) const ZERO: Self = Self { negative: false, low: 0, high: 0, limbs: [0; LIMBS] };

    /// `a b / 2^UNIT`, exactly.
    pub(super) fn product(a: f64, b: f64) -> Self {
        if a == 0.0 || b == 0.0 {
            return Self::ZERO;
        }
        let ((m, e), (n, f)) = (decode(a), decode(b));
        let negative = a.is_sign_negative() != b.is_sign_negative();
        Self::shifted(u128::from(m) * u128::from(n), e + f - UNIT, negative)
    }

    /// `a / 2^UNIT`, exactly.
    pub(super) fn number(a: f64) -> Self {
        Self::product(a, 1.0)
    }

    /// `bits 2^shift`; a negative shift only takes zeros away, by the range of admitted numbers.
    fn shifted(bits: u128, shift: i32, negative: bool) -> Self {
        let (bits, shift) = if shift < 0 { (bits >> -shift, 0) } else { (bits, shift) };
        let mut result = Self { negative, ..Self::ZERO };
        let (limb, bit) = (shift as usize / 64, shift as usize % 64);
        for (k, part) in [bits as u64, (bits >> 64) as u64].into_iter().enumerate() {
            let wide = u128::from(part) << bit;
            result.limbs[limb + k] |= wide as u64;
            result.limbs[limb + k + 1] |= (wide >> 64) as u64;
        }
        (result.low, result.high) = (limb, limb + 3);
        result.trim();
        result
    }

    fn trim(&mut self) {
        while self.high > self.low && self.limbs[self.high - 1] == 0 {
            self.high -= 1;
        }
        while self.low < self.high && self.limbs[self.low] == 0 {
            self.low += 1;
        }
        if self.low == self.high {
            (self.low, self.high, self.negative) = (0, 0, false);
        }
    }

    pub(super) fn negate(mut self) -> Self {
        self.negative = !self.negative && self.high > 0;
        self
    }

    fn compare_magnitude(&self, other: &Self) -> Ordering {
        let low = self.low.min(other.low);
        self.high.cmp(&other.high).then_with(|| {
            let (a, b) = (&self.limbs[low..self.high], &other.limbs[low..other.high]);
            a.iter().rev().cmp(b.iter().rev())
        })
    }

    pub(super) fn add(&self, other: &Self) -> Self {
        if self.high == 0 {
            return *other;
        }
        if other.high == 0 {
            return *self;
        }
        if self.negative == other.negative {
            return self.add_magnitude(other);
        }
        match self.compare_magnitude(other) {
            Ordering::Less => other.subtract_magnitude(self),
            Ordering::Equal => Self::ZERO,
            Ordering::Greater => self.subtract_magnitude(other),
        }
    }

    pub(super) fn subtract(&self, other: &Self) -> Self {
        self.add(&other.negate())
    }

    fn add_magnitude(&self, other: &Self) -> Self {
        let mut sum = *self;
        sum.low = self.low.min(other.low);
        sum.high = self.high.max(other.high) + 1;
        let mut carry = false;
        for k in sum.low..sum.high {
            let (s, c) = self.limbs[k].overflowing_add(other.limbs[k]);
            let (s, d) = s.overflowing_add(u64::from(carry));
            sum.limbs[k] = s;
            carry = c || d;
        }
        sum.trim();
        sum
    }

    /// The larger magnitude minus the smaller one, with the sign of the larger.
    fn subtract_magnitude(&self, smaller: &Self) -> Self {
        let mut rest = *self;
        rest.low = self.low.min(smaller.low);
        let mut borrow = false;
        for k in rest.low..rest.high {
            let (s, c) = self.limbs[k].overflowing_sub(smaller.limbs[k]);
            let (s, d) = s.overflowing_sub(u64::from(borrow));
            rest.limbs[k] = s;
            borrow = c || d;
        }
        rest.trim();
        rest
    }

    pub(super) fn multiply(&self, other: &Self) -> Self {
        let mut result = Self::ZERO;
        if self.high == 0 || other.high == 0 {
            return result;
        }
        result.negative = self.negative != other.negative;
        for i in self.low..self.high {
            let mut carry = 0_u128;
            for j in other.low..other.high {
                let wide = u128::from(self.limbs[i]) * u128::from(other.limbs[j])
                    + u128::from(result.limbs[i + j])
                    + carry;
                result.limbs[i + j] = wide as u64;
                carry = wide >> 64;
            }
            result.limbs[i + other.high] = carry as u64;
        }
        (result.low, result.high) = (self.low + other.low, self.high + other.high);
        result.trim();
        result
    }

    pub(super) fn sign(&self) -> Ordering {
        match (self.high, self.negative) {
            (0, _) => Ordering::Equal,
            (_, true) => Ordering::Less,
            (_, false) => Ordering::Greater,
        }
    }

    /// `m 2^e` to within `2^-52` of itself.
    fn leading(&self) -> (f64, i32) {
        if self.high == 0 {
            return (0.0, 0);
        }
        let top = self.high - 1;
        let below = if top > 0 { self.limbs[top - 1] } else { 0 };
        let bits = u128::from(self.limbs[top]) << 64 | u128::from(below);
        let magnitude = bits as f64;
        (if self.negative { -magnitude } else { magnitude }, 64 * (top as i32 - 1))
    }

    /// `self / other`, to within a few roundings of itself, for numbers in the same unit.
    pub(super) fn ratio(&self, other: &Self) -> f64 {
        let ((n, i), (d, j)) = (self.leading(), other.leading());
        let (quotient, exponent) = (n / d, i - j);
        let half = exponent / 2;
        quotient * 2.0_f64.powi(half) * 2.0_f64.powi(exponent - half)
    }
}

/// Mantissa and exponent: `|x| = mantissa 2^exponent`.
fn decode(x: f64) -> (u64, i32) {
    let bits = x.to_bits();
    let fraction = bits & ((1 << 52) - 1);
    let exponent = (bits >> 52 & 0x7ff) as i32;
    if exponent == 0 { (fraction, -1074) } else { (fraction | 1 << 52, exponent - 1075) }
}

/// `det[a, b, c]`, in the cube of the unit.
pub(super) fn determinant(a: &[Wide; 3], b: &[Wide; 3], c: &[Wide; 3]) -> Wide {
    let mut sum = Wide::ZERO;
    for (k, component) in a.iter().enumerate() {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        let minor = b[i].multiply(&c[j]).subtract(&b[j].multiply(&c[i]));
        sum = sum.add(&component.multiply(&minor));
    }
    sum
}

/// `a - b`.
pub(super) fn difference(a: &[Wide; 3], b: &[Wide; 3]) -> [Wide; 3] {
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

    /// Numbers of very different size, zero and ties among them.
    fn number() -> impl Strategy<Value = f64> {
        prop_oneof![
            Just(0.0),
            (-4_i32..=4).prop_map(f64::from),
            -1.0..1.0_f64,
            (-1.0..1.0_f64, -180_i32..180).prop_map(|(x, e)| x * 2.0_f64.powi(e)),
        ]
    }

    proptest! {
        #[test]
        fn sums_of_products_agree_with_rationals(a in number(), b in number(), c in number(), d in number()) {
            let sum = Wide::product(a, b).add(&Wide::product(c, d));
            let expected = rational(a) * rational(b) + rational(c) * rational(d);
            prop_assert_eq!(sum.sign(), expected.cmp(&RBig::ZERO));
        }

        #[test]
        fn determinants_and_ratios_agree_with_rationals(numbers in prop::array::uniform9(number()), w in number(), z in number()) {
            let coordinate = |k: usize| Wide::product(numbers[k], w).add(&Wide::number(z));
            let exact = |k: usize| rational(numbers[k]) * rational(w) + rational(z);
            let row = |r: usize| [coordinate(r), coordinate(r + 1), coordinate(r + 2)];
            let det = determinant(&row(0), &row(3), &row(6));
            let minor = |a: usize, b: usize| exact(3 + a) * exact(6 + b) - exact(3 + b) * exact(6 + a);
            let expected = exact(0) * minor(1, 2) + exact(1) * minor(2, 0) + exact(2) * minor(0, 1);
            prop_assert_eq!(det.sign(), expected.cmp(&RBig::ZERO));
            let cube = coordinate(0).multiply(&coordinate(0)).multiply(&coordinate(0));
            let cubed = exact(0) * exact(0) * exact(0);
            if cubed != RBig::ZERO {
                let (found, right) = (det.ratio(&cube), (expected / cubed).to_f64().value());
                let far = !(1e-290..1e290).contains(&right.abs()) && right != 0.0;
                prop_assert!(far || (found - right).abs() <= 1e-14 * right.abs(), "{found} {right}");
            }
        }
    }
}
