//! Parts that can leave alone, ranked by what it costs to take them away.
//!
//! The cost of a way has a share of its own, which changes only with what is near the part, and one that depends on the
//! direction, on whether the step before took another shape, and on whether all of its shape can leave. So ways for which
//! the second share is the same are sorted by the first one, and the best of all is among the first ones of each of these
//! classes. A step costs a look at the classes and at the parts whose own share it changes, not at all parts.

use std::collections::{BTreeMap, BTreeSet};

/// Costs that differ by less are equal: far more than the rounding of a sum, far less than any choice differs by.
const EQUAL: f64 = 1e-9;

/// Checks whether a way is better than the best of those before it.
pub(super) fn is_better(cost: f64, best: Option<f64>) -> bool {
    best.is_none_or(|best| cost < best - EQUAL)
}

/// The position of a way's direction, and its own share of the cost, which is not negative.
pub(super) type OwnCost = (usize, f64);

/// How the shape of a part compares with others.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ShapeState {
    /// Whether the step before took another shape.
    pub(super) other: bool,
    /// Whether all parts of this shape can leave.
    pub(super) all: bool,
}

/// Ways along one direction: by the bits of their own share of the cost, which are in the order of the numbers, each part
/// with the position of the way among its ways.
#[derive(Default)]
struct Class(BTreeMap<u64, BTreeSet<(usize, usize)>>);

impl Class {
    fn insert(&mut self, own: f64, way: (usize, usize)) {
        self.0.entry(own.to_bits()).or_default().insert(way);
    }

    fn remove(&mut self, own: f64, way: (usize, usize)) {
        if let Some(equal) = self.0.get_mut(&own.to_bits()) {
            equal.remove(&way);
            if equal.is_empty() {
                self.0.remove(&own.to_bits());
            }
        }
    }
}

/// The ways of parts that can leave alone.
#[derive(Default)]
pub(super) struct Ranking {
    /// By whether all of their shape can leave, and by direction.
    ways: BTreeMap<(bool, usize), Class>,
    /// The same ways by shape and direction.
    of_shape: BTreeMap<(usize, usize), Class>,
    /// By part, its shape and ways.
    parts: BTreeMap<usize, (usize, Vec<OwnCost>)>,
    /// By shape, its parts, and whether all can leave.
    shapes: BTreeMap<usize, (BTreeSet<usize>, bool)>,
}

impl Ranking {
    /// Adds a part of a shape with its ways.
    pub(super) fn insert(&mut self, part: usize, shape: usize, ways: Vec<OwnCost>) {
        let (parts, all) = self.shapes.entry(shape).or_default();
        parts.insert(part);
        for (at, &(direction, own)) in ways.iter().enumerate() {
            self.ways.entry((*all, direction)).or_default().insert(own, (part, at));
            self.of_shape.entry((shape, direction)).or_default().insert(own, (part, at));
        }
        self.parts.insert(part, (shape, ways));
    }

    /// Takes a part away, if it is there.
    pub(super) fn remove(&mut self, part: usize) {
        let Some((shape, ways)) = self.parts.remove(&part) else { return };
        let (parts, all) = self.shapes.entry(shape).or_default();
        parts.remove(&part);
        for (at, (direction, own)) in ways.into_iter().enumerate() {
            self.ways.entry((*all, direction)).or_default().remove(own, (part, at));
            self.of_shape.entry((shape, direction)).or_default().remove(own, (part, at));
        }
    }

    /// Updates whether all parts of a shape can leave, of which there are `count`.
    pub(super) fn set_count(&mut self, shape: usize, count: usize) {
        let (parts, all) = self.shapes.entry(shape).or_default();
        let can_all = parts.len() >= count;
        if *all == can_all {
            return;
        }
        // Ways move to another class; mostly this happens once to each shape.
        let ways = |part: &usize| Some((*part, self.parts.get(part)?.1.clone()));
        let moved: Vec<(usize, Vec<OwnCost>)> = parts.iter().filter_map(ways).collect();
        for (part, _) in &moved {
            self.remove(*part);
        }
        self.shapes.entry(shape).or_default().1 = can_all;
        for (part, ways) in moved {
            self.insert(part, shape, ways);
        }
    }

    /// Returns the best part and the position of its direction, as a scan of all parts in order would find them in which
    /// a way has to be [better](is_better) than the best before it. `last` is the shape that was taken last; `cost` grows
    /// with the own share of a way, and is larger by far more than [`EQUAL`] for another shape.
    ///
    /// The scan ends with one of the ways whose costs follow each other from the least one in steps of no more than
    /// twice [`EQUAL`]: the first of these is better than any other way. Of several with one own share the first counts.
    pub(super) fn best(
        &self,
        last: Option<usize>,
        cost: impl Fn(ShapeState, OwnCost) -> f64,
    ) -> Option<(usize, usize)> {
        // Ways of the last shape are listed twice: as of another shape they cost more than as they are, and do not count.
        let listed = self.ways.iter().map(|(&(all, direction), class)| {
            (ShapeState { other: last.is_some(), all }, direction, class)
        });
        let of_last = last.map(|last| self.of_shape.range((last, 0)..=(last, usize::MAX)));
        let of_last = of_last.into_iter().flatten().map(|(&(_, direction), class)| {
            (ShapeState { other: false, all: true }, direction, class)
        });
        let cost = &cost;
        let mut classes: Vec<_> = Vec::new();
        for (state, direction, Class(class)) in listed.chain(of_last) {
            let ways = class.iter().filter_map(move |(&own, equal)| {
                let &first = equal.first()?;
                Some((cost(state, (direction, f64::from_bits(own))), first, direction))
            });
            classes.push(ways.peekable());
        }
        let mut near: Vec<(f64, (usize, usize), usize)> = Vec::new();
        loop {
            let least = classes.iter_mut().filter_map(|ways| Some((ways.peek()?.0, ways)));
            let Some((cost, ways)) = least.min_by(|a, b| a.0.total_cmp(&b.0)) else { break };
            if near.last().is_some_and(|most| cost > most.0 + 3.0 * EQUAL) {
                break;
            }
            near.extend(ways.next());
        }
        near.sort_unstable_by_key(|way| way.1);
        let mut best: Option<(f64, usize, usize)> = None;
        for (cost, (part, _), direction) in near {
            if is_better(cost, best.map(|best| best.0)) {
                best = Some((cost, part, direction));
            }
        }
        best.map(|(_, part, direction)| (part, direction))
    }
}

#[cfg(test)]
mod tests {
    use colltrans_testkit::random::Random;

    use super::*;

    /// The best of all parts that are there, one by one.
    fn scanned(
        all: &BTreeMap<usize, (usize, Vec<OwnCost>)>,
        cost: impl Fn(usize, OwnCost) -> f64,
    ) -> Option<(usize, usize)> {
        let mut best: Option<(f64, usize, usize)> = None;
        for (&part, (shape, ways)) in all {
            for &way in ways {
                let cost = cost(*shape, way);
                if is_better(cost, best.map(|best| best.0)) {
                    best = Some((cost, part, way.0));
                }
            }
        }
        best.map(|(_, part, direction)| (part, direction))
    }

    #[test]
    fn the_best_of_all_is_that_of_a_scan_also_where_costs_nearly_equal_each_other() {
        let mut random = Random::new(21);
        for round in 0..400 {
            let (mut ranking, mut all) = (Ranking::default(), BTreeMap::new());
            // Costs of few values, or in steps of about what counts as equal.
            let step = [0.1, 0.4e-9, 0.9e-9, 1.1e-9, 1e-16][round % 5];
            let along: Vec<f64> = (0..4).map(|_| [0.0, 0.3, 0.4e-9][random.index(3)]).collect();
            let cost = |ShapeState { other, all }: ShapeState, (k, own): OwnCost| {
                own + along[k]
                    + if other { 0.8 } else { 0.0 }
                    + if other && !all { 0.4 } else { 0.0 }
            };
            for _ in 0..60 {
                let part = random.index(30);
                ranking.remove(part);
                all.remove(&part);
                if random.unit() < 0.7 {
                    let mut own = || 0.5 + step * random.index(12) as f64;
                    let mut ways: Vec<OwnCost> = (0..4).map(|k| (k, own())).collect();
                    ways.retain(|_| random.unit() < 0.5);
                    ranking.insert(part, part % 3, ways.clone());
                    all.insert(part, (part % 3, ways));
                }
                let can_all: Vec<bool> = (0..3)
                    .map(|shape| {
                        let (there, count) = (all.values().filter(|x| x.0 == shape), 3 + 2 * shape);
                        ranking.set_count(shape, count);
                        there.count() >= count
                    })
                    .collect();
                let last = [None, Some(0), Some(1), Some(7)][random.index(4)];
                let expected = scanned(&all, |shape, way| {
                    let other = last.is_some_and(|last| last != shape);
                    cost(ShapeState { other, all: can_all[shape] }, way)
                });
                assert_eq!(ranking.best(last, cost), expected, "round {round}");
            }
        }
    }
}
