//! Numbers for people.

/// Up to four significant digits, for people.
pub(crate) fn short(x: f64) -> String {
    digits(x, 4)
}

/// Up to so many significant digits; all before the point.
pub(crate) fn digits(x: f64, count: i32) -> String {
    if x == 0.0 || !x.is_finite() {
        return if x == 0.0 { "0".into() } else { "∞".into() };
    }
    let magnitude = x.abs().log10().floor() as i32;
    if !(-4..7).contains(&magnitude) {
        return format!("{x:.2e}");
    }
    let text = format!("{x:.*}", (count - 1 - magnitude).max(0) as usize);
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').into() } else { text }
}
