//! A triangle of one of the bodies, with exact predicates.

use std::cmp::Ordering;

use super::scene::{ExactPoint, PairFrame, PlacedBody, PlacedVertex};
use crate::body::edges::NO_NEIGHBOUR;
use colltrans_convex::body::Aabb;

/// A placed triangle of one body.
pub(crate) struct Triangle<'s, 'a> {
    pub(crate) side: &'s PlacedBody<'a>,
    pub(crate) index: usize,
    pub(crate) corners: [PlacedVertex; 3],
    pub(crate) bounds: Aabb,
}

impl<'s, 'a> Triangle<'s, 'a> {
    pub(crate) fn new(side: &'s PlacedBody<'a>, index: usize) -> Self {
        let corners = side.corners(index);
        let bounds = Aabb::from_triangle(corners.map(|c| c.at));
        Self { side, index, corners, bounds }
    }

    /// Returns on which side of the triangle's plane the corners of another triangle are.
    pub(crate) fn corner_sides(&self, scene: &PairFrame, other: &Self) -> [Ordering; 3] {
        let [a, b, c] = &self.corners;
        std::array::from_fn(|k| scene.side_of_plane(a, b, c, &other.corners[k]))
    }

    /// Returns an axis of the world along which the projection of the triangle has an area, and its orientation.
    pub(crate) fn open_axis(&self, scene: &PairFrame) -> (usize, Ordering) {
        let [a, b, c] = &self.corners;
        let normal = (b.at - a.at).cross(c.at - a.at);
        let normal = scene.frame.transpose() * normal;
        let mut axes = [0, 1, 2];
        axes.sort_by(|&i, &j| normal[j].abs().total_cmp(&normal[i].abs()));
        let about = |k| (k, scene.projected_orientation(k, a, b, c));
        axes.into_iter().map(about).find(|x| x.1 != Ordering::Equal).unwrap_or((0, Ordering::Equal))
    }

    pub(crate) fn is_open(&self) -> bool {
        self.side.solid.is_open(self.index)
    }

    /// Returns the corner of the neighbour across edge `k` that is not on the edge; `None` at a boundary.
    pub(crate) fn corner_across_edge(&self, k: usize) -> Option<PlacedVertex> {
        let solid = self.side.solid;
        let n = solid.neighbours()[self.index][k];
        if n == NO_NEIGHBOUR {
            return None;
        }
        let own = solid.triangles()[self.index];
        let ends = [own[k], own[(k + 1) % 3]];
        let apex = solid.triangles()[n as usize].into_iter().find(|v| !ends.contains(v))?;
        Some(self.side.corner(apex))
    }
}

/// Checks whether a point lies on a triangle, its edges included.
pub(crate) fn lies_on(scene: &PairFrame, point: &impl ExactPoint, triangle: &Triangle) -> bool {
    let [a, b, c] = &triangle.corners;
    let at = Aabb { low: point.query_position(), high: point.query_position() };
    let boxed = triangle.bounds.expanded(4.0 * scene.noise).contains_box(&at);
    if !boxed || scene.side_of_plane(a, b, c, point) != Ordering::Equal {
        return false;
    }
    let (axis, facing) = triangle.open_axis(scene);
    (0..3).all(|k| {
        let (a, b) = (&triangle.corners[k], &triangle.corners[(k + 1) % 3]);
        scene.projected_orientation(axis, a, b, point) != facing.reverse()
    })
}
