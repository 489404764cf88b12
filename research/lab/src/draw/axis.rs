//! The visible range of an axis, and the labels of its ticks.

use crate::finding::Axis;

/// Smallest value on a logarithmic axis. The plotting crate's logarithms end at `1e-10`.
const LEAST_ON_LOG_AXIS: f64 = 1e-9;
/// Largest absolute value on an axis. Beyond `2^53` neighbouring ticks would be equal numbers.
const MOST: f64 = 1e15;

/// Margin at each end, as a share of the range of the data.
const ROOM: f64 = 0.04;

/// Checks whether an axis can show a value.
pub(super) fn has_place(axis: &Axis, value: f64) -> bool {
    value.abs() <= MOST && (!axis.log || value >= LEAST_ON_LOG_AXIS)
}

/// Returns a range of the axis that contains all values with a margin; `None` without values.
pub(super) fn visible_range(axis: &Axis, values: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    let (low, high) = values.fold(None, |ends: Option<(f64, f64)>, v| {
        Some(ends.map_or((v, v), |(low, high)| (low.min(v), high.max(v))))
    })?;
    Some(if axis.log { log_range(low, high) } else { linear_range(low, high) })
}

/// Returns a range for a logarithmic axis, whose margin is a factor. Ticks are at 1, 2 and 5 times powers of
/// ten, and at least two of them are visible.
fn log_range(low: f64, high: f64) -> (f64, f64) {
    let factor = (high / low).powf(ROOM).max(1.05);
    let (low, high) = (low / factor, high * factor);
    if high / low >= 6.0 {
        return (low, high);
    }
    let below = |value: f64| {
        let decade = 10_f64.powf(value.log10().floor());
        [5.0, 2.0].map(|m| m * decade).into_iter().find(|&t| t <= value).unwrap_or(decade)
    };
    let above = |value: f64| {
        let decade = 10_f64.powf(value.log10().floor());
        [1.0, 2.0, 5.0]
            .map(|m| m * decade)
            .into_iter()
            .find(|&t| t >= value)
            .unwrap_or(10.0 * decade)
    };
    (below(low), above(high))
}

/// Returns a range for a linear axis. It includes zero unless the data span a small part of their distance
/// from zero.
fn linear_range(low: f64, high: f64) -> (f64, f64) {
    let span = high - low;
    if span == 0.0 {
        let around = if low == 0.0 { 1.0 } else { 0.5 * low.abs() };
        return (low - around, high + around);
    }
    let room = ROOM * span;
    let from = if low > room && low <= 2.0 * span { 0.0 } else { low - room };
    let to = if high < -room && high >= -2.0 * span { 0.0 } else { high + room };
    (from, to)
}

/// Formats a tick label: `0.05`, `20`, `2,000`, `5×10⁶`.
pub(super) fn tick_label(value: f64) -> String {
    let size = value.abs();
    if size == 0.0 {
        return "0".into();
    }
    if !(1e-4..1e6).contains(&size) {
        return scientific_label(value);
    }
    // Ticks are short decimal numbers up to rounding, which 12 digits hide.
    let digits = (12 - size.log10().floor() as i32).clamp(0, 16) as usize;
    let text = format!("{value:.digits$}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    let (whole, fraction) = text.split_once('.').unwrap_or((text, ""));
    let mut label = group_thousands(whole);
    if !fraction.is_empty() {
        label.push('.');
        label.push_str(fraction);
    }
    label
}

/// Inserts separators between thousands.
fn group_thousands(whole: &str) -> String {
    let (sign, digits) = whole.strip_prefix('-').map_or(("", whole), |digits| ("\u{2212}", digits));
    let mut grouped = String::from(sign);
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            grouped.push(',');
        }
        grouped.push(digit);
    }
    grouped
}

/// Formats a number with a power of ten.
fn scientific_label(value: f64) -> String {
    const SUPERSCRIPTS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let text = format!("{value:.6e}");
    let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    let mantissa = mantissa.trim_end_matches('0').trim_end_matches('.');
    let power: String = exponent
        .chars()
        .map(|c| c.to_digit(10).map_or('⁻', |digit| SUPERSCRIPTS[digit as usize]))
        .collect();
    if mantissa == "1" { format!("10{power}") } else { format!("{mantissa}×10{power}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tick_labels_are_short() {
        for (value, expected) in [
            (0.0, "0"),
            (0.05, "0.05"),
            (0.1 + 0.2, "0.3"),
            (20.0, "20"),
            (2000.0, "2,000"),
            (-2000.0, "\u{2212}2,000"),
            (200_000.0, "200,000"),
            (5e6, "5×10⁶"),
            (1e-5, "10⁻⁵"),
            (1234.5, "1,234.5"),
        ] {
            assert_eq!(tick_label(value), expected);
        }
    }

    /// Every range contains all data and at least two ticks.
    #[test]
    fn log_ranges_contain_data_and_two_ticks() {
        for low in [1e-6, 0.3, 1.0, 1.9, 2.0, 70.0, 99.0, 1e6] {
            for ratio in [1.0, 1.01, 1.5, 2.0, 4.9, 5.1, 30.0, 1e6] {
                let (from, to) = log_range(low, low * ratio);
                assert!(from < low && to > low * ratio, "{low} {ratio}");
                let ticks = (-9..15)
                    .flat_map(|e| [1.0, 2.0, 5.0].map(|m| m * 10_f64.powi(e)))
                    .filter(|t| from * (1.0 - 1e-9) <= *t && *t <= to * (1.0 + 1e-9));
                assert!(ticks.count() >= 2, "{low} {ratio}: {from} {to}");
            }
        }
    }

    #[test]
    fn linear_ranges_contain_the_data_and_mostly_zero() {
        assert_eq!(linear_range(1.0, 9.0).0, 0.0);
        assert!(linear_range(100.0, 101.0).0 > 99.0);
        for (low, high) in [(0.0, 0.0), (3.0, 3.0), (-3.0, -3.0), (-2.0, 5.0), (1e-7, 2e-7)] {
            let (from, to) = linear_range(low, high);
            assert!(from <= low && to > high && from < to);
        }
    }
}
