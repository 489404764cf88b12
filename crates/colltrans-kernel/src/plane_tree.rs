//! A tree over the face planes of a hull, which finds the minimum over all planes of the depth of a point.
//!
//! The depth of a point `p` below a plane is `offset - normal . p`, which is linear in normal and offset.
//! Therefore a tree over the planes bounds their depths by boxes of the normals and by the least offset of
//! each node. In contrast to a walk from face to face, the search does not visit all neighbours of a large
//! face.
//!
//! Invariant. A depth is computed from the plane as given. The bounds use offsets from the centre of the body,
//! because bounds with offsets from the origin would be wide for a body far from it. The bounds are lowered by
//! more than the rounding error of a bound and a depth.

use std::ops::Range;

use glam::DVec3;

use crate::visit_counter;

/// Maximum number of planes of a leaf.
const MAX_LEAF_PLANES: usize = 8;
/// Bound on the rounding errors of a bound and a depth together, relative to the size of coordinates. Each of the
/// two has about ten roundings of `2^-53`; the constant is 90 of them.
const RELATIVE_ROUNDING: f64 = 1e-14;

/// A tree over planes.
#[derive(Debug)]
pub struct PlaneTree {
    center: DVec3,
    slack: f64,
    /// Unit normal and offset from the origin of each plane, leaf by leaf.
    planes: Vec<(DVec3, f64)>,
    /// The nodes. Each node is before its children, and its first child is next.
    nodes: Vec<Node>,
}

/// A node: a range of consecutive planes with bounds.
#[derive(Debug)]
struct Node {
    planes: Range<usize>,
    /// Componentwise bounds of the normals.
    low: DVec3,
    high: DVec3,
    /// Lower bound of the offsets from the centre of the body.
    least_offset: f64,
    /// Number of the second child; `None` for a leaf.
    second: Option<usize>,
}

impl PlaneTree {
    /// Builds the tree over planes, each with unit normal and offset from the origin. `vertices` are those of
    /// the body that the planes bound.
    pub fn new(vertices: &[DVec3], planes: Vec<(DVec3, f64)>) -> Self {
        let center = vertices.iter().sum::<DVec3>() / vertices.len() as f64;
        let size = vertices.iter().map(|v| v.abs().element_sum()).fold(0.0, f64::max);
        let mut tree = Self { center, slack: RELATIVE_ROUNDING * size, planes, nodes: Vec::new() };
        tree.build_node(0..tree.planes.len());
        tree
    }

    /// Builds the subtree over a range of planes, and sorts the planes into its leaves.
    fn build_node(&mut self, range: Range<usize>) {
        let center = self.center;
        let part = &mut self.planes[range.clone()];
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let mut least_offset = f64::INFINITY;
        for (normal, offset) in part.iter() {
            (low, high) = (low.min(*normal), high.max(*normal));
            least_offset = least_offset.min(offset - normal.dot(center));
        }
        let number = self.nodes.len();
        self.nodes.push(Node { planes: range.clone(), low, high, least_offset, second: None });
        if range.len() <= MAX_LEAF_PLANES {
            return;
        }
        let axis = (high - low).max_position();
        let half = range.len() / 2;
        part.select_nth_unstable_by(half, |a, b| a.0[axis].total_cmp(&b.0[axis]));
        let middle = range.start + half;
        self.build_node(range.start..middle);
        self.nodes[number].second = Some(self.nodes.len());
        self.build_node(middle..range.end);
    }

    /// Returns the minimum over all planes of the depth of the point `p`. If a depth found earlier is not greater
    /// than `enough`, the search stops and returns the least depth found until then.
    ///
    /// `near` is the plane to begin with, as its position in the order of the tree. Position 0 is valid if there
    /// are planes. `near` is set to the plane with the returned depth. The number of visited planes and nodes is
    /// added to `looks`.
    pub fn least_depth(&self, p: DVec3, enough: f64, near: &mut usize, looks: &mut usize) -> f64 {
        let depth = |plane: usize| self.planes[plane].1 - self.planes[plane].0.dot(p);
        let ray = p - self.center;
        let bound = |node: usize| {
            let node = &self.nodes[node];
            let highest = (node.low * ray).max(node.high * ray).element_sum();
            node.least_offset - highest - self.slack
        };
        let mut least = depth(*near);
        let (mut stack, mut visits) = (vec![0], 1);
        while let Some(number) = stack.pop().filter(|_| least > enough) {
            visits += 1;
            if bound(number) >= least {
                continue;
            }
            let node = &self.nodes[number];
            let Some(second) = node.second else {
                visits += node.planes.len();
                for plane in node.planes.clone() {
                    let depth = depth(plane);
                    if depth < least {
                        (least, *near) = (depth, plane);
                    }
                }
                continue;
            };
            let children = [second, number + 1];
            let is_second_deeper = bound(second) > bound(number + 1);
            stack.extend(if is_second_deeper { children } else { [number + 1, second] });
        }
        visit_counter::count_visits(visits);
        *looks += visits;
        least
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use colltrans_testkit::random::Random;

    #[test]
    fn least_depth_is_the_minimum_over_all_planes() {
        let mut random = Random::new(3);
        for at in [0.0, 1e3, 5e6] {
            let center = random.vector() * at;
            let vertices: Vec<DVec3> = (0..300).map(|_| center + random.direction()).collect();
            let planes: Vec<(DVec3, f64)> = (0..300)
                .map(|_| random.direction())
                .map(|normal| {
                    let heights = vertices.iter().map(|v| normal.dot(*v));
                    (normal, heights.fold(f64::NEG_INFINITY, f64::max))
                })
                .collect();
            let tree = PlaneTree::new(&vertices, planes.clone());
            let mut near = 0;
            for _ in 0..300 {
                let p = center + random.direction() * random.range(0.0, 1.0);
                let all = planes.iter().map(|(normal, offset)| offset - normal.dot(p));
                let least = all.fold(f64::INFINITY, f64::min);
                assert_eq!(tree.least_depth(p, f64::NEG_INFINITY, &mut near, &mut 0), least);
                let found = tree.least_depth(p, 0.5, &mut near, &mut 0);
                assert!(found == least || (least..=0.5).contains(&found), "{found} {least}");
            }
        }
    }
}
