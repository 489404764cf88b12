//! Bodies and poses of the tests, from the test kit's meshes.

use colltrans_convex::Pose;
use colltrans_solid::Solid;
use colltrans_testkit::shapes::{self, Mesh};
use glam::DVec3;

pub(crate) fn solid(mesh: &Mesh) -> Solid {
    Solid::from_mesh(&mesh.vertices, &mesh.faces).expect("a closed mesh")
}

/// Returns the box from one corner to the opposite one.
pub(crate) fn cuboid(low: [f64; 3], high: [f64; 3]) -> Solid {
    solid(&shapes::block(low, high))
}

pub(crate) fn at(translation: impl Into<DVec3>) -> Pose {
    Pose::from_translation(translation.into()).expect("in range")
}
