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

use super::start::continued;
use super::{FirstNormal, Portal, normal_of};
use crate::body::ConvexPolyhedron;
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
    watch: &mut Watch<O>,
) -> Followed {
    let [a, b, c] = last.pairs;
    let mut portal = [difference.vertex(a), difference.vertex(b), difference.vertex(c)];
    let [a, b, c] = portal.map(|p| p.shadow());
    if (b - a).perp_dot(c - a) < 0.0 {
        portal.swap(0, 1);
    }
    let Some(edge) = crossed(difference, &portal) else { return Followed::Portal(portal) };
    let shift = a * last.weights[0] + b * last.weights[1] + c * last.weights[2];
    let Some(slopes) = slopes(difference, last, shift) else { return Followed::Lost };
    if edge.distance() > FAR * edge.width() {
        let slope = continued(difference, shift, slopes);
        match jump(difference, slope, last.pairs[0], watch) {
            Some(there) => portal = there,
            None => return Followed::Lost,
        }
    }
    walk(difference, portal, CROSSINGS, watch)
}

/// From a face of `M` to the one that the line pierces, over one edge after another.
#[inline]
fn walk<O: Observer>(
    difference: &MinkowskiDifference,
    mut portal: Portal,
    most: usize,
    watch: &mut Watch<O>,
) -> Followed {
    let Some(mut edge) = crossed(difference, &portal) else { return Followed::Portal(portal) };
    for _ in 0..most {
        watch.portal(|| portal.map(|p| p.at));
        let Some(tilt) = edge.tilt() else { return Followed::Lost };
        match first_met(difference, &edge.from, &tilt) {
            Neighbour::Met(point) => portal = [edge.to, edge.from, point],
            Neighbour::None => {
                return Followed::Rim { outward: tilt.outward, near: edge.from.pair };
            }
            Neighbour::TooMany => return Followed::Lost,
        }
        // The edge that was crossed has the line on its left now.
        let [to, from, point] = portal;
        edge = if !difference.is_left(&from, &point) {
            Edge { from, to: point, third: to }
        } else if !difference.is_left(&point, &to) {
            Edge { from: point, to, third: from }
        } else {
            return Followed::Portal(portal);
        };
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
pub(crate) fn approach<O: Observer>(
    difference: &MinkowskiDifference,
    start: &FirstNormal,
    watch: &mut Watch<O>,
) -> Followed {
    let mut slope = start.normal.truncate() / start.normal.z;
    let mut vertex = match start.near {
        Some(near) => difference.support_from(normal_of(slope), near),
        None => difference.support(normal_of(slope)),
    };
    watch.support(|| Support::of(normal_of(slope), &vertex));
    for _ in 0..CORRECTIONS {
        let Some(portal) = beside(difference, &vertex, slope) else { return Followed::Lost };
        let Some(edge) = crossed(difference, &portal) else { return Followed::Portal(portal) };
        if edge.distance() <= FAR * edge.width() {
            return walk(difference, portal, FEW_CROSSINGS, watch);
        }
        let shadow = vertex.shadow();
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

/// A directed edge of a portal with the third corner on its left and the line on its right.
struct Edge {
    from: Point,
    to: Point,
    third: Point,
}

/// An edge of the portal over which the line has left it.
#[inline]
fn crossed(difference: &MinkowskiDifference, portal: &Portal) -> Option<Edge> {
    for (i, j, k) in [(0, 1, 2), (1, 2, 0), (2, 0, 1)] {
        if !difference.is_left(&portal[i], &portal[j]) {
            return Some(Edge { from: portal[i], to: portal[j], third: portal[k] });
        }
    }
    None
}

impl Edge {
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
    watch: &mut Watch<O>,
) -> Option<Portal> {
    if !slope.is_finite() {
        return None;
    }
    let vertex = difference.support_from(normal_of(slope), near);
    watch.support(|| Support::of(normal_of(slope), &vertex));
    beside(difference, &vertex, slope)
}

/// The face of `M` at the support point `vertex` along a slope, on the side of the line.
fn beside(difference: &MinkowskiDifference, vertex: &Point, slope: DVec2) -> Option<Portal> {
    let (vertex, normal) = (*vertex, normal_of(slope));
    let toward_line = Tilt { normal, outward: -vertex.shadow() };
    let Neighbour::Met(second) = first_met(difference, &vertex, &toward_line) else { return None };
    // The plane after the turn, which contains both.
    let edge = second.at - vertex.at;
    let turn = normal.dot(edge) / toward_line.outward.dot(edge.truncate());
    let normal = normal_of(slope - toward_line.outward * turn);
    let line_is_left = difference.is_left(&vertex, &second);
    let left = edge.truncate().perp();
    let outward = if line_is_left { left } else { -left };
    let Neighbour::Met(third) = first_met(difference, &vertex, &Tilt { normal, outward }) else {
        return None;
    };
    Some(if line_is_left { [vertex, second, third] } else { [second, vertex, third] })
}
