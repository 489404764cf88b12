//! Sine and cosine of an angle, with equal bits on every platform.
//!
//! `docs/theory/exact-arithmetic.md` derives the error bounds. Notation: `u = 2^-53`. The angle is a sum of
//! two numbers. `r` is the remainder after `k` quarter turns, `|r|` at most slightly above `pi/4`.
//!
//! - *Reduction.* `pi/2` is a sum of three numbers, of which the first two have at most 33 bits (Cody and
//!   Waite). `r` is a sum of two numbers. Its error is below `2^-100` if the second part of the angle is 0, and below
//!   `2^-89` for the angles of motions.
//! - *Series.* The Taylor series are used up to `r^17` and `r^18`.
//!
//! Sine and cosine have an absolute error below `2 u`. For a small angle, the relative error of the sine is
//! below `2 u`, and of `1 - cos` at most `4 u`.

use crate::error_free::{difference_error, sum_error};

/// Maximum magnitude of an accepted angle, in radians.
pub const MAX_ANGLE: f64 = 1e5;

/// Terms of a sum for `pi / 2`, the first two with at most 33 bits.
const QUARTER_TURN: [f64; 3] =
    [1.570_796_326_734_125_6, 6.077_100_506_303_966e-11, 2.022_266_248_795_950_6e-21];

/// Coefficients `1 / k!` of the sine with alternating signs, for `k = 3, 5, ..., 17`.
const SINE_COEFFICIENTS: [f64; 8] = [
    -1.0 / 6.0,
    1.0 / 120.0,
    -1.0 / 5_040.0,
    1.0 / 362_880.0,
    -1.0 / 39_916_800.0,
    1.0 / 6_227_020_800.0,
    -1.0 / 1_307_674_368_000.0,
    1.0 / 355_687_428_096_000.0,
];

/// Coefficients `1 / k!` of the cosine with alternating signs, for `k = 4, 6, ..., 18`.
const COSINE_COEFFICIENTS: [f64; 8] = [
    1.0 / 24.0,
    -1.0 / 720.0,
    1.0 / 40_320.0,
    -1.0 / 3_628_800.0,
    1.0 / 479_001_600.0,
    -1.0 / 87_178_291_200.0,
    1.0 / 20_922_789_888_000.0,
    -1.0 / 6_402_373_705_728_000.0,
];

/// Sine and cosine of an angle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SineCosine {
    pub sin: f64,
    pub cos: f64,
    /// The versine `1 - cos`.
    pub versine: f64,
}

/// Computes sine, cosine and versine of the angle `high + low` in radians, of magnitude at most [`MAX_ANGLE`].
#[inline]
pub fn sine_and_cosine(high: f64, low: f64) -> SineCosine {
    let k = (high * std::f64::consts::FRAC_2_PI).round();
    let first = high - k * QUARTER_TURN[0];
    let second = first - k * QUARTER_TURN[1];
    let rest = (difference_error(first, k * QUARTER_TURN[1]) - k * QUARTER_TURN[2]) + low;
    let r = second + rest;
    let tail = sum_error(second, rest, r);
    let square = r * r;
    let series = |terms: &[f64; 8]| terms.iter().rev().fold(0.0, |sum, term| sum * square + term);
    let half = 0.5 * square;
    let sin = r + (r * (square * series(&SINE_COEFFICIENTS)) + tail * (1.0 - half));
    let beyond = square * square * series(&COSINE_COEFFICIENTS) - r * tail;
    let near = 1.0 - half;
    let cos = near + (((1.0 - near) - half) + beyond);
    match (k as i64).rem_euclid(4) {
        0 => SineCosine { sin, cos, versine: half - beyond },
        1 => SineCosine { sin: cos, cos: -sin, versine: 1.0 + sin },
        2 => SineCosine { sin: -sin, cos: -cos, versine: 1.0 + cos },
        _ => SineCosine { sin: -cos, cos: sin, versine: 1.0 - sin },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::rational;
    use dashu_ratio::RBig;

    fn rational_integer(x: i64) -> RBig {
        RBig::from(x)
    }

    /// Returns `pi` within `2^-200`, by Machin's formula.
    fn rational_pi() -> RBig {
        let arctan = |n: i64| {
            let (mut sum, mut power) = (RBig::ZERO, RBig::ONE / rational_integer(n));
            let square = rational_integer(n * n);
            for k in 0..80_i64 {
                let term = power.clone() / rational_integer(2 * k + 1);
                sum = if k % 2 == 0 { sum + term } else { sum - term };
                power /= square.clone();
            }
            sum
        };
        rational_integer(16) * arctan(5) - rational_integer(4) * arctan(239)
    }

    /// Computes sine and cosine by the Taylor series of the remainder after whole turns. Terms are truncated
    /// to multiples of `2^-200`.
    fn exact_sine_cosine(angle: &RBig) -> [RBig; 2] {
        let turn = rational_integer(2) * rational_pi();
        let turns = (angle.clone() / turn.clone() + RBig::ONE / rational_integer(2)).floor();
        let r = angle.clone() - RBig::from(turns) * turn;
        let cut = |x: RBig| {
            let scale = (0..4).fold(RBig::ONE, |scale, _| scale * rational_integer(1 << 50));
            RBig::from((x * scale.clone()).floor()) / scale
        };
        let (mut sums, mut term) = ([RBig::ZERO, RBig::ZERO], RBig::ONE);
        for k in 0..60_i64 {
            let signed = if k % 4 < 2 { term.clone() } else { -term.clone() };
            sums[(1 - k % 2) as usize] += signed;
            term = cut(term * r.clone() / rational_integer(k + 1));
        }
        sums
    }

    #[test]
    fn sine_and_cosine_are_within_stated_errors() {
        let u = rational(0.5 * f64::EPSILON);
        let size = |x: &RBig| if *x < RBig::ZERO { -x.clone() } else { x.clone() };
        let quarter = std::f64::consts::FRAC_PI_2;
        let mut angles = vec![0.0, 1e-300, 1e-9, 0.785, 0.786, quarter, 3.0, -6.0, 1e5, -99_999.9];
        for k in 0..300_i32 {
            let x = f64::from(k);
            let tiny = 1e-6 * f64::from(k % 7) * x.recip().min(1.0);
            angles.extend([x * 0.02, x * quarter, x * quarter * (1.0 + tiny), x * x]);
        }
        for high in angles {
            for low in [0.0, high * 3e-17, -high * 5e-17] {
                let found = sine_and_cosine(high, low);
                let [sin, cos] = exact_sine_cosine(&(rational(high) + rational(low)));
                let off = |x: f64, exact: &RBig| size(&(rational(x) - exact.clone()));
                assert!(off(found.sin, &sin) < rational_integer(2) * u.clone(), "sine of {high}");
                assert!(off(found.cos, &cos) < rational_integer(2) * u.clone(), "cosine of {high}");
                let versine = RBig::ONE - cos;
                assert!(off(found.versine, &versine) < rational_integer(3) * u.clone());
                if high.abs() < 0.7 && high.abs() > 1e-100 {
                    assert!(off(found.sin, &sin) < rational_integer(2) * u.clone() * size(&sin));
                    let most = rational_integer(4) * u.clone() * versine.clone();
                    assert!(off(found.versine, &versine) <= most, "{high}");
                }
            }
        }
    }

    #[test]
    fn quarter_turn_parts_are_short_and_sum_to_half_pi() {
        for part in &QUARTER_TURN[..2] {
            assert_eq!(part.to_bits() << 44 >> 44, 0, "at most 33 bits");
        }
        let sum = QUARTER_TURN.iter().fold(RBig::ZERO, |sum, x| sum + rational(*x));
        let off = sum * rational_integer(2) - rational_pi();
        let size = if off < RBig::ZERO { -off } else { off };
        assert!(size < rational(2.0_f64.powi(-115)));
    }
}
