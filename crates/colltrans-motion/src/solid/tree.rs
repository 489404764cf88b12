//! A solid as a search through time sees it: shrunk, with boxes down to each facet.
//!
//! The tree is the solid's own ([`tree`](colltrans_solid::body::tree)), its leaves of a few facets halved down to
//! one. Boxes hold the vertices as they are shrunk, exactly but for the roundings of middle and extent, by which
//! extents are larger.

use std::borrow::Cow;

use glam::DVec3;

use colltrans_convex::body::{Aabb, Hull};
use colltrans_solid::body::{Solid, displace};

/// Extents are larger by this share of them and of the middle.
const ROUNDED: f64 = 4.0 * f64::EPSILON;

/// A solid, shrunk.
#[derive(Debug, Clone)]
pub(crate) struct Tree<'a> {
    pub(super) solid: &'a Solid,
    vertices: Cow<'a, [DVec3]>,
    reach: f64,
    nodes: Vec<Node>,
}

/// A box in the body's frame around some facets.
#[derive(Debug, Clone, Copy)]
pub(super) struct Node {
    pub(super) middle: DVec3,
    pub(super) half: DVec3,
    pub(super) below: Below,
}

/// What a node holds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Below {
    /// Two nodes, the first of them at this place.
    Nodes(u32),
    /// One facet, by its position in [`Solid::triangles`].
    Facet(u32),
}

/// A facet as a convex body.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Facet {
    pub(super) corners: [DVec3; 3],
    reach: f64,
}

impl Facet {
    pub(super) fn new(corners: [DVec3; 3]) -> Self {
        let square = corners.iter().map(|v| v.length_squared()).fold(0.0, f64::max);
        Self { corners, reach: square.sqrt().next_up() }
    }
}

impl Hull for Facet {
    #[inline]
    fn corners(&self) -> &[DVec3] {
        &self.corners
    }

    #[inline]
    fn reach(&self) -> f64 {
        self.reach
    }
}

impl Hull for Tree<'_> {
    fn corners(&self) -> &[DVec3] {
        &self.vertices
    }

    fn reach(&self) -> f64 {
        self.reach
    }
}

impl<'a> Tree<'a> {
    /// Of a solid that is shrunk by so much.
    pub(super) fn new(solid: &'a Solid, amount: f64) -> Self {
        let vertices = if amount == 0.0 || !solid.has_offset() {
            Cow::Borrowed(solid.vertices())
        } else {
            let field = &solid.shrinking().field;
            let moved = solid.vertices().iter().zip(field).map(|(v, x)| displace(*v, *x, amount));
            Cow::Owned(moved.collect())
        };
        let reach = vertices.iter().map(|v| v.length()).fold(0.0, f64::max).next_up();
        let mut tree = Self { solid, vertices, reach, nodes: Vec::new() };
        tree.nodes = tree.grown();
        tree
    }

    pub(super) fn node(&self, at: u32) -> &Node {
        &self.nodes[at as usize]
    }

    /// All nodes in preorder: the facet that one is, or -1 of one that has parts.
    #[cfg(feature = "json")]
    fn preorder(&self) -> Vec<i64> {
        let (mut all, mut open) = (Vec::with_capacity(self.nodes.len()), vec![0]);
        while let Some(at) = open.pop() {
            match self.node(at).below {
                Below::Facet(triangle) => all.push(i64::from(triangle)),
                Below::Nodes(first) => {
                    all.push(-1);
                    open.extend([first + 1, first]);
                }
            }
        }
        all
    }

    pub(super) fn facet(&self, triangle: u32) -> Facet {
        let corners = self.solid.triangles()[triangle as usize].map(|v| self.vertices[v as usize]);
        Facet::new(corners)
    }

    fn grown(&self) -> Vec<Node> {
        let own = self.solid.nodes();
        let empty = Node { middle: DVec3::ZERO, half: DVec3::ZERO, below: Below::Nodes(0) };
        let mut nodes = vec![empty];
        // Nodes to be filled, with a node of the solid or some of its facets.
        let mut open = vec![(0, Part::Node(0))];
        while let Some((at, part)) = open.pop() {
            let parts = match part {
                Part::Node(k) if own[k].is_leaf() => Part::facets(own[k].facets()),
                Part::Node(k) => {
                    let first = k + own[k].skip as usize;
                    Some([Part::Node(first), Part::Node(first + 1)])
                }
                Part::Facets(first, end) => Part::facets(first..end),
            };
            let Some(parts) = parts else {
                nodes[at].below = Below::Facet(part.first(own) as u32);
                continue;
            };
            let first = nodes.len();
            nodes[at].below = Below::Nodes(first as u32);
            nodes.extend([empty; 2]);
            open.extend([(first, parts[0]), (first + 1, parts[1])]);
        }
        // Children stand behind their parents.
        let mut boxes = vec![Aabb::EMPTY; nodes.len()];
        for at in (0..nodes.len()).rev() {
            boxes[at] = match nodes[at].below {
                Below::Facet(triangle) => Aabb::of_points(self.facet(triangle).corners),
                Below::Nodes(first) => boxes[first as usize].join(&boxes[first as usize + 1]),
            };
            let Aabb { low, high } = boxes[at];
            let middle = low + (high - low) * 0.5;
            let half = (high - middle).max(middle - low);
            (nodes[at].middle, nodes[at].half) = (middle, half + (half + middle.abs()) * ROUNDED);
        }
        nodes
    }
}

/// What is to become of a node.
#[derive(Clone, Copy)]
enum Part {
    /// A node of the solid.
    Node(usize),
    /// Facets from one to before another.
    Facets(usize, usize),
}

impl Part {
    /// Both halves of some facets, unless it is one.
    fn facets(range: std::ops::Range<usize>) -> Option<[Self; 2]> {
        let middle = range.start + range.len() / 2;
        let halves = [Self::Facets(range.start, middle), Self::Facets(middle, range.end)];
        (range.len() > 1).then_some(halves)
    }

    fn first(self, own: &[colltrans_solid::body::tree::Node]) -> usize {
        match self {
            Self::Node(k) => own[k].facets().start,
            Self::Facets(first, _) => first,
        }
    }
}

/// The facets of a solid as the tolerance leaves them, in the order in which a proof counts them, and how it splits them.
#[cfg(feature = "json")]
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Parts {
    /// The number of each in the file.
    numbers: Vec<colltrans_convex::body::InputFacet>,
    corners: Vec<[[f64; 3]; 3]>,
    /// The nodes in preorder: the facet that one is, or -1 of one that has two parts.
    tree: Vec<i64>,
}

#[cfg(feature = "json")]
impl Parts {
    pub(super) fn of(tree: &Tree) -> Self {
        let numbers = tree.solid.facet_indices().to_vec();
        let count = tree.solid.triangles().len() as u32;
        let corners = (0..count).map(|at| tree.facet(at).corners.map(|v| v.to_array()));
        Self { numbers, corners: corners.collect(), tree: tree.preorder() }
    }
}
