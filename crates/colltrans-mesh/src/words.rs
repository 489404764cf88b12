//! Formats numbers with their significant digits and without `-0`, and lists of names.

/// Formats a number with all digits, with an exponent if there were many zeros.
pub fn number(value: f64) -> String {
    if value == 0.0 {
        "0".into()
    } else if (1e-4..1e15).contains(&value.abs()) {
        value.to_string()
    } else {
        format!("{value:e}")
    }
}

/// Formats a number with a known error. It is rounded at the decimal place of the error's first digit, so that
/// the rounding error is at most the error. Trailing zeros are omitted.
pub fn rounded_to_error(value: f64, error: f64) -> String {
    if !value.is_finite() || !error.is_normal() || value == 0.0 {
        return number(value);
    }
    let place = decade(error);
    let leading = decade(value);
    if place > leading {
        // No digit is significant.
        return if value.abs() <= error.abs() { "0".into() } else { format!("{value:.0e}") };
    }
    // Number of digits after the first one. An `f64` has at most 17 digits.
    let digits = (leading - place).clamp(0, 16) as usize;
    let rounded: f64 = format!("{value:.digits$e}").parse().unwrap_or(value);
    number(rounded)
}

/// Lists at most `most` names, followed by the number of the others.
pub fn first_named<T: AsRef<str>>(names: &[T], most: usize) -> String {
    let first: Vec<&str> = names.iter().take(most).map(AsRef::as_ref).collect();
    match names.len().saturating_sub(most) {
        0 => first.join(", "),
        more => format!("{} and {more} more", first.join(", ")),
    }
}

/// Formats a measured value with six digits.
pub fn six_digits(value: f64) -> String {
    rounded_to_error(value, value.abs() * 1e-5)
}

/// Formats an error or a tolerance with one digit and an exponent, rounded up in magnitude.
pub fn error_bound(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return number(value);
    }
    format!("{:e}", round_up(value.abs(), 1).copysign(value))
}

/// Returns the least number of at most this many significant decimal digits that is not less than the value. It is
/// infinite beyond the largest number. Infinities and NaN are returned unchanged.
pub fn round_up(value: f64, digits: usize) -> f64 {
    if value < 0.0 { -round_down(-value, digits) } else { decimals_around(value, digits)[1] }
}

/// Returns the largest number of at most this many significant decimal digits that does not exceed the value.
/// Infinities and NaN are returned unchanged.
pub fn round_down(value: f64, digits: usize) -> f64 {
    if value < 0.0 { -round_up(-value, digits) } else { decimals_around(value, digits)[0] }
}

/// Returns the neighbours of a number that is not negative among the numbers with this many significant decimal digits.
/// Both are the number itself if it has no more digits. Each decimal number is compared as the nearest `f64`.
fn decimals_around(value: f64, digits: usize) -> [f64; 2] {
    if value == 0.0 || !value.is_finite() {
        return [value; 2];
    }
    let digits = digits.clamp(1, 17);
    let nearest = format!("{value:.*e}", digits - 1);
    let (mantissa, power) = nearest.split_once('e').unwrap_or((&nearest, "0"));
    let units: u64 = mantissa.replace('.', "").parse().unwrap_or(0);
    let place = power.parse::<i32>().unwrap_or(0) - (digits as i32 - 1);
    let decimal =
        |units: u64, place: i32| -> f64 { format!("{units}e{place}").parse().unwrap_or(f64::NAN) };
    let shown = decimal(units, place);
    if shown == value {
        [shown; 2]
    } else if shown < value {
        [shown, decimal(units + 1, place)]
    } else if units == 10_u64.pow(digits as u32 - 1) {
        // The next smaller number has a smaller exponent, therefore its last digit has another place.
        [decimal(10 * units - 1, place - 1), shown]
    } else {
        [decimal(units - 1, place), shown]
    }
}

/// Returns the decimal exponent of a finite number other than 0. It is exact, unlike the logarithms of the
/// platform.
pub fn decade(value: f64) -> i32 {
    let written = format!("{value:e}");
    written.split_once('e').and_then(|(_, power)| power.parse().ok()).unwrap_or(0)
}

/// Formats a count with the singular or plural of a noun.
pub fn count_text(count: usize, one: &str, many: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { many })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn first_names_are_listed_with_count_of_the_rest() {
        let listed = |names: &[&str]| first_named(names, 2);
        assert_eq!(listed(&[]), "");
        assert_eq!(listed(&["a", "b"]), "a, b");
        assert_eq!(listed(&["a", "b", "c", "d"]), "a, b and 2 more");
    }

    #[test]
    fn errors_are_rounded_up() {
        for (value, shown) in [
            (1.117e-12, "2e-12"),
            (3.87e-13, "4e-13"),
            (9.2, "1e1"),
            (1e-6, "1e-6"),
            (-1.2, "-2e0"),
        ] {
            assert_eq!(error_bound(value), shown);
        }
    }

    #[test]
    fn directed_rounding_encloses_the_value() {
        for (value, digits, down, up) in [
            (7.0, 3, 7.0, 7.0),
            (1.0 / 3.0, 3, 0.333, 0.334),
            (-1.0 / 3.0, 3, -0.334, -0.333),
            (9.996, 3, 9.99, 10.0),
            (0.099_96, 3, 0.0999, 0.1),
            (12.000_000_000_001_384, 9, 12.0, 12.000_000_1),
            (6.999_999_999_999_279, 9, 6.999_999_99, 7.0),
            (5e-324, 1, 5e-324, 5e-324),
            (f64::MAX, 3, 1.79e308, f64::INFINITY),
            (f64::INFINITY, 3, f64::INFINITY, f64::INFINITY),
        ] {
            assert_eq!([round_down(value, digits), round_up(value, digits)], [down, up], "{value}");
        }
        assert!(round_up(f64::NAN, 3).is_nan());
    }

    #[test]
    fn decades_are_exact() {
        for (value, power) in
            [(1.0, 0), (-10.0, 1), (999.999, 2), (1e-3, -3), (0.001_f64.next_down(), -4)]
        {
            assert_eq!(decade(value), power, "{value}");
        }
    }

    #[test]
    fn numbers_are_rounded_at_their_error() {
        assert_eq!(rounded_to_error(1.0 / 3.0, 7e-15), "0.333333333333333");
        assert_eq!(rounded_to_error(2.000_000_000_000_000_4, 7e-15), "2");
        assert_eq!(rounded_to_error(-1_234.567_891, 0.02), "-1234.57");
        assert_eq!(rounded_to_error(-1e-16, 7e-15), "0");
        assert_eq!(rounded_to_error(123_456.789, 1e3), "123000");
        assert_eq!(rounded_to_error(1.0 / 3.0, 0.0), (1.0_f64 / 3.0).to_string());
        assert_eq!(rounded_to_error(9.999_999_999_999_999, 1e-14), "10");
        assert_eq!(rounded_to_error(1e-20, 1e-30), "1e-20");
        assert_eq!(rounded_to_error(f64::INFINITY, 1.0), "inf");
        // The rounding error is at most the error.
        let mut value = 0.1_f64;
        while value < 1e6 {
            for error in [1e-3, 3e-9, 9.9e-12] {
                let shown: f64 = rounded_to_error(value, error).parse().unwrap();
                assert!((shown - value).abs() <= error, "{value} {error}");
            }
            value *= 1.37;
        }
    }

    #[test]
    fn extreme_magnitudes_use_an_exponent() {
        assert_eq!([1e-5, 2e16, 1e-4].map(number), ["1e-5", "2e16", "0.0001"]);
    }

    #[test]
    fn signed_zeros_print_as_zero() {
        assert_eq!([0.0, -0.0].map(number), ["0", "0"]);
        assert_eq!([0.0, -0.0].map(error_bound), ["0", "0"]);
    }
}
