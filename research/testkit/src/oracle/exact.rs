//! Exact numbers `m 2^e` with integers `m` and `e`. Every finite `f64` has this form, and so do sums,
//! differences and products. Only the final comparison needs a quotient.

use std::cmp::Ordering;
use std::ops::{Add, Mul, Neg, Sub};

use dashu_int::IBig;
use dashu_int::ops::BitTest;
use glam::{DMat3, DVec3};

/// The exact number `mantissa * 2^exponent`.
#[derive(Debug, Clone)]
pub struct Dyadic {
    mantissa: IBig,
    exponent: i32,
}

impl Dyadic {
    /// The number zero.
    pub const ZERO: Self = Self { mantissa: IBig::ZERO, exponent: 0 };

    /// Converts a finite `f64` exactly.
    ///
    /// # Panics
    /// If `x` is not finite.
    pub fn new(x: f64) -> Self {
        assert!(x.is_finite(), "{x} has no exact value");
        if x == 0.0 {
            return Self::ZERO;
        }
        let bits = x.to_bits();
        let field = ((bits >> 52) & 0x7ff) as i32;
        let fraction = (bits & ((1 << 52) - 1)) as i64;
        let (mantissa, exponent) =
            if field == 0 { (fraction, -1074) } else { (fraction | (1 << 52), field - 1075) };
        let zeros = mantissa.trailing_zeros() as i32;
        let mantissa = mantissa >> zeros;
        let mantissa = IBig::from(if x < 0.0 { -mantissa } else { mantissa });
        Self { mantissa, exponent: exponent + zeros }
    }

    /// Checks whether the number is zero.
    pub fn is_zero(&self) -> bool {
        self.mantissa.is_zero()
    }

    /// Checks whether the number is positive.
    pub fn is_positive(&self) -> bool {
        self.mantissa > IBig::ZERO
    }

    /// Checks whether the number is negative.
    pub fn is_negative(&self) -> bool {
        self.mantissa < IBig::ZERO
    }

    /// Returns the absolute value.
    #[must_use]
    pub fn abs(self) -> Self {
        if self.is_negative() { -self } else { self }
    }

    /// Returns the exponent `e` of the representation `m 2^e`.
    pub fn exponent(&self) -> i32 {
        self.exponent
    }

    /// Returns the number as a multiple of `2^exponent`.
    ///
    /// # Panics
    /// If it is not an integer multiple.
    pub fn in_units_of(&self, exponent: i32) -> IBig {
        if self.is_zero() {
            return IBig::ZERO;
        }
        let shift = usize::try_from(self.exponent - exponent).expect("a finer unit");
        &self.mantissa << shift
    }

    /// Builds the number `mantissa * 2^exponent`.
    pub fn from_units(mantissa: IBig, exponent: i32) -> Self {
        Self { mantissa, exponent }
    }

    /// Returns the leading 62 bits as `(m, e)`. The value is `m 2^e` up to a relative error of `2^-61`.
    fn leading(&self) -> (f64, i32) {
        let surplus = self.mantissa.bit_len().saturating_sub(62);
        let m = i64::try_from(&self.mantissa >> surplus).expect("at most 62 bits");
        (m as f64, self.exponent + surplus as i32)
    }

    /// Returns the nearest `f64`, up to one rounding error.
    pub fn to_f64(&self) -> f64 {
        self.to_f64_in_units_of(0)
    }

    /// Returns the number as a multiple of `2^exponent`, up to one rounding error.
    pub fn to_f64_in_units_of(&self, exponent: i32) -> f64 {
        let (m, e) = self.leading();
        scale_by_power(m, e - exponent)
    }

    /// Returns the least `e` with `|x| < 2^e`; `None` for zero.
    pub fn log2(&self) -> Option<i32> {
        (!self.is_zero()).then(|| self.exponent + self.mantissa.bit_len() as i32)
    }
}

/// Returns `m 2^e`. Two factors are used, so that neither overflows alone.
fn scale_by_power(m: f64, e: i32) -> f64 {
    let half = e / 2;
    m * 2.0_f64.powi(half) * 2.0_f64.powi(e - half)
}

/// Converts two numbers to multiples of the smaller of their powers of two. Returns both and the exponent.
fn to_common_exponent(a: &Dyadic, b: &Dyadic) -> (IBig, IBig, i32) {
    let exponent = a.exponent.min(b.exponent);
    (a.in_units_of(exponent), b.in_units_of(exponent), exponent)
}

impl Add for &Dyadic {
    type Output = Dyadic;
    fn add(self, other: Self) -> Dyadic {
        if self.is_zero() {
            return other.clone();
        }
        if other.is_zero() {
            return self.clone();
        }
        let (a, b, exponent) = to_common_exponent(self, other);
        Dyadic { mantissa: a + b, exponent }
    }
}

impl Sub for &Dyadic {
    type Output = Dyadic;
    fn sub(self, other: Self) -> Dyadic {
        self + &-other.clone()
    }
}

impl Mul for &Dyadic {
    type Output = Dyadic;
    fn mul(self, other: Self) -> Dyadic {
        if self.is_zero() || other.is_zero() {
            return Dyadic::ZERO;
        }
        Dyadic {
            mantissa: &self.mantissa * &other.mantissa,
            exponent: self.exponent + other.exponent,
        }
    }
}

impl Neg for Dyadic {
    type Output = Self;
    fn neg(self) -> Self {
        Self { mantissa: -self.mantissa, exponent: self.exponent }
    }
}

impl PartialEq for Dyadic {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Dyadic {}

impl PartialOrd for Dyadic {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Dyadic {
    fn cmp(&self, other: &Self) -> Ordering {
        (self - other).mantissa.cmp(&IBig::ZERO)
    }
}

/// The quotient `numerator / denominator` with a positive denominator.
#[derive(Debug, Clone)]
pub struct Ratio {
    numerator: Dyadic,
    denominator: Dyadic,
}

impl Ratio {
    /// Builds a quotient.
    ///
    /// # Panics
    /// If the denominator is zero.
    pub fn new(numerator: Dyadic, denominator: Dyadic) -> Self {
        assert!(!denominator.is_zero(), "division by zero");
        if denominator.is_negative() {
            Self { numerator: -numerator, denominator: -denominator }
        } else {
            Self { numerator, denominator }
        }
    }

    /// Converts a finite `f64` exactly.
    pub fn from_f64(x: f64) -> Self {
        Self { numerator: Dyadic::new(x), denominator: Dyadic::new(1.0) }
    }

    /// Returns the nearest `f64`, up to a few rounding errors.
    pub fn to_f64(&self) -> f64 {
        let ((n, i), (d, j)) = (self.numerator.leading(), self.denominator.leading());
        scale_by_power(n / d, i - j)
    }

    /// Returns the square root as the nearest `f64`, up to a few rounding errors. The number itself may be
    /// outside of the range of `f64`.
    ///
    /// # Panics
    /// If the number is negative.
    pub fn sqrt_to_f64(&self) -> f64 {
        assert!(!self.is_negative(), "no square root");
        let ((n, i), (d, j)) = (self.numerator.leading(), self.denominator.leading());
        let odd = (i - j).rem_euclid(2);
        scale_by_power((n / d * f64::from(1 + odd)).sqrt(), (i - j - odd) / 2)
    }

    /// Returns `self - other`, exactly.
    #[must_use]
    pub fn minus(&self, other: &Self) -> Self {
        Self {
            numerator: &(&self.numerator * &other.denominator)
                - &(&other.numerator * &self.denominator),
            denominator: &self.denominator * &other.denominator,
        }
    }

    /// Returns `self * other`, exactly.
    #[must_use]
    pub fn times(&self, other: &Self) -> Self {
        Self {
            numerator: &self.numerator * &other.numerator,
            denominator: &self.denominator * &other.denominator,
        }
    }

    /// Checks whether the number is zero.
    pub fn is_zero(&self) -> bool {
        self.numerator.is_zero()
    }

    /// Checks whether the number is negative.
    pub fn is_negative(&self) -> bool {
        self.numerator.is_negative()
    }

    /// Returns the absolute value.
    #[must_use]
    pub fn abs(self) -> Self {
        Self { numerator: self.numerator.abs(), denominator: self.denominator }
    }

    /// Checks whether the absolute value is at most `bound`, exactly.
    pub fn is_within(&self, bound: f64) -> bool {
        self.clone().abs() <= Self::from_f64(bound)
    }
}

impl PartialEq for Ratio {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Ratio {}

impl PartialOrd for Ratio {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Ratio {
    fn cmp(&self, other: &Self) -> Ordering {
        (&self.numerator * &other.denominator).cmp(&(&other.numerator * &self.denominator))
    }
}

/// A vector of exact numbers.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Vector(pub [Dyadic; 3]);

impl Vector {
    /// Converts three `f64` exactly.
    pub fn new(v: DVec3) -> Self {
        Self(v.to_array().map(Dyadic::new))
    }

    /// Returns the scalar product.
    pub fn dot(&self, other: &Self) -> Dyadic {
        let [a, b, c] = [0, 1, 2].map(|i| &self.0[i] * &other.0[i]);
        &(&a + &b) + &c
    }

    /// Returns the cross product.
    #[must_use]
    pub fn cross(&self, other: &Self) -> Self {
        let ([a, b, c], [x, y, z]) = (&self.0, &other.0);
        Self([&(b * z) - &(c * y), &(c * x) - &(a * z), &(a * y) - &(b * x)])
    }

    /// Returns the difference.
    #[must_use]
    pub fn minus(&self, other: &Self) -> Self {
        Self([0, 1, 2].map(|i| &self.0[i] - &other.0[i]))
    }

    /// Returns the sum.
    #[must_use]
    pub fn plus(&self, other: &Self) -> Self {
        Self([0, 1, 2].map(|i| &self.0[i] + &other.0[i]))
    }

    /// Returns the multiple by a factor.
    #[must_use]
    pub fn times(&self, factor: &Dyadic) -> Self {
        Self([0, 1, 2].map(|i| &self.0[i] * factor))
    }

    /// Returns the nearest `f64` vector.
    pub fn to_f64(&self) -> DVec3 {
        DVec3::from_array([0, 1, 2].map(|i| self.0[i].to_f64()))
    }
}

/// Returns the points `R v + t`, exactly, for points `v` of a body.
pub fn place(rotation: DMat3, translation: DVec3, points: &[DVec3]) -> Vec<Vector> {
    let rows = rotation.transpose();
    let rows = [rows.x_axis, rows.y_axis, rows.z_axis].map(Vector::new);
    let translation = Vector::new(translation);
    let put = |&v: &DVec3| {
        let v = Vector::new(v);
        Vector([0, 1, 2].map(|i| rows[i].dot(&v))).plus(&translation)
    };
    points.iter().map(put).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arithmetic_is_exact() {
        let (a, b) = (Dyadic::new(1e300), Dyadic::new(1e-300));
        let sum = &a + &b;
        assert!(sum > a);
        assert_eq!(&sum - &a, b);
        assert_eq!((&a * &b).to_f64(), 1e300 * 1e-300);
        assert_eq!(Dyadic::new(-0.1).to_f64(), -0.1);
        assert_eq!(Dyadic::new(f64::from_bits(3)).to_f64(), f64::from_bits(3));
    }

    #[test]
    fn one_third_differs_from_its_f64() {
        let third = Ratio::new(Dyadic::new(1.0), Dyadic::new(3.0));
        assert_ne!(third, Ratio::from_f64(1.0 / 3.0));
        assert_eq!(third.to_f64(), 1.0 / 3.0);
        assert!(third.minus(&Ratio::from_f64(1.0 / 3.0)).is_within(1e-16));
        assert!(!third.minus(&Ratio::from_f64(1.0 / 3.0)).is_within(1e-18));
    }

    #[test]
    fn square_roots_of_numbers_outside_f64_are_exact() {
        for x in [3e-200, 1e-300, 7.0, 1e200, 5e-320, 0.0] {
            let x = Ratio::from_f64(x);
            let root = x.times(&x).sqrt_to_f64();
            assert!((root - x.to_f64()).abs() <= 2.0 * f64::EPSILON * root, "{root}");
        }
        let two = Ratio::new(Dyadic::new(-1.0), Dyadic::new(-0.5));
        assert!((two.sqrt_to_f64() - 2.0_f64.sqrt()).abs() <= f64::EPSILON);
    }

    #[test]
    fn cross_is_orthogonal() {
        let (a, b) = (DVec3::new(0.1, 0.2, 0.3), DVec3::new(-7.7, 1e-9, 5.5));
        let (a, b) = (Vector::new(a), Vector::new(b));
        assert!(a.cross(&b).dot(&a).is_zero() && a.cross(&b).dot(&b).is_zero());
    }
}
