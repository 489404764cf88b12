//! Integers times powers of two, of fixed size on the stack.

use std::cmp::Ordering;

/// Limbs that are enough for all that is admitted.
pub(super) const ALL: usize = 48;
/// Limbs that are enough for what is usual.
pub(super) const USUAL: usize = 14;

/// `sum_k limbs[k] 2^(64 (lowest + k))` with a sign; not zero: the limbs at both ends are not.
/// Limbs beyond `len` are zero.
#[derive(Clone, Copy)]
pub(super) struct Integer<const N: usize> {
    negative: bool,
    lowest: i32,
    len: usize,
    limbs: [u64; N],
}

impl<const N: usize> Integer<N> {
    pub(super) const ZERO: Self = Self { negative: false, lowest: 0, len: 0, limbs: [0; N] };

    /// `a b`, exactly.
    pub(super) fn product(a: f64, b: f64) -> Self {
        let mut result = Self::ZERO;
        let ((m, e), (n, f)) = (decode(a), decode(b));
        let bits = u128::from(m) * u128::from(n);
        if bits == 0 {
            return result;
        }
        result.negative = a.is_sign_negative() != b.is_sign_negative();
        let zeros = bits.trailing_zeros();
        let bits = bits >> zeros;
        let shift = e + f + zeros as i32;
        result.lowest = shift.div_euclid(64);
        let bit = shift.rem_euclid(64);
        let high = u128::from((bits >> 64) as u64) << bit;
        let low = u128::from(bits as u64) << bit;
        result.limbs[0] = low as u64;
        result.limbs[1] = (low >> 64) as u64 | high as u64;
        result.limbs[2] = (high >> 64) as u64;
        result.len = 3;
        result.trim();
        result
    }

    fn trim(&mut self) {
        while self.len > 0 && self.limbs[self.len - 1] == 0 {
            self.len -= 1;
        }
    }

    pub(super) fn negate(mut self) -> Self {
        self.negative = !self.negative;
        self
    }

    /// Limb with the weight `2^(64 place)`.
    fn limb(&self, place: i32) -> u64 {
        let k = place - self.lowest;
        if (0..self.len as i32).contains(&k) { self.limbs[k as usize] } else { 0 }
    }

    /// Place above the highest limb.
    fn top(&self) -> i32 {
        self.lowest + self.len as i32
    }

    fn compare_magnitude(&self, other: &Self) -> Ordering {
        let (top, lowest) = (self.top().max(other.top()), self.lowest.min(other.lowest));
        for place in (lowest..top).rev() {
            match self.limb(place).cmp(&other.limb(place)) {
                Ordering::Equal => {}
                unequal => return unequal,
            }
        }
        Ordering::Equal
    }

    /// The sum; `None` if it has too many limbs.
    pub(super) fn add(&self, other: &Self) -> Option<Self> {
        if self.len == 0 {
            return Some(*other);
        }
        if other.len == 0 {
            return Some(*self);
        }
        if self.negative == other.negative {
            return self.combine(other, false);
        }
        match self.compare_magnitude(other) {
            Ordering::Less => other.combine(self, true),
            Ordering::Equal => Some(Self::ZERO),
            Ordering::Greater => self.combine(other, true),
        }
    }

    pub(super) fn subtract(&self, other: &Self) -> Option<Self> {
        self.add(&other.negate())
    }

    /// The sum of the magnitudes, or the larger one minus the smaller one, with the sign of the
    /// first.
    fn combine(&self, other: &Self, subtract: bool) -> Option<Self> {
        let lowest = self.lowest.min(other.lowest);
        let len = (self.top().max(other.top()) - lowest) as usize + 1;
        if len > N {
            return None;
        }
        let mut result = Self { negative: self.negative, lowest, len, ..Self::ZERO };
        let mut carry = false;
        for k in 0..len {
            let (a, b) = (self.limb(lowest + k as i32), other.limb(lowest + k as i32));
            let (s, c, d);
            if subtract {
                (s, c) = a.overflowing_sub(b);
                (result.limbs[k], d) = s.overflowing_sub(u64::from(carry));
            } else {
                (s, c) = a.overflowing_add(b);
                (result.limbs[k], d) = s.overflowing_add(u64::from(carry));
            }
            carry = c || d;
        }
        result.trim();
        Some(result)
    }

    /// The product; `None` if it has too many limbs.
    pub(super) fn multiply(&self, other: &Self) -> Option<Self> {
        if self.len == 0 || other.len == 0 {
            return Some(Self::ZERO);
        }
        let len = self.len + other.len;
        if len > N {
            return None;
        }
        let negative = self.negative != other.negative;
        let mut result = Self { negative, lowest: self.lowest + other.lowest, len, ..Self::ZERO };
        for i in 0..self.len {
            let mut carry = 0_u128;
            for j in 0..other.len {
                let wide = u128::from(self.limbs[i]) * u128::from(other.limbs[j])
                    + u128::from(result.limbs[i + j])
                    + carry;
                result.limbs[i + j] = wide as u64;
                carry = wide >> 64;
            }
            result.limbs[i + other.len] = carry as u64;
        }
        result.trim();
        Some(result)
    }

    pub(super) fn sign(&self) -> Ordering {
        match (self.len, self.negative) {
            (0, _) => Ordering::Equal,
            (_, true) => Ordering::Less,
            (_, false) => Ordering::Greater,
        }
    }
}

/// Mantissa and exponent: `|x| = mantissa 2^exponent`.
fn decode(x: f64) -> (u64, i32) {
    let bits = x.to_bits();
    let fraction = bits & ((1 << 52) - 1);
    let exponent = (bits >> 52 & 0x7ff) as i32;
    if exponent == 0 { (fraction, -1074) } else { (fraction | 1 << 52, exponent - 1075) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::number::tests::{number, rational};
    use dashu_ratio::RBig;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn integers_agree_with_rationals(a in number(), b in number(), c in number(), d in number()) {
            let sum = Integer::<ALL>::product(a, b).add(&Integer::product(c, d)).unwrap();
            let expected = rational(a) * rational(b) + rational(c) * rational(d);
            prop_assert_eq!(sum.sign(), expected.cmp(&RBig::ZERO));
        }
    }
}
