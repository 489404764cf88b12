//! Three points of the Minkowski difference around a ray from an inner point.

use colltrans::ConvexPolyhedron;
use glam::DVec3;

/// Mean of the vertices, a point inside a solid.
pub(crate) fn centre(body: &ConvexPolyhedron) -> DVec3 {
    body.vertices().iter().sum::<DVec3>() / body.vertices().len() as f64
}

/// A triangle that the ray passes: a *portal*.
///
/// Corners are relative to the start of the ray. Invariant, up to rounding: they are counter-clockwise, seen against
/// the ray, so `det(u_i, u_{i+1}, r)` is not negative for the ray `r`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Wedge {
    pub(crate) ray: DVec3,
    pub(crate) corners: [DVec3; 3],
}

impl Wedge {
    /// Returns the normal of the triangle's plane, along the ray, of any length.
    pub(crate) fn normal(&self) -> DVec3 {
        let [a, b, c] = self.corners;
        (b - a).cross(c - a)
    }

    /// Returns the share of the ray up to the plane through a point with a normal.
    pub(crate) fn share_to_plane(&self, normal: DVec3, point: DVec3) -> f64 {
        normal.dot(point) / normal.dot(self.ray)
    }

    /// Replaces the corner whose exchange for `point` keeps the ray inside.
    pub(crate) fn replace_corner(&mut self, point: DVec3) {
        let sides = self.corners.map(|corner| point.cross(corner).dot(self.ray));
        // The ray is between the corners `k` and `k + 1`: on the left of the first, on the right of the second.
        let inside = |k: &usize| sides[*k].min(-sides[(k + 1) % 3]);
        let kept = (0..3).max_by(|a, b| inside(a).total_cmp(&inside(b))).unwrap_or(0);
        self.corners[(kept + 2) % 3] = point;
    }
}
