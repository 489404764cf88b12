//! Coplanar regions: from one triangle of a large face of `M` to its triangle around the line.
//!
//! A face of `M` in a supporting plane is the difference of the features of both bodies in this plane,
//! each a face, an edge or a vertex. The farthest point in a lateral direction combines the farthest
//! vertices of both features. A scan of their boundaries finds these.
//!
//! Gift wrapping would cross the face one triangle at a time. In contrast, each step here reaches the
//! farthest point of the face beyond the edge over which the line has left a triangle.

use glam::DVec3;

use super::edge::{Edge, line_position_after_crossing};
use super::refine::portal_normal;
use super::{Context, LinePosition, Portal, PortalStatus};
use crate::body::ConvexPolyhedron;
use crate::setting::VertexPair;
use crate::setting::minkowski::{MinkowskiDifference, ShadowPoint};
use crate::solve::observe::Observer;

/// Result of crossing a face.
pub(super) enum CoplanarStep {
    /// The line pierces this portal in the face.
    Portal(Portal, PortalStatus),
    /// The line is beyond the face: its normal (shadow frame), and its farthest corner on that side.
    Corner(DVec3, ShadowPoint),
    /// The triangle has no coplanar neighbour, or the walk did not reach the line.
    NotCoplanar,
}

/// Maximum number of steps in a face. Each leaves about half of the face behind.
const MAX_STEPS: usize = 12;

/// Maximum number of vertices of a body. A larger body may have faces with too many corners to scan
/// (measured).
const MAX_VERTICES: usize = 256;

/// Checks that one of the bodies has fewer faces than vertices, so that some faces have many corners,
/// and that neither has more than `MAX_VERTICES` vertices.
#[inline]
pub(super) fn has_polygonal_faces(difference: &MinkowskiDifference) -> bool {
    let setting = difference.setting;
    let most = setting.moving.vertices().len().max(setting.fixed.vertices().len());
    let large = |body: &ConvexPolyhedron| body.face_count() < body.vertices().len();
    most <= MAX_VERTICES && (large(setting.moving) || large(setting.fixed))
}

/// Walks in a face from a triangle, which the line has left over the edge that begins at the corner
/// `from`.
#[inline(never)]
pub(super) fn cross_face<O: Observer>(
    context: &mut Context<O>,
    mut portal: Portal,
    mut from: usize,
) -> CoplanarStep {
    let Some(normal) = portal_normal(&context.difference, &portal) else {
        return CoplanarStep::NotCoplanar;
    };
    let mut face = None;
    for _ in 0..MAX_STEPS {
        context.watch.portal(|| portal.map(|p| p.coordinates));
        let edge = Edge::from_corner(&portal, from);
        let outward = edge.outward();
        let (p, q) = *face
            .get_or_insert_with(|| features_in_plane(&context.difference, edge.from.pair, normal));
        let far = farthest_point(&context.difference, (p, q), outward.extend(0.0));
        let beyond = outward.dot(far.shadow() - edge.from.shadow());
        if beyond <= context.difference.touching_distance() * outward.length() {
            return CoplanarStep::NotCoplanar;
        }
        if outward.dot(far.shadow()) <= 0.0 {
            return CoplanarStep::Corner(normal, far);
        }
        portal = [edge.to, edge.from, far];
        match line_position_after_crossing(context, &portal) {
            LinePosition::BeyondEdge(next) => from = next,
            LinePosition::Inside(status) => return CoplanarStep::Portal(portal, status),
        }
    }
    CoplanarStep::NotCoplanar
}

/// Feature of a body in a supporting plane.
#[derive(Debug, Clone, Copy)]
enum Feature {
    Vertex(u32),
    Edge([u32; 2]),
    Face(u32),
}

/// Returns the features of both bodies in the plane perpendicular to `normal` at a vertex pair.
fn features_in_plane(
    difference: &MinkowskiDifference,
    pair: VertexPair,
    normal: DVec3,
) -> (Feature, Feature) {
    let [moving, fixed] = pair.indices();
    let setting = difference.setting;
    // Distances along `normal` are scaled by its length.
    let near = difference.touching_distance() * normal.length();
    let p = feature_in_plane(setting.moving, moving, difference.to_moving_frame(normal), near);
    let q = feature_in_plane(setting.fixed, fixed, difference.to_fixed_frame(normal), near);
    (p, q)
}

/// Returns the feature of a body within `near` of the plane perpendicular to `normal` at a vertex.
fn feature_in_plane(body: &ConvexPolyhedron, vertex: u32, normal: DVec3, near: f64) -> Feature {
    let here = body.vertices()[vertex as usize];
    let is_in = |w: u32| normal.dot(body.vertices()[w as usize] - here).abs() <= near;
    let neighbours = body.neighbours(vertex);
    let outgoing = body.topology().outgoing_half_edges(vertex);
    let mut found = Feature::Vertex(vertex);
    for (k, &w) in neighbours.iter().enumerate() {
        if !is_in(w) {
            continue;
        }
        let next = if k + 1 == neighbours.len() { 0 } else { k + 1 };
        if next != k && !outgoing.is_empty() && is_in(neighbours[next]) {
            // The face between a neighbour and the next one is on the left of the half-edge to the next.
            return Feature::Face(body.topology().half_edge(outgoing[next]).face);
        }
        found = Feature::Edge([vertex, w]);
    }
    found
}

/// Returns the point of a face of `M` that is farthest along a lateral direction (shadow frame).
fn farthest_point(
    difference: &MinkowskiDifference,
    (p, q): (Feature, Feature),
    outward: DVec3,
) -> ShadowPoint {
    let setting = difference.setting;
    let moving = farthest_vertex(setting.moving, p, -difference.to_moving_frame(outward));
    let fixed = farthest_vertex(setting.fixed, q, difference.to_fixed_frame(outward));
    difference.vertex_point(VertexPair::from_indices(moving, fixed))
}

/// Returns the vertex of a feature that is farthest along `direction` (body frame).
fn farthest_vertex(body: &ConvexPolyhedron, feature: Feature, direction: DVec3) -> u32 {
    let along = |v: u32| direction.dot(body.vertices()[v as usize]);
    match feature {
        Feature::Vertex(v) => v,
        Feature::Edge([v, w]) => {
            if along(w) > along(v) {
                w
            } else {
                v
            }
        }
        Feature::Face(face) => {
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
