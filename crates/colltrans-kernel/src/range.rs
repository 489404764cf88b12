//! The range of accepted numbers.

use glam::DVec3;

/// Maximum magnitude of a coordinate, a translation or a direction component: `2^200`.
///
/// With [`MIN_MAGNITUDE`], every product of three coordinates, and every rounding error of such a product, is
/// in the range of an `f64`. Therefore the orientation predicates are exact.
pub const MAX_MAGNITUDE: f64 = f64::from_bits((1023 + 200) << 52);

/// Minimum magnitude of a nonzero coordinate: `2^-200`. See [`MAX_MAGNITUDE`].
pub const MIN_MAGNITUDE: f64 = f64::from_bits((1023 - 200) << 52);

/// Returns the vector with components below the exact range replaced by zero.
#[inline]
pub fn with_tiny_components_zeroed(v: DVec3) -> DVec3 {
    DVec3::from_array(v.to_array().map(|c| if c.abs() < MIN_MAGNITUDE { 0.0 } else { c }))
}

/// Checks whether all components are finite and zero or in the exact range.
#[inline]
pub fn is_in_exact_range(v: DVec3) -> bool {
    v.to_array().into_iter().all(|c| c == 0.0 || (MIN_MAGNITUDE..=MAX_MAGNITUDE).contains(&c.abs()))
}
