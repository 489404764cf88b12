//! Convex polyhedra, checked once at the door.
//!
//! The data's way: points -> [`hull`] (which vertices, which faces) -> [`crate::topology`]
//! (half-edges, no coordinates) -> the indices built on both (support points, sections).

mod hull;
mod measure;
mod mesh;
mod support;

use glam::DVec3;

use crate::error::BuildError;
use crate::plane::polygon_normal;
use crate::section::SectionIndex;
use crate::topology::Topology;
use hull::Hull;
pub(crate) use measure::Measure;
pub use mesh::{ConvexityDefect, convexity_defect};
use support::SupportIndex;

/// A convex polyhedron in its own frame: the convex hull of finitely many points.
///
/// It may be of lower dimension: a flat polygon, a segment, a point. Immutable, `Send` and `Sync`;
/// everything a query needs is built once, here, in `O(n)` space.
///
/// Vertices and faces are numbered from 0; [`Self::input_indices`] leads back to the input.
#[derive(Debug, Clone)]
pub struct ConvexPolyhedron {
    vertices: Vec<DVec3>,
    input_index: Vec<u32>,
    dimension: u8,
    hull_error: f64,
    topology: Topology,
    measure: Measure,
    support: SupportIndex,
    sections: SectionIndex,
}

impl ConvexPolyhedron {
    /// The convex hull of `points` (body frame, any unit).
    ///
    /// Coplanar triangles are merged into polygons and points within rounding error of a face
    /// or an edge are no vertices; [`Self::hull_error`] says how far outside the faces any
    /// input point was left. Takes `O(n log n)` for points in general.
    ///
    /// # Errors
    /// No points, more than 32-bit indices can number, a point that is not finite, a coordinate
    /// out of the exact range.
    ///
    /// ```
    /// use colltrans::ConvexPolyhedron;
    /// use colltrans::glam::DVec3;
    ///
    /// // A grid of 3 x 3 x 3 points: a cube of 8 vertices and 6 faces.
    /// let grid: Vec<DVec3> = (0..27)
    ///     .map(|i| DVec3::new((i % 3) as f64, (i / 3 % 3) as f64, (i / 9) as f64))
    ///     .collect();
    /// let cube = ConvexPolyhedron::from_points(&grid)?;
    /// assert_eq!((cube.vertices().len(), cube.edge_count(), cube.face_count()), (8, 12, 6));
    /// assert_eq!(cube.volume(), 8.0);
    ///
    /// assert!(ConvexPolyhedron::from_points(&[DVec3::NAN]).is_err());
    /// # Ok::<(), colltrans::BuildError>(())
    /// ```
    pub fn from_points(points: &[DVec3]) -> Result<Self, BuildError> {
        hull::check_points(points)?;
        Ok(Self::from_hull(points, hull::convex_hull(points)))
    }

    /// A closed convex surface: vertices (body frame, any unit) and polygonal faces as lists of
    /// vertex indices, counter-clockwise as seen from outside.
    ///
    /// The surface must be closed, consistently oriented, one sphere, and nowhere more than
    /// `tolerance` (a length; rounding error is tolerated in any case) below its convex hull; the
    /// hull is what is kept. Vertices that no face uses are ignored.
    ///
    /// # Errors
    /// What is wrong with the points, the topology, the orientation, or the convexity (with the
    /// worst face and its depth).
    ///
    /// ```
    /// use colltrans::glam::DVec3;
    /// use colltrans::{BuildError, ConvexPolyhedron, TopologyError};
    ///
    /// let vertices = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    /// let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    /// let tetrahedron = ConvexPolyhedron::from_mesh(&vertices, &faces, 0.0)?;
    /// assert_eq!(tetrahedron.face_count(), 4);
    ///
    /// let open = ConvexPolyhedron::from_mesh(&vertices, &faces[..3], 0.0);
    /// let Err(BuildError::Topology(TopologyError::OpenEdge { .. })) = open else {
    ///     unreachable!("a face is missing")
    /// };
    /// # Ok::<(), BuildError>(())
    /// ```
    pub fn from_mesh<F: AsRef<[u32]>>(
        vertices: &[DVec3],
        faces: &[F],
        tolerance: f64,
    ) -> Result<Self, BuildError> {
        mesh::from_mesh(vertices, faces, tolerance)
    }

    fn from_hull(points: &[DVec3], hull: Hull) -> Self {
        let Hull { dimension, vertices: input_index, topology, violation } = hull;
        let vertices: Vec<DVec3> = input_index.iter().map(|&i| points[i as usize]).collect();
        let measure = Measure::new(&vertices, &topology, dimension);
        let support = SupportIndex::build(&vertices, &topology, &measure);
        let sections = if dimension == 3 {
            SectionIndex::build(&vertices, &topology)
        } else {
            SectionIndex::default()
        };
        Self {
            vertices,
            input_index,
            dimension,
            hull_error: violation,
            topology,
            measure,
            support,
            sections,
        }
    }

    /// The vertices, in the body frame.
    pub fn vertices(&self) -> &[DVec3] {
        &self.vertices
    }

    /// For each vertex, its index in the points or mesh vertices the polyhedron was made from.
    pub fn input_indices(&self) -> &[u32] {
        &self.input_index
    }

    /// 3 for a solid, 2 for a flat polygon (with a front and a back face), 1 for a segment, 0 for a
    /// point.
    pub fn dimension(&self) -> u8 {
        self.dimension
    }

    /// Number of faces: 2 for a flat polygon, 0 for a segment or a point.
    pub fn face_count(&self) -> usize {
        self.topology.face_count()
    }

    /// Number of edges.
    pub fn edge_count(&self) -> usize {
        self.topology.edge_count()
    }

    /// The vertices of a face, counter-clockwise as seen from outside.
    ///
    /// # Panics
    /// If there is no such face.
    pub fn face_vertices(&self, face: u32) -> impl ExactSizeIterator<Item = u32> + Clone + '_ {
        self.topology.face_vertices(face)
    }

    /// Unit normal of a face, outwards, in the body frame, rounded.
    ///
    /// # Panics
    /// If there is no such face.
    pub fn face_normal(&self, face: u32) -> DVec3 {
        polygon_normal(self.face_vertices(face).map(|v| self.vertices[v as usize]))
    }

    /// The vertices joined to `vertex` by an edge, clockwise as seen from outside.
    ///
    /// # Panics
    /// If there is no such vertex.
    pub fn neighbours(&self, vertex: u32) -> &[u32] {
        self.topology.neighbours(vertex)
    }

    /// The largest distance by which an input point lies outside a face plane: the hull's own
    /// error, in the unit of the input.
    pub fn hull_error(&self) -> f64 {
        self.hull_error
    }

    /// The volume, in the cube of the input's unit; 0 for a body of lower dimension.
    pub fn volume(&self) -> f64 {
        self.measure.volume
    }

    /// The vertex farthest along `direction` (body frame, any length): a support point, in
    /// `O(log n)`. One of the farthest, to within rounding error, if there are several.
    ///
    /// ```
    /// use colltrans::ConvexPolyhedron;
    /// use colltrans::glam::DVec3;
    ///
    /// let needle = ConvexPolyhedron::from_points(&[DVec3::X * 100.0, DVec3::Y, DVec3::Z])?;
    /// let tip = needle.support(DVec3::new(1.0, -0.5, 0.25));
    /// assert_eq!(needle.vertices()[tip as usize], DVec3::new(100.0, 0.0, 0.0));
    /// assert_eq!(needle.input_indices()[tip as usize], 0);
    /// # Ok::<(), colltrans::BuildError>(())
    /// ```
    #[inline]
    pub fn support(&self, direction: DVec3) -> u32 {
        self.support.extreme(&self.vertices, &self.topology, direction)
    }

    /// A vertex near the support point.
    #[inline]
    pub(crate) fn support_guess(&self, direction: DVec3) -> u32 {
        self.support.guess(direction)
    }

    /// The support point, from a guess.
    #[inline]
    pub(crate) fn support_from_guess(&self, direction: DVec3, guess: u32) -> u32 {
        self.support.extreme_from_guess(&self.vertices, &self.topology, direction, guess)
    }

    /// The same as [`Self::support`], faster if `near` is a vertex near the answer.
    #[inline(always)]
    #[expect(
        clippy::inline_always,
        reason = "a direction passed through memory stalls the scan: 7 %"
    )]
    pub(crate) fn support_from(&self, direction: DVec3, near: u32) -> u32 {
        self.support.extreme_from(&self.vertices, &self.topology, direction, near)
    }

    /// Positions among the neighbours of `vertex` that may lie in its supporting plane along
    /// `direction`: the first and how many.
    pub(crate) fn plane_candidates(&self, vertex: u32, direction: DVec3) -> (usize, usize) {
        self.support.plane_candidates(&self.vertices, &self.topology, vertex, direction)
    }

    /// Bytes of memory that the polyhedron occupies, on the heap and in itself.
    pub fn memory_bytes(&self) -> usize {
        size_of::<Self>()
            + self.vertices.capacity() * size_of::<DVec3>()
            + self.input_index.capacity() * size_of::<u32>()
            + self.topology.heap_bytes()
            + self.support.heap_bytes()
            + self.sections.heap_bytes()
    }

    pub(crate) fn measure(&self) -> &Measure {
        &self.measure
    }

    pub(crate) fn topology(&self) -> &Topology {
        &self.topology
    }

    pub(crate) fn sections(&self) -> &SectionIndex {
        &self.sections
    }

    /// A body of dimension 3 from its faces, which the caller knows to be convex.
    #[cfg(test)]
    pub(crate) fn from_convex_faces(vertices: &[DVec3], faces: &[Vec<u32>]) -> Self {
        let mut face_start = vec![0];
        let mut face_vertices = Vec::new();
        for face in faces {
            face_vertices.extend_from_slice(face);
            face_start.push(face_vertices.len() as u32);
        }
        let topology = Topology::from_faces(vertices.len(), face_start, &face_vertices).unwrap();
        let vertices_in_order = (0..vertices.len() as u32).collect();
        let hull = Hull { dimension: 3, vertices: vertices_in_order, topology, violation: 0.0 };
        Self::from_hull(vertices, hull)
    }
}
