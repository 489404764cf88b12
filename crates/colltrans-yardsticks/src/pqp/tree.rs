//! A tree of bounding volumes over triangles, both volumes in every node.
//!
//! Top-down: the volumes of a node are fitted to its triangles, which are then divided at the
//! median of their centres along the longest axis, down to single triangles. `n` triangles make `2
//! n - 1` nodes in depth `ceil(log2 n)`, in `O(n log n)` time. Nodes lie in preorder: the left child
//! follows its parent, and the triangles of a node lie in one piece.

use glam::{DMat3, DVec3};

use super::frame;
use super::obb::Obb;
use super::rss::Rss;
use super::triangle::Triangle;

/// What a node stands for.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Content {
    /// One triangle.
    Leaf(u32),
    /// Two nodes: the next one and this one.
    Inner(u32),
}

/// A node for distances: two cache lines.
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
}

impl Tree {
    /// The tree of at least one triangle, and the order in which it numbers them.
    pub(crate) fn build(count: usize, triangle: impl Fn(u32) -> Triangle) -> (Self, Vec<u32>) {
        let mut builder = Builder {
            triangle,
            items: (0..count as u32).map(|i| (0.0, i)).collect(),
            points: Vec::with_capacity(3 * count),
        };
        let node_count = 2 * count - 1;
        let mut tree =
            Self { nodes: Vec::with_capacity(node_count), boxes: Vec::with_capacity(node_count) };
        // A stack of ranges of items: a node's left part is taken up next, so nodes come in
        // preorder.
        let mut pending = vec![(0, count)];
        while let Some((start, end)) = pending.pop() {
            let (rss, obb) = builder.volumes(start, end);
            let node = tree.nodes.len();
            let content = if end - start == 1 {
                Content::Leaf(start as u32)
            } else {
                let middle = start + (end - start).div_ceil(2);
                builder.divide(start, middle, end, rss.axes.x_axis);
                pending.push((middle, end));
                pending.push((start, middle));
                Content::Inner((node + 2 * (middle - start)) as u32)
            };
            tree.nodes.push(Node { rss, content });
            tree.boxes.push(obb);
        }
        (tree, builder.items.into_iter().map(|(_, i)| i).collect())
    }

    pub(crate) fn heap_bytes(&self) -> usize {
        self.nodes.capacity() * size_of::<Node>() + self.boxes.capacity() * size_of::<Obb>()
    }

    /// The longest way from the root to a leaf, in nodes.
    pub(crate) fn depth(&self) -> usize {
        let triangles = self.nodes.len().div_ceil(2);
        triangles.next_power_of_two().ilog2() as usize + 1
    }
}

struct Builder<F> {
    triangle: F,
    /// Triangles in the order of leaves, each with the key of the last division.
    items: Vec<(f64, u32)>,
    /// Corners of the node's triangles, then their coordinates along its axes.
    points: Vec<DVec3>,
}

impl<F: Fn(u32) -> Triangle> Builder<F> {
    fn volumes(&mut self, start: usize, end: usize) -> (Rss, Obb) {
        let Self { triangle, items, points } = self;
        points.clear();
        points.extend(items[start..end].iter().flat_map(|(_, i)| triangle(*i)));
        let axes = match points.as_slice() {
            &[a, b, c] => frame::of_triangle(&[a, b, c]),
            many => frame::of_points(many),
        };
        let to_axes: DMat3 = axes.transpose();
        points.iter_mut().for_each(|p| *p = to_axes * *p);
        (Rss::fit(axes, points), Obb::fit(axes, points))
    }

    fn divide(&mut self, start: usize, middle: usize, end: usize, along: DVec3) {
        let items = &mut self.items[start..end];
        for (key, i) in items.iter_mut() {
            *key = (self.triangle)(*i).iter().sum::<DVec3>().dot(along);
        }
        items
            .select_nth_unstable_by(middle - start, |a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    }
}
