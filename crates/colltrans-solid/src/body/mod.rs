//! Solids that need not be convex, validated on input.
//!
//! Data flow: facets -> [`validate`] (one checked surface of triangles) -> [`shells`] (which parts
//! there are, which are inside out) -> [`tree`] (what a search goes down). [`shrink`] is made when it
//! is first asked for; [`self_intersection`] finds the walls that are too thin for it.

mod bodies;
mod convex;
pub(crate) mod cuts;
pub(crate) mod edges;
mod error;
pub(crate) mod exact;
mod faces;
mod openness;
mod polygon;
mod report;
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
    Aabb, ConvexPolyhedron, Hull, InputFacet, InputVertex, Kept, Moving, Numbered,
};
use colltrans_kernel::motion::Motion;
pub use error::SolidError;
use faces::Faces;
pub use report::{Shell, ShellKind, SolidReport};
pub use shells::crossing;
pub use shrink::{ShrinkReport, Shrinking, displace};
use tree::Node;
pub(crate) use validate::Surface;

/// A solid in its own frame, bounded by triangles; it may have holes, cavities and several parts.
///
/// Closed and consistently oriented, or a surface some shells of which are open
/// ([`Self::from_open_mesh`]). Several closed surfaces may overlap: the solid is what any of them
/// encloses. Immutable, `Send` and `Sync`. Vertices and facets keep the numbers of the input.
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
    spans: Vec<Span>,
    reach: f64,
    /// How many vertices and facets the input had.
    input_counts: [u32; 2],
    report: SolidReport,
    shrinking: OnceLock<Shrinking>,
    /// Made when a feature is first named.
    faces: OnceLock<Box<Faces>>,
    groups: Box<Groups>,
    kept: Kept,
}

impl Numbered for Solid {
    fn inputs(&self) -> &[InputVertex] {
        &self.vertex_index
    }

    fn corners_of_face(&self, face: u32) -> Vec<u32> {
        self.face_corners(face)
    }
}

/// What a [`Solid`] can be asked against, and made of.
pub trait AsSolid: Numbered {
    /// The body as a solid: itself, or a convex polyhedron's surface, made when it is first asked for
    /// and kept.
    ///
    /// # Errors
    /// A point or a segment. A flat polygon is a sheet with two sides and no volume.
    fn as_solid(&self) -> Result<&Solid, SolidError>;

    /// Returns the body as [`Self::as_solid`] does, and a point or a segment as one facet without area.
    ///
    /// Casts, distances, motions and scenes accept such a facet. It is an open shell: it has no inside, and
    /// no tolerance shrinks it.
    ///
    /// # Errors
    /// A body whose facets [`Solid::from_mesh`] refuses.
    fn as_surface(&self) -> Result<&Solid, SolidError>;
}

impl AsSolid for Solid {
    fn as_solid(&self) -> Result<&Solid, SolidError> {
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

/// Where a shell is.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Span {
    pub(crate) bounds: Aabb,
    /// One of its triangles.
    pub(crate) triangle: u32,
}

/// How the facets are grouped.
#[derive(Debug, Clone, Default)]
struct Groups {
    /// The first input facet of each piece after the first one.
    piece_starts: Vec<u32>,
    /// Made when a point or a segment lies on one of several shells.
    body_of: OnceLock<Vec<u32>>,
}

impl Groups {
    fn heap_bytes(&self) -> usize {
        let bodies = self.body_of.get().map_or(0, Vec::capacity);
        (self.piece_starts.capacity() + bodies) * size_of::<u32>()
    }
}

impl Solid {
    /// A solid from the polygons of a closed surface (body frame, any unit).
    ///
    /// Polygons run counter-clockwise as seen from outside and are cut into triangles. Vertices with
    /// equal coordinates are one; facets without an area are left out; vertices that lie exactly on
    /// an edge are joined to it. Shells that are inside out as a whole are turned.
    /// [`Self::report`] says what was done.
    ///
    /// # Errors
    /// A surface that is open, or whose facets are oriented against each other; a coordinate that is
    /// not finite or out of range; a polygon that crosses itself; no facets.
    pub fn from_mesh<F: AsRef<[u32]>>(
        vertices: &[DVec3],
        facets: &[F],
    ) -> Result<Self, SolidError> {
        let mut report = SolidReport::default();
        let surface = validate::surface(vertices, facets, false, &mut report)?;
        Ok(Self::assemble(surface, report))
    }

    /// A surface shells of which may be open, as a scan or a sheet is. Closed shells keep their inside.
    /// Open ones ([`ShellKind::Sided`], [`ShellKind::Sheet`]) have no side: their facets block from
    /// both, and so do their rims, edge on. Nothing is inside them, but they overlap what they pass
    /// through. [`Self::report`] says of what kind each shell is.
    ///
    /// # Errors
    /// As [`Self::from_mesh`], except that edges may have a facet on one side only.
    pub fn from_open_mesh<F: AsRef<[u32]>>(
        vertices: &[DVec3],
        facets: &[F],
    ) -> Result<Self, SolidError> {
        let mut report = SolidReport::default();
        let surface = validate::surface(vertices, facets, true, &mut report)?;
        Ok(Self::assemble(surface, report))
    }

    /// The union of several solids or convex polyhedra, which may overlap. The inputs of the pieces are
    /// numbered through, with all that they had ([`Self::input_counts`]), used or not.
    ///
    /// # Errors
    /// No pieces, more facets than 32-bit indices can number, or a point or segment among them.
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
            let shift = |n: u32| if n == edges::NONE { n } else { n + t };
            all.neighbours.extend(piece.neighbours.iter().map(|n| n.map(shift)));
            all.kinds.extend_from_slice(&piece.kinds);
            report.absorb(&piece.report);
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

    /// Builds a surface of one facet without area: a point or a segment, by its corners.
    pub(crate) fn without_area(body: &ConvexPolyhedron, corners: [u32; 3]) -> Self {
        let surface = Surface {
            vertices: body.vertices().to_vec(),
            vertex_index: body.input_indices().to_vec(),
            triangles: vec![corners],
            facet_index: vec![InputFacet(0)],
            neighbours: vec![[edges::NONE; 3]],
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
            turned: false,
            kind: ShellKind::Sheet,
        };
        Self::from_surface(surface, SolidReport { shells: vec![shell], ..SolidReport::default() })
    }

    /// Checks whether a triangle is a point or a segment: two of its corners are one vertex.
    #[doc(hidden)]
    #[inline]
    pub fn is_without_area(&self, triangle: usize) -> bool {
        let [_, b, c] = self.triangles[triangle];
        b == c
    }

    /// The same, made of a body's vertices, which have numbers in that body's input.
    pub(crate) fn renumbered(mut self, inputs: &[InputVertex]) -> Self {
        for v in &mut self.vertex_index {
            *v = inputs[v.index()];
        }
        self.input_counts[0] = inputs.iter().max().map_or(0, |last| last.0.saturating_add(1));
        self
    }

    fn assemble(mut surface: Surface, mut report: SolidReport) -> Self {
        shells::orient(&mut surface, &mut report);
        surface.part_sheets();
        Self::from_surface(surface, report)
    }

    fn from_surface(surface: Surface, report: SolidReport) -> Self {
        let (mut nodes, order) = tree::build(&surface.vertices, &surface.triangles);
        let mut place = vec![0; order.len()];
        for (k, &t) in order.iter().enumerate() {
            place[t as usize] = k as u32;
        }
        let shift = |n: u32| if n == edges::NONE { n } else { place[n as usize] };
        let old = |k: &u32| *k as usize;
        let kinds: Vec<ShellKind> = order.iter().map(|k| surface.kinds[old(k)]).collect();
        tree::open_nodes(&mut nodes, |t| kinds[t] != ShellKind::Closed);
        let reach = surface.vertices.iter().map(|v| v.length()).fold(0.0, f64::max);
        let faces =
            surface.faces.map_or_else(OnceLock::new, |f| Box::new(f.ordered(&order)).into());
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
            input_counts: surface.input_counts,
            report,
            shrinking: OnceLock::new(),
            faces,
            groups: Box::default(),
            kept: Kept::default(),
        };
        solid.spans = solid.find_spans();
        solid
    }

    /// Boxes of the shells, by their connected triangles.
    fn find_spans(&self) -> Vec<Span> {
        let shell_of = shells::components(&self.neighbours);
        let mut spans: Vec<Span> = Vec::new();
        for (t, &shell) in shell_of.iter().enumerate() {
            if shell as usize == spans.len() {
                spans.push(Span { bounds: Aabb::EMPTY, triangle: t as u32 });
            }
            for v in self.triangles[t] {
                spans[shell as usize].bounds.add(self.vertices[v as usize]);
            }
        }
        spans
    }

    /// Whether numbers of vertices, facets and nodes mean the same of another solid. What bounds a node may still
    /// be rounded otherwise.
    #[cfg(feature = "json")]
    #[doc(hidden)]
    #[inline]
    pub fn has_tree_of(&self, other: &Self) -> bool {
        let place = |node: &Node| (node.skip, node.first, node.count);
        self.vertices == other.vertices
            && self.triangles == other.triangles
            && self.kinds == other.kinds
            && self.nodes.iter().map(place).eq(other.nodes.iter().map(place))
    }

    /// The vertices in use, in the body frame.
    pub fn vertices(&self) -> &[DVec3] {
        &self.vertices
    }

    /// For each of [`Self::vertices`], its number in the input.
    pub fn vertex_indices(&self) -> &[InputVertex] {
        &self.vertex_index
    }

    /// How many vertices and facets the input had, used or not; of a convex polyhedron, vertices up to
    /// the last one in use.
    pub fn input_counts(&self) -> [u32; 2] {
        self.input_counts
    }

    /// The triangles, as indices into [`Self::vertices`].
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// For each of [`Self::triangles`], the facet of the input that it is a part of.
    pub fn facet_indices(&self) -> &[InputFacet] {
        &self.facet_index
    }

    /// Whether all shells are closed; if not, the body is a *surface*, at least in part.
    pub fn is_closed(&self) -> bool {
        !self.nodes[0].is_open()
    }

    /// Whether a triangle belongs to an open shell: it has no side.
    #[doc(hidden)]
    #[inline]
    pub fn is_open(&self, triangle: usize) -> bool {
        self.kinds[triangle] != ShellKind::Closed
    }

    /// The same of a shell, in the order of [`Self::spans`].
    fn is_shell_closed(&self, shell: u32) -> bool {
        !self.is_open(self.spans[shell as usize].triangle as usize)
    }

    /// Whether nothing is left of a closed body when it is shrunk by this amount, seen by its box alone:
    /// then every point of it is at most as deep.
    pub(crate) fn vanishes(&self, amount: f64) -> bool {
        amount > 0.0 && 2.0 * amount >= self.thickness() && self.is_closed()
    }

    /// The smallest side of its box.
    pub(crate) fn thickness(&self) -> f64 {
        self.bounds().size().min_element()
    }

    /// Whether some shell is closed, so that there is an inside.
    pub(crate) fn has_inside(&self) -> bool {
        self.report.count(ShellKind::Closed) > 0
    }

    /// Whether a shell can be shrunk.
    #[doc(hidden)]
    #[inline]
    pub fn can_shrink(&self) -> bool {
        self.report.shells.iter().any(|s| s.kind != ShellKind::Sheet)
    }

    /// What was noticed when it was built.
    pub fn report(&self) -> &SolidReport {
        &self.report
    }

    /// The volume of all shells together, in cubic units; overlaps of pieces count twice.
    pub fn volume(&self) -> f64 {
        self.report.shells.iter().map(|s| s.volume).sum()
    }

    /// At least and at most the volume, exactly; `None` with an open shell, which has no volume.
    ///
    /// The sum is that of `6 V = a . (b x c)` over all triangles, from one vertex. Each of the six products
    /// of three differences that make a term is rounded 8 times at most, so a term is off by `10 u` of
    /// their absolute sum, which is rounded itself; each addition by `u` of what comes out. The errors'
    /// sum is rounded too, by far less than a hundredth.
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

    /// Smallest and largest coordinates of all vertices.
    pub fn bounds(&self) -> Aabb {
        self.nodes[0].bounds
    }

    /// What shrinking it by this amount takes; `None` where it stays as it is.
    fn shrinking_by(&self, amount: f64) -> Option<&Shrinking> {
        (amount != 0.0 && self.can_shrink()).then(|| self.shrinking())
    }

    /// A box around the body, shrunk by this amount.
    pub(crate) fn box_shrunk_by(&self, amount: f64) -> Aabb {
        let bounds = self.bounds();
        let shrinking = self.shrinking_by(amount);
        shrinking.map_or(bounds, |shrinking| shrinking.boxed(bounds, amount, 0))
    }

    /// How far shrinking it by this amount moves a vertex, at most.
    pub(crate) fn moved_by(&self, amount: f64) -> f64 {
        self.shrinking_by(amount).map_or(0.0, |shrinking| shrinking.farthest * amount.abs())
    }

    /// Bytes of memory that the solid occupies now, on the heap and in itself: what is made when it is first
    /// asked for (shrunk facets, polygons) counts once it is there.
    pub fn memory_bytes(&self) -> usize {
        size_of::<Self>() + self.heap_bytes()
    }

    /// Bytes on the heap.
    pub(crate) fn heap_bytes(&self) -> usize {
        self.vertices.capacity() * size_of::<DVec3>()
            + self.vertex_index.capacity() * size_of::<u32>()
            + self.triangles.capacity() * size_of::<[u32; 3]>()
            + self.facet_index.capacity() * size_of::<u32>()
            + self.neighbours.capacity() * size_of::<[u32; 3]>()
            + self.kinds.capacity()
            + self.nodes.capacity() * size_of::<Node>()
            + self.spans.capacity() * size_of::<Span>()
            + self.report.shells.capacity() * size_of::<Shell>()
            + self.shrinking.get().map_or(0, Shrinking::heap_bytes)
            + self.faces.get().map_or(0, |faces| size_of::<Faces>() + faces.heap_bytes())
            + size_of::<Groups>()
            + self.groups.heap_bytes()
            + self.kept.heap_bytes()
    }

    /// What a query keeps with the body.
    pub(crate) fn kept(&self) -> &Kept {
        &self.kept
    }

    /// The largest distance of a vertex from the origin of the body frame.
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

    pub(crate) fn spans(&self) -> &[Span] {
        &self.spans
    }

    /// Returns [`Self::bodies`], which are computed once.
    pub(crate) fn body_map(&self) -> &[u32] {
        self.groups.body_of.get_or_init(|| self.bodies())
    }

    /// Returns the number of the piece that a triangle is of.
    fn piece_of(&self, triangle: usize) -> usize {
        let facet = self.facet_index[triangle].0;
        self.groups.piece_starts.partition_point(|start| *start <= facet)
    }
}

impl Solid {
    /// This body and a motion, for a cast of bodies that turn.
    pub fn along<'a>(&'a self, motion: &'a Motion) -> Moving<'a, Self> {
        Moving { body: self, motion: Cow::Borrowed(motion) }
    }
}

#[doc(hidden)]
impl Hull for Solid {
    fn corners(&self) -> &[DVec3] {
        self.vertices()
    }

    fn reach(&self) -> f64 {
        Self::reach(self)
    }
}
