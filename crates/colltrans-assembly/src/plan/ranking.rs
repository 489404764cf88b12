//! Parts that can leave alone, ranked by the cost of their removal.
//!
//! The cost of a removal has two terms. The *own* cost changes only with parts nearby. The other term depends on the
//! direction, on whether the step before removed another shape, and on whether all parts of the shape can leave.
//! Removals with an equal second term form a class, sorted by own cost. The best removal is therefore among the first
//! of each class. A step examines the classes and the parts whose own cost it changes, not all parts.

use std::collections::{BTreeMap, BTreeSet};

/// Costs that differ by less than this are equal. This is far above the rounding of a sum and far below any real
/// difference.
const EQUAL: f64 = 1e-9;

/// Checks whether a removal is better than the best one before it.
pub(super) fn is_better(cost: f64, best: Option<f64>) -> bool {
    best.is_none_or(|best| cost < best - EQUAL)
}

/// The index of a direction, and the own cost of the removal along it, which is not negative.
pub(super) type OwnCost = (usize, f64);

/// The state of a shape that affects the cost.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ShapeState {
    /// Whether the step before removed another shape.
    pub(super) other: bool,
    /// Whether all parts of this shape can leave.
    pub(super) all: bool,
}

/// Removals along one direction that have the same cost apart from the own cost. The key is the bit pattern of the own
/// cost, which sorts like the number because the own cost is not negative. Each entry is a part and the index of the
/// removal in the list of the part.
#[derive(Default)]
struct CostClass(BTreeMap<u64, BTreeSet<(usize, usize)>>);

impl CostClass {
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

/// The removals of parts that can leave alone.
#[derive(Default)]
pub(super) struct Ranking {
    /// Classes by whether all parts of the shape can leave, and by direction.
    ways: BTreeMap<(bool, usize), CostClass>,
    /// Classes of the same removals by shape and direction.
    of_shape: BTreeMap<(usize, usize), CostClass>,
    /// For each part, its shape and removals.
    parts: BTreeMap<usize, (usize, Vec<OwnCost>)>,
    /// For each shape, its parts, and whether all can leave.
    shapes: BTreeMap<usize, (BTreeSet<usize>, bool)>,
}

impl Ranking {
    /// Adds a part of a shape with its removals.
    pub(super) fn insert(&mut self, part: usize, shape: usize, ways: Vec<OwnCost>) {
        let (parts, all) = self.shapes.entry(shape).or_default();
        parts.insert(part);
        for (at, &(direction, own)) in ways.iter().enumerate() {
            self.ways.entry((*all, direction)).or_default().insert(own, (part, at));
            self.of_shape.entry((shape, direction)).or_default().insert(own, (part, at));
        }
        self.parts.insert(part, (shape, ways));
    }

    /// Removes a part if it is ranked.
    pub(super) fn remove(&mut self, part: usize) {
        let Some((shape, ways)) = self.parts.remove(&part) else { return };
        let (parts, all) = self.shapes.entry(shape).or_default();
        parts.remove(&part);
        for (at, (direction, own)) in ways.into_iter().enumerate() {
            self.ways.entry((*all, direction)).or_default().remove(own, (part, at));
            self.of_shape.entry((shape, direction)).or_default().remove(own, (part, at));
        }
    }

    /// Updates whether all `count` parts of a shape can leave.
    pub(super) fn set_count(&mut self, shape: usize, count: usize) {
        let (parts, all) = self.shapes.entry(shape).or_default();
        let can_all = parts.len() >= count;
        if *all == can_all {
            return;
        }
        // Removals move to another class. Mostly this happens once for each shape.
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

    /// Returns the best part and the index of its direction. Returns `None` if no part is ranked.
    ///
    /// The reference is a scan over all parts in order, in which a removal replaces the best one if it is
    /// [better](is_better). This search has the same result. It examines only the removals whose costs follow the
    /// least one in small steps, because the scan ends with one of them (`docs/theory/disassembly.md`). Of several
    /// removals of a class with equal own cost, only the first is examined. `last` is the shape of the step before.
    /// `cost` must increase with the own cost. For another shape than `last` it must be larger by far more than
    /// [`EQUAL`].
    pub(super) fn best_removal(
        &self,
        last: Option<usize>,
        cost: impl Fn(ShapeState, OwnCost) -> f64,
    ) -> Option<(usize, usize)> {
        // Removals of the last shape are listed twice. As those of another shape they cost more and are never chosen.
        let listed = self.ways.iter().map(|(&(all, direction), class)| {
            (ShapeState { other: last.is_some(), all }, direction, class)
        });
        let of_last = last.map(|last| self.of_shape.range((last, 0)..=(last, usize::MAX)));
        let of_last = of_last.into_iter().flatten().map(|(&(_, direction), class)| {
            (ShapeState { other: false, all: true }, direction, class)
        });
        let cost = &cost;
        let mut classes: Vec<_> = Vec::new();
        for (state, direction, CostClass(class)) in listed.chain(of_last) {
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

    /// Returns the best of all parts by a scan.
    fn best_by_scan(
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
    fn best_removal_equals_scan_for_nearly_equal_costs() {
        let mut random = Random::new(21);
        for round in 0..400 {
            let (mut ranking, mut all) = (Ranking::default(), BTreeMap::new());
            // Costs take few values, or differ by about the limit of equality.
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
                let expected = best_by_scan(&all, |shape, way| {
                    let other = last.is_some_and(|last| last != shape);
                    cost(ShapeState { other, all: can_all[shape] }, way)
                });
                assert_eq!(ranking.best_removal(last, cost), expected, "round {round}");
            }
        }
    }
}
