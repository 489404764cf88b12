//! Rounded numbers for text output.

/// Formats a number with up to four significant digits.
pub(crate) fn short_number(x: f64) -> String {
    rounded_number(x, 4)
}

/// Formats a number with up to `count` significant digits.
///
/// - Digits before the decimal point are always written in full.
/// - Magnitudes below `1e-4` or from `1e7` on are written in scientific notation with three digits.
/// - Values that are not finite are written as `∞`.
pub(crate) fn rounded_number(x: f64, count: i32) -> String {
    if x == 0.0 || !x.is_finite() {
        return if x == 0.0 { "0".into() } else { "∞".into() };
    }
    let magnitude = x.abs().log10().floor() as i32;
    if !(-4..7).contains(&magnitude) {
        return format!("{x:.2e}");
    }
    let text = format!("{x:.*}", (count - 1 - magnitude).max(0) as usize);
    without_trailing_zeros(text)
}

/// Returns a decimal number without zeros at the end of its decimals.
pub(crate) fn without_trailing_zeros(text: String) -> String {
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').into() } else { text }
}
