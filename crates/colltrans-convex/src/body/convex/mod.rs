//! Convex polyhedra, validated at construction.
//!
//! Data flow:
//! 1. [`build`] selects vertices and faces from points, a mesh or two opposite corners.
//! 2. [`Topology`] stores the half-edges, without coordinates.
//! 3. [`support`] indexes both for support point queries, at construction.
//! 4. [`sections`] indexes both for planar sections, when the paper's algorithm first needs them.

mod build;
mod excess;
mod fan;
mod ring;
mod round;
pub(crate) mod sections;
mod support;
#[cfg(test)]
pub(crate) mod tests;

use std::ops::Range;
use std::sync::OnceLock;

use glam::DVec3;

use crate::body::{DerivedDataSlot, Inertia, InputVertex, VertexId};
pub use build::{ConvexityDefect, OffsetReport, convexity_defect};
use colltrans_kernel::plane::polygon_normal;
use colltrans_kernel::topology::{HalfEdge, Topology};
pub(crate) use excess::LargeFace;
pub(crate) use fan::{MAX_SCANNED_NEIGHBOURS, cyclic_maximum};
pub(crate) use ring::Rim;
use sections::SectionIndex;
pub(crate) use support::MAX_RIMS;
use support::SupportIndex;

/// A convex polyhedron in its own frame: the convex hull of finitely many points, optionally
/// [rounded](Self::rounded) by a radius.
///
/// It may have a lower dimension: a flat polygon, a segment, a point. It is immutable, `Send` and `Sync`. The
/// indices that queries need are built at construction, in `O(n)` space. Two structures are built lazily, once, and
/// cached: planar sections for [`Solver::Cta`](crate::Solver::Cta) (built ahead by [`Self::prepare_sections`]), and
/// the body as a `Solid`. A clone copies existing sections, and shares an existing solid.
///
/// Vertices and faces are numbered from 0. [`Self::input_indices`] maps vertices to the input.
#[derive(Debug, Clone)]
pub struct ConvexPolyhedron {
    vertices: Vec<DVec3>,
    input_index: Vec<InputVertex>,
    dimension: u8,
    /// Whether the body is a box with sides along the axes of its frame, exactly.
    is_upright_box: bool,
    hull_error: f64,
    /// Upper bound of the distance of an input point from the body. In contrast to the hull error it does not
    /// include uneven faces.
    input_excess: f64,
    /// Depth of the source mesh below the body, if it exceeds rounding error; else 0.
    dent: f64,
    /// Upper bound of the distance of a corner from the plane of its polygon.
    flatness: f64,
    /// Radius of the ball that sweeps the body; 0 unless it is rounded.
    radius: f64,
    /// Faces with many corners, in ascending order. On a body with few vertices and few polygons, these are all
    /// faces with more than three corners.
    large_faces: Vec<LargeFace>,
    topology: Topology,
    inertia: Inertia,
    support: SupportIndex,
    /// Built when [`crate::Solver::Cta`] first needs them. Portal refinement does not use them.
    sections: OnceLock<SectionIndex>,
    /// The body as a solid, built when it is first needed.
    kept: DerivedDataSlot,
}

/// Maximum number of vertices of a body for which a ball gives a guess that is good enough (measured).
const MAX_BALL_VERTICES: usize = 20;

impl ConvexPolyhedron {
    /// Returns the vertices, in the body frame.
    pub fn vertices(&self) -> &[DVec3] {
        &self.vertices
    }

    /// Returns for each vertex its number among the points or mesh vertices from which the polyhedron was made.
    pub fn input_indices(&self) -> &[InputVertex] {
        &self.input_index
    }

    /// Returns the dimension: 3 for a solid, 2 for a flat polygon (with a front and a back face), 1 for a segment, 0
    /// for a point.
    pub fn dimension(&self) -> u8 {
        self.dimension
    }

    /// Checks whether the vertices are those of a box with sides along the axes of the body frame, exactly.
    #[inline]
    pub(crate) fn is_upright_box(&self) -> bool {
        self.is_upright_box
    }

    /// Returns the number of faces: 2 for a flat polygon, 0 for a segment or a point.
    pub fn face_count(&self) -> usize {
        self.topology.face_count()
    }

    /// Returns the number of edges.
    pub fn edge_count(&self) -> usize {
        self.topology.edge_count()
    }

    /// Returns the vertices of a face, counter-clockwise as seen from outside.
    ///
    /// # Panics
    /// If `face` is not below [`Self::face_count`].
    pub fn face_vertices(&self, face: u32) -> impl ExactSizeIterator<Item = u32> + Clone + '_ {
        self.topology.face_vertices(face)
    }

    /// Computes the outward unit normal of a face, in the body frame, rounded.
    ///
    /// # Panics
    /// If `face` is not below [`Self::face_count`].
    pub fn face_normal(&self, face: u32) -> DVec3 {
        polygon_normal(self.face_vertices(face).map(|v| self.vertices[v as usize]))
    }

    /// Returns the vertices that share an edge with `vertex`, clockwise as seen from outside.
    ///
    /// # Panics
    /// If `vertex` is not below the number of vertices.
    pub fn neighbours(&self, vertex: u32) -> &[u32] {
        self.topology.neighbours(vertex)
    }

    /// Returns the half-edges, two for each edge. They are ordered by face, and counter-clockwise within a face as
    /// seen from outside. Half-edge numbers are positions in this slice, which is empty for a segment or a point.
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

    /// Returns the half-edges around a face, in the order of [`Self::face_vertices`]. The origin of each is the face
    /// vertex at its position.
    ///
    /// # Panics
    /// If `face` is not below [`Self::face_count`].
    pub fn face_half_edges(&self, face: u32) -> Range<u32> {
        self.topology.face_half_edges(face)
    }

    /// Returns the half-edges that leave `vertex`, in the order of its [`Self::neighbours`]. An end of a segment has
    /// none.
    ///
    /// # Panics
    /// If `vertex` is not below the number of vertices.
    pub fn outgoing(&self, vertex: u32) -> &[u32] {
        self.topology.outgoing_half_edges(vertex)
    }

    /// Returns the hull error, an upper bound of two distances, in the unit of the input:
    /// - the distance of an input point from the body, which is the convex hull of [`Self::vertices`];
    /// - the distance of a vertex outside the plane of a face.
    ///
    /// It has the size of rounding errors, independent of the shape. The largest observed value is `1024 u`, that is
    /// `1.2e-13`, relative to the largest coordinate.
    ///
    /// Bounds of answers account for input points outside the bodies, so they hold for the convex hulls of the input
    /// as well. Lower bounds of distances, translations and gaps are lowered by the first distance of both bodies
    /// (divided by `n . d` along a direction). The upper bound of a depth is raised by it. Certificates are checked
    /// against the vertices alone.
    pub fn hull_error(&self) -> f64 {
        self.hull_error
    }

    /// Returns the largest depth of the source mesh's surface below the body, in the unit of the input.
    ///
    /// It is 0 for a mesh that is convex up to rounding error, and for a body that was not made from a mesh. A mesh
    /// with a larger value is convex only within the tolerance of [`Self::from_mesh`], and answers refer to the hull
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

    /// Returns an upper bound of the distance of an input point from the body; 0 if no input point is outside.
    #[inline]
    #[doc(hidden)]
    pub fn input_excess(&self) -> f64 {
        self.input_excess
    }

    /// Returns the body with an input excess of 0, that is, as the hull of its vertices alone. The caller must
    /// account for input points outside this hull.
    #[must_use]
    #[inline]
    pub fn without_input_excess(self) -> Self {
        Self { input_excess: 0.0, ..self }
    }

    /// Returns the volume, in the cube of the input's unit; 0 for a body of lower dimension that is not rounded.
    pub fn volume(&self) -> f64 {
        self.inertia.volume + self.volume_of_rounding()
    }

    /// Finds the support point, the vertex farthest along `direction` (body frame, any length), in `O(log n)`. If
    /// several vertices are equally far up to rounding error, it returns one of them.
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

    /// Returns a vertex near the support point along `direction`, for [`Self::support_from_guess`].
    #[inline]
    pub(crate) fn support_guess(&self, direction: DVec3) -> u32 {
        self.support.table_guess(direction)
    }

    /// Returns a vertex near a point (body frame): the nearest one of a body that is small enough to scan, otherwise one
    /// near the support point along the direction from the centre to the point.
    #[inline]
    pub(crate) fn vertex_near(&self, point: DVec3) -> u32 {
        if !self.support.is_scanned() {
            return self.support.table_guess(point - self.inertia.center);
        }
        let (mut nearest, mut least) = (0, f64::INFINITY);
        for (k, vertex) in self.vertices.iter().enumerate() {
            let square = vertex.distance_squared(point);
            nearest = if square < least { k as u32 } else { nearest };
            least = if square < least { square } else { least };
        }
        nearest
    }

    /// Finds the support point along `direction`, starting from the vertex `guess`.
    #[inline]
    pub(crate) fn support_from_guess(&self, direction: DVec3, guess: u32) -> u32 {
        self.support.farthest_vertex_from_guess(&self.vertices, &self.topology, direction, guess)
    }

    /// Finds the support point along `direction`. In contrast to [`Self::support`], the search is faster if the
    /// vertex `near` is near the result.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "a direction in memory stalls the scan")]
    pub(crate) fn support_point_from(&self, direction: DVec3, near: u32) -> u32 {
        self.support.farthest_vertex_near(&self.vertices, &self.topology, direction, near)
    }

    /// Checks whether the body has so few vertices and is so round that a guess from a ball suffices in place of one
    /// from its inertia ellipsoid.
    #[inline]
    pub(crate) fn is_like_ball(&self) -> bool {
        self.vertices.len() <= MAX_BALL_VERTICES && self.inertia.is_round
    }

    /// Checks whether the body may have rims: faces with many corners or vertices with many neighbours, to which a
    /// ring of vertices belongs.
    #[inline]
    pub(crate) fn may_have_rims(&self) -> bool {
        self.support.has_rings()
    }

    /// Returns at most [`MAX_RIMS`] rims and points whose hull approximates the body. The iterator is empty if
    /// there is no such approximation.
    #[inline]
    pub(crate) fn rim_outline(&self) -> impl ExactSizeIterator<Item = Rim> {
        let known = self.support.outline();
        let few = known.is_empty() && self.vertices.len() <= MAX_RIMS;
        let count = if few { self.vertices.len() } else { known.len() };
        let point = |k: usize| Rim::from_vertex(k as u32, self.vertices[k]);
        (0..count).map(move |k| if few { point(k) } else { known[k] })
    }

    /// Finds the farthest vertex along `direction` on the rim that contains `vertex`. Returns `vertex` if it is on
    /// no rim.
    pub(crate) fn farthest_rim_vertex(&self, direction: DVec3, vertex: u32) -> u32 {
        self.support.farthest_on_ring(&self.vertices, &self.topology, direction, vertex)
    }

    /// Finds the edge of `vertex` that is steepest along `direction`, as a position among its neighbours. The vertex
    /// must have more than [`MAX_SCANNED_NEIGHBOURS`] neighbours.
    pub(crate) fn steepest_edge_position(&self, vertex: u32, direction: DVec3) -> usize {
        self.support.fan_of_vertex(vertex).steepest_edge_position(
            &self.vertices,
            &self.topology,
            direction,
        )
    }

    /// Returns a range of positions among the neighbours of `vertex`, as first position and count, cyclic. It
    /// contains the neighbours that may lie in the supporting plane at `vertex` along `direction`.
    pub(crate) fn plane_candidates(&self, vertex: u32, direction: DVec3) -> (usize, usize) {
        self.support.plane_candidates(&self.vertices, &self.topology, vertex, direction)
    }

    /// Builds the planar sections that [`Solver::Cta`](crate::Solver::Cta) needs, unless they exist.
    ///
    /// Without this call, the body's first cast with that solver that solves a planar problem builds them. This
    /// takes `O(n log n)` time on one thread, while other threads that need them wait. Therefore a program that
    /// measures queries or answers within a deadline should call this method first. Other solvers do not use
    /// sections, and a body of lower dimension has none.
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

    /// Returns the number of bytes that the polyhedron occupies, including its heap memory. Sections and the body as
    /// a solid count once they are built.
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

    /// Returns the cache for structures that other crates derive from the body.
    #[doc(hidden)]
    pub fn kept(&self) -> &DerivedDataSlot {
        &self.kept
    }

    /// Returns size, volume and inertia ellipsoid of the body.
    #[doc(hidden)]
    #[inline]
    pub fn inertia(&self) -> &Inertia {
        &self.inertia
    }

    /// Returns the half-edges and faces.
    pub(crate) fn topology(&self) -> &Topology {
        &self.topology
    }

    /// Returns the planar sections, which are built by the first call. They are empty for a body of lower dimension.
    pub(crate) fn sections(&self) -> &SectionIndex {
        self.sections.get_or_init(|| match self.dimension {
            3 => SectionIndex::build(&self.vertices, &self.topology),
            _ => SectionIndex::default(),
        })
    }
}
