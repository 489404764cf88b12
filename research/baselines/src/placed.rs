//! The pose of one body in the frame of the other.

use colltrans::Pose;
use glam::{DMat3, DVec3};

/// The pose of the moving body in the fixed body's frame: `x_fixed = R x_moving + t`.
///
/// Only the difference of both translations is used. Therefore a common displacement of both bodies costs no
/// accuracy.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Relative {
    pub(crate) rotation: DMat3,
    pub(crate) translation: DVec3,
}

impl Relative {
    /// Computes the relative pose.
    pub(crate) fn new(moving_pose: &Pose, fixed_pose: &Pose) -> Self {
        let to_fixed = fixed_pose.matrix().transpose();
        Self {
            rotation: to_fixed * moving_pose.matrix(),
            translation: to_fixed * (moving_pose.translation() - fixed_pose.translation()),
        }
    }

    /// Transforms a point of the moving body to the fixed body's frame.
    pub(crate) fn point(&self, in_moving: DVec3) -> DVec3 {
        self.rotation * in_moving + self.translation
    }

    /// Transforms a direction of the fixed body's frame to the moving body's frame.
    pub(crate) fn to_moving(self, in_fixed: DVec3) -> DVec3 {
        self.rotation.transpose() * in_fixed
    }
}
