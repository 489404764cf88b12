//! Bodies and poses of the tests.

use colltrans_convex::{ConvexPolyhedron, Pose};
use glam::DVec3;

/// Returns the hull of points.
pub(crate) fn body(points: &[DVec3]) -> ConvexPolyhedron {
    ConvexPolyhedron::from_points(points).expect("a body")
}

/// Returns the faces of a body, as lists of its vertices.
pub(crate) fn faces(body: &ConvexPolyhedron) -> Vec<Vec<u32>> {
    (0..body.face_count() as u32).map(|f| body.face_vertices(f).collect()).collect()
}

pub(crate) fn at(translation: impl Into<DVec3>) -> Pose {
    Pose::from_translation(translation.into()).expect("in range")
}
