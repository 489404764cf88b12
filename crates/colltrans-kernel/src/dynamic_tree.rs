//! A binary tree of boxes that changes.
//!
//! Built from the top ([`split`](mod@crate::split)), each child with a quarter of the items at least.
//! One that comes goes down to where boxes grow least; one that goes leaves its place to its neighbour; one
//! that moves within its parent's box stays where it is, and else goes and comes, two changes. Every node is
//! built anew after as many changes below it as it had items (and [`FEW_CHANGES`] at least).
//!
//! So no node becomes more than twice what it was; a child had three quarters of its items at most, and has
//! seven eighths at most whatever comes: the height stays below `log n / log (8 / 7)`, that is `5.2 log2 n`, plus
//! a few. A change costs `O(log^2 n)` on average.
//!
//! Invariant. A node's box holds the boxes of all items below it; inner boxes are the joins of their children's.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use crate::aabb::Aabb;
use crate::split::{Boxed, Rule, halve, split};

/// Items that are halved.
const FEW: usize = 4;
/// Changes that no node is built anew for.
const FEW_CHANGES: u32 = 8;
const NONE: u32 = u32::MAX;
/// Queues have room for so many nodes.
const ROOM: usize = 64;

/// A box with an item, or of two nodes.
#[derive(Debug, Clone, Copy)]
struct Node {
    bounds: Aabb,
    parent: u32,
    /// The first of two children, side by side; of a leaf its item.
    first: u32,
    /// How many items; 1 is a leaf.
    count: u32,
    /// Changes until it is built anew.
    left: u32,
}

/// Items, numbered from 0 without gaps, and their boxes.
#[derive(Debug, Clone, Default)]
pub struct DynamicTree {
    /// The root first, if there are items.
    nodes: Vec<Node>,
    /// Pairs of nodes out of use, by the first of them.
    free: Vec<u32>,
    /// Where each item's leaf is.
    leaves: Vec<u32>,
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
    /// Of items with these boxes.
    pub fn build(boxes: impl IntoIterator<Item = Aabb>) -> Self {
        let number = |(k, bounds)| Item { bounds, number: k as u32 };
        let mut items: Vec<Item> = boxes.into_iter().enumerate().map(number).collect();
        let mut tree = Self::default();
        tree.leaves.resize(items.len(), 0);
        if !items.is_empty() {
            tree.nodes.reserve(2 * items.len() - 1);
            tree.nodes.push(Node::leaf(Aabb::EMPTY, NONE, 0));
            tree.grow(0, &mut items);
        }
        tree
    }

    /// The box of an item.
    #[inline]
    pub fn bounds(&self, item: u32) -> &Aabb {
        &self.nodes[self.leaves[item as usize] as usize].bounds
    }

    /// The box of all items.
    #[inline]
    pub fn root(&self) -> Option<&Aabb> {
        self.nodes.first().map(|root| &root.bounds)
    }

    /// Makes what is at and below a node, which has its place and its parent.
    fn grow(&mut self, at: u32, items: &mut [Item]) {
        let parent = self.nodes[at as usize].parent;
        if let [item] = items {
            self.put(at, Node::leaf(item.bounds, parent, item.number));
            return;
        }
        let middle = if items.len() <= FEW {
            let centers = Aabb::of_points(items.iter().map(Boxed::center));
            halve(items, &centers)
        } else {
            split(items, Rule { least: items.len() / 4, longest: true })
        };
        let (left, right) = items.split_at_mut(middle);
        let first = self.pair(at);
        self.grow(first, left);
        self.grow(first + 1, right);
        let bounds = self.joined(first);
        let count = (left.len() + right.len()) as u32;
        self.nodes[at as usize] = Node { bounds, parent, first, count, left: life(count) };
    }

    /// Two places for children of a node.
    fn pair(&mut self, parent: u32) -> u32 {
        let nothing = Node::leaf(Aabb::EMPTY, parent, 0);
        if let Some(first) = self.free.pop() {
            self.nodes[first as usize] = nothing;
            self.nodes[first as usize + 1] = nothing;
            return first;
        }
        let first = self.nodes.len() as u32;
        self.nodes.extend([nothing; 2]);
        first
    }

    /// Puts a node to its place, and tells who is below where that is.
    fn put(&mut self, at: u32, node: Node) {
        self.nodes[at as usize] = node;
        if node.is_leaf() {
            self.leaves[node.first as usize] = at;
        } else {
            for child in [node.first, node.first + 1] {
                self.nodes[child as usize].parent = at;
            }
        }
    }

    fn joined(&self, first: u32) -> Aabb {
        let [a, b] = [first, first + 1].map(|child| &self.nodes[child as usize].bounds);
        a.join(b)
    }

    /// A new item, the last one.
    pub fn insert(&mut self, bounds: Aabb) {
        self.leaves.push(0);
        self.hang(self.leaves.len() as u32 - 1, bounds);
    }

    fn hang(&mut self, item: u32, bounds: Aabb) {
        let Some(mut at) = (!self.nodes.is_empty()).then_some(0_u32) else {
            self.nodes.push(Node::leaf(bounds, NONE, item));
            self.leaves[item as usize] = 0;
            return;
        };
        while !self.nodes[at as usize].is_leaf() {
            at = self.least_grown(self.nodes[at as usize].first, &bounds);
        }
        let there = self.nodes[at as usize];
        let first = self.pair(at);
        self.put(first, Node { parent: at, ..there });
        self.put(first + 1, Node::leaf(bounds, at, item));
        self.nodes[at as usize] = Node { first, count: 1, left: life(2), ..there };
        self.change(at, 1);
    }

    /// Which of two nodes grows least by a box, or else is smaller, or has fewer items.
    fn least_grown(&self, first: u32, bounds: &Aabb) -> u32 {
        let cost = |at: u32| {
            let Node { bounds: there, count, .. } = &self.nodes[at as usize];
            let area = there.join(bounds).half_area();
            (area - there.half_area(), area, *count)
        };
        if cost(first + 1) < cost(first) { first + 1 } else { first }
    }

    /// Takes an item out; the last one gets its number.
    pub fn remove(&mut self, item: u32) {
        self.unhang(item);
        let last = self.leaves.len() as u32 - 1;
        if item != last {
            let leaf = self.leaves[last as usize];
            self.leaves[item as usize] = leaf;
            self.nodes[leaf as usize].first = item;
        }
        self.leaves.pop();
        if self.leaves.is_empty() {
            *self = Self::default();
        }
    }

    /// Its parent becomes its neighbour; nothing happens to an only one.
    fn unhang(&mut self, item: u32) {
        let leaf = self.leaves[item as usize];
        let parent = self.nodes[leaf as usize].parent;
        if parent == NONE {
            self.nodes.clear();
            self.free.clear();
            return;
        }
        let Node { parent: above, first, .. } = self.nodes[parent as usize];
        let other = if leaf == first { first + 1 } else { first };
        let kept = self.nodes[other as usize];
        self.put(parent, Node { parent: above, ..kept });
        self.free.push(first);
        if above != NONE {
            self.change(above, -1);
        }
    }

    /// An item that has another box now.
    pub fn set(&mut self, item: u32, bounds: Aabb) {
        let leaf = self.leaves[item as usize] as usize;
        let parent = self.nodes[leaf].parent;
        if parent == NONE {
            self.nodes[leaf].bounds = bounds;
        } else if self.nodes[parent as usize].bounds.holds(&bounds) {
            self.nodes[leaf].bounds = bounds;
            self.refit(parent);
        } else {
            self.unhang(item);
            self.hang(item, bounds);
        }
    }

    /// Boxes from a node upwards, as far as they change.
    fn refit(&mut self, mut at: u32) {
        while at != NONE {
            let bounds = self.joined(self.nodes[at as usize].first);
            let node = &mut self.nodes[at as usize];
            if node.bounds == bounds {
                return;
            }
            node.bounds = bounds;
            at = node.parent;
        }
    }

    /// So many items more below an inner node: boxes and counts from there upwards; the highest node that
    /// has changed too much is built anew.
    fn change(&mut self, from: u32, more: i32) {
        let (mut at, mut worn) = (from, None);
        while at != NONE {
            let bounds = self.joined(self.nodes[at as usize].first);
            let node = &mut self.nodes[at as usize];
            node.bounds = bounds;
            node.count = node.count.wrapping_add_signed(more);
            node.left -= 1;
            if node.left == 0 {
                worn = Some(at);
            }
            at = node.parent;
        }
        if let Some(at) = worn {
            self.rebuild(at);
        }
    }

    fn rebuild(&mut self, at: u32) {
        let mut items = Vec::with_capacity(self.nodes[at as usize].count as usize);
        let mut stack = vec![at];
        while let Some(node) = stack.pop() {
            let Node { bounds, first, .. } = self.nodes[node as usize];
            if self.nodes[node as usize].is_leaf() {
                items.push(Item { bounds, number: first });
            } else {
                stack.extend([first, first + 1]);
                self.free.push(first);
            }
        }
        self.grow(at, &mut items);
    }

    /// Visits items by their least bounds first, as long as these are not above a limit; `bound` is not
    /// above that of what a box holds, not negative, and infinite for what is of no interest. `visit` says the new limit.
    /// How many boxes were looked at.
    ///
    /// # Errors
    /// What `visit` says.
    pub fn search<E>(
        &self,
        mut limit: f64,
        bound: impl Fn(&Aabb) -> f64,
        mut visit: impl FnMut(u32, f64) -> Result<f64, E>,
    ) -> Result<u32, E> {
        if self.nodes.is_empty() {
            return Ok(0);
        }
        // The least bound comes first, and among equals the first node: bounds are not negative, so they are in the order
        // of their bits.
        let entry =
            |node: u32| Reverse((bound(&self.nodes[node as usize].bounds).abs().to_bits(), node));
        let (mut queue, mut looked) = (BinaryHeap::with_capacity(ROOM), 1);
        let mut next = Some(entry(0));
        while let Some(Reverse((bits, at))) = next.take().or_else(|| queue.pop()) {
            let least = f64::from_bits(bits);
            if least > limit || least == f64::INFINITY {
                break;
            }
            let node = &self.nodes[at as usize];
            if node.is_leaf() {
                limit = visit(node.first, least)?;
                continue;
            }
            looked += 2;
            let [a, b] = [node.first, node.first + 1].map(entry);
            let (near, far) = if a > b { (a, b) } else { (b, a) };
            if f64::from_bits(far.0.0) <= limit {
                queue.push(far);
            }
            // Straight down, unless something else is nearer.
            match queue.peek() {
                Some(top) if *top > near => queue.push(near),
                _ => next = Some(near),
            }
        }
        Ok(looked)
    }

    /// The height of the tree.
    #[cfg(test)]
    fn height(&self) -> usize {
        let depth = |leaf: &u32| {
            std::iter::successors(Some(*leaf), |at| {
                let parent = self.nodes[*at as usize].parent;
                (parent != NONE).then_some(parent)
            })
            .count()
        };
        self.leaves.iter().map(depth).max().unwrap_or(0)
    }
}

/// After how many changes a node of so many items is built anew.
fn life(count: u32) -> u32 {
    count.max(FEW_CHANGES)
}

impl Node {
    fn leaf(bounds: Aabb, parent: u32, item: u32) -> Self {
        Self { bounds, parent, first: item, count: 1, left: 0 }
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

    fn cube(x: f64, y: f64, z: f64) -> Aabb {
        let at = DVec3::new(x, y, z);
        Aabb { low: at, high: at + 1.0 }
    }

    /// Whether the tree is one, with these items.
    fn check(tree: &DynamicTree, boxes: &[Aabb]) {
        assert_eq!(tree.leaves.len(), boxes.len());
        for (item, bounds) in boxes.iter().enumerate() {
            assert_eq!(tree.bounds(item as u32), bounds);
            assert_eq!(tree.nodes[tree.leaves[item] as usize].first, item as u32);
        }
        let mut inner = 0;
        let mut stack: Vec<u32> = tree.root().map(|_| 0).into_iter().collect();
        while let Some(at) = stack.pop() {
            let node = tree.nodes[at as usize];
            if node.is_leaf() {
                continue;
            }
            inner += 1;
            let children = [node.first, node.first + 1];
            assert_eq!(node.bounds, tree.joined(node.first));
            let counts = children.map(|child| tree.nodes[child as usize].count);
            assert_eq!(node.count, counts[0] + counts[1]);
            assert!(children.iter().all(|child| tree.nodes[*child as usize].parent == at));
            stack.extend(children);
        }
        assert_eq!(inner, boxes.len().saturating_sub(1));
        let most = 5.2 * (boxes.len().max(1) as f64).log2() + 8.0;
        assert!(tree.height() as f64 <= most, "{} of {}", tree.height(), boxes.len());
    }

    fn found(tree: &DynamicTree, limit: f64) -> Vec<u32> {
        let mut all = Vec::new();
        let visit = |item, _| {
            all.push(item);
            Ok::<_, Infallible>(limit)
        };
        tree.search(limit, |bounds| bounds.low.x.max(0.0), visit).expect("no errors");
        all.sort_unstable();
        all
    }

    proptest! {
        #[test]
        fn it_stays_a_tree_whatever_comes_moves_and_goes(
            start in prop::collection::vec([0..9_i32, 0..9, 0..9], 0..40),
            changes in prop::collection::vec((0..4_u8, any::<prop::sample::Index>(), [0..9_i32, 0..9, 0..9]), 0..200),
        ) {
            let of = |[x, y, z]: [i32; 3]| cube(f64::from(x), f64::from(y), f64::from(z));
            let mut boxes: Vec<Aabb> = start.into_iter().map(of).collect();
            let mut tree = DynamicTree::build(boxes.iter().copied());
            for (kind, which, at) in changes {
                let bounds = of(at);
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
                    tree.set(which as u32, bounds);
                }
                check(&tree, &boxes);
            }
            let near: Vec<u32> =
                (0..boxes.len() as u32).filter(|k| boxes[*k as usize].low.x <= 4.0).collect();
            prop_assert_eq!(found(&tree, 4.0), near);
        }
    }

    #[test]
    fn one_after_the_other_makes_no_list() {
        let mut tree = DynamicTree::default();
        let mut boxes = Vec::new();
        for k in 0..3_000 {
            boxes.push(cube(2.0 * f64::from(k), 0.0, 0.0));
            tree.insert(boxes[k as usize]);
        }
        check(&tree, &boxes);
        while boxes.len() > 10 {
            boxes.swap_remove(0);
            tree.remove(0);
        }
        check(&tree, &boxes);
    }
}
