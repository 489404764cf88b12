//! Refines a portal to the lowest face of `M` on the line, in steps of Snethen's portal refinement (narrow portals:
//! `docs/theory/portals.md`).
//!
//! - *Invariant*: the three shadows contain the line, counter-clockwise. This is decided exactly, with ties broken
//!   consistently.
//! - *Step*: a support point along the portal's normal that lies below its plane replaces one of the three points.
//!   The height at which the line crosses the portal never rises. It falls unless the line passes a kept edge.
//! - *End*: no point of `M` lies below the plane by more than rounding error. Then the plane proves the lower bound,
//!   and the portal the upper one.
//!
//! A portal is *narrow* if a straight line passes its three shadows within the touching distance.

use glam::DVec3;

use super::enclose::{SeparatingLine, nearest_parameter};
use super::overlap::{Overlap, overlap};
use super::plane::{Face, Plane};
use super::{Context, Portal, PortalStatus};
use crate::setting::VertexPair;
use crate::setting::minkowski::{MinkowskiDifference, ShadowPoint};
use crate::solve::observe::{Observer, Support};
use colltrans_kernel::determinant::accurate_det;
use colltrans_kernel::plane::triangle_normal;

/// Number of portals after which exchanges are assumed to cycle through ties, more than any body needs.
/// From then on, points below the plane by at most the touching distance count as lying on it.
const TIES_AFTER: usize = 200;

/// Maximum number of portals. A refinement that reaches it returns `None`; the cast fails with an error if
/// this happens in all frames.
pub(crate) const MAX_PORTALS: usize = 10_000;

/// Maximum number of narrow portals in a refinement; at most five have been observed. A refinement with more is
/// assumed to cycle, and the cast is repeated, in a rotated frame if it started from scratch.
const MAX_NARROW: usize = 32;

/// Result of refinement.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Refined {
    /// The lowest face on the line.
    Lowest(Face),
    /// The line touches the silhouette of `M`, or passes outside of it.
    Silhouette(SeparatingLine),
}

/// Returns the face of a portal if its plane is shown to support `M`. This is the case after gift
/// wrapping, and mostly after a walk from an earlier portal.
///
/// `None` if the portal is narrow, or its third corner is not shown to be a support point.
#[inline(always)]
#[expect(clippy::inline_always, reason = "a copy through memory stalls its reader")]
pub(crate) fn supported_face<O: Observer>(
    context: &mut Context<O>,
    portal: &Portal,
) -> Option<Face> {
    let normal = portal_normal(&context.difference, portal)?;
    let plane = Plane::if_supported_at(&context.difference, normal, portal[2].pair)?;
    context.watch.portal(|| portal.map(|p| p.coordinates));
    context
        .watch
        .support(|| Support::from_point(normal, &context.difference.vertex_point(plane.lowest)));
    Some(Face { plane, weights: line_weights(portal) })
}

/// Exchanges corners of `portal` until its plane supports `M`.
///
/// `None` after `most` portals or `MAX_NARROW` narrow ones, for example because rounding makes them cycle,
/// or if the plane that supports `M` is vertical.
#[inline]
pub(crate) fn refine<O: Observer>(
    context: &mut Context<O>,
    portal: &mut Portal,
    most: usize,
) -> Option<Refined> {
    let mut newest = 2;
    let mut narrow = 0;
    for round in 0..most {
        context.watch.portal(|| portal.map(|p| p.coordinates));
        let plane = match portal_normal(&context.difference, portal) {
            Some(plane) => plane,
            None if narrow == MAX_NARROW => return None,
            None => {
                if narrow == 0
                    && let Some(line) = silhouette(context, portal)
                {
                    return Some(Refined::Silhouette(line));
                }
                narrow += 1;
                narrow_portal_normal(portal)
            }
        };
        let point = context.difference.support_point_from(plane, portal[newest].pair);
        context.watch.support(|| Support::from_point(plane, &point));
        let rounding = context.difference.noise.plane_tolerance(round >= TIES_AFTER);
        let below = match plane_or_lower_point(&context.difference, portal, plane, point, rounding)
        {
            Err(point) => point,
            // A vertical plane proves no lower bound.
            Ok(_) if plane.z == 0.0 => return None,
            Ok(plane) => {
                return Some(Refined::Lowest(Face { plane, weights: line_weights(portal) }));
            }
        };
        newest = exchange(&context.difference, portal, below);
    }
    None
}

/// Returns the plane of a portal, if no point of `M` lies below it by more than rounding error, or
/// else such a point as the error. `found` is the support point at which a climb stopped.
#[inline]
fn plane_or_lower_point(
    difference: &MinkowskiDifference,
    portal: &Portal,
    normal: DVec3,
    found: ShadowPoint,
    rounding: f64,
) -> Result<Plane, ShadowPoint> {
    if is_below(portal, normal, &found, rounding) {
        return Err(found);
    }
    verified_plane(difference, portal, normal, found.pair, rounding)
}

/// Verifies a support point that does not lie below the portal, because the climb to it may have
/// stopped short. Returns a point below the portal as the error, if there is one.
#[inline]
fn verified_plane(
    difference: &MinkowskiDifference,
    portal: &Portal,
    normal: DVec3,
    found: VertexPair,
    rounding: f64,
) -> Result<Plane, ShadowPoint> {
    let plane = Plane::at_support(difference, normal, found);
    if plane.lowest == found {
        return Ok(plane);
    }
    let point = difference.widened_point(plane.lowest, normal);
    if is_below(portal, normal, &point, rounding) { Err(point) } else { Ok(plane) }
}

/// Returns [`PortalStatus::Lowest`] if `found` is verified as the support pair along `normal`, or if the support point
/// found instead does not lie below the portal by more than rounding error. Otherwise returns
/// [`PortalStatus::EnclosesLine`].
///
/// `found` is the pair of a corner of the portal. `weights` are those of the line in the portal.
#[inline]
pub(super) fn status_at_support(
    difference: &MinkowskiDifference,
    portal: &Portal,
    normal: DVec3,
    found: VertexPair,
    weights: [f64; 3],
) -> PortalStatus {
    let rounding = difference.noise.plane_tolerance(false);
    match verified_plane(difference, portal, normal, found, rounding) {
        Ok(plane) => PortalStatus::Lowest(Face { plane, weights }),
        Err(_) => PortalStatus::EnclosesLine,
    }
}

/// Checks whether a point lies below a portal along `normal` by more than rounding error.
#[inline]
pub(super) fn is_below(portal: &Portal, normal: DVec3, point: &ShadowPoint, rounding: f64) -> bool {
    depth_below(portal, normal, point) > rounding * normal.length()
}

/// Returns the separating line at the silhouette of `M`, if the line `t d` is within the touching
/// distance of the silhouette. `None` if the overlap of the shadows exceeds this distance.
fn silhouette<O: Observer>(context: &mut Context<O>, portal: &Portal) -> Option<SeparatingLine> {
    match overlap(context, portal, context.difference.touching_distance()) {
        Overlap::Slight { inward, depth, point } => {
            Some(SeparatingLine { normal: inward, margin: -depth, point, end: point.pair })
        }
        Overlap::Ample => None,
    }
}

/// Returns the depth of a point below the lowest corner of the portal along `normal`, times the length
/// of `normal`.
#[inline]
pub(super) fn depth_below(portal: &Portal, normal: DVec3, point: &ShadowPoint) -> f64 {
    let depth = |corner: &ShadowPoint| normal.dot(corner.coordinates - point.coordinates);
    depth(&portal[0]).min(depth(&portal[1])).min(depth(&portal[2]))
}

/// Replaces the corner whose exchange keeps the line inside the portal, and returns its index.
pub(super) fn exchange(
    difference: &MinkowskiDifference,
    portal: &mut Portal,
    new: ShadowPoint,
) -> usize {
    let left = |i: usize| difference.is_left(&portal[i], &new);
    let (first, second) = (left(0), left(1));
    // Seen from the new point, the line is in the triangle with the edge `i -> j` where the sides
    // change from right to left. The third point is replaced.
    let gone = match (first, second) {
        (false, true) => Some(2),
        (true, false) => Some(usize::from(!left(2))),
        (false, false) => left(2).then_some(0),
        (true, true) => (!left(2)).then_some(1),
    };
    if let Some(k) = gone {
        portal[k] = new;
        return k;
    }
    // All are on one side because the shadows coincide. The new point replaces the one above it.
    let distances = portal.map(|p| -p.shadow().distance_squared(new.shadow()));
    let same = index_of_largest(distances);
    portal[same] = new;
    same
}

/// Returns the upward normal of the plane through the three points. `None` if the portal is too narrow
/// to have a plane.
#[inline]
pub(super) fn portal_normal(difference: &MinkowskiDifference, portal: &Portal) -> Option<DVec3> {
    let normal = triangle_normal(portal.map(|p| p.coordinates));
    is_wide(difference, portal, normal.z).then_some(normal)
}

/// Returns the normal of a narrow portal from its rounded corners. It is lateral if rounding has
/// inverted the portal, and `X` if the corners have no plane.
fn narrow_portal_normal(portal: &Portal) -> DVec3 {
    let own = triangle_normal(portal.map(|p| p.coordinates));
    if own.z > 0.0 {
        own
    } else if own.truncate().length_squared() > 0.0 {
        own.with_z(0.0)
    } else {
        DVec3::X
    }
}

/// Checks whether a portal is wider than the touching distance. `area` is twice the area of its shadow.
#[inline]
pub(super) fn is_wide(difference: &MinkowskiDifference, portal: &Portal, area: f64) -> bool {
    let [a, b, c] = portal.each_ref().map(ShadowPoint::shadow);
    let longest = (b - a).length_squared().max((c - b).length_squared());
    let longest = longest.max((a - c).length_squared());
    let least = difference.touching_distance();
    area > 0.0 && area * area > least * least * longest
}

/// Returns the barycentric coordinates of the line in the shadow of the portal.
///
/// The coordinates are accurate for narrow portals, because the determinants are computed without cancellation.
/// If the line is outside in rounded coordinates, returns those of the nearest boundary point.
#[inline]
pub(super) fn line_weights(portal: &Portal) -> [f64; 3] {
    let shadows = portal.map(|p| p.shadow());
    let [a, b, c] = shadows;
    let areas = [accurate_det(b, c), accurate_det(c, a), accurate_det(a, b)];
    let sum = areas[0] + areas[1] + areas[2];
    if sum > 0.0 && areas.iter().all(|&area| area >= 0.0) {
        return areas.map(|area| area / sum);
    }
    let mut nearest = (f64::INFINITY, [1.0, 0.0, 0.0]);
    for (i, j) in [(0, 1), (1, 2), (2, 0)] {
        let along = shadows[j] - shadows[i];
        let share = nearest_parameter([shadows[i], shadows[j]]);
        let distance = (shadows[i] + along * share).length_squared();
        if distance < nearest.0 {
            let mut weights = [0.0; 3];
            (weights[i], weights[j]) = (1.0 - share, share);
            nearest = (distance, weights);
        }
    }
    nearest.1
}

/// Returns the index of the largest value, the first one of equal values.
pub(super) fn index_of_largest(values: [f64; 3]) -> usize {
    if values[0] >= values[1] && values[0] >= values[2] {
        0
    } else if values[1] >= values[2] {
        1
    } else {
        2
    }
}
