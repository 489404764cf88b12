//! Detects the number format of coordinates in a text, and thereby their precision, from the printed digits.
//!
//! A writer prints a fixed number of decimals (`%.6f`) or of significant digits (`%g`). A coordinate that it
//! rounds mostly ends in the last place of this format. Numbers that end sooner may be exact: those of a
//! drawing (`12.5`), or binary fractions (`0.0625`). The format therefore follows from the *rounded* numbers,
//! without trailing zeros. These are fractions that are not binary fractions, and whole numbers that are
//! printed with an exponent (`1.54245e+07`). The last digit of the latter need not be a unit.
//!
//! - *Decimals*: at least [`MANY`] rounded numbers, and more than half of them, have the maximum number of
//!   decimals.
//! - *Digits*: as many have the maximum number of significant digits. One digit may be missing from a maximum of
//!   seven, and two from a larger one, because the shortest text of a number in single precision has six to nine.
//! - Otherwise the numbers count as exact in the precision in which they are read. So do numbers on a grid
//!   ([`is_grid`]), numbers of more than [`ALL`] digits, and numbers of at most [`EXACT`] digits. The latter are
//!   rounded nevertheless if zeros fill up each number to the same place ([`fixed_places`]).
//!
//! The maximum leaves out one number in [`OUTLIERS`], which may have more digits, for example after edits by
//! hand.
//!
//! Digits are those of the shortest decimal that reads as the same double. Up to 15 significant digits that is
//! the text of the file. A double does not contain exponents and trailing zeros, so readers record these
//! ([`Printed`]).
//!
//! The format alone may be finer than the numbers: a program that computes in single precision prints them with
//! nine digits, eight decimals, or all digits of a double. So each number is compared with the nearest one in single
//! precision (`Decimal::single_bits`). If nearly all are such numbers rounded to the printed place, and chance
//! explains this with a probability below `2^-SURE` only, the file is in single precision.

use std::collections::HashMap;
use std::fmt;
use std::fmt::Write as _;

use glam::DVec3;

use crate::mesh::Mesh;

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
/// Maximum number of significant digits of a rounded text. A text with more digits has all those of a double.
const ALL: u32 = 15;
/// Minimum number of different coordinates that show how a writer rounds.
const MANY: usize = 4;
/// Maximum common divisor that occurs by chance, in units of the last decimal.
const GRID: u64 = 8;
/// One number out of this many may be printed differently from the others.
const OUTLIERS: usize = 16;
/// Minimum evidence that numbers are in single precision, in bits: the negative binary logarithm of the probability
/// that chance explains them.
const SURE: f64 = 20.0;
/// Maximum evidence of one number, in bits: [`MANY`] of these are sure.
const MAX_BITS: f64 = SURE / MANY as f64;
/// Maximum number of coordinates that are examined. If there are more, a sample at equal distances is used.
const MAX_EXAMINED: usize = 1 << 16;

/// The printed form of a number, as far as its value does not show it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Printed {
    /// Number of digits between the point and the exponent or the end; at most 255.
    places: u8,
    /// Whether the last of these digits is 0.
    is_padded: bool,
    has_exponent: bool,
}

impl Printed {
    /// Returns the form of a number's text.
    pub(crate) fn from_text(text: &str) -> Self {
        let text = text.as_bytes();
        let end = text.iter().position(|byte| matches!(byte, b'e' | b'E'));
        let mantissa = &text[..end.unwrap_or(text.len())];
        let point = mantissa.iter().position(|byte| *byte == b'.');
        let decimals = point.map_or(&[][..], |point| &mantissa[point + 1..]);
        Self {
            places: decimals.len().min(255) as u8,
            is_padded: decimals.last() == Some(&b'0'),
            has_exponent: end.is_some(),
        }
    }
}

/// The fixed number of places that a writer prints for each number, zeros included.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum FixedPlaces {
    /// As `%.3f` prints.
    Decimals(i32),
    /// As `%.3e` prints: significant digits, one of them before the point.
    Digits(i32),
}

/// Returns the places that nearly all numbers have in common, if these are two decimals or more and some of the
/// numbers end in zeros. A single decimal shows nothing, because `1.0` is also the shortest text of a number.
fn fixed_places<'a>(numbers: impl Iterator<Item = &'a Printed>) -> Option<FixedPlaces> {
    // For each number of places, without and with an exponent: how many numbers end in another digit than 0, and
    // how many in 0.
    let mut counts = [[[0; 2]; 2]; 256];
    let mut total = 0;
    for number in numbers {
        let count = &mut counts[usize::from(number.places)][usize::from(number.has_exponent)];
        count[usize::from(number.is_padded)] += 1;
        total += 1;
    }
    let is_fixed = |[full, padded]: [usize; 2]| padded > 0 && is_nearly_all(full + padded, total);
    (2..).zip(&counts[2..]).find_map(|(places, [plain, with_exponent])| {
        if is_fixed(*plain) {
            Some(FixedPlaces::Decimals(places))
        } else {
            is_fixed(*with_exponent).then_some(FixedPlaces::Digits(places + 1))
        }
    })
}

/// Checks whether a count is the total, except for one in [`OUTLIERS`].
const fn is_nearly_all(count: usize, total: usize) -> bool {
    total - count <= total / OUTLIERS
}

impl NumberFormat {
    /// Returns the format of the coordinates of a text, of vertices in use; `single` if they were read in single
    /// precision.
    pub(crate) fn of_text(mesh: &Mesh, single: bool) -> Self {
        let different = different_numbers(mesh);
        let numbers = finite_numbers(&different, single);
        let rounded: Vec<Decimal> =
            numbers.iter().filter(|x| x.may_be_rounded).map(|x| x.decimal).collect();
        let read_as = if single { Self::Single } else { Self::Double };
        let found = Self::of_rounded(&rounded, different.values()).unwrap_or(read_as);
        let largest = largest_magnitude(mesh.vertices_in_use());
        let is_shortest = || found != Self::Double && are_shortest_singles(&rounded);
        // A few numbers may not show how they are rounded.
        let [digits, decimals] =
            [typical_maximum(&rounded, |x| x.digits), typical_maximum(&rounded, |x| x.decimals)];
        let others = [Self::Digits(digits as u32), Self::Decimals(decimals.max(0) as u32)];
        let is_other = || {
            found == Self::Double && others.into_iter().any(|format| are_singles(&numbers, format))
        };
        let is_single = || is_shortest() || are_singles(&numbers, found) || is_other();
        if Self::Single.precision(largest) > found.precision(largest) && is_single() {
            Self::Single
        } else {
            found
        }
    }

    /// Returns the format of coordinates that are stored as doubles. It is single precision if nearly all of them are
    /// numbers of single precision, and not by chance.
    pub(crate) fn of_doubles(mesh: &Mesh) -> Self {
        let different = different_numbers(mesh);
        let count = different.keys().filter(|bits| is_single(f64::from_bits(**bits))).count();
        if !is_nearly_all(count, different.len()) {
            return Self::Double;
        }
        let numbers = finite_numbers(&different, false);
        if are_singles(&numbers, Self::Double) { Self::Single } else { Self::Double }
    }

    /// Returns decimals or digits, if numbers that may be rounded show that they are; `None` if they are exact, or
    /// have all digits that they were read with.
    fn of_rounded<'a>(
        rounded: &[Decimal],
        printed: impl Iterator<Item = &'a Printed>,
    ) -> Option<Self> {
        let (digits, decimals) =
            (typical_maximum(rounded, |x| x.digits), typical_maximum(rounded, |x| x.decimals));
        let is_fixed = || match fixed_places(printed) {
            Some(FixedPlaces::Decimals(fixed)) => fixed == decimals,
            Some(FixedPlaces::Digits(fixed)) => fixed == digits,
            None => false,
        };
        if digits > ALL as i32 || digits <= EXACT as i32 && !is_fixed() {
            return None;
        }
        let missing = (digits - 6).clamp(0, 2);
        let count = |is: &dyn Fn(&Decimal) -> bool| rounded.iter().filter(|x| is(x)).count();
        let by_place = count(&|x| x.decimals == decimals);
        let [by_digits, nearly] = [0, missing].map(|less| count(&|x| x.digits >= digits - less));
        let many = |count: usize| count >= MANY && 2 * count > rounded.len();
        if rounded.len() >= MANY && is_grid(rounded) {
            None
        } else if many(by_place) && by_place >= by_digits && decimals > 0 {
            Some(Self::Decimals(decimals as u32))
        } else if many(nearly) {
            Some(Self::Digits(digits as u32))
        } else {
            None
        }
    }

    /// Returns the distance up to which two vertices in the file may denote the same point, for the largest
    /// coordinate in magnitude. For text and single precision these are two units in the last place, because a
    /// distance is at most `sqrt(3)` times the largest difference of a coordinate. For doubles it is larger,
    /// because they may have the errors of a few dozen roundings.
    pub(crate) fn precision(self, largest: f64) -> f64 {
        let of_doubles = largest / (1_u64 << 48) as f64;
        match self {
            Self::Double => of_doubles,
            Self::Single => largest / (1_u64 << 22) as f64,
            Self::Decimals(decimals) => of_doubles.max(2.0 * power_of_ten(-(decimals as i32))),
            Self::Digits(digits) => {
                let first = Decimal::shortest(largest, false, &mut String::new());
                let exponent = first.map_or(0, |first| first.exponent());
                of_doubles.max(2.0 * power_of_ten(exponent - digits as i32 + 1))
            }
        }
    }
}

/// A number of a file.
#[derive(Debug, Clone, Copy)]
struct Number {
    decimal: Decimal,
    may_be_rounded: bool,
}

/// Returns the different coordinates of vertices in use without their signs, as bits, and how each is printed.
fn different_numbers(mesh: &Mesh) -> HashMap<u64, Printed> {
    let used: Vec<usize> = mesh.indices_in_use().collect();
    let step = used.len().div_ceil(MAX_EXAMINED / 3).max(1);
    let examined = used.into_iter().step_by(step).flat_map(|v| {
        let printed = mesh.printed.get(v).copied().unwrap_or_default();
        mesh.vertices[v].to_array().into_iter().zip(printed)
    });
    examined.map(|(x, printed)| (x.abs().to_bits(), printed)).collect()
}

/// Returns the numbers that are finite and not 0.
fn finite_numbers(different: &HashMap<u64, Printed>, single: bool) -> Vec<Number> {
    let mut text = String::new();
    let number = |(bits, printed): (&u64, &Printed)| {
        let decimal = Decimal::shortest(f64::from_bits(*bits), single, &mut text)?;
        Some(Number { decimal, may_be_rounded: decimal.may_be_rounded(*printed) })
    };
    different.iter().filter_map(number).collect()
}

/// Returns the largest count after the largest counts of one number in [`OUTLIERS`] are left out; 0 without numbers.
fn typical_maximum(numbers: &[Decimal], count: fn(&Decimal) -> i32) -> i32 {
    let mut counts: Vec<i32> = numbers.iter().map(count).collect();
    counts.sort_unstable_by_key(|count| std::cmp::Reverse(*count));
    counts.get(counts.len() / OUTLIERS).copied().unwrap_or(0)
}

/// Checks whether nearly all numbers are the shortest texts of numbers in single precision, and too long for fewer
/// digits.
fn are_shortest_singles(rounded: &[Decimal]) -> bool {
    let count = rounded.iter().filter(|x| x.is_single).count();
    typical_maximum(rounded, |x| x.digits) > 7 && is_nearly_all(count, rounded.len())
}

/// Checks whether nearly all numbers are numbers in single precision, printed in a format, and not by chance.
fn are_singles(numbers: &[Number], format: NumberFormat) -> bool {
    let bits = numbers.iter().filter_map(|number| number.single_bits(format));
    let (count, bits) = bits.fold((0, 0.0), |(count, sum), bits| (count + 1, sum + bits));
    bits >= SURE && is_nearly_all(count, numbers.len())
}

/// Checks whether a number is one in single precision.
fn is_single(x: f64) -> bool {
    f64::from(x as f32) == x
}

/// Checks whether all numbers are multiples of a number of more than [`GRID`] units in their last decimal: those of a
/// drawing on a grid, such as 2.54. Rounded numbers have no such divisor.
fn is_grid(numbers: &[Decimal]) -> bool {
    let last = numbers.iter().map(|number| number.decimals).max().unwrap_or(0);
    let units = |number: &Decimal| {
        let power = 10_u64.checked_pow(u32::try_from(last - number.decimals).ok()?)?;
        number.mantissa.checked_mul(power)
    };
    let divisor =
        numbers.iter().try_fold(0, |divisor, number| Some(common_divisor(divisor, units(number)?)));
    divisor.is_some_and(|divisor| divisor > GRID)
}

/// Returns the greatest common divisor.
const fn common_divisor(mut a: u64, mut b: u64) -> u64 {
    while b > 0 {
        (a, b) = (b, a % b);
    }
    a
}

/// Returns `10^exponent`, correctly rounded.
fn power_of_ten(exponent: i32) -> f64 {
    format!("1e{exponent}").parse().unwrap_or(0.0)
}

/// Returns the largest magnitude of the finite coordinates; 0 if there are none.
pub(crate) fn largest_magnitude(vertices: impl Iterator<Item = DVec3>) -> f64 {
    let magnitudes = vertices.flat_map(|v| v.to_array()).map(f64::abs);
    magnitudes.filter(|m| m.is_finite()).fold(0.0, f64::max)
}

/// A number `mantissa / 10^decimals` without trailing zeros.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Decimal {
    mantissa: u64,
    /// Number of significant digits.
    digits: i32,
    /// Number of places after the point; negative for integers that end in zeros.
    decimals: i32,
    /// Whether a number in single precision has the same shortest text.
    is_single: bool,
    value: f64,
}

impl Number {
    /// Returns the evidence, in bits, that this is a number in single precision that was printed in a format; `None`
    /// if it is not such a number. A short number is one, but without evidence.
    fn single_bits(&self, format: NumberFormat) -> Option<f64> {
        let Self { decimal, may_be_rounded } = self;
        let nearest = decimal.value as f32;
        let place = match format {
            NumberFormat::Double | NumberFormat::Single => 0.0,
            NumberFormat::Decimals(decimals) => power_of_ten(-(decimals as i32)),
            NumberFormat::Digits(digits) => power_of_ten(decimal.exponent() - digits as i32 + 1),
        };
        // Ties are off by the rounding of the number as a double.
        let half = 0.5 * place + f64::EPSILON * decimal.value;
        if (decimal.value - f64::from(nearest)).abs() > half {
            return None;
        }
        if *may_be_rounded {
            let spacing = f64::from(nearest.next_up()) - f64::from(nearest);
            return Some((spacing / place).log2().clamp(0.0, MAX_BITS));
        }
        // Quarters, and binary fractions of few digits, are numbers that people write.
        let unused = (nearest.to_bits() | 1 << (f32::MANTISSA_DIGITS - 1)).trailing_zeros();
        Some(if decimal.decimals > 2 && unused < 4 { MAX_BITS } else { 0.0 })
    }
}

impl Decimal {
    /// Returns the shortest decimal of a finite positive number; `None` for other numbers. The buffer `text` is
    /// overwritten.
    fn shortest(x: f64, single: bool, text: &mut String) -> Option<Self> {
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
        Some(Self { mantissa, digits, decimals, is_single: in_single == found, value: x })
    }

    /// Returns the power of ten of the first digit.
    const fn exponent(&self) -> i32 {
        self.digits - self.decimals - 1
    }

    /// Checks whether a writer may have rounded the number. A fraction may be rounded unless it is a binary
    /// fraction. A whole number may be rounded if it was printed with an exponent, because the printed digits may
    /// end before its units.
    fn may_be_rounded(&self, printed: Printed) -> bool {
        if self.decimals > 0 { !self.is_binary_fraction() } else { printed.has_exponent }
    }

    /// Checks whether the number is an integer divided by a power of 2, which binary numbers represent exactly.
    fn is_binary_fraction(&self) -> bool {
        let five = u32::try_from(self.decimals).map_or(Some(1), |places| 5_u64.checked_pow(places));
        five.is_some_and(|power| self.mantissa.is_multiple_of(power))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::text::number;
    use colltrans_testkit::random::Random;

    /// Returns the format of numbers that are printed by `print`.
    fn format_of(
        numbers: impl Iterator<Item = f64>,
        print: impl Fn(f64) -> String,
    ) -> NumberFormat {
        format_of_words(&numbers.map(print).collect::<Vec<_>>())
    }

    fn format_of_words(words: &[String]) -> NumberFormat {
        let mut mesh = Mesh::default();
        for [x, y, z] in words.as_chunks().0 {
            let numbers = [x, y, z].map(|word| number(word).unwrap());
            mesh.vertices.push(numbers.map(|(x, _)| x).into());
            mesh.printed.push(numbers.map(|(_, printed)| printed));
        }
        NumberFormat::of_text(&mesh, false)
    }

    /// Prints a number like `%.{digits}g`.
    fn print_general(x: f64, digits: usize) -> String {
        let scientific = format!("{x:.*e}", digits - 1);
        let (mantissa, exponent) = scientific.split_once('e').unwrap();
        let exponent: i32 = exponent.parse().unwrap();
        if (-4..digits as i32).contains(&exponent) {
            return scientific.parse::<f64>().unwrap().to_string();
        }
        let mantissa = mantissa.trim_end_matches('0').trim_end_matches('.');
        let sign = if exponent < 0 { '-' } else { '+' };
        format!("{mantissa}e{sign}{:02}", exponent.abs())
    }

    /// Prints a number like `%.{digits}e`, with one digit fewer after the point.
    fn print_significant(x: f64, digits: usize) -> String {
        format!("{x:.*e}", digits - 1)
    }

    fn random_numbers(low: f64, high: f64) -> impl Iterator<Item = f64> {
        let mut random = Random::new(7);
        (0..300).map(move |_| random.range(low, high))
    }

    #[test]
    fn printed_formats_are_recognised() {
        for places in 4..=9 {
            let printed = format_of(random_numbers(-300.0, 300.0), |x| format!("{x:.places$}"));
            assert_eq!(printed, NumberFormat::Decimals(places as u32));
        }
        for digits in 5..=15 {
            let printed =
                format_of(random_numbers(-300.0, 300.0), |x| print_significant(x, digits));
            assert_eq!(printed, NumberFormat::Digits(digits as u32));
        }
        let all = format_of(random_numbers(-300.0, 300.0), |x| x.to_string());
        assert_eq!(all, NumberFormat::Double);
        let single = format_of(random_numbers(-300.0, 300.0), |x| (x as f32).to_string());
        assert_eq!(single, NumberFormat::Single);
    }

    /// Numbers in single precision as programs print them: with nine digits, eight decimals, or as doubles.
    #[test]
    fn numbers_in_single_precision_are_recognised_in_longer_text() {
        let prints: [fn(f64) -> String; 4] = [
            |x| print_general(f64::from(x as f32), 9),
            |x| print_significant(f64::from(x as f32), 9),
            |x| print_significant(f64::from(x as f32), 12),
            |x| f64::from(x as f32).to_string(),
        ];
        for (k, print) in prints.into_iter().enumerate() {
            for size in [1e-3, 1.0, 25.4, 300.0, 5e3, 3e4, 2e5] {
                let found = format_of(random_numbers(-size, size), print);
                assert_eq!(found, NumberFormat::Single, "print {k} of {size}");
                // A box has few coordinates.
                let few = format_of(random_numbers(-size, size).take(12), print);
                assert_eq!(few, NumberFormat::Single, "print {k} of few of {size}");
            }
        }
        for size in [3.0, 25.4, 5e3, 2e5] {
            let eight = |x: f64| format!("{:.8}", f64::from(x as f32));
            assert_eq!(
                format_of(random_numbers(-size, size), eight),
                NumberFormat::Single,
                "{size}"
            );
        }
        // Eight decimals of small numbers are coarser than single precision.
        let small =
            format_of(random_numbers(-0.01, 0.01), |x| format!("{:.8}", f64::from(x as f32)));
        assert_eq!(small, NumberFormat::Decimals(8));
    }

    #[test]
    fn doubles_and_drawings_are_not_in_single_precision() {
        for size in [1e-3, 1.0, 25.4, 300.0, 5e3, 2e5, 1e9] {
            for digits in [8, 9, 10, 15] {
                let found =
                    format_of(random_numbers(-size, size), |x| print_significant(x, digits));
                assert_eq!(found, NumberFormat::Digits(digits as u32), "{size}");
            }
            let found = format_of(random_numbers(-size, size), |x| x.to_string());
            assert_eq!(found, NumberFormat::Double, "{size}");
        }
        // Coordinates of the UTM grid: integers, halves and quarters use all bits of single precision.
        let utm = random_numbers(0.0, 64.0).map(|x| 4_649_776.0 + x.round() / 4.0);
        assert_eq!(format_of(utm, |x| x.to_string()), NumberFormat::Double);
        // Multiples of 1/16 with long integer parts.
        let inches = random_numbers(0.0, 1e3).map(|x| (16.0 * x).round() / 16.0);
        assert_eq!(format_of(inches, |x| x.to_string()), NumberFormat::Double);
    }

    #[test]
    fn doubles_that_were_in_single_precision_are_recognised() {
        let mesh = |round: fn(f64) -> f64| {
            let numbers: Vec<f64> = random_numbers(-20.0, 20.0).map(round).collect();
            let vertices = numbers.as_chunks().0.iter().map(|v| DVec3::from_array(*v)).collect();
            NumberFormat::of_doubles(&Mesh::new(vertices, Vec::new()))
        };
        assert_eq!(mesh(|x| f64::from(x as f32)), NumberFormat::Single);
        assert_eq!(mesh(|x| x), NumberFormat::Double);
        assert_eq!(mesh(|x| (8.0 * x).round() / 8.0), NumberFormat::Double);
        assert_eq!(mesh(|x| (100.0 * x).round() / 100.0), NumberFormat::Double);
    }

    #[test]
    fn integers_with_exponents_are_rounded() {
        for (low, high) in [(5e5, 2e7), (4.2e6, 4.3e6), (1e50, 9e50)] {
            for digits in 5..=6 {
                let printed = format_of(random_numbers(low, high), |x| print_general(x, digits));
                assert_eq!(printed, NumberFormat::Digits(digits as u32), "{low} to {high}");
            }
        }
        let printed = format_of(random_numbers(-5e6, 5e6), |x| print_significant(x, 7));
        assert_eq!(printed, NumberFormat::Digits(7));
        assert_eq!(NumberFormat::Digits(7).precision(5e6), 2.0);
        assert_eq!(NumberFormat::Digits(6).precision(1.54245e7), 200.0);
        // Integers without an exponent, and drawings with one.
        let whole = format_of(random_numbers(-5e6, 5e6), |x| format!("{x:.0}"));
        assert_eq!(whole, NumberFormat::Double);
        let drawing = [12.5, 1000.0, 7.25, 104.775, 0.5, 25.4, 3.175, 12.7, 0.0];
        assert_eq!(
            format_of(drawing.into_iter(), |x| print_significant(x, 7)),
            NumberFormat::Double
        );
    }

    #[test]
    fn few_digits_padded_with_zeros_are_rounded() {
        for (places, size) in [(2, 9.0), (2, 90.0), (3, 1.0), (3, 9.0), (4, 0.9)] {
            let printed = format_of(random_numbers(-size, size), |x| format!("{x:.places$}"));
            assert_eq!(printed, NumberFormat::Decimals(places as u32), "{places}");
            // The same numbers without these zeros, as in drawings.
            let short = |x: f64| format!("{x:.places$}").parse::<f64>().unwrap().to_string();
            assert_eq!(
                format_of(random_numbers(-size, size), short),
                NumberFormat::Double,
                "{places}"
            );
        }
        let printed = format_of(random_numbers(-5.0, 5.0), |x| print_significant(x, 4));
        assert_eq!(printed, NumberFormat::Digits(4));
        // A drawing padded to more places than it has, and numbers like `1.0`.
        let drawing = [0.5, 1.2, 3.4, 0.1, 2.6, 7.7, 0.0, 1.0, 9.3];
        let padded = |places: usize| format_of(drawing.into_iter(), |x| format!("{x:.places$}"));
        assert_eq!([1, 2, 3, 6].map(padded), [NumberFormat::Double; 4]);
    }

    #[test]
    fn single_outlier_does_not_change_the_format() {
        let exact = 0.123_456_789_012_345_67;
        for digits in [7, 9, 12, 17] {
            let mut words: Vec<String> =
                random_numbers(-9.0, 9.0).map(|x| print_general(x, 6)).collect();
            words[0] = print_general(exact, digits);
            assert_eq!(format_of_words(&words), NumberFormat::Digits(6), "{digits}");
            let mut words: Vec<String> =
                random_numbers(-9.0, 9.0).map(|x| format!("{x:.3}")).collect();
            words[0] = print_general(exact, digits);
            assert_eq!(format_of_words(&words), NumberFormat::Decimals(3), "{digits}");
            let mut words: Vec<String> =
                random_numbers(-9.0, 9.0).map(|x| (x as f32).to_string()).collect();
            words[0] = print_general(exact, digits);
            assert_eq!(format_of_words(&words), NumberFormat::Single, "{digits}");
        }
    }

    #[test]
    fn short_numbers_are_exact() {
        // Drawings, inches, and binary fractions with any number of digits.
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
    fn multiples_of_a_step_are_exact() {
        for step in ["2.54", "1.5875", "0.0254", "0.396875"] {
            let step: f64 = step.parse().unwrap();
            let numbers = random_numbers(1.0, 60.0).map(|k| k.round() * step);
            let found = format_of(numbers, |x| format!("{x:.6}").trim_end_matches('0').to_owned());
            assert_eq!(found, NumberFormat::Double, "{step}");
        }
    }

    #[test]
    fn exact_numbers_do_not_change_the_format() {
        let mixed = random_numbers(-3.0, 3.0).chain([0.0, 0.5, 10.0, 1.25, 12.5, 200.0]);
        let printed = format_of(mixed, |x| format!("{x:.6}"));
        assert_eq!(printed, NumberFormat::Decimals(6));
        assert_eq!(printed.precision(200.0), 2e-6);
        assert_eq!(NumberFormat::Digits(6).precision(200.0), 2e-3);
        assert_eq!(NumberFormat::Digits(6).precision(0.05), 2e-7);
    }
}
