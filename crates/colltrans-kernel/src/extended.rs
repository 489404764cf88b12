//! Points in twice the usual precision and determinants of the displacements between them, with error bounds.
//!
//! These determinants decide most signs that rounded numbers leave uncertain, at a tenth of the cost of exact
//! integers. The remaining cases are mostly exact zeros. Sums that track their error ([`Double`]) prove that a
//! determinant is 0, if all digits fit.
//!
//! Rounding. A sum or a product of two [`DoubleWord`] has a relative error below [`RELATIVE_ERROR`] (Joldes, Muller and
//! Popescu, "Tight and rigorous error bounds for basic building blocks of double-word arithmetic", ACM TOMS
//! 44(2), 2017). `docs/theory/exact-arithmetic.md` derives the bounds of determinants and minors.

use std::cmp::Ordering;

use glam::{DMat3, DVec3};

use super::double::{Double, ParallelSums};
use super::real::{DoubleWord, Real, RealVector};

/// Bound on the relative error of a sum or a product.
const RELATIVE_ERROR: f64 = f64::EPSILON * f64::EPSILON * 2.0;
/// Bound on the absolute error by underflow.
const UNDERFLOW_ERROR: f64 = f64::from_bits((1023 - 800) << 52);

/// A point with a bound on the error of each coordinate.
#[derive(Debug, Clone, Copy)]
pub struct ExtendedPoint {
    coordinates: [Double; 3],
    error: f64,
}

impl ExtendedPoint {
    /// The origin, exactly.
    pub const ORIGIN: Self = Self { coordinates: [Double::ZERO; 3], error: 0.0 };

    /// Returns the point `v` exactly.
    #[inline]
    pub fn from_exact(v: DVec3) -> Self {
        let coordinates = v.to_array().map(|high| Double { high, ..Double::ZERO });
        Self { coordinates, error: 0.0 }
    }

    /// Computes the sum of two offsets and of `weight * matrix * point` for each pair. Weights are powers of
    /// two.
    #[inline]
    pub fn from_products(matrix: &DMat3, offset: [DVec3; 2], points: &[(f64, DVec3)]) -> Self {
        let [high, low] = offset.map(|part| part.to_array());
        let mut sums = ParallelSums { high, low, ..ParallelSums::ZERO };
        for (weight, point) in points {
            for column in 0..3 {
                let entries = matrix.col(column) * *weight;
                sums.add_products(entries.to_array(), point[column]);
            }
        }
        let error = sums.error.into_iter().fold(0.0, f64::max);
        Self { coordinates: [0, 1, 2].map(|k| sums.get(k)), error: 1.01 * error }
    }

    /// Returns the displacement from this point to another one.
    #[inline]
    pub fn displacement_to<'p>(&'p self, end: &'p Self) -> ExtendedDisplacement<'p> {
        ExtendedDisplacement([self, end])
    }
}

/// The displacement from the first point to the second.
#[derive(Clone, Copy)]
pub struct ExtendedDisplacement<'p>([&'p ExtendedPoint; 2]);

impl ExtendedDisplacement<'_> {
    /// Computes the displacement in twice the usual precision.
    #[inline]
    fn to_twice(self) -> RealVector<DoubleWord> {
        let [from, to] = self
            .0
            .map(|point| RealVector(point.coordinates.map(|x| DoubleWord::new(x.high, x.low))));
        to.minus(&from)
    }

    /// Returns the bound on the error of each coordinate, without the rounding error of the difference.
    #[inline]
    fn coordinate_error(&self) -> f64 {
        self.0[0].error + self.0[1].error
    }

    /// Computes the displacement with complete error bounds, which are 0 if the coordinates have few digits.
    #[inline]
    fn tracked_coordinates(&self) -> [Double; 3] {
        let [from, to] = self.0.map(|point| point.coordinates);
        [0, 1, 2].map(|k| {
            let mut sum = to[k];
            sum.add_number(-from[k].high);
            sum.add_number(-from[k].low);
            sum.error += from[k].error;
            sum.normalized()
        })
    }

    /// Returns the sign of one coordinate (axis 0, 1 or 2); `None` if it is uncertain.
    #[inline]
    pub fn sign_along(&self, axis: usize) -> Option<Ordering> {
        self.tracked_coordinates()[axis].certain_sign()
    }
}

/// A number with a bound on its absolute error.
#[derive(Debug, Clone, Copy)]
pub struct NumberWithError {
    value: DoubleWord,
    error: f64,
}

impl NumberWithError {
    /// Returns the sign; `None` if the number is within its error of 0.
    #[inline]
    pub fn sign(&self) -> Option<Ordering> {
        let high = self.value.to_f64();
        (high.abs() > self.error).then(|| high.total_cmp(&0.0))
    }

    /// Computes `self / other` with an error of at most two roundings, or of `slack` plus two roundings. `None` if
    /// the errors of the two numbers are too large for both.
    #[inline]
    pub fn ratio(&self, other: &Self, slack: f64) -> Option<f64> {
        const ROUNDING: f64 = f64::EPSILON / 4.0;
        let [over, under] = [self.value, other.value].map(|x| x.to_f64().abs());
        let known = under * ROUNDING > other.error
            && (over * ROUNDING > self.error || under * slack > self.error);
        known.then(|| (self.value / other.value).to_f64())
    }
}

/// Returns the maximum norm of a displacement.
#[inline]
fn max_norm(way: &RealVector<DoubleWord>) -> f64 {
    way.to_dvec3().abs().max_element()
}

/// Computes `det[x, y, z]`.
#[inline]
pub fn determinant([x, y, z]: [ExtendedDisplacement; 3]) -> NumberWithError {
    let (e, f, g) = (x.coordinate_error(), y.coordinate_error(), z.coordinate_error());
    let (x, y, z) = (x.to_twice(), y.to_twice(), z.to_twice());
    let (l, m, n) = (max_norm(&x), max_norm(&y), max_norm(&z));
    let change = e * (m + f) * (n + g) + l * (f * (n + g) + m * g);
    let error = 8.0 * change + 48.0 * RELATIVE_ERROR * (l * m * n) + UNDERFLOW_ERROR;
    NumberWithError { value: x.dot(&y.cross(&z)), error }
}

/// Returns the sign of `det[x, y, z]`; `None` if it is uncertain. Computes the determinant again with tracked
/// errors if rounding leaves the sign uncertain.
#[inline]
pub fn determinant_sign(ways: [ExtendedDisplacement; 3]) -> Option<Ordering> {
    determinant(ways).sign().or_else(|| tracked_determinant_sign(ways))
}

/// Returns the sign of `det[x, y, z]`, computed only with tracked errors; `None` if it is uncertain.
#[inline]
pub fn tracked_determinant_sign(ways: [ExtendedDisplacement; 3]) -> Option<Ordering> {
    tracked_determinant(&ways.map(|way| way.tracked_coordinates())).certain_sign()
}

/// Computes `det[x, y, z]` with tracked errors.
#[inline]
fn tracked_determinant([x, y, z]: &[[Double; 3]; 3]) -> Double {
    let mut sum = Double::ZERO;
    for (k, entry) in x.iter().enumerate() {
        sum.add_double_product(entry, &tracked_minor(y, z, [(k + 1) % 3, (k + 2) % 3]), 1.0);
    }
    sum
}

/// Computes `x_i y_j - x_j y_i` with tracked errors.
#[inline]
fn tracked_minor(x: &[Double; 3], y: &[Double; 3], [i, j]: [usize; 2]) -> Double {
    let mut sum = Double::ZERO;
    sum.add_double_product(&x[i], &y[j], 1.0);
    sum.add_double_product(&x[j], &y[i], -1.0);
    sum.normalized()
}

/// Returns the sign of `x_i y_j - x_j y_i`; `None` if it is uncertain.
#[inline]
pub fn minor_sign([x, y]: [ExtendedDisplacement; 2], [i, j]: [usize; 2]) -> Option<Ordering> {
    let rough = rounded_minor([x, y], [i, j]).sign();
    rough.or_else(|| {
        tracked_minor(&x.tracked_coordinates(), &y.tracked_coordinates(), [i, j]).certain_sign()
    })
}

/// Computes `x_i y_j - x_j y_i`.
#[inline]
fn rounded_minor([x, y]: [ExtendedDisplacement; 2], [i, j]: [usize; 2]) -> NumberWithError {
    let (e, f) = (x.coordinate_error(), y.coordinate_error());
    let (x, y) = (x.to_twice(), y.to_twice());
    let (l, m) = (max_norm(&x), max_norm(&y));
    let error = 4.0 * (e * (m + f) + l * f) + 8.0 * RELATIVE_ERROR * (l * m) + UNDERFLOW_ERROR;
    let (RealVector(x), RealVector(y)) = (x, y);
    NumberWithError { value: x[i] * y[j] - x[j] * y[i], error }
}

#[cfg(test)]
mod tests {
    use dashu_ratio::RBig;
    use proptest::prelude::*;

    use super::*;
    use crate::tests::{any_vector, rational};

    /// Matrices: the identity, rotations, and entries that may be tiny or zero.
    fn any_matrix() -> impl Strategy<Value = DMat3> {
        let turned = [-1.0..1.0_f64, -1.0..1.0, -1.0..1.0, 0.25..1.0]
            .prop_map(|q| DMat3::from_quat(glam::DQuat::from_array(q).normalize()));
        let column = || any_vector().prop_map(|v| v.clamp(DVec3::NEG_ONE, DVec3::ONE));
        let any = [column(), column(), column()];
        prop_oneof![
            Just(DMat3::IDENTITY),
            turned,
            any.prop_map(|[a, b, c]| DMat3::from_cols(a, b, c)),
        ]
    }

    /// Points that are nearly in one plane or on one line, or anywhere.
    fn nearly_flat_points() -> impl Strategy<Value = [DVec3; 4]> {
        let like = || [-2.0..2.0_f64, -2.0..2.0, -2.0..2.0].prop_map(DVec3::from_array);
        let (a, s) = (|| [like(), like(), like()], || -60..-20_i32);
        let flat = (a(), -1.0..1.0_f64, -1.0..1.0_f64, like(), s()).prop_map(
            |([a, b, c], s, t, off, k)| {
                [a, b, c, a + (b - a) * s + (c - a) * t + off * 2.0_f64.powi(k)]
            },
        );
        let line = (a(), s())
            .prop_map(|([a, b, off], k)| [a, b, a.lerp(b, 0.3) + off * 2.0_f64.powi(k), b]);
        prop_oneof![[any_vector(), any_vector(), any_vector(), any_vector()], flat, line]
    }

    /// Returns the exact coordinates of `matrix point` plus two offsets.
    fn exact_point(matrix: &DMat3, offset: [DVec3; 2], point: DVec3) -> [RBig; 3] {
        [0, 1, 2].map(|row| {
            let products = (0..3).map(|k| rational(matrix.col(k)[row]) * rational(point[k]));
            products.fold(rational(offset[0][row]) + rational(offset[1][row]), |sum, x| sum + x)
        })
    }

    /// Returns the exact displacement from `a` to `b`.
    fn exact_displacement(a: &[RBig; 3], b: &[RBig; 3]) -> [RBig; 3] {
        [0, 1, 2].map(|k| b[k].clone() - a[k].clone())
    }

    fn exact_cross_component(x: &[RBig; 3], y: &[RBig; 3], k: usize) -> RBig {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        x[i].clone() * y[j].clone() - x[j].clone() * y[i].clone()
    }

    /// Checks whether the error bound and the sign of a number are right.
    fn is_within_error(found: NumberWithError, truth: &RBig) -> bool {
        let high = rational(found.value.to_f64());
        let low = rational((found.value - DoubleWord::from_f64(found.value.to_f64())).to_f64());
        let off = high + low - truth.clone();
        let error = rational(found.error);
        off <= error && -off <= error && found.sign().is_none_or(|s| s == truth.cmp(&RBig::ZERO))
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2_000))]

        #[test]
        fn signs_and_bounds_agree_with_rationals(
            m in any_matrix(), high in any_vector(), low in -1.0..1.0_f64,
            corners in nearly_flat_points(), d in any_vector(),
        ) {
            let offset = [high, high * (low * 2.0_f64.powi(-54))];
            let fine = corners.map(|v| ExtendedPoint::from_products(&m, offset, &[(1.0, v)]));
            let right = corners.map(|v| exact_point(&m, offset, v));
            for (x, y) in fine.iter().zip(&right) {
                for (k, exact) in y.iter().enumerate() {
                    let found = ExtendedPoint::ORIGIN.displacement_to(x).sign_along(k);
                    prop_assert!(found.is_none_or(|s| s == exact.cmp(&RBig::ZERO)), "{x:?} {exact}");
                }
            }
            let ways = [1, 2, 3].map(|k| fine[0].displacement_to(&fine[k]));
            let truth = [1, 2, 3].map(|k| exact_displacement(&right[0], &right[k]));
            let det = |z: &[RBig; 3]| {
                (0..3).fold(RBig::ZERO, |sum, k| {
                    sum + z[k].clone() * exact_cross_component(&truth[0], &truth[1], k)
                })
            };
            let d_fine = ExtendedPoint::from_exact(d);
            let [volume, area] = [ways[2], ExtendedPoint::ORIGIN.displacement_to(&d_fine)].map(|z| [ways[0], ways[1], z]);
            let (right_volume, right_area) = (det(&truth[2]), det(&d.to_array().map(rational)));
            for (ways, right) in [(volume, &right_volume), (area, &right_area)] {
                let found = determinant(ways);
                prop_assert!(is_within_error(found, right), "{found:?} {right}");
                let sign = determinant_sign(ways);
                prop_assert!(sign.is_none_or(|s| s == right.cmp(&RBig::ZERO)), "{sign:?} {right}");
            }
            for k in 0..3 {
                let axes = [(k + 1) % 3, (k + 2) % 3];
                let (ways, right) = ([ways[0], ways[1]], exact_cross_component(&truth[0], &truth[1], k));
                let found = rounded_minor(ways, axes);
                prop_assert!(is_within_error(found, &right), "{found:?} {right}");
                let sign = minor_sign(ways, axes);
                prop_assert!(sign.is_none_or(|s| s == right.cmp(&RBig::ZERO)), "{sign:?} {right}");
            }
            let slack = 1e-30;
            if let Some(found) = determinant(volume).ratio(&determinant(area), slack) {
                let off = rational(found) - right_volume / right_area;
                let off = off.to_f64().value().abs();
                prop_assert!(off <= 2.0 * slack + f64::EPSILON * found.abs(), "{found} {off}");
            }
        }

        /// Points with few digits in one plane, or on one line, have certain zero signs.
        #[test]
        fn ties_of_short_numbers_have_certain_zero_sign(
            a in [-9_i32..9, -9..9, -9..9], b in [-9_i32..9, -9..9, -9..9], c in [-9_i32..9, -9..9, -9..9],
            s in -4_i32..4, t in -4_i32..4, off in -1.0..1.0_f64,
        ) {
            let point = |v: [i32; 3]| DVec3::from_array(v.map(f64::from));
            let (x, y) = (point(b), point(c));
            let z = x * f64::from(s) + y * f64::from(t);
            let offset = [DVec3::splat(off), DVec3::ZERO];
            let fine = [DVec3::ZERO, x, y, z]
                .map(|v| ExtendedPoint::from_products(&DMat3::IDENTITY, offset, &[(1.0, point(a) + v)]));
            let ways = [1, 2, 3].map(|k| fine[0].displacement_to(&fine[k]));
            prop_assert_eq!(determinant_sign(ways), Some(Ordering::Equal));
            let same = [0, 1].map(|_| ways[0]);
            prop_assert_eq!(minor_sign(same, [0, 1]), Some(Ordering::Equal));
        }
    }
}
