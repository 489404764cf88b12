//! Where the line passes a vertex, an edge or the rim of a triangle by less than rounding can tell.
//!
//! On which side it passes does not matter if what it passes is lowest: if it lies in a supporting
//! plane of `M`, the plane is the lower bound, and what the line nearly meets there is an upper bound
//! as soon as the line is deep inside the shadow of `M`
//! ([`is_upper_bound`](MinkowskiDifference::is_upper_bound)). Parts of machines stand like this as a rule, and
//! then nothing has to be decided exactly. Whatever is not settled so is left to exact decisions.

use glam::{DVec2, DVec3};

use super::enclose::nearest_share;
use super::gift_wrap::{Tilt, first_met};
use super::refine::{known_at, largest, plane_normal, weights};
use super::{Context, Face, Known, Line, Plane, Portal, normal_of};
use crate::body::VertexId;
use crate::setting::VertexPair;
use crate::setting::minkowski::{MinkowskiDifference, Point};
use crate::solve::observe::{Observer, Support};
use colltrans_kernel::determinant::accurate_det;

/// What a support point within rounding error of the line says.
pub(super) enum Pointed {
    /// The line meets `M` here: the support point's plane is the lower bound, if it is proven to be one,
    /// the portal's point on the line the upper one.
    Lowest(Portal, Known),
    /// The direction, any length, in which the line is.
    Toward(DVec2),
    /// Nothing, because it is too close to be told.
    Unknown,
}

/// Looks for the line around the support point `vertex` along a slope.
///
/// If the line is deep inside the shadow of `M`, the point is as low as it can be told. If not, the
/// exact shadow decides. If the line is on the point, any triangle with this corner is pierced
/// there. If it is beside it, the face of the point in whose direction it lies is, and the line
/// passes it at a height that the shadow's exact direction tells, however steep the face is. What
/// lies higher than the plane by less than the noise is as low as can be told.
#[cold]
#[inline(never)]
pub(super) fn pointed<O: Observer>(
    context: &mut Context<O>,
    vertex: &Point,
    slope: DVec2,
) -> Pointed {
    let normal = normal_of(slope);
    let at_corner = || {
        let portal =
            context.difference.setting.fixed.neighbours(vertex.pair.fixed.0).first().and_then(
                |&q| {
                    let to =
                        context.difference.vertex(VertexPair { fixed: VertexId(q), ..vertex.pair });
                    corner(&context.difference, vertex, &to)
                },
            );
        match portal {
            Some(portal) => {
                let weights = weights_of(&portal, vertex, 0.0);
                let known = known_at(&context.difference, &portal, normal, vertex.pair, weights);
                Pointed::Lowest(portal, known)
            }
            None => Pointed::Unknown,
        }
    };
    let residual = vertex.shadow().length();
    if residual <= context.difference.noise.point()
        && context.difference.is_upper_bound(vertex.at, residual, normal)
    {
        return at_corner();
    }
    let Some(shadow) = context.difference.precise_shadow(vertex.pair) else {
        return Pointed::Unknown;
    };
    if shadow == DVec2::ZERO {
        return at_corner();
    }
    let line = -shadow.normalize();
    let found = beside(context, vertex, slope, line);
    let Some(Beside::Face(portal) | Beside::Edge(portal, _)) = found else {
        return Pointed::Toward(line);
    };
    if [(1, 2), (2, 0)].iter().any(|&(i, j)| !context.difference.is_left(&portal[i], &portal[j])) {
        return Pointed::Toward(line);
    }
    // Of the three corners, `vertex` is the first or the second.
    let here = usize::from(portal[0].pair != vertex.pair);
    let [i, j] = [1 - here, 2];
    let [a, b] = [i, j].map(|k| portal[k].at - vertex.at);
    let (u, v) = (a.truncate(), b.truncate());
    let area = accurate_det(u, v);
    let least = context.difference.touching() * (u.length() + v.length());
    let parts = [-accurate_det(shadow, v), -accurate_det(u, shadow)].map(|p| (p / area).max(0.0));
    let sum = parts[0] + parts[1];
    let height = parts[0] * normal.dot(a) + parts[1] * normal.dot(b);
    let level = height <= context.difference.noise.point() * normal.length();
    // Narrower triangles have no plane.
    if area.abs() <= least || sum > 1.0 || !level {
        return Pointed::Toward(line);
    }
    let mut weights = [0.0; 3];
    (weights[here], weights[i], weights[j]) = (1.0 - sum, parts[0], parts[1]);
    let known = known_at(&context.difference, &portal, normal, vertex.pair, weights);
    Pointed::Lowest(portal, known)
}

/// The weights of a place on the first edge of a portal, given as a share of the way from one of the
/// edge's ends.
fn weights_of(portal: &Portal, from: &Point, share: f64) -> [f64; 3] {
    if portal[0].pair == from.pair { [1.0 - share, share, 0.0] } else { [share, 1.0 - share, 0.0] }
}

/// A triangle with an edge of `M` and another edge of the same body at its end `from`,
/// counter-clockwise.
fn corner(difference: &MinkowskiDifference, from: &Point, to: &Point) -> Option<Portal> {
    let [moving, fixed] = from.pair.numbers();
    let setting = difference.setting;
    let other = |neighbours: &[u32], not: u32| neighbours.iter().copied().find(|&w| w != not);
    let third = if to.pair.fixed.0 == fixed {
        let moving = other(setting.moving.neighbours(moving), to.pair.moving.0)?;
        VertexPair::of(moving, fixed)
    } else {
        let fixed = other(setting.fixed.neighbours(fixed), to.pair.fixed.0)?;
        VertexPair::of(moving, fixed)
    };
    let third = difference.vertex(third);
    let (way, across) = (to.shadow() - from.shadow(), third.shadow() - from.shadow());
    Some(if way.perp_dot(across) < 0.0 { [*to, *from, third] } else { [*from, *to, third] })
}

/// The line passes an edge or a corner of the portal by less than rounding can tell.
///
/// That does not matter if it is clearly beyond another edge, or if the portal proves to be the
/// lowest face and the line to be deep inside the shadow of `M`; only else it is decided exactly.
#[cold]
#[inline(never)]
pub(super) fn crossed_or_tied<O: Observer>(context: &mut Context<O>, portal: &Portal) -> Line {
    let edges = [(0, 1), (1, 2), (2, 0)].map(|(i, j)| [&portal[i], &portal[j]]);
    let clear =
        edges.iter().position(|[i, j]| context.difference.is_left_rounded(i, j) == Some(false));
    if let Some(from) = clear {
        return Line::Beyond(from);
    }
    if let Some(face) = lowest_face(context, portal) {
        return Line::Inside(Known::Lowest(face));
    }
    match edges.iter().position(|[i, j]| !context.difference.is_left(i, j)) {
        Some(from) => Line::Beyond(from),
        None => Line::Inside(Known::FaceByFace),
    }
}

/// The lowest plane at an edge of `M` that the line meets up to rounding, if the plane through it supports
/// `M` and the line is so deep inside the shadow of `M` that rounding does not matter.
#[cold]
#[inline(never)]
pub(super) fn lowest_edge<O: Observer>(
    context: &mut Context<O>,
    [from, to]: &[Point; 2],
    normal: DVec3,
) -> Option<(Portal, Face)> {
    let share = met_share(&context.difference, [from, to], normal)?;
    let portal = corner(&context.difference, from, to)?;
    let plane = Plane::at(&context.difference, normal, from.pair)?;
    context.watch.support(|| Support::of(normal, &context.difference.vertex(plane.lowest)));
    let weights = weights_of(&portal, from, share);
    Some((portal, Face { plane, weights }))
}

/// Where on an edge the line meets it up to rounding, from 0 at its start to 1 at its end, if the line
/// is so deep inside the shadow of `M` that rounding does not matter in a plane across `normal`.
pub(super) fn met_share(
    difference: &MinkowskiDifference,
    [from, to]: [&Point; 2],
    normal: DVec3,
) -> Option<f64> {
    let share = nearest_share([from.shadow(), to.shadow()]);
    let contact = from.at + (to.at - from.at) * share;
    let residual = contact.truncate().length();
    let is_met = residual <= difference.noise.point()
        && difference.is_upper_bound_on_edge([from, to], contact, residual, normal);
    is_met.then_some(share)
}

/// The lowest face in a portal that contains the line up to rounding, if its plane supports `M` and the
/// line is so deep inside the shadow of `M` that rounding does not matter.
fn lowest_face<O: Observer>(context: &mut Context<O>, portal: &Portal) -> Option<Face> {
    let normal = plane_normal(&context.difference, portal)?;
    let weights = weights(portal);
    let contact = portal.iter().zip(weights).map(|(corner, w)| corner.at * w).sum::<DVec3>();
    let residual = contact.truncate().length();
    let least = 2 - largest([weights[2], weights[1], weights[0]].map(|w| -w));
    let edge = [&portal[(least + 1) % 3], &portal[(least + 2) % 3]];
    if residual > context.difference.noise.point()
        || !context.difference.is_upper_bound_on_edge(edge, contact, residual, normal)
    {
        return None;
    }
    let plane = Plane::at(&context.difference, normal, portal[2].pair)?;
    context.watch.support(|| Support::of(normal, &context.difference.vertex(plane.lowest)));
    Some(Face { plane, weights })
}

/// What of `M` is beside a support point.
pub(super) enum Beside {
    /// A face with the line on the left of its first edge.
    Face(Portal),
    /// An edge under the line, which is as low as can be told.
    Edge(Portal, Face),
}

/// The face, or the edge, of `M` at the support point `vertex` along a slope, in the direction of the
/// line.
pub(super) fn beside<O: Observer>(
    context: &mut Context<O>,
    vertex: &Point,
    slope: DVec2,
    line: DVec2,
) -> Option<Beside> {
    let (vertex, normal) = (*vertex, normal_of(slope));
    let toward_line = Tilt { normal, outward: line };
    let second = first_met(&context.difference, &vertex, &toward_line)?;
    // The plane after the turn, which contains both.
    let edge = second.at - vertex.at;
    let turn = normal.dot(edge) / toward_line.outward.dot(edge.truncate());
    let normal = normal_of(slope - toward_line.outward * turn);
    let rounded = context.difference.is_left_rounded(&vertex, &second);
    if rounded.is_none()
        && let Some((portal, found)) = lowest_edge(context, &[vertex, second], normal)
    {
        return Some(Beside::Edge(portal, found));
    }
    let line_is_left = rounded.unwrap_or_else(|| context.difference.is_left(&vertex, &second));
    let left = edge.truncate().perp();
    let outward = if line_is_left { left } else { -left };
    let third = first_met(&context.difference, &vertex, &Tilt { normal, outward })?;
    let face = if line_is_left { [vertex, second, third] } else { [second, vertex, third] };
    Some(Beside::Face(face))
}
