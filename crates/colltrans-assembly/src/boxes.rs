//! A tree over boxes along the axes.
//!
//! A box `A` swept along `d` meets `B` at the translations `t` for which `t d` lies in the box
//! `B - A` (Minkowski difference): one slab test. Faces that only touch count, and the test allows
//! for its own rounding, so that it never loses a pair.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use colltrans::Aabb;
use glam::DVec3;

/// The least translation `t >= 0` along `d` at which a box meets another, from below.
pub(crate) fn entry(moving: &Aabb, other: &Aabb, d: DVec3) -> Option<f64> {
    let size = moving.low.abs().max(moving.high.abs()).max(other.low.abs()).max(other.high.abs());
    let slack = 8.0 * f64::EPSILON * size.max_element();
    let (low, high) = (other.low - moving.high - slack, other.high - moving.low + slack);
    first_meeting([0, 1, 2].map(|k| ([low[k], high[k]], d[k])))
}

/// The least translation, from below, at which intervals that move each meet another one, which is from `low` to `high` away
/// from it; `None` if there is none at which all do.
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

/// The least and the largest of some numbers; of none, infinities the wrong way round.
pub(crate) fn span(values: impl IntoIterator<Item = f64>) -> [f64; 2] {
    let none = [f64::INFINITY, f64::NEG_INFINITY];
    values.into_iter().fold(none, |[low, high], x| [low.min(x), high.max(x)])
}

const LEAF: usize = 4;

struct Node {
    bounds: Aabb,
    /// The second child is so far behind; 0 for a leaf.
    skip: usize,
    first: usize,
    count: usize,
}

/// A tree over boxes, halved along the longest side of their centres.
pub(crate) struct BoxTree {
    nodes: Vec<Node>,
    /// Boxes and their numbers, in the order of the leaves.
    items: Vec<(Aabb, usize)>,
    /// By number, the position among the items.
    place: Vec<usize>,
}

/// Some of the boxes of a tree, which become fewer.
pub(crate) struct Living {
    /// By node of the tree, how many of its boxes are left.
    under: Vec<usize>,
    /// By number of a box.
    there: Vec<bool>,
}

impl Living {
    /// Checks whether a box is left.
    pub(crate) fn has(&self, number: usize) -> bool {
        self.there[number]
    }

    /// Returns by number whether a box is left.
    pub(crate) fn there(&self) -> &[bool] {
        &self.there
    }
}

impl BoxTree {
    pub(crate) fn new(boxes: impl IntoIterator<Item = Aabb>) -> Self {
        let items = boxes.into_iter().enumerate().map(|(k, b)| (b, k)).collect();
        let mut tree = Self { nodes: Vec::new(), items, place: Vec::new() };
        let count = tree.items.len();
        if count > 0 {
            tree.grow(0, count);
        }
        tree.place = vec![0; count];
        for (at, item) in tree.items.iter().enumerate() {
            tree.place[item.1] = at;
        }
        tree
    }

    /// Returns the boxes that are `true`.
    pub(crate) fn living(&self, there: &[bool]) -> Living {
        let count = |node: &Node| {
            let items = &self.items[node.first..node.first + node.count];
            items.iter().filter(|item| there[item.1]).count()
        };
        Living { under: self.nodes.iter().map(count).collect(), there: there.to_vec() }
    }

    /// Takes a box away from those that are left.
    pub(crate) fn remove(&self, living: &mut Living, number: usize) {
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
            let second = self.place[number] >= self.nodes[at + skip].first;
            at += if second { skip } else { 1 };
        }
    }

    /// Calls with the boxes that are left and that `moving` meets along `d`, and with a lower bound of where, nearest first
    /// and of equal ones by number, until a call returns `true`; returns the number of that box.
    ///
    /// Best first over the tree: what is not called with costs a look at the nodes beside the way to what is.
    pub(crate) fn first_ahead(
        &self,
        living: &Living,
        moving: &Aabb,
        d: DVec3,
        mut call: impl FnMut(f64, usize) -> bool,
    ) -> Option<usize> {
        // Bounds are not negative, so they are in the order of their bits; nodes come before boxes.
        let mut open = BinaryHeap::new();
        let key = |bound: f64| bound.abs().to_bits();
        let add = |open: &mut BinaryHeap<_>, at: usize| {
            let bound = entry(moving, &self.nodes[at].bounds, d);
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
                let bound = entry(moving, bounds, d).filter(|_| living.has(*number));
                open.extend(bound.map(|bound| Reverse((key(bound), true, *number))));
            }
        }
        None
    }

    /// Computes for each node the box around others that have the numbers of its boxes.
    pub(crate) fn bounds_of(&self, boxes: &[Aabb]) -> Vec<Aabb> {
        let mut bounds = vec![Aabb::EMPTY; self.nodes.len()];
        for (at, node) in self.nodes.iter().enumerate().rev() {
            bounds[at] = if node.skip > 0 {
                bounds[at + 1].join(&bounds[at + node.skip])
            } else {
                let items = &self.items[node.first..node.first + node.count];
                items.iter().fold(Aabb::EMPTY, |all, item| all.join(&boxes[item.1]))
            };
        }
        bounds
    }

    /// Calls with the number of each box that is left under nodes for whose bounds, as of [`bounds_of`](Self::bounds_of),
    /// `wanted` holds; of two nodes first under the one that reaches further along the third axis.
    pub(crate) fn visit_high(
        &self,
        living: &Living,
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
                items.filter(|item| living.has(item.1)).for_each(|item| call(item.1));
                continue;
            }
            let [first, second] = [at + 1, at + node.skip];
            let is_first_higher = bounds[first].high.z > bounds[second].high.z;
            stack.extend(if is_first_higher { [second, first] } else { [first, second] });
        }
    }

    fn grow(&mut self, first: usize, count: usize) {
        let at = self.nodes.len();
        let items = &mut self.items[first..first + count];
        let bounds = items.iter().map(|i| i.0).reduce(|a, b| a.join(&b)).unwrap_or(items[0].0);
        self.nodes.push(Node { bounds, skip: 0, first, count });
        if count <= LEAF {
            return;
        }
        let centers = Aabb::of_points(items.iter().map(|i| i.0.center()));
        let axis = (centers.high - centers.low).max_position();
        let half = count / 2;
        items.select_nth_unstable_by(half, |a, b| {
            a.0.center()[axis].total_cmp(&b.0.center()[axis]).then(a.1.cmp(&b.1))
        });
        self.grow(first, half);
        self.nodes[at].skip = self.nodes.len() - at;
        self.grow(first + half, count - half);
    }

    /// Calls with the number of each box for which `wanted` holds, and holds for the boxes around.
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

    /// Numbers of boxes that meet `query`, in increasing order.
    pub(crate) fn meeting(&self, query: &Aabb) -> Vec<usize> {
        let mut found = Vec::new();
        self.visit(|b| b.meets(query), |_, k| found.push(k));
        found.sort_unstable();
        found
    }

    /// Numbers of boxes that `moving` meets along `d`, each with a lower bound of where, nearest
    /// first.
    pub(crate) fn ahead(&self, moving: &Aabb, d: DVec3) -> Vec<(f64, usize)> {
        let mut found = Vec::new();
        let wanted = |b: &Aabb| entry(moving, b, d).is_some();
        self.visit(wanted, |b, k| found.extend(entry(moving, b, d).map(|t| (t, k))));
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
    fn the_tree_finds_what_a_list_finds() {
        let mut random = Random::new(7);
        for round in 0..200 {
            let snapped = round % 2 == 0;
            let boxes: Vec<Aabb> = (0..round).map(|_| random_box(&mut random, snapped)).collect();
            let tree = BoxTree::new(boxes.iter().copied());
            let query = random_box(&mut random, snapped);
            let d = if snapped { DVec3::AXES[round % 3] } else { random.direction() };
            let listed: Vec<usize> = (0..round).filter(|&k| boxes[k].meets(&query)).collect();
            assert_eq!(tree.meeting(&query), listed);
            let mut ahead: Vec<usize> = tree.ahead(&query, d).iter().map(|x| x.1).collect();
            ahead.sort_unstable();
            let swept: Vec<usize> =
                (0..round).filter(|&k| entry(&query, &boxes[k], d).is_some()).collect();
            assert_eq!(ahead, swept);
            // And nearest first of those that are left, as they become fewer.
            let mut there: Vec<bool> = (0..round).map(|_| random.unit() < 0.7).collect();
            let mut living = tree.living(&there);
            loop {
                let mut called = Vec::new();
                tree.first_ahead(&living, &query, d, |bound, k| {
                    called.push((bound, k));
                    false
                });
                let mut expected = tree.ahead(&query, d);
                expected.retain(|x| there[x.1]);
                assert_eq!(called, expected);
                let Some(gone) = (0..round).find(|&k| there[k]) else { break };
                there[gone] = false;
                tree.remove(&mut living, gone);
            }
        }
    }

    #[test]
    fn the_highest_box_left_over_a_query_is_that_of_a_list() {
        let mut random = Random::new(9);
        for round in 1..200 {
            let boxes: Vec<Aabb> = (0..round).map(|_| random_box(&mut random, false)).collect();
            let tree = BoxTree::new(boxes.iter().copied());
            // Others of the same numbers, as of bodies seen along a direction.
            let seen: Vec<Aabb> = (0..round).map(|_| random_box(&mut random, false)).collect();
            let bounds = tree.bounds_of(&seen);
            let there: Vec<bool> = (0..round).map(|_| random.unit() < 0.7).collect();
            let (living, query) = (tree.living(&there), random_box(&mut random, false));
            let over =
                |b: &Aabb| (0..2).all(|k| b.low[k] <= query.high[k] && query.low[k] <= b.high[k]);
            let best = std::cell::Cell::new(f64::NEG_INFINITY);
            let higher = |b: &Aabb| over(b) && b.high.z > best.get();
            tree.visit_high(&living, &bounds, higher, |k| {
                assert!(there[k]);
                if higher(&seen[k]) {
                    best.set(seen[k].high.z);
                }
            });
            let all = (0..round).filter(|&k| there[k] && over(&seen[k]));
            let expected = all.map(|k| seen[k].high.z).fold(f64::NEG_INFINITY, f64::max);
            assert_eq!(best.get(), expected);
        }
    }

    #[test]
    fn a_box_enters_another_where_small_steps_first_meet_it() {
        let mut random = Random::new(8);
        for round in 0..400 {
            let snapped = round % 2 == 0;
            let (a, b) = (random_box(&mut random, snapped), random_box(&mut random, snapped));
            let d = if snapped { DVec3::AXES[round % 3] } else { random.direction() };
            let moved = |t: f64| Aabb { low: a.low + d * t, high: a.high + d * t };
            let stepped = (0..60_000).map(|k| f64::from(k) * 1e-3).find(|&t| moved(t).meets(&b));
            match (entry(&a, &b, d), stepped) {
                (Some(t), Some(s)) => assert!((t - s).abs() < 1.1e-3, "{t} {s}"),
                (None, None) => (),
                // Corners that pass between two steps.
                (Some(t), None) => assert!(b.grown(2e-3).meets(&moved(t))),
                (None, Some(s)) => panic!("missed at {s}"),
            }
        }
    }
}
