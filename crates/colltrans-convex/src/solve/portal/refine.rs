//! From a portal to the lowest face of `M` on the line.
//!
//! Invariant: the three shadows, counter-clockwise, contain the line (decided exactly, with ties
//! broken consistently). Each step asks for the support point along a normal; if it lies below the
//! portal's plane it replaces one of the three, and the height at which the line passes the portal
//! falls. The end: no point of `M` is below the plane by more than rounding error; then the plane
//! proves the lower bound and the portal the upper one.
//!
//! Narrow portals. Shadows within what counts as touching of one straight line (upright faces, ties
//! within rounding) have a rounded plane that may be far from the exact one, and yet serves: no exact
//! corner is off it by more than a noise, so the portal proves the upper bound of what this plane
//! proves the lower one of. Where rounding has turned the portal over, its exact plane is nearly
//! upright, and what lies beyond the upright one lies below it. In narrow portals the line may pass the
//! rim of `M`, beyond which there is nothing: that is asked first.

use glam::DVec3;

use super::enclose::{SeparatingLine, nearest_share};
use super::overlap::{Overlap, overlap};
use super::plane::{Face, Plane};
use super::{Context, Known, Portal};
use crate::setting::VertexPair;
use crate::setting::minkowski::{MinkowskiDifference, Point};
use crate::solve::observe::{Observer, Support};
use colltrans_kernel::determinant::accurate_det;
use colltrans_kernel::plane::triangle_normal;

/// More portals than any body needs: then ties within rounding error keep following each other, and
/// points below the plane by less than what counts as touching are taken to lie on it.
const LONG: usize = 200;

/// Bound on the number of portals; reaching it is reported, never hidden.
pub(crate) const MAX_PORTALS: usize = 10_000;

/// Bound on the narrow ones, of which five are the most that was seen: more run in a circle, which
/// another frame breaks.
const MAX_NARROW: usize = 32;

/// What following portals ends with.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Refined {
    /// The lowest face.
    Lowest(Face),
    /// The line passes the rim of the shadow of `M`.
    Rim(SeparatingLine),
}

/// A portal as a face, if it is seen to be in the lowest: as it is after gift wrapping, and mostly if it
/// was followed.
#[inline(always)]
#[expect(clippy::inline_always, reason = "passed through memory it stalls its reader")]
pub(crate) fn face<O: Observer>(context: &mut Context<O>, portal: &Portal) -> Option<Face> {
    let normal = plane_normal(&context.difference, portal)?;
    let plane = Plane::at(&context.difference, normal, portal[2].pair)?;
    context.watch.portal(|| portal.map(|p| p.at));
    context.watch.support(|| Support::of(normal, &context.difference.vertex(plane.lowest)));
    Some(Face { plane, weights: weights(portal) })
}

/// Follows portals down to the optimum, and leaves the last one in place of the first. `None` if
/// there are more than `most`, for one because rounding makes them run in a circle.
#[inline]
pub(crate) fn refine<O: Observer>(
    context: &mut Context<O>,
    portal: &mut Portal,
    most: usize,
) -> Option<Refined> {
    let mut newest = 2;
    let mut narrow = 0;
    for round in 0..most {
        context.watch.portal(|| portal.map(|p| p.at));
        let plane = match plane_normal(&context.difference, portal) {
            Some(plane) => plane,
            None if narrow == MAX_NARROW => return None,
            None => {
                if narrow == 0
                    && let Some(rim) = rim(context, portal)
                {
                    return Some(Refined::Rim(rim));
                }
                narrow += 1;
                narrow_plane_normal(portal)
            }
        };
        let point = context.difference.support_from(plane, portal[newest].pair);
        context.watch.support(|| Support::of(plane, &point));
        let rounding = context.difference.noise.plane(round >= LONG);
        let below = match lowest(&context.difference, portal, plane, point, rounding) {
            Err(point) => point,
            // An upright plane bounds nothing.
            Ok(_) if plane.z == 0.0 => return None,
            Ok(plane) => return Some(Refined::Lowest(Face { plane, weights: weights(portal) })),
        };
        newest = exchange(&context.difference, portal, below);
    }
    None
}

/// The plane of a portal, if no point of `M` lies below it by more than rounding, given the support
/// point that a climb has found; else a point that does.
#[inline]
fn lowest(
    difference: &MinkowskiDifference,
    portal: &Portal,
    normal: DVec3,
    found: Point,
    rounding: f64,
) -> Result<Plane, Point> {
    if is_below(portal, normal, &found, rounding) {
        return Err(found);
    }
    settled(difference, portal, normal, found.pair, rounding)
}

/// The same of a support point that does not lie below the portal; the climb to it may have stuck.
#[inline]
fn settled(
    difference: &MinkowskiDifference,
    portal: &Portal,
    normal: DVec3,
    found: VertexPair,
    rounding: f64,
) -> Result<Plane, Point> {
    let plane = Plane::of(difference, normal, found);
    if plane.lowest == found {
        return Ok(plane);
    }
    let point = difference.point(plane.lowest, normal);
    if is_below(portal, normal, &point, rounding) { Err(point) } else { Ok(plane) }
}

/// What is known of a portal through which the line passes with these weights, and of a plane across
/// `normal` at a support point: that it is lowest, if nothing lies below it.
#[inline]
pub(super) fn known_at(
    difference: &MinkowskiDifference,
    portal: &Portal,
    normal: DVec3,
    found: VertexPair,
    weights: [f64; 3],
) -> Known {
    let rounding = difference.noise.plane(false);
    match settled(difference, portal, normal, found, rounding) {
        Ok(plane) => Known::Lowest(Face { plane, weights }),
        Err(_) => Known::Around,
    }
}

/// Whether a point lies below a portal by more than rounding.
#[inline]
pub(super) fn is_below(portal: &Portal, normal: DVec3, point: &Point, rounding: f64) -> bool {
    depth_below(portal, normal, point) > rounding * normal.length()
}

/// The rim of the shadow of `M`, if the line passes it.
fn rim<O: Observer>(context: &mut Context<O>, portal: &Portal) -> Option<SeparatingLine> {
    match overlap(context, portal, context.difference.touching()) {
        Overlap::Slight { inward, depth, point } => {
            Some(SeparatingLine { normal: inward, margin: -depth, point, end: point.pair })
        }
        Overlap::Ample => None,
    }
}

/// How far a point lies below all three of the portal's along `normal`, times the normal's length.
#[inline]
pub(super) fn depth_below(portal: &Portal, normal: DVec3, point: &Point) -> f64 {
    let depth = |corner: &Point| normal.dot(corner.at - point.at);
    depth(&portal[0]).min(depth(&portal[1])).min(depth(&portal[2]))
}

/// Replaces the one point whose exchange keeps the line inside, and says which.
pub(super) fn exchange(difference: &MinkowskiDifference, portal: &mut Portal, new: Point) -> usize {
    let left = |i: usize| difference.is_left(&portal[i], &new);
    let (first, second) = (left(0), left(1));
    // Seen from the new point, the line is inside the triangle with the edge `i -> j` where the
    // sides change from right to left; the third point goes.
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
    // All on one side: the shadows coincide, and the new point takes the place of the one it lies
    // under.
    let distances = portal.map(|p| -p.shadow().distance_squared(new.shadow()));
    let same = largest(distances);
    portal[same] = new;
    same
}

/// The upward normal of the plane through the three points; `None` if the portal is too narrow to
/// have one.
#[inline]
pub(super) fn plane_normal(difference: &MinkowskiDifference, portal: &Portal) -> Option<DVec3> {
    let normal = triangle_normal(portal.map(|p| p.at));
    is_wide(difference, portal, normal.z).then_some(normal)
}

/// The same of a narrow portal's rounded corners; lateral if rounding has turned them over.
fn narrow_plane_normal(portal: &Portal) -> DVec3 {
    let own = triangle_normal(portal.map(|p| p.at));
    if own.z > 0.0 {
        own
    } else if own.truncate().length_squared() > 0.0 {
        own.with_z(0.0)
    } else {
        DVec3::X
    }
}

/// Whether a portal, with twice this area, is wider than what counts as touching.
#[inline]
pub(super) fn is_wide(difference: &MinkowskiDifference, portal: &Portal, area: f64) -> bool {
    let [a, b, c] = portal.each_ref().map(Point::shadow);
    let longest = (b - a).length_squared().max((c - b).length_squared());
    let longest = longest.max((a - c).length_squared());
    let least = difference.touching();
    area > 0.0 && area * area > least * least * longest
}

/// Barycentric coordinates of the line in the shadow of the portal.
///
/// From determinants without cancellation, so that narrow portals have accurate ones; if the line
/// is outside in the rounded coordinates, those of the nearest point of the rim.
#[inline]
pub(super) fn weights(portal: &Portal) -> [f64; 3] {
    let shadows = portal.map(|p| p.shadow());
    let [a, b, c] = shadows;
    let parts = [accurate_det(b, c), accurate_det(c, a), accurate_det(a, b)];
    let sum = parts[0] + parts[1] + parts[2];
    if sum > 0.0 && parts.iter().all(|&part| part >= 0.0) {
        return parts.map(|part| part / sum);
    }
    let mut nearest = (f64::INFINITY, [1.0, 0.0, 0.0]);
    for (i, j) in [(0, 1), (1, 2), (2, 0)] {
        let along = shadows[j] - shadows[i];
        let share = nearest_share([shadows[i], shadows[j]]);
        let distance = (shadows[i] + along * share).length_squared();
        if distance < nearest.0 {
            let mut weights = [0.0; 3];
            (weights[i], weights[j]) = (1.0 - share, share);
            nearest = (distance, weights);
        }
    }
    nearest.1
}

pub(super) fn largest(values: [f64; 3]) -> usize {
    if values[0] >= values[1] && values[0] >= values[2] {
        0
    } else if values[1] >= values[2] {
        1
    } else {
        2
    }
}
