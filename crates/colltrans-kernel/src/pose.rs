//! Poses: a rotation followed by a translation, `x_world = R x_body + t`.
//!
//! Invariants:
//!
//! - The nine entries of `R` *define* where a body is. Solvers, certificates and the exact verification read
//!   the same nine numbers, so that no rounding occurs between them.
//! - The entries are given, or computed once from a quaternion.
//! - The entries of `R^T R` may differ from those of the identity by [`TOLERANCE`]. Such a matrix stretches the
//!   body by a factor of at most [`MAX_STRETCH`], which the margins of [`noise`](crate::noise) cover.

use glam::{DMat3, DQuat, DVec3};

use crate::error::PoseError;
use crate::range::{MIN_MAGNITUDE, is_in_exact_range};

/// Maximum difference of the length of a quaternion from 1, and of an entry of `R^T R` from that of the
/// identity. Single precision is accepted.
const TOLERANCE: f64 = 1e-6;

/// Maximum factor by which a pose stretches a length, because the entries of `R^T R` may differ from those of the
/// identity by [`TOLERANCE`].
pub const MAX_STRETCH: f64 = 1.0 + 4.0 * TOLERANCE;

/// Maximum difference of the length of a quaternion, or of an entry of `R^T R`, that [`Pose::from_rounded`]
/// and [`Pose::from_rounded_matrix`] accept. Two written digits are sufficient.
const ROUNDED_TOLERANCE: f64 = 0.02;

/// Maximum number of Newton steps towards the nearest rotation. Each step squares the defect, so that four
/// steps reduce two percent to rounding error.
const MAX_POLAR_STEPS: usize = 8;

/// A rigid placement of a body in the world: `x_world = R x_body + t`.
///
/// ```
/// use colltrans::Pose;
/// use colltrans::glam::{DQuat, DVec3};
///
/// // A quarter turn about z, then two units up.
/// let turn = DQuat::from_rotation_z(std::f64::consts::FRAC_PI_2);
/// let pose = Pose::new(turn, DVec3::new(0.0, 0.0, 2.0))?;
/// let moved = pose.transform_point(DVec3::X);
/// assert!(moved.distance(DVec3::new(0.0, 1.0, 2.0)) < 1e-15);
/// assert!(pose.inverse()?.transform_point(moved).distance(DVec3::X) < 1e-15);
///
/// // A quaternion whose length is not 1 is rejected.
/// assert!(Pose::new(DQuat::from_xyzw(0.0, 0.0, 1.0, 1.0), DVec3::ZERO).is_err());
/// # Ok::<(), colltrans::PoseError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(into = "PoseRecord", try_from = "PoseRecord")
)]
pub struct Pose {
    matrix: DMat3,
    translation: DVec3,
}

impl Pose {
    /// The identity: the body frame is the world frame.
    pub const IDENTITY: Self = Self { matrix: DMat3::IDENTITY, translation: DVec3::ZERO };

    /// Builds a pose from a quaternion of length 1 within 1e-6, which is normalised, and a translation in
    /// world units.
    ///
    /// # Errors
    /// [`PoseError::NotARotation`] if the length of the quaternion is not a number or differs from 1 by more than
    /// 1e-6. [`PoseError::Translation`] if the translation is not finite or out of range.
    #[inline]
    pub fn new(rotation: DQuat, translation: DVec3) -> Result<Self, PoseError> {
        let length = rotation.length();
        if length.is_nan() || (length - 1.0).abs() > TOLERANCE {
            let [x, y, z, w] = rotation.to_array();
            return Err(PoseError::NotARotation { x, y, z, w, length });
        }
        check_translation(translation)?;
        let rotation = if length == 1.0 { rotation } else { rotation * (1.0 / length) };
        Ok(Self { matrix: flush_tiny(matrix_from_quaternion(rotation)), translation })
    }

    /// Builds a pose from the nine entries of a rotation matrix and a translation in world units.
    ///
    /// The entries are stored unchanged, except that magnitudes below `2^-200` become 0.
    ///
    /// # Errors
    /// [`PoseError::NotARotationMatrix`] with the defect, if an entry is not finite, an entry of `R^T R` differs
    /// from that of the identity by more than 1e-6, or the determinant is negative. [`PoseError::Translation`] if
    /// the translation is not finite or out of range.
    ///
    /// ```
    /// use colltrans::Pose;
    /// use colltrans::glam::{DMat3, DVec3};
    ///
    /// // Maps x to y, y to z, z to x. The pose stores these nine entries.
    /// let turn = DMat3::from_cols(DVec3::Y, DVec3::Z, DVec3::X);
    /// assert_eq!(Pose::from_matrix(turn, DVec3::ZERO)?.matrix(), turn);
    /// // A reflection is rejected.
    /// assert!(Pose::from_matrix(-turn, DVec3::ZERO).is_err());
    /// # Ok::<(), colltrans::PoseError>(())
    /// ```
    #[inline]
    pub fn from_matrix(matrix: DMat3, translation: DVec3) -> Result<Self, PoseError> {
        let defect = largest_defect(matrix);
        if defect > TOLERANCE {
            let columns = matrix.to_cols_array_2d();
            return Err(PoseError::NotARotationMatrix { columns, defect, tolerance: TOLERANCE });
        }
        check_translation(translation)?;
        Ok(Self { matrix: flush_tiny(matrix), translation })
    }

    /// Builds a pose from a quaternion that was written with few digits. A quaternion whose length differs
    /// from 1 by more than 1e-6 and at most 0.02 is normalised. In that case, returns its defect
    /// `|length - 1|`, otherwise `None`.
    ///
    /// # Errors
    /// [`PoseError::NotARotation`] if the length is not a number or differs from 1 by more than 0.02.
    /// [`PoseError::Translation`] if the translation is not finite or out of range.
    ///
    /// ```
    /// use colltrans::Pose;
    /// use colltrans::glam::{DQuat, DVec3};
    ///
    /// let quarter = DQuat::from_xyzw(0.0, 0.0, 0.707, 0.707);
    /// assert!(Pose::new(quarter, DVec3::ZERO).is_err());
    /// let (pose, defect) = Pose::from_rounded(quarter, DVec3::ZERO)?;
    /// assert!(defect.is_some_and(|defect| (1e-4..2e-4).contains(&defect)));
    /// assert!(pose.transform_point(DVec3::X).distance(DVec3::Y) < 1e-15);
    /// # Ok::<(), colltrans::PoseError>(())
    /// ```
    #[inline]
    pub fn from_rounded(
        rotation: DQuat,
        translation: DVec3,
    ) -> Result<(Self, Option<f64>), PoseError> {
        let defect = (rotation.length() - 1.0).abs();
        let is_rounded = defect > TOLERANCE && defect <= ROUNDED_TOLERANCE;
        let rotation = if is_rounded { rotation.normalize() } else { rotation };
        Ok((Self::new(rotation, translation)?, is_rounded.then_some(defect)))
    }

    /// Builds a pose from a matrix that was written with few digits. A matrix that differs from a rotation by
    /// more than 1e-6 and at most 0.02 is replaced by the nearest rotation, its polar factor. In that case,
    /// returns its defect, otherwise `None`.
    ///
    /// # Errors
    /// [`PoseError::NotARotationMatrix`] if the matrix is not finite, is a reflection, or differs from a rotation by
    /// more than 0.02. [`PoseError::Translation`] if the translation is not finite or out of range.
    #[inline]
    pub fn from_rounded_matrix(
        matrix: DMat3,
        translation: DVec3,
    ) -> Result<(Self, Option<f64>), PoseError> {
        let defect = largest_defect(matrix);
        let is_rounded = defect > TOLERANCE && defect <= ROUNDED_TOLERANCE;
        let matrix = if is_rounded { nearest_rotation(matrix) } else { matrix };
        let pose = Self::from_matrix(matrix, translation).map_err(|error| match error {
            PoseError::NotARotationMatrix { columns, defect, .. } => {
                PoseError::NotARotationMatrix { columns, defect, tolerance: ROUNDED_TOLERANCE }
            }
            other => other,
        })?;
        Ok((pose, is_rounded.then_some(defect)))
    }

    /// Builds a pose that only translates, in world units.
    ///
    /// # Errors
    /// [`PoseError::Translation`] if the translation is not finite or out of range.
    #[inline]
    pub fn from_translation(translation: DVec3) -> Result<Self, PoseError> {
        check_translation(translation)?;
        Ok(Self { matrix: DMat3::IDENTITY, translation })
    }

    /// Builds a pose from entries that a valid pose contained, without checks.
    #[inline]
    #[doc(hidden)]
    pub fn from_checked_entries(matrix: DMat3, translation: DVec3) -> Self {
        Self { matrix, translation }
    }

    /// Returns the pose with the same rotation and another translation, in world units.
    ///
    /// # Errors
    /// [`PoseError::Translation`] if the translation is not finite or out of range.
    #[inline]
    pub fn with_translation(&self, translation: DVec3) -> Result<Self, PoseError> {
        check_translation(translation)?;
        Ok(Self { translation, ..*self })
    }

    /// Returns the rotation as a unit quaternion, up to rounding. The matrix defines the pose.
    #[inline]
    pub fn rotation(&self) -> DQuat {
        DQuat::from_mat3(&self.matrix).normalize()
    }

    /// Returns the rotation matrix `R`, which defines the pose.
    #[inline]
    pub const fn matrix(&self) -> DMat3 {
        self.matrix
    }

    /// Returns the translation `t`, in world units.
    #[inline]
    pub const fn translation(&self) -> DVec3 {
        self.translation
    }

    /// Transforms a point from the body frame to the world.
    #[inline]
    pub fn transform_point(&self, point_in_body: DVec3) -> DVec3 {
        self.matrix * point_in_body + self.translation
    }

    /// Transforms a vector (a difference of points) from the body frame to the world.
    #[inline]
    pub fn transform_vector(&self, vector_in_body: DVec3) -> DVec3 {
        self.matrix * vector_in_body
    }

    /// Returns the composition `x -> self(first(x))`.
    ///
    /// # Errors
    /// [`PoseError::Translation`] if the composed translation is out of range.
    /// [`PoseError::NotARotationMatrix`] if the product of the matrices differs from a rotation by more than 1e-6.
    #[inline]
    pub fn compose(&self, first: &Self) -> Result<Self, PoseError> {
        Self::from_matrix(self.matrix * first.matrix, self.transform_point(first.translation))
    }

    /// Returns the inverse pose.
    ///
    /// # Errors
    /// [`PoseError::Translation`] if the translation of the inverse is out of range.
    /// [`PoseError::NotARotationMatrix`] if the inverse of the matrix differs from a rotation by more than
    /// 1e-6.
    #[inline]
    pub fn inverse(&self) -> Result<Self, PoseError> {
        let matrix = self.matrix.inverse();
        Self::from_matrix(matrix, -(matrix * self.translation))
    }

    /// Returns this pose translated by `offset` in the world.
    ///
    /// # Errors
    /// [`PoseError::Translation`] if the new translation is not finite or out of range.
    #[inline]
    pub fn translated_by(&self, offset: DVec3) -> Result<Self, PoseError> {
        self.with_translation(self.translation + offset)
    }
}

/// Serialised form of a pose. A deserialised pose is checked like any other.
#[cfg(feature = "serde")]
#[derive(serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PoseRecord {
    /// The nine entries, column by column.
    matrix: [f64; 9],
    translation: [f64; 3],
}

#[cfg(feature = "serde")]
impl From<Pose> for PoseRecord {
    #[inline]
    fn from(pose: Pose) -> Self {
        Self { matrix: pose.matrix.to_cols_array(), translation: pose.translation.to_array() }
    }
}

#[cfg(feature = "serde")]
impl TryFrom<PoseRecord> for Pose {
    type Error = PoseError;

    #[inline]
    fn try_from(record: PoseRecord) -> Result<Self, PoseError> {
        let translation = DVec3::from_array(record.translation);
        Self::from_matrix(DMat3::from_cols_array(&record.matrix), translation)
    }
}

impl Default for Pose {
    #[inline]
    fn default() -> Self {
        Self::IDENTITY
    }
}

/// Computes the rotation matrix of a quaternion of any length near 1.
///
/// The entries are divided by the computed square of the length. Therefore the entries of a quarter turn, or
/// of a half turn about a diagonal, are exactly 0 and 1: the quaternion contains rounded roots of 1/2, and
/// the same rounding occurs in numerator and denominator.
#[inline]
fn matrix_from_quaternion(rotation: DQuat) -> DMat3 {
    let [x, y, z, w] = rotation.to_array();
    let scale = 2.0 / ((x * x + y * y) + (z * z + w * w));
    let off = |a: f64, b: f64| (a + b) * scale;
    let diagonal = |a: f64, b: f64| 1.0 - (a * a + b * b) * scale;
    DMat3::from_cols(
        DVec3::new(diagonal(y, z), off(x * y, w * z), off(x * z, -w * y)),
        DVec3::new(off(x * y, -w * z), diagonal(x, z), off(y * z, w * x)),
        DVec3::new(off(x * z, w * y), off(y * z, -w * x), diagonal(x, y)),
    )
}

/// Returns the largest entry of `R^T R - I` by magnitude: at least 2 for a reflection, infinite if an entry is not
/// finite.
#[inline]
fn largest_defect(matrix: DMat3) -> f64 {
    let defect = orthogonality_defect(matrix).into_iter().map(f64::abs).fold(0.0, f64::max);
    if !matrix.is_finite() {
        f64::INFINITY
    } else if matrix.determinant() < 0.0 {
        2.0_f64.max(defect)
    } else {
        defect
    }
}

/// Returns the rotation nearest to a matrix that is close to one, by Newton's iteration for the polar factor,
/// `R <- (R + R^-T) / 2` (Higham, "Computing the polar decomposition - with applications", 1986).
#[inline]
fn nearest_rotation(matrix: DMat3) -> DMat3 {
    let mut rotation = matrix;
    for _ in 0..MAX_POLAR_STEPS {
        let next = (rotation + rotation.inverse().transpose()) * 0.5;
        let step = (next - rotation).to_cols_array().map(f64::abs).into_iter().fold(0.0, f64::max);
        rotation = next;
        if step <= f64::EPSILON {
            break;
        }
    }
    rotation
}

/// Returns the nine entries of `R^T R - I`, which are 0 for a rotation.
#[inline]
fn orthogonality_defect(matrix: DMat3) -> [f64; 9] {
    (matrix.transpose() * matrix - DMat3::IDENTITY).to_cols_array()
}

/// Returns the Frobenius norm of `R^T R - I`, which bounds the relative stretch of lengths by the matrix `R`.
#[inline]
pub fn rotation_defect(matrix: DMat3) -> f64 {
    orthogonality_defect(matrix).into_iter().map(|x| x * x).sum::<f64>().sqrt()
}

#[inline]
fn check_translation(translation: DVec3) -> Result<(), PoseError> {
    if is_in_exact_range(translation) {
        Ok(())
    } else {
        Err(PoseError::Translation { translation })
    }
}

/// Replaces entries of a rotation below `2^-200` by zero, because they are rounding noise of zero. Products
/// with coordinates then stay in the exact range.
#[inline]
fn flush_tiny(m: DMat3) -> DMat3 {
    DMat3::from_cols_array(
        &m.to_cols_array().map(|c| if c.abs() < MIN_MAGNITUDE { 0.0 } else { c }),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rotations_between_axes_are_exact() {
        let axes = DVec3::AXES.into_iter().flat_map(|axis| [axis, -axis]);
        let mut count = 0;
        for x in axes.clone() {
            for y in axes.clone().filter(|y| x.dot(*y) == 0.0) {
                let turn = DMat3::from_cols(x, y, x.cross(y));
                let pose = Pose::new(DQuat::from_mat3(&turn), DVec3::ZERO).unwrap();
                assert_eq!(pose.matrix(), turn);
                count += 1;
            }
        }
        assert_eq!(count, 24);
    }

    #[test]
    fn matrix_agrees_with_quaternion() {
        for k in 0..100 {
            let angle = f64::from(k);
            let q = DQuat::from_euler(glam::EulerRot::ZYX, angle, 2.0 * angle, 3.0 * angle);
            let m = Pose::new(q, DVec3::ZERO).unwrap().matrix();
            assert!((m - DMat3::from_quat(q)).to_cols_array().iter().all(|e| e.abs() < 1e-15));
        }
    }
}
