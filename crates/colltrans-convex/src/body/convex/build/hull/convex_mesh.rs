//! Recognises meshes that are their own convex hull, exactly.
//!
//! A closed, oriented surface of triangles is the boundary of a convex body under three conditions:
//! - no edge is bent inwards;
//! - a point is strictly inside all planes;
//! - one ray from that point passes one triangle only.
//!
//! Under the first two, the surface covers the sphere around the point a whole number of times, which the ray
//! counts (Mehlhorn, Naeher, Seel, Seidel, Schilz, Schirra, Uhrig, "Checking geometric programs or verification of
//! geometric structures", Computational Geometry 12, 1999). All signs are exact. If a condition fails, the hull is
//! computed from the points.

use glam::DVec3;

use super::quickhull::{Simplicial, Triangle, orientation};
use colltrans_kernel::plane::triangle_normal;
use colltrans_kernel::topology::Topology;

/// Returns the mesh as a simplicial hull. Returns `None` unless all faces are triangles and the mesh is convex with
/// every vertex a corner.
pub(super) fn simplicial_of_mesh(points: &[DVec3], topology: &Topology) -> Option<Simplicial> {
    let mesh = TriangleMesh { points, topology };
    let count = topology.face_count() as u32;
    if !(0..count).all(|f| topology.face_half_edges(f).len() == 3) {
        return None;
    }
    let middle = points.iter().sum::<DVec3>() / points.len() as f64;
    let convex = (0..count).all(|f| mesh.is_below(f, middle) && mesh.bends_outwards(f));
    if !convex || mesh.ray_crossings(middle) != 1 {
        return None;
    }
    let triangles = (0..count).map(|f| mesh.simplicial_triangle(f)).collect();
    Some(Simplicial { triangles, near: Vec::new() })
}

struct TriangleMesh<'a> {
    points: &'a [DVec3],
    topology: &'a Topology,
}

impl TriangleMesh<'_> {
    fn corner_vertices(&self, face: u32) -> [u32; 3] {
        let first = self.topology.face_half_edges(face).start;
        [first, first + 1, first + 2].map(|h| self.topology.origin(h))
    }

    fn corner_points(&self, face: u32) -> [DVec3; 3] {
        self.corner_vertices(face).map(|v| self.points[v as usize])
    }

    /// Checks whether a point is strictly below a triangle's plane, which must have an area.
    fn is_below(&self, face: u32, p: DVec3) -> bool {
        let [a, b, c] = self.corner_points(face);
        orientation(a, b, c, p) < 0.0
    }

    /// Checks that no neighbour's third corner is above a triangle's plane. Each edge is tested once, for the
    /// half-edge with the smaller number.
    fn bends_outwards(&self, face: u32) -> bool {
        let [a, b, c] = self.corner_points(face);
        self.topology.face_half_edges(face).all(|h| {
            let twin = self.topology.half_edge(h).twin;
            if twin < h {
                return true;
            }
            let third = self.topology.target(self.topology.next(twin));
            orientation(a, b, c, self.points[third as usize]) <= 0.0
        })
    }

    /// Counts the triangles that a ray from an inner point passes, including their borders.
    fn ray_crossings(&self, from: DVec3) -> usize {
        let through = self.corner_points(0).into_iter().sum::<DVec3>() / 3.0;
        let passes = |f: u32| {
            let [a, b, c] = self.corner_points(f);
            orientation(from, b, a, through) <= 0.0
                && orientation(from, c, b, through) <= 0.0
                && orientation(from, a, c, through) <= 0.0
        };
        (0..self.topology.face_count() as u32).filter(|&f| passes(f)).count()
    }

    /// Returns a face as a triangle of a simplicial hull.
    fn simplicial_triangle(&self, face: u32) -> Triangle {
        let neighbour = |h: u32| self.topology.half_edge(self.topology.half_edge(h).twin).face;
        let first = self.topology.face_half_edges(face).start;
        let neighbours = [first, first + 1, first + 2].map(neighbour);
        let normal = triangle_normal(self.corner_points(face)).normalize_or_zero();
        Triangle { corners: self.corner_vertices(face), neighbours, normal }
    }
}
