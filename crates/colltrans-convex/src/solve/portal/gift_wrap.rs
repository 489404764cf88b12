//! Gift wrapping: finds the neighbour that a plane meets first as it rotates about a vertex or an edge
//! of `M`.
//!
//! Projected along the axis of rotation, the edges that leave a vertex are rays on one side of the
//! plane, which meets them in the order of their angles. In cyclic order of the edges the angle has one
//! maximum and one minimum, because the body's cone projects to a wedge. Therefore a vertex with many
//! neighbours is searched in `O(log n)`. Most planes support the body, so the search starts near the
//! edge that rises least, and mostly ends there.

use std::hint::select_unpredictable;

use glam::{DVec2, DVec3};

use crate::body::{ConvexPolyhedron, MAX_SCANNED_NEIGHBOURS, cyclic_maximum};
use crate::setting::VertexPair;
use crate::setting::minkowski::{MinkowskiDifference, ShadowPoint};

/// Plane that rotates downwards on one side of an axis.
pub(super) struct RotatingPlane {
    /// Normal of the plane (shadow frame, any length).
    pub(super) normal: DVec3,
    /// Vector away from the axis of rotation, in the shadow plane (any length).
    pub(super) outward: DVec2,
}

/// Returns the point of `M` that the plane meets first: the neighbour of `vertex`, which is on the axis,
/// with the smallest ratio of rise to run. `None` if no neighbour lies beyond the axis.
#[inline]
pub(super) fn first_vertex_met(
    difference: &MinkowskiDifference,
    vertex: &ShadowPoint,
    plane: &RotatingPlane,
) -> Option<ShadowPoint> {
    let [moving, fixed] = vertex.pair.indices();
    let setting = difference.setting;
    let (normal, outward) = (plane.normal, plane.outward.extend(0.0));
    // A neighbour nearer to the axis than this is not beyond it.
    let least = difference.touching_distance() * plane.outward.length();
    let rotation = BodyRotation {
        up: -difference.to_moving_frame(normal),
        out: -difference.to_moving_frame(outward),
        least,
    };
    let p = rotation.first_neighbour(setting.moving, moving);
    let rotation = BodyRotation {
        up: difference.to_fixed_frame(normal),
        out: difference.to_fixed_frame(outward),
        least,
    };
    let q = rotation.first_neighbour(setting.fixed, fixed);
    let of_fixed = q.rise * p.run < p.rise * q.run;
    let found = if of_fixed { q.vertex } else { p.vertex };
    if found == NO_VERTEX {
        return None;
    }
    let moving = select_unpredictable(of_fixed, moving, found);
    let fixed = select_unpredictable(of_fixed, found, fixed);
    Some(difference.vertex_point(VertexPair::from_indices(moving, fixed)))
}

/// Rotation of a plane in the frame of one body. `up` measures the rise of an edge and `out` its run.
struct BodyRotation {
    up: DVec3,
    out: DVec3,
    /// Minimum run.
    least: f64,
}

/// First neighbour that a rotating plane meets.
struct FirstNeighbour {
    vertex: u32,
    rise: f64,
    run: f64,
}

/// Marks that no neighbour is beyond the axis.
const NO_VERTEX: u32 = u32::MAX;

impl BodyRotation {
    /// Returns the first of the neighbours of one body's vertex, or `NO_VERTEX` if none lies beyond the axis.
    #[inline]
    #[expect(clippy::needless_bitwise_bool, reason = "a branch here is not predictable")]
    fn first_neighbour(&self, body: &ConvexPolyhedron, vertex: u32) -> FirstNeighbour {
        let here = body.vertices()[vertex as usize];
        let neighbours = body.neighbours(vertex);
        if neighbours.len() > MAX_SCANNED_NEIGHBOURS {
            return self.first_of_fan(body, vertex, neighbours);
        }
        let mut first = FirstNeighbour { vertex: NO_VERTEX, rise: f64::INFINITY, run: 1.0 };
        for &w in neighbours {
            let edge = body.vertices()[w as usize] - here;
            let (rise, run) = (self.up.dot(edge), self.out.dot(edge));
            let is_earlier = (run > self.least) & (rise * first.run < first.rise * run);
            first.vertex = select_unpredictable(is_earlier, w, first.vertex);
            first.rise = select_unpredictable(is_earlier, rise, first.rise);
            first.run = select_unpredictable(is_earlier, run, first.run);
        }
        first
    }

    /// Returns the first of many neighbours by a search in their cyclic order.
    #[cold]
    #[inline(never)]
    fn first_of_fan(
        &self,
        body: &ConvexPolyhedron,
        vertex: u32,
        neighbours: &[u32],
    ) -> FirstNeighbour {
        let here = body.vertices()[vertex as usize];
        let ahead = |i: usize| {
            let edge = body.vertices()[neighbours[i] as usize] - here;
            (self.up.dot(edge), self.out.dot(edge))
        };
        // Decreases as the angle grows. Edges that are not beyond the axis have values of at most -1, and
        // an edge on the axis, which has no angle, -2.
        let precedence = |i: usize| {
            let (rise, run) = ahead(i);
            let size = run.abs() + rise.abs();
            if run > self.least { -rise / size } else { (rise.abs() / size - 2.0).max(-2.0) }
        };
        let near = body.steepest_edge_position(vertex, -self.up);
        let i = cyclic_maximum(neighbours.len(), near, precedence);
        let (rise, run) = ahead(i);
        if run > self.least {
            FirstNeighbour { vertex: neighbours[i], rise, run }
        } else {
            FirstNeighbour { vertex: NO_VERTEX, rise: f64::INFINITY, run: 1.0 }
        }
    }
}
