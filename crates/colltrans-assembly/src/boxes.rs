//! A bounding volume tree over axis-aligned boxes.
//!
//! A box `A` swept along `d` meets `B` at the translations `t` for which `t d` is in the box `B - A` (the
//! Minkowski difference). This is one slab test. Contacts of faces count, and the test allows for its own
//! rounding, so that it never misses a pair.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use colltrans::Aabb;
use glam::DVec3;

/// Returns a lower bound of the least translation `t >= 0` along `d` at which a box meets another one; `None`
/// if it never does.
pub(crate) fn entry_translation(moving: &Aabb, other: &Aabb, d: DVec3) -> Option<f64> {
    let size = moving.low.abs().max(moving.high.abs()).max(other.low.abs()).max(other.high.abs());
    let slack = 8.0 * f64::EPSILON * size.max_element();
    let (low, high) = (other.low - moving.high - slack, other.high - moving.low + slack);
    first_meeting([0, 1, 2].map(|k| ([low[k], high[k]], d[k])))
}

/// Returns a lower bound of the least translation `t >= 0` at which all moving intervals meet their fixed ones. Each
/// item holds the range of displacements at which two intervals meet, and the speed. Returns `None` if no translation
/// satisfies all items.
pub(crate) fn first_meeting(gaps: impl IntoIterator<Item = ([f64; 2], f64)>) -> Option<f64> {
    let (mut enter, mut leave) = (0.0_f64, f64::INFINITY);
    for ([low, high], speed) in gaps {
        if speed == 0.0 {
            if low > 0.0 || high < 0.0 {
                return None;
            }
            continue;
        }
        let (x, y) = (low / speed, high / speed);
        enter = enter.max(x.min(y));
        leave = leave.min(x.max(y));
    }
    (enter <= leave * (1.0 + 8.0 * f64::EPSILON)).then_some(enter * (1.0 - 8.0 * f64::EPSILON))
}

/// Returns the minimum and maximum of some numbers; without numbers, `[infinity, -infinity]`.
pub(crate) fn value_range(values: impl IntoIterator<Item = f64>) -> [f64; 2] {
    let none = [f64::INFINITY, f64::NEG_INFINITY];
    values.into_iter().fold(none, |[low, high], x| [low.min(x), high.max(x)])
}

/// Maximum number of boxes in a leaf.
const LEAF: usize = 4;

struct Node {
    bounds: Aabb,
    /// Offset of the second child from this node; 0 for a leaf. The first child follows this node.
    skip: usize,
    first: usize,
    count: usize,
}

/// Tree over boxes, split at the median along the axis in which their centres spread most.
pub(crate) struct BoxTree {
    nodes: Vec<Node>,
    /// Boxes with their indices, in the order of the leaves.
    items: Vec<(Aabb, usize)>,
    /// For each index, the position among the items.
    position_of: Vec<usize>,
}

/// Subset of the boxes of a tree, from which boxes are removed.
pub(crate) struct RemainingBoxes {
    /// For each node, the number of remaining boxes below it.
    under: Vec<usize>,
    /// For each index, whether the box remains.
    there: Vec<bool>,
}

impl RemainingBoxes {
    /// Checks whether a box remains.
    pub(crate) fn contains(&self, number: usize) -> bool {
        self.there[number]
    }

    /// Returns for each index whether the box remains.
    pub(crate) fn remaining_flags(&self) -> &[bool] {
        &self.there
    }
}

impl BoxTree {
    /// Builds the tree; the index of a box is its position in `boxes`.
    pub(crate) fn new(boxes: impl IntoIterator<Item = Aabb>) -> Self {
        let items = boxes.into_iter().enumerate().map(|(k, b)| (b, k)).collect();
        let mut tree = Self { nodes: Vec::new(), items, position_of: Vec::new() };
        let count = tree.items.len();
        if count > 0 {
            tree.build_subtree(0, count);
        }
        tree.position_of = vec![0; count];
        for (at, item) in tree.items.iter().enumerate() {
            tree.position_of[item.1] = at;
        }
        tree
    }

    /// Returns the subset of boxes whose entry in `there` is `true`.
    pub(crate) fn remaining_boxes(&self, there: &[bool]) -> RemainingBoxes {
        let count = |node: &Node| {
            let items = &self.items[node.first..node.first + node.count];
            items.iter().filter(|item| there[item.1]).count()
        };
        RemainingBoxes { under: self.nodes.iter().map(count).collect(), there: there.to_vec() }
    }

    /// Removes a box from the subset. Takes time proportional to the depth of the tree.
    pub(crate) fn remove(&self, living: &mut RemainingBoxes, number: usize) {
        if !std::mem::take(&mut living.there[number]) {
            return;
        }
        let mut at = 0;
        loop {
            living.under[at] -= 1;
            let skip = self.nodes[at].skip;
            if skip == 0 {
                return;
            }
            let second = self.position_of[number] >= self.nodes[at + skip].first;
            at += if second { skip } else { 1 };
        }
    }

    /// Calls `call` with the remaining boxes that `moving` meets along `d` and a lower bound of the
    /// translation, until a call returns `true`. Returns the index of that box; `None` if no call returns
    /// `true`.
    ///
    /// The order is best first: the nearest box first, and among equal bounds the one with the smaller index.
    /// Only nodes along the paths to these boxes are visited.
    pub(crate) fn first_ahead(
        &self,
        living: &RemainingBoxes,
        moving: &Aabb,
        d: DVec3,
        mut call: impl FnMut(f64, usize) -> bool,
    ) -> Option<usize> {
        // Bounds are not negative, so their bit patterns are ordered like their values. Nodes precede boxes
        // with the same bound.
        let mut open = BinaryHeap::new();
        let key = |bound: f64| bound.abs().to_bits();
        let add = |open: &mut BinaryHeap<_>, at: usize| {
            let bound = entry_translation(moving, &self.nodes[at].bounds, d);
            if let Some(bound) = bound.filter(|_| living.under[at] > 0) {
                open.push(Reverse((key(bound), false, at)));
            }
        };
        if !self.nodes.is_empty() {
            add(&mut open, 0);
        }
        while let Some(Reverse((bound, is_box, at))) = open.pop() {
            if is_box {
                if call(f64::from_bits(bound), at) {
                    return Some(at);
                }
                continue;
            }
            let node = &self.nodes[at];
            if node.skip > 0 {
                add(&mut open, at + 1);
                add(&mut open, at + node.skip);
                continue;
            }
            for (bounds, number) in &self.items[node.first..node.first + node.count] {
                let bound =
                    entry_translation(moving, bounds, d).filter(|_| living.contains(*number));
                open.extend(bound.map(|bound| Reverse((key(bound), true, *number))));
            }
        }
        None
    }

    /// Computes for each node the bounds of other boxes, given by index, that take the place of the boxes
    /// below it.
    pub(crate) fn bounds_of(&self, boxes: &[Aabb]) -> Vec<Aabb> {
        let mut bounds = vec![Aabb::EMPTY; self.nodes.len()];
        for (at, node) in self.nodes.iter().enumerate().rev() {
            bounds[at] = if node.skip > 0 {
                bounds[at + 1].union(&bounds[at + node.skip])
            } else {
                let items = &self.items[node.first..node.first + node.count];
                items.iter().fold(Aabb::EMPTY, |all, item| all.union(&boxes[item.1]))
            };
        }
        bounds
    }

    /// Calls `call` with the index of each remaining box below nodes whose `bounds`, computed by
    /// [`bounds_of`](Self::bounds_of), satisfy `wanted`. Visits first the child that extends further along
    /// the third axis.
    pub(crate) fn visit_high(
        &self,
        living: &RemainingBoxes,
        bounds: &[Aabb],
        wanted: impl Fn(&Aabb) -> bool,
        mut call: impl FnMut(usize),
    ) {
        let mut stack = if self.nodes.is_empty() { Vec::new() } else { vec![0] };
        while let Some(at) = stack.pop() {
            if living.under[at] == 0 || !wanted(&bounds[at]) {
                continue;
            }
            let node = &self.nodes[at];
            if node.skip == 0 {
                let items = self.items[node.first..node.first + node.count].iter();
                items.filter(|item| living.contains(item.1)).for_each(|item| call(item.1));
                continue;
            }
            let [first, second] = [at + 1, at + node.skip];
            let is_first_higher = bounds[first].high.z > bounds[second].high.z;
            stack.extend(if is_first_higher { [second, first] } else { [first, second] });
        }
    }

    /// Builds the subtree of a range of items.
    fn build_subtree(&mut self, first: usize, count: usize) {
        let at = self.nodes.len();
        let items = &mut self.items[first..first + count];
        let bounds = items.iter().map(|i| i.0).reduce(|a, b| a.union(&b)).unwrap_or(items[0].0);
        self.nodes.push(Node { bounds, skip: 0, first, count });
        if count <= LEAF {
            return;
        }
        let centers = Aabb::from_points(items.iter().map(|i| i.0.center()));
        let axis = (centers.high - centers.low).max_position();
        let half = count / 2;
        items.select_nth_unstable_by(half, |a, b| {
            a.0.center()[axis].total_cmp(&b.0.center()[axis]).then(a.1.cmp(&b.1))
        });
        self.build_subtree(first, half);
        self.nodes[at].skip = self.nodes.len() - at;
        self.build_subtree(first + half, count - half);
    }

    /// Calls `call` for each box that satisfies `wanted`, if the bounds of all nodes above it satisfy
    /// `wanted` too.
    pub(crate) fn visit(
        &self,
        mut wanted: impl FnMut(&Aabb) -> bool,
        mut call: impl FnMut(&Aabb, usize),
    ) {
        let mut stack = if self.nodes.is_empty() { Vec::new() } else { vec![0] };
        while let Some(at) = stack.pop() {
            let node = &self.nodes[at];
            if !wanted(&node.bounds) {
                continue;
            }
            if node.skip == 0 {
                for (bounds, k) in &self.items[node.first..node.first + node.count] {
                    if wanted(bounds) {
                        call(bounds, *k);
                    }
                }
            } else {
                stack.push(at + node.skip);
                stack.push(at + 1);
            }
        }
    }

    /// Returns the indices of the boxes that intersect `query`, in increasing order.
    pub(crate) fn intersecting(&self, query: &Aabb) -> Vec<usize> {
        let mut found = Vec::new();
        self.visit(|b| b.intersects(query), |_, k| found.push(k));
        found.sort_unstable();
        found
    }

    /// Returns the boxes that `moving` meets along `d`, each as a lower bound of the translation and its
    /// index, nearest first.
    pub(crate) fn boxes_ahead(&self, moving: &Aabb, d: DVec3) -> Vec<(f64, usize)> {
        let mut found = Vec::new();
        let wanted = |b: &Aabb| entry_translation(moving, b, d).is_some();
        self.visit(wanted, |b, k| found.extend(entry_translation(moving, b, d).map(|t| (t, k))));
        found.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        found
    }
}

#[cfg(test)]
mod tests {
    use colltrans_testkit::random::Random;

    use super::*;

    fn random_box(random: &mut Random, snapped: bool) -> Aabb {
        let mut point = |scale: f64| {
            let p = DVec3::from_array([0; 3].map(|_| scale * (random.unit() - 0.5)));
            if snapped { p.round() } else { p }
        };
        let (low, size) = (point(20.0), point(6.0).abs());
        Aabb { low, high: low + size }
    }

    #[test]
    fn tree_queries_equal_linear_scans() {
        let mut random = Random::new(7);
        for round in 0..200 {
            let snapped = round % 2 == 0;
            let boxes: Vec<Aabb> = (0..round).map(|_| random_box(&mut random, snapped)).collect();
            let tree = BoxTree::new(boxes.iter().copied());
            let query = random_box(&mut random, snapped);
            let d = if snapped { DVec3::AXES[round % 3] } else { random.direction() };
            let listed: Vec<usize> = (0..round).filter(|&k| boxes[k].intersects(&query)).collect();
            assert_eq!(tree.intersecting(&query), listed);
            let mut boxes_ahead: Vec<usize> =
                tree.boxes_ahead(&query, d).iter().map(|x| x.1).collect();
            boxes_ahead.sort_unstable();
            let swept: Vec<usize> =
                (0..round).filter(|&k| entry_translation(&query, &boxes[k], d).is_some()).collect();
            assert_eq!(boxes_ahead, swept);
            // The best-first order, while boxes are removed one by one.
            let mut there: Vec<bool> = (0..round).map(|_| random.unit() < 0.7).collect();
            let mut living = tree.remaining_boxes(&there);
            loop {
                let mut called = Vec::new();
                tree.first_ahead(&living, &query, d, |bound, k| {
                    called.push((bound, k));
                    false
                });
                let mut expected = tree.boxes_ahead(&query, d);
                expected.retain(|x| there[x.1]);
                assert_eq!(called, expected);
                let Some(gone) = (0..round).find(|&k| there[k]) else { break };
                there[gone] = false;
                tree.remove(&mut living, gone);
            }
        }
    }

    #[test]
    fn highest_remaining_box_equals_linear_scan() {
        let mut random = Random::new(9);
        for round in 1..200 {
            let boxes: Vec<Aabb> = (0..round).map(|_| random_box(&mut random, false)).collect();
            let tree = BoxTree::new(boxes.iter().copied());
            // Other boxes with the same indices, as of parts in the frame of a direction.
            let rotated: Vec<Aabb> = (0..round).map(|_| random_box(&mut random, false)).collect();
            let bounds = tree.bounds_of(&rotated);
            let there: Vec<bool> = (0..round).map(|_| random.unit() < 0.7).collect();
            let (living, query) = (tree.remaining_boxes(&there), random_box(&mut random, false));
            let over =
                |b: &Aabb| (0..2).all(|k| b.low[k] <= query.high[k] && query.low[k] <= b.high[k]);
            let best = std::cell::Cell::new(f64::NEG_INFINITY);
            let higher = |b: &Aabb| over(b) && b.high.z > best.get();
            tree.visit_high(&living, &bounds, higher, |k| {
                assert!(there[k]);
                if higher(&rotated[k]) {
                    best.set(rotated[k].high.z);
                }
            });
            let all = (0..round).filter(|&k| there[k] && over(&rotated[k]));
            let expected = all.map(|k| rotated[k].high.z).fold(f64::NEG_INFINITY, f64::max);
            assert_eq!(best.get(), expected);
        }
    }

    #[test]
    fn entry_translation_equals_first_contact_of_small_steps() {
        let mut random = Random::new(8);
        for round in 0..400 {
            let snapped = round % 2 == 0;
            let (a, b) = (random_box(&mut random, snapped), random_box(&mut random, snapped));
            let d = if snapped { DVec3::AXES[round % 3] } else { random.direction() };
            let moved = |t: f64| Aabb { low: a.low + d * t, high: a.high + d * t };
            let stepped =
                (0..60_000).map(|k| f64::from(k) * 1e-3).find(|&t| moved(t).intersects(&b));
            match (entry_translation(&a, &b, d), stepped) {
                (Some(t), Some(s)) => assert!((t - s).abs() < 1.1e-3, "{t} {s}"),
                (None, None) => (),
                // Only corners meet, between two steps.
                (Some(t), None) => assert!(b.expanded(2e-3).intersects(&moved(t))),
                (None, Some(s)) => panic!("missed at {s}"),
            }
        }
    }
}
