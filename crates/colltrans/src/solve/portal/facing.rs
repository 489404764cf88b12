//! Large faces that face each other, as those of parts that stand on each other do.
//!
//! Notation. `f` and `g` are large faces of `P` and of `Q`, those most nearly across the
//! direction; of those with few corners, exactly so. Where one plane supports both bodies in them, `g - f` is a face of `M`. Its boundary is
//! gone round by going round those of both; a quarter of the way at a time this leads to four points
//! of `g - f`, wide apart if one begins at corners opposite each other. If the line meets `g - f`
//! between them, that is the answer, without a search.

use glam::DVec3;

use super::plane::{Face, Plane};
use super::refine::{is_wide, weights};
use super::tied::met_share;
use super::{Context, Portal};
use crate::body::{ConvexPolyhedron, LargeFace};
use crate::setting::VertexPair;
use crate::setting::minkowski::{MinkowskiDifference, Point};
use crate::solve::observe::{Observer, Support};

/// Least cosine of the angle between normals of faces that may be parallel: whether they are is seen
/// by how far the bodies reach beyond a plane through both.
const PARALLEL: f64 = 1.0 - 1e-12;

/// The lowest face and a portal in it, if it is the difference of two large faces and the line passes
/// well inside.
#[inline]
pub(crate) fn facing<O: Observer>(context: &mut Context<O>) -> Option<(Portal, Face)> {
    let setting = context.difference.setting;
    if !setting.moving.has_large_faces() || !setting.fixed.has_large_faces() {
        return None;
    }
    let down = context.difference.in_moving(DVec3::Z);
    let f = setting.moving.large_face_toward(down)?;
    if f.has_few_corners() && f.normal.dot(down) < PARALLEL {
        return None;
    }
    let (portal, face) = between(&context.difference, f)?;
    let plane = &face.plane;
    context.watch.portal(|| portal.map(|p| p.at));
    let normal = || context.difference.setting_from_shadow.transpose() * plane.normal;
    context.watch.support(|| Support::of(normal(), &context.difference.vertex(plane.lowest)));
    Some((portal, face))
}

/// The same between a face of the moving body and one of the fixed body.
#[inline(never)]
fn between(difference: &MinkowskiDifference, f: &LargeFace) -> Option<(Portal, Face)> {
    let setting = difference.setting;
    let g = setting.fixed.large_face_toward(-difference.in_fixed(DVec3::Z))?;
    let normal = difference.shadow_of_moving(f.normal);
    let parallel = normal.dot(difference.shadow_of_fixed(g.normal)) < -PARALLEL;
    if !parallel || normal.z <= 0.0 {
        return None;
    }
    let origin = |body: &ConvexPolyhedron, h: u32| body.topology().origin(h);
    let corner = |moving: u32, fixed: u32| {
        let (moving, fixed) = (origin(setting.moving, moving), origin(setting.fixed, fixed));
        difference.vertex(VertexPair::of(moving, fixed))
    };
    // Of corners of `g` a quarter of the way apart, the one opposite a corner of `f`, seen from the middles.
    let ([p, ..], [first, ..]) = (f.half_edges, g.half_edges);
    let place = |body: &ConvexPolyhedron, h: u32| {
        body.vertices()[origin(body, h) as usize] - body.inertia().center
    };
    let here = difference.in_fixed(difference.shadow_of_moving(place(setting.moving, p)));
    let mut opposite = (f64::NEG_INFINITY, first);
    for quarters in 0..4 {
        let q = quarters_round(setting.fixed, first, quarters);
        let away = here.distance_squared(place(setting.fixed, q));
        if away > opposite.0 {
            opposite = (away, q);
        }
    }
    let q = opposite.1;
    let a = corner(p, q);
    let after = |quarters: u32| {
        let moving = quarters_round(setting.moving, p, quarters);
        corner(moving, quarters_round(setting.fixed, q, 4 - quarters))
    };
    let c = after(2);
    let (portal, weights) = if let Some(left) = difference.is_left_rounded(&a, &c) {
        let portal = if left { [a, c, after(3)] } else { [c, a, after(1)] };
        let [from, to, third] = &portal;
        let inside = difference.is_left_rounded(to, third) == Some(true)
            && difference.is_left_rounded(third, from) == Some(true);
        inside.then(|| (portal, weights(&portal)))?
    } else {
        let share = met_share(difference, [&a, &c], normal)?;
        ([a, after(1), c], [1.0 - share, 0.0, share])
    };
    let is_level = |p: &Point| normal.dot(p.at - a.at).abs() <= difference.noise.point();
    let [from, to, third] = portal.each_ref().map(Point::shadow);
    let area = (to - from).perp_dot(third - from);
    if !portal.iter().all(is_level) || !is_wide(difference, &portal, area) {
        return None;
    }
    // Of faces with few corners, a look at all vertices proves more.
    let plane = if f.has_few_corners() && g.has_few_corners() {
        Plane::at(difference, normal, a.pair)?
    } else {
        Plane::of_faces(difference, normal, f, g)?
    };
    Some((portal, Face { plane, weights }))
}

/// The half-edge along a face that begins some quarters of the way round, at most four, after another.
fn quarters_round(body: &ConvexPolyhedron, h: u32, quarters: u32) -> u32 {
    let topology = body.topology();
    let range = topology.face(topology.half_edge(h).face);
    let count = range.end - range.start;
    let ahead = h + quarters * count / 4;
    if ahead < range.end { ahead } else { ahead - count }
}
