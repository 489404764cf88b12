//! Large faces: from a corner of a face of `M` to the triangle in it around the line.
//!
//! Notation. A face of `M` in a supporting plane is the difference of what lies in the plane of
//! either body: a face, an edge or a vertex. Its point farthest in a lateral direction is made of the
//! farthest ones of both, which are looked for around the boundaries of the two.
//!
//! Gift wrapping would go round such a face triangle by triangle. Here each step goes as far as
//! the face reaches beyond the edge over which the line has left a triangle.

use glam::DVec3;

use super::edge::{Edge, left_behind};
use super::refine::plane_normal;
use super::{Context, Known, Line, Portal};
use crate::body::ConvexPolyhedron;
use crate::setting::VertexPair;
use crate::setting::minkowski::{MinkowskiDifference, Point};
use crate::solve::observe::Observer;

/// Where a face ends.
pub(super) enum Flat {
    /// The line pierces it.
    Portal(Portal, Known),
    /// The line is beyond: the normal of the face (shadow frame), and its corner on that side.
    Corner(DVec3, Point),
    /// Nothing flat.
    No,
}

/// Steps around a face: each leaves half of it behind, or nearly so.
const MAX_STEPS: usize = 12;

/// Bodies with more vertices than this may have faces that are too long to go around (measured).
const MOST_VERTICES: usize = 256;

/// Whether one of the bodies has faces with many corners, and neither has too many.
#[inline]
pub(super) fn has_large_faces(difference: &MinkowskiDifference) -> bool {
    let setting = difference.setting;
    let most = setting.moving.vertices().len().max(setting.fixed.vertices().len());
    let large = |body: &ConvexPolyhedron| body.face_count() < body.vertices().len();
    most <= MOST_VERTICES && (large(setting.moving) || large(setting.fixed))
}

/// From a triangle of a face, and the corner where an edge begins over which the line has left it.
#[inline(never)]
pub(super) fn across<O: Observer>(
    context: &mut Context<O>,
    mut portal: Portal,
    mut from: usize,
) -> Flat {
    let Some(normal) = plane_normal(&context.difference, &portal) else { return Flat::No };
    let mut face = None;
    for _ in 0..MAX_STEPS {
        context.watch.portal(|| portal.map(|p| p.at));
        let edge = Edge::of(&portal, from);
        let outward = edge.outward();
        let (p, q) =
            *face.get_or_insert_with(|| in_plane(&context.difference, edge.from.pair, normal));
        let far = farthest(&context.difference, (p, q), outward.extend(0.0));
        let beyond = outward.dot(far.shadow() - edge.from.shadow());
        if beyond <= context.difference.touching() * outward.length() {
            return Flat::No;
        }
        if outward.dot(far.shadow()) <= 0.0 {
            return Flat::Corner(normal, far);
        }
        portal = [edge.to, edge.from, far];
        match left_behind(context, &portal) {
            Line::Beyond(next) => from = next,
            Line::Inside(known) => return Flat::Portal(portal, known),
        }
    }
    Flat::No
}

/// What of a body lies in its supporting plane.
#[derive(Debug, Clone, Copy)]
enum InPlane {
    Vertex(u32),
    Edge([u32; 2]),
    Face(u32),
}

/// What of both bodies lies in the plane across `normal` at a pair of vertices.
fn in_plane(
    difference: &MinkowskiDifference,
    pair: VertexPair,
    normal: DVec3,
) -> (InPlane, InPlane) {
    let [moving, fixed] = pair.numbers();
    let setting = difference.setting;
    // Along the normal times its length.
    let near = difference.touching() * normal.length();
    let p = part_in_plane(setting.moving, moving, difference.in_moving(normal), near);
    let q = part_in_plane(setting.fixed, fixed, difference.in_fixed(normal), near);
    (p, q)
}

/// What of a body lies within `near` of the plane across `normal` at a vertex.
fn part_in_plane(body: &ConvexPolyhedron, vertex: u32, normal: DVec3, near: f64) -> InPlane {
    let here = body.vertices()[vertex as usize];
    let is_in = |w: u32| normal.dot(body.vertices()[w as usize] - here).abs() <= near;
    let neighbours = body.neighbours(vertex);
    let outgoing = body.topology().outgoing(vertex);
    let mut found = InPlane::Vertex(vertex);
    for (k, &w) in neighbours.iter().enumerate() {
        if !is_in(w) {
            continue;
        }
        let next = if k + 1 == neighbours.len() { 0 } else { k + 1 };
        if next != k && !outgoing.is_empty() && is_in(neighbours[next]) {
            // The face between a neighbour and the next one is on the left of the half-edge to the
            // next.
            return InPlane::Face(body.topology().half_edge(outgoing[next]).face);
        }
        found = InPlane::Edge([vertex, w]);
    }
    found
}

/// The point of a face of `M` farthest along a lateral direction (shadow frame).
fn farthest(difference: &MinkowskiDifference, (p, q): (InPlane, InPlane), outward: DVec3) -> Point {
    let setting = difference.setting;
    let moving = farthest_of(setting.moving, p, -difference.in_moving(outward));
    let fixed = farthest_of(setting.fixed, q, difference.in_fixed(outward));
    difference.vertex(VertexPair::of(moving, fixed))
}

fn farthest_of(body: &ConvexPolyhedron, part: InPlane, direction: DVec3) -> u32 {
    let along = |v: u32| direction.dot(body.vertices()[v as usize]);
    match part {
        InPlane::Vertex(v) => v,
        InPlane::Edge([v, w]) => {
            if along(w) > along(v) {
                w
            } else {
                v
            }
        }
        InPlane::Face(face) => {
            let mut best = (u32::MAX, f64::NEG_INFINITY);
            for v in body.face_vertices(face) {
                let reach = along(v);
                if reach > best.1 {
                    best = (v, reach);
                }
            }
            best.0
        }
    }
}
