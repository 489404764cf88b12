//! Test whether a shell of one solid, open or closed, lies inside the closed shells of the other.
//!
//! - A general point of the shell decides: a corner or, if the corners lie on the other surface, a mean of corners
//!   whose weights are powers of two.
//! - A ray starts at this point along the direction. It is displaced laterally by an infinitesimal amount, first along
//!   one axis of the world and then along another, so that it passes no edge.
//! - A facet ahead counts 1 if the ray leaves through it, and -1 if it enters. The sum is the winding number: the
//!   number of pieces that contain the point.
//! - If all points of the shell that are tried lie on the other surface, the shell touches a piece along facets. It is
//!   then inside if one of the points is inside another piece.

use std::cmp::Ordering;
use std::collections::HashSet;

use glam::DVec3;

use super::line;
use super::projected::Projected;
use super::scene::{ExactPoint, PairFrame, PlacedBody, PlacedVertex, place_exactly};
use super::triangle::{Triangle, lies_on};
use crate::body::ShellBounds;
use crate::body::edges::NO_NEIGHBOUR;
use colltrans_convex::body::Aabb;
use colltrans_kernel::extended::ExtendedPoint;
use colltrans_kernel::integer::Integer;

/// Maximum number of triangles of a shell that are tried for a point off the other surface. A shell inside touches the
/// other surface in isolated points only. Therefore the first or second triangle has such a point, unless the shell
/// touches along facets.
const MOST_TRIANGLES: usize = 16;
/// Weights of points within a facet.
pub(crate) const WEIGHTS: [[f64; 3]; 4] =
    [[0.5, 0.25, 0.25], [0.25, 0.5, 0.25], [0.25, 0.25, 0.5], [0.0, 0.5, 0.5]];

/// Finds a shell of one body that lies inside the other, and returns a triangle of it; `None` if there is none.
pub(crate) fn shell_inside(scene: &PairFrame, moving: bool) -> Option<u32> {
    shells_inside(scene, moving).next()
}

/// Finds the shells of one body that lie inside the other, and returns a triangle of each.
pub(crate) fn shells_inside(scene: &PairFrame, moving: bool) -> impl Iterator<Item = u32> {
    let (own, other) = (scene.side(moving), scene.side(!moving));
    let room = other.solid.has_interior().then(|| Projected::new(scene, other, 0));
    room.into_iter()
        .flat_map(move |room| {
            let spans = own.solid.shell_bounds().iter();
            spans.filter(move |span| is_span_inside(scene, (own, other), &room, span))
        })
        .map(|span| span.triangle)
}

/// Checks whether a shell of one body lies inside the other one, whose bounds are given.
fn is_span_inside(
    scene: &PairFrame,
    (own, other): (&PlacedBody, &PlacedBody),
    room: &Projected,
    span: &ShellBounds,
) -> bool {
    let (middle, half) = (span.bounds.center(), span.bounds.side_lengths() * 0.5);
    let at = own.view * middle + own.view_offset;
    let rows = own.view.transpose();
    let swell = own.max_displacement();
    let extent = [rows.x_axis, rows.y_axis, rows.z_axis].map(|r| r.abs().dot(half));
    let extent = DVec3::from_array(extent) + DVec3::splat(4.0 * scene.noise);
    let grown = |by: f64| {
        let extent = (extent + by).max(DVec3::ZERO);
        Aabb { low: at - extent, high: at + extent }
    };
    // A shell that extends beyond the other body's box is not inside it. The offset may shorten its extent by
    // `swell`.
    let around = grown(swell);
    let within = room.bounds.expanded(16.0 * scene.noise).contains_box(&grown(-swell));
    // Boxes that are not aligned are loose. Then every shell whose box meets the other one is tested.
    let meets = room.bounds.intersects(&around);
    let aligned = own.aligned == [true; 3] && other.aligned == [true; 3];
    meets && (within || !aligned) && is_shell_inside(scene, own, other, span.triangle)
}

/// Checks whether the shell that contains this triangle of a body is inside the other body.
pub(crate) fn is_inside(scene: &PairFrame, moving: bool, triangle: u32) -> bool {
    is_shell_inside(scene, scene.side(moving), scene.side(!moving), triangle)
}

fn is_shell_inside(scene: &PairFrame, own: &PlacedBody, other: &PlacedBody, triangle: u32) -> bool {
    if own.solid.is_without_area(triangle as usize) {
        let [p, q, _] = own.corners(triangle as usize);
        return [p, q].iter().any(|end| match winding_number(scene, other, end) {
            Some(winding) => winding > 0,
            None => is_inside_other_piece(scene, other, end),
        });
    }
    let mut seen = [triangle; MOST_TRIANGLES];
    let (mut count, mut next) = (1, 0);
    while next < count {
        let t = seen[next];
        next += 1;
        let corners = own.corners(t as usize);
        for corner in &corners {
            if let Some(winding) = winding_number(scene, other, corner) {
                return winding > 0;
            }
        }
        for mean in facet_means(scene, corners) {
            if let Some(winding) = winding_number(scene, other, &mean) {
                return winding > 0;
            }
        }
        for &n in &own.solid.neighbours()[t as usize] {
            if n != NO_NEIGHBOUR && count < MOST_TRIANGLES && !seen[..count].contains(&n) {
                seen[count] = n;
                count += 1;
            }
        }
    }
    // All points lie on the other surface. A shell that only touches one piece may be inside another one.
    seen[..count].iter().any(|&t| {
        let mut means = facet_means(scene, own.corners(t as usize));
        means.any(|mean| is_inside_other_piece(scene, other, &mean))
    })
}

/// Finds the shells of one body that lie inside the other one and bound material of their own body, and returns a
/// triangle of each. The surfaces of the bodies do not cross.
///
/// An open shell bounds no material, nor does a shell that lies inside another piece. The latter is certain if it crosses
/// no other shell. The other shells inside are excluded by their boxes, and the shells outside by the other body's
/// surface, which they do not cross.
pub(crate) fn bounding_shells_inside(scene: &PairFrame, moving: bool) -> impl Iterator<Item = u32> {
    let own = scene.side(moving);
    let inside: HashSet<u32> = shells_inside(scene, moving)
        .filter(|triangle| !own.solid.is_open(*triangle as usize))
        .collect();
    let spans = own.solid.shell_bounds().iter();
    let spans: Vec<&ShellBounds> = spans.filter(|span| inside.contains(&span.triangle)).collect();
    let meets = spans_that_meet(&spans);
    let is_within_piece = |span: &ShellBounds| {
        let mut means = facet_means(scene, own.corners(span.triangle as usize));
        !meets.contains(&span.triangle)
            && means.all(|mean| is_inside_other_piece(scene, own, &mean))
    };
    let bounding: Vec<u32> =
        spans.iter().filter(|span| !is_within_piece(span)).map(|span| span.triangle).collect();
    bounding.into_iter()
}

/// Returns the triangles of the shells whose boxes meet the box of another shell, by a sweep along the axis along which
/// the boxes are shortest, relative to the box of all.
fn spans_that_meet(spans: &[&ShellBounds]) -> HashSet<u32> {
    let whole = spans.iter().fold(Aabb::EMPTY, |all, span| all.union(&span.bounds));
    let lengths = spans.iter().map(|span| span.bounds.side_lengths()).sum::<DVec3>();
    let sides = whole.side_lengths();
    let shares = DVec3::select(sides.cmpgt(DVec3::ZERO), lengths / sides, DVec3::INFINITY);
    let axis = shares.min_position();
    let mut sorted = spans.to_vec();
    sorted.sort_by(|a, b| a.bounds.low[axis].total_cmp(&b.bounds.low[axis]));
    let (mut meets, mut active) = (HashSet::new(), Vec::<&ShellBounds>::new());
    for span in sorted {
        active.retain(|other| other.bounds.high[axis] >= span.bounds.low[axis]);
        for other in &active {
            if other.bounds.intersects(&span.bounds) {
                meets.extend([span.triangle, other.triangle]);
            }
        }
        active.push(span);
    }
    meets
}

/// Iterates over points of a facet.
fn facet_means(scene: &PairFrame, corners: [PlacedVertex; 3]) -> impl Iterator<Item = FacetMean> {
    WEIGHTS.into_iter().map(move |weights| FacetMean::new(scene, corners, weights))
}

/// A weighted mean of the corners of a facet.
pub(crate) struct FacetMean {
    at: DVec3,
    moving: bool,
    terms: [(f64, DVec3); 3],
}

impl FacetMean {
    pub(crate) fn new(scene: &PairFrame, corners: [PlacedVertex; 3], weights: [f64; 3]) -> Self {
        let terms = [0, 1, 2].map(|k| (weights[k], corners[k].local));
        let local: DVec3 = terms.iter().map(|(w, p)| *p * *w).sum();
        let side = scene.side(corners[0].moving);
        Self { at: side.view * local + side.view_offset, moving: corners[0].moving, terms }
    }
}

impl ExactPoint for FacetMean {
    fn query_position(&self) -> DVec3 {
        self.at
    }

    fn is_exact(&self) -> bool {
        false
    }

    fn exact_position(&self, _: &PairFrame) -> Option<DVec3> {
        None
    }

    fn integer_position<const N: usize>(&self, scene: &PairFrame) -> [Integer<N>; 3] {
        place_exactly(scene.side(self.moving), &self.terms)
    }

    fn double_double_position(&self, scene: &PairFrame) -> ExtendedPoint {
        let side = scene.side(self.moving);
        ExtendedPoint::from_products(&side.matrix, side.offset, &self.terms)
    }
}

/// Computes the winding number of a point: the number of closed shells of a solid around the point, where the wall of a
/// cavity counts -1. `None` if the point lies on a closed shell.
pub(crate) fn winding_number(
    scene: &PairFrame,
    side: &PlacedBody,
    point: &impl ExactPoint,
) -> Option<i32> {
    let mut winding = 0;
    let is_off = visit_facets(scene, side, point, 0, &mut |_, count| {
        winding += count?;
        Some(())
    });
    is_off.map(|()| winding)
}

/// Checks whether a point is inside a body of the solid on whose surface it does not lie.
fn is_inside_other_piece(scene: &PairFrame, side: &PlacedBody, point: &impl ExactPoint) -> bool {
    let body = |shell: &ShellBounds| side.solid.body_numbers()[shell.triangle as usize];
    let [first, others @ ..] = side.solid.shell_bounds() else { return false };
    if others.iter().all(|shell| body(shell) == body(first)) {
        return false;
    }
    let (mut ahead, mut on) = (Vec::new(), Vec::new());
    visit_facets(scene, side, point, 0, &mut |t, count| {
        match count {
            Some(0) => {}
            Some(count) => ahead.push((t, count)),
            None => on.push(t),
        }
        Some(())
    });
    line::is_around(side.solid, &ahead, &on)
}

/// Calls `take` for the facets of closed shells in a node that are ahead of a point or contain it, until it returns
/// `None`. It receives a facet's contribution to the winding number, or `None` if the point lies on the facet.
fn visit_facets(
    scene: &PairFrame,
    side: &PlacedBody,
    point: &impl ExactPoint,
    at: u32,
    take: &mut impl FnMut(usize, Option<i32>) -> Option<()>,
) -> Option<()> {
    let (p, noise) = (point.query_position(), 4.0 * scene.noise);
    let node = &side.solid.nodes()[at as usize];
    let projected = Projected::new(scene, side, at as usize);
    let Aabb { low, high } = projected.bounds.expanded(noise);
    if (0..2).any(|k| p[k] < low[k] || p[k] > high[k]) || p.z > high.z {
        return Some(());
    }
    if !node.is_leaf() {
        let [first, second] = node.child_positions(at);
        visit_facets(scene, side, point, first, take)?;
        return visit_facets(scene, side, point, second, take);
    }
    let axes = lateral_axes(scene);
    // Open shells enclose no volume.
    for t in node.facets().filter(|&t| !side.solid.is_open(t)) {
        let is_on = lies_on(scene, point, &Triangle::new(side, t));
        take(t, (!is_on).then(|| crossing_sign(scene, side.corners(t), point, axes)))?;
    }
    Some(())
}

/// Returns the two axes of the world other than the one with the largest component of the direction.
fn lateral_axes(scene: &PairFrame) -> [usize; 2] {
    let main = scene.setting.direction.abs().max_position();
    [(main + 1) % 3, (main + 2) % 3]
}

/// Returns 1 if the ray from the point leaves through the triangle, -1 if it enters, 0 if it misses the triangle.
fn crossing_sign(
    scene: &PairFrame,
    [a, b, c]: [PlacedVertex; 3],
    point: &impl ExactPoint,
    axes: [usize; 2],
) -> i32 {
    let facing = scene.turn(&a, &b, &c);
    if facing == Ordering::Equal {
        return 0;
    }
    let beside = |u: &PlacedVertex, v: &PlacedVertex| {
        scene
            .turn(u, v, point)
            .then_with(|| scene.drift_sign(axes[0], u, v))
            .then_with(|| scene.drift_sign(axes[1], u, v))
    };
    let passes = beside(&a, &b) == facing && beside(&b, &c) == facing && beside(&c, &a) == facing;
    if !passes || scene.side_of_plane(&a, &b, &c, point) != facing.reverse() {
        return 0;
    }
    if facing == Ordering::Greater { 1 } else { -1 }
}
