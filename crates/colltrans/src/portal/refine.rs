//! From a portal to the lowest face of `M` on the line.
//!
//! Invariant: the three shadows, counter-clockwise, contain the line (decided exactly, with ties broken consistently). Each step asks for
//! the support point along a normal; if it lies below the portal's plane it replaces one of the three, and the
//! height at which the line passes the portal falls. The end: no point of `M` is below the plane by more than rounding error; then the plane
//! proves the lower bound and the portal the upper one.

use glam::{DVec2, DVec3};

use super::{Portal, Tangent, normal_of};
use crate::certificate::VertexPair;
use crate::exact::accurate_det;
use crate::minkowski::{Difference, Point};
use crate::outcome::Steps;

/// The lowest face on the line.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Optimum {
    /// Normal of its plane (shadow frame; height component > 0, any length).
    pub(crate) normal: DVec3,
    /// A pair that is lowest along `normal`.
    pub(crate) lowest: VertexPair,
    /// Three of its points around the line.
    pub(crate) portal: [Point; 3],
    /// Their barycentric weights at the line.
    pub(crate) weights: [f64; 3],
}

/// Bound on the number of portals; reaching it is reported, never hidden.
const MAX_PORTALS: usize = 10_000;

/// Follows portals down to the optimum. `None` if rounding makes them run in a circle.
pub(crate) fn refine(
    difference: &Difference,
    mut portal: Portal,
    steps: &mut Steps,
) -> Option<Optimum> {
    let mut newest = 2;
    for _ in 0..MAX_PORTALS {
        steps.pivots += 1;
        let plane = plane_normal(difference, &portal);
        steps.supports += 1;
        let point = difference.support_from(plane, portal[newest].point.pair);
        if depth_below(&portal, plane, &point) <= difference.noise * plane.length() {
            let weights = weights(&portal);
            let portal = portal.map(|t| t.point);
            return Some(Optimum { normal: plane, lowest: point.pair, portal, weights });
        }
        newest =
            exchange(difference, &mut portal, Tangent { point, slope: plane.truncate() / plane.z });
    }
    None
}

/// How far a point lies below all three of the portal's along `normal`, times the normal's length.
fn depth_below(portal: &Portal, normal: DVec3, point: &Point) -> f64 {
    let depth = |t: &Tangent| normal.dot(t.point.at - point.at);
    depth(&portal[0]).min(depth(&portal[1])).min(depth(&portal[2]))
}

/// Replaces the one point whose exchange keeps the line inside, and says which.
fn exchange(difference: &Difference, portal: &mut Portal, new: Tangent) -> usize {
    let left = [0, 1, 2].map(|i| difference.is_left(&portal[i].point, &new.point));
    // Seen from the new point, the line is inside the triangle with the edge `i -> j` where the sides change.
    for (i, j, k) in [(0, 1, 2), (1, 2, 0), (2, 0, 1)] {
        if !left[i] && left[j] {
            portal[k] = new;
            return k;
        }
    }
    // All on one side: the shadows coincide, and the new point takes the place of the one it lies under.
    let distances = portal.map(|t| -t.point.shadow().distance_squared(new.point.shadow()));
    let same = largest(distances);
    portal[same] = new;
    same
}

/// The upward normal of the plane through the three points, from the two shorter edges, which determine it best.
///
/// A portal lower than the noise has no plane of its own: then the normal through its longest edge that is
/// closest to the slopes of the tangents.
fn plane_normal(difference: &Difference, portal: &Portal) -> DVec3 {
    let [a, b, c] = portal.map(|t| t.point.at);
    let edges = [b - a, c - b, a - c];
    let lengths = edges.map(|e| e.truncate().length_squared());
    let longest = largest(lengths);
    let normal = edges[(longest + 1) % 3].cross(edges[(longest + 2) % 3]);
    let least_height = 8.0 * difference.noise;
    if normal.z > 0.0 && normal.z * normal.z > least_height * least_height * lengths[longest] {
        return normal;
    }
    let edge = edges[longest];
    let slope = (portal[0].slope + portal[1].slope + portal[2].slope) / 3.0;
    let guess = normal_of(slope);
    let square = edge.length_squared();
    let upright = if square > 0.0 { guess - edge * (guess.dot(edge) / square) } else { guess };
    if upright.z > 0.0 { upright } else { guess }
}

/// Barycentric coordinates of the line in the shadow of the portal.
///
/// From determinants without cancellation, so that narrow portals have accurate ones; if the line is outside in the rounded
/// coordinates, those of the nearest point of the rim.
fn weights(portal: &Portal) -> [f64; 3] {
    let shadows = portal.map(|t| t.point.shadow());
    let [a, b, c] = shadows;
    let parts = [accurate_det(b, c), accurate_det(c, a), accurate_det(a, b)];
    let sum = parts[0] + parts[1] + parts[2];
    if sum > 0.0 && parts.iter().all(|&part| part >= 0.0) {
        return parts.map(|part| part / sum);
    }
    let mut nearest = (f64::INFINITY, [1.0, 0.0, 0.0]);
    for (i, j) in [(0, 1), (1, 2), (2, 0)] {
        let along = shadows[j] - shadows[i];
        let square = along.length_squared();
        let share =
            if square > 0.0 { (-shadows[i].dot(along) / square).clamp(0.0, 1.0) } else { 0.0 };
        let distance = (shadows[i] + along * share).length_squared();
        if distance < nearest.0 {
            let mut weights = [0.0; 3];
            (weights[i], weights[j]) = (1.0 - share, share);
            nearest = (distance, weights);
        }
    }
    nearest.1
}

fn largest(weights: [f64; 3]) -> usize {
    if weights[0] >= weights[1] && weights[0] >= weights[2] {
        0
    } else if weights[1] >= weights[2] {
        1
    } else {
        2
    }
}
