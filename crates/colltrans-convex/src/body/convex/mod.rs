//! Convex polyhedra, validated on input.
//!
//! Data flow: points, a mesh or two corners -> [`build`] (which vertices, which faces) ->
//! [`topology`](crate::body::topology) (half-edges, no coordinates) -> the indices built on both
//! ([`support`] points at once, [`sections`] when the paper's algorithm first asks for them).

mod build;
mod excess;
mod fan;
mod ring;
pub(crate) mod sections;
mod support;
#[cfg(test)]
pub(crate) mod tests;

use std::ops::Range;
use std::sync::OnceLock;

use glam::DVec3;

use crate::body::{Inertia, InputVertex, Kept, VertexId};
pub use build::{ConvexityDefect, OffsetReport, convexity_defect};
use colltrans_kernel::plane::polygon_normal;
use colltrans_kernel::topology::{HalfEdge, Topology};
pub(crate) use excess::LargeFace;
pub(crate) use fan::{FAN, greatest_near};
pub(crate) use ring::Rim;
use sections::SectionIndex;
pub(crate) use support::MOST_RIMS;
use support::SupportIndex;

/// A convex polyhedron in its own frame: the convex hull of finitely many points.
///
/// It may be of lower dimension: a flat polygon, a segment, a point. Immutable, `Send` and `Sync`;
/// everything a query needs is built once, here, in `O(n)` space. Two things are made when they are
/// first asked for, once, and kept: planar sections for [`Solver::Cta`](crate::Solver::Cta)
/// ([`Self::prepare_sections`] makes them beforehand), and the body as a `Solid`. A clone copies what
/// there is.
///
/// Vertices and faces are numbered from 0; [`Self::input_indices`] leads back to the input.
#[derive(Debug, Clone)]
pub struct ConvexPolyhedron {
    vertices: Vec<DVec3>,
    input_index: Vec<InputVertex>,
    dimension: u8,
    hull_error: f64,
    /// Bound on the distance of an input point from the body: the hull error without uneven faces.
    input_excess: f64,
    /// How deep the mesh that the body was made of lies below it, where that is more than rounding.
    dent: f64,
    /// The largest distance of a corner from its polygon's plane.
    flatness: f64,
    /// Faces with many corners, or all polygons where they are few, ascending.
    large_faces: Vec<LargeFace>,
    topology: Topology,
    inertia: Inertia,
    support: SupportIndex,
    /// Made when [`crate::Solver::Cta`] first asks for them: portal refinement does without.
    sections: OnceLock<SectionIndex>,
    /// The same body as a solid, made when it is first asked for.
    kept: Kept,
}

/// Bodies with more vertices than this are worth the better guess from ellipsoids (measured).
const MAX_BALL_VERTICES: usize = 20;

impl ConvexPolyhedron {
    /// The vertices, in the body frame.
    pub fn vertices(&self) -> &[DVec3] {
        &self.vertices
    }

    /// For each vertex, its number in the points or mesh vertices the polyhedron was made from.
    pub fn input_indices(&self) -> &[InputVertex] {
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

    /// The directed edges, two for each edge: those of face 0 first, each face's one after the other,
    /// counter-clockwise as seen from outside. Indices of half-edges are indices of this slice, which is
    /// empty for a segment or a point.
    ///
    /// ```
    /// use colltrans::ConvexPolyhedron;
    /// use colltrans::glam::DVec3;
    ///
    /// let cube = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE)?;
    /// let half_edges = cube.half_edges();
    /// let across = |h: u32| half_edges[half_edges[h as usize].twin as usize].face;
    /// let around: Vec<u32> = cube.face_half_edges(0).map(across).collect();
    /// assert_eq!(around.len(), 4, "the faces that share an edge with face 0");
    /// # Ok::<(), colltrans::BuildError>(())
    /// ```
    pub fn half_edges(&self) -> &[HalfEdge] {
        self.topology.half_edges()
    }

    /// The half-edges around a face: those from its [`Self::face_vertices`], in their order.
    ///
    /// # Panics
    /// If there is no such face.
    pub fn face_half_edges(&self, face: u32) -> Range<u32> {
        self.topology.face(face)
    }

    /// The half-edges that leave `vertex`, in the order of its [`Self::neighbours`]; none for an end of a
    /// segment.
    ///
    /// # Panics
    /// If there is no such vertex.
    pub fn outgoing(&self, vertex: u32) -> &[u32] {
        self.topology.outgoing(vertex)
    }

    /// No input point is farther than this from the body (the convex hull of [`Self::vertices`]), nor a
    /// vertex outside a face plane: the hull's own error, in the unit of the input.
    ///
    /// It has the size of rounding, whatever the shape: the most seen is `1024 u`, `1.2e-13`, of the
    /// largest coordinate. Bounds of answers count how far input points are outside, so they hold for the
    /// convex hull of the input as well: lower bounds of distances, translations and gaps are lowered by that
    /// distance of both bodies (over `n . d` along a direction), and the upper bound of a depth is raised by it.
    /// Certificates are checked against the vertices alone.
    pub fn hull_error(&self) -> f64 {
        self.hull_error
    }

    /// How deep the surface of the mesh that the body was made of lies below the body: its largest dent, in
    /// the unit of the input.
    ///
    /// 0 for a mesh that is convex to rounding error, and for a body that is not made of a mesh. With a larger
    /// dent the mesh is convex only to within the tolerance of [`Self::from_mesh`], and answers are about the hull
    /// of its vertices.
    ///
    /// ```
    /// use colltrans::ConvexPolyhedron;
    /// use colltrans::glam::DVec3;
    ///
    /// // An octahedron whose top is pushed in by a thousandth below the square of the other corners.
    /// let rim = [DVec3::X, DVec3::Y, DVec3::NEG_X, DVec3::NEG_Y];
    /// let vertices = [rim[0], rim[1], rim[2], rim[3], DVec3::NEG_Z, DVec3::Z * -1e-3];
    /// let faces: Vec<[u32; 3]> =
    ///     (0..4).flat_map(|i| [[i, (i + 1) % 4, 5], [(i + 1) % 4, i, 4]]).collect();
    /// assert!(ConvexPolyhedron::from_mesh(&vertices, &faces, 1e-4).is_err());
    /// let body = ConvexPolyhedron::from_mesh(&vertices, &faces, 1e-2)?;
    /// assert!((body.dent() - 1e-3).abs() < 1e-15);
    /// # Ok::<(), colltrans::BuildError>(())
    /// ```
    pub fn dent(&self) -> f64 {
        self.dent
    }

    /// Bound on the distance of an input point from the body; 0 if none is outside.
    #[inline]
    #[doc(hidden)]
    pub fn input_excess(&self) -> f64 {
        self.input_excess
    }

    /// The body as the hull of its vertices alone, for a caller that counts itself what those lack.
    #[must_use]
    #[inline]
    pub fn without_input_excess(self) -> Self {
        Self { input_excess: 0.0, ..self }
    }

    /// The volume, in the cube of the input's unit; 0 for a body of lower dimension.
    pub fn volume(&self) -> f64 {
        self.inertia.volume
    }

    /// The vertex farthest along `direction` (body frame, any length): a support point, in
    /// `O(log n)`. One of the farthest, to within rounding error, if there are several.
    ///
    /// ```
    /// use colltrans::glam::DVec3;
    /// use colltrans::{ConvexPolyhedron, InputVertex};
    ///
    /// let needle = ConvexPolyhedron::from_points(&[DVec3::X * 100.0, DVec3::Y, DVec3::Z])?;
    /// let tip = needle.support(DVec3::new(1.0, -0.5, 0.25));
    /// assert_eq!(needle.vertices()[tip.index()], DVec3::new(100.0, 0.0, 0.0));
    /// assert_eq!(needle.input_indices()[tip.index()], InputVertex(0));
    /// # Ok::<(), colltrans::BuildError>(())
    /// ```
    #[inline]
    pub fn support(&self, direction: DVec3) -> VertexId {
        VertexId(self.support.farthest_vertex(&self.vertices, &self.topology, direction))
    }

    /// A vertex near the support point.
    #[inline]
    pub(crate) fn support_guess(&self, direction: DVec3) -> u32 {
        self.support.table_guess(direction)
    }

    /// The support point, from a guess.
    #[inline]
    pub(crate) fn support_from_guess(&self, direction: DVec3, guess: u32) -> u32 {
        self.support.farthest_vertex_from_guess(&self.vertices, &self.topology, direction, guess)
    }

    /// The same as [`Self::support`], faster if `near` is a vertex near the answer.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "a direction passed through memory stalls the scan")]
    pub(crate) fn support_from(&self, direction: DVec3, near: u32) -> u32 {
        self.support.farthest_vertex_near(&self.vertices, &self.topology, direction, near)
    }

    /// Whether a guess from its inertia ellipsoid is hardly better than one from a ball.
    #[inline]
    pub(crate) fn is_like_ball(&self) -> bool {
        self.vertices.len() <= MAX_BALL_VERTICES && self.inertia.round
    }

    /// Whether the body has faces with so many corners, or vertices with so many neighbours, that these lie on a
    /// rim.
    #[inline]
    pub(crate) fn has_rims(&self) -> bool {
        self.support.has_rings()
    }

    /// At most [`MOST_RIMS`] rims and points that the body is nearly the hull of; none if it is no such body.
    #[inline]
    pub(crate) fn outline(&self) -> impl ExactSizeIterator<Item = Rim> {
        let known = self.support.outline();
        let few = known.is_empty() && self.vertices.len() <= MOST_RIMS;
        let count = if few { self.vertices.len() } else { known.len() };
        let point = |k: usize| Rim::from_vertex(k as u32, self.vertices[k]);
        (0..count).map(move |k| if few { point(k) } else { known[k] })
    }

    /// The vertex farthest along `direction` of the rim that a vertex is on; that vertex if it is on none.
    pub(crate) fn farthest_on_rim(&self, direction: DVec3, vertex: u32) -> u32 {
        self.support.farthest_on_ring(&self.vertices, &self.topology, direction, vertex)
    }

    /// Position among the neighbours of a vertex, which has many, of the steepest edge along `direction`.
    pub(crate) fn steepest_edge(&self, vertex: u32, direction: DVec3) -> usize {
        self.support.fan_of_vertex(vertex).steepest_edge(&self.vertices, &self.topology, direction)
    }

    /// Positions among the neighbours of `vertex` that may lie in its supporting plane along
    /// `direction`: the first and how many.
    pub(crate) fn plane_candidates(&self, vertex: u32, direction: DVec3) -> (usize, usize) {
        self.support.plane_candidates(&self.vertices, &self.topology, vertex, direction)
    }

    /// Makes the planar sections that [`Solver::Cta`](crate::Solver::Cta) works on, unless they are there.
    ///
    /// Otherwise the body's first cast with that solver that solves a planar problem makes them, in
    /// `O(n log n)`, on one thread while others that need them wait: who times queries, or answers within a
    /// deadline, pays here. No other solver needs them; a body of lower dimension has none.
    ///
    /// ```
    /// use colltrans::ConvexPolyhedron;
    /// use colltrans::glam::DVec3;
    ///
    /// let cube = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE)?;
    /// let before = cube.memory_bytes();
    /// cube.prepare_sections();
    /// assert!(cube.memory_bytes() > before);
    /// # Ok::<(), colltrans::BuildError>(())
    /// ```
    pub fn prepare_sections(&self) {
        self.sections();
    }

    /// Bytes of memory that the polyhedron occupies now, on the heap and in itself: sections, and the
    /// body as a solid, count once they are made.
    pub fn memory_bytes(&self) -> usize {
        size_of::<Self>()
            + self.vertices.capacity() * size_of::<DVec3>()
            + self.input_index.capacity() * size_of::<u32>()
            + self.topology.heap_bytes()
            + self.large_faces.capacity() * size_of::<LargeFace>()
            + self.support.heap_bytes()
            + self.sections.get().map_or(0, SectionIndex::heap_bytes)
            + self.kept.heap_bytes()
    }

    /// What others have made of the body.
    #[doc(hidden)]
    pub fn kept(&self) -> &Kept {
        &self.kept
    }

    #[doc(hidden)]
    #[inline]
    pub fn inertia(&self) -> &Inertia {
        &self.inertia
    }

    pub(crate) fn topology(&self) -> &Topology {
        &self.topology
    }

    pub(crate) fn sections(&self) -> &SectionIndex {
        self.sections.get_or_init(|| match self.dimension {
            3 => SectionIndex::build(&self.vertices, &self.topology),
            _ => SectionIndex::default(),
        })
    }
}
