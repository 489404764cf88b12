//! How far bodies that slide along each other overlap, seen along the direction.

use glam::DVec3;

use super::Cast;
use crate::answer::CertificateError;
use crate::number::noise;

/// At least how far two bodies overlap along a normal, with the gap that they are to keep. One that is not quite orthogonal to the direction
/// lets them overlap more, as far away as the bodies reach.
pub(crate) fn proven_overlap(normal: DVec3, cast: &Cast<'_>) -> f64 {
    let setting = &cast.setting;
    let gap = setting.distance_along(normal);
    let keep = cast.options().keep;
    let overlap = (normal.dot(setting.unit).abs() * (setting.scale() + keep) - gap).next_up();
    if keep > 0.0 { (overlap + keep).next_up() } else { overlap }
}

/// The same along a normal that is claimed to be a unit vector, orthogonal to the direction.
pub(crate) fn verified_overlap(normal: DVec3, cast: &Cast<'_>) -> Result<f64, CertificateError> {
    let is_unit = (normal.length() - 1.0).abs() <= noise::UNIT_VECTOR;
    if !is_unit || normal.dot(cast.setting.unit).abs() > noise::UNIT_VECTOR {
        return Err(CertificateError::Normal { normal });
    }
    Ok(proven_overlap(normal, cast))
}
