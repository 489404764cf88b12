//! Number types of a search: `f64`, and [`DoubleWord`] for results that the rounding of `f64` leaves uncertain.

use std::ops::{Add, Div, Mul, Neg, Sub};

use glam::DVec3;

use super::error_free::{product_error, sum_error};

/// A number type with the basic operations.
pub trait Real:
    Copy
    + PartialOrd
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    const ZERO: Self;

    /// Converts an `f64` exactly.
    fn from_f64(x: f64) -> Self;

    /// Returns the nearest `f64`.
    fn to_f64(self) -> f64;
}

impl Real for f64 {
    const ZERO: Self = 0.0;

    #[inline]
    fn from_f64(x: f64) -> Self {
        x
    }

    #[inline]
    fn to_f64(self) -> f64 {
        self
    }
}

/// A double-word number: the sum of an `f64` and its rounding error, about 106 bits. Underflow is not
/// detected, so numbers must not be tiny.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
pub struct DoubleWord {
    high: f64,
    low: f64,
}

impl DoubleWord {
    /// Returns `high + low`, where `low` is small compared with `high`.
    #[inline]
    pub fn new(high: f64, low: f64) -> Self {
        let sum = high + low;
        Self { high: sum, low: sum_error(high, low, sum) }
    }
}

impl Real for DoubleWord {
    const ZERO: Self = Self { high: 0.0, low: 0.0 };

    #[inline]
    fn from_f64(x: f64) -> Self {
        Self { high: x, low: 0.0 }
    }

    #[inline]
    fn to_f64(self) -> f64 {
        self.high
    }
}

impl Add for DoubleWord {
    type Output = Self;

    #[inline]
    fn add(self, other: Self) -> Self {
        let high = self.high + other.high;
        let low = self.low + other.low;
        let first = Self::new(high, sum_error(self.high, other.high, high) + low);
        Self::new(first.high, first.low + sum_error(self.low, other.low, low))
    }
}

impl Neg for DoubleWord {
    type Output = Self;

    #[inline]
    fn neg(self) -> Self {
        Self { high: -self.high, low: -self.low }
    }
}

impl Sub for DoubleWord {
    type Output = Self;

    #[inline]
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for DoubleWord {
    type Output = Self;

    #[inline]
    fn mul(self, other: Self) -> Self {
        let high = self.high * other.high;
        let rest = product_error(self.high, other.high, high);
        Self::new(high, rest + (self.high * other.low + self.low * other.high))
    }
}

impl Div for DoubleWord {
    type Output = Self;

    #[inline]
    fn div(self, other: Self) -> Self {
        let first = self.high / other.high;
        let rest = self - other * Self::from_f64(first);
        Self::new(first, rest.high / other.high)
    }
}

/// A vector of three numbers of the type `T`.
#[derive(Debug, Clone, Copy)]
pub struct RealVector<T>(pub [T; 3]);

impl<T: Real> RealVector<T> {
    pub const ZERO: Self = Self([T::ZERO; 3]);

    #[inline]
    #[must_use]
    pub fn minus(&self, other: &Self) -> Self {
        let ([a, b, c], [x, y, z]) = (self.0, other.0);
        Self([a - x, b - y, c - z])
    }

    #[inline]
    #[must_use]
    pub fn plus(&self, other: &Self) -> Self {
        let ([a, b, c], [x, y, z]) = (self.0, other.0);
        Self([a + x, b + y, c + z])
    }

    #[inline]
    #[must_use]
    pub fn times(&self, factor: T) -> Self {
        Self(self.0.map(|x| x * factor))
    }

    #[inline]
    pub fn dot(&self, other: &Self) -> T {
        let ([a, b, c], [x, y, z]) = (self.0, other.0);
        a * x + b * y + c * z
    }

    #[inline]
    #[must_use]
    pub fn cross(&self, other: &Self) -> Self {
        let ([a, b, c], [x, y, z]) = (self.0, other.0);
        Self([b * z - c * y, c * x - a * z, a * y - b * x])
    }

    /// Returns the nearest vector of `f64`.
    #[inline]
    pub fn to_dvec3(&self) -> DVec3 {
        DVec3::from_array(self.0.map(T::to_f64))
    }
}

#[cfg(test)]
mod tests {
    use dashu_ratio::RBig;
    use proptest::prelude::*;

    use super::*;
    use crate::tests::rational;

    /// Numbers of similar magnitude, with zeros.
    fn any_twice() -> impl Strategy<Value = DoubleWord> {
        let high = || prop_oneof![Just(0.0), (-4_i32..=4).prop_map(f64::from), -2.0..2.0_f64];
        (high(), -1.0..1.0_f64).prop_map(|(high, low)| DoubleWord::new(high, low * 1e-17))
    }

    fn exact_value(x: DoubleWord) -> RBig {
        rational(x.high) + rational(x.low)
    }

    /// Checks whether two numbers differ by at most `1e-30` times a size.
    fn agrees_within(found: DoubleWord, truth: RBig, size: f64) -> bool {
        (exact_value(found) - truth).to_f64().value().abs() <= 1e-30 * size
    }

    proptest! {
        #[test]
        fn operations_are_accurate_to_twice_the_digits(a in any_twice(), b in any_twice()) {
            prop_assert!(agrees_within(a + b, exact_value(a) + exact_value(b), a.high.abs() + b.high.abs()));
            prop_assert!(agrees_within(a - b, exact_value(a) - exact_value(b), a.high.abs() + b.high.abs()));
            prop_assert!(agrees_within(a * b, exact_value(a) * exact_value(b), (a.high * b.high).abs()));
            if b.high.abs() > 1e-10 {
                prop_assert!(agrees_within(a / b, exact_value(a) / exact_value(b), (a.high / b.high).abs()));
            }
        }
    }
}
