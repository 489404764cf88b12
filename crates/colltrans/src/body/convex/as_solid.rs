//! A convex polyhedron as a solid, made when it is first asked for and kept.

use super::ConvexPolyhedron;
use crate::body::solid::{AsSolid, Solid, SolidError};

impl Solid {
    /// A convex polyhedron, its faces cut into triangles. Vertices keep the numbers of its input, and
    /// faces their numbers. A flat polygon becomes a sheet with two sides and no volume; it overlaps
    /// what it is inside of.
    ///
    /// # Errors
    /// A point or a segment.
    pub fn from_convex(body: &ConvexPolyhedron) -> Result<Self, SolidError> {
        let facets: Vec<Vec<u32>> =
            (0..body.face_count() as u32).map(|f| body.face_vertices(f).collect()).collect();
        Ok(Self::from_mesh(body.vertices(), &facets)?.renumbered(body.input_indices()))
    }
}

impl AsSolid for ConvexPolyhedron {
    fn as_solid(&self) -> Result<&Solid, SolidError> {
        let made = self.solid.get_or_init(|| Box::new(Solid::from_convex(self)));
        made.as_ref().as_ref().map_err(Clone::clone)
    }
}
