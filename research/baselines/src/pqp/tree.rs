//! A tree of bounding volumes over triangles, with both kinds of volumes in every node.
//!
//! The tree is built top-down. The volumes of a node are fitted to its triangles. These are split at the mean
//! of their centres along the longest axis, or at the median if one side would have less than 1/8 of them,
//! down to single triangles. `n` triangles yield `2 n - 1` nodes in `O(log n)` levels, in `O(n log n)` time.
//! Nodes are in preorder: the left child follows its parent, and the triangles of a node are consecutive.

use glam::{DMat3, DVec3};

use super::frame;
use super::obb::Obb;
use super::rss::Rss;
use super::triangle::Triangle;

/// Limit of the split, which bounds the depth: no child has more than 7/8 of its parent's triangles.
const MOST_UNEVEN: usize = 8;

/// Content of a node.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Content {
    /// A leaf with this triangle.
    Leaf(u32),
    /// An inner node. Its children are the next node and this one.
    Inner(u32),
}

/// A node for distance queries, of two cache lines.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Node {
    pub(crate) rss: Rss,
    pub(crate) content: Content,
}

/// All nodes of a soup, and their boxes.
#[derive(Debug, Clone)]
pub(crate) struct Tree {
    pub(crate) nodes: Vec<Node>,
    pub(crate) boxes: Vec<Obb>,
    /// Number of nodes on the longest path from the root to a leaf.
    pub(crate) levels: usize,
}

impl Tree {
    /// Builds the tree of at least one triangle, and the order of its triangles.
    pub(crate) fn build(count: usize, triangle: impl Fn(u32) -> Triangle) -> (Self, Vec<u32>) {
        let mut builder = Builder {
            triangle,
            items: (0..count as u32).map(|i| (0.0, i)).collect(),
            points: Vec::with_capacity(3 * count),
        };
        let node_count = 2 * count - 1;
        let mut tree = Self {
            nodes: Vec::with_capacity(node_count),
            boxes: Vec::with_capacity(node_count),
            levels: 0,
        };
        // A stack of ranges of items. The left part of a node is processed next, so that nodes are in
        // preorder.
        let mut pending = vec![(0, count, 1)];
        while let Some((start, end, level)) = pending.pop() {
            tree.levels = tree.levels.max(level);
            let (rss, obb) = builder.fit_volumes(start, end);
            let node = tree.nodes.len();
            let content = if end - start == 1 {
                Content::Leaf(start as u32)
            } else {
                let middle = builder.partition_triangles(start, end, rss.axes.x_axis);
                pending.push((middle, end, level + 1));
                pending.push((start, middle, level + 1));
                Content::Inner((node + 2 * (middle - start)) as u32)
            };
            tree.nodes.push(Node { rss, content });
            tree.boxes.push(obb);
        }
        (tree, builder.items.into_iter().map(|(_, i)| i).collect())
    }

    /// Returns the number of bytes on the heap.
    pub(crate) fn heap_bytes(&self) -> usize {
        self.nodes.capacity() * size_of::<Node>() + self.boxes.capacity() * size_of::<Obb>()
    }
}

/// Data for building a tree.
struct Builder<F> {
    triangle: F,
    /// Triangles in the order of the leaves, each with the key of the last split.
    items: Vec<(f64, u32)>,
    /// Corners of the node's triangles, later their coordinates along its axes.
    points: Vec<DVec3>,
}

impl<F: Fn(u32) -> Triangle> Builder<F> {
    /// Fits both volumes to a range of triangles.
    fn fit_volumes(&mut self, start: usize, end: usize) -> (Rss, Obb) {
        let Self { triangle, items, points } = self;
        points.clear();
        points.extend(items[start..end].iter().flat_map(|(_, i)| triangle(*i)));
        let axes = match points.as_slice() {
            &[a, b, c] => frame::of_triangle(&[a, b, c]),
            many => frame::of_points(many),
        };
        let to_axes: DMat3 = axes.transpose();
        for p in points.iter_mut() {
            *p = to_axes * *p;
        }
        (Rss::fit(axes, points), Obb::fit(axes, points))
    }

    /// Partitions a range of triangles along an axis, and returns the start of the second part.
    fn partition_triangles(&mut self, start: usize, end: usize, along: DVec3) -> usize {
        let items = &mut self.items[start..end];
        let mut sum = 0.0;
        for (key, i) in items.iter_mut() {
            *key = (self.triangle)(*i).iter().sum::<DVec3>().dot(along);
            sum += *key;
        }
        let count = items.len();
        let mean = sum / count as f64;
        let mut below = 0;
        for k in 0..count {
            if items[k].0 < mean {
                items.swap(k, below);
                below += 1;
            }
        }
        if below.min(count - below) * MOST_UNEVEN < count {
            below = count / 2;
            items.select_nth_unstable_by(below, |a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        }
        start + below
    }
}
