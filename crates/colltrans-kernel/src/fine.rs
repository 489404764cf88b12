//! Points in twice the usual precision and determinants of the ways between them, with what they may be off by.
//!
//! They tell most signs that rounding cannot at a tenth of what whole numbers cost. What is in doubt after that
//! is mostly nothing at all: where all digits fit, sums that say what they lost ([`Double`]) tell that.
//!
//! Rounding. A sum of two [`Twice`] is off by at most `3 u^2` of itself (a little more than that in `u^3`),
//! a product by `7 u^2` (Joldes, Muller and Popescu, "Tight and rigorous error bounds for basic building
//! blocks of double-word arithmetic", ACM TOMS 44(2), 2017): both by less than [`SMALL`] `= 2^-103`. A point's
//! coordinates are off by what [`Sums`] says.
//!
//! With `l, m, n` the sizes of three ways in the maximum norm and `e, f, g` what their ends are off by, a
//! determinant is six products of three: exact, each changes by at most `(l + e)(m + f)(n + g) - l m n`. Each
//! is made of three differences, two products and three sums, which make `6 (1.5 + 5)` of [`SMALL`] of
//! `l m n`. Of the two products of a [`minor`] each changes by `(l + e)(m + f) - l m`, and they make
//! `2 (1 + 2)`. The factors below are larger, for the rounding of the bounds themselves. What underflows of
//! numbers of at least `2^-505` is less than `2^-1070`, and with another factor less than [`TINY`].

use std::cmp::Ordering;

use glam::{DMat3, DVec3};

use super::double::{Double, Sums};
use super::real::{Real, Twice, Vector};

/// What a sum or a product is off by, of itself.
const SMALL: f64 = f64::EPSILON * f64::EPSILON * 2.0;
/// What underflows.
const TINY: f64 = f64::from_bits((1023 - 800) << 52);

/// A point, with what each coordinate may be off by.
#[derive(Debug, Clone, Copy)]
pub struct Fine {
    at: [Double; 3],
    error: f64,
}

impl Fine {
    pub const ORIGIN: Self = Self { at: [Double::ZERO; 3], error: 0.0 };

    /// `v`, exactly.
    #[inline]
    pub fn exactly(v: DVec3) -> Self {
        let at = v.to_array().map(|high| Double { high, ..Double::ZERO });
        Self { at, error: 0.0 }
    }

    /// The sum of two offsets and of `matrix point` for each point, by weight. Weights are powers of two.
    #[inline]
    pub fn placed(matrix: &DMat3, offset: [DVec3; 2], points: &[(f64, DVec3)]) -> Self {
        let [high, low] = offset.map(|part| part.to_array());
        let mut sums = Sums { high, low, ..Sums::ZERO };
        for (weight, point) in points {
            for column in 0..3 {
                let entries = matrix.col(column) * *weight;
                sums.add_products(entries.to_array(), point[column]);
            }
        }
        let error = sums.error.into_iter().fold(0.0, f64::max);
        Self { at: [0, 1, 2].map(|k| sums.get(k)), error: 1.01 * error }
    }

    /// The way to another point.
    #[inline]
    pub fn to<'p>(&'p self, end: &'p Self) -> Way<'p> {
        Way([self, end])
    }
}

/// The way from one point to another.
#[derive(Clone, Copy)]
pub struct Way<'p>([&'p Fine; 2]);

impl Way<'_> {
    #[inline]
    fn twice(&self) -> Vector<Twice> {
        let [from, to] = self.0.map(|point| Vector(point.at.map(|x| Twice::new(x.high, x.low))));
        to.minus(&from)
    }

    /// What each coordinate may be off by, but for the rounding of the difference.
    #[inline]
    fn error(&self) -> f64 {
        self.0[0].error + self.0[1].error
    }

    /// With all that it may be off by: nothing, where coordinates have few digits.
    #[inline]
    fn tracked(&self) -> [Double; 3] {
        let [from, to] = self.0.map(|point| point.at);
        [0, 1, 2].map(|k| {
            let mut sum = to[k];
            sum.add(-from[k].high);
            sum.add(-from[k].low);
            sum.error += from[k].error;
            sum.tidy()
        })
    }

    /// The sign of one coordinate, if it is certain.
    #[inline]
    pub fn sign_along(&self, axis: usize) -> Option<Ordering> {
        self.tracked()[axis].sign()
    }
}

/// A number with a bound of its error.
#[derive(Debug, Clone, Copy)]
pub struct Doubtful {
    value: Twice,
    error: f64,
}

impl Doubtful {
    /// The sign, if rounding leaves none in doubt.
    #[inline]
    pub fn sign(&self) -> Option<Ordering> {
        let high = self.value.value();
        (high.abs() > self.error).then(|| high.total_cmp(&0.0))
    }

    /// `self / other` to within two roundings, or to within `slack`; `None` if it is not known that well.
    #[inline]
    pub fn ratio(&self, other: &Self, slack: f64) -> Option<f64> {
        const ROUNDING: f64 = f64::EPSILON / 4.0;
        let [over, under] = [self.value, other.value].map(|x| x.value().abs());
        let known = under * ROUNDING > other.error
            && (over * ROUNDING > self.error || under * slack > self.error);
        known.then(|| (self.value / other.value).value())
    }
}

#[inline]
fn size(way: &Vector<Twice>) -> f64 {
    way.value().abs().max_element()
}

/// `det[x, y, z]`.
#[inline]
pub fn determinant([x, y, z]: [Way; 3]) -> Doubtful {
    let (e, f, g) = (x.error(), y.error(), z.error());
    let (x, y, z) = (x.twice(), y.twice(), z.twice());
    let (l, m, n) = (size(&x), size(&y), size(&z));
    let change = e * (m + f) * (n + g) + l * (f * (n + g) + m * g);
    let error = 8.0 * change + 48.0 * SMALL * (l * m * n) + TINY;
    Doubtful { value: x.dot(&y.cross(&z)), error }
}

/// The sign of `det[x, y, z]`, if it is certain.
#[inline]
pub fn determinant_sign(ways: [Way; 3]) -> Option<Ordering> {
    determinant(ways).sign().or_else(|| tracked_sign(ways))
}

/// The same of a determinant that rounding leaves in doubt.
#[inline]
pub fn tracked_sign(ways: [Way; 3]) -> Option<Ordering> {
    tracked_determinant(&ways.map(|way| way.tracked())).sign()
}

#[inline]
fn tracked_determinant([x, y, z]: &[[Double; 3]; 3]) -> Double {
    let mut sum = Double::ZERO;
    for (k, entry) in x.iter().enumerate() {
        sum.add_double_product(entry, &tracked_minor(y, z, [(k + 1) % 3, (k + 2) % 3]), 1.0);
    }
    sum
}

#[inline]
fn tracked_minor(x: &[Double; 3], y: &[Double; 3], [i, j]: [usize; 2]) -> Double {
    let mut sum = Double::ZERO;
    sum.add_double_product(&x[i], &y[j], 1.0);
    sum.add_double_product(&x[j], &y[i], -1.0);
    sum.tidy()
}

/// The sign of `x_i y_j - x_j y_i`, if it is certain.
#[inline]
pub fn minor_sign([x, y]: [Way; 2], [i, j]: [usize; 2]) -> Option<Ordering> {
    let rough = minor([x, y], [i, j]).sign();
    rough.or_else(|| tracked_minor(&x.tracked(), &y.tracked(), [i, j]).sign())
}

#[inline]
fn minor([x, y]: [Way; 2], [i, j]: [usize; 2]) -> Doubtful {
    let (e, f) = (x.error(), y.error());
    let (x, y) = (x.twice(), y.twice());
    let (l, m) = (size(&x), size(&y));
    let error = 4.0 * (e * (m + f) + l * f) + 8.0 * SMALL * (l * m) + TINY;
    let (Vector(x), Vector(y)) = (x, y);
    Doubtful { value: x[i] * y[j] - x[j] * y[i], error }
}

#[cfg(test)]
mod tests {
    use dashu_ratio::RBig;
    use proptest::prelude::*;

    use super::*;
    use crate::tests::{rational, vector};

    /// Entries of a matrix, tiny ones and zero among them.
    fn matrix() -> impl Strategy<Value = DMat3> {
        let turned = [-1.0..1.0_f64, -1.0..1.0, -1.0..1.0, 0.25..1.0]
            .prop_map(|q| DMat3::from_quat(glam::DQuat::from_array(q).normalize()));
        let column = || vector().prop_map(|v| v.clamp(DVec3::NEG_ONE, DVec3::ONE));
        let any = [column(), column(), column()];
        prop_oneof![
            Just(DMat3::IDENTITY),
            turned,
            any.prop_map(|[a, b, c]| DMat3::from_cols(a, b, c)),
        ]
    }

    /// Points that are all but on one plane, or anywhere.
    fn points() -> impl Strategy<Value = [DVec3; 4]> {
        let like = || [-2.0..2.0_f64, -2.0..2.0, -2.0..2.0].prop_map(DVec3::from_array);
        let (a, s) = (|| [like(), like(), like()], || -60..-20_i32);
        let flat = (a(), -1.0..1.0_f64, -1.0..1.0_f64, like(), s()).prop_map(
            |([a, b, c], s, t, off, k)| {
                [a, b, c, a + (b - a) * s + (c - a) * t + off * 2.0_f64.powi(k)]
            },
        );
        let line = (a(), s())
            .prop_map(|([a, b, off], k)| [a, b, a.lerp(b, 0.3) + off * 2.0_f64.powi(k), b]);
        prop_oneof![[vector(), vector(), vector(), vector()], flat, line]
    }

    fn exact(matrix: &DMat3, offset: [DVec3; 2], point: DVec3) -> [RBig; 3] {
        [0, 1, 2].map(|row| {
            let products = (0..3).map(|k| rational(matrix.col(k)[row]) * rational(point[k]));
            products.fold(rational(offset[0][row]) + rational(offset[1][row]), |sum, x| sum + x)
        })
    }

    fn from(a: &[RBig; 3], b: &[RBig; 3]) -> [RBig; 3] {
        [0, 1, 2].map(|k| b[k].clone() - a[k].clone())
    }

    fn cross(x: &[RBig; 3], y: &[RBig; 3], k: usize) -> RBig {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        x[i].clone() * y[j].clone() - x[j].clone() * y[i].clone()
    }

    /// Whether a number is known as well as it says.
    fn holds(found: Doubtful, truth: &RBig) -> bool {
        let high = rational(found.value.value());
        let low = rational((found.value - Twice::of(found.value.value())).value());
        let off = high + low - truth.clone();
        let error = rational(found.error);
        off <= error && -off <= error && found.sign().is_none_or(|s| s == truth.cmp(&RBig::ZERO))
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2_000))]

        #[test]
        fn bounds_of_fine_numbers_hold(
            m in matrix(), high in vector(), low in -1.0..1.0_f64, corners in points(), d in vector(),
        ) {
            let offset = [high, high * (low * 2.0_f64.powi(-54))];
            let fine = corners.map(|v| Fine::placed(&m, offset, &[(1.0, v)]));
            let right = corners.map(|v| exact(&m, offset, v));
            for (x, y) in fine.iter().zip(&right) {
                for (k, exact) in y.iter().enumerate() {
                    let found = Fine::ORIGIN.to(x).sign_along(k);
                    prop_assert!(found.is_none_or(|s| s == exact.cmp(&RBig::ZERO)), "{x:?} {exact}");
                }
            }
            let ways = [1, 2, 3].map(|k| fine[0].to(&fine[k]));
            let truth = [1, 2, 3].map(|k| from(&right[0], &right[k]));
            let det = |z: &[RBig; 3]| {
                (0..3).fold(RBig::ZERO, |sum, k| sum + z[k].clone() * cross(&truth[0], &truth[1], k))
            };
            let d_fine = Fine::exactly(d);
            let [volume, area] = [ways[2], Fine::ORIGIN.to(&d_fine)].map(|z| [ways[0], ways[1], z]);
            let (right_volume, right_area) = (det(&truth[2]), det(&d.to_array().map(rational)));
            for (ways, right) in [(volume, &right_volume), (area, &right_area)] {
                let found = determinant(ways);
                prop_assert!(holds(found, right), "{found:?} {right}");
                let sign = determinant_sign(ways);
                prop_assert!(sign.is_none_or(|s| s == right.cmp(&RBig::ZERO)), "{sign:?} {right}");
            }
            for k in 0..3 {
                let axes = [(k + 1) % 3, (k + 2) % 3];
                let (ways, right) = ([ways[0], ways[1]], cross(&truth[0], &truth[1], k));
                prop_assert!(holds(minor(ways, axes), &right), "{:?} {right}", minor(ways, axes));
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

        /// Points of few digits in one plane, or on one line, are known to be.
        #[test]
        fn ties_of_short_numbers_are_certain(
            a in [-9_i32..9, -9..9, -9..9], b in [-9_i32..9, -9..9, -9..9], c in [-9_i32..9, -9..9, -9..9],
            s in -4_i32..4, t in -4_i32..4, off in -1.0..1.0_f64,
        ) {
            let point = |v: [i32; 3]| DVec3::from_array(v.map(f64::from));
            let (x, y) = (point(b), point(c));
            let z = x * f64::from(s) + y * f64::from(t);
            let offset = [DVec3::splat(off), DVec3::ZERO];
            let fine = [DVec3::ZERO, x, y, z]
                .map(|v| Fine::placed(&DMat3::IDENTITY, offset, &[(1.0, point(a) + v)]));
            let ways = [1, 2, 3].map(|k| fine[0].to(&fine[k]));
            prop_assert_eq!(determinant_sign(ways), Some(Ordering::Equal));
            let same = [0, 1].map(|_| ways[0]);
            prop_assert_eq!(minor_sign(same, [0, 1]), Some(Ordering::Equal));
        }
    }
}
