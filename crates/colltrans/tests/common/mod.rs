//! Bodies and poses of the tests, from the test kit's meshes and points.

#![allow(dead_code, unreachable_pub, reason = "each test program uses a part of it")]

use colltrans::{ConvexPolyhedron, Pose, Solid};
use colltrans_testkit::shapes::{self, Mesh};
use glam::DVec3;

/// The hull of points.
pub fn body(points: &[DVec3]) -> ConvexPolyhedron {
    ConvexPolyhedron::from_points(points).expect("a body")
}

/// The faces of a body, as lists of its vertices.
pub fn faces(body: &ConvexPolyhedron) -> Vec<Vec<u32>> {
    (0..body.face_count() as u32).map(|f| body.face_vertices(f).collect()).collect()
}

pub fn solid(mesh: &Mesh) -> Solid {
    Solid::from_mesh(&mesh.vertices, &mesh.faces).expect("a closed mesh")
}

/// The box from one corner to the opposite one.
pub fn cuboid(low: [f64; 3], high: [f64; 3]) -> Solid {
    solid(&shapes::block(low, high))
}

pub fn at(translation: impl Into<DVec3>) -> Pose {
    Pose::from_translation(translation.into()).expect("in range")
}
