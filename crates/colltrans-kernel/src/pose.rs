//! Poses: a rotation followed by a translation, `x_world = R x_body + t`.
//!
//! The nine entries of `R` *define* where a body is: solvers, certificates and the exact
//! verification all read the same nine numbers, so no rounding lies between them. They are those
//! given, or computed once from a quaternion. They need not be a rotation to the last digit: a
//! matrix that is off one by [`TOLERANCE`] places a body that is stretched by as much, which
//! [`noise`](crate::noise) covers.

use glam::{DMat3, DQuat, DVec3};

use crate::error::PoseError;
use crate::range::{MIN_MAGNITUDE, in_exact_range};

/// How far the length of a quaternion may be from 1, and an entry of `R^T R` from that of the
/// identity: single precision passes.
const TOLERANCE: f64 = 1e-6;

/// Factor by which a pose stretches a length at most: its nine entries may be off a rotation by [`TOLERANCE`].
pub const STRETCHED: f64 = 1.0 + 4.0 * TOLERANCE;

/// How far the length of a quaternion, or an entry of `R^T R`, may be off for
/// [`Pose::from_rounded`] and [`Pose::from_rounded_matrix`]: two written digits pass.
const FEW_DIGITS: f64 = 0.02;

/// Largest number of Newton steps towards the nearest rotation. Each squares the defect, so that
/// two percent become rounding error in four.
const MOST_POLAR_STEPS: usize = 8;

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
/// // A quaternion that is not a rotation is refused.
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
    /// The body's own frame is the world's.
    pub const IDENTITY: Self = Self { matrix: DMat3::IDENTITY, translation: DVec3::ZERO };

    /// Rotation (a quaternion of length 1 to within 1e-6, normalised here), then translation.
    ///
    /// # Errors
    /// A quaternion that is not a rotation, a translation that is not finite or out of range.
    #[inline]
    pub fn new(rotation: DQuat, translation: DVec3) -> Result<Self, PoseError> {
        let length = rotation.length();
        if length.is_nan() || (length - 1.0).abs() > TOLERANCE {
            let [x, y, z, w] = rotation.to_array();
            return Err(PoseError::NotARotation { x, y, z, w, length });
        }
        check_translation(translation)?;
        let rotation = if length == 1.0 { rotation } else { rotation * (1.0 / length) };
        Ok(Self { matrix: flush_tiny(matrix_of(rotation)), translation })
    }

    /// The nine entries of a rotation matrix, taken as they are, then translation.
    ///
    /// # Errors
    /// A matrix that is off a rotation by more than 1e-6, with the measured defect; a translation
    /// that is not finite or out of range.
    ///
    /// ```
    /// use colltrans::Pose;
    /// use colltrans::glam::{DMat3, DVec3};
    ///
    /// // x to y, y to z, z to x: the same nine entries come back.
    /// let turn = DMat3::from_cols(DVec3::Y, DVec3::Z, DVec3::X);
    /// assert_eq!(Pose::from_matrix(turn, DVec3::ZERO)?.matrix(), turn);
    /// // A reflection places nothing.
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

    /// Builds a pose from a quaternion that was written with few digits: one whose length is off 1 by more than
    /// 1e-6 and at most 0.02 is normalised. Returns its defect, `|length - 1|`, in that case.
    ///
    /// # Errors
    /// As [`Self::new`], for a quaternion that is off by more.
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
        let is_rounded = defect > TOLERANCE && defect <= FEW_DIGITS;
        let rotation = if is_rounded { rotation.normalize() } else { rotation };
        Ok((Self::new(rotation, translation)?, is_rounded.then_some(defect)))
    }

    /// Builds a pose from a matrix that was written with few digits: one that is off a rotation by more than 1e-6
    /// and at most 0.02 becomes the nearest rotation, its polar factor. Returns its defect in that case.
    ///
    /// # Errors
    /// As [`Self::from_matrix`], for a matrix that is off by more than 0.02.
    #[inline]
    pub fn from_rounded_matrix(
        matrix: DMat3,
        translation: DVec3,
    ) -> Result<(Self, Option<f64>), PoseError> {
        let defect = largest_defect(matrix);
        let is_rounded = defect > TOLERANCE && defect <= FEW_DIGITS;
        let matrix = if is_rounded { nearest_rotation(matrix) } else { matrix };
        let pose = Self::from_matrix(matrix, translation).map_err(|error| match error {
            PoseError::NotARotationMatrix { columns, defect, .. } => {
                PoseError::NotARotationMatrix { columns, defect, tolerance: FEW_DIGITS }
            }
            other => other,
        })?;
        Ok((pose, is_rounded.then_some(defect)))
    }

    /// A translation alone.
    ///
    /// # Errors
    /// A translation that is not finite or out of range.
    #[inline]
    pub fn from_translation(translation: DVec3) -> Result<Self, PoseError> {
        check_translation(translation)?;
        Ok(Self { matrix: DMat3::IDENTITY, translation })
    }

    /// From entries that were those of a pose before.
    #[inline]
    #[doc(hidden)]
    pub fn checked(matrix: DMat3, translation: DVec3) -> Self {
        Self { matrix, translation }
    }

    /// The same rotation somewhere else.
    ///
    /// # Errors
    /// The new translation is out of range.
    #[inline]
    pub fn moved_to(&self, translation: DVec3) -> Result<Self, PoseError> {
        check_translation(translation)?;
        Ok(Self { translation, ..*self })
    }

    /// The rotation as a unit quaternion, to rounding error: the matrix is what counts.
    #[inline]
    pub fn rotation(&self) -> DQuat {
        DQuat::from_mat3(&self.matrix).normalize()
    }

    /// The rotation matrix `R` that defines the placement.
    #[inline]
    pub const fn matrix(&self) -> DMat3 {
        self.matrix
    }

    /// The translation `t`, in world units.
    #[inline]
    pub const fn translation(&self) -> DVec3 {
        self.translation
    }

    /// A point of the body, in the world.
    #[inline]
    pub fn transform_point(&self, point_in_body: DVec3) -> DVec3 {
        self.matrix * point_in_body + self.translation
    }

    /// A vector (difference of points) of the body, in the world.
    #[inline]
    pub fn transform_vector(&self, vector_in_body: DVec3) -> DVec3 {
        self.matrix * vector_in_body
    }

    /// `self` after `first`: `x -> self(first(x))`.
    ///
    /// # Errors
    /// The composed translation is out of range, or errors of the two matrices have added up.
    #[inline]
    pub fn compose(&self, first: &Self) -> Result<Self, PoseError> {
        Self::from_matrix(self.matrix * first.matrix, self.transform_point(first.translation))
    }

    /// The pose that undoes this one.
    ///
    /// # Errors
    /// The inverse's translation is out of range, or errors of the matrix have doubled.
    #[inline]
    pub fn inverse(&self) -> Result<Self, PoseError> {
        let matrix = self.matrix.inverse();
        Self::from_matrix(matrix, -(matrix * self.translation))
    }

    /// This pose moved by `offset` in the world.
    ///
    /// # Errors
    /// The new translation is out of range.
    #[inline]
    pub fn translated(&self, offset: DVec3) -> Result<Self, PoseError> {
        self.moved_to(self.translation + offset)
    }
}

/// A pose as it is written; read, it is checked like any other.
#[cfg(feature = "serde")]
#[derive(serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PoseRecord {
    /// Column by column.
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

/// The rotation matrix of a quaternion of any length near 1.
///
/// Divided by the square of the length as it is computed, the entries of a quarter turn, or of a
/// half turn about a diagonal, come out as 0 and 1: the roots of 1/2 that make it are rounded, but
/// the same rounding is above and below.
#[inline]
fn matrix_of(rotation: DQuat) -> DMat3 {
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
    let defect = off_rotation(matrix).into_iter().map(f64::abs).fold(0.0, f64::max);
    if !matrix.is_finite() {
        f64::INFINITY
    } else if matrix.determinant() < 0.0 {
        2.0_f64.max(defect)
    } else {
        defect
    }
}

/// Returns the rotation nearest to a matrix that is close to one, by Newton's iteration for the polar factor,
/// `R <- (R + R^-T) / 2` (Higham, "Computing the polar decomposition", 1986).
#[inline]
fn nearest_rotation(matrix: DMat3) -> DMat3 {
    let mut rotation = matrix;
    for _ in 0..MOST_POLAR_STEPS {
        let next = (rotation + rotation.inverse().transpose()) * 0.5;
        let step = (next - rotation).to_cols_array().map(f64::abs).into_iter().fold(0.0, f64::max);
        rotation = next;
        if step <= f64::EPSILON {
            break;
        }
    }
    rotation
}

/// The nine entries of `R^T R - 1`, which are 0 for a rotation.
#[inline]
fn off_rotation(matrix: DMat3) -> [f64; 9] {
    (matrix.transpose() * matrix - DMat3::IDENTITY).to_cols_array()
}

/// How far lengths may be stretched by a matrix: the square root of the sum of the squares of what it is off
/// a rotation.
#[inline]
pub fn rotation_defect(matrix: DMat3) -> f64 {
    off_rotation(matrix).into_iter().map(|x| x * x).sum::<f64>().sqrt()
}

#[inline]
fn check_translation(translation: DVec3) -> Result<(), PoseError> {
    if in_exact_range(translation) { Ok(()) } else { Err(PoseError::Translation { translation }) }
}

/// Entries of a rotation below `2^-200` are rounding noise of zero: they become zero, so that
/// products with coordinates stay in the exact range.
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
    fn turns_that_map_the_axes_to_each_other_are_exact() {
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
    fn the_matrix_is_that_of_the_quaternion() {
        for k in 0..100 {
            let angle = f64::from(k);
            let q = DQuat::from_euler(glam::EulerRot::ZYX, angle, 2.0 * angle, 3.0 * angle);
            let m = Pose::new(q, DVec3::ZERO).unwrap().matrix();
            assert!((m - DMat3::from_quat(q)).to_cols_array().iter().all(|e| e.abs() < 1e-15));
        }
    }
}
