//! Feature focus: from the portal of an earlier query to one around the line of today's (the
//! paper's future work, section V-F).
//!
//! Notation. The three pairs of vertices still give points of `M`, wherever the bodies are now; the
//! *shift* is where the old point of contact, the same weights over these pairs, has its shadow. It
//! was on the line, so the shift is what poses and direction have changed.
//!
//! Where the line has left the triangle, it went over an edge; on the other side lies the next face
//! of `M`. That face is found as in gift wrapping: among the neighbours of the edge's vertices, the
//! one that a plane turning about the edge meets first. If the line is many faces away, the shift
//! and the curvature of the bodies' inertia ellipsoids tell the slope where to continue, at a
//! vertex of `M` and the face beside it.
//!
//! All this guesses: the old triangle need not be a face of `M` any more. The result is three points
//! of `M` around the line, whatever way led there; refinement does not ask.

use std::hint::select_unpredictable;

use glam::{DVec2, DVec3};

use super::enclose::nearest_share;
use super::refine::lowest_face;
use super::start::continued;
use super::{FirstNormal, Optimum, Portal, normal_of};
use crate::body::ConvexPolyhedron;
use crate::number::determinant::accurate_det;
use crate::number::plane::triangle_normal;
use crate::setting::VertexPair;
use crate::setting::minkowski::{MinkowskiDifference, Point};
use crate::solve::observe::{Observer, Support, Watch};

/// What became of an old portal.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Followed {
    /// A portal around the line.
    Portal(Portal),
    /// Nothing of `M` seems to lie beyond an edge: its outward normal in the shadow plane (any
    /// length), and a pair of vertices there.
    Rim { outward: DVec2, near: VertexPair },
    /// The line is too far away.
    Lost,
}

/// Faces of `M` crossed before a start from scratch is the shorter way (measured).
const CROSSINGS: usize = 20;

/// A line this many widths of the triangle beyond an edge is not reached face by face (measured).
const FAR: f64 = 1.2;

/// A vertex with more neighbours than this is not looked around.
const MOST_NEIGHBOURS: usize = 32;

/// Where the line met `M` in an earlier query.
///
/// In this order in memory: behind the tag of an enum, fields of eight bytes are written once if they
/// come first, and twice if not.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub(crate) struct ContactPortal {
    /// The contact normal, in the frames of the moving and of the fixed body.
    pub(crate) normals: [DVec3; 2],
    /// The weights of the contact in the portal.
    pub(crate) weights: [f64; 3],
    /// The portal.
    pub(crate) pairs: [VertexPair; 3],
}

/// Follows the line from where it met `M` before.
#[inline]
pub(crate) fn follow<O: Observer>(
    difference: &MinkowskiDifference,
    last: &ContactPortal,
    optimum: &mut Option<Optimum>,
    watch: &mut Watch<O>,
) -> Followed {
    let [a, b, c] = last.pairs;
    let mut portal = [difference.vertex(a), difference.vertex(b), difference.vertex(c)];
    let [a, b, c] = portal.map(|p| p.shadow());
    if (b - a).perp_dot(c - a) < 0.0 {
        portal.swap(0, 1);
    }
    let mut edge = match crossed(difference, &portal, optimum, watch) {
        Some(from) => Edge::of(&portal, from),
        None => return Followed::Portal(portal),
    };
    let shift = a * last.weights[0] + b * last.weights[1] + c * last.weights[2];
    let Some(slopes) = slopes(difference, last, shift) else { return Followed::Lost };
    if edge.distance() > FAR * edge.width() {
        let slope = continued(difference, shift, slopes);
        match jump(difference, slope, last.pairs[0], optimum, watch) {
            Some(there) if optimum.is_some() => return Followed::Portal(there),
            Some(there) => portal = there,
            None => return Followed::Lost,
        }
        match left_behind(difference, &portal, optimum, watch) {
            Some(from) => edge = Edge::of(&portal, from),
            None => return Followed::Portal(portal),
        }
    }
    walk(difference, edge, CROSSINGS, optimum, watch)
}

/// From a face of `M` to the one that the line pierces, over one edge after another, of which the
/// first is given.
#[inline(never)]
fn walk<O: Observer>(
    difference: &MinkowskiDifference,
    mut edge: Edge,
    most: usize,
    optimum: &mut Option<Optimum>,
    watch: &mut Watch<O>,
) -> Followed {
    for _ in 0..most {
        watch.portal(|| [edge.from.at, edge.to.at, edge.third.at]);
        let Some(tilt) = edge.tilt() else { return Followed::Lost };
        // The edge that was crossed has the line on its left now.
        let portal = match first_met(difference, &edge.from, &tilt) {
            Neighbour::Met(point) => [edge.to, edge.from, point],
            Neighbour::None => {
                return Followed::Rim { outward: tilt.outward, near: edge.from.pair };
            }
            Neighbour::TooMany => return Followed::Lost,
        };
        match left_behind(difference, &portal, optimum, watch) {
            Some(from) => edge = Edge::of(&portal, from),
            None => return Followed::Portal(portal),
        }
    }
    Followed::Lost
}

/// The same for a start from scratch, which has wider portals to fall back on.
const FEW_CROSSINGS: usize = 8;

/// How often a guess is corrected by the ellipsoids' curvature before the walk begins.
const CORRECTIONS: usize = 4;

/// A correction that leaves more of the distance from the line than this share says that the bodies
/// are no ellipsoids.
const PROGRESS: f64 = 0.5;

/// From a guessed normal: the face of `M` beside its support point, and from there to the line.
///
/// Where the support point is itself on the line, or nearly so, its plane may prove that the portal
/// reached is the lowest; then `optimum` says so.
#[inline(always)]
#[expect(clippy::inline_always, reason = "passed through memory its result stalls its reader: 3 %")]
pub(crate) fn approach<O: Observer>(
    difference: &MinkowskiDifference,
    start: &FirstNormal,
    optimum: &mut Option<Optimum>,
    watch: &mut Watch<O>,
) -> Followed {
    let mut slope = start.normal.truncate() / start.normal.z;
    let mut vertex = match start.near {
        Some(near) => difference.support_from(normal_of(slope), near),
        None => difference.support(normal_of(slope)),
    };
    watch.support(|| Support::of(normal_of(slope), &vertex));
    for _ in 0..CORRECTIONS {
        let shadow = vertex.shadow();
        let mut toward_line = -shadow;
        if shadow.length_squared() <= difference.touching() * difference.touching() {
            match pointed(difference, &vertex, slope, watch) {
                Pointed::Lowest(portal, found) => {
                    *optimum = Some(found);
                    return Followed::Portal(portal);
                }
                Pointed::Toward(line) => toward_line = line,
                Pointed::Unknown => {}
            }
        }
        let Some(portal) = beside(difference, &vertex, slope, toward_line, optimum, watch) else {
            return Followed::Lost;
        };
        if optimum.is_some() {
            return Followed::Portal(portal);
        }
        let Some(from) = left_behind(difference, &portal, optimum, watch) else {
            return Followed::Portal(portal);
        };
        let edge = Edge::of(&portal, from);
        if edge.distance() <= FAR * edge.width() {
            return walk(difference, edge, FEW_CROSSINGS, optimum, watch);
        }
        slope += start.slope_per_shadow * shadow;
        if !slope.is_finite() {
            break;
        }
        vertex = difference.support_from(normal_of(slope), vertex.pair);
        watch.support(|| Support::of(normal_of(slope), &vertex));
        if vertex.shadow().length_squared() > PROGRESS * PROGRESS * shadow.length_squared() {
            break;
        }
    }
    Followed::Lost
}

/// What a support point within rounding error of the line says.
enum Pointed {
    /// The line meets `M` here: the support point's plane is the lower bound, the portal's point on
    /// the line the upper one.
    Lowest(Portal, Optimum),
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
fn pointed<O: Observer>(
    difference: &MinkowskiDifference,
    vertex: &Point,
    slope: DVec2,
    watch: &mut Watch<O>,
) -> Pointed {
    let normal = normal_of(slope);
    let optimum = |weights| Optimum { normal, lowest: vertex.pair, weights };
    let at_corner = || {
        let portal =
            difference.setting.fixed.neighbours(vertex.pair.fixed).first().and_then(|&q| {
                let to = difference.vertex(VertexPair { fixed: q, ..vertex.pair });
                corner(difference, vertex, &to)
            });
        match portal {
            Some(portal) => {
                let weights = weights_of(&portal, vertex, 0.0);
                Pointed::Lowest(portal, optimum(weights))
            }
            None => Pointed::Unknown,
        }
    };
    let residual = vertex.shadow().length();
    if residual <= difference.noise.point() && difference.is_met_at(vertex.at, residual, normal) {
        return at_corner();
    }
    let Some(shadow) = difference.exact_shadow(vertex.pair) else { return Pointed::Unknown };
    if shadow == DVec2::ZERO {
        return at_corner();
    }
    let line = -shadow.normalize();
    let Some(portal) = beside(difference, vertex, slope, line, &mut None, watch) else {
        return Pointed::Toward(line);
    };
    if [(1, 2), (2, 0)].iter().any(|&(i, j)| !difference.is_left(&portal[i], &portal[j])) {
        return Pointed::Toward(line);
    }
    // Of the three corners, `vertex` is the first or the second.
    let here = usize::from(portal[0].pair != vertex.pair);
    let [i, j] = [1 - here, 2];
    let [a, b] = [i, j].map(|k| portal[k].at - vertex.at);
    let (u, v) = (a.truncate(), b.truncate());
    let area = accurate_det(u, v);
    let least = difference.touching() * (u.length() + v.length());
    let parts = [-accurate_det(shadow, v), -accurate_det(u, shadow)].map(|p| (p / area).max(0.0));
    let sum = parts[0] + parts[1];
    let height = parts[0] * normal.dot(a) + parts[1] * normal.dot(b);
    let level = height <= difference.noise.point() * normal.length();
    // Narrower triangles have no plane.
    if area.abs() <= least || sum > 1.0 || !level {
        return Pointed::Toward(line);
    }
    let mut weights = [0.0; 3];
    (weights[here], weights[i], weights[j]) = (1.0 - sum, parts[0], parts[1]);
    Pointed::Lowest(portal, optimum(weights))
}

/// The weights of a place on the first edge of a portal, given as a share of the way from one of the
/// edge's ends.
fn weights_of(portal: &Portal, from: &Point, share: f64) -> [f64; 3] {
    if portal[0].pair == from.pair { [1.0 - share, share, 0.0] } else { [share, 1.0 - share, 0.0] }
}

/// A triangle with an edge of `M` and another edge of the same body at its end `from`,
/// counter-clockwise.
fn corner(difference: &MinkowskiDifference, from: &Point, to: &Point) -> Option<Portal> {
    let VertexPair { moving, fixed } = from.pair;
    let setting = difference.setting;
    let other = |neighbours: &[u32], not: u32| neighbours.iter().copied().find(|&w| w != not);
    let third = if to.pair.fixed == fixed {
        let moving = other(setting.moving.neighbours(moving), to.pair.moving)?;
        VertexPair { moving, fixed }
    } else {
        let fixed = other(setting.fixed.neighbours(fixed), to.pair.fixed)?;
        VertexPair { moving, fixed }
    };
    let third = difference.vertex(third);
    let (way, across) = (to.shadow() - from.shadow(), third.shadow() - from.shadow());
    Some(if way.perp_dot(across) < 0.0 { [*to, *from, third] } else { [*from, *to, third] })
}

/// The slopes that the old contact normal has now, as a normal of either body; `None` if so much has
/// changed that there is nothing to follow.
fn slopes(
    difference: &MinkowskiDifference,
    last: &ContactPortal,
    shift: DVec2,
) -> Option<[DVec2; 2]> {
    let [p, q] = difference.shadow_from_bodies(last.normals)?;
    let near = difference.is_near(shift.length()) && p.z.min(q.z) > 0.0;
    near.then(|| [p, q].map(|n| n.truncate() / n.z))
}

/// The corner after another.
const NEXT: [usize; 3] = [1, 2, 0];

/// A directed edge of a portal with the third corner on its left and the line on its right.
struct Edge {
    from: Point,
    to: Point,
    third: Point,
}

/// The corner of the portal where an edge begins over which the line has left it; none, and perhaps
/// the `optimum`, if it has not.
#[inline]
fn crossed<O: Observer>(
    difference: &MinkowskiDifference,
    portal: &Portal,
    optimum: &mut Option<Optimum>,
    watch: &mut Watch<O>,
) -> Option<usize> {
    match difference.is_left_rounded(&portal[0], &portal[1]) {
        Some(true) => left_behind(difference, portal, optimum, watch),
        Some(false) => Some(0),
        None => crossed_or_tied(difference, portal, optimum, watch),
    }
}

/// The same, if the line is known to be on the left of the first edge.
#[inline]
fn left_behind<O: Observer>(
    difference: &MinkowskiDifference,
    portal: &Portal,
    optimum: &mut Option<Optimum>,
    watch: &mut Watch<O>,
) -> Option<usize> {
    let second = difference.is_left_rounded(&portal[1], &portal[2]);
    let third = difference.is_left_rounded(&portal[2], &portal[0]);
    match (second, third) {
        (Some(true), Some(true)) => None,
        (Some(false), _) => Some(1),
        (_, Some(false)) => Some(2),
        _ => crossed_or_tied(difference, portal, optimum, watch),
    }
}

/// The line passes an edge or a corner of the portal by less than rounding can tell.
///
/// That does not matter if it is clearly beyond another edge, or if the portal proves to be the
/// lowest face and the line to be deep inside the shadow of `M`; only else it is decided exactly.
#[cold]
#[inline(never)]
fn crossed_or_tied<O: Observer>(
    difference: &MinkowskiDifference,
    portal: &Portal,
    optimum: &mut Option<Optimum>,
    watch: &mut Watch<O>,
) -> Option<usize> {
    let edges = [(0, 1), (1, 2), (2, 0)].map(|(i, j)| [&portal[i], &portal[j]]);
    let clear = edges.iter().position(|[i, j]| difference.is_left_rounded(i, j) == Some(false));
    if clear.is_some() {
        return clear;
    }
    *optimum = lowest_face(difference, portal, watch);
    if optimum.is_some() {
        return None;
    }
    edges.iter().position(|[i, j]| !difference.is_left(i, j))
}

impl Edge {
    /// The edge that begins at a corner.
    #[inline]
    fn of(portal: &Portal, from: usize) -> Self {
        let [to, third] = [NEXT[from], NEXT[NEXT[from]]];
        Self { from: portal[from], to: portal[to], third: portal[third] }
    }

    /// From the edge away from the triangle, as long as the edge.
    fn outward(&self) -> DVec2 {
        -(self.to.shadow() - self.from.shadow()).perp()
    }

    /// How wide the triangle is over the edge, times the edge's length.
    fn width(&self) -> f64 {
        self.outward().dot(self.from.shadow() - self.third.shadow())
    }

    /// How far the line is beyond the edge, times the edge's length.
    fn distance(&self) -> f64 {
        -self.outward().dot(self.from.shadow())
    }

    /// The turn of the triangle's plane about the edge; `None` if the plane stands upright.
    fn tilt(&self) -> Option<Tilt> {
        let normal = triangle_normal([self.from.at, self.to.at, self.third.at]);
        (normal.z > 0.0).then_some(Tilt { normal, outward: self.outward() })
    }
}

/// A plane that turns downwards on one side.
struct Tilt {
    /// Its normal (shadow frame, any length).
    normal: DVec3,
    /// Away from the axis of the turn, in the shadow plane, any length.
    outward: DVec2,
}

/// What a turning plane meets first.
enum Neighbour {
    Met(Point),
    None,
    TooMany,
}

/// Of the neighbours of a vertex of `M` on the axis of the turn, the one with the least rise over
/// its run.
#[inline]
fn first_met(difference: &MinkowskiDifference, vertex: &Point, tilt: &Tilt) -> Neighbour {
    let VertexPair { moving, fixed } = vertex.pair;
    let setting = difference.setting;
    let (normal, outward) = (tilt.normal, tilt.outward.extend(0.0));
    // A neighbour closer to the axis than this is not beyond it.
    let least = difference.touching() * tilt.outward.length();
    let turn =
        Turn { up: -difference.in_moving(normal), out: -difference.in_moving(outward), least };
    let p = turn.first(setting.moving, moving);
    let turn = Turn { up: difference.in_fixed(normal), out: difference.in_fixed(outward), least };
    let q = turn.first(setting.fixed, fixed);
    let (Some(p), Some(q)) = (p, q) else { return Neighbour::TooMany };
    let of_fixed = q.rise * p.run < p.rise * q.run;
    let found = if of_fixed { q.vertex } else { p.vertex };
    if found == NOBODY {
        return Neighbour::None;
    }
    let moving = select_unpredictable(of_fixed, moving, found);
    let fixed = select_unpredictable(of_fixed, found, fixed);
    Neighbour::Met(difference.vertex(VertexPair { moving, fixed }))
}

/// A turn seen from one body's frame: `up` and `out` measure rise and run.
struct Turn {
    up: DVec3,
    out: DVec3,
    /// Least run.
    least: f64,
}

/// The neighbour that a turn meets first.
struct First {
    vertex: u32,
    rise: f64,
    run: f64,
}

/// No neighbour lies beyond the axis.
const NOBODY: u32 = u32::MAX;

impl Turn {
    /// The first among the neighbours of one body's vertex; `None` if there are too many.
    #[inline]
    #[expect(clippy::needless_bitwise_bool, reason = "a branch here is not predictable")]
    fn first(&self, body: &ConvexPolyhedron, vertex: u32) -> Option<First> {
        let here = body.vertices()[vertex as usize];
        let neighbours = body.neighbours(vertex);
        if neighbours.len() > MOST_NEIGHBOURS {
            return None;
        }
        let mut first = First { vertex: NOBODY, rise: f64::INFINITY, run: 1.0 };
        for &w in neighbours {
            let edge = body.vertices()[w as usize] - here;
            let (rise, run) = (self.up.dot(edge), self.out.dot(edge));
            let sooner = (run > self.least) & (rise * first.run < first.rise * run);
            first.vertex = select_unpredictable(sooner, w, first.vertex);
            first.rise = select_unpredictable(sooner, rise, first.rise);
            first.run = select_unpredictable(sooner, run, first.run);
        }
        Some(first)
    }
}

/// The face of `M` at the support point along a slope, on the side of the line.
fn jump<O: Observer>(
    difference: &MinkowskiDifference,
    slope: DVec2,
    near: VertexPair,
    optimum: &mut Option<Optimum>,
    watch: &mut Watch<O>,
) -> Option<Portal> {
    if !slope.is_finite() {
        return None;
    }
    let vertex = difference.support_from(normal_of(slope), near);
    watch.support(|| Support::of(normal_of(slope), &vertex));
    beside(difference, &vertex, slope, -vertex.shadow(), optimum, watch)
}

/// The face of `M` at the support point `vertex` along a slope, in the direction of the line, with
/// the line on the left of its first edge; or an edge under the line, with the `optimum`.
fn beside<O: Observer>(
    difference: &MinkowskiDifference,
    vertex: &Point,
    slope: DVec2,
    line: DVec2,
    optimum: &mut Option<Optimum>,
    watch: &mut Watch<O>,
) -> Option<Portal> {
    let (vertex, normal) = (*vertex, normal_of(slope));
    let toward_line = Tilt { normal, outward: line };
    let Neighbour::Met(second) = first_met(difference, &vertex, &toward_line) else { return None };
    // The plane after the turn, which contains both.
    let edge = second.at - vertex.at;
    let turn = normal.dot(edge) / toward_line.outward.dot(edge.truncate());
    let normal = normal_of(slope - toward_line.outward * turn);
    let rounded = difference.is_left_rounded(&vertex, &second);
    if rounded.is_none()
        && let Some((portal, found)) = lowest_edge(difference, &[vertex, second], normal, watch)
    {
        *optimum = Some(found);
        return Some(portal);
    }
    let line_is_left = rounded.unwrap_or_else(|| difference.is_left(&vertex, &second));
    let left = edge.truncate().perp();
    let outward = if line_is_left { left } else { -left };
    let Neighbour::Met(third) = first_met(difference, &vertex, &Tilt { normal, outward }) else {
        return None;
    };
    Some(if line_is_left { [vertex, second, third] } else { [second, vertex, third] })
}

/// The optimum on an edge of `M` that the line meets up to rounding, if the plane through it supports
/// `M` and the line is so deep inside the shadow of `M` that rounding does not matter.
#[cold]
#[inline(never)]
fn lowest_edge<O: Observer>(
    difference: &MinkowskiDifference,
    [from, to]: &[Point; 2],
    normal: DVec3,
    watch: &mut Watch<O>,
) -> Option<(Portal, Optimum)> {
    let share = nearest_share([from.shadow(), to.shadow()]);
    let contact = from.at + (to.at - from.at) * share;
    let residual = contact.truncate().length();
    let noise = difference.noise.point();
    if residual > noise || !difference.is_met_on([from, to], contact, residual, normal) {
        return None;
    }
    let portal = corner(difference, from, to)?;
    let point = difference.support_from(normal, from.pair);
    watch.support(|| Support::of(normal, &point));
    if normal.dot(contact - point.at) > noise * normal.length() {
        return None;
    }
    let weights = weights_of(&portal, from, share);
    Some((portal, Optimum { normal, lowest: point.pair, weights }))
}
