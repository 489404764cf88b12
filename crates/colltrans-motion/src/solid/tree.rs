//! A shrunk solid with a binary tree of boxes down to single facets.
//!
//! The tree is that of the solid ([`tree`](colltrans_solid::body::tree)). Its leaves, which hold a few facets, are
//! halved down to one facet. Boxes contain the shrunk vertices exactly, because the rounding errors of middle and half
//! extents are added to the half extents.
//!
//! A node is computed when a search first needs it, from vertices that the solid stores for all amounts
//! ([`Solid::exact_offset_box`]). Therefore a query computes no more nodes than it visits, unless the amount is so large
//! that the stored vertices do not determine a box. The box is then that of both children.
//!
//! Nodes are numbered like those of the solid, followed by one number for each facet, and by one for each pair of
//! facets, that of its first facet.

use std::cell::{OnceCell, RefCell};
use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};

use glam::DVec3;

use colltrans_convex::body::{Aabb, VertexHull};
use colltrans_solid::body::{Solid, offset_vertex};
use colltrans_solid::solve::hulls::Surface;

/// Relative error of middle and half extents, which is added to the half extents.
const EXTENT_ERROR: f64 = 4.0 * f64::EPSILON;

/// A shrunk solid and its tree.
#[derive(Debug, Clone)]
pub(crate) struct SolidTree<'a> {
    pub(super) solid: &'a Solid,
    /// Amount by which the solid is shrunk, and the displacements of its vertices for an amount of 1. Without them,
    /// the solid is not shrunk.
    amount: f64,
    displacements: Option<&'a [DVec3]>,
    reach: f64,
    known: RefCell<KnownNodes>,
    /// All vertices, computed on first use.
    vertices: OnceCell<Vec<DVec3>>,
}

/// The nodes that have been computed, by their indices.
type KnownNodes = HashMap<u32, (Aabb, BoxNode), BuildHasherDefault<IndexHasher>>;

/// Hashes one index by a product whose upper bits depend on all bits of the index.
#[derive(Debug, Clone, Copy, Default)]
struct IndexHasher(u64);

impl Hasher for IndexHasher {
    fn write(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.write_u32(u32::from(*byte));
        }
    }

    fn write_u32(&mut self, index: u32) {
        let product = (self.0 ^ u64::from(index)).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        self.0 = product ^ (product >> 32);
    }

    fn finish(&self) -> u64 {
        self.0
    }
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
    /// The indices of two children.
    Children([u32; 2]),
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
        Self { corners, reach: reach_of(&corners), radius }
    }
}

/// Returns an upper bound of the distances of points from the origin.
fn reach_of(points: &[DVec3]) -> f64 {
    points.iter().map(|v| v.length_squared()).fold(0.0, f64::max).sqrt().next_up()
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
        self.vertices.get_or_init(|| {
            (0..self.solid.vertices().len() as u32).map(|v| self.vertex(v)).collect()
        })
    }

    fn vertex_count(&self) -> usize {
        self.solid.vertices().len()
    }

    fn reach(&self) -> f64 {
        self.reach
    }

    fn radius(&self) -> f64 {
        self.solid.radius()
    }
}

/// All vertices of some facets of a shrunk solid, as a convex body, rounded like the solid.
pub(super) struct PartHull {
    vertices: Vec<DVec3>,
    reach: f64,
    radius: f64,
}

impl VertexHull for PartHull {
    fn hull_vertices(&self) -> &[DVec3] {
        &self.vertices
    }

    fn reach(&self) -> f64 {
        self.reach
    }

    fn radius(&self) -> f64 {
        self.radius
    }
}

impl<'a> SolidTree<'a> {
    /// Builds the tree of a solid, shrunk by `amount` in world units.
    pub(super) fn new(solid: &'a Solid, amount: f64) -> Self {
        let is_shrunk = amount != 0.0 && solid.has_offset();
        let displacements = is_shrunk.then(|| &solid.offset_field().displacements[..]);
        let reach = solid.offset_reach(amount).next_up();
        let known = RefCell::default();
        Self { solid, amount, displacements, reach, known, vertices: OnceCell::new() }
    }

    /// Returns a node by its index. The root has index 0.
    pub(super) fn node(&self, at: u32) -> BoxNode {
        self.box_and_node(at).1
    }

    /// Returns all nodes in preorder: the index of the facet for a leaf, -1 for an inner node.
    #[cfg(feature = "json")]
    fn preorder(&self) -> Vec<i64> {
        let (mut all, mut open) = (Vec::new(), vec![0]);
        while let Some(at) = open.pop() {
            match self.content(at) {
                NodeContent::Facet(triangle) => all.push(i64::from(triangle)),
                NodeContent::Children([first, second]) => {
                    all.push(-1);
                    open.extend([second, first]);
                }
            }
        }
        all
    }

    /// Returns a facet by its index, shrunk.
    pub(super) fn facet(&self, triangle: u32) -> Facet {
        let corners = self.solid.triangles()[triangle as usize].map(|v| self.vertex(v));
        Facet::new(corners, self.solid.radius())
    }

    /// Returns the vertices of all facets below a node, shrunk.
    pub(super) fn part_hull(&self, at: u32) -> PartHull {
        let (mut numbers, mut open) = (Vec::new(), vec![at]);
        while let Some(at) = open.pop() {
            match self.content(at) {
                NodeContent::Facet(triangle) => {
                    numbers.extend(self.solid.triangles()[triangle as usize]);
                }
                NodeContent::Children(children) => open.extend(children),
            }
        }
        numbers.sort_unstable();
        numbers.dedup();
        let vertices: Vec<DVec3> = numbers.into_iter().map(|v| self.vertex(v)).collect();
        let reach = reach_of(&vertices);
        PartHull { vertices, reach, radius: self.solid.radius() }
    }

    /// Returns the amount by which the solid is shrunk.
    pub(super) fn amount(&self) -> f64 {
        self.amount
    }

    /// Returns an upper bound of the displacement of a vertex.
    pub(super) fn max_displacement(&self) -> f64 {
        self.solid.max_offset_displacement(self.amount)
    }

    /// Returns the surface of the solid with its hull; `None` if the solid is not convex.
    pub(super) fn surface(&self) -> Option<Surface<'a>> {
        Surface::of_convex(self.solid)
    }

    /// Returns a vertex, shrunk.
    #[inline]
    fn vertex(&self, vertex: u32) -> DVec3 {
        let at = self.solid.vertices()[vertex as usize];
        let by = self.displacements.map(|all| all[vertex as usize]);
        by.map_or(at, |by| offset_vertex(at, by, self.amount))
    }

    /// Returns the exact box of a node, and the node.
    fn box_and_node(&self, at: u32) -> (Aabb, BoxNode) {
        if let Some(known) = self.known.borrow().get(&at) {
            return *known;
        }
        let content = self.content(at);
        let is_stored = (at as usize) < self.solid.nodes().len();
        let stored = is_stored.then(|| self.solid.exact_offset_box(at as usize, self.amount));
        let bounds = match (stored.flatten(), content) {
            (Some(bounds), _) => bounds,
            (None, NodeContent::Facet(triangle)) => Aabb::from_points(self.facet(triangle).corners),
            (None, NodeContent::Children([first, second])) => {
                self.box_and_node(first).0.union(&self.box_and_node(second).0)
            }
        };
        let Aabb { low, high } = bounds;
        let middle = low + (high - low) * 0.5;
        let half = (high - middle).max(middle - low);
        let half = half + (half + middle.abs()) * EXTENT_ERROR;
        let computed = (bounds, BoxNode { middle, half, content });
        self.known.borrow_mut().insert(at, computed);
        computed
    }

    /// Returns the children of a node, or its facet.
    fn content(&self, at: u32) -> NodeContent {
        let own = self.solid.nodes();
        let (count, facets) = (own.len() as u32, self.solid.triangles().len() as u32);
        if let Some(node) = own.get(at as usize) {
            if !node.is_leaf() {
                let first = at + node.child_offset;
                return NodeContent::Children([first, first + 1]);
            }
            return self.range_content(node.first_facet, node.facet_count);
        }
        let below = at - count;
        if below < facets {
            self.range_content(below, 1)
        } else {
            self.range_content(below - facets, 2)
        }
    }

    /// Returns the content of a node with consecutive facets.
    fn range_content(&self, first: u32, facet_count: u32) -> NodeContent {
        if facet_count == 1 {
            return NodeContent::Facet(first);
        }
        let (nodes, facets) =
            (self.solid.nodes().len() as u32, self.solid.triangles().len() as u32);
        let part = |first: u32, count: u32| nodes + first + if count == 2 { facets } else { 0 };
        let half = facet_count / 2;
        NodeContent::Children([part(first, half), part(first + half, facet_count - half)])
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

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::super::search_span;
    use super::*;
    use crate::answer::MotionSteps;
    use crate::solid::search::SearchMode;
    use crate::span::split_into_spans;
    use crate::{Motion, MotionCast};
    use colltrans_convex::body::Pose;

    /// Builds a torus with waves, or with flat sides and corners if `side` is a multiple of four and `waves` is 0.
    fn torus(side: u32, waves: f64) -> Solid {
        let at = |k: u32| TAU * f64::from(k) / f64::from(side);
        let corner = |k: u32| {
            let (u, v) = (at(k / side), at(k % side));
            let wave = waves * (7.0 * u + 5.0 * v).sin() * (3.0 * v).cos();
            let square = |x: f64| if waves == 0.0 { x.clamp(-0.6, 0.6) } else { x };
            let r = 3.0 + square(v.cos()) * (1.0 + wave);
            DVec3::new(r * u.cos(), r * u.sin(), square(v.sin()) * (1.0 + wave))
        };
        let vertices: Vec<DVec3> = (0..side * side).map(corner).collect();
        let next = |k: u32| if (k + 1).is_multiple_of(side) { k + 1 - side } else { k + 1 };
        let over = |k: u32| (k + side) % (side * side);
        let facets: Vec<[u32; 3]> = (0..side * side)
            .flat_map(|k| [[k, over(k), next(k)], [over(k), over(next(k)), next(k)]])
            .collect();
        Solid::from_mesh(&vertices, &facets).expect("a solid")
    }

    /// Returns the box of all facets below a node, by a pass over them, after comparing the boxes of all nodes below.
    fn check_boxes(tree: &SolidTree, at: u32, count: &mut usize) -> Aabb {
        let expected = match tree.content(at) {
            NodeContent::Facet(triangle) => Aabb::from_points(tree.facet(triangle).corners),
            NodeContent::Children(children) => {
                let [first, second] = children.map(|child| check_boxes(tree, child, count));
                first.union(&second)
            }
        };
        *count += 1;
        assert_eq!(tree.box_and_node(at).0, expected, "node {at}");
        expected
    }

    #[test]
    fn boxes_equal_those_of_all_facets() {
        for solid in [torus(40, 0.0), torus(33, 0.15), torus(8, 0.3)] {
            for amount in [0.0, 1e-300, 1e-14, 1e-9, 1e-5, 1e-3, 0.03, 0.4, 5.0] {
                let tree = SolidTree::new(&solid, amount);
                // From the root down, so that no box is computed from those of its children that are known.
                let (mut open, mut all) = (vec![0], Vec::new());
                while let Some(at) = open.pop() {
                    all.push((at, tree.box_and_node(at).0));
                    if let NodeContent::Children(children) = tree.content(at) {
                        open.extend(children);
                    }
                }
                let mut count = 0;
                check_boxes(&tree, 0, &mut count);
                assert_eq!((count, all.len()), (2 * solid.triangles().len() - 1, count));
                let far = tree.hull_vertices().iter().map(|v| v.length()).fold(0.0, f64::max);
                assert_eq!(tree.reach(), far.next_up());
            }
        }
    }

    #[test]
    fn search_computes_a_small_part_of_the_nodes() {
        let solid = torus(192, 0.1);
        let start = Pose::from_translation(DVec3::new(1.0, 9.5, 0.5)).expect("a pose");
        let swing = Motion::rotation_about(start, DVec3::new(9.0, 9.0, 0.0), DVec3::Z, 1.5);
        let (swing, rest) = (swing.expect("a motion"), Motion::at_rest(Pose::IDENTITY));
        let cast = MotionCast::between_any(solid.with_motion(&swing), solid.with_motion(&rest));
        let cast = cast.expect("a cast");
        for tolerance in [0.0, 1e-11, 1e-6] {
            let trees = cast.shrunk_trees(tolerance);
            let spans = split_into_spans(trees.each_ref(), cast.motions(), 0.0);
            let mut steps = MotionSteps::default();
            let (found, _) = search_span(&spans[0], SearchMode::FirstContact, &mut steps);
            assert!(found.is_some());
            let known: usize = trees.map(|tree| tree.known.into_inner().len()).iter().sum();
            // Both trees have four nodes for each facet of one body. Where vertices tie, boxes need their children.
            let all = 4 * solid.triangles().len();
            assert!(known < all / 8, "{tolerance}: {known} of {all} nodes, {} visits", steps.nodes);
        }
    }
}
