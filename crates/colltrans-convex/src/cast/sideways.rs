//! How far bodies that slide along each other overlap, seen along the direction.

use glam::DVec3;

use super::Cast;
use crate::answer::{CertificateError, check_lateral_normal, shadow_gap};

/// Returns at least how far the shadows of two bodies overlap along a normal, with the gap that they are to keep.
#[inline]
pub fn proven_overlap(normal: DVec3, cast: &Cast<'_>) -> f64 {
    let gap = shadow_gap(&cast.setting, normal);
    let keep = cast.options().keep;
    // Without a gap nothing is rounded.
    if keep > 0.0 { (keep - gap).next_up() } else { 0.0 - gap }
}

/// Returns [`proven_overlap`] along a normal that is claimed to be a unit vector, orthogonal to the direction.
///
/// # Errors
/// The normal is not.
#[inline]
pub fn verified_overlap(normal: DVec3, cast: &Cast<'_>) -> Result<f64, CertificateError> {
    check_lateral_normal(&cast.setting, normal)?;
    Ok(proven_overlap(normal, cast))
}
