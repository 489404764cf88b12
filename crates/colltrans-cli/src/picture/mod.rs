//! stub
use colltrans::glam::DVec3;
use colltrans::{ContactRange, ConvexPolyhedron, Pose};
pub(crate) struct Scene<'a> {
    pub(crate) moving: &'a ConvexPolyhedron,
    pub(crate) moving_pose: Pose,
    pub(crate) fixed: &'a ConvexPolyhedron,
    pub(crate) fixed_pose: Pose,
    pub(crate) direction: DVec3,
    pub(crate) answer: &'a ContactRange,
}
pub(crate) fn draw(_: &Scene<'_>) -> String {
    String::new()
}
