//! What a plane is held against: the corners that a body is the convex hull of, or lies within the hull of.

use glam::DVec3;

use super::ConvexPolyhedron;

/// A body, or a part of one, by its corners.
pub trait Hull {
    /// In the body's frame; at least one.
    fn corners(&self) -> &[DVec3];

    /// The largest distance of a corner from the origin of that frame, or more.
    fn reach(&self) -> f64;

    /// How far a point of the input may lie outside the hull of the corners.
    #[inline]
    fn input_excess(&self) -> f64 {
        0.0
    }
}

impl Hull for ConvexPolyhedron {
    #[inline]
    fn corners(&self) -> &[DVec3] {
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
}
