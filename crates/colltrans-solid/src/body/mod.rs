//! Solids that need not be convex, validated on input.
//!
//! - [`validate`] builds a checked surface of triangles from facets.
//! - [`shells`] finds its connected parts, and reverses those that are inside out.
//! - [`tree`] builds the tree of boxes that searches descend.
//! - [`shrink`] computes offsets on first use, and [`self_intersection`] finds walls that are too thin for an offset.
//!   [`extremes`] stores which vertices determine the boxes of offset solids.
//! - [`round`] sweeps a solid by a ball: its radius.
//! - [`faces`] joins triangles to polygonal faces on first use; [`bodies`] assigns cavities to the shells around
//!   them.

mod bodies;
mod convex;
pub(crate) mod cuts;
pub(crate) mod edges;
mod error;
pub(crate) mod exact;
mod extremes;
mod faces;
mod openness;
mod polygon;
mod report;
mod round;
mod self_intersection;
mod shells;
mod shrink;
pub mod tree;
mod validate;
pub(crate) mod wedge;
mod weld;

use std::borrow::Cow;
use std::sync::OnceLock;

use glam::{DVec3, Vec3Swizzles};

use colltrans_convex::body::{
    Aabb, ConvexPolyhedron, DerivedDataSlot, InputFacet, InputNumbered, InputVertex, Moving,
    VertexHull,
};
use colltrans_kernel::motion::Motion;
pub use error::SolidError;
use extremes::OffsetExtremes;
use faces::Faces;
pub use report::{Shell, ShellKind, SolidReport};
#[doc(hidden)]
pub use round::check_is_not_rounded;
pub use shells::ray_crossing;
pub use shrink::{OffsetField, ShrinkReport, offset_vertex};
use tree::Node;
pub(crate) use validate::Surface;

/// A solid in its own frame, bounded by triangles. It may have holes, cavities and several parts.
///
/// The surface is closed and consistently oriented, or has open shells ([`Self::from_open_mesh`]). Several closed
/// surfaces may overlap. The solid is the union of the regions that they enclose. A solid is immutable, `Send` and
/// `Sync`. Vertices and facets keep the indices of the input.
///
/// ```
/// use colltrans::Solid;
/// use colltrans::glam::DVec3;
///
/// // A square frame: 4 x 4 outside, 2 x 2 inside, 1 high.
/// let corner = |r: f64, k: usize, z: f64| {
///     DVec3::new([-r, r, r, -r][k % 4], [-r, -r, r, r][k % 4], z)
/// };
/// let vertices: Vec<DVec3> = [(2.0, 0.0), (2.0, 1.0), (1.0, 0.0), (1.0, 1.0)]
///     .iter()
///     .flat_map(|&(r, z)| (0..4).map(move |k| corner(r, k, z)))
///     .collect();
/// let facets: Vec<[u32; 4]> = (0..4)
///     .flat_map(|k| {
///         let l = (k + 1) % 4;
///         [
///             [k, l, 4 + l, 4 + k],
///             [4 + k, 4 + l, 12 + l, 12 + k],
///             [12 + k, 12 + l, 8 + l, 8 + k],
///             [8 + k, 8 + l, l, k],
///         ]
///     })
///     .collect();
/// let frame = Solid::from_mesh(&vertices, &facets)?;
/// assert_eq!(frame.report().holes_through(), 1);
/// assert_eq!(frame.volume(), 12.0);
/// # Ok::<(), colltrans::solid::SolidError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Solid {
    vertices: Vec<DVec3>,
    vertex_index: Vec<InputVertex>,
    triangles: Vec<[u32; 3]>,
    facet_index: Vec<InputFacet>,
    neighbours: Vec<[u32; 3]>,
    kinds: Vec<ShellKind>,
    nodes: Vec<Node>,
    spans: Vec<ShellBounds>,
    reach: f64,
    /// Radius of the ball that sweeps the surface and its interior; see [`Self::rounded`].
    radius: f64,
    /// Number of vertices and of facets of the input.
    input_counts: [u32; 2],
    report: SolidReport,
    shrinking: OnceLock<OffsetField>,
    /// Computed when a motion of an offset solid is first requested.
    extremes: OnceLock<Box<OffsetExtremes>>,
    /// Computed when a feature is first requested.
    faces: OnceLock<Box<Faces>>,
    groups: Box<Groups>,
    kept: DerivedDataSlot,
}

impl InputNumbered for Solid {
    fn vertex_inputs(&self) -> &[InputVertex] {
        &self.vertex_index
    }

    fn face_corner_positions(&self, face: u32) -> Vec<u32> {
        self.face_corners(face)
    }
}

/// A body that can be used as a [`Solid`] in queries and as a piece of a solid.
pub trait AsSolid: InputNumbered {
    /// Returns the body as a solid without a radius. The surface of a convex polyhedron is built on first use and
    /// stored with it. A flat polygon becomes a surface with two sides and no volume.
    ///
    /// # Errors
    /// Returns [`SolidError::Rounded`] for a rounded body, [`SolidError::NoArea`] for a point or a segment, and an
    /// error for a body whose facets [`Solid::from_mesh`] rejects.
    fn as_solid(&self) -> Result<&Solid, SolidError>;

    /// Returns the body as a solid, and a point or a segment as one facet without area.
    ///
    /// Casts, distances, motions and scenes accept such a facet. It is an open shell: it has no interior and no
    /// offset. The result has the radius of the body, so a sphere is a point with a radius.
    ///
    /// # Errors
    /// Returns an error for a body whose facets [`Solid::from_mesh`] rejects.
    fn as_surface(&self) -> Result<&Solid, SolidError>;
}

impl AsSolid for Solid {
    fn as_solid(&self) -> Result<&Solid, SolidError> {
        round::check_is_not_rounded(self.radius)?;
        match self.triangles[..] {
            [[a, b, c]] if a == b && b == c => Err(SolidError::NoArea { what: "point" }),
            [_] if self.is_without_area(0) => Err(SolidError::NoArea { what: "segment" }),
            _ => Ok(self),
        }
    }

    fn as_surface(&self) -> Result<&Solid, SolidError> {
        Ok(self)
    }
}

/// The bounding box of a shell.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ShellBounds {
    pub(crate) bounds: Aabb,
    /// Position of one triangle of the shell.
    pub(crate) triangle: u32,
}

/// Groups of facets.
#[derive(Debug, Clone, Default)]
struct Groups {
    /// First input facet of each piece, without the first piece.
    piece_starts: Vec<u32>,
    /// Results of [`Solid::bodies`], computed when a point or a segment lies on one of several shells.
    body_of: OnceLock<Vec<u32>>,
}

impl Groups {
    fn heap_bytes(&self) -> usize {
        let bodies = self.body_of.get().map_or(0, Vec::capacity);
        (self.piece_starts.capacity() + bodies) * size_of::<u32>()
    }
}

/// Validates the polygons of a surface and orients its shells.
fn oriented_surface<F: AsRef<[u32]>>(
    vertices: &[DVec3],
    facets: &[F],
    open: bool,
) -> Result<(Surface, SolidReport), SolidError> {
    let mut report = SolidReport::default();
    let mut surface = validate::validated_surface(vertices, facets, open, &mut report)?;
    shells::orient_shells(&mut surface, &mut report);
    Ok((surface, report))
}

impl SolidReport {
    /// Returns the report of [`Solid::from_mesh`] without building the solid.
    ///
    /// # Errors
    /// Returns the errors of [`Solid::from_mesh`].
    pub fn from_mesh<F: AsRef<[u32]>>(
        vertices: &[DVec3],
        facets: &[F],
    ) -> Result<Self, SolidError> {
        Ok(oriented_surface(vertices, facets, false)?.1)
    }

    /// Returns the report of [`Solid::from_open_mesh`] without building the solid.
    ///
    /// # Errors
    /// Returns the errors of [`Solid::from_open_mesh`].
    pub fn from_open_mesh<F: AsRef<[u32]>>(
        vertices: &[DVec3],
        facets: &[F],
    ) -> Result<Self, SolidError> {
        Ok(oriented_surface(vertices, facets, true)?.1)
    }
}

impl Solid {
    /// Builds a solid from the polygons of a closed surface (body frame, any unit).
    ///
    /// Polygons are counter-clockwise as seen from outside, and are triangulated. Vertices with equal coordinates are
    /// merged, facets without area removed, and vertices that lie exactly on an edge joined to it. Shells that are
    /// inside out are reversed. [`Self::report`] lists these repairs.
    ///
    /// # Errors
    /// Returns an error for an open surface and for facets with inconsistent orientations. It also rejects
    /// coordinates that are not finite or out of range, invalid vertex indices, polygons that cross themselves, and
    /// meshes with no facets or too many.
    pub fn from_mesh<F: AsRef<[u32]>>(
        vertices: &[DVec3],
        facets: &[F],
    ) -> Result<Self, SolidError> {
        Ok(Self::from_oriented(oriented_surface(vertices, facets, false)?))
    }

    /// Builds a solid from a surface with open shells, such as a scan or a sheet.
    ///
    /// Closed shells keep their interior. Open shells ([`ShellKind::Sided`], [`ShellKind::Sheet`]) have no interior;
    /// they block from both sides and with their boundary edges, and overlap bodies that they pass through.
    /// [`Self::report`] lists the kind of each shell.
    ///
    /// # Errors
    /// Returns an error in the same cases as [`Self::from_mesh`], except for edges with a facet on one side only.
    pub fn from_open_mesh<F: AsRef<[u32]>>(
        vertices: &[DVec3],
        facets: &[F],
    ) -> Result<Self, SolidError> {
        Ok(Self::from_oriented(oriented_surface(vertices, facets, true)?))
    }

    /// Builds the union of several solids or convex polyhedra, which may overlap.
    ///
    /// The inputs of the pieces are numbered consecutively, including unused vertices and facets
    /// ([`Self::input_counts`]).
    ///
    /// # Errors
    /// Returns an error if there are no pieces, if the result has more than `2^29 - 1` triangles, input vertices or
    /// input facets, or if [`AsSolid::as_solid`] rejects a piece, for example a point, a segment or a rounded body.
    pub fn from_pieces<'a, B: AsSolid + 'a>(
        pieces: impl IntoIterator<Item = &'a B>,
    ) -> Result<Self, SolidError> {
        let mut all = Surface {
            vertices: Vec::new(),
            vertex_index: Vec::new(),
            triangles: Vec::new(),
            facet_index: Vec::new(),
            neighbours: Vec::new(),
            input_counts: [0; 2],
            faces: None,
            kinds: Vec::new(),
        };
        let mut report = SolidReport::default();
        let mut piece_starts = Vec::new();
        for piece in pieces {
            let piece = piece.as_solid()?;
            let (v, t) = (all.vertices.len() as u32, all.triangles.len() as u32);
            let [vertex_base, facet_base] = all.input_counts;
            if !all.triangles.is_empty() {
                piece_starts.push(facet_base);
            }
            piece_starts.extend(piece.groups.piece_starts.iter().map(|start| start + facet_base));
            all.vertices.extend_from_slice(&piece.vertices);
            all.vertex_index
                .extend(piece.vertex_index.iter().map(|v| InputVertex(v.0 + vertex_base)));
            all.triangles.extend(piece.triangles.iter().map(|c| c.map(|k| k + v)));
            all.facet_index.extend(piece.facet_index.iter().map(|f| InputFacet(f.0 + facet_base)));
            let shift = |n: u32| if n == edges::NO_NEIGHBOUR { n } else { n + t };
            all.neighbours.extend(piece.neighbours.iter().map(|n| n.map(shift)));
            all.kinds.extend_from_slice(&piece.kinds);
            report.add_counts(&piece.report);
            let inputs =
                [0, 1].map(|k| all.input_counts[k] as usize + piece.input_counts[k] as usize);
            let limit = u32::MAX as usize / 8;
            let count = all.triangles.len().max(inputs[0]).max(inputs[1]);
            if count > limit {
                return Err(SolidError::TooMany { count, limit });
            }
            all.input_counts = inputs.map(|count| count as u32);
        }
        if all.triangles.is_empty() {
            return Err(SolidError::Empty);
        }
        let mut solid = Self::from_surface(all, report);
        solid.groups.piece_starts = piece_starts;
        Ok(solid)
    }

    /// Builds a surface with one facet without area: a point or a segment, given by corner positions.
    pub(crate) fn from_degenerate_facet(body: &ConvexPolyhedron, corners: [u32; 3]) -> Self {
        let surface = Surface {
            vertices: body.vertices().to_vec(),
            vertex_index: body.input_indices().to_vec(),
            triangles: vec![corners],
            facet_index: vec![InputFacet(0)],
            neighbours: vec![[edges::NO_NEIGHBOUR; 3]],
            input_counts: [
                body.input_indices().iter().max().map_or(0, |last| last.0.saturating_add(1)),
                1,
            ],
            faces: None,
            kinds: vec![ShellKind::Sheet],
        };
        let shell = Shell {
            triangles: 1,
            volume: 0.0,
            holes_through: None,
            reversed: false,
            kind: ShellKind::Sheet,
        };
        Self::from_surface(surface, SolidReport { shells: vec![shell], ..SolidReport::default() })
    }

    /// Checks whether a triangle is a point or a segment. Its second and third corner are then the same vertex.
    #[doc(hidden)]
    #[inline]
    pub fn is_without_area(&self, triangle: usize) -> bool {
        let [_, b, c] = self.triangles[triangle];
        b == c
    }

    /// Replaces vertex indices, and their number, by those of the input of the body from which the solid was built.
    pub(crate) fn with_input_numbers(mut self, inputs: &[InputVertex]) -> Self {
        for v in &mut self.vertex_index {
            *v = inputs[v.index()];
        }
        self.input_counts[0] = inputs.iter().max().map_or(0, |last| last.0.saturating_add(1));
        self
    }

    /// Separates the sheets of a surface and builds the solid.
    fn from_oriented((mut surface, report): (Surface, SolidReport)) -> Self {
        surface.separate_sheets();
        Self::from_surface(surface, report)
    }

    /// Builds the tree, and orders the triangles by its leaves.
    fn from_surface(surface: Surface, report: SolidReport) -> Self {
        let (mut nodes, order) = tree::build_tree(&surface.vertices, &surface.triangles);
        let mut place = vec![0; order.len()];
        for (k, &t) in order.iter().enumerate() {
            place[t as usize] = k as u32;
        }
        let shift = |n: u32| if n == edges::NO_NEIGHBOUR { n } else { place[n as usize] };
        let old = |k: &u32| *k as usize;
        let kinds: Vec<ShellKind> = order.iter().map(|k| surface.kinds[old(k)]).collect();
        tree::mark_open_nodes(&mut nodes, |t| kinds[t] != ShellKind::Closed);
        let reach = surface.vertices.iter().map(|v| v.length()).fold(0.0, f64::max);
        let faces =
            surface.faces.map_or_else(OnceLock::new, |f| Box::new(f.reordered(&order)).into());
        let mut solid = Self {
            triangles: order.iter().map(|k| surface.triangles[old(k)]).collect(),
            facet_index: order.iter().map(|k| surface.facet_index[old(k)]).collect(),
            neighbours: order.iter().map(|k| surface.neighbours[old(k)].map(shift)).collect(),
            vertices: surface.vertices,
            vertex_index: surface.vertex_index,
            kinds,
            nodes,
            spans: Vec::new(),
            reach,
            radius: 0.0,
            input_counts: surface.input_counts,
            report,
            shrinking: OnceLock::new(),
            extremes: OnceLock::new(),
            faces,
            groups: Box::default(),
            kept: DerivedDataSlot::default(),
        };
        solid.spans = solid.shell_spans();
        solid
    }

    /// Computes the bounding boxes of the shells.
    fn shell_spans(&self) -> Vec<ShellBounds> {
        let shell_of = edges::shell_numbers(&self.neighbours);
        let mut spans: Vec<ShellBounds> = Vec::new();
        for (t, &shell) in shell_of.iter().enumerate() {
            if shell as usize == spans.len() {
                spans.push(ShellBounds { bounds: Aabb::EMPTY, triangle: t as u32 });
            }
            for v in self.triangles[t] {
                spans[shell as usize].bounds.extend_to(self.vertices[v as usize]);
            }
        }
        spans
    }

    /// Checks whether indices of vertices, facets and nodes have the same meaning in another solid. The bounds of
    /// nodes may differ by rounding.
    #[cfg(feature = "json")]
    #[doc(hidden)]
    #[inline]
    pub fn has_same_tree(&self, other: &Self) -> bool {
        let place = |node: &Node| (node.child_offset, node.first_facet, node.facet_count);
        self.vertices == other.vertices
            && self.radius == other.radius
            && self.triangles == other.triangles
            && self.kinds == other.kinds
            && self.nodes.iter().map(place).eq(other.nodes.iter().map(place))
    }

    /// Returns the vertices in use, in the body frame.
    pub fn vertices(&self) -> &[DVec3] {
        &self.vertices
    }

    /// Returns the input index of each of [`Self::vertices`].
    pub fn vertex_indices(&self) -> &[InputVertex] {
        &self.vertex_index
    }

    /// Returns the number of vertices and of facets of the input, including unused ones. For a convex polyhedron,
    /// vertices after the last used one are not counted.
    pub fn input_counts(&self) -> [u32; 2] {
        self.input_counts
    }

    /// Returns the triangles, as indices into [`Self::vertices`].
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// Returns the input facet to which each of [`Self::triangles`] belongs.
    pub fn facet_indices(&self) -> &[InputFacet] {
        &self.facet_index
    }

    /// Checks whether all shells are closed.
    pub fn is_closed(&self) -> bool {
        !self.nodes[0].is_open()
    }

    /// Checks whether a triangle belongs to an open shell.
    #[doc(hidden)]
    #[inline]
    pub fn is_open(&self, triangle: usize) -> bool {
        self.kinds[triangle] != ShellKind::Closed
    }

    /// Checks whether a shell is closed; shells are numbered as in [`Self::spans`].
    fn is_shell_closed(&self, shell: u32) -> bool {
        !self.is_open(self.spans[shell as usize].triangle as usize)
    }

    /// Checks whether a closed body vanishes under an inward offset by this amount, because the amount is positive and
    /// at least half of the smallest side of its box.
    pub(crate) fn vanishes_under_offset(&self, amount: f64) -> bool {
        amount > 0.0 && 2.0 * amount >= self.min_side() && self.is_closed()
    }

    /// Returns the smallest side of the bounding box.
    pub(crate) fn min_side(&self) -> f64 {
        self.bounds().side_lengths().min_element()
    }

    /// Checks whether the solid has an interior, that is, a closed shell.
    pub(crate) fn has_interior(&self) -> bool {
        self.report.shell_count(ShellKind::Closed) > 0
    }

    /// Checks whether any shell has an offset, that is, is not a sheet.
    #[doc(hidden)]
    #[inline]
    pub fn has_offset(&self) -> bool {
        self.report.shells.iter().any(|s| s.kind != ShellKind::Sheet)
    }

    /// Returns the report of the construction: shells and repairs.
    pub fn report(&self) -> &SolidReport {
        &self.report
    }

    /// Returns the sum of the volumes of all shells, in cubic units. Overlaps of pieces count twice. If a shell is
    /// open, the sum has no meaning. The radius of a rounded solid does not count.
    pub fn volume(&self) -> f64 {
        self.report.shells.iter().map(|s| s.volume).sum()
    }

    /// Computes proven bounds on the volume without a radius, `[lower, upper]`; `None` if a shell is open.
    /// Derivation: `docs/theory/solid-bounds.md`.
    pub fn volume_bounds(&self) -> Option<[f64; 2]> {
        const U: f64 = f64::EPSILON / 2.0;
        if !self.is_closed() {
            return None;
        }
        let origin = self.vertices[self.triangles[0][0] as usize];
        let (mut sum, mut error) = (0.0_f64, 0.0);
        for corners in &self.triangles {
            let [a, b, c] = corners.map(|v| self.vertices[v as usize] - origin);
            sum += a.dot(b.cross(c));
            let [a, b, c] = [a.abs(), b.abs(), c.abs()];
            let products = a.dot(b.yzx() * c.zxy() + b.zxy() * c.yzx());
            error += U * (10.0 * products + sum.abs()) + f64::MIN_POSITIVE;
        }
        let (value, error) = (self.volume(), 1.01 * error);
        let [lower, upper] = [(sum - error) / 6.0, (sum + error) / 6.0];
        let [lower, upper] = [lower.next_down().next_down(), upper.next_up().next_up()];
        Some([lower.min(value), upper.max(value)])
    }

    /// Returns the bounding box of all vertices. It does not contain the radius of a rounded solid.
    pub fn bounds(&self) -> Aabb {
        self.nodes[0].bounds
    }

    /// Returns the offset field, or `None` if this amount changes nothing.
    pub(crate) fn shrinking_by(&self, amount: f64) -> Option<&OffsetField> {
        (amount != 0.0 && self.has_offset()).then(|| self.offset_field())
    }

    /// Returns a box around the body offset inwards by this amount.
    pub(crate) fn offset_bounds(&self, amount: f64) -> Aabb {
        let bounds = self.bounds();
        let shrinking = self.shrinking_by(amount);
        shrinking.map_or(bounds, |shrinking| shrinking.offset_box(bounds, amount, 0))
    }

    /// Returns an upper bound on the displacement of a vertex under an offset by this amount.
    #[doc(hidden)]
    #[inline]
    pub fn max_offset_displacement(&self, amount: f64) -> f64 {
        self.shrinking_by(amount).map_or(0.0, |shrinking| shrinking.max_displacement * amount.abs())
    }

    /// Returns the memory that the solid occupies now, in bytes. Lazily computed data (offset field, polygonal faces,
    /// data that queries derive) counts once it exists.
    pub fn memory_bytes(&self) -> usize {
        size_of::<Self>() + self.heap_bytes()
    }

    pub(crate) fn heap_bytes(&self) -> usize {
        self.vertices.capacity() * size_of::<DVec3>()
            + self.vertex_index.capacity() * size_of::<u32>()
            + self.triangles.capacity() * size_of::<[u32; 3]>()
            + self.facet_index.capacity() * size_of::<u32>()
            + self.neighbours.capacity() * size_of::<[u32; 3]>()
            + self.kinds.capacity()
            + self.nodes.capacity() * size_of::<Node>()
            + self.spans.capacity() * size_of::<ShellBounds>()
            + self.report.shells.capacity() * size_of::<Shell>()
            + self.shrinking.get().map_or(0, OffsetField::heap_bytes)
            + self.extremes.get().map_or(0, |all| size_of::<OffsetExtremes>() + all.heap_bytes())
            + self.faces.get().map_or(0, |faces| size_of::<Faces>() + faces.heap_bytes())
            + size_of::<Groups>()
            + self.groups.heap_bytes()
            + self.kept.heap_bytes()
    }

    /// Returns the slot for data that queries derive from the body.
    pub(crate) fn derived_data(&self) -> &DerivedDataSlot {
        &self.kept
    }

    /// Returns the largest distance of a vertex from the origin of the body frame.
    pub(crate) fn reach(&self) -> f64 {
        self.reach
    }

    #[doc(hidden)]
    #[inline]
    pub fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    pub(crate) fn neighbours(&self) -> &[[u32; 3]] {
        &self.neighbours
    }

    pub(crate) fn shell_bounds(&self) -> &[ShellBounds] {
        &self.spans
    }

    /// Returns [`Self::bodies`], computed on first use.
    pub(crate) fn body_numbers(&self) -> &[u32] {
        self.groups.body_of.get_or_init(|| self.bodies())
    }

    /// Returns the index of the piece to which a triangle belongs.
    pub(crate) fn piece_of(&self, triangle: usize) -> usize {
        let facet = self.facet_index[triangle].0;
        self.groups.piece_starts.partition_point(|start| *start <= facet)
    }
}

impl Solid {
    /// Returns the body with a motion, for a cast of rotating bodies.
    pub fn with_motion<'a>(&'a self, motion: &'a Motion) -> Moving<'a, Self> {
        Moving { body: self, motion: Cow::Borrowed(motion) }
    }
}

#[doc(hidden)]
impl VertexHull for Solid {
    fn hull_vertices(&self) -> &[DVec3] {
        self.vertices()
    }

    fn reach(&self) -> f64 {
        Self::reach(self)
    }

    fn radius(&self) -> f64 {
        Self::radius(self)
    }
}
