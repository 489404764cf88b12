//! Upper bounds of the distances between a hull and the points from which it was made.
//!
//! The distance of a point from a body is at most its distance from a *witness*, a point of a triangle of the
//! body's corners. A poor choice of triangle and weights, by a walk that rounding misled or by a projection of a
//! sliver, makes the bound larger but never wrong. Therefore the bound does not depend on the thickness of the
//! body. In contrast, a point within rounding error of two face planes can be a body's width away from it.

use glam::{DVec2, DVec3};

use super::neighbours::{Neighbours, PlaneNode};
use super::quickhull::{Simplicial, Triangle, orientation};
use colltrans_kernel::determinant::triangle_area;
use colltrans_kernel::plane::polygon_normal;
use colltrans_kernel::predicates::orient2d as orientation_in_plane;
use colltrans_kernel::topology::Topology;
use colltrans_kernel::visit_counter;

/// Locator of the face that a ray from an inner point passes. It walks from face to face.
///
/// With the inner point as origin, the faces are the points `n / o` of the polar polytope, and the required face is
/// its support point. Therefore a walk to better and better neighbours ends there.
pub(in crate::body::convex) struct Locator {
    center: DVec3,
    /// Unit normal of each face, and its offset from the centre.
    planes: Vec<(DVec3, f64)>,
    neighbours: Neighbours,
}

impl Locator {
    pub(super) fn new(points: &[DVec3], hull: &Simplicial) -> Self {
        let at = |i: u32| points[i as usize];
        let corners = hull.triangles.iter().flat_map(|t| t.corners);
        let center = corners.map(at).sum::<DVec3>() / (3 * hull.triangles.len()) as f64;
        let plane = |t: &Triangle| (t.normal, t.normal.dot(at(t.corners[0]) - center));
        let planes: Vec<(DVec3, f64)> = hull.triangles.iter().map(plane).collect();
        let start = (0..=hull.triangles.len() as u32).map(|k| 3 * k).collect();
        let neighbours = hull.triangles.iter().flat_map(|t| t.neighbours).collect();
        Self { center, neighbours: Neighbours::new(start, neighbours, &planes), planes }
    }

    /// Builds the locator of a polyhedron.
    pub(in crate::body::convex) fn of_faces(vertices: &[DVec3], topology: &Topology) -> Self {
        let center = vertices.iter().sum::<DVec3>() / vertices.len() as f64;
        let plane = |face: u32| {
            let corners = topology.face_vertices(face).map(|v| vertices[v as usize]);
            let normal = polygon_normal(corners.clone());
            (
                normal,
                corners.map(|p| normal.dot(p - center)).sum::<f64>()
                    / topology.face_half_edges(face).len() as f64,
            )
        };
        let faces = 0..topology.face_count() as u32;
        let mut neighbour_start = vec![0];
        let mut neighbours = Vec::new();
        for face in faces.clone() {
            let twin_face = |h: u32| topology.half_edge(topology.half_edge(h).twin).face;
            neighbours.extend(topology.face_half_edges(face).map(twin_face));
            neighbour_start.push(neighbours.len() as u32);
        }
        let planes: Vec<(DVec3, f64)> = faces.map(plane).collect();
        let neighbours = Neighbours::new(neighbour_start, neighbours, &planes);
        Self { center, planes, neighbours }
    }

    /// Returns the largest signed distance of a point outside the face that its ray passes and the neighbours of
    /// this face; negative if it is inside them all. `near` is the face where the walk starts, and then the face
    /// where it ended.
    pub(super) fn distance_outside(&self, point: DVec3, near: &mut usize) -> f64 {
        let ray = point - self.center;
        self.walk_to_face(ray, near);
        let outside = |f: usize| self.planes[f].0.dot(ray) - self.planes[f].1;
        let bound = |node: &PlaneNode| node.max_product(ray) - node.min_offset;
        self.neighbours.best_neighbour(*near, (outside(*near), *near), outside, bound).0
    }

    /// Returns the unit normals of the faces and their offsets from the origin of the coordinates.
    pub(in crate::body::convex) fn planes_from_origin(
        &self,
    ) -> impl Iterator<Item = (DVec3, f64)> + '_ {
        self.planes.iter().map(|&(normal, offset)| (normal, offset + normal.dot(self.center)))
    }

    /// Walks to the face that a ray from the centre passes.
    fn walk_to_face(&self, ray: DVec3, near: &mut usize) {
        let passing = |f: usize| {
            let (normal, offset) = self.planes[f];
            normal.dot(ray) / offset.max(f64::MIN_POSITIVE)
        };
        let bound = |node: &PlaneNode| {
            let highest = node.max_product(ray);
            let offset = if highest > 0.0 { node.min_offset } else { node.max_offset };
            highest / offset.max(f64::MIN_POSITIVE)
        };
        let mut value = passing(*near);
        // Every step increases the value. The limit is for rounding errors.
        for _ in 0..self.planes.len() {
            let better = self.neighbours.best_neighbour(*near, (value, *near), passing, bound);
            if better.1 == *near {
                break;
            }
            (value, *near) = better;
        }
    }
}

/// Returns the largest distance of a hull's vertex outside a face plane. Polygons are flat only up to rounding.
fn max_unevenness(locator: &Locator, vertices: &[DVec3], topology: &Topology) -> f64 {
    let mut worst = 0.0_f64;
    for (face, (normal, offset)) in locator.planes.iter().enumerate() {
        for v in topology.face_vertices(face as u32) {
            worst = worst.max(normal.dot(vertices[v as usize] - locator.center) - offset);
        }
    }
    worst
}

/// Number of triangles per edge or point that may be examined one by one.
const TRIANGLES_PER_ELEMENT: usize = 128;

/// Maximum number of triangles examined to find whether points are inside.
const MAX_INSIDE_TRIANGLES: usize = 1 << 16;

/// Measures upper bounds of the distances of points from a body.
pub(super) struct Gauge<'a> {
    locator: Locator,
    vertices: &'a [DVec3],
    topology: &'a Topology,
    /// Upper bound of the rounding error of a witness.
    rounding: f64,
    /// Upper bound of the distance of the locator's centre from the body, once it is computed. Rounding can place
    /// the centre outside a thin body.
    center_bound: Option<f64>,
    /// The largest bound found, initially the unevenness of the faces.
    pub(super) violation: f64,
    /// The largest bound found for a point that is not proven to be inside.
    pub(super) input_excess: f64,
    /// Remaining number of triangles that may be examined for points for which the walk gives no good bound.
    triangle_budget: usize,
    /// Remaining number of triangles that may be examined to prove that a point is inside.
    inside_budget: usize,
}

impl<'a> Gauge<'a> {
    /// Prepares the measurement of `points` points. `rounding` is the rounding error of a witness at their size.
    pub(super) fn new(
        vertices: &'a [DVec3],
        topology: &'a Topology,
        points: usize,
        rounding: f64,
    ) -> Self {
        let locator = Locator::of_faces(vertices, topology);
        Self {
            violation: max_unevenness(&locator, vertices, topology),
            input_excess: 0.0,
            locator,
            vertices,
            topology,
            rounding,
            center_bound: None,
            triangle_budget: TRIANGLES_PER_ELEMENT * (topology.edge_count() + points),
            inside_budget: (TRIANGLES_PER_ELEMENT * (topology.edge_count() + points))
                .min(MAX_INSIDE_TRIANGLES),
        }
    }

    /// Returns an upper bound of the distance of a point from the body, and records it. The bound exceeds `enough`
    /// only if no witness is that near, or if the triangle budget is exhausted. `near` is the face where the walk
    /// starts, and then the face where it ended.
    pub(super) fn distance_bound(&mut self, p: DVec3, enough: f64, near: &mut usize) -> f64 {
        let bound = self.unrecorded_bound(p, enough, near);
        self.violation = self.violation.max(bound);
        if bound > self.input_excess && !self.is_inside(p) {
            self.input_excess = bound;
        }
        bound
    }

    /// Checks whether a point is proven to be inside the body. Returns `false` for a flat polygon, or if the budget
    /// for this test is exhausted.
    fn is_inside(&mut self, p: DVec3) -> bool {
        let count = 2 * self.topology.edge_count();
        let has_budget = self.inside_budget >= count && self.topology.face_count() > 2;
        if has_budget {
            self.inside_budget -= count;
            visit_counter::count_visits(count);
        }
        has_budget && self.contains_exactly(p)
    }

    /// Computes the bound of [`Self::distance_bound`].
    fn unrecorded_bound(&mut self, p: DVec3, enough: f64, near: &mut usize) -> f64 {
        // The front and the back of a flat polygon coincide, so the walk is not needed.
        let is_solid = self.topology.face_count() > 2;
        if is_solid {
            self.locator.walk_to_face(p - self.locator.center, near);
        }
        let outside = self.bound_by_face(p, *near, FanSearch::Foot);
        if outside <= enough {
            return outside;
        }
        let inside = if is_solid { self.bound_by_ray(p, *near) } else { f64::INFINITY };
        let count = 2 * self.topology.edge_count();
        if inside <= enough || self.triangle_budget < count {
            return outside.min(inside);
        }
        self.triangle_budget -= count;
        self.bound_by_all_faces(p).min(inside)
    }

    /// Returns the bound for a point between the centre and the face `face` of its ray; infinity for any other point.
    /// Along the ray, between the centre and the face, the distance from the convex body is at most the weighted mean
    /// of the distances at both ends.
    fn bound_by_ray(&mut self, p: DVec3, face: usize) -> f64 {
        let ray = p - self.locator.center;
        let (normal, offset) = self.locator.planes[face];
        let share = normal.dot(ray) / offset;
        if !(share > 0.0 && share < 1.0) {
            return f64::INFINITY;
        }
        let center_bound =
            self.center_bound.unwrap_or_else(|| self.bound_by_all_faces(self.locator.center));
        self.center_bound = Some(center_bound);
        let exit = self.locator.center + ray / share;
        // Scaling the ray has at most the rounding error of a witness.
        (1.0 - share) * center_bound
            + self.bound_by_face(exit, face, FanSearch::Foot)
            + self.rounding
    }

    /// Returns the smallest bound from all triangles; 0 if the point is inside, exactly.
    fn bound_by_all_faces(&self, p: DVec3) -> f64 {
        if self.contains_exactly(p) {
            return 0.0;
        }
        let faces = 0..self.topology.face_count();
        visit_counter::count_visits(2 * self.topology.edge_count());
        faces.map(|face| self.bound_by_face(p, face, FanSearch::All)).fold(f64::INFINITY, f64::min)
    }

    /// Checks whether a point is above no triangle of the faces' fans and below at least one, exactly. Then all
    /// triangles turn the same way around the point, so the closed surface winds around it.
    fn contains_exactly(&self, p: DVec3) -> bool {
        let mut is_below_some = false;
        for face in 0..self.topology.face_count() as u32 {
            let range = self.topology.face_half_edges(face);
            let at = |h: u32| self.vertices[self.topology.origin(h) as usize];
            for h in range.start + 1..range.end - 1 {
                let height = orientation(at(range.start), at(h), at(h + 1), p);
                if height > 0.0 {
                    return false;
                }
                is_below_some |= height < 0.0;
            }
        }
        is_below_some
    }

    /// Returns the smallest bound from triangles of a face's fan. The bound is 0 if the point lies exactly in one of
    /// the triangles. The exact test is made only if the rounded bound is small and exceeds [`Self::input_excess`].
    fn bound_by_face(&self, p: DVec3, face: usize, search: FanSearch) -> f64 {
        let range = self.topology.face_half_edges(face as u32);
        let corner =
            |k: usize| self.vertices[self.topology.origin(range.start + k as u32) as usize];
        let normal = self.locator.planes[face].0;
        let projection = Projection::for_normal(normal);
        let first = corner(0);
        let foot = projection.project(p - normal * normal.dot(p - first));
        let count = range.len();
        let bound = |k: usize| {
            let triangle = [first, corner(k), corner(k + 1)];
            let bound = distance_to_triangle(p, triangle, foot, projection) + self.rounding;
            let may_be_on = bound > self.input_excess && bound <= 2.0 * self.rounding;
            if may_be_on && is_in_triangle(p, triangle, projection) { 0.0 } else { bound }
        };
        if let FanSearch::All = search {
            return (1..count - 1).map(bound).fold(f64::INFINITY, f64::min);
        }
        let at =
            fan_triangle(projection.project(first), count, foot, |k| projection.project(corner(k)));
        let found = bound(at);
        if found <= 2.0 * self.rounding {
            return found;
        }
        // For a needle, the rounding error of the foot can be as large as its width.
        let adjacent = (at - 1).max(1)..(at + 2).min(count - 1);
        adjacent.map(bound).fold(found, f64::min)
    }
}

/// Selection of the triangles of a face's fan to examine.
#[derive(Clone, Copy)]
enum FanSearch {
    /// The triangle that contains the foot of the perpendicular, and its neighbours.
    Foot,
    /// All triangles.
    All,
}

/// Finds the triangle of a face's fan whose sector, seen from the corner 0, contains `foot`. Returns `k` for the
/// triangle of the corners 0, `k` and `k + 1`: the first triangle if `foot` is clockwise of all sectors, the last one
/// if it is counter-clockwise of them.
fn fan_triangle(first: DVec2, count: usize, foot: DVec2, corner: impl Fn(usize) -> DVec2) -> usize {
    let (mut low, mut high) = (1, count - 1);
    while low + 1 < high {
        visit_counter::count_visits(1);
        let middle = low.midpoint(high);
        if orientation_in_plane(first, corner(middle), foot) >= 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

/// Returns the distance of a point from the point of a triangle whose projection is `foot`. If `foot` is outside the
/// projected triangle, returns the distance from the nearest point of the edges.
fn distance_to_triangle(
    p: DVec3,
    [a, b, c]: [DVec3; 3],
    foot: DVec2,
    projection: Projection,
) -> f64 {
    let [u, v, w] = [a, b, c].map(|corner| projection.project(corner));
    let whole = triangle_area(u, v, w);
    let (s, t) = (triangle_area(u, foot, w) / whole, triangle_area(u, v, foot) / whole);
    if s >= 0.0 && t >= 0.0 && s + t <= 1.0 {
        return ((p - a) - (b - a) * s - (c - a) * t).length();
    }
    distance_to_segment(p, a, b).min(distance_to_segment(p, b, c)).min(distance_to_segment(p, c, a))
}

/// Returns the distance of a point from the nearest point of a segment.
pub(super) fn distance_to_segment(p: DVec3, a: DVec3, b: DVec3) -> f64 {
    let edge = b - a;
    let share = (p - a).dot(edge) / edge.length_squared();
    // The share of a segment without length is not a number.
    let share = if share > 0.0 { share.min(1.0) } else { 0.0 };
    ((p - a) - edge * share).length()
}

/// Checks whether a point lies in a triangle, exactly. Returns `false` if the projection of the triangle is not
/// counter-clockwise.
fn is_in_triangle(p: DVec3, [a, b, c]: [DVec3; 3], projection: Projection) -> bool {
    let [u, v, w, q] = [a, b, c, p].map(|point| projection.project(point));
    let is_left = |from: DVec2, to: DVec2| orientation_in_plane(from, to, q) >= 0.0;
    orientation_in_plane(u, v, w) > 0.0
        && is_left(u, v)
        && is_left(v, w)
        && is_left(w, u)
        && orientation(a, b, c, p) == 0.0
}

/// Projection along the coordinate axis of a normal's largest component. It preserves the orientation:
/// counter-clockwise around the normal remains counter-clockwise.
#[derive(Debug, Clone, Copy)]
pub(super) struct Projection {
    axes: [usize; 2],
}

impl Projection {
    pub(super) fn for_normal(normal: DVec3) -> Self {
        let main = normal.abs().max_position();
        let axes = [(main + 1) % 3, (main + 2) % 3];
        Self { axes: if normal[main] < 0.0 { [axes[1], axes[0]] } else { axes } }
    }

    pub(super) fn project(self, p: DVec3) -> DVec2 {
        DVec2::new(p[self.axes[0]], p[self.axes[1]])
    }
}
