//! Builds bodies and poses of tests from the meshes and points of [`shapes`]. All functions panic if the
//! library rejects a body.

use colltrans::{ConvexPolyhedron, Pose, Solid};
use glam::{DQuat, DVec3};

use crate::random::Random;
use crate::shapes::{self, Mesh};

/// Returns the hull of points.
///
/// # Panics
/// If there are no points.
pub fn body(points: &[DVec3]) -> ConvexPolyhedron {
    ConvexPolyhedron::from_points(points).expect("a body")
}

/// Returns the hull of `n` random points on the unit sphere.
pub fn hull(n: usize, random: &mut Random) -> ConvexPolyhedron {
    body(&shapes::random_hull(n, random).vertices)
}

/// Returns the faces of a body, as lists of its vertices.
pub fn faces(body: &ConvexPolyhedron) -> Vec<Vec<u32>> {
    (0..body.face_count() as u32).map(|f| body.face_vertices(f).collect()).collect()
}

/// Returns the convex box from one corner to the opposite one.
///
/// # Panics
/// If the corners are not in order.
pub fn block(low: impl Into<DVec3>, high: impl Into<DVec3>) -> ConvexPolyhedron {
    ConvexPolyhedron::cuboid(low.into(), high.into()).expect("a box")
}

/// Returns the convex box, centred at the origin, with these half extents.
pub fn centered(half: impl Into<DVec3>) -> ConvexPolyhedron {
    let half = half.into();
    block(-half, half)
}

/// Returns the unit cube with a corner in the origin.
pub fn cube() -> ConvexPolyhedron {
    block(DVec3::ZERO, DVec3::ONE)
}

/// Returns the solid of a closed mesh.
///
/// # Panics
/// If the mesh is not closed.
pub fn solid(mesh: &Mesh) -> Solid {
    Solid::from_mesh(&mesh.vertices, &mesh.faces).expect("a closed mesh")
}

/// Returns the box from one corner to the opposite one as a solid.
pub fn cuboid(low: impl Into<DVec3>, high: impl Into<DVec3>) -> Solid {
    solid(&shapes::block(low, high))
}

/// Returns a floor with a wall at its end as one solid.
///
/// # Panics
/// Never.
pub fn floor_with_wall() -> Solid {
    let floor = block([-4.0, -2.0, -1.0], [4.0, 2.0, 0.0]);
    let wall = block([3.0, -2.0, 0.0], [4.0, 2.0, 5.0]);
    Solid::from_pieces([&floor, &wall]).expect("pieces")
}

/// Returns a pose without rotation.
///
/// # Panics
/// If the translation is out of range.
pub fn at(translation: impl Into<DVec3>) -> Pose {
    Pose::from_translation(translation.into()).expect("in range")
}

/// Returns a pose without rotation, given by its coordinates.
pub fn at_xyz(x: f64, y: f64, z: f64) -> Pose {
    at([x, y, z])
}

/// Returns a pose with a translation in the xy plane, and a rotation about z by an angle in radians.
///
/// # Panics
/// If the translation is out of range.
pub fn turned(x: f64, y: f64, angle: f64) -> Pose {
    Pose::new(DQuat::from_rotation_z(angle), DVec3::new(x, y, 0.0)).expect("in range")
}
