//! Hulls without volume: a point, a segment, a flat polygon.

use glam::{DVec2, DVec3, Vec3Swizzles};

use super::quickhull::Flat;
use super::violation::{Projection, distance_to_segment};
use super::{IndexedHull, MAX_DISTANCE_FACTOR, with_violation, witness_rounding};
use colltrans_kernel::predicates::orient2d as orientation;
use colltrans_kernel::topology::Topology;
use colltrans_kernel::visit_counter;

/// Computes the hull of points whose affine hull is `flat`.
pub(super) fn flat_hull(points: &[DVec3], kept: &[u32], flat: Flat, tolerance: f64) -> IndexedHull {
    match flat {
        Flat::Point(a) => without_faces(points, kept, &[a], tolerance),
        Flat::Segment(ends) => without_faces(points, kept, &ends, tolerance),
        Flat::Plane(normal) => polygon_hull(points, kept, normal, tolerance),
    }
}

/// Builds the hull that is a point, or a segment between two points.
fn without_faces(points: &[DVec3], kept: &[u32], vertices: &[u32], tolerance: f64) -> IndexedHull {
    let mut vertices = vertices.to_vec();
    vertices.sort_unstable();
    let at = |i: u32| points[i as usize];
    let [a, b] = [vertices[0], vertices[vertices.len() - 1]].map(at);
    let distance = |&i: &u32| match at(i) {
        p if p == a || p == b => 0.0,
        p => distance_to_segment(p, a, b) + witness_rounding(tolerance),
    };
    let is_off_segment = |i: &&u32| !is_on_segment(at(**i), a, b);
    IndexedHull {
        dimension: vertices.len() as u8 - 1,
        topology: Topology::without_faces(vertices.len()),
        violation: kept.iter().map(distance).fold(0.0, f64::max),
        input_excess: kept.iter().filter(is_off_segment).map(distance).fold(0.0, f64::max),
        vertices,
    }
}

/// Checks whether a point lies on a segment, exactly.
fn is_on_segment(p: DVec3, a: DVec3, b: DVec3) -> bool {
    let is_between = p.cmpge(a.min(b)).all() && p.cmple(a.max(b)).all();
    let in_line = |q: &dyn Fn(DVec3) -> DVec2| orientation(q(a), q(b), q(p)) == 0.0;
    is_between && in_line(&|v| v.xy()) && in_line(&|v| v.yz()) && in_line(&|v| v.zx())
}

/// Computes the hull of points in a plane as a polygon. Drops corners that are within the tolerance of an edge, unless
/// this leaves a point farther than [`MAX_DISTANCE_FACTOR`] tolerances from the polygon.
fn polygon_hull(points: &[DVec3], kept: &[u32], normal: DVec3, tolerance: f64) -> IndexedHull {
    let plane = PlanarPoints { points, projection: Projection::for_normal(normal) };
    let chain = plane.corner_chain(kept);
    let hull = plane.hull_of_corners(kept, &plane.drop_collinear(&chain, tolerance), tolerance);
    if hull.violation <= MAX_DISTANCE_FACTOR * tolerance {
        hull
    } else {
        plane.hull_of_corners(kept, &chain, tolerance)
    }
}

/// Points in a plane, and their projection.
struct PlanarPoints<'a> {
    points: &'a [DVec3],
    projection: Projection,
}

impl PlanarPoints<'_> {
    fn point_at(&self, i: u32) -> DVec3 {
        self.points[i as usize]
    }

    fn projected_point(&self, i: u32) -> DVec2 {
        self.projection.project(self.point_at(i))
    }

    /// Builds the polygon with these corners as a front and a back face; a segment if there are two.
    fn hull_of_corners(&self, kept: &[u32], corners: &[u32], tolerance: f64) -> IndexedHull {
        if corners.len() < 3 {
            return without_faces(self.points, kept, corners, tolerance);
        }
        let mut vertices = corners.to_vec();
        vertices.sort_unstable();
        let position = |v: &u32| vertices.binary_search(v).unwrap_or(0) as u32;
        let mut face_vertices: Vec<u32> = corners.iter().map(position).collect();
        let back: Vec<u32> = face_vertices.iter().rev().copied().collect();
        face_vertices.extend(back);
        let count = corners.len() as u32;
        let topology =
            Topology::from_sphere_faces(vertices.len(), vec![0, count, 2 * count], face_vertices)
                .expect("the front and the back of a polygon are a closed surface");
        let hull =
            IndexedHull { dimension: 2, vertices, topology, violation: 0.0, input_excess: 0.0 };
        with_violation(self.points, hull, kept.iter().copied(), tolerance).0
    }

    /// Returns the corners, counter-clockwise around the normal, starting at the one with the smallest `x`. This is
    /// the monotone chain algorithm with exact orientations.
    fn corner_chain(&self, kept: &[u32]) -> Vec<u32> {
        let project = |i: u32| self.projected_point(i);
        let mut order = kept.to_vec();
        order.sort_unstable_by(|&a, &b| {
            let (p, q) = (project(a), project(b));
            p.x.total_cmp(&q.x).then(p.y.total_cmp(&q.y)).then(a.cmp(&b))
        });
        order.dedup_by_key(|i| project(*i).to_array());
        let mut chain = half_chain(order.iter().copied(), &project);
        let upper = half_chain(order.iter().rev().copied(), &project);
        chain.pop();
        chain.extend(&upper[..upper.len() - 1]);
        chain
    }

    /// Returns the chain without corners within the tolerance of the edge between their neighbours.
    fn drop_collinear(&self, chain: &[u32], tolerance: f64) -> Vec<u32> {
        // Measured from the edge, not from its line: the tip of a needle is near the line through its neighbours.
        let is_on_edge = |a: u32, b: u32, c: u32| {
            distance_to_segment(self.point_at(b), self.point_at(a), self.point_at(c)) <= tolerance
        };
        let mut corners: Vec<u32> = Vec::with_capacity(chain.len());
        for &c in chain {
            while let [.., a, b] = corners[..] {
                visit_counter::count_visits(1);
                if !is_on_edge(a, b, c) {
                    break;
                }
                corners.pop();
            }
            corners.push(c);
        }
        // The chain starts at the corner with the smallest `x`, which can be redundant only within the tolerance.
        while let [first, .., a, b] = corners[..] {
            if corners.len() <= 3 || !is_on_edge(a, b, first) {
                break;
            }
            corners.pop();
        }
        if let [first, second, _, .., last] = corners[..]
            && is_on_edge(last, first, second)
        {
            corners.remove(0);
        }
        corners
    }
}

/// Returns one half of the monotone chain, for points in the given order.
fn half_chain(order: impl Iterator<Item = u32>, project: &dyn Fn(u32) -> DVec2) -> Vec<u32> {
    let mut chain: Vec<u32> = Vec::new();
    for i in order {
        while let [.., a, b] = chain[..] {
            visit_counter::count_visits(1);
            if orientation(project(a), project(b), project(i)) > 0.0 {
                break;
            }
            chain.pop();
        }
        chain.push(i);
    }
    chain
}
