//! Search for the best neighbour of a face: by a scan, or by a tree for a face with many neighbours.
//!
//! Each cap of a prism is adjacent to all other faces. Therefore a walk over the faces would take quadratic time if
//! it scanned them.
//!
//! Invariant. The result is that of a loop over the neighbours in their order, bit for bit. Floating-point sums and
//! products are monotone, so a bound is never below a value that is computed in the same way.

use std::collections::HashMap;
use std::ops::Range;

use glam::DVec3;

use colltrans_kernel::visit_counter;

/// Maximum number of neighbours that are scanned one by one.
const MAX_SCANNED: usize = 32;
/// Maximum number of neighbours in a leaf.
const LEAF_SIZE: usize = 8;

/// The faces adjacent to each face.
pub(super) struct Neighbours {
    start: Vec<u32>,
    faces: Vec<u32>,
    /// Trees of the faces with many neighbours, each node before its children.
    trees: HashMap<usize, Vec<PlaneNode>>,
}

/// Consecutive neighbours, and bounds of their planes.
pub(super) struct PlaneNode {
    range: Range<usize>,
    low: DVec3,
    high: DVec3,
    pub(super) min_offset: f64,
    pub(super) max_offset: f64,
    /// Position of the first node outside the subtree of this one.
    end: usize,
}

impl PlaneNode {
    /// Returns an upper bound of the products of the normals with `ray`.
    pub(super) fn max_product(&self, ray: DVec3) -> f64 {
        DVec3::select(ray.cmpge(DVec3::ZERO), self.high, self.low).dot(ray)
    }
}

impl Neighbours {
    /// Builds the trees. `start` contains the position of each face's first neighbour in `faces`, and `planes` the
    /// normal and offset of each face.
    pub(super) fn new(start: Vec<u32>, faces: Vec<u32>, planes: &[(DVec3, f64)]) -> Self {
        let mut trees = HashMap::new();
        for (face, ends) in start.windows(2).enumerate() {
            let range = ends[0] as usize..ends[1] as usize;
            if range.len() > MAX_SCANNED {
                let mut nodes = Vec::new();
                build_nodes(&mut nodes, range, &faces, planes);
                trees.insert(face, nodes);
            }
        }
        Self { start, faces, trees }
    }

    /// Returns the first neighbour of a face with the largest value, and this value, if it exceeds that of `best`,
    /// else `best`. `bound` must return an upper bound of the values of a node.
    pub(super) fn best_neighbour(
        &self,
        face: usize,
        mut best: (f64, usize),
        value: impl Fn(usize) -> f64,
        bound: impl Fn(&PlaneNode) -> f64,
    ) -> (f64, usize) {
        let scan = |range: Range<usize>, best: &mut (f64, usize)| {
            visit_counter::count_visits(range.len());
            for &neighbour in &self.faces[range] {
                let value = value(neighbour as usize);
                if value > best.0 {
                    *best = (value, neighbour as usize);
                }
            }
        };
        let range = self.start[face] as usize..self.start[face + 1] as usize;
        if range.len() <= MAX_SCANNED {
            scan(range, &mut best);
            return best;
        }
        let nodes = &self.trees[&face];
        let mut next = 0;
        while let Some(node) = nodes.get(next) {
            visit_counter::count_visits(1);
            if bound(node) <= best.0 {
                next = node.end;
                continue;
            }
            if node.range.len() <= LEAF_SIZE {
                scan(node.range.clone(), &mut best);
            }
            next += 1;
        }
        best
    }
}

/// Appends the nodes of a range of neighbours.
fn build_nodes(
    nodes: &mut Vec<PlaneNode>,
    range: Range<usize>,
    faces: &[u32],
    planes: &[(DVec3, f64)],
) {
    let number = nodes.len();
    let mut node = PlaneNode {
        range: range.clone(),
        low: DVec3::INFINITY,
        high: DVec3::NEG_INFINITY,
        min_offset: f64::INFINITY,
        max_offset: f64::NEG_INFINITY,
        end: 0,
    };
    for &face in &faces[range.clone()] {
        let (normal, offset) = planes[face as usize];
        (node.low, node.high) = (node.low.min(normal), node.high.max(normal));
        node.min_offset = node.min_offset.min(offset);
        node.max_offset = node.max_offset.max(offset);
    }
    nodes.push(node);
    if range.len() > LEAF_SIZE {
        let middle = range.start.midpoint(range.end);
        build_nodes(nodes, range.start..middle, faces, planes);
        build_nodes(nodes, middle..range.end, faces, planes);
    }
    nodes[number].end = nodes.len();
}
