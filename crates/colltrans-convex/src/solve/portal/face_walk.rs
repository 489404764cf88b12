//! Face walk: from an earlier portal or a guessed normal to the face of `M` that the line pierces. The paper names the
//! former as future work (section V-F).
//!
//! - *Earlier portal*: its three vertex pairs are still points of `M`, in any poses.
//! - *Shift*: today's shadow of the earlier contact point, computed with the same weights over the pairs. The contact
//!   point was on the line; therefore the shift is due to the change of poses and direction.
//!
//! If the line has left the triangle over an edge, gift wrapping finds the face of `M` beyond that edge. If the line
//! is many faces away, the walk continues at the support point along a slope that the shift and the curvature of the
//! inertia ellipsoids predict. All this is heuristic, because the earlier triangle need not be a face of `M` any
//! more. Refinement accepts any three points of `M` around the line.

use glam::{DVec2, DVec3};

use super::coplanar::{CoplanarStep, cross_face, has_polygonal_faces};
use super::edge::{Edge, line_position, line_position_after_crossing};
use super::gift_wrap::first_vertex_met;
use super::normal_guess::{predicted_slope, slope_per_shadow};
use super::ties::{AdjacentFace, VertexCase, adjacent_face, classify_vertex};
use super::{Context, LinePosition, NormalGuess, Portal, PortalStatus, normal_of};
use crate::setting::VertexPair;
use crate::setting::minkowski::MinkowskiDifference;
use crate::solve::observe::Observer;

/// Result of a face walk.
#[derive(Debug, Clone, Copy)]
pub(crate) enum WalkResult {
    /// A portal around the line, and how much is proven about it.
    Portal(Portal, PortalStatus),
    /// Nothing of `M` seems to lie beyond an edge. Contains its outward normal in the shadow plane (any
    /// length), and the vertex pairs of its ends, or one pair near it twice.
    Silhouette { outward: DVec2, edge: [VertexPair; 2] },
    /// No portal was found, for example because the line is too far away.
    Lost,
}

/// Maximum number of faces crossed from a guess. Beyond that, enclosing the line is faster (measured).
const MAX_CROSSINGS: usize = 20;

/// Maximum number of faces crossed from an earlier portal. Beyond that, a cast from scratch is faster
/// (measured).
const MAX_CROSSINGS_FROM_LAST: usize = 8;

/// Distance of the line beyond an edge, in widths of the triangle, above which crossing faces one at a
/// time does not reach it (measured).
const MAX_WALK_WIDTHS: f64 = 1.2;

/// Distance in the same unit above which the support tables of both bodies find the next vertex faster
/// than a hill climb (measured).
const MAX_CLIMB_WIDTHS: f64 = 4.0;

/// Where the line met `M` in an earlier cast.
///
/// The order of the fields matters for speed. Behind the tag of an enum, fields of eight bytes are
/// written once if they are first, and twice if not.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub(crate) struct ContactPortal {
    /// Contact normal in the frames of the moving and of the fixed body.
    pub(crate) normals: [DVec3; 2],
    /// Barycentric weights of the contact point in the portal.
    pub(crate) weights: [f64; 3],
    /// Vertex pairs of the portal.
    pub(crate) pairs: [VertexPair; 3],
}

/// Walks from the portal of an earlier cast to the line. Returns [`WalkResult::Lost`] if the bodies have moved
/// too far since.
#[inline]
pub(crate) fn walk_from_last<O: Observer>(
    context: &mut Context<O>,
    last: &ContactPortal,
) -> WalkResult {
    let [a, b, c] = last.pairs;
    let mut portal = [
        context.difference.vertex_point(a),
        context.difference.vertex_point(b),
        context.difference.vertex_point(c),
    ];
    let [a, b, c] = portal.map(|p| p.shadow());
    if (b - a).perp_dot(c - a) < 0.0 {
        portal.swap(0, 1);
    }
    let mut edge = match line_position(context, &portal) {
        LinePosition::BeyondEdge(from) => Edge::from_corner(&portal, from),
        LinePosition::Inside(status) => return WalkResult::Portal(portal, status),
    };
    let shift = a * last.weights[0] + b * last.weights[1] + c * last.weights[2];
    let Some(slopes) = current_slopes(&context.difference, last, shift) else {
        return WalkResult::Lost;
    };
    if edge.scaled_distance() > MAX_WALK_WIDTHS * edge.scaled_width() {
        let slope = predicted_slope(&context.difference, shift, slopes);
        let climbs = edge.scaled_distance() <= MAX_CLIMB_WIDTHS * edge.scaled_width();
        match adjacent_face_along(context, slope, climbs.then_some(last.pairs[0])) {
            Some(AdjacentFace::Edge(portal, found)) => {
                return WalkResult::Portal(portal, PortalStatus::Lowest(found));
            }
            Some(AdjacentFace::Face(adjacent)) => portal = adjacent,
            None => return WalkResult::Lost,
        }
        match line_position_after_crossing(context, &portal) {
            LinePosition::BeyondEdge(from) => edge = Edge::from_corner(&portal, from),
            LinePosition::Inside(status) => return WalkResult::Portal(portal, status),
        }
    }
    walk_to_line(context, edge, MAX_CROSSINGS_FROM_LAST)
}

/// Walks over the faces of `M` to the one that the line pierces. Starts by crossing `edge`, and crosses
/// at most `most` edges.
#[inline(never)]
fn walk_to_line<O: Observer>(context: &mut Context<O>, mut edge: Edge, most: usize) -> WalkResult {
    for _ in 0..most {
        context
            .watch
            .portal(|| [edge.from.coordinates, edge.to.coordinates, edge.third.coordinates]);
        let Some(plane) = edge.rotating_plane() else { return WalkResult::Lost };
        // The line is on the left of the crossed edge, taken in reverse.
        let Some(point) = first_vertex_met(&context.difference, &edge.from, &plane) else {
            let ends = [edge.from.pair, edge.to.pair];
            return WalkResult::Silhouette { outward: plane.outward, edge: ends };
        };
        let portal = [edge.to, edge.from, point];
        match line_position_after_crossing(context, &portal) {
            LinePosition::BeyondEdge(from) => edge = Edge::from_corner(&portal, from),
            LinePosition::Inside(status) => return WalkResult::Portal(portal, status),
        }
    }
    WalkResult::Lost
}

/// Limits of a face walk from a guess.
pub(crate) struct WalkLimits {
    /// Maximum number of corrections of the guess by the curvature of the ellipsoids.
    corrections: usize,
    /// Maximum distance of the line beyond an edge, in widths of the triangle, at which a walk may begin at this
    /// edge. It begins at the last such edge found, before or after a correction. From farther away, enclosing the line
    /// is faster.
    widths: f64,
    /// Maximum number of faces of `M` crossed. Beyond that, enclosing the line is faster.
    crossings: usize,
}

/// Limits for a guess from ellipsoids (measured).
pub(crate) const ELLIPSOID_LIMITS: WalkLimits =
    WalkLimits { corrections: 3, widths: 8.0, crossings: MAX_CROSSINGS };
/// Limits for a guess from outlines, which is either right or wrong (measured).
pub(super) const OUTLINE_LIMITS: WalkLimits =
    WalkLimits { corrections: 0, widths: 4.0, crossings: 8 };

/// Maximum ratio of the distances from the line after and before a correction. If a correction exceeds
/// it, the bodies are not similar to ellipsoids.
const MAX_REMAINDER: f64 = 0.5;

/// Walks from a guessed normal to the line, beginning at a face of `M` at the support point.
///
/// If the support point is on the line, up to the touching distance, its plane may prove that the
/// portal is the lowest. Also returns the support point that the corrections reached, as a guess from
/// which the caller continues if there is no portal.
#[inline(always)]
#[expect(clippy::inline_always, reason = "a result copied through memory stalls")]
pub(crate) fn walk_from_guess<O: Observer>(
    context: &mut Context<O>,
    start: &NormalGuess,
    limits: &WalkLimits,
) -> (WalkResult, NormalGuess) {
    let reached = |portal, status| (WalkResult::Portal(portal, status), *start);
    let mut slope = start.normal.truncate();
    let mut vertex = context.support(normal_of(slope), start.near);
    let mut within_reach = None;
    // The farthest corner of an apparent face need not be a support point; then it proves nothing.
    let mut is_support = true;
    for corrections in 0.. {
        let shadow = vertex.shadow();
        let mut toward_line = -shadow;
        let touching = context.difference.touching_distance();
        if is_support && shadow.length_squared() <= touching * touching {
            match classify_vertex(context, &vertex, slope) {
                VertexCase::Lowest(portal, status) => return reached(portal, status),
                VertexCase::Toward(line) => toward_line = line,
                VertexCase::Unknown => {}
            }
        }
        let portal = match adjacent_face(context, &vertex, slope, toward_line) {
            Some(AdjacentFace::Face(portal)) => portal,
            Some(AdjacentFace::Edge(portal, found)) => {
                return reached(portal, PortalStatus::Lowest(found));
            }
            None => break,
        };
        let from = match line_position_after_crossing(context, &portal) {
            LinePosition::BeyondEdge(from) => from,
            LinePosition::Inside(status) => return reached(portal, status),
        };
        let edge = Edge::from_corner(&portal, from);
        let [distance, width] = [edge.scaled_distance(), edge.scaled_width()];
        if distance <= limits.widths * width {
            within_reach = Some(edge);
        }
        if distance <= MAX_WALK_WIDTHS * width || corrections == limits.corrections {
            break;
        }
        if has_polygonal_faces(&context.difference) {
            match cross_face(context, portal, from) {
                CoplanarStep::Portal(portal, status) => return reached(portal, status),
                CoplanarStep::Corner(normal, corner) => {
                    (slope, vertex) = (normal.truncate() / normal.z, corner);
                    is_support = false;
                    continue;
                }
                CoplanarStep::NotCoplanar => {}
            }
        }
        let corrected = slope + slope_per_shadow(&context.difference, slope) * shadow;
        if !corrected.is_finite() {
            break;
        }
        let next = context.support(normal_of(corrected), Some(vertex.pair));
        let [before, after] = [shadow, next.shadow()].map(DVec2::length_squared);
        if after <= before {
            (slope, vertex, is_support) = (corrected, next, true);
        }
        if after > MAX_REMAINDER * MAX_REMAINDER * before {
            break;
        }
    }
    let nearest = NormalGuess { normal: normal_of(slope), near: Some(vertex.pair) };
    let walk =
        within_reach.map_or(WalkResult::Lost, |edge| walk_to_line(context, edge, limits.crossings));
    (walk, nearest)
}

/// Returns the slopes of the earlier contact normal today, as a normal of either body. `None` if poses
/// or direction have changed too much for a walk.
fn current_slopes(
    difference: &MinkowskiDifference,
    last: &ContactPortal,
    shift: DVec2,
) -> Option<[DVec2; 2]> {
    let [p, q] = difference.body_normals_to_shadow(last.normals)?;
    let near = difference.is_near(shift.length()) && p.z.min(q.z) > 0.0;
    near.then(|| [p, q].map(|n| n.truncate() / n.z))
}

/// Returns the face or edge of `M` at the support point along `slope`, on the side of the line. Starts
/// the search for this point at `near`, if a nearby pair is known. `None` if there is no such face, or the
/// slope is not finite.
fn adjacent_face_along<O: Observer>(
    context: &mut Context<O>,
    slope: DVec2,
    near: Option<VertexPair>,
) -> Option<AdjacentFace> {
    if !slope.is_finite() {
        return None;
    }
    let vertex = context.support(normal_of(slope), near);
    adjacent_face(context, &vertex, slope, -vertex.shadow())
}
