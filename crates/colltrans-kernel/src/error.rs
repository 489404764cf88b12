//! Why a pose or a motion was refused.

use glam::DVec3;
use thiserror::Error;

/// Why a [`Pose`](crate::Pose) was refused.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum PoseError {
    /// The quaternion is not finite or its length is not 1.
    #[error("the rotation (x {x}, y {y}, z {z}, w {w}) has length {length}, not 1")]
    NotARotation {
        /// Component x as given.
        x: f64,
        /// Component y as given.
        y: f64,
        /// Component z as given.
        z: f64,
        /// Component w as given.
        w: f64,
        /// Its length.
        length: f64,
    },
    /// The matrix is not finite or not a rotation.
    #[error(
        "the matrix with the columns {columns:?} is not a rotation: it is off one by {defect:e} \
         (tolerated: {tolerance:e})"
    )]
    NotARotationMatrix {
        /// The columns as given.
        columns: [[f64; 3]; 3],
        /// The largest entry of `R^T R - I` by magnitude; at least 2 for a reflection, infinite if an
        /// entry is not finite.
        defect: f64,
        /// The defect that would have been accepted.
        tolerance: f64,
    },
    /// The translation is not finite, or beyond the range in which the predicates are exact.
    #[error(
        "the translation {:?} is not finite or has a component outside the exact range \
         (0, or a magnitude from 2^-200 to 2^200)",
        .translation.to_array()
    )]
    Translation {
        /// The translation as given.
        translation: DVec3,
    },
}

/// Why a motion is none.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum MotionError {
    /// A vector is not finite or out of range, or an axis is zero.
    #[error(
        "the {what} {:?} is zero, not finite or has a component outside the exact range \
         (0, or a magnitude from 2^-200 to 2^200)",
        .vector.to_array()
    )]
    Number {
        /// Which one.
        what: &'static str,
        /// As given, or as it follows.
        vector: DVec3,
    },
    /// The angle is not finite, or larger than 1e5 in a piece or for a whole unit of time.
    #[error("the angle {angle} is not a number from -1e5 to 1e5 (radians)")]
    Angle {
        /// The angle as given, in a unit of time.
        angle: f64,
    },
    /// No poses to go through.
    #[error("a motion needs at least one pose")]
    NoPoses,
    /// A time that is not from 0 to 1, or not in order.
    #[error("the time {time} is not from 0 to 1, or not after the one before it")]
    Time {
        /// The time as given.
        time: f64,
    },
    /// A pose on the way is none.
    #[error("a pose on the way is none: {0}")]
    Pose(#[from] PoseError),
}
