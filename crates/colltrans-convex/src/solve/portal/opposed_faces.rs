//! Contact of large opposed faces, for example of parts that rest on each other.
//!
//! `f` is the large face of `P` whose normal is nearest to the direction, and `g` the one of `Q` whose normal is
//! nearest to the opposite direction. If `f` has few corners, it must be perpendicular to the direction up to
//! rounding. If one plane supports both bodies in these faces, `g - f` is a face of `M`.
//!
//! The boundaries of `f` and `g` together yield that of `g - f`. Steps of a quarter of both boundaries give four
//! points of `g - f`, which are far apart if the first corners are opposite each other. If the line meets `g - f`
//! between them, the contact is found without a search. If it does not and both faces have few corners, as those of
//! boxes, the edge that it passes may belong to the silhouette.

use glam::DVec3;

use super::edge::Edge;
use super::plane::{Face, Plane};
use super::refine::{is_wide, line_weights};
use super::ties::met_parameter;
use super::{Context, Portal, PortalStatus, WalkResult};
use crate::body::{ConvexPolyhedron, LargeFace};
use crate::setting::VertexPair;
use crate::setting::minkowski::{MinkowskiDifference, ShadowPoint};
use crate::solve::observe::{Observer, Support};

/// Minimum cosine of the angle between the normals of faces that may be parallel. Whether they are is decided by the
/// excess of the bodies beyond a plane through both.
const MIN_PARALLEL_COSINE: f64 = 1.0 - 1e-12;

/// Returns the lowest face and a portal in it, if this face is the difference of two large faces and
/// the line passes well inside.
///
/// For faces with few corners, the result may also be the edge that the line does not clearly pass on
/// the inside. Otherwise the result is `Lost`.
#[inline]
pub(crate) fn opposed_face_contact<O: Observer>(context: &mut Context<O>) -> WalkResult {
    let setting = context.difference.setting;
    if !setting.moving.has_large_faces() || !setting.fixed.has_large_faces() {
        return WalkResult::Lost;
    }
    let down = context.difference.to_moving_frame(DVec3::Z);
    let Some(f) = setting.moving.large_face_toward(down) else { return WalkResult::Lost };
    if f.has_few_corners() && f.normal.dot(down) < MIN_PARALLEL_COSINE {
        return WalkResult::Lost;
    }
    let found = face_pair_contact(&context.difference, f).unwrap_or(WalkResult::Lost);
    if let WalkResult::Portal(portal, PortalStatus::Lowest(Face { plane, .. })) = &found {
        context.watch.portal(|| portal.map(|p| p.coordinates));
        let normal = || context.difference.setting_from_shadow.transpose() * plane.normal;
        context.watch.support(|| {
            Support::from_point(normal(), &context.difference.vertex_point(plane.lowest))
        });
    }
    found
}

/// Computes the contact of the large face `f` of the moving body with a face of the fixed body.
///
/// `None` if the faces are not parallel, their plane does not support `M`, or the line is not shown to pass
/// inside the four points.
#[inline(never)]
fn face_pair_contact(difference: &MinkowskiDifference, f: &LargeFace) -> Option<WalkResult> {
    let setting = difference.setting;
    let g = setting.fixed.large_face_toward(-difference.to_fixed_frame(DVec3::Z))?;
    let have_few_corners = f.has_few_corners() && g.has_few_corners();
    let normal = difference.moving_normal_to_shadow(f.normal);
    let parallel = normal.dot(difference.fixed_normal_to_shadow(g.normal)) < -MIN_PARALLEL_COSINE;
    if !parallel || normal.z <= 0.0 {
        return None;
    }
    let middle = difference.center_difference();
    // For widened bodies, the corner of the widening rectangle that is farther from the centre of `M`.
    let corner = |moving: u32, fixed: u32| {
        let (moving, fixed) =
            (origin_vertex(setting.moving, moving), origin_vertex(setting.fixed, fixed));
        let point = difference.vertex_point(VertexPair::from_indices(moving, fixed));
        if difference.widening == 0.0 {
            return point;
        }
        difference.widened_point(point.pair, middle - point.coordinates)
    };
    let [p, q] = opposite_corners(difference, f, g);
    let a = corner(p, q);
    let after = |quarters: u32| {
        let moving = half_edge_at_quarter(setting.moving, p, quarters);
        corner(moving, half_edge_at_quarter(setting.fixed, q, 4 - quarters))
    };
    let c = after(2);
    let left = difference.is_left_rounded(&a, &c);
    let share = if left.is_none() { met_parameter(difference, [&a, &c], normal) } else { None };
    let (portal, weights) = if let Some(share) = share {
        ([a, after(1), c], [1.0 - share, 0.0, share])
    } else {
        let portal = if left == Some(false) { [c, a, after(1)] } else { [a, c, after(3)] };
        if let Some(from) =
            [1, 2].into_iter().find(|&from| !is_line_left_of(difference, &portal, from))
        {
            let edge = Edge::from_corner(&portal, from);
            let ends = [edge.from.pair, edge.to.pair];
            return have_few_corners
                .then_some(WalkResult::Silhouette { outward: edge.outward(), edge: ends });
        }
        left.map(|_| (portal, line_weights(&portal)))?
    };
    let is_level = |p: &ShadowPoint| {
        normal.dot(p.coordinates - a.coordinates).abs() <= difference.noise.point_error()
    };
    let [from, to, third] = portal.each_ref().map(ShadowPoint::shadow);
    let area = (to - from).perp_dot(third - from);
    if !portal.iter().all(is_level) || !is_wide(difference, &portal, area) {
        return None;
    }
    // Bodies of faces with few corners are scanned vertex by vertex, which proves a tighter bound.
    let plane = if have_few_corners {
        Plane::if_supported_at(difference, normal, a.pair)?
    } else {
        Plane::from_large_faces(difference, normal, f, g)?
    };
    Some(WalkResult::Portal(portal, PortalStatus::Lowest(Face { plane, weights })))
}

/// Returns half-edges that leave a corner of `f` and the corner of `g` opposite it, relative to the
/// centres of the bodies. Considers four corners of `g`, a quarter of its boundary apart.
#[inline]
fn opposite_corners(difference: &MinkowskiDifference, f: &LargeFace, g: &LargeFace) -> [u32; 2] {
    let (moving, fixed) = (difference.setting.moving, difference.setting.fixed);
    let place = |body: &ConvexPolyhedron, h: u32| {
        body.vertices()[origin_vertex(body, h) as usize] - body.inertia().center
    };
    let ([p, ..], [first, ..]) = (f.half_edges, g.half_edges);
    let first_corner =
        difference.to_fixed_frame(difference.moving_normal_to_shadow(place(moving, p)));
    let mut farthest = (f64::NEG_INFINITY, first);
    for quarters in 0..4 {
        let q = half_edge_at_quarter(fixed, first, quarters);
        let away = first_corner.distance_squared(place(fixed, q));
        if away > farthest.0 {
            farthest = (away, q);
        }
    }
    [p, farthest.1]
}

/// Returns the vertex at which the half-edge `h` begins.
fn origin_vertex(body: &ConvexPolyhedron, h: u32) -> u32 {
    body.topology().origin(h)
}

/// Checks that the line is on the left of the edge that begins at the corner `from`. If rounded
/// coordinates do not decide this, the distance must exceed the touching distance.
fn is_line_left_of(difference: &MinkowskiDifference, portal: &Portal, from: usize) -> bool {
    let (start, end) = (&portal[from], &portal[(from + 1) % 3]);
    difference.is_left_rounded(start, end).unwrap_or_else(|| {
        let edge = Edge::from_corner(portal, from);
        -edge.scaled_distance() > difference.touching_distance() * edge.outward().length()
            && difference.is_left(start, end)
    })
}

/// Returns the half-edge of the face that is `quarters`, at most four, quarters of its boundary after
/// `h`.
fn half_edge_at_quarter(body: &ConvexPolyhedron, h: u32, quarters: u32) -> u32 {
    let topology = body.topology();
    let range = topology.face_half_edges(topology.half_edge(h).face);
    let count = range.end - range.start;
    let ahead = h + quarters * count / 4;
    if ahead < range.end { ahead } else { ahead - count }
}
