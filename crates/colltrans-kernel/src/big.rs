//! Exact integers of any size, for constructions whose depth is not known in advance.
//!
//! A [`Big`] has a sign and limbs of 64 bits, the lowest first, without zero limbs at the top. Signs of determinants of
//! coordinates need no allocation: they use [`Integer`](crate::integer::Integer).

use std::cmp::Ordering;
use std::ops::{Add, Mul, Neg, Sub};

use crate::integer::mantissa_and_exponent;

/// An integer of any size.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Big {
    is_negative: bool,
    limbs: Vec<u64>,
}

impl Big {
    /// Returns `a b / 2^unit`, which must be an integer.
    pub fn exact_product(a: f64, b: f64, unit: i32) -> Self {
        if a == 0.0 || b == 0.0 {
            return Self::default();
        }
        let ([m, n], exponent) = odd_mantissas(a, b);
        debug_assert!(exponent >= unit, "{a} {b} {unit}");
        let bits = u128::from(m) * u128::from(n);
        let limbs = vec![bits as u64, (bits >> 64) as u64];
        let is_negative = a.is_sign_negative() != b.is_sign_negative();
        Self::new(is_negative, limbs).shifted((exponent - unit).max(0) as u32)
    }

    /// Returns `2^exponent`.
    pub fn power_of_two(exponent: u32) -> Self {
        Self::new(false, vec![1]).shifted(exponent)
    }

    fn new(is_negative: bool, mut limbs: Vec<u64>) -> Self {
        while limbs.last() == Some(&0) {
            limbs.pop();
        }
        Self { is_negative: is_negative && !limbs.is_empty(), limbs }
    }

    /// Returns the number times `2^bits`.
    #[must_use]
    pub fn shifted(&self, bits: u32) -> Self {
        let (whole, part) = (bits as usize / 64, bits % 64);
        let mut limbs = vec![0; whole];
        let mut carry = 0;
        for limb in &self.limbs {
            limbs.push(limb << part | carry);
            carry = if part == 0 { 0 } else { limb >> (64 - part) };
        }
        limbs.push(carry);
        Self::new(self.is_negative, limbs)
    }

    /// Returns the sign.
    pub fn sign(&self) -> Ordering {
        match (self.limbs.is_empty(), self.is_negative) {
            (true, _) => Ordering::Equal,
            (false, true) => Ordering::Less,
            (false, false) => Ordering::Greater,
        }
    }

    /// Returns the number of bits of the magnitude.
    pub fn bits(&self) -> u32 {
        self.limbs.last().map_or(0, |top| 64 * self.limbs.len() as u32 - top.leading_zeros())
    }

    /// Returns `m` and `e` with `m 2^e` near the number, with a relative error of at most `2^-52`. The magnitude of `m`
    /// is from 1/2 to 1, or 0.
    pub fn rounded(&self) -> (f64, i64) {
        let count = self.limbs.len();
        let Some(top) = self.limbs.last() else { return (0.0, 0) };
        let shift = top.leading_zeros();
        let below = if count > 1 { self.limbs[count - 2] } else { 0 };
        let bits = if shift == 0 { *top } else { top << shift | below >> (64 - shift) };
        // The highest bit is set, so that the lowest 11 bits are below the precision.
        let mantissa = (bits >> 11) as f64 / (1_u64 << 53) as f64;
        (if self.is_negative { -mantissa } else { mantissa }, i64::from(self.bits()))
    }

    /// Returns the sum of two numbers, the second one with the given sign.
    fn plus(&self, other: &Self, is_negative: bool) -> Self {
        if self.is_negative == is_negative {
            return Self::new(is_negative, sum(&self.limbs, &other.limbs));
        }
        match compare(&self.limbs, &other.limbs) {
            Ordering::Less => Self::new(is_negative, difference(&other.limbs, &self.limbs)),
            _ => Self::new(self.is_negative, difference(&self.limbs, &other.limbs)),
        }
    }
}

/// Returns the odd mantissas of two numbers that are not 0, and the exponent of their product.
fn odd_mantissas(a: f64, b: f64) -> ([u64; 2], i32) {
    let parts = [a, b].map(mantissa_and_exponent);
    let zeros = parts.map(|(mantissa, _)| mantissa.trailing_zeros());
    let mantissas = [0, 1].map(|k| parts[k].0 >> zeros[k]);
    (mantissas, parts[0].1 + parts[1].1 + (zeros[0] + zeros[1]) as i32)
}

/// Returns the exponent of the lowest bit of a product; `None` if it is 0.
pub fn lowest_exponent(a: f64, b: f64) -> Option<i32> {
    (a != 0.0 && b != 0.0).then(|| odd_mantissas(a, b).1)
}

fn compare(a: &[u64], b: &[u64]) -> Ordering {
    a.len().cmp(&b.len()).then_with(|| a.iter().rev().cmp(b.iter().rev()))
}

fn sum(a: &[u64], b: &[u64]) -> Vec<u64> {
    let (long, short) = if a.len() < b.len() { (b, a) } else { (a, b) };
    let mut limbs = Vec::with_capacity(long.len() + 1);
    let mut carry = false;
    for (k, limb) in long.iter().enumerate() {
        let (part, first) = limb.overflowing_add(short.get(k).copied().unwrap_or(0));
        let (part, second) = part.overflowing_add(u64::from(carry));
        carry = first || second;
        limbs.push(part);
    }
    limbs.push(u64::from(carry));
    limbs
}

/// Returns the difference of two magnitudes, the first of which is at least the second.
fn difference(a: &[u64], b: &[u64]) -> Vec<u64> {
    let mut borrow = false;
    let limb = |(k, limb): (usize, &u64)| {
        let (part, first) = limb.overflowing_sub(b.get(k).copied().unwrap_or(0));
        let (part, second) = part.overflowing_sub(u64::from(borrow));
        borrow = first || second;
        part
    };
    a.iter().enumerate().map(limb).collect()
}

impl Add for &Big {
    type Output = Big;

    fn add(self, other: &Big) -> Big {
        self.plus(other, other.is_negative)
    }
}

impl Sub for &Big {
    type Output = Big;

    fn sub(self, other: &Big) -> Big {
        self.plus(other, !other.is_negative)
    }
}

impl Mul for &Big {
    type Output = Big;

    fn mul(self, other: &Big) -> Big {
        if self.limbs.is_empty() || other.limbs.is_empty() {
            return Big::default();
        }
        let mut limbs = vec![0_u64; self.limbs.len() + other.limbs.len()];
        for (i, a) in self.limbs.iter().enumerate() {
            let mut carry = 0_u128;
            for (j, b) in other.limbs.iter().enumerate() {
                carry += u128::from(*a) * u128::from(*b) + u128::from(limbs[i + j]);
                limbs[i + j] = carry as u64;
                carry >>= 64;
            }
            limbs[i + other.limbs.len()] = carry as u64;
        }
        Big::new(self.is_negative != other.is_negative, limbs)
    }
}

impl Neg for &Big {
    type Output = Big;

    fn neg(self) -> Big {
        Big { is_negative: !self.is_negative && !self.limbs.is_empty(), limbs: self.limbs.clone() }
    }
}

#[cfg(test)]
mod tests {
    use dashu_ratio::RBig;
    use proptest::prelude::*;

    use super::*;
    use crate::tests::{any_number, rational};

    /// Exponent below those of all products of two numbers.
    const UNIT: i32 = -2148;

    fn value(of: &Big) -> RBig {
        let mut sum = RBig::ZERO;
        for limb in of.limbs.iter().rev() {
            sum = sum * RBig::from(1_u128 << 64) + RBig::from(*limb);
        }
        if of.is_negative { -sum } else { sum }
    }

    proptest! {
        #[test]
        fn sums_and_products_are_exact(
            a in any_number(), b in any_number(), c in any_number(), d in any_number()
        ) {
            let (p, q) = (Big::exact_product(a, b, UNIT), Big::exact_product(c, d, UNIT));
            let (x, y) = (value(&p), value(&q));
            let unit = RBig::from(1) / value(&Big::power_of_two(2148));
            prop_assert_eq!(&x * &unit, rational(a) * rational(b));
            prop_assert_eq!(value(&(&p + &q)), &x + &y);
            prop_assert_eq!(value(&(&p - &q)), &x - &y);
            prop_assert_eq!(value(&(&p * &q)), &x * &y);
            prop_assert_eq!(value(&-&p), -x);
            prop_assert_eq!((&p - &p).sign(), Ordering::Equal);
            prop_assert_eq!(&(&p + &q) - &q, p);
        }

        #[test]
        fn rounded_numbers_are_near(a in any_number(), b in any_number()) {
            let exact = Big::exact_product(a, b, UNIT);
            let (mantissa, exponent) = exact.rounded();
            if exact.sign() == Ordering::Equal {
                prop_assert_eq!(mantissa, 0.0);
            } else {
                prop_assert!((0.5..=1.0).contains(&mantissa.abs()));
                let scale = value(&Big::power_of_two(exponent as u32));
                let miss = rational(mantissa) * scale / value(&exact) - RBig::from(1);
                let bound = RBig::from(1) / RBig::from(1_u64 << 52);
                prop_assert!(miss <= bound && -miss <= bound);
            }
        }
    }
}
