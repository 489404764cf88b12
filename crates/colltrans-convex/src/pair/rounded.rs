//! Answers about rounded bodies, from those about their cores.
//!
//! With `R`, the sum of the radii, and `d`, the distance of the cores:
//!
//! - Distance: `d - R` if `d > R`, otherwise 0.
//! - Depth: `R - d` if the cores are apart (`0 <= d <= R`), `R` plus the depth of the cores if they overlap.
//!   Both hold because the boundary of `M + B(R)` is at the distance `R` from the convex set `M`.

use glam::DVec3;

use super::convex::{MAX_BOUND_GAP, core_depth};
use super::verify::depth_by_points;
use crate::answer::{Depth, Distance, Enclosure, NearPoints, PlaneGap};
use crate::body::VertexHull;
use crate::setting::TwoBodies;
use crate::setting::error::{QueryError, Stalled};
use crate::solve::nearest::{Difference, NearestPairs, nearest_points};

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

/// Returns the distance of rounded bodies, from that of their cores.
pub(super) fn distance(bodies: &TwoBodies, cores: Distance) -> Distance {
    let gap = cores.gap.map(|plane| plane_gap(bodies, plane)).filter(|plane| plane.gap > 0.0);
    let near = near_points(bodies, cores.near);
    let points = [cores.on_moving, cores.on_fixed];
    let [on_moving, on_fixed] = surface_points(bodies, points, near.distance, cores.normal);
    Distance {
        lower: gap.map_or(0.0, |plane| plane.gap),
        upper: near.distance,
        on_moving,
        on_fixed,
        normal: gap.map(|plane| plane.normal),
        features: cores.features.filter(|_| gap.is_some()),
        near,
        gap,
        steps: cores.steps,
    }
}

/// Returns the nearest points of rounded bodies from those of their cores, in the world: one point of both bodies if
/// their `distance` is 0. `normal` replaces the direction between the points if that is not defined.
pub fn surface_points<B: VertexHull>(
    bodies: &TwoBodies<'_, B>,
    cores: [DVec3; 2],
    distance: f64,
    normal: Option<DVec3>,
) -> [DVec3; 2] {
    let between = cores[1] - cores[0];
    let normal = between.try_normalize().or(normal).unwrap_or(DVec3::ZERO);
    if distance == 0.0 {
        [common_point(bodies, cores[0], between.length(), normal); 2]
    } else {
        bodies.surface_points(cores, normal)
    }
}

/// Returns a point of both bodies, on the segment from the point `on_moving` of the moving core along `normal` to a
/// point of the fixed core at `distance`.
fn common_point<B: VertexHull>(
    bodies: &TwoBodies<'_, B>,
    on_moving: DVec3,
    distance: f64,
    normal: DVec3,
) -> DVec3 {
    let difference = bodies.moving.radius() - bodies.fixed.radius();
    on_moving + normal * (0.5 * (distance + difference)).clamp(0.0, distance)
}

/// Computes the penetration depth of rounded bodies. See [`Pair::depth_until`](super::Pair::depth_until).
///
/// # Errors
/// Returns the errors of the search for the depth of the cores.
pub(super) fn depth(bodies: &TwoBodies, enough: f64) -> Result<Depth, QueryError> {
    let [least, most] = bodies.core_gap_bounds(0.0);
    let difference = Difference::new(bodies);
    let found = nearest_points(&difference, &NearestPairs::default(), None);
    let steps = found.steps();
    if let Some(plane) = found.gap_plane(&difference).filter(|plane| plane.gap.gap > 0.0) {
        // The cores are apart.
        let direction = -plane.gap.normal;
        let upper = (most - plane.gap.gap).next_up().max(0.0);
        let near = found.near_points(&difference);
        let lower = depth_by_points(bodies, &near).unwrap_or(0.0);
        let lower = if upper == 0.0 { 0.0 } else { lower };
        let tolerance = MAX_BOUND_GAP * difference.noise.point_error() + plane.excess;
        if lower <= enough && upper - lower > tolerance + 8.0 * f64::EPSILON * most {
            let reason = Stalled::Distance { lower, upper, tolerance };
            return Err(QueryError::NotConverged { reason });
        }
        let near = (lower > 0.0).then(|| near_points(bodies, near));
        return Ok(Depth { lower, upper, direction, enclosure: Enclosure::default(), near, steps });
    }
    let cores = core_depth(bodies, enough - least)?;
    let upper = (cores.upper + most).next_up();
    if cores.lower > 0.0 {
        return Ok(Depth { lower: (cores.lower + least).next_down(), upper, ..cores });
    }
    let near = found.near_points(&difference);
    let lower = depth_by_points(bodies, &near).unwrap_or(0.0);
    let near = (lower > 0.0).then(|| near_points(bodies, near));
    Ok(Depth { lower, upper, near, ..cores })
}
