//! Overlap of the shadows of bodies that slide along each other.

use glam::DVec3;

use super::Cast;
use crate::answer::{CertificateError, check_lateral_normal, shadow_gap};

/// Returns an upper bound of the overlap of two bodies' shadows along a normal, in world units. The minimum
/// gap and the radii of rounded bodies are added.
#[inline]
pub fn proven_overlap(normal: DVec3, cast: &Cast<'_>) -> f64 {
    let gap = shadow_gap(&cast.setting, normal);
    let [_, min_gap] = cast.setting.core_gap_bounds(cast.options().min_gap);
    // The negation of a gap is exact.
    if min_gap > 0.0 { (min_gap - gap).next_up() } else { 0.0 - gap }
}

/// Returns [`proven_overlap`] after a check of the normal, which must be a unit vector orthogonal to the
/// direction.
///
/// # Errors
/// Returns [`CertificateError::Normal`] if it is not.
#[inline]
pub fn verified_overlap(normal: DVec3, cast: &Cast<'_>) -> Result<f64, CertificateError> {
    check_lateral_normal(&cast.setting, normal)?;
    Ok(proven_overlap(normal, cast))
}
