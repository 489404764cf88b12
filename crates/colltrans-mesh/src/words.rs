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

/// Formats an error or a tolerance with one digit, rounded up in magnitude.
pub fn rounded_up(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return number(value);
    }
    let nearest = format!("{value:.0e}");
    let shown: f64 = nearest.parse().unwrap_or(value);
    if shown.abs() >= value.abs() {
        return nearest;
    }
    // The value was rounded down. Adding half a unit of the digit makes the rounding go up.
    let half: f64 = format!("5e{}", decade(value) - 1).parse().unwrap_or(0.0);
    format!("{:.0e}", value + half.copysign(value))
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
            assert_eq!(rounded_up(value), shown);
        }
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
        assert_eq!([0.0, -0.0].map(rounded_up), ["0", "0"]);
    }
}
