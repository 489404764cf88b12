//! Convex hull (interface).
use crate::error::BuildError;
use glam::DVec3;

/// Which input points are vertices, and the faces over them.
#[derive(Debug, Clone)]
pub(crate) struct Hull {
    /// Affine dimension of the points, 0 to 3.
    pub(crate) dimension: u8,
    /// Indices of the vertices in the input.
    pub(crate) vertices: Vec<u32>,
    /// First entry of each face in `face_vertices`, and one past the end.
    pub(crate) face_start: Vec<u32>,
    /// Positions in `vertices`, counter-clockwise from outside. A flat polygon: front and back.
    pub(crate) face_vertices: Vec<u32>,
    /// Largest distance of an input point outside a face plane.
    pub(crate) violation: f64,
}

pub(crate) fn convex_hull(points: &[DVec3]) -> Result<Hull, BuildError> {
    let _ = points;
    Err(BuildError::NoPoints)
}
