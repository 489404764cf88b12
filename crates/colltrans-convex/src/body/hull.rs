//! The trait [`VertexHull`]: vertices whose convex hull is, or contains, a body. Planes are checked against them.

use glam::DVec3;

use super::ConvexPolyhedron;

/// Vertices whose convex hull is, or contains, a body or a part of one.
pub trait VertexHull {
    /// Returns the vertices, in the body frame; at least one.
    fn hull_vertices(&self) -> &[DVec3];

    /// Returns the number of vertices. Bodies that compute their vertices on the first request override it.
    #[inline]
    fn vertex_count(&self) -> usize {
        self.hull_vertices().len()
    }

    /// Returns an upper bound of the distances of the vertices from the origin of the body frame.
    fn reach(&self) -> f64;

    /// Returns an upper bound of the distance of an input point from the hull of the vertices.
    #[inline]
    fn input_excess(&self) -> f64 {
        0.0
    }

    /// Returns the radius of the ball that sweeps the hull; 0 for a body that is not rounded.
    #[inline]
    fn radius(&self) -> f64 {
        0.0
    }
}

impl VertexHull for ConvexPolyhedron {
    #[inline]
    fn hull_vertices(&self) -> &[DVec3] {
        self.vertices()
    }

    #[inline]
    fn reach(&self) -> f64 {
        self.inertia().reach
    }

    #[inline]
    fn input_excess(&self) -> f64 {
        Self::input_excess(self)
    }

    #[inline]
    fn radius(&self) -> f64 {
        Self::radius(self)
    }
}
