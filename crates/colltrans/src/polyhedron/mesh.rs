//! Bodies from meshes (interface).
use super::ConvexPolyhedron;
use crate::error::BuildError;
use glam::DVec3;

pub(super) fn from_mesh<F: AsRef<[u32]>>(
    vertices: &[DVec3],
    faces: &[F],
    tolerance: f64,
) -> Result<ConvexPolyhedron, BuildError> {
    let _ = (vertices, faces.iter().map(AsRef::as_ref).count(), tolerance);
    Err(BuildError::NoPoints)
}
