//! Vertices, edges and faces of a convex polyhedron with their neighbours.
//!
//! - Half-edges of a face are stored consecutively, counter-clockwise as seen from outside.
//! - Half-edge `h` leads from `origin` to `target` with `face` on its left; `twin` is its opposite.
//! - An *edge* is identified by the smaller of its two half-edges.
//!
//! Voronoi planes (Mirtich 1998) are computed on demand from two points and a normal. The plane between a
//! vertex `v` and an edge `vw` is through `v`, normal to `w - v` ([`Shell::beyond_vertex`]). The plane
//! between a face with normal `n` and its edge `ab` is through `a`, normal to `n x (b - a)`
//! ([`Shell::inside_edge`]). Both features at a plane call the same function, so that rounding cannot make
//! each of them direct a walk to the other.

use std::fmt;

use colltrans::ConvexPolyhedron;
use glam::DVec3;

/// A directed edge along the boundary of its face.
#[derive(Debug, Clone, Copy)]
pub(crate) struct HalfEdge {
    pub(crate) origin: u32,
    pub(crate) target: u32,
    pub(crate) twin: u32,
    pub(crate) face: u32,
}

impl HalfEdge {
    /// Returns origin and target.
    pub(crate) fn both_ends(self) -> [u32; 2] {
        [self.origin, self.target]
    }
}

/// A vertex, an edge (as its smaller half-edge) or a face.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Feature {
    Vertex(u32),
    Edge(u32),
    Face(u32),
}

/// The surface of a solid for walks over its features: vertices, edges, faces and their adjacency, in `O(n)`
/// space.
///
/// ```
/// use colltrans::ConvexPolyhedron;
/// use colltrans::glam::DVec3;
/// use colltrans_baselines::vclip::Shell;
///
/// let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
/// let shell = Shell::new(&ConvexPolyhedron::from_points(&corners)?)?;
/// assert_eq!((shell.vertex_count(), shell.edge_count(), shell.face_count()), (4, 6, 4));
///
/// let flat = ConvexPolyhedron::from_points(&corners[..3])?;
/// assert_eq!(Shell::new(&flat).unwrap_err().dimension, 2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Shell {
    vertices: Vec<DVec3>,
    half_edges: Vec<HalfEdge>,
    /// First half-edge of each face, and one entry past the end.
    face_start: Vec<u32>,
    normals: Vec<DVec3>,
    /// First entry of each vertex in `outgoing`, and one entry past the end.
    vertex_start: Vec<u32>,
    outgoing: Vec<u32>,
    /// Largest distance of a vertex from the origin.
    reach: f64,
}

/// A body of lower dimension, which the published algorithm does not support.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct NotSolid {
    /// The dimension of the body.
    pub dimension: u8,
}

impl fmt::Display for NotSolid {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "the body has dimension {}; only solids (3) have Voronoi regions", self.dimension)
    }
}

impl std::error::Error for NotSolid {}

impl Shell {
    /// Extracts the features of a body, in its frame, in `O(n)` time.
    ///
    /// # Errors
    /// [`NotSolid`] for a polygon, a segment or a point.
    pub fn new(body: &ConvexPolyhedron) -> Result<Self, NotSolid> {
        if body.dimension() < 3 {
            return Err(NotSolid { dimension: body.dimension() });
        }
        let links = body.half_edges();
        let half_edges = links.iter().map(|h| HalfEdge {
            origin: h.origin,
            target: links[h.twin as usize].origin,
            twin: h.twin,
            face: h.face,
        });
        let faces = 0..body.face_count() as u32;
        let face_start = faces.clone().map(|f| body.face_half_edges(f).start);
        let (mut vertex_start, mut outgoing) = (vec![0], Vec::with_capacity(links.len()));
        for v in 0..body.vertices().len() as u32 {
            outgoing.extend_from_slice(body.outgoing(v));
            vertex_start.push(outgoing.len() as u32);
        }
        Ok(Self {
            vertices: body.vertices().to_vec(),
            half_edges: half_edges.collect(),
            face_start: face_start.chain([links.len() as u32]).collect(),
            normals: faces.map(|f| body.face_normal(f)).collect(),
            vertex_start,
            outgoing,
            reach: body.vertices().iter().map(|v| v.length()).fold(0.0, f64::max),
        })
    }

    /// Returns the number of vertices.
    pub fn vertex_count(&self) -> usize {
        self.vertices.len()
    }

    /// Returns the number of edges.
    pub fn edge_count(&self) -> usize {
        self.half_edges.len() / 2
    }

    /// Returns the number of faces.
    pub fn face_count(&self) -> usize {
        self.normals.len()
    }

    /// Returns the number of bytes that the shell occupies, including the heap.
    pub fn memory_bytes(&self) -> usize {
        size_of::<Self>()
            + size_of::<DVec3>() * (self.vertices.capacity() + self.normals.capacity())
            + size_of::<HalfEdge>() * self.half_edges.capacity()
            + size_of::<u32>()
                * (self.face_start.capacity()
                    + self.vertex_start.capacity()
                    + self.outgoing.capacity())
    }

    /// Returns the position of a vertex.
    pub(crate) fn vertex(&self, v: u32) -> DVec3 {
        self.vertices[v as usize]
    }

    /// Returns a half-edge.
    pub(crate) fn half_edge(&self, h: u32) -> HalfEdge {
        self.half_edges[h as usize]
    }

    /// Returns the positions of origin and target of a half-edge.
    pub(crate) fn ends(&self, h: u32) -> [DVec3; 2] {
        let HalfEdge { origin, target, .. } = self.half_edge(h);
        [self.vertex(origin), self.vertex(target)]
    }

    /// Returns the length of a half-edge.
    pub(crate) fn length(&self, h: u32) -> f64 {
        let [a, b] = self.ends(h);
        a.distance(b)
    }

    /// Returns the unit outward normal of a face.
    pub(crate) fn normal(&self, face: u32) -> DVec3 {
        self.normals[face as usize]
    }

    /// Returns the half-edges that leave a vertex.
    pub(crate) fn outgoing(&self, v: u32) -> &[u32] {
        let v = v as usize;
        &self.outgoing[self.vertex_start[v] as usize..self.vertex_start[v + 1] as usize]
    }

    /// Returns the half-edges of a face.
    pub(crate) fn boundary(&self, face: u32) -> std::ops::Range<u32> {
        let f = face as usize;
        self.face_start[f]..self.face_start[f + 1]
    }

    /// Returns the edge of a half-edge.
    pub(crate) fn edge(&self, h: u32) -> Feature {
        Feature::Edge(h.min(self.half_edge(h).twin))
    }

    /// Returns the largest distance of a vertex from the origin.
    pub(crate) fn reach(&self) -> f64 {
        self.reach
    }

    /// Returns a vertex of the feature.
    pub(crate) fn some_vertex(&self, feature: Feature) -> u32 {
        match feature {
            Feature::Vertex(v) => v,
            Feature::Edge(h) => self.half_edge(h).origin,
            Feature::Face(f) => self.half_edge(self.face_start[f as usize]).origin,
        }
    }

    /// Returns the signed distance of `x` from the Voronoi plane between the half-edge's origin and its edge,
    /// multiplied by the edge's length. It is positive on the side of the edge.
    pub(crate) fn beyond_vertex(&self, h: u32, x: DVec3) -> f64 {
        let [v, w] = self.ends(h);
        (x - v).dot(w - v)
    }

    /// Returns the signed distance of `x` from the Voronoi plane between the half-edge's face and its edge,
    /// multiplied by the edge's length. It is positive on the side of the face.
    pub(crate) fn inside_edge(&self, h: u32, x: DVec3) -> f64 {
        let [a, b] = self.ends(h);
        self.normal(self.half_edge(h).face).cross(b - a).dot(x - a)
    }

    /// Returns the signed distance of `x` from the plane of a face, positive outside.
    pub(crate) fn height(&self, face: u32, x: DVec3) -> f64 {
        let origin = self.half_edge(self.face_start[face as usize]).origin;
        self.normal(face).dot(x - self.vertex(origin))
    }

    /// Returns a support vertex along `direction`, by hill climbing along edges from `near`. On a convex body
    /// a local maximum is the global one, up to rounding.
    pub(crate) fn support(&self, direction: DVec3, near: u32) -> u32 {
        let (mut best, mut height) = (near, direction.dot(self.vertex(near)));
        // The height strictly increases, so the loop ends.
        loop {
            let start = best;
            for &h in self.outgoing(start) {
                let target = self.half_edge(h).target;
                let above = direction.dot(self.vertex(target));
                if above > height {
                    (best, height) = (target, above);
                }
            }
            if best == start {
                return best;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use colltrans_testkit::random::Random;

    #[test]
    fn links_match_coordinates_and_support_is_maximal() {
        let mut rng = Random::new(1);
        for n in [4, 8, 20, 300] {
            let points: Vec<DVec3> = (0..n).map(|_| rng.direction()).collect();
            let body = ConvexPolyhedron::from_points(&points).unwrap();
            let shell = Shell::new(&body).unwrap();
            assert_eq!(shell.edge_count(), body.edge_count());
            for h in 0..2 * shell.edge_count() as u32 {
                let [edge, twin] = [h, shell.half_edge(h).twin].map(|h| shell.half_edge(h));
                assert_eq!((edge.origin, edge.target), (twin.target, twin.origin));
                assert!(shell.outgoing(edge.origin).contains(&h));
                assert!(shell.boundary(edge.face).contains(&h));
                assert!(body.neighbours(edge.origin).contains(&edge.target));
                let middle = (shell.vertex(edge.origin) + shell.vertex(edge.target)) / 2.0;
                assert!(shell.height(edge.face, middle).abs() < 1e-14);
                assert!(shell.inside_edge(h, middle).abs() < 1e-14);
                let corners = body.face_vertices(edge.face).map(|v| shell.vertex(v));
                let inside = corners.clone().sum::<DVec3>() / corners.len() as f64;
                assert!(shell.inside_edge(h, inside) > 0.0);
                assert!(shell.beyond_vertex(h, middle) > 0.0);
            }
            for _ in 0..50 {
                let along = rng.direction();
                let highest = points.iter().map(|p| along.dot(*p)).fold(f64::MIN, f64::max);
                let found = shell.support(along, rng.int(0, n - 1) as u32);
                assert!((along.dot(shell.vertex(found)) - highest).abs() < 1e-14);
            }
        }
    }
}
