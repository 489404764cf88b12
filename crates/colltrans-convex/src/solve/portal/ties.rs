//! Ties: the line passes a vertex, an edge or the boundary of a triangle within rounding error.
//!
//! The side on which the line passes does not matter if the vertex or edge is lowest, that is, if it
//! lies in a supporting plane of `M`. This plane is the lower bound. The point next to the line is an
//! upper bound if the line is deep inside the shadow of `M`
//! ([`is_upper_bound`](MinkowskiDifference::is_upper_bound)). Machine parts that rest on each other usually touch
//! like this, so they need no exact decisions. All other cases are decided exactly.

use glam::{DVec2, DVec3};

use super::enclose::nearest_parameter;
use super::gift_wrap::{RotatingPlane, first_vertex_met};
use super::refine::{index_of_largest, line_weights, portal_normal, status_at_support};
use super::{Context, Face, LinePosition, Plane, Portal, PortalStatus, normal_of};
use crate::body::VertexId;
use crate::setting::VertexPair;
use crate::setting::minkowski::{MinkowskiDifference, ShadowPoint};
use crate::solve::observe::{Observer, Support};
use colltrans_kernel::determinant::accurate_det;

/// Position of the line relative to a support point within rounding error.
pub(super) enum VertexCase {
    /// The line meets `M` in this portal, up to rounding. The portal's point on the line is the upper
    /// bound. The plane of the support point is the lower bound if the status is `Lowest`.
    Lowest(Portal, PortalStatus),
    /// The line lies in this direction (any length).
    Toward(DVec2),
    /// The line is too close to decide.
    Unknown,
}

/// Locates the line relative to the support point `vertex` along `slope`.
///
/// 1. If the line is deep inside the shadow of `M`, the vertex is the lowest point up to rounding.
/// 2. Otherwise the exact shadow of the vertex decides. If the line passes through the vertex, it
///    pierces any triangle with this corner there.
/// 3. Otherwise the face at the vertex in the direction of the line may be the lowest. The exact
///    direction yields the height at which the line passes this face, however steep the face is. If
///    this height is within one noise of the plane of the vertex, the face is the lowest up to
///    rounding.
#[cold]
#[inline(never)]
pub(super) fn classify_vertex<O: Observer>(
    context: &mut Context<O>,
    vertex: &ShadowPoint,
    slope: DVec2,
) -> VertexCase {
    let normal = normal_of(slope);
    let at_corner = || {
        let portal =
            context.difference.setting.fixed.neighbours(vertex.pair.fixed.0).first().and_then(
                |&q| {
                    let to = context
                        .difference
                        .vertex_point(VertexPair { fixed: VertexId(q), ..vertex.pair });
                    triangle_at_corner(&context.difference, vertex, &to)
                },
            );
        match portal {
            Some(portal) => {
                let weights = weights_on_first_edge(&portal, vertex, 0.0);
                let status =
                    status_at_support(&context.difference, &portal, normal, vertex.pair, weights);
                VertexCase::Lowest(portal, status)
            }
            None => VertexCase::Unknown,
        }
    };
    let residual = vertex.shadow().length();
    if residual <= context.difference.noise.point_error()
        && context.difference.is_upper_bound(vertex.coordinates, residual, normal)
    {
        return at_corner();
    }
    let Some(shadow) = context.difference.precise_shadow(vertex.pair) else {
        return VertexCase::Unknown;
    };
    if shadow == DVec2::ZERO {
        return at_corner();
    }
    let line = -shadow.normalize();
    let found = adjacent_face(context, vertex, slope, line);
    let Some(AdjacentFace::Face(portal) | AdjacentFace::Edge(portal, _)) = found else {
        return VertexCase::Toward(line);
    };
    if [(1, 2), (2, 0)].iter().any(|&(i, j)| !context.difference.is_left(&portal[i], &portal[j])) {
        return VertexCase::Toward(line);
    }
    // `vertex` is the first or the second of the three corners.
    let own = usize::from(portal[0].pair != vertex.pair);
    let [i, j] = [1 - own, 2];
    let [a, b] = [i, j].map(|k| portal[k].coordinates - vertex.coordinates);
    let (u, v) = (a.truncate(), b.truncate());
    let area = accurate_det(u, v);
    let least = context.difference.touching_distance() * (u.length() + v.length());
    let shares = [-accurate_det(shadow, v), -accurate_det(u, shadow)].map(|p| (p / area).max(0.0));
    let sum = shares[0] + shares[1];
    let height = shares[0] * normal.dot(a) + shares[1] * normal.dot(b);
    let level = height <= context.difference.noise.point_error() * normal.length();
    // Narrower triangles have no plane.
    if area.abs() <= least || sum > 1.0 || !level {
        return VertexCase::Toward(line);
    }
    let mut weights = [0.0; 3];
    (weights[own], weights[i], weights[j]) = (1.0 - sum, shares[0], shares[1]);
    let status = status_at_support(&context.difference, &portal, normal, vertex.pair, weights);
    VertexCase::Lowest(portal, status)
}

/// Returns the weights of a point on the first edge of a portal: at the fraction `share` of the edge, from
/// its end `from`.
fn weights_on_first_edge(portal: &Portal, from: &ShadowPoint, share: f64) -> [f64; 3] {
    if portal[0].pair == from.pair { [1.0 - share, share, 0.0] } else { [share, 1.0 - share, 0.0] }
}

/// Returns the triangle of an edge of `M` and another edge of the same body at its end `from`,
/// counter-clockwise. `None` if the body has no other edge there.
fn triangle_at_corner(
    difference: &MinkowskiDifference,
    from: &ShadowPoint,
    to: &ShadowPoint,
) -> Option<Portal> {
    let [moving, fixed] = from.pair.indices();
    let setting = difference.setting;
    let other = |neighbours: &[u32], not: u32| neighbours.iter().copied().find(|&w| w != not);
    let third = if to.pair.fixed.0 == fixed {
        let moving = other(setting.moving.neighbours(moving), to.pair.moving.0)?;
        VertexPair::from_indices(moving, fixed)
    } else {
        let fixed = other(setting.fixed.neighbours(fixed), to.pair.fixed.0)?;
        VertexPair::from_indices(moving, fixed)
    };
    let third = difference.vertex_point(third);
    let (first, second) = (to.shadow() - from.shadow(), third.shadow() - from.shadow());
    Some(if first.perp_dot(second) < 0.0 { [*to, *from, third] } else { [*from, *to, third] })
}

/// Locates the line relative to a portal if it passes an edge or a corner within rounding error.
///
/// The tie does not matter if the line is clearly beyond another edge. Nor does it if the portal is
/// proven to be the lowest face, with the line deep inside the shadow of `M`. Otherwise the side is
/// decided exactly.
#[cold]
#[inline(never)]
pub(super) fn line_position_with_ties<O: Observer>(
    context: &mut Context<O>,
    portal: &Portal,
) -> LinePosition {
    let edges = [(0, 1), (1, 2), (2, 0)].map(|(i, j)| [&portal[i], &portal[j]]);
    let clear =
        edges.iter().position(|[i, j]| context.difference.is_left_rounded(i, j) == Some(false));
    if let Some(from) = clear {
        return LinePosition::BeyondEdge(from);
    }
    if let Some(face) = lowest_face(context, portal) {
        return LinePosition::Inside(PortalStatus::Lowest(face));
    }
    match edges.iter().position(|[i, j]| !context.difference.is_left(i, j)) {
        Some(from) => LinePosition::BeyondEdge(from),
        None => LinePosition::Inside(PortalStatus::ReachedByWalk),
    }
}

/// Returns the lowest plane at an edge of `M` that the line meets up to rounding.
///
/// `None` unless the plane supports `M` and the line is so deep inside the shadow of `M` that rounding
/// does not matter.
#[cold]
#[inline(never)]
pub(super) fn lowest_edge<O: Observer>(
    context: &mut Context<O>,
    [from, to]: &[ShadowPoint; 2],
    normal: DVec3,
) -> Option<(Portal, Face)> {
    let share = met_parameter(&context.difference, [from, to], normal)?;
    let portal = triangle_at_corner(&context.difference, from, to)?;
    let plane = Plane::if_supported_at(&context.difference, normal, from.pair)?;
    context
        .watch
        .support(|| Support::from_point(normal, &context.difference.vertex_point(plane.lowest)));
    let weights = weights_on_first_edge(&portal, from, share);
    Some((portal, Face { plane, weights }))
}

/// Returns the parameter of the point on an edge where the line meets it up to rounding, from 0 at its
/// start to 1 at its end.
///
/// `None` unless the line is so deep inside the shadow of `M` that rounding does not matter in a plane
/// perpendicular to `normal`.
pub(super) fn met_parameter(
    difference: &MinkowskiDifference,
    [from, to]: [&ShadowPoint; 2],
    normal: DVec3,
) -> Option<f64> {
    let share = nearest_parameter([from.shadow(), to.shadow()]);
    let contact = from.coordinates + (to.coordinates - from.coordinates) * share;
    let residual = contact.truncate().length();
    let is_met = residual <= difference.noise.point_error()
        && difference.is_upper_bound_on_edge([from, to], contact, residual, normal);
    is_met.then_some(share)
}

/// Returns the lowest face in a portal that contains the line up to rounding.
///
/// `None` unless its plane supports `M` and the line is so deep inside the shadow of `M` that rounding
/// does not matter.
fn lowest_face<O: Observer>(context: &mut Context<O>, portal: &Portal) -> Option<Face> {
    let normal = portal_normal(&context.difference, portal)?;
    let weights = line_weights(portal);
    let contact =
        portal.iter().zip(weights).map(|(corner, w)| corner.coordinates * w).sum::<DVec3>();
    let residual = contact.truncate().length();
    let least = 2 - index_of_largest([weights[2], weights[1], weights[0]].map(|w| -w));
    let edge = [&portal[(least + 1) % 3], &portal[(least + 2) % 3]];
    if residual > context.difference.noise.point_error()
        || !context.difference.is_upper_bound_on_edge(edge, contact, residual, normal)
    {
        return None;
    }
    let plane = Plane::if_supported_at(&context.difference, normal, portal[2].pair)?;
    context
        .watch
        .support(|| Support::from_point(normal, &context.difference.vertex_point(plane.lowest)));
    Some(Face { plane, weights })
}

/// Face or edge of `M` at a support point.
pub(super) enum AdjacentFace {
    /// A face, with the line on the left of its first edge.
    Face(Portal),
    /// An edge under the line that is the lowest up to rounding.
    Edge(Portal, Face),
}

/// Returns the face or edge of `M` at the support point `vertex` along `slope`, in the direction `line`.
/// `None` if no neighbour of the vertex lies in this direction, or beyond the edge found there.
pub(super) fn adjacent_face<O: Observer>(
    context: &mut Context<O>,
    vertex: &ShadowPoint,
    slope: DVec2,
    line: DVec2,
) -> Option<AdjacentFace> {
    let (vertex, normal) = (*vertex, normal_of(slope));
    let toward_line = RotatingPlane { normal, outward: line };
    let second = first_vertex_met(&context.difference, &vertex, &toward_line)?;
    // The plane after the rotation, which contains both vertices.
    let edge = second.coordinates - vertex.coordinates;
    let turn = normal.dot(edge) / toward_line.outward.dot(edge.truncate());
    let normal = normal_of(slope - toward_line.outward * turn);
    let rounded = context.difference.is_left_rounded(&vertex, &second);
    if rounded.is_none()
        && let Some((portal, found)) = lowest_edge(context, &[vertex, second], normal)
    {
        return Some(AdjacentFace::Edge(portal, found));
    }
    let line_is_left = rounded.unwrap_or_else(|| context.difference.is_left(&vertex, &second));
    let left = edge.truncate().perp();
    let outward = if line_is_left { left } else { -left };
    let third = first_vertex_met(&context.difference, &vertex, &RotatingPlane { normal, outward })?;
    let face = if line_is_left { [vertex, second, third] } else { [second, vertex, third] };
    Some(AdjacentFace::Face(face))
}
