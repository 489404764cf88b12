//! How far outside its face planes a hull leaves the points it was made of.

use glam::DVec3;

use super::quickhull::Simplicial;
use crate::body::topology::Topology;
use crate::number::plane::polygon_normal;

/// Finds the face that the ray from an inner point to a given point passes, by walking from face to
/// face.
///
/// With the inner point as origin, faces are the points `n / o` of the polar polytope and the face
/// sought is its support point, so a walk to ever better neighbours ends at it.
pub(in crate::body::convex) struct Locator {
    center: DVec3,
    /// Unit normal and offset from the centre of each face.
    planes: Vec<(DVec3, f64)>,
    neighbour_start: Vec<u32>,
    neighbours: Vec<u32>,
}

impl Locator {
    pub(super) fn new(points: &[DVec3], hull: &Simplicial) -> Self {
        let at = |i: u32| points[i as usize];
        let corners = hull.triangles.iter().flat_map(|t| t.corners);
        let center = corners.map(at).sum::<DVec3>() / (3 * hull.triangles.len()) as f64;
        Self {
            center,
            planes: hull
                .triangles
                .iter()
                .map(|t| (t.normal, t.normal.dot(at(t.corners[0]) - center)))
                .collect(),
            neighbour_start: (0..=hull.triangles.len() as u32).map(|k| 3 * k).collect(),
            neighbours: hull.triangles.iter().flat_map(|t| t.neighbours).collect(),
        }
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
        Self { center, planes: faces.map(plane).collect(), neighbour_start, neighbours }
    }

    /// How far a point is outside the face its ray passes and that face's neighbours (negative:
    /// inside). `near`: where the walk starts, and where it ended.
    pub(super) fn outside(&self, point: DVec3, near: &mut usize) -> f64 {
        let ray = point - self.center;
        self.walk(ray, near);
        let outside = |f: usize| self.planes[f].0.dot(ray) - self.planes[f].1;
        self.around(*near).map(outside).fold(outside(*near), f64::max)
    }

    /// An upper bound of the depth of a point below the faces, close to it for points near the
    /// surface.
    pub(in crate::body::convex) fn depth_bound(&self, point: DVec3, near: &mut usize) -> f64 {
        let ray = point - self.center;
        self.walk(ray, near);
        let depth = |f: usize| self.planes[f].1 - self.planes[f].0.dot(ray);
        self.around(*near).map(depth).fold(depth(*near), f64::min)
    }

    /// Unit normals and offsets from the origin of the coordinates.
    pub(in crate::body::convex) fn planes_from_origin(
        &self,
    ) -> impl Iterator<Item = (DVec3, f64)> + '_ {
        self.planes.iter().map(|&(normal, offset)| (normal, offset + normal.dot(self.center)))
    }

    /// Walks to the face that a ray from the centre passes.
    fn walk(&self, ray: DVec3, near: &mut usize) {
        let passing = |f: usize| {
            let (normal, offset) = self.planes[f];
            normal.dot(ray) / offset.max(f64::MIN_POSITIVE)
        };
        let mut value = passing(*near);
        // Every step increases the value; the bound is for rounding.
        for _ in 0..self.planes.len() {
            let better = self
                .around(*near)
                .map(|f| (passing(f), f))
                .fold((value, *near), |a, b| if b.0 > a.0 { b } else { a });
            if better.1 == *near {
                break;
            }
            (value, *near) = better;
        }
    }

    fn around(&self, face: usize) -> impl Iterator<Item = usize> + '_ {
        let range = self.neighbour_start[face] as usize..self.neighbour_start[face + 1] as usize;
        self.neighbours[range].iter().map(|&f| f as usize)
    }
}

/// The largest distance of a point outside a face plane, over the hull's vertices and the points
/// `near` its surface.
pub(super) fn measure(
    points: &[DVec3],
    vertices: &[DVec3],
    topology: &Topology,
    near: &[u32],
) -> f64 {
    let locator = Locator::of_faces(vertices, topology);
    let mut worst = 0.0_f64;
    for (face, (normal, offset)) in locator.planes.iter().enumerate() {
        for v in topology.face_vertices(face as u32) {
            worst = worst.max(normal.dot(vertices[v as usize] - locator.center) - offset);
        }
    }
    let mut face = 0;
    near.iter().map(|&i| locator.outside(points[i as usize], &mut face)).fold(worst, f64::max)
}
