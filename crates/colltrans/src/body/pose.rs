//! Poses: a rotation followed by a translation, `x_world = R x_body + t`.
//!
//! The nine entries of `R` are `f64` numbers computed once from the quaternion. They, not the
//! quaternion, *define* where a body is: solvers, certificates and the exact verification all
//! read the same nine numbers, so no rounding lies between them.

use glam::{DMat3, DQuat, DVec3};

use crate::error::PoseError;
use crate::number::range::{MIN_MAGNITUDE, in_exact_range};

/// How far the length of a quaternion may be from 1: single-precision quaternions pass.
const UNIT_LENGTH_TOLERANCE: f64 = 1e-6;

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
/// // A quaternion that is no rotation is refused.
/// assert!(Pose::new(DQuat::from_xyzw(0.0, 0.0, 1.0, 1.0), DVec3::ZERO).is_err());
/// # Ok::<(), colltrans::PoseError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    rotation: DQuat,
    matrix: DMat3,
    translation: DVec3,
}

impl Pose {
    /// The body's own frame is the world's.
    pub const IDENTITY: Self =
        Self { rotation: DQuat::IDENTITY, matrix: DMat3::IDENTITY, translation: DVec3::ZERO };

    /// Rotation (a quaternion of length 1 to within 1e-6, normalised here), then translation.
    ///
    /// # Errors
    /// A quaternion that is no rotation, a translation that is not finite or out of range.
    pub fn new(rotation: DQuat, translation: DVec3) -> Result<Self, PoseError> {
        let length = rotation.length();
        if length.is_nan() || (length - 1.0).abs() > UNIT_LENGTH_TOLERANCE {
            let [x, y, z, w] = rotation.to_array();
            return Err(PoseError::NotARotation { x, y, z, w, length });
        }
        if !in_exact_range(translation) {
            return Err(PoseError::Translation { translation });
        }
        let rotation = if length == 1.0 { rotation } else { rotation * (1.0 / length) };
        Ok(Self { rotation, matrix: flush_tiny(DMat3::from_quat(rotation)), translation })
    }

    /// A translation alone.
    ///
    /// # Errors
    /// A translation that is not finite or out of range.
    pub fn from_translation(translation: DVec3) -> Result<Self, PoseError> {
        Self::new(DQuat::IDENTITY, translation)
    }

    /// The rotation as a unit quaternion.
    pub const fn rotation(&self) -> DQuat {
        self.rotation
    }

    /// The rotation matrix `R` that defines the placement.
    pub const fn matrix(&self) -> DMat3 {
        self.matrix
    }

    /// The translation `t`, in world units.
    pub const fn translation(&self) -> DVec3 {
        self.translation
    }

    /// A point of the body, in the world.
    pub fn transform_point(&self, point_in_body: DVec3) -> DVec3 {
        self.matrix * point_in_body + self.translation
    }

    /// A vector (difference of points) of the body, in the world.
    pub fn transform_vector(&self, vector_in_body: DVec3) -> DVec3 {
        self.matrix * vector_in_body
    }

    /// `self` after `first`: `x -> self(first(x))`.
    ///
    /// # Errors
    /// The composed translation is out of range.
    pub fn compose(&self, first: &Self) -> Result<Self, PoseError> {
        let rotation = (self.rotation * first.rotation).normalize();
        Self::new(rotation, self.transform_point(first.translation))
    }

    /// The pose that undoes this one.
    ///
    /// # Errors
    /// The inverse's translation is out of range.
    pub fn inverse(&self) -> Result<Self, PoseError> {
        let rotation = self.rotation.conjugate();
        Self::new(rotation, -(rotation * self.translation))
    }

    /// This pose moved by `offset` in the world.
    ///
    /// # Errors
    /// The new translation is out of range.
    pub fn translated(&self, offset: DVec3) -> Result<Self, PoseError> {
        let translation = self.translation + offset;
        if !in_exact_range(translation) {
            return Err(PoseError::Translation { translation });
        }
        Ok(Self { translation, ..*self })
    }
}

impl Default for Pose {
    fn default() -> Self {
        Self::IDENTITY
    }
}

/// Entries of a rotation below `2^-200` are rounding noise of zero: they become zero, so that
/// products with coordinates stay in the exact range.
fn flush_tiny(m: DMat3) -> DMat3 {
    DMat3::from_cols_array(
        &m.to_cols_array().map(|c| if c.abs() < MIN_MAGNITUDE { 0.0 } else { c }),
    )
}
