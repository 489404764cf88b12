//! A tree of the boxes of facets, in an order in which a traversal needs no stack.

use colltrans_convex::body::Aabb;
use colltrans_kernel::split::{Boxed, SplitRule, split_items};

/// Maximum number of facets of a leaf.
const LEAF: usize = 4;

/// A facet while the tree is built.
struct Item {
    bounds: Aabb,
    index: u32,
}

impl Boxed for Item {
    fn bounds(&self) -> &Aabb {
        &self.bounds
    }

    fn number(&self) -> u32 {
        self.index
    }
}

struct Node {
    bounds: Aabb,
    /// Node at which a traversal continues that leaves out this one and its children.
    next: u32,
    /// The facet, if the node is a single one.
    facet: Option<u32>,
}

/// A tree of boxes of facets. Each node precedes its children.
pub(super) struct FacetTree {
    nodes: Vec<Node>,
}

impl FacetTree {
    /// Builds the tree of facets, which are numbered in the order of their boxes.
    pub(super) fn new(bounds: impl Iterator<Item = Aabb>) -> Self {
        let mut items: Vec<Item> =
            bounds.zip(0..).map(|(bounds, index)| Item { bounds, index }).collect();
        let mut tree = Self { nodes: Vec::with_capacity(2 * items.len()) };
        tree.add(&mut items);
        tree
    }

    fn add(&mut self, items: &mut [Item]) {
        let bounds = items.iter().fold(Aabb::EMPTY, |all, item| all.union(&item.bounds));
        let at = self.nodes.len();
        let facet = if let [item] = items { Some(item.index) } else { None };
        self.nodes.push(Node { bounds, next: 0, facet });
        if items.len() > LEAF {
            let rule = SplitRule { min_items: 1, only_longest_axis: true };
            let middle = split_items(items, rule);
            let (first, second) = items.split_at_mut(middle);
            self.add(first);
            self.add(second);
        } else if items.len() > 1 {
            items.chunks_mut(1).for_each(|item| self.add(item));
        }
        self.nodes[at].next = self.nodes.len() as u32;
    }

    /// Calls a function for each facet whose box meets a place, and returns the number of boxes examined.
    pub(super) fn visit(&self, meets: impl Fn(&Aabb) -> bool, mut take: impl FnMut(usize)) -> u64 {
        let (mut at, mut count) = (0, 0);
        while let Some(node) = self.nodes.get(at) {
            count += 1;
            if !meets(&node.bounds) {
                at = node.next as usize;
                continue;
            }
            if let Some(facet) = node.facet {
                take(facet as usize);
            }
            at += 1;
        }
        count
    }
}
