//! Distances of rounded bodies, from those of their cores: `d - R` if `d > R`, otherwise 0, where `R` is the sum of the
//! radii and `d` the distance of the cores.

use glam::DVec3;

use crate::answer::{NearPoints, PlaneGap};
use crate::body::VertexHull;
use crate::setting::TwoBodies;

/// Lowers the upper bound of a distance of cores by both radii. Changes nothing if no body is rounded.
#[inline]
pub(super) fn near_points(bodies: &TwoBodies, near: NearPoints) -> NearPoints {
    NearPoints { distance: bodies.distance_less_radii(near.distance), ..near }
}

/// Lowers the gap of a plane between cores by both radii. Changes nothing if no body is rounded.
#[inline]
pub(super) fn plane_gap(bodies: &TwoBodies, plane: PlaneGap) -> PlaneGap {
    PlaneGap { gap: bodies.less_radii(plane.gap), ..plane }
}

/// Returns the nearest points of bodies from those of their cores, in the world: one point of both bodies if a body is
/// rounded and their `distance` is 0. `normal` replaces the direction between the points if they coincide.
#[inline]
pub fn surface_points<B: VertexHull>(
    bodies: &TwoBodies<'_, B>,
    cores: [DVec3; 2],
    distance: f64,
    normal: DVec3,
) -> [DVec3; 2] {
    let [on_moving, on_fixed] = bodies.surface_points(cores, DVec3::ZERO, normal);
    if distance == 0.0 && bodies.is_rounded() {
        // The point of the segment between the cores' points that is nearest to the middle of the surface points.
        let [p, q] = cores;
        [on_moving.midpoint(on_fixed).clamp(p.min(q), p.max(q)); 2]
    } else {
        [on_moving, on_fixed]
    }
}
