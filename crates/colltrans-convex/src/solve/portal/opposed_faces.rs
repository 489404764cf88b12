//! Large faces that face each other, as those of parts that stand on each other do.
//!
//! Notation. `f` and `g` are large faces of `P` and of `Q`, those most nearly across the direction; of
//! those with few corners, exactly so. Where one plane supports both bodies in them, `g - f` is a face of
//! `M`. Its boundary is gone round by going round those of both; a quarter of the way at a time this leads
//! to four points of `g - f`, wide apart if one begins at corners opposite each other. If the line meets `g - f`
//! between them, that is the answer, without a search. If it does not, and the faces are those of boxes, the
//! shadow of `M` may end at the edge that it passes.

use glam::DVec3;

use super::edge::Edge;
use super::plane::{Face, Plane};
use super::refine::{is_wide, weights};
use super::ties::met_share;
use super::{Context, Followed, Known, Portal};
use crate::body::{ConvexPolyhedron, LargeFace};
use crate::setting::VertexPair;
use crate::setting::minkowski::{MinkowskiDifference, Point};
use crate::solve::observe::{Observer, Support};

/// Least cosine of the angle between normals of faces that may be parallel: whether they are is seen
/// by how far the bodies reach beyond a plane through both.
const PARALLEL: f64 = 1.0 - 1e-12;

/// The lowest face and a portal in it, if it is the difference of two large faces and the line passes
/// well inside; of rectangles also the edge that the line does not clearly pass on the inside.
#[inline]
pub(crate) fn facing<O: Observer>(context: &mut Context<O>) -> Followed {
    let setting = context.difference.setting;
    if !setting.moving.has_large_faces() || !setting.fixed.has_large_faces() {
        return Followed::Lost;
    }
    let down = context.difference.in_moving(DVec3::Z);
    let Some(f) = setting.moving.large_face_toward(down) else { return Followed::Lost };
    if f.has_few_corners() && f.normal.dot(down) < PARALLEL {
        return Followed::Lost;
    }
    let found = between(&context.difference, f).unwrap_or(Followed::Lost);
    if let Followed::Portal(portal, Known::Lowest(Face { plane, .. })) = &found {
        context.watch.portal(|| portal.map(|p| p.at));
        let normal = || context.difference.setting_from_shadow.transpose() * plane.normal;
        context.watch.support(|| Support::of(normal(), &context.difference.vertex(plane.lowest)));
    }
    found
}

/// The same between a face of the moving body and one of the fixed body.
#[inline(never)]
fn between(difference: &MinkowskiDifference, f: &LargeFace) -> Option<Followed> {
    let setting = difference.setting;
    let g = setting.fixed.large_face_toward(-difference.in_fixed(DVec3::Z))?;
    let are_few = f.has_few_corners() && g.has_few_corners();
    let normal = difference.shadow_of_moving(f.normal);
    let parallel = normal.dot(difference.shadow_of_fixed(g.normal)) < -PARALLEL;
    if !parallel || normal.z <= 0.0 {
        return None;
    }
    let middle = difference.center();
    // Of bodies that are widened, the corner on this side of the middle.
    let corner = |moving: u32, fixed: u32| {
        let (moving, fixed) = (origin(setting.moving, moving), origin(setting.fixed, fixed));
        let point = difference.vertex(VertexPair::of(moving, fixed));
        if difference.widening == 0.0 {
            return point;
        }
        difference.point(point.pair, middle - point.at)
    };
    let [p, q] = opposite(difference, f, g);
    let a = corner(p, q);
    let after = |quarters: u32| {
        let moving = quarters_round(setting.moving, p, quarters);
        corner(moving, quarters_round(setting.fixed, q, 4 - quarters))
    };
    let c = after(2);
    let left = difference.is_left_rounded(&a, &c);
    let share = if left.is_none() { met_share(difference, [&a, &c], normal) } else { None };
    let (portal, weights) = if let Some(share) = share {
        ([a, after(1), c], [1.0 - share, 0.0, share])
    } else {
        let portal = if left == Some(false) { [c, a, after(1)] } else { [a, c, after(3)] };
        if let Some(from) = [1, 2].into_iter().find(|&from| !is_inside(difference, &portal, from)) {
            let edge = Edge::of(&portal, from);
            let ends = [edge.from.pair, edge.to.pair];
            return are_few.then_some(Followed::Rim { outward: edge.outward(), edge: ends });
        }
        left.map(|_| (portal, weights(&portal)))?
    };
    let is_level = |p: &Point| normal.dot(p.at - a.at).abs() <= difference.noise.point();
    let [from, to, third] = portal.each_ref().map(Point::shadow);
    let area = (to - from).perp_dot(third - from);
    if !portal.iter().all(is_level) || !is_wide(difference, &portal, area) {
        return None;
    }
    // Of faces with few corners, a look at all vertices proves more.
    let plane = if are_few {
        Plane::at(difference, normal, a.pair)?
    } else {
        Plane::of_faces(difference, normal, f, g)?
    };
    Some(Followed::Portal(portal, Known::Lowest(Face { plane, weights })))
}

/// Half-edges that leave a corner of `f` and, of corners of `g` a quarter of the way apart, the one opposite
/// it, seen from the middles of the bodies.
#[inline]
fn opposite(difference: &MinkowskiDifference, f: &LargeFace, g: &LargeFace) -> [u32; 2] {
    let (moving, fixed) = (difference.setting.moving, difference.setting.fixed);
    let place = |body: &ConvexPolyhedron, h: u32| {
        body.vertices()[origin(body, h) as usize] - body.inertia().center
    };
    let ([p, ..], [first, ..]) = (f.half_edges, g.half_edges);
    let here = difference.in_fixed(difference.shadow_of_moving(place(moving, p)));
    let mut farthest = (f64::NEG_INFINITY, first);
    for quarters in 0..4 {
        let q = quarters_round(fixed, first, quarters);
        let away = here.distance_squared(place(fixed, q));
        if away > farthest.0 {
            farthest = (away, q);
        }
    }
    [p, farthest.1]
}

fn origin(body: &ConvexPolyhedron, h: u32) -> u32 {
    body.topology().origin(h)
}

/// Whether the line is on the left of the edge that begins at a corner, by more than counts as touching if
/// rounding does not tell.
fn is_inside(difference: &MinkowskiDifference, portal: &Portal, from: usize) -> bool {
    let (start, end) = (&portal[from], &portal[(from + 1) % 3]);
    difference.is_left_rounded(start, end).unwrap_or_else(|| {
        let edge = Edge::of(portal, from);
        -edge.distance() > difference.touching() * edge.outward().length()
            && difference.is_left(start, end)
    })
}

/// The half-edge along a face that begins some quarters of the way round, at most four, after another.
fn quarters_round(body: &ConvexPolyhedron, h: u32, quarters: u32) -> u32 {
    let topology = body.topology();
    let range = topology.face(topology.half_edge(h).face);
    let count = range.end - range.start;
    let ahead = h + quarters * count / 4;
    if ahead < range.end { ahead } else { ahead - count }
}
