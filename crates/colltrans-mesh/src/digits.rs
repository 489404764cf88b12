//! The precision of coordinates that are written as text, from the digits that are written.
//!
//! A writer prints a number of decimals (`%.6f`) or of significant digits (`%g`), so each coordinate that it
//! had to round ends in the last place that it prints. Numbers that end sooner are exact: those of a drawing
//! (`12.5`), or whole binary fractions (`0.0625`). The writer's format is therefore read from the numbers that
//! are no binary fractions, trailing zeros apart:
//!
//! - Many different ones ([`MANY`]), more than half of all, end in the same place: *decimals*.
//! - Or they have the same number of significant digits: *digits*. Of seven digits one may be missing, of
//!   more two, because the shortest text of a number in single precision has six to nine.
//! - Neither, or up to [`EXACT`] digits at most: the numbers are exact decimals, as far as doubles are.
//! - More than [`ALL`] digits: doubles with all their digits.
//!
//! Digits are those of the shortest decimal that reads as the same double. Up to 15 significant digits that is
//! the text of the file.

use std::collections::HashSet;
use std::fmt;
use std::fmt::Write as _;

use glam::DVec3;

/// How a file writes its coordinates.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum NumberFormat {
    /// In double precision, or as decimals that are exact.
    #[default]
    Double,
    /// In single precision.
    Single,
    /// As text, rounded to this many decimals.
    Decimals(u32),
    /// As text, rounded to this many significant digits.
    Digits(u32),
}

impl fmt::Display for NumberFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Double => f.write_str("double precision"),
            Self::Single => f.write_str("single precision"),
            Self::Decimals(count) => write!(f, "text of {count} decimals"),
            Self::Digits(count) => write!(f, "text of {count} significant digits"),
        }
    }
}

/// Maximum number of significant digits that are taken as exact.
const EXACT: u32 = 4;
/// Maximum number of significant digits that are fewer than those of a double.
const ALL: u32 = 15;
/// Minimum number of different coordinates that show how a writer rounds.
const MANY: usize = 4;
/// Maximum number of coordinates that are looked at; of more, some at even distances.
const LOOKED_AT: usize = 1 << 16;

impl NumberFormat {
    /// The format of these coordinates of a text; `single` if they were read in single precision.
    pub(crate) fn of_text(coordinates: &[DVec3], single: bool) -> Self {
        let read_as = if single { Self::Single } else { Self::Double };
        let step = coordinates.len().div_ceil(LOOKED_AT / 3).max(1);
        let looked_at = coordinates.iter().step_by(step).flat_map(DVec3::to_array);
        let different: HashSet<u64> = looked_at.map(|x| x.abs().to_bits()).collect();
        let mut text = String::new();
        let mut decimal = |bits: u64| Decimal::of(f64::from_bits(bits), single, &mut text);
        let rounded: Vec<Decimal> = different
            .into_iter()
            .filter_map(&mut decimal)
            .filter(|decimal| !decimal.is_binary_fraction())
            .collect();
        let most = |of: fn(&Decimal) -> i32| rounded.iter().map(of).max().unwrap_or(0);
        let (digits, decimals) = (most(|x| x.digits), most(|x| x.decimals));
        if digits <= EXACT as i32 || digits > ALL as i32 && !single {
            return read_as;
        }
        let missing = (digits - 6).clamp(0, 2);
        let count = |is: &dyn Fn(&Decimal) -> bool| rounded.iter().filter(|x| is(x)).count();
        let by_place = count(&|x| x.decimals == decimals);
        let [by_digits, nearly] = [0, missing].map(|less| count(&|x| x.digits >= digits - less));
        let many = |count: usize| count >= MANY && 2 * count > rounded.len();
        let found = if many(by_place) && by_place >= by_digits && decimals > 0 {
            Self::Decimals(decimals as u32)
        } else if many(nearly) {
            Self::Digits(digits as u32)
        } else {
            return read_as;
        };
        // All of them may be numbers in single precision, which knows less than eight or nine digits say.
        let is_single = digits > 7 && rounded.iter().all(|x| x.is_single);
        let largest = largest_magnitude(coordinates);
        if is_single && Self::Single.precision(largest) > found.precision(largest) {
            Self::Single
        } else {
            found
        }
    }

    /// [`Self::precision`] of these coordinates.
    pub(crate) fn precision_of(self, coordinates: &[DVec3]) -> f64 {
        self.precision(largest_magnitude(coordinates))
    }

    /// How far apart two vertices may be written that were meant to be one, where the largest coordinate has this
    /// magnitude: two units in its last place, because a distance is at most `sqrt(3)` times the difference of a
    /// coordinate; of doubles more, as they are computed in a few dozen roundings.
    pub(crate) fn precision(self, largest: f64) -> f64 {
        let of_doubles = largest / (1_u64 << 48) as f64;
        match self {
            Self::Double => of_doubles,
            Self::Single => largest / (1_u64 << 22) as f64,
            Self::Decimals(decimals) => of_doubles.max(2.0 * power_of_ten(-(decimals as i32))),
            Self::Digits(digits) => {
                let first = Decimal::of(largest, false, &mut String::new());
                let exponent = first.map_or(0, |first| first.digits - first.decimals - 1);
                of_doubles.max(2.0 * power_of_ten(exponent - digits as i32 + 1))
            }
        }
    }
}

/// `10^exponent`, correctly rounded.
fn power_of_ten(exponent: i32) -> f64 {
    format!("1e{exponent}").parse().unwrap_or(0.0)
}

/// The largest magnitude of a coordinate that is finite; 0 if none is.
pub(crate) fn largest_magnitude(vertices: &[DVec3]) -> f64 {
    let magnitudes = vertices.iter().flat_map(DVec3::to_array).map(f64::abs);
    magnitudes.filter(|m| m.is_finite()).fold(0.0, f64::max)
}

/// A number `mantissa / 10^decimals` without trailing zeros.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Decimal {
    mantissa: u64,
    /// Significant digits.
    digits: i32,
    /// Places after the point; negative for whole numbers that end in zeros.
    decimals: i32,
    /// Whether a number in single precision has the same shortest text.
    is_single: bool,
}

impl Decimal {
    /// The shortest one of a positive number, if this is finite; `text` is room to write.
    fn of(x: f64, single: bool, text: &mut String) -> Option<Self> {
        if !(x.is_finite() && x > 0.0) {
            return None;
        }
        let mut shortest = |number: &dyn fmt::LowerExp| {
            text.clear();
            // Writing to a string cannot fail.
            let _ = write!(text, "{number:e}");
            let (mantissa, exponent) = text.split_once('e')?;
            let digits = mantissa.bytes().filter(u8::is_ascii_digit).count() as i32;
            let whole = mantissa.bytes().filter(u8::is_ascii_digit);
            let mantissa = whole.fold(0, |sum: u64, digit| 10 * sum + u64::from(digit - b'0'));
            Some((mantissa, digits, digits - 1 - exponent.parse::<i32>().ok()?))
        };
        let in_single = shortest(&(x as f32));
        let found = if single { in_single } else { shortest(&x) };
        let (mantissa, digits, decimals) = found?;
        Some(Self { mantissa, digits, decimals, is_single: in_single == found })
    }

    /// Whether it is a whole number over a power of 2, which binary numbers hold exactly.
    fn is_binary_fraction(&self) -> bool {
        let five = u32::try_from(self.decimals).map_or(Some(1), |places| 5_u64.checked_pow(places));
        five.is_some_and(|power| self.mantissa.is_multiple_of(power))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use colltrans_testkit::random::Random;

    /// The format of numbers, each as a writer prints it.
    fn format_of(
        numbers: impl Iterator<Item = f64>,
        print: impl Fn(f64) -> String,
    ) -> NumberFormat {
        let numbers: Vec<f64> = numbers.map(|x| print(x).parse().unwrap()).collect();
        let points: Vec<DVec3> = numbers.chunks_exact(3).map(DVec3::from_slice).collect();
        NumberFormat::of_text(&points, false)
    }

    /// As `%.{digits}g` prints.
    fn significant(x: f64, digits: usize) -> String {
        format!("{x:.*e}", digits - 1)
    }

    fn random(low: f64, high: f64) -> impl Iterator<Item = f64> {
        let mut random = Random::new(7);
        (0..300).map(move |_| random.range(low, high))
    }

    #[test]
    fn what_writers_print_is_recognised() {
        for places in 4..=9 {
            let printed = format_of(random(-300.0, 300.0), |x| format!("{x:.places$}"));
            assert_eq!(printed, NumberFormat::Decimals(places as u32));
        }
        for digits in 5..=15 {
            let printed = format_of(random(-300.0, 300.0), |x| significant(x, digits));
            assert_eq!(printed, NumberFormat::Digits(digits as u32));
        }
        let all = format_of(random(-300.0, 300.0), |x| x.to_string());
        assert_eq!(all, NumberFormat::Double);
        let single = format_of(random(-300.0, 300.0), |x| (x as f32).to_string());
        assert_eq!(single, NumberFormat::Single);
    }

    #[test]
    fn short_numbers_are_exact() {
        // Drawings, inches, binary fractions with any number of digits.
        let cases: [&[f64]; 4] = [
            &[0.0, 1.0, 0.5, 250.0, -1e6, 1000.0],
            &[0.1, 12.3, 4.55, 0.001, 101.3, 7.0],
            &[104.775, 12.7, 25.4, 50.8, 3.175, 88.9, 0.0, 6.35, 19.05],
            &[1.0 / 256.0, 1.0 / 1024.0, 3.0 + 1.0 / 2048.0, 17.0, 0.125, 5.5],
        ];
        for numbers in cases {
            let found = format_of(numbers.iter().copied(), |x| x.to_string());
            assert_eq!(found, NumberFormat::Double, "{numbers:?}");
        }
    }

    #[test]
    fn exact_numbers_beside_rounded_ones_change_nothing() {
        let mixed = random(-3.0, 3.0).chain([0.0, 0.5, 10.0, 1.25, 12.5, 200.0]);
        let printed = format_of(mixed, |x| format!("{x:.6}"));
        assert_eq!(printed, NumberFormat::Decimals(6));
        assert_eq!(printed.precision(200.0), 2e-6);
        assert_eq!(NumberFormat::Digits(6).precision(200.0), 2e-3);
        assert_eq!(NumberFormat::Digits(6).precision(0.05), 2e-7);
    }
}
