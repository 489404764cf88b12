//! A binary tree of boxes over the facets of a solid, in the body frame.
//!
//! A node covers consecutive facets and stores:
//! - an exact bounding box, with [cut corners and edges](super::cuts)
//! - an axis `n` (the mean unit normal), with an upper bound on the sine of the largest angle to a normal of a facet.
//!   It is exactly 0 for facets whose computed normals are exact and equal.
//! - the slab `low <= n . x <= high` of all vertices. It is rounded, and users of the slab account for the error.
//!
//! The tree is built from the top ([`split`](mod@colltrans_kernel::split)). The children of node `i` are adjacent, at
//! `i + child_offset` and `i + child_offset + 1`, because a search reads both. The nodes below the first child follow,
//! then those below the second. `child_offset` is relative, so that threads build subtrees that are joined end to end.
//! The tree does not depend on the number of threads.

use std::thread;

use glam::{BVec3, DVec3, Vec3Swizzles};

use super::cuts::{CUTS, SignMaxima};
use colltrans_convex::body::Aabb;
use colltrans_kernel::descent::{node_to_split, pair_with_node};
use colltrans_kernel::split::{Boxed, SplitRule, split_items_within};

/// Maximum number of facets of a leaf.
pub(crate) const MAX_LEAF_FACETS: usize = 4;
/// Minimum number of facets of each of two subtrees that are built on two threads.
const MIN_THREAD_FACETS: usize = 1 << 14;
/// Sine that represents an unbounded angle.
pub const ANY_ANGLE: f64 = 2.0;
/// Sine that represents facets of open shells, which have no orientation.
pub(crate) const OPEN_SPREAD: f32 = f32::INFINITY;

/// Bounds of consecutive facets.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Node {
    pub bounds: Aabb,
    pub(crate) axis: DVec3,
    pub(crate) slab: [f64; 2],
    /// Upper bound on the sine of the largest angle between `axis` and the normal of a facet. It is [`ANY_ANGLE`] from
    /// a right angle, and [`OPEN_SPREAD`] if a facet belongs to an open shell.
    pub spread: f32,
    /// Offset to the first child; 0 for a leaf.
    pub child_offset: u32,
    /// Position of the first facet.
    pub first_facet: u32,
    /// Number of facets.
    pub facet_count: u32,
    /// Depths of the facets below the corners and edges of the box.
    pub(crate) cuts: [u8; CUTS],
    /// Bits of the sides of the box, the lower ones first, in which a facet may lie that faces the inside of the box.
    pub(crate) inward_sides: u8,
}

/// Bits of all six sides.
const ALL_SIDES: u8 = 0b11_1111;

impl Node {
    #[inline]
    pub fn is_leaf(&self) -> bool {
        self.child_offset == 0
    }

    /// Checks whether the node contains facets of open shells.
    pub(crate) fn is_open(&self) -> bool {
        self.spread == OPEN_SPREAD
    }

    /// Returns the positions of the children of this node, which is at position `at`.
    #[inline]
    pub(crate) fn child_positions(&self, at: u32) -> [u32; 2] {
        [at + self.child_offset, at + self.child_offset + 1]
    }

    /// Returns the squared diagonal of the box.
    #[inline]
    pub(crate) fn squared_diagonal(&self) -> f64 {
        self.bounds.side_lengths().length_squared()
    }

    /// Returns the inward sides among those in which the box touches the sides of an enclosing box.
    fn inward_sides_within(&self, outer: &Aabb) -> u8 {
        let Aabb { low, high } = self.bounds;
        let shared = low.cmpeq(outer.low).bitmask() | high.cmpeq(outer.high).bitmask() << 3;
        self.inward_sides & shared as u8
    }

    #[inline]
    pub fn facets(&self) -> std::ops::Range<usize> {
        self.first_facet as usize..(self.first_facet + self.facet_count) as usize
    }
}

/// Splits a pair of nodes of two trees into two pairs; returns `None` for two leaves.
#[inline]
pub(crate) fn split_pair(trees: [&[Node]; 2], pair: [u32; 2]) -> Option<[[u32; 2]; 2]> {
    let nodes = [0, 1].map(|k| &trees[k][pair[k] as usize]);
    let which = node_to_split(nodes.map(Node::is_leaf), |k| nodes[k].squared_diagonal())?;
    Some(nodes[which].child_positions(pair[which]).map(|child| pair_with_node(pair, which, child)))
}

/// Data of one facet for the builder.
#[derive(Clone, Copy)]
struct Item {
    facet: u32,
    bounds: Aabb,
    /// Unit normal; zero for a facet without area.
    normal: DVec3,
    /// Twice the area.
    area: f64,
    /// Upper bound on the sine of the angle by which rounding turns the normal.
    doubt: f64,
}

impl Item {
    fn new(facet: u32, corners: [DVec3; 3]) -> Self {
        let (normal, doubt) = area_vector(corners);
        let area = normal.length();
        let normal = if area > 0.0 { normal / area } else { DVec3::ZERO };
        Self { facet, bounds: Aabb::from_points(corners), normal, area, doubt }
    }

    /// Returns the sides of an enclosing box in which the facet lies, as bits, without sides where it certainly faces
    /// out of the box.
    fn inward_sides(&self, bounds: &Aabb) -> u8 {
        let Aabb { low, high } = self.bounds;
        let flat = low.cmpeq(high);
        let away = |way: f64| {
            let outward = (self.normal * way).cmpgt(DVec3::ZERO);
            if self.doubt < 1.0 { outward } else { BVec3::FALSE }
        };
        let lower = flat & low.cmpeq(bounds.low) & !away(-1.0);
        let upper = flat & high.cmpeq(bounds.high) & !away(1.0);
        (lower.bitmask() | upper.bitmask() << 3) as u8
    }
}

impl Boxed for Item {
    #[inline]
    fn bounds(&self) -> &Aabb {
        &self.bounds
    }

    #[inline]
    fn number(&self) -> u32 {
        self.facet
    }
}

/// Returns the area vector of a triangle (twice the area times the unit normal), and an upper bound on the sine of
/// the angle by which rounding turns this vector.
///
/// The bound is 0 for facets in planes of the axes, and [`ANY_ANGLE`] if the error may be as large as the vector.
/// Derivation: `docs/theory/solid-bounds.md`.
#[inline]
pub fn area_vector([a, b, c]: [DVec3; 3]) -> (DVec3, f64) {
    let (u, v) = (b - a, c - a);
    let area = u.cross(v);
    let (x, y) = (u.abs(), v.abs());
    let terms = DVec3::new(x.y * y.z + x.z * y.y, x.z * y.x + x.x * y.z, x.x * y.y + x.y * y.x);
    let error = terms * (4.0 * f64::EPSILON);
    let length = area.length_squared();
    if length <= error.length_squared() {
        return (area, ANY_ANGLE);
    }
    let size = area.abs();
    // `|error x area|` for the worst signs.
    let across = DVec3::new(
        error.y * size.z + error.z * size.y,
        error.z * size.x + error.x * size.z,
        error.x * size.y + error.y * size.x,
    );
    (area, (across.length() / length).min(ANY_ANGLE))
}

/// Builds the tree. Returns its nodes, and the order in which they list the facets.
pub(super) fn build_tree(vertices: &[DVec3], triangles: &[[u32; 3]]) -> (Vec<Node>, Vec<u32>) {
    // The number of processors is read from files. That takes longer than a small tree.
    let is_large = triangles.len() >= 2 * MIN_THREAD_FACETS;
    let threads = if is_large { thread::available_parallelism().map_or(1, usize::from) } else { 1 };
    build_tree_on(threads, vertices, triangles)
}

fn build_tree_on(
    threads: usize,
    vertices: &[DVec3],
    triangles: &[[u32; 3]],
) -> (Vec<Node>, Vec<u32>) {
    let corners = |t: &[u32; 3]| t.map(|v| vertices[v as usize]);
    let mut items: Vec<Item> = triangles
        .iter()
        .enumerate()
        .map(|(facet, t)| Item::new(facet as u32, corners(t)))
        .collect();
    let builder = Builder { vertices, triangles };
    let mut nodes = Vec::with_capacity(items.len());
    let (root, centers) = builder.oriented_node(&items, 0);
    nodes.push(root);
    builder.build_subtree(&mut items, 0, &centers, threads, &mut nodes);
    nodes.shrink_to_fit();
    (nodes, items.iter().map(|i| i.facet).collect())
}

/// Marks the nodes with facets of open shells, because the orientation of these facets has no meaning.
pub(super) fn mark_open_nodes(nodes: &mut [Node], is_open: impl Fn(usize) -> bool) {
    for at in (0..nodes.len()).rev() {
        let node = &nodes[at];
        let open = if node.is_leaf() {
            node.facets().any(&is_open)
        } else {
            let first = at + node.child_offset as usize;
            nodes[first].is_open() || nodes[first + 1].is_open()
        };
        if open {
            nodes[at].spread = OPEN_SPREAD;
            nodes[at].inward_sides = ALL_SIDES;
        }
    }
}

struct Builder<'a> {
    vertices: &'a [DVec3],
    triangles: &'a [[u32; 3]],
}

impl Builder<'_> {
    /// Appends the nodes below node `at`, which covers `items`, and sets the bounds, inward sides and cuts of this
    /// node. `centers` is the box of the centres of the items. Returns the maxima of the vertices along the signs.
    fn build_subtree(
        &self,
        items: &mut [Item],
        at: usize,
        centers: &Aabb,
        threads: usize,
        nodes: &mut Vec<Node>,
    ) -> SignMaxima {
        let (maxima, bounds, inward_sides) = if items.len() <= MAX_LEAF_FACETS {
            let bounds = items.iter().fold(Aabb::EMPTY, |bounds, item| bounds.union(&item.bounds));
            let inward = items.iter().fold(0, |sides, item| sides | item.inward_sides(&bounds));
            (self.facet_maxima(items), bounds, inward)
        } else {
            let maxima = self.build_children(items, at, centers, threads, nodes);
            let [first, second] = nodes[at].child_positions(at as u32);
            let children = [&nodes[first as usize], &nodes[second as usize]];
            let bounds = children[0].bounds.union(&children[1].bounds);
            let inward = children.map(|child| child.inward_sides_within(&bounds));
            (maxima, bounds, inward[0] | inward[1])
        };
        let cuts = maxima.depth_shares(&bounds);
        nodes[at] = Node { bounds, cuts, inward_sides, ..nodes[at] };
        maxima
    }

    /// Returns the maxima of the vertices of facets along the signs of corners and edges.
    fn facet_maxima(&self, items: &[Item]) -> SignMaxima {
        let mut maxima = SignMaxima::NONE;
        for v in items.iter().flat_map(|item| self.triangles[item.facet as usize]) {
            maxima.add(self.vertices[v as usize]);
        }
        maxima
    }

    /// Splits the items of a node, appends both children with their descendants, on two threads if there are enough
    /// facets.
    fn build_children(
        &self,
        items: &mut [Item],
        at: usize,
        centers: &Aabb,
        threads: usize,
        nodes: &mut Vec<Node>,
    ) -> SignMaxima {
        let rule = SplitRule { min_items: 1, only_longest_axis: false };
        let middle = split_items_within(items, centers, rule);
        let (left, right) = items.split_at_mut(middle);
        let first = nodes[at].first_facet;
        let second = first + middle as u32;
        let child = nodes.len();
        nodes[at].child_offset = (child - at) as u32;
        if threads > 1 && left.len().min(right.len()) >= MIN_THREAD_FACETS {
            let mut behind = Vec::with_capacity(right.len());
            let mut maxima = SignMaxima::NONE;
            let mut other = SignMaxima::NONE;
            thread::scope(|scope| {
                scope.spawn(|| {
                    let (node, centers) = self.oriented_node(right, second);
                    behind.push(node);
                    other = self.build_subtree(right, 0, &centers, threads / 2, &mut behind);
                });
                let (node, centers) = self.oriented_node(left, first);
                nodes.extend([node; 2]);
                maxima = self.build_subtree(left, child, &centers, threads - threads / 2, nodes);
            });
            maxima.include_maxima(&other);
            // The second child is stored next to the first, its descendants at the end.
            let root = &mut behind[0];
            if root.child_offset != 0 {
                root.child_offset += (nodes.len() - 1 - (child + 1)) as u32;
            }
            nodes[child + 1] = *root;
            nodes.extend_from_slice(&behind[1..]);
            maxima
        } else {
            let (left_node, left_centers) = self.oriented_node(left, first);
            let (right_node, right_centers) = self.oriented_node(right, second);
            nodes.extend([left_node, right_node]);
            let mut maxima = self.build_subtree(left, child, &left_centers, 1, nodes);
            let behind = self.build_subtree(right, child + 1, &right_centers, 1, nodes);
            maxima.include_maxima(&behind);
            maxima
        }
    }

    /// Returns a leaf node with the orientation of `items`, without a box, and the box of their centres.
    fn oriented_node(&self, items: &[Item], first: u32) -> (Node, Aabb) {
        let mut centers = Aabb::EMPTY;
        let (mut sum, mut total) = (DVec3::ZERO, 0.0);
        for item in items {
            centers.extend_to(item.doubled_center());
            sum += item.normal * item.area;
            total += item.area;
        }
        let mut node = Node {
            bounds: Aabb::EMPTY,
            axis: DVec3::ZERO,
            slab: [f64::NEG_INFINITY, f64::INFINITY],
            spread: ANY_ANGLE as f32,
            child_offset: 0,
            first_facet: first,
            facet_count: items.len() as u32,
            cuts: [0; CUTS],
            inward_sides: 0,
        };
        // Only a surface with a dominant orientation has an axis.
        if sum.length() > 0.25 * total {
            node.axis = sum.normalize_or_zero();
            self.add_cone(items, &mut node);
        }
        (node, centers)
    }

    /// Sets the spread and the slab of a node, or removes its axis if a normal may be perpendicular to it.
    fn add_cone(&self, items: &[Item], node: &mut Node) {
        let (mut squared, mut doubt) = (0.0_f64, 0.0_f64);
        for item in items {
            let [x, y] = normal_deviation(node.axis, item);
            (squared, doubt) = (squared.max(x), doubt.max(y));
            if squared >= 1.0 || doubt >= 1.0 {
                // Such a node bounds no orientation, and its slab is hardly thinner than the box.
                node.axis = DVec3::ZERO;
                return;
            }
        }
        // Angles whose sines have a sum below 1 have a sum below a right angle.
        let spread = squared.sqrt() + doubt;
        if spread >= 1.0 {
            node.axis = DVec3::ZERO;
            return;
        }
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for item in items {
            for v in self.triangles[item.facet as usize] {
                let height = node.axis.dot(self.vertices[v as usize]);
                (low, high) = (low.min(height), high.max(height));
            }
        }
        node.slab = [low, high];
        node.spread = round_up(spread);
    }
}

/// Returns the squared sine of the angle between a unit axis and the normal of a facet, and an upper bound on its
/// error, a sine. Returns [`ANY_ANGLE`] for both if the angle may be a right angle or more.
fn normal_deviation(axis: DVec3, item: &Item) -> [f64; 2] {
    if item.doubt >= 1.0 || axis.dot(item.normal) <= 0.0 {
        return [ANY_ANGLE; 2];
    }
    let squared = axis.cross(item.normal).length_squared();
    let (x, y) = (axis.abs(), item.normal.abs());
    let terms = x.yzx() * y.zxy() + x.zxy() * y.yzx();
    [squared, item.doubt + 4.0 * f64::EPSILON * terms.element_sum()]
}

/// Returns the smallest single-precision number that is not smaller.
fn round_up(x: f64) -> f32 {
    let near = x as f32;
    if f64::from(near) < x { near.next_up() } else { near }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tree_is_equal_for_all_thread_counts() {
        // Facets of a wavy sheet, more than five times the number from which threads are used.
        let side = 220_u32;
        let at = |i: u32, j: u32| {
            let (x, y) = (f64::from(i), f64::from(j));
            DVec3::new(x, y, 8.0 * (0.1 * x).sin() * (0.07 * y).cos())
        };
        let vertices: Vec<DVec3> = (0..side * side).map(|k| at(k % side, k / side)).collect();
        let triangles: Vec<[u32; 3]> = (0..side * side)
            .filter(|k| k % side + 1 < side && k / side + 1 < side)
            .flat_map(|k| [[k, k + 1, k + side], [k + 1, k + side + 1, k + side]])
            .collect();
        assert!(triangles.len() > 5 * MIN_THREAD_FACETS);
        let alone = build_tree_on(1, &vertices, &triangles);
        for threads in [2, 3, 8, 64] {
            assert!(build_tree_on(threads, &vertices, &triangles) == alone, "{threads} threads");
        }
    }
}
