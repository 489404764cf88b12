//! A shrunk solid with a binary tree of boxes down to single facets.
//!
//! The tree is that of the solid ([`tree`](colltrans_solid::body::tree)). Its leaves, which hold a few facets, are
//! halved down to one facet. Boxes contain the shrunk vertices exactly, because the rounding errors of middle and half
//! extents are added to the half extents.

use std::borrow::Cow;

use glam::DVec3;

use colltrans_convex::body::{Aabb, VertexHull};
use colltrans_solid::body::{Solid, offset_vertex};

/// Relative error of middle and half extents, which is added to the half extents.
const EXTENT_ERROR: f64 = 4.0 * f64::EPSILON;

/// A shrunk solid and its tree.
#[derive(Debug, Clone)]
pub(crate) struct SolidTree<'a> {
    pub(super) solid: &'a Solid,
    vertices: Cow<'a, [DVec3]>,
    reach: f64,
    nodes: Vec<BoxNode>,
}

/// A box around some facets, in the frame of the body.
#[derive(Debug, Clone, Copy)]
pub(super) struct BoxNode {
    pub(super) middle: DVec3,
    pub(super) half: DVec3,
    pub(super) content: NodeContent,
}

/// Content of a node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum NodeContent {
    /// Two children; the index of the first.
    Children(u32),
    /// One facet, by its index in [`Solid::triangles`].
    Facet(u32),
}

/// A facet as a convex body, rounded like its solid.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Facet {
    pub(super) corners: [DVec3; 3],
    reach: f64,
    radius: f64,
}

impl Facet {
    /// Builds a facet from its corners and the radius of its solid.
    pub(super) fn new(corners: [DVec3; 3], radius: f64) -> Self {
        let square = corners.iter().map(|v| v.length_squared()).fold(0.0, f64::max);
        Self { corners, reach: square.sqrt().next_up(), radius }
    }
}

impl VertexHull for Facet {
    #[inline]
    fn hull_vertices(&self) -> &[DVec3] {
        &self.corners
    }

    #[inline]
    fn reach(&self) -> f64 {
        self.reach
    }

    #[inline]
    fn radius(&self) -> f64 {
        self.radius
    }
}

impl VertexHull for SolidTree<'_> {
    fn hull_vertices(&self) -> &[DVec3] {
        &self.vertices
    }

    fn reach(&self) -> f64 {
        self.reach
    }

    fn radius(&self) -> f64 {
        self.solid.radius()
    }
}

impl<'a> SolidTree<'a> {
    /// Builds the tree of a solid, shrunk by `amount` in world units.
    pub(super) fn new(solid: &'a Solid, amount: f64) -> Self {
        let vertices = if amount == 0.0 || !solid.has_offset() {
            Cow::Borrowed(solid.vertices())
        } else {
            let field = &solid.offset_field().displacements;
            let moved =
                solid.vertices().iter().zip(field).map(|(v, x)| offset_vertex(*v, *x, amount));
            Cow::Owned(moved.collect())
        };
        let reach = vertices.iter().map(|v| v.length()).fold(0.0, f64::max).next_up();
        let mut tree = Self { solid, vertices, reach, nodes: Vec::new() };
        tree.nodes = tree.build_nodes();
        tree
    }

    /// Returns a node by its index.
    pub(super) fn node(&self, at: u32) -> &BoxNode {
        &self.nodes[at as usize]
    }

    /// Returns all nodes in preorder: the index of the facet for a leaf, -1 for an inner node.
    #[cfg(feature = "json")]
    fn preorder(&self) -> Vec<i64> {
        let (mut all, mut open) = (Vec::with_capacity(self.nodes.len()), vec![0]);
        while let Some(at) = open.pop() {
            match self.node(at).content {
                NodeContent::Facet(triangle) => all.push(i64::from(triangle)),
                NodeContent::Children(first) => {
                    all.push(-1);
                    open.extend([first + 1, first]);
                }
            }
        }
        all
    }

    /// Returns a facet by its index, shrunk.
    pub(super) fn facet(&self, triangle: u32) -> Facet {
        let corners = self.solid.triangles()[triangle as usize].map(|v| self.vertices[v as usize]);
        Facet::new(corners, self.solid.radius())
    }

    /// Builds the nodes and their boxes.
    fn build_nodes(&self) -> Vec<BoxNode> {
        let own = self.solid.nodes();
        let empty =
            BoxNode { middle: DVec3::ZERO, half: DVec3::ZERO, content: NodeContent::Children(0) };
        let mut nodes = vec![empty];
        // Nodes that have no content yet, with the node of the solid or the facets that they are built from.
        let mut open = vec![(0, NodeSource::Node(0))];
        while let Some((at, part)) = open.pop() {
            let parts = match part {
                NodeSource::Node(k) if own[k].is_leaf() => NodeSource::split_range(own[k].facets()),
                NodeSource::Node(k) => {
                    let first = k + own[k].child_offset as usize;
                    Some([NodeSource::Node(first), NodeSource::Node(first + 1)])
                }
                NodeSource::Facets(first, end) => NodeSource::split_range(first..end),
            };
            let Some(parts) = parts else {
                nodes[at].content = NodeContent::Facet(part.first_facet(own) as u32);
                continue;
            };
            let first = nodes.len();
            nodes[at].content = NodeContent::Children(first as u32);
            nodes.extend([empty; 2]);
            open.extend([(first, parts[0]), (first + 1, parts[1])]);
        }
        // Children have larger indices than their parents.
        let mut boxes = vec![Aabb::EMPTY; nodes.len()];
        for at in (0..nodes.len()).rev() {
            boxes[at] = match nodes[at].content {
                NodeContent::Facet(triangle) => Aabb::from_points(self.facet(triangle).corners),
                NodeContent::Children(first) => {
                    boxes[first as usize].union(&boxes[first as usize + 1])
                }
            };
            let Aabb { low, high } = boxes[at];
            let middle = low + (high - low) * 0.5;
            let half = (high - middle).max(middle - low);
            (nodes[at].middle, nodes[at].half) =
                (middle, half + (half + middle.abs()) * EXTENT_ERROR);
        }
        nodes
    }
}

/// Source from which a node is built.
#[derive(Clone, Copy)]
enum NodeSource {
    /// A node of the solid.
    Node(usize),
    /// Facets from the first index to before the second.
    Facets(usize, usize),
}

impl NodeSource {
    /// Returns both halves of a range of facets. Returns `None` for a single facet.
    fn split_range(range: std::ops::Range<usize>) -> Option<[Self; 2]> {
        let middle = range.start + range.len() / 2;
        let halves = [Self::Facets(range.start, middle), Self::Facets(middle, range.end)];
        (range.len() > 1).then_some(halves)
    }

    /// Returns the index of the first facet.
    fn first_facet(self, own: &[colltrans_solid::body::tree::Node]) -> usize {
        match self {
            Self::Node(k) => own[k].facets().start,
            Self::Facets(first, _) => first,
        }
    }
}

/// The facets of a solid, shrunk by half of the tolerance, in the order of a proof, and the tree by which the proof
/// splits them.
#[cfg(feature = "json")]
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ProofFacets {
    /// Number of each facet in the input file.
    numbers: Vec<colltrans_convex::body::InputFacet>,
    corners: Vec<[[f64; 3]; 3]>,
    /// Nodes in preorder: the index of the facet for a leaf, -1 for an inner node.
    tree: Vec<i64>,
}

#[cfg(feature = "json")]
impl ProofFacets {
    pub(super) fn from_tree(tree: &SolidTree) -> Self {
        let numbers = tree.solid.facet_indices().to_vec();
        let count = tree.solid.triangles().len() as u32;
        let corners = (0..count).map(|at| tree.facet(at).corners.map(|v| v.to_array()));
        Self { numbers, corners: corners.collect(), tree: tree.preorder() }
    }
}
