//! A dynamic bounding volume tree: a binary tree of axis-aligned boxes with insertion, removal and moves.
//!
//! - The tree is built from the top ([`split`](mod@crate::split)). Each child gets at least a quarter of the
//!   items.
//! - A new item descends to the child whose box grows least.
//! - The sibling of a removed leaf takes the place of the parent.
//! - An item that moves within its parent's box keeps its leaf. Otherwise it is removed and inserted (two
//!   changes).
//! - A node is rebuilt after as many changes below it as it had items, and at least [`MIN_CHANGES`].
//!
//! The height stays below `5.2 log2 n` plus a constant, and a change costs `O(log^2 n)` on average
//! (`docs/theory/box-trees.md`). Invariant: the box of an inner node is the union of its children's boxes.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use crate::aabb::Aabb;
use crate::split::{Boxed, SplitRule, split_at_median, split_items};

/// Maximum number of items that are split by count.
const MAX_HALVED: usize = 4;
/// Minimum number of changes below a node before it is rebuilt.
const MIN_CHANGES: u32 = 8;
/// Number of the missing parent of the root.
const NO_NODE: u32 = u32::MAX;
/// Initial capacity of the queue of a search, in nodes.
const QUEUE_CAPACITY: usize = 64;

/// A leaf with the box of one item, or an inner node with the union of two boxes.
#[derive(Debug, Clone, Copy)]
struct Node {
    bounds: Aabb,
    parent: u32,
    /// Number of the first of two adjacent children; number of the item for a leaf.
    first: u32,
    /// Number of items below; 1 for a leaf.
    count: u32,
    /// Number of changes below until the node is rebuilt.
    changes_left: u32,
}

/// A tree over the boxes of items, which are numbered from 0 without gaps.
#[derive(Debug, Clone, Default)]
pub struct DynamicTree {
    /// The nodes, the root first; empty without items.
    nodes: Vec<Node>,
    /// The first nodes of pairs that are not in use.
    free_pairs: Vec<u32>,
    /// Number of the leaf of each item.
    leaf_of_item: Vec<u32>,
}

#[derive(Debug, Clone, Copy)]
struct Item {
    bounds: Aabb,
    number: u32,
}

impl Boxed for Item {
    #[inline]
    fn bounds(&self) -> &Aabb {
        &self.bounds
    }

    #[inline]
    fn number(&self) -> u32 {
        self.number
    }
}

impl DynamicTree {
    /// Builds the tree over boxes. Items are numbered in the order of the boxes.
    pub fn from_boxes(boxes: impl IntoIterator<Item = Aabb>) -> Self {
        let number = |(k, bounds)| Item { bounds, number: k as u32 };
        let mut items: Vec<Item> = boxes.into_iter().enumerate().map(number).collect();
        let mut tree = Self::default();
        tree.leaf_of_item.resize(items.len(), 0);
        if !items.is_empty() {
            tree.nodes.reserve(2 * items.len() - 1);
            tree.nodes.push(Node::new_leaf(Aabb::EMPTY, NO_NODE, 0));
            tree.build_subtree(0, &mut items);
        }
        tree
    }

    /// Returns the box of an item.
    ///
    /// # Panics
    /// If there is no item with this number.
    #[inline]
    pub fn item_bounds(&self, item: u32) -> &Aabb {
        &self.nodes[self.leaf_of_item[item as usize] as usize].bounds
    }

    /// Returns the box of all items; `None` if there are no items.
    #[inline]
    pub fn root_bounds(&self) -> Option<&Aabb> {
        self.nodes.first().map(|root| &root.bounds)
    }

    /// Builds the subtree at a node that is already allocated and has its parent.
    fn build_subtree(&mut self, index: u32, items: &mut [Item]) {
        let parent = self.nodes[index as usize].parent;
        if let [item] = items {
            self.store_node(index, Node::new_leaf(item.bounds, parent, item.number));
            return;
        }
        let middle = if items.len() <= MAX_HALVED {
            let centers = Aabb::from_points(items.iter().map(Boxed::doubled_center));
            split_at_median(items, &centers)
        } else {
            split_items(items, SplitRule { min_items: items.len() / 4, only_longest_axis: true })
        };
        let (left, right) = items.split_at_mut(middle);
        let first = self.allocate_children(index);
        self.build_subtree(first, left);
        self.build_subtree(first + 1, right);
        let bounds = self.union_of_siblings(first);
        let count = (left.len() + right.len()) as u32;
        self.nodes[index as usize] =
            Node { bounds, parent, first, count, changes_left: changes_until_rebuild(count) };
    }

    /// Allocates two adjacent children of a node and returns the number of the first.
    fn allocate_children(&mut self, parent: u32) -> u32 {
        let nothing = Node::new_leaf(Aabb::EMPTY, parent, 0);
        if let Some(first) = self.free_pairs.pop() {
            self.nodes[first as usize] = nothing;
            self.nodes[first as usize + 1] = nothing;
            return first;
        }
        let first = self.nodes.len() as u32;
        self.nodes.extend([nothing; 2]);
        first
    }

    /// Stores a node at a position, and updates the position of its item or the parents of its children.
    fn store_node(&mut self, index: u32, node: Node) {
        self.nodes[index as usize] = node;
        if node.is_leaf() {
            self.leaf_of_item[node.first as usize] = index;
        } else {
            for child in [node.first, node.first + 1] {
                self.nodes[child as usize].parent = index;
            }
        }
    }

    /// Returns the union of the boxes of two siblings.
    fn union_of_siblings(&self, first: u32) -> Aabb {
        let [a, b] = [first, first + 1].map(|child| &self.nodes[child as usize].bounds);
        a.union(b)
    }

    /// Inserts an item. Its number is the previous number of items.
    pub fn insert(&mut self, bounds: Aabb) {
        self.leaf_of_item.push(0);
        self.insert_leaf(self.leaf_of_item.len() as u32 - 1, bounds);
    }

    /// Inserts the leaf of an item next to the leaf that the descent reaches.
    fn insert_leaf(&mut self, item: u32, bounds: Aabb) {
        let Some(mut index) = (!self.nodes.is_empty()).then_some(0_u32) else {
            self.nodes.push(Node::new_leaf(bounds, NO_NODE, item));
            self.leaf_of_item[item as usize] = 0;
            return;
        };
        while !self.nodes[index as usize].is_leaf() {
            index = self.cheaper_sibling(self.nodes[index as usize].first, &bounds);
        }
        let reached = self.nodes[index as usize];
        let first = self.allocate_children(index);
        self.store_node(first, Node { parent: index, ..reached });
        self.store_node(first + 1, Node::new_leaf(bounds, index, item));
        self.nodes[index as usize] =
            Node { first, count: 1, changes_left: changes_until_rebuild(2), ..reached };
        self.update_ancestors(index, 1);
    }

    /// Selects the sibling whose surface area grows least by a box. Among equal ones, selects the smaller
    /// joined box, then the one with fewer items.
    fn cheaper_sibling(&self, first: u32, bounds: &Aabb) -> u32 {
        let cost = |index: u32| {
            let Node { bounds: node_bounds, count, .. } = &self.nodes[index as usize];
            let area = node_bounds.union(bounds).half_area();
            (area - node_bounds.half_area(), area, *count)
        };
        if cost(first + 1) < cost(first) { first + 1 } else { first }
    }

    /// Removes an item. The last item gets its number.
    ///
    /// # Panics
    /// If there is no item with this number.
    pub fn remove(&mut self, item: u32) {
        self.remove_leaf(item);
        let last = self.leaf_of_item.len() as u32 - 1;
        if item != last {
            let leaf = self.leaf_of_item[last as usize];
            self.leaf_of_item[item as usize] = leaf;
            self.nodes[leaf as usize].first = item;
        }
        self.leaf_of_item.pop();
        if self.leaf_of_item.is_empty() {
            *self = Self::default();
        }
    }

    /// Removes the leaf of an item. The sibling of the leaf replaces their parent. A tree of one item becomes
    /// empty.
    fn remove_leaf(&mut self, item: u32) {
        let leaf = self.leaf_of_item[item as usize];
        let parent = self.nodes[leaf as usize].parent;
        if parent == NO_NODE {
            self.nodes.clear();
            self.free_pairs.clear();
            return;
        }
        let Node { parent: grandparent, first, .. } = self.nodes[parent as usize];
        let sibling = if leaf == first { first + 1 } else { first };
        let sibling_node = self.nodes[sibling as usize];
        self.store_node(parent, Node { parent: grandparent, ..sibling_node });
        self.free_pairs.push(first);
        if grandparent != NO_NODE {
            self.update_ancestors(grandparent, -1);
        }
    }

    /// Sets the box of an item.
    ///
    /// # Panics
    /// If there is no item with this number.
    pub fn set_bounds(&mut self, item: u32, bounds: Aabb) {
        let leaf = self.leaf_of_item[item as usize] as usize;
        let parent = self.nodes[leaf].parent;
        if parent == NO_NODE {
            self.nodes[leaf].bounds = bounds;
        } else if self.nodes[parent as usize].bounds.contains_box(&bounds) {
            self.nodes[leaf].bounds = bounds;
            self.refit_ancestors(parent);
        } else {
            self.remove_leaf(item);
            self.insert_leaf(item, bounds);
        }
    }

    /// Recomputes the boxes from a node upwards until a box does not change.
    fn refit_ancestors(&mut self, mut index: u32) {
        while index != NO_NODE {
            let bounds = self.union_of_siblings(self.nodes[index as usize].first);
            let node = &mut self.nodes[index as usize];
            if node.bounds == bounds {
                return;
            }
            node.bounds = bounds;
            index = node.parent;
        }
    }

    /// Updates boxes and numbers of items from an inner node upwards, after `added` items were inserted below it
    /// (removed, if negative). Rebuilds the highest node that has reached its number of changes.
    fn update_ancestors(&mut self, from: u32, added: i32) {
        let (mut index, mut exhausted) = (from, None);
        while index != NO_NODE {
            let bounds = self.union_of_siblings(self.nodes[index as usize].first);
            let node = &mut self.nodes[index as usize];
            node.bounds = bounds;
            node.count = node.count.wrapping_add_signed(added);
            node.changes_left -= 1;
            if node.changes_left == 0 {
                exhausted = Some(index);
            }
            index = node.parent;
        }
        if let Some(index) = exhausted {
            self.rebuild_subtree(index);
        }
    }

    fn rebuild_subtree(&mut self, index: u32) {
        let mut items = Vec::with_capacity(self.nodes[index as usize].count as usize);
        let mut stack = vec![index];
        while let Some(node) = stack.pop() {
            let Node { bounds, first, .. } = self.nodes[node as usize];
            if self.nodes[node as usize].is_leaf() {
                items.push(Item { bounds, number: first });
            } else {
                stack.extend([first, first + 1]);
                self.free_pairs.push(first);
            }
        }
        self.build_subtree(index, &mut items);
    }

    /// Visits items in the order of increasing bounds, until the least bound exceeds the limit. Returns the
    /// number of boxes for which `bound` was evaluated.
    ///
    /// `bound` maps a box to a lower bound for the items that it contains. Bounds are not negative, and
    /// infinite for boxes to skip. `visit` gets an item with its bound and returns the new limit.
    ///
    /// # Errors
    /// The error of `visit`.
    pub fn visit_by_bound<E>(
        &self,
        mut limit: f64,
        bound: impl Fn(&Aabb) -> f64,
        mut visit: impl FnMut(u32, f64) -> Result<f64, E>,
    ) -> Result<u32, E> {
        if self.nodes.is_empty() {
            return Ok(0);
        }
        // The least bound comes first, and among equal bounds the first node. Bounds are not negative,
        // therefore the order of their bits is their order.
        let entry =
            |node: u32| Reverse((bound(&self.nodes[node as usize].bounds).abs().to_bits(), node));
        let (mut queue, mut evaluated) = (BinaryHeap::with_capacity(QUEUE_CAPACITY), 1);
        let mut next = Some(entry(0));
        while let Some(Reverse((bits, index))) = next.take().or_else(|| queue.pop()) {
            let least = f64::from_bits(bits);
            if least > limit || least == f64::INFINITY {
                break;
            }
            let node = &self.nodes[index as usize];
            if node.is_leaf() {
                limit = visit(node.first, least)?;
                continue;
            }
            evaluated += 2;
            let [a, b] = [node.first, node.first + 1].map(entry);
            let (near, far) = if a > b { (a, b) } else { (b, a) };
            if f64::from_bits(far.0.0) <= limit {
                queue.push(far);
            }
            // Continue with the nearer child, unless another node in the queue is nearer.
            match queue.peek() {
                Some(top) if *top > near => queue.push(near),
                _ => next = Some(near),
            }
        }
        Ok(evaluated)
    }

    /// Returns the number of nodes on the longest path from the root.
    #[cfg(test)]
    fn tree_height(&self) -> usize {
        let depth = |leaf: &u32| {
            std::iter::successors(Some(*leaf), |index| {
                let parent = self.nodes[*index as usize].parent;
                (parent != NO_NODE).then_some(parent)
            })
            .count()
        };
        self.leaf_of_item.iter().map(depth).max().unwrap_or(0)
    }
}

/// Returns the number of changes after which a node with `count` items is rebuilt.
fn changes_until_rebuild(count: u32) -> u32 {
    count.max(MIN_CHANGES)
}

impl Node {
    fn new_leaf(bounds: Aabb, parent: u32, item: u32) -> Self {
        Self { bounds, parent, first: item, count: 1, changes_left: 0 }
    }

    fn is_leaf(&self) -> bool {
        self.count == 1
    }
}

#[cfg(test)]
mod tests {
    use std::convert::Infallible;

    use glam::DVec3;
    use proptest::prelude::*;

    use super::*;

    fn unit_cube(x: f64, y: f64, z: f64) -> Aabb {
        let low = DVec3::new(x, y, z);
        Aabb { low, high: low + 1.0 }
    }

    /// Checks the invariants and the height of a tree that contains exactly these boxes.
    fn assert_valid_tree(tree: &DynamicTree, boxes: &[Aabb]) {
        assert_eq!(tree.leaf_of_item.len(), boxes.len());
        for (item, bounds) in boxes.iter().enumerate() {
            assert_eq!(tree.item_bounds(item as u32), bounds);
            assert_eq!(tree.nodes[tree.leaf_of_item[item] as usize].first, item as u32);
        }
        let mut inner = 0;
        let mut stack: Vec<u32> = tree.root_bounds().map(|_| 0).into_iter().collect();
        while let Some(index) = stack.pop() {
            let node = tree.nodes[index as usize];
            if node.is_leaf() {
                continue;
            }
            inner += 1;
            let children = [node.first, node.first + 1];
            assert_eq!(node.bounds, tree.union_of_siblings(node.first));
            let counts = children.map(|child| tree.nodes[child as usize].count);
            assert_eq!(node.count, counts[0] + counts[1]);
            assert!(children.iter().all(|child| tree.nodes[*child as usize].parent == index));
            stack.extend(children);
        }
        assert_eq!(inner, boxes.len().saturating_sub(1));
        let max_height = 5.2 * (boxes.len().max(1) as f64).log2() + 8.0;
        assert!(
            tree.tree_height() as f64 <= max_height,
            "{} of {}",
            tree.tree_height(),
            boxes.len()
        );
    }

    /// Returns the items whose boxes begin at most at `limit` along x.
    fn items_within(tree: &DynamicTree, limit: f64) -> Vec<u32> {
        let mut all = Vec::new();
        let visit = |item, _| {
            all.push(item);
            Ok::<_, Infallible>(limit)
        };
        tree.visit_by_bound(limit, |bounds| bounds.low.x.max(0.0), visit).expect("no errors");
        all.sort_unstable();
        all
    }

    proptest! {
        #[test]
        fn random_changes_keep_tree_valid(
            start in prop::collection::vec([0..9_i32, 0..9, 0..9], 0..40),
            changes in prop::collection::vec((0..4_u8, any::<prop::sample::Index>(), [0..9_i32, 0..9, 0..9]), 0..200),
        ) {
            let cube_of = |[x, y, z]: [i32; 3]| unit_cube(f64::from(x), f64::from(y), f64::from(z));
            let mut boxes: Vec<Aabb> = start.into_iter().map(cube_of).collect();
            let mut tree = DynamicTree::from_boxes(boxes.iter().copied());
            for (kind, which, low) in changes {
                let bounds = cube_of(low);
                if kind == 0 || boxes.is_empty() {
                    boxes.push(bounds);
                    tree.insert(bounds);
                } else if kind == 1 {
                    let which = which.index(boxes.len());
                    boxes.swap_remove(which);
                    tree.remove(which as u32);
                } else {
                    let which = which.index(boxes.len());
                    boxes[which] = bounds;
                    tree.set_bounds(which as u32, bounds);
                }
                assert_valid_tree(&tree, &boxes);
            }
            let near: Vec<u32> =
                (0..boxes.len() as u32).filter(|k| boxes[*k as usize].low.x <= 4.0).collect();
            prop_assert_eq!(items_within(&tree, 4.0), near);
        }
    }

    #[test]
    fn sequential_insertions_keep_height_logarithmic() {
        let mut tree = DynamicTree::default();
        let mut boxes = Vec::new();
        for k in 0..3_000 {
            boxes.push(unit_cube(2.0 * f64::from(k), 0.0, 0.0));
            tree.insert(boxes[k as usize]);
        }
        assert_valid_tree(&tree, &boxes);
        while boxes.len() > 10 {
            boxes.swap_remove(0);
            tree.remove(0);
        }
        assert_valid_tree(&tree, &boxes);
    }
}
