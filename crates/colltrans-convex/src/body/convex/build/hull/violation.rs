//! How far from itself a hull leaves the points it was made of.
//!
//! The distance of a point from a body is bounded from above by that from a *witness*, a point of a
//! triangle of the body's corners. Whatever chose the triangle and the weights, a walk that rounding
//! misled or a projection of a sliver, a bad choice makes the bound larger and never wrong. So it does
//! not depend on how thin the body is, as distances from face planes do: within a rounding of two of
//! them, a point can be a body's width away from it.

use glam::{DVec2, DVec3};

use super::neighbours::{Neighbours, PlaneNode};
use super::quickhull::{Simplicial, Triangle, orientation};
use colltrans_kernel::determinant::triangle_area;
use colltrans_kernel::plane::polygon_normal;
use colltrans_kernel::predicates::orient2d as orientation_in_plane;
use colltrans_kernel::topology::Topology;
use colltrans_kernel::work;

/// Finds the face that the ray from an inner point to a given point passes, by walking from face to
/// face.
///
/// With the inner point as origin, faces are the points `n / o` of the polar polytope and the face
/// sought is its support point, so a walk to ever better neighbours ends at it.
pub(in crate::body::convex) struct Locator {
    center: DVec3,
    /// Unit normal and offset from the centre of each face.
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

    /// The faces of a polyhedron.
    pub(in crate::body::convex) fn of_faces(vertices: &[DVec3], topology: &Topology) -> Self {
        let center = vertices.iter().sum::<DVec3>() / vertices.len() as f64;
        let plane = |face: u32| {
            let corners = topology.face_vertices(face).map(|v| vertices[v as usize]);
            let normal = polygon_normal(corners.clone());
            (
                normal,
                corners.map(|p| normal.dot(p - center)).sum::<f64>()
                    / topology.face(face).len() as f64,
            )
        };
        let faces = 0..topology.face_count() as u32;
        let mut neighbour_start = vec![0];
        let mut neighbours = Vec::new();
        for face in faces.clone() {
            let twin_face = |h: u32| topology.half_edge(topology.half_edge(h).twin).face;
            neighbours.extend(topology.face(face).map(twin_face));
            neighbour_start.push(neighbours.len() as u32);
        }
        let planes: Vec<(DVec3, f64)> = faces.map(plane).collect();
        let neighbours = Neighbours::new(neighbour_start, neighbours, &planes);
        Self { center, planes, neighbours }
    }

    /// How far a point is outside the face its ray passes and that face's neighbours (negative:
    /// inside). `near`: where the walk starts, and where it ended.
    pub(super) fn distance_outside(&self, point: DVec3, near: &mut usize) -> f64 {
        let ray = point - self.center;
        self.walk_to_face(ray, near);
        let outside = |f: usize| self.planes[f].0.dot(ray) - self.planes[f].1;
        let bound = |node: &PlaneNode| node.max_product(ray) - node.min_offset;
        self.neighbours.best_neighbour(*near, (outside(*near), *near), outside, bound).0
    }

    /// Unit normals and offsets from the origin of the coordinates.
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
        // Every step increases the value; the bound is for rounding.
        for _ in 0..self.planes.len() {
            let better = self.neighbours.best_neighbour(*near, (value, *near), passing, bound);
            if better.1 == *near {
                break;
            }
            (value, *near) = better;
        }
    }
}

/// The largest distance of a hull's vertex outside a face plane: polygons are flat only up to
/// rounding.
fn max_unevenness(locator: &Locator, vertices: &[DVec3], topology: &Topology) -> f64 {
    let mut worst = 0.0_f64;
    for (face, (normal, offset)) in locator.planes.iter().enumerate() {
        for v in topology.face_vertices(face as u32) {
            worst = worst.max(normal.dot(vertices[v as usize] - locator.center) - offset);
        }
    }
    worst
}

/// Triangles looked at one by one, in multiples of the number of edges and points.
const TRIANGLES_PER_ELEMENT: usize = 128;

/// Triangles looked at to see that points are inside, at most.
const MAX_INSIDE_TRIANGLES: usize = 1 << 16;

/// How far points are from a body, bounded from above.
pub(super) struct Gauge<'a> {
    locator: Locator,
    vertices: &'a [DVec3],
    topology: &'a Topology,
    /// Bound on the rounding errors of a witness.
    rounding: f64,
    /// How far the locator's centre is from the body: rounding can leave it outside of a thin one.
    center_bound: Option<f64>,
    /// The largest bound so far, at first the unevenness of the faces.
    pub(super) violation: f64,
    /// The largest bound so far on the distance of a point that is not seen to be inside.
    pub(super) input_excess: f64,
    /// Triangles that may still be looked at for points of which the walk does not tell enough.
    triangle_budget: usize,
    /// Triangles that may still be looked at to see that a point is inside.
    inside_budget: usize,
}

impl<'a> Gauge<'a> {
    /// For so many points; `rounding` is that of a witness at their size.
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

    /// A bound on the distance of a point from the body; more than `enough` only if no witness is
    /// nearer than that, or too many points have taken a look at all faces.
    /// `near`: where the walk starts, and where it ended.
    pub(super) fn distance_bound(&mut self, p: DVec3, enough: f64, near: &mut usize) -> f64 {
        let bound = self.unrecorded_bound(p, enough, near);
        self.violation = self.violation.max(bound);
        if bound > self.input_excess && !self.is_inside(p) {
            self.input_excess = bound;
        }
        bound
    }

    /// Whether a point is seen to be inside the body, as far as there are looks left for that.
    fn is_inside(&mut self, p: DVec3) -> bool {
        let count = 2 * self.topology.edge_count();
        let has_budget = self.inside_budget >= count && self.topology.face_count() > 2;
        if has_budget {
            self.inside_budget -= count;
            work::count(count);
        }
        has_budget && self.contains_exactly(p)
    }

    fn unrecorded_bound(&mut self, p: DVec3, enough: f64, near: &mut usize) -> f64 {
        // The front of a flat polygon is where its back is.
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

    /// The bound of a point that its face leaves inside: on the way from the centre to where its ray
    /// passes the face, the distance from a convex body is at most the weighted mean of that at
    /// both ends.
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
        // Scaling the ray is off by as little as a witness.
        (1.0 - share) * center_bound
            + self.bound_by_face(exit, face, FanSearch::Foot)
            + self.rounding
    }

    /// The bound from all triangles: 0 inside, exactly.
    fn bound_by_all_faces(&self, p: DVec3) -> f64 {
        if self.contains_exactly(p) {
            return 0.0;
        }
        let faces = 0..self.topology.face_count();
        work::count(2 * self.topology.edge_count());
        faces.map(|face| self.bound_by_face(p, face, FanSearch::All)).fold(f64::INFINITY, f64::min)
    }

    /// Whether a point is above none of the triangles of the faces' fans, and below some; exact.
    ///
    /// All of them turn the same way around it then: the closed surface winds around the point.
    fn contains_exactly(&self, p: DVec3) -> bool {
        let mut is_below_some = false;
        for face in 0..self.topology.face_count() as u32 {
            let range = self.topology.face(face);
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

    /// The bound from triangles of a face's fan. 0 if the point lies in one of them, exactly, which is
    /// looked at where it makes a difference.
    fn bound_by_face(&self, p: DVec3, face: usize, search: FanSearch) -> f64 {
        let range = self.topology.face(face as u32);
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
        // Of a needle, the rounding of the foot can be as much as its width.
        let adjacent = (at - 1).max(1)..(at + 2).min(count - 1);
        adjacent.map(bound).fold(found, f64::min)
    }
}

/// Which triangles of a face's fan are looked at.
#[derive(Clone, Copy)]
enum FanSearch {
    /// The one where the foot of the perpendicular falls, and its neighbours.
    Foot,
    All,
}

/// The last corner `k`, not the last of all, that the foot is not clockwise of, as seen from the first one.
fn fan_triangle(first: DVec2, count: usize, foot: DVec2, corner: impl Fn(usize) -> DVec2) -> usize {
    let (mut low, mut high) = (1, count - 1);
    while low + 1 < high {
        work::count(1);
        let middle = low.midpoint(high);
        if orientation_in_plane(first, corner(middle), foot) >= 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

/// The distance of a point from the point of a triangle above `foot`, or from one on its edges.
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

/// The distance of a point from the nearest one of a segment.
pub(super) fn distance_to_segment(p: DVec3, a: DVec3, b: DVec3) -> f64 {
    let edge = b - a;
    let share = (p - a).dot(edge) / edge.length_squared();
    // A segment without length has no share.
    let share = if share > 0.0 { share.min(1.0) } else { 0.0 };
    ((p - a) - edge * share).length()
}

/// Whether a point lies in a triangle, exactly; its projection must not be flat.
fn is_in_triangle(p: DVec3, [a, b, c]: [DVec3; 3], projection: Projection) -> bool {
    let [u, v, w, q] = [a, b, c, p].map(|point| projection.project(point));
    let is_left = |from: DVec2, to: DVec2| orientation_in_plane(from, to, q) >= 0.0;
    orientation_in_plane(u, v, w) > 0.0
        && is_left(u, v)
        && is_left(v, w)
        && is_left(w, u)
        && orientation(a, b, c, p) == 0.0
}

/// Points on the two coordinates orthogonal to a normal's largest component, so that what is
/// counter-clockwise around the normal stays so.
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
