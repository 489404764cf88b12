//! The range of numbers that are admitted.

use glam::DVec3;

/// Largest magnitude of a coordinate, a translation or a direction component: `2^200`.
///
/// Together with [`MIN_MAGNITUDE`] it keeps every product of three coordinates, and
/// every rounding error of such a product, inside the range of an `f64`, so that the orientation
/// predicates are exact.
pub const MAX_MAGNITUDE: f64 = f64::from_bits((1023 + 200) << 52);

/// Smallest magnitude of a coordinate that is not zero: `2^-200`. See [`MAX_MAGNITUDE`].
pub const MIN_MAGNITUDE: f64 = f64::from_bits((1023 - 200) << 52);

/// The same without coordinates that are too small for the exact range, which are zero.
#[inline]
pub fn without_traces(v: DVec3) -> DVec3 {
    DVec3::from_array(v.to_array().map(|c| if c.abs() < MIN_MAGNITUDE { 0.0 } else { c }))
}

/// Whether a coordinate is finite and inside the exact range.
#[inline]
pub fn in_exact_range(v: DVec3) -> bool {
    v.to_array().into_iter().all(|c| c == 0.0 || (MIN_MAGNITUDE..=MAX_MAGNITUDE).contains(&c.abs()))
}
