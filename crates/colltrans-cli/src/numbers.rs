//! Formats numbers, intervals and vectors for text output, as `colltrans help files` states.
//!
//! Text has the digits that are known, at most [`MAX_DIGITS`] of them. JSON, tables and proofs have all digits.
//! - An estimate is rounded at its error ([`estimate`]).
//! - A bound is rounded to the side on which it still holds ([`at_least`], [`at_most`]).
//! - An interval contains the given one ([`interval`]).
//!
//! A printed number is compared as the `f64` that it is read back as, like a number of JSON.

use colltrans::Aabb;
use colltrans::glam::DVec3;
pub(crate) use colltrans_mesh::words::{
    count_text, decade, error_bound, number, rounded_to_error, six_digits,
};
use colltrans_mesh::words::{round_down, round_up};

/// Maximum number of significant digits of a number.
const MAX_DIGITS: usize = 9;
/// Number of significant digits of tolerances, gaps and depths.
const LENGTH_DIGITS: usize = 6;
/// Rounding error of points, relative to the extent of a body, and of the components of unit vectors.
const POINT_ERROR: f64 = 1e-7;
/// Half width of an interval, relative to its middle, up to which the middle is printed.
const NARROW: f64 = 0.01;
/// Factor by which rounding may widen an interval, unless it would need more than [`MAX_DIGITS`] digits.
const WIDENING: f64 = 1.25;
/// Number of significant digits of the ends of a wide interval.
const END_DIGITS: usize = 4;
/// Number of significant digits of the half width of a narrow interval.
const HALF_WIDTH_DIGITS: usize = 2;

/// Returns an interval, with at most [`MAX_DIGITS`] digits in each number. The printed interval contains the given one.
///
/// - `7 ± 7.3e-13`: the middle with the fewest digits that widen the interval by no more than a quarter, and the half
///   width. If that needs more than [`MAX_DIGITS`] digits, the half width grows by the rounding error of the middle.
/// - `0.2 to 0.95`: the ends, if the half width is more than a hundredth of the middle.
/// - `0.25`: a number, if the width is zero and the number has at most [`MAX_DIGITS`] digits.
/// - `at least 3`, `at most 3`: one end, if the other one is infinite.
pub(crate) fn interval([lower, upper]: [f64; 2]) -> String {
    let bounded_below = lower > f64::NEG_INFINITY;
    let bounded_above = upper < f64::INFINITY;
    if bounded_below != bounded_above {
        return if bounded_below {
            format!("at least {}", at_least(lower))
        } else {
            format!("at most {}", at_most(upper))
        };
    }
    if lower == upper && is_short(lower) {
        return number(lower);
    }
    if let Some((middle, half_width)) = middle_and_half_width([lower, upper]) {
        return format!("{} ± {}", number(middle), number(half_width));
    }
    let ends = [round_down(lower, END_DIGITS), round_up(upper, END_DIGITS)];
    ends.map(number).join(" to ")
}

/// Returns the rounded middle and half width of a narrow interval, or of one that is nearly symmetric to zero. Returns
/// `None` for other intervals, and if a number is not finite.
fn middle_and_half_width([lower, upper]: [f64; 2]) -> Option<(f64, f64)> {
    let half_width = 0.5 * upper - 0.5 * lower;
    if lower <= 0.0 && 0.0 <= upper {
        let around_zero = upper.max(-lower);
        let shown = round_up(around_zero, HALF_WIDTH_DIGITS);
        return (around_zero <= WIDENING * half_width && shown.is_finite()).then_some((0.0, shown));
    }
    let middle = 0.5 * lower + 0.5 * upper;
    if half_width > NARROW * middle.abs() {
        return None;
    }
    let rounded = |digits: usize| {
        let shown: f64 = format!("{middle:.*e}", digits - 1).parse().unwrap_or(middle);
        // The decimal number differs from `shown` by at most half the distance to the next number.
        let spacing = shown.abs().next_up() - shown.abs();
        let needed = (upper - shown).max(shown - lower) * (1.0 + 4.0 * f64::EPSILON) + spacing;
        (shown, round_up(needed, HALF_WIDTH_DIGITS))
    };
    let mut all = (1..=MAX_DIGITS).map(rounded).filter(|(a, b)| a.is_finite() && b.is_finite());
    let is_tight = |(_, shown): &(f64, f64)| *shown <= WIDENING * half_width;
    all.clone().find(is_tight).or_else(|| all.next_back())
}

/// Returns an interval that a unit follows, in parentheses if it has two numbers.
pub(crate) fn interval_of_unit(bounds: [f64; 2], unit: &str) -> String {
    let text = interval(bounds);
    let has_two = text.contains(" ± ") || text.contains(" to ");
    if has_two { format!("({text}) {unit}") } else { format!("{text} {unit}") }
}

/// Returns a lower bound, rounded down to at most [`MAX_DIGITS`] digits.
pub(crate) fn at_least(bound: f64) -> String {
    number(round_down(bound, MAX_DIGITS))
}

/// Returns an upper bound, rounded up to at most [`MAX_DIGITS`] digits.
pub(crate) fn at_most(bound: f64) -> String {
    number(round_up(bound, MAX_DIGITS))
}

/// Returns a length that is safe if it is too long, for example a tolerance, rounded up to [`LENGTH_DIGITS`] digits. A
/// number of at most [`MAX_DIGITS`] digits is unchanged.
pub(crate) fn length_up(length: f64) -> String {
    number(if is_short(length) { length } else { round_up(length, LENGTH_DIGITS) })
}

/// Returns a length that is safe if it is too short, for example a minimum gap, rounded down to [`LENGTH_DIGITS`] digits.
/// A number of at most [`MAX_DIGITS`] digits is unchanged.
pub(crate) fn length_down(length: f64) -> String {
    number(if is_short(length) { length } else { round_down(length, LENGTH_DIGITS) })
}

/// Returns a number that is known to within `error`, with at most [`MAX_DIGITS`] digits.
pub(crate) fn estimate(value: f64, error: f64) -> String {
    let nearest: f64 = format!("{value:.*e}", MAX_DIGITS - 1).parse().unwrap_or(value);
    let known = rounded_to_error(value, error);
    if known.parse::<f64>().is_ok_and(is_short) { known } else { number(nearest) }
}

/// Checks whether a number has at most [`MAX_DIGITS`] significant digits.
fn is_short(value: f64) -> bool {
    format!("{value:.*e}", MAX_DIGITS - 1).parse() == Ok(value)
}

/// Returns a vector of any length, for example of the command line, with [`MAX_DIGITS`] digits.
pub(crate) fn vector(v: DVec3) -> String {
    known_vector(v, 0.0)
}

/// Returns a unit vector, rounded to [`POINT_ERROR`].
pub(crate) fn unit_vector(v: DVec3) -> String {
    known_vector(v, POINT_ERROR)
}

/// Returns a unit quaternion, rounded to [`POINT_ERROR`].
pub(crate) fn unit_quaternion(q: [f64; 4]) -> String {
    q.map(|c| estimate(c, POINT_ERROR)).join(",")
}

/// Returns a unit vector inside a region, from whose border it is `margin` away. It has enough digits to stay inside.
pub(crate) fn unit_vector_within(v: DVec3, margin: f64) -> String {
    let error = (0.1 * margin).min(POINT_ERROR);
    v.to_array().map(|c| rounded_to_error(c, error)).join(",")
}

/// Returns a point that is known to within `error`, rounded at [`POINT_ERROR`] of the extent of a body.
pub(crate) fn point(v: DVec3, error: f64, extent: f64) -> String {
    known_vector(v, error.max(POINT_ERROR * extent))
}

/// Returns a vector whose components are known to within `error`.
fn known_vector(v: DVec3, error: f64) -> String {
    v.to_array().map(|c| estimate(c, error)).join(",")
}

/// Returns the largest side of the smaller box; a body without extent does not count.
pub(crate) fn smaller_extent(boxes: impl IntoIterator<Item = Aabb>) -> f64 {
    let extents = boxes.into_iter().map(|Aabb { low, high }| (high - low).max_element());
    let least = extents.filter(|extent| *extent > 0.0).fold(f64::INFINITY, f64::min);
    if least.is_finite() { least } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use colltrans_testkit::random::Random;

    #[test]
    fn signed_zeros_print_as_zero() {
        assert_eq!(vector(DVec3::new(-0.0, 1.0, -2.5)), "0,1,-2.5");
        assert_eq!(unit_vector(DVec3::new(1e-17, -1e-16, -1.0)), "0,0,-1");
        assert_eq!(interval([-0.0, 0.0]), "0");
        assert_eq!([at_least(-0.0), at_most(-0.0), length_up(-0.0)], ["0"; 3]);
        assert_eq!(estimate(-1e-16, 1e-14), "0");
    }

    #[test]
    fn intervals_have_the_digits_that_are_known() {
        for (bounds, shown) in [
            ([6.999_999_999_999_279, 7.000_000_000_000_721], "7 ± 7.3e-13"),
            ([5.763_932_022_500_097, 5.763_932_022_500_593], "5.76393202 ± 2.6e-9"),
            ([4.1365, 4.1367], "4.1366 ± 0.00011"),
            ([-3.0e-13, 4.0e-13], "0 ± 4e-13"),
            ([-1e-13, 4e-13], "-1e-13 to 4e-13"),
            ([0.2, 0.949_999], "0.2 to 0.95"),
            ([1e-9, 1.0], "1e-9 to 1"),
            ([0.25, 0.25], "0.25"),
            ([1.0 / 3.0, 1.0 / 3.0], "0.333333333 ± 3.4e-10"),
            ([3.000_000_000_01, f64::INFINITY], "at least 3"),
            ([f64::NEG_INFINITY, 3.000_000_000_01], "at most 3.00000001"),
            ([f64::NEG_INFINITY, f64::INFINITY], "-inf to inf"),
        ] {
            assert_eq!(interval(bounds), shown, "{bounds:?}");
        }
    }

    #[test]
    fn bounds_and_lengths_are_rounded_to_the_safe_side() {
        assert_eq!(at_least(6.999_999_999_999_279), "6.99999999");
        assert_eq!(at_most(12.000_000_000_001_384), "12.0000001");
        assert_eq!(length_up(2.384_185_840_753_616_5e-6), "2.38419e-6");
        assert_eq!(length_down(0.123_456_789_9), "0.123456");
        assert_eq!([length_up(0.1), length_down(0.012_345_678_9)], ["0.1", "0.0123456789"]);
        for value in [0.1, 0.12345, 0.999_96, 7.0, 1e-7 / 3.0, 2.0 / 3.0, 123_456.7] {
            let shown: f64 = length_up(value).parse().unwrap();
            assert!(shown >= value && shown <= value * 1.00002, "{value} as {shown}");
        }
    }

    #[test]
    fn estimates_have_at_most_nine_digits() {
        assert_eq!(estimate(4.316_736_420_582, 1e-12), "4.31673642");
        assert_eq!(estimate(-1_234.567_891, 0.02), "-1234.57");
        assert_eq!(estimate(1.0 / 3.0, 0.0), "0.333333333");
        assert_eq!(point(DVec3::new(1.0 / 3.0, 2e-9, -5.0), 0.0, 1.0), "0.3333333,0,-5");
        assert_eq!(unit_vector_within(DVec3::new(2.34e-10, 0.0, 1.0), 1e-9), "2e-10,0,1");
    }

    /// Returns the interval that a text states, and asserts that each number has at most nine digits.
    fn read_back(text: &str) -> [f64; 2] {
        let read = |word: &str| -> f64 {
            let (mantissa, _) = word.split_once('e').unwrap_or((word, ""));
            let digits: String = mantissa.chars().filter(char::is_ascii_digit).collect();
            let digits = digits.trim_start_matches('0').trim_end_matches('0');
            assert!(digits.len() <= MAX_DIGITS, "{text}");
            assert_ne!(word, "-0");
            word.parse().unwrap()
        };
        if let Some((middle, half)) = text.split_once(" ± ") {
            let [middle, half] = [middle, half].map(read);
            [middle - half, middle + half]
        } else if let Some((lower, upper)) = text.split_once(" to ") {
            [lower, upper].map(read)
        } else if let Some(lower) = text.strip_prefix("at least ") {
            [read(lower), f64::INFINITY]
        } else if let Some(upper) = text.strip_prefix("at most ") {
            [f64::NEG_INFINITY, read(upper)]
        } else {
            [read(text); 2]
        }
    }

    #[test]
    fn printed_intervals_contain_the_given_ones() {
        let mut random = Random::new(1);
        let special = [0.0, 5e-324, 1e-310, f64::MIN_POSITIVE, 0.1, 1.0, 7.0, 1e300, f64::MAX];
        for _ in 0..10_000 {
            let any = |random: &mut Random| loop {
                let value = match random.index(4) {
                    0 => f64::from_bits(random.bits()),
                    1 => special[random.index(special.len())],
                    2 => random.range(-100.0, 100.0),
                    _ => random.whole(-1000, 1000) / 8.0,
                };
                let value = if random.one_in(2) { -value } else { value };
                if !value.is_nan() {
                    break if random.one_in(20) { f64::INFINITY.copysign(value) } else { value };
                }
            };
            let a = any(&mut random);
            let b = match random.index(5) {
                0 => a,
                1 => any(&mut random),
                2 => a.next_up(),
                _ => a + a.abs() * 10.0_f64.powi(random.int(-17, 2) as i32) * random.unit(),
            };
            let bounds = [a.min(b), a.max(b)];
            // A bound cannot be infinite on the wrong side.
            if bounds[0] == f64::INFINITY || bounds[1] == f64::NEG_INFINITY {
                continue;
            }
            let text = interval(bounds);
            let [lower, upper] = read_back(&text);
            assert!(lower <= bounds[0] && bounds[1] <= upper, "{bounds:?} as {text}");
        }
    }
}
