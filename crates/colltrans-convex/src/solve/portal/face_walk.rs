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

use glam::{DVec2, DVec3};

use super::coplanar::{Flat, across, has_large_faces};
use super::edge::{Edge, crossed, left_behind};
use super::gift_wrap::first_met;
use super::normal_guess::{continued, slope_per_shadow};
use super::ties::{Beside, Pointed, beside, pointed};
use super::{Context, FirstNormal, Known, Line, Portal, normal_of};
use crate::setting::VertexPair;
use crate::setting::minkowski::MinkowskiDifference;
use crate::solve::observe::Observer;

/// What became of an old portal.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Followed {
    /// A portal around the line.
    Portal(Portal, Known),
    /// Nothing of `M` seems to lie beyond an edge: its outward normal in the shadow plane (any
    /// length), and its ends, or twice a pair of vertices there.
    Rim { outward: DVec2, edge: [VertexPair; 2] },
    /// The line is too far away.
    Lost,
}

/// Faces of `M` crossed before wide portals are the shorter way (measured).
const CROSSINGS: usize = 20;

/// The same of an earlier portal, beside which a cast from scratch is the shorter way (measured).
const FOLLOWED: usize = 8;

/// A line this many widths of the triangle beyond an edge is not reached face by face (measured).
const FAR: f64 = 1.2;

/// From farther than this, in the same widths, the tables of both bodies are asked for the vertex there, which is
/// sooner than to climb to it (measured).
const TOO_FAR_TO_CLIMB: f64 = 4.0;

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
pub(crate) fn follow<O: Observer>(context: &mut Context<O>, last: &ContactPortal) -> Followed {
    let [a, b, c] = last.pairs;
    let mut portal =
        [context.difference.vertex(a), context.difference.vertex(b), context.difference.vertex(c)];
    let [a, b, c] = portal.map(|p| p.shadow());
    if (b - a).perp_dot(c - a) < 0.0 {
        portal.swap(0, 1);
    }
    let mut edge = match crossed(context, &portal) {
        Line::Beyond(from) => Edge::of(&portal, from),
        Line::Inside(known) => return Followed::Portal(portal, known),
    };
    let shift = a * last.weights[0] + b * last.weights[1] + c * last.weights[2];
    let Some(slopes) = slopes(&context.difference, last, shift) else { return Followed::Lost };
    if edge.distance() > FAR * edge.width() {
        let slope = continued(&context.difference, shift, slopes);
        let climbs = edge.distance() <= TOO_FAR_TO_CLIMB * edge.width();
        match jump(context, slope, climbs.then_some(last.pairs[0])) {
            Some(Beside::Edge(there, found)) => {
                return Followed::Portal(there, Known::Lowest(found));
            }
            Some(Beside::Face(there)) => portal = there,
            None => return Followed::Lost,
        }
        match left_behind(context, &portal) {
            Line::Beyond(from) => edge = Edge::of(&portal, from),
            Line::Inside(known) => return Followed::Portal(portal, known),
        }
    }
    walk(context, edge, FOLLOWED)
}

/// From a face of `M` to the one that the line pierces, over one edge after another, of which the
/// first is given.
#[inline(never)]
fn walk<O: Observer>(context: &mut Context<O>, mut edge: Edge, most: usize) -> Followed {
    for _ in 0..most {
        context.watch.portal(|| [edge.from.at, edge.to.at, edge.third.at]);
        let Some(tilt) = edge.tilt() else { return Followed::Lost };
        // The edge that was crossed has the line on its left now.
        let Some(point) = first_met(&context.difference, &edge.from, &tilt) else {
            let ends = [edge.from.pair, edge.to.pair];
            return Followed::Rim { outward: tilt.outward, edge: ends };
        };
        let portal = [edge.to, edge.from, point];
        match left_behind(context, &portal) {
            Line::Beyond(from) => edge = Edge::of(&portal, from),
            Line::Inside(known) => return Followed::Portal(portal, known),
        }
    }
    Followed::Lost
}

/// How much is done to get from a guess to the line, face by face.
pub(crate) struct Patience {
    /// How often the guess is corrected by the ellipsoids' curvature before the walk begins.
    corrections: usize,
    /// A line no farther than this, in widths of the last triangle that is so near, is walked to if
    /// corrections come no nearer. From farther away wide portals are the shorter way.
    reach: f64,
    /// Faces of `M` crossed before wide portals are the shorter way.
    crossings: usize,
}

/// For a guess from ellipsoids, and for one that is right or wrong (both measured).
pub(crate) const OF_ELLIPSOIDS: Patience =
    Patience { corrections: 3, reach: 8.0, crossings: CROSSINGS };
pub(super) const OF_RIMS: Patience = Patience { corrections: 0, reach: 4.0, crossings: 8 };

/// A correction that leaves more of the distance from the line than this share says that the bodies
/// are no ellipsoids.
const PROGRESS: f64 = 0.5;

/// From a guessed normal: the face of `M` beside its support point, and from there to the line.
///
/// Where the support point is itself on the line, or nearly so, its plane may prove that the portal
/// reached is the lowest. Beside what became of it, the support point that corrections led to, from where
/// to go on if no portal is reached.
#[inline(always)]
#[expect(clippy::inline_always, reason = "passed through memory its result stalls its reader")]
pub(crate) fn approach<O: Observer>(
    context: &mut Context<O>,
    start: &FirstNormal,
    patience: &Patience,
) -> (Followed, FirstNormal) {
    let reached = |portal, known| (Followed::Portal(portal, known), *start);
    let mut slope = start.normal.truncate();
    let mut vertex = context.support(normal_of(slope), start.near);
    let mut within_reach = None;
    // A corner that is farthest in what seems to be a face need not be one, and proves nothing.
    let mut is_support = true;
    for corrections in 0.. {
        let shadow = vertex.shadow();
        let mut toward_line = -shadow;
        let touching = context.difference.touching();
        if is_support && shadow.length_squared() <= touching * touching {
            match pointed(context, &vertex, slope) {
                Pointed::Lowest(portal, known) => return reached(portal, known),
                Pointed::Toward(line) => toward_line = line,
                Pointed::Unknown => {}
            }
        }
        let portal = match beside(context, &vertex, slope, toward_line) {
            Some(Beside::Face(portal)) => portal,
            Some(Beside::Edge(portal, found)) => {
                return reached(portal, Known::Lowest(found));
            }
            None => break,
        };
        let from = match left_behind(context, &portal) {
            Line::Beyond(from) => from,
            Line::Inside(known) => return reached(portal, known),
        };
        let edge = Edge::of(&portal, from);
        let [distance, width] = [edge.distance(), edge.width()];
        if distance <= patience.reach * width {
            within_reach = Some(edge);
        }
        if distance <= FAR * width || corrections == patience.corrections {
            break;
        }
        if has_large_faces(&context.difference) {
            match across(context, portal, from) {
                Flat::Portal(portal, known) => return reached(portal, known),
                Flat::Corner(normal, corner) => {
                    (slope, vertex) = (normal.truncate() / normal.z, corner);
                    is_support = false;
                    continue;
                }
                Flat::No => {}
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
        if after > PROGRESS * PROGRESS * before {
            break;
        }
    }
    let nearest = FirstNormal { normal: normal_of(slope), near: Some(vertex.pair) };
    let followed =
        within_reach.map_or(Followed::Lost, |edge| walk(context, edge, patience.crossings));
    (followed, nearest)
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

/// The face of `M` at the support point along a slope, on the side of the line; that point may be known to be near a
/// pair.
fn jump<O: Observer>(
    context: &mut Context<O>,
    slope: DVec2,
    near: Option<VertexPair>,
) -> Option<Beside> {
    if !slope.is_finite() {
        return None;
    }
    let vertex = context.support(normal_of(slope), near);
    beside(context, &vertex, slope, -vertex.shadow())
}
