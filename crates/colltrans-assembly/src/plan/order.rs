//! Choice of the next step: which removable group leaves, and along which direction.
//!
//! - `up` is opposite to gravity. A part *rests on* the parts that block it at once along `-up`.
//! - A part *falls* if nothing that remains carries it. The lowest parts, the *base* and fixed parts never fall.
//! - The *travel* of a group along `d` is the distance after which it is beyond all remaining parts whose projected
//!   boxes overlap its own ([`Bodies::travel_beyond`]).
//!
//! A direction is considered if its travel is at most [`TRAVEL_SLACK`] times the shortest one, up to the noise. The
//! choice of least [cost](Order::step_cost) wins; ties go to the first part. Before a choice is accepted, samples of
//! the sphere are searched for a much shorter direction. `docs/theory/disassembly.md` lists the costs.

use std::collections::BTreeMap;

use colltrans::Bounded;
use colltrans::solid::StartOverlap;
use glam::DVec3;
use rayon::prelude::*;

use super::ranking::{OwnCost, ShapeState, is_better};
use super::shadow::Shadow;
use super::single::SingleParts;
use super::stability::{Stability, Support};
use crate::bodies::Bodies;
use crate::boxes::RemainingBoxes;
use crate::constraints::Constraints;
use crate::liaisons::contact_reach;
use crate::matrix::{ContactMatrix, direction_bits};
use crate::sphere::Sphere;
use crate::witness::Memory;

/// Maximum ratio of a considered travel to the shortest one.
const TRAVEL_SLACK: f64 = 1.1;
/// Ratio of travels above which a free direction with the shorter travel replaces the chosen one, ...
const SHORTCUT_RATIO: f64 = 1.5;
/// ... unless the chosen travel is at most this fraction of the assembly's size.
const SHORT_TRAVEL: f64 = 1e-3;
/// A part rests on the parts that block it within this multiple of the contact reach. Both are shrunk, and they may
/// touch at a slant.
const SUPPORT_REACH: f64 = 4.0;
/// Two directions are equal if their dot product exceeds this: 0.8 degrees.
const SAME_DIRECTION: f64 = 0.9999;

/// Costs that are added to the travel as a fraction of the assembly's size. For each part that falls, ...
const FALL_COST: f64 = 2.0;
/// ... for each part that is then off balance, ...
const TIP_COST: f64 = 1.0;
/// ... for another shape than in the step before, because it needs another tool, ...
const SHAPE_CHANGE_COST: f64 = 0.8;
/// ... in addition, if other parts of the new shape cannot leave yet, ...
const INCOMPLETE_SHAPE_COST: f64 = 0.4;
/// ... for another direction than in the step before, ...
const DIRECTION_CHANGE_COST: f64 = 0.3;
/// ... for a direction down (half of it for a horizontal one), ...
const DOWNWARD_COST: f64 = 0.3;
/// ... for a direction that is not along an axis of the world, ...
const OBLIQUE_COST: f64 = 0.2;
/// ... and for a group of all parts; a smaller group costs its fraction.
const GROUP_COST: f64 = 0.3;

/// The chosen group and its direction.
pub(super) struct GroupChoice {
    pub(super) parts: Vec<usize>,
    pub(super) direction: DVec3,
}

/// The state by which steps are chosen, for some of the parts.
pub(super) struct Order<'a> {
    bodies: &'a Bodies<'a>,
    /// The constraints of the assembly with preferred orders, from the most demanding one to none.
    preferred: Vec<&'a Constraints>,
    /// Position of the order that is demanded now.
    demanded: usize,
    up: DVec3,
    size: f64,
    /// For each part, the first part with the same shape.
    likes: &'a [usize],
    living: RemainingBoxes,
    /// For each shape (named by its first part), the number of present parts that may move.
    counts: Vec<usize>,
    /// Mask of the parts that do not move: the base, and parts that must not be moved.
    stationary: Vec<bool>,
    /// For each part, the parts that rest on it, of all parts.
    carried: Vec<Vec<usize>>,
    /// For each part, what it rests on; `None` if it cannot fall.
    supports: Vec<Option<Support>>,
    /// One for each direction; the directions of the matrix come first.
    shadows: Vec<Shadow>,
    last: Option<(DVec3, usize)>,
    shortcuts: Shortcuts,
    /// Parts whose own cost has changed since they were ranked.
    changed: Vec<usize>,
}

/// State of the search for much shorter directions.
#[derive(Default)]
struct Shortcuts {
    /// Minimum number of samples, and the treatment of overlaps at the start.
    samples: usize,
    start: StartOverlap,
    /// Shadows along the samples, filled at first use.
    shadows: Vec<Shadow>,
    /// For each group, the indices of the shorter directions that were found.
    found: BTreeMap<Vec<usize>, Vec<usize>>,
    memory: Memory,
}

impl<'a> Order<'a> {
    /// Builds the state for the parts of a mask. If `movable` is given, only these parts move. Otherwise all move
    /// except the base, which contains none of the `wanted` parts.
    pub(super) fn new(
        bodies: &'a Bodies,
        matrix: &ContactMatrix,
        likes: &'a [usize],
        present: &[bool],
        up: DVec3,
        movable: Option<&[usize]>,
        wanted: &[usize],
    ) -> Self {
        let moves = |part: usize| movable.unwrap_or(wanted).contains(&part);
        let base = base_parts(bodies, present, up, moves);
        let shadows = matrix.directions().iter().map(|d| Shadow::new(bodies, present, *d));
        let shadows = shadows.collect();
        let size = bodies.assembly().bounds().side_lengths().max_element().max(f64::MIN_POSITIVE);
        let (carried, supports) = find_supports(bodies, matrix, present, &base, up);
        let living = bodies.remaining_parts(present);
        let stationary = if movable.is_some() {
            (0..likes.len()).map(|part| present[part] && !moves(part)).collect()
        } else {
            base
        };
        let mut counts = vec![0; likes.len()];
        for part in (0..likes.len()).filter(|&part| present[part]) {
            counts[likes[part]] += usize::from(!stationary[part]);
        }
        let (last, shortcuts, changed) = (None, Shortcuts::default(), Vec::new());
        Self {
            bodies,
            preferred: vec![bodies.assembly().constraints()],
            demanded: 0,
            up,
            size,
            likes,
            living,
            counts,
            stationary,
            carried,
            supports,
            shadows,
            last,
            shortcuts,
            changed,
        }
    }

    /// Enables the search for much shorter directions, over at least this number of samples of the sphere.
    pub(super) fn with_shortcuts(self, samples: usize, start: StartOverlap) -> Self {
        let shortcuts = Shortcuts { samples, start, ..self.shortcuts };
        Self { shortcuts, ..self }
    }

    /// Adds preferred orders to the constraints of the assembly, from the most demanding one to the least.
    pub(super) fn with_preferred(self, preferred: &'a [Constraints]) -> Self {
        let none = self.bodies.assembly().constraints();
        Self { preferred: preferred.iter().chain([none]).collect(), ..self }
    }

    /// Demands less of the preferred order until it is [restored](Self::restore). Returns `false` if no less demanding
    /// order differs for the present parts.
    pub(super) fn relax(&mut self) -> bool {
        let count = |order: &&Constraints| order.order_arcs(self.present()).len();
        let known = count(&self.constraints());
        let next = (self.demanded + 1..self.preferred.len())
            .find(|&level| count(&self.preferred[level]) < known);
        self.demanded = next.unwrap_or(self.demanded);
        next.is_some()
    }

    /// Demands the whole preferred order again.
    pub(super) fn restore(&mut self) {
        self.demanded = 0;
    }

    /// Returns the mask of present parts.
    pub(super) fn present(&self) -> &[bool] {
        self.living.remaining_flags()
    }

    /// Returns the arcs of the order constraints among the present parts.
    pub(super) fn order_arcs(&self) -> Vec<(usize, usize)> {
        self.constraints().order_arcs(self.present())
    }

    fn constraints(&self) -> &'a Constraints {
        self.preferred[self.demanded]
    }

    /// Returns the parts that move if a group is separated from the others, in increasing order.
    ///
    /// This is the group, or all others if the group contains stationary parts. Returns `None` if both contain
    /// stationary parts, or if the order constraints forbid the motion.
    pub(super) fn moving_parts(&self, group: &[usize], left: &[usize]) -> Option<Vec<usize>> {
        let stays = |&part: &usize| self.stationary[part];
        let mut moving = group.to_vec();
        if group.iter().any(stays) {
            moving = left.iter().copied().filter(|k| !group.contains(k)).collect();
        }
        let may = !moving.is_empty() && !moving.iter().any(stays);
        (may && self.constraints().allows_leaving(&moving, self.present())).then_some(moving)
    }

    /// Returns the parts that move and their direction if a group is separated along `d`: the group along `d`, or the
    /// others along `-d` if the group contains stationary parts. Returns `None` if both contain such parts or
    /// constraints forbid the motion.
    pub(super) fn choice_for(
        &self,
        group: &[usize],
        left: &[usize],
        d: DVec3,
    ) -> Option<GroupChoice> {
        let parts = self.moving_parts(group, left)?;
        let direction = if parts == group { d } else { DVec3::ZERO - d };
        self.constraints()
            .allows_direction(&parts, direction)
            .then_some(GroupChoice { parts, direction })
    }

    /// Returns the number of parts that move if a group is separated along `d`, or `None` if it may not be.
    pub(super) fn moving_count(&self, group: &[usize], left: &[usize], d: DVec3) -> Option<usize> {
        self.choice_for(group, left, d).map(|way| way.parts.len())
    }

    /// Checks whether a part is stationary.
    pub(super) fn is_stationary(&self, part: usize) -> bool {
        self.stationary[part]
    }

    /// Updates the state after parts have left along a direction.
    pub(super) fn remove(&mut self, parts: &[usize], direction: DVec3) {
        for &part in parts {
            self.bodies.remove(&mut self.living, part);
            // Stationary parts are not counted. They leave only if some of them move against others.
            let count = &mut self.counts[self.likes[part]];
            *count = count.saturating_sub(1);
            self.changed.extend(self.shadows.iter_mut().flat_map(|shadow| shadow.remove(part)));
            for shadow in &mut self.shortcuts.shadows {
                shadow.remove(part);
            }
            // The own costs of the parts below, and of those that carry the same parts, change: their removal may
            // unsettle more parts now.
            let below = |part: usize| self.supports[part].iter().flat_map(Support::parts_below);
            let same_load = self.carried[part].iter().flat_map(|&above| below(above));
            self.changed.extend(below(part).chain(same_load));
        }
        self.last = parts.first().map(|&part| (direction, self.likes[part]));
    }

    /// Returns the best of the parts that can leave alone, with its direction. Returns `None` if no part can.
    pub(super) fn best_single_part(&mut self, single: &mut SingleParts) -> Option<GroupChoice> {
        let mut changed = std::mem::take(&mut self.changed);
        changed.append(&mut single.changed);
        changed.sort_unstable();
        changed.dedup();
        for &part in &changed {
            self.rank_part(single, part);
        }
        for shape in changed.into_iter().map(|part| self.likes[part]) {
            single.ranking.set_count(shape, self.counts[shape]);
        }
        let last = self.last.map(|last| last.1);
        loop {
            let (part, k) =
                single.ranking.best_removal(last, |state, way| self.step_cost(1, state, way))?;
            if !self.find_shortcut(&[part], k) {
                let direction = self.shadows[k].direction;
                return Some(GroupChoice { parts: vec![part], direction });
            }
            self.rank_part(single, part);
        }
    }

    /// Recomputes the rank of a part. Drops it if it cannot leave alone.
    fn rank_part(&mut self, single: &mut SingleParts, part: usize) {
        single.ranking.remove(part);
        let Some(ways) = single.free_directions(part) else { return };
        let ways = self.own_costs(&[part], ways);
        single.ranking.insert(part, self.likes[part], ways);
    }

    /// Returns the best of some groups, each given with the indices of its free directions. Returns `None` without
    /// groups.
    pub(super) fn best_group<'g>(
        &mut self,
        groups: &(impl Iterator<Item = (&'g [usize], &'g [usize])> + Clone),
    ) -> Option<GroupChoice> {
        let mut ready: BTreeMap<usize, usize> = BTreeMap::new();
        for (parts, _) in groups.clone() {
            *ready.entry(self.likes[parts[0]]).or_default() += 1;
        }
        loop {
            let (parts, k) = self.cheapest_group(groups.clone(), &ready)?;
            if !self.find_shortcut(parts, k) {
                let (parts, direction) = (parts.to_vec(), self.shadows[k].direction);
                return Some(GroupChoice { parts, direction });
            }
        }
    }

    /// Returns the group of least cost and the index of its direction. `ready` maps a shape to its number of
    /// removable groups.
    fn cheapest_group<'g>(
        &mut self,
        groups: impl Iterator<Item = (&'g [usize], &'g [usize])>,
        ready: &BTreeMap<usize, usize>,
    ) -> Option<(&'g [usize], usize)> {
        let mut best: Option<(f64, &[usize], usize)> = None;
        for (parts, ways) in groups {
            let shape = self.likes[parts[0]];
            let all = parts.len() == 1 && ready[&shape] >= self.counts[shape];
            let state = ShapeState { other: self.last.is_some_and(|last| last.1 != shape), all };
            for way in self.own_costs(parts, ways) {
                let cost = self.step_cost(parts.len(), state, way);
                if is_better(cost, best.map(|best| best.0)) {
                    best = Some((cost, parts, way.0));
                }
            }
        }
        best.map(|(_, parts, k)| (parts, k))
    }

    /// Returns the directions of a group whose travel is at most [`TRAVEL_SLACK`] times the shortest one plus the
    /// noise. The candidates are `ways` and the shorter directions that [`find_shortcut`](Self::find_shortcut) has
    /// stored. Each direction has its own cost: the travel, and the parts that fall or lose balance. This cost does not
    /// depend on the shape and direction of the step before.
    fn own_costs(&mut self, parts: &[usize], ways: &[usize]) -> Vec<OwnCost> {
        self.bodies.count_visit();
        let more = self.shortcuts.found.get(parts).map_or(&[][..], |found| found);
        let (bodies, shadows, living) = (self.bodies, &mut self.shadows, &self.living);
        let travel = |&k: &usize| (k, shadows[k].travel_of(bodies, parts, living));
        let travels: Vec<(usize, f64)> = ways.iter().chain(more).map(travel).collect();
        let least = travels.iter().map(|way| way.1).fold(f64::INFINITY, f64::min);
        let unsettled = self.unsettled_parts(parts).map(|parts| parts.len() as f64);
        let falls = FALL_COST * unsettled[0] + TIP_COST * unsettled[1];
        let mut near = travels;
        near.retain(|way| way.1 <= TRAVEL_SLACK * least + bodies.noise());
        near.into_iter().map(|(k, travel)| (k, falls + travel / self.size)).collect()
    }

    /// Searches for a much shorter direction of a group that would leave along direction `k`, and stores it. Returns
    /// whether one was found.
    fn find_shortcut(&mut self, parts: &[usize], k: usize) -> bool {
        let Some(shortcut) = self.shortest_alternative(parts, k) else { return false };
        self.shortcuts.found.entry(parts.to_vec()).or_default().push(shortcut);
        true
    }

    /// Returns the index of the shortest free direction of a group, if the travel along `k` is more than
    /// [`SHORTCUT_RATIO`] times as long.
    fn shortest_alternative(&mut self, parts: &[usize], k: usize) -> Option<usize> {
        let Self { bodies, living, shadows, shortcuts, .. } = self;
        let present = living.remaining_flags();
        let way = shadows[k].travel_of(bodies, parts, living);
        if way <= SHORT_TRAVEL * self.size {
            return None;
        }
        if shortcuts.shadows.is_empty() && shortcuts.samples > 0 {
            let samples = Sphere::with_directions(shortcuts.samples).directions;
            let shadow = |d: &DVec3| Shadow::new(bodies, present, *d);
            shortcuts.shadows = samples.par_iter().map(shadow).collect();
        }
        let mut shorter: Vec<(f64, DVec3)> = Vec::new();
        for shadow in shadows.iter_mut().chain(&mut shortcuts.shadows) {
            let travel = shadow.travel_of(bodies, parts, living);
            if SHORTCUT_RATIO * travel < way {
                shorter.push((travel, shadow.direction));
            }
        }
        shorter.sort_by(|a, b| a.0.total_cmp(&b.0));
        let constraints = bodies.assembly().constraints();
        let (memory, start) = (&mut shortcuts.memory, shortcuts.start);
        let mut free = shorter.into_iter().map(|(_, d)| d).filter(|&d| {
            constraints.allows_direction(parts, d)
                && memory.is_free(bodies, parts, present, d, start)
        });
        let direction = free.next()?;
        Some(self.direction_index(direction))
    }

    /// Returns bounds of the distance that a removed group travels along a direction until it is beyond all remaining
    /// parts.
    pub(super) fn bounded_travel(&self, parts: &[usize], direction: DVec3) -> Bounded {
        let known =
            self.shadows.iter().find(|s| direction_bits(s.direction) == direction_bits(direction));
        let new = || Shadow::new(self.bodies, self.present(), direction);
        let travel = |shadow: &Shadow| shadow.bounded_travel(self.bodies, parts, &self.living);
        known.map_or_else(|| travel(&new()), travel)
    }

    /// Returns the index of a direction, which is added if it is new.
    pub(super) fn direction_index(&mut self, direction: DVec3) -> usize {
        let known = self
            .shadows
            .iter()
            .position(|s| direction_bits(s.direction) == direction_bits(direction));
        known.unwrap_or_else(|| {
            self.shadows.push(Shadow::new(self.bodies, self.living.remaining_flags(), direction));
            self.shadows.len() - 1
        })
    }

    /// Returns the cost of removing a group of `count` parts.
    fn step_cost(
        &self,
        count: usize,
        ShapeState { other, all }: ShapeState,
        (k, own): OwnCost,
    ) -> f64 {
        let when = |what: bool, cost: f64| if what { cost } else { 0.0 };
        let d = self.shadows[k].direction;
        let turn = self.last.is_some_and(|(last, _)| last.dot(d) < SAME_DIRECTION);
        own + when(turn, DIRECTION_CHANGE_COST)
            + when(other, SHAPE_CHANGE_COST)
            + when(other && !all, INCOMPLETE_SHAPE_COST)
            + when(d.abs().max_element() < SAME_DIRECTION, OBLIQUE_COST)
            + DOWNWARD_COST * (1.0 - d.dot(self.up)) / 2.0
            + GROUP_COST * (count - 1) as f64 / self.likes.len() as f64
    }

    /// Returns the parts that fall after a group is removed, and the parts that are then off balance but were not
    /// before.
    pub(super) fn unsettled_parts(&self, parts: &[usize]) -> [Vec<usize>; 2] {
        if parts.iter().all(|&part| self.carried[part].is_empty()) {
            return [Vec::new(), Vec::new()];
        }
        let mut above: Vec<usize> =
            parts.iter().flat_map(|&part| self.carried[part].iter().copied()).collect();
        above.sort_unstable();
        above.dedup();
        above.retain(|part| self.living.contains(*part) && !parts.contains(part));
        let (mut falls, mut tips) = (Vec::new(), Vec::new());
        for part in above {
            let Some(base) = &self.supports[part] else { continue };
            let carries = |below: usize| self.living.contains(below) && !parts.contains(&below);
            match base.stability(carries) {
                Stability::Falls => falls.push(part),
                Stability::OffBalance
                    if base.stability(|below| self.living.contains(below)) == Stability::Stands =>
                {
                    tips.push(part);
                }
                _ => (),
            }
        }
        [falls, tips]
    }
}

/// Returns the mask of the base: the fixed parts, or else the largest part.
///
/// Parts are compared by the volume of their boxes, then the area of these, their own volume, and their height (the
/// lower part wins). A part for which `moves` holds is never the base. A part that must leave before others is the
/// base only if all are such parts.
pub(super) fn base_parts(
    bodies: &Bodies,
    present: &[bool],
    up: DVec3,
    moves: impl Fn(usize) -> bool,
) -> Vec<bool> {
    let parts = bodies.assembly().parts();
    let mut base: Vec<bool> = parts.iter().zip(present).map(|(p, t)| *t && p.is_fixed()).collect();
    if base.contains(&true) {
        return base;
    }
    // Differences below single precision do not decide.
    let digits = |x: f64| x as f32;
    let key = |k: usize| {
        let bounds = parts[k].solid().bounds();
        let size = bounds.side_lengths();
        // Boxes of flat sheets have zero volume.
        let area = size.x * size.y + size.y * size.z + size.z * size.x;
        let height = bounds.center().dot(up);
        [size.element_product(), area, parts[k].solid().volume(), -height].map(digits)
    };
    let first = |k: usize| bodies.assembly().constraints().is_first(k);
    let all: Vec<usize> = (0..parts.len()).filter(|&k| present[k] && !moves(k)).collect();
    let any = all.iter().all(|&k| first(k));
    let all = all.into_iter().filter(|&k| any || !first(k));
    let larger = |a: &usize, b: &usize| {
        let by = key(*a).partial_cmp(&key(*b)).unwrap_or(std::cmp::Ordering::Equal);
        by.then(b.cmp(a))
    };
    if let Some(largest) = all.max_by(larger) {
        base[largest] = true;
    }
    base
}

/// Returns for each part the parts that rest on it, and what it rests on.
fn find_supports(
    bodies: &Bodies,
    matrix: &ContactMatrix,
    present: &[bool],
    base: &[bool],
    up: DVec3,
) -> (Vec<Vec<usize>>, Vec<Option<Support>>) {
    let count = bodies.len();
    let near = SUPPORT_REACH * contact_reach(bodies);
    let lowest = |k: usize| {
        let heights = bodies.assembly().parts()[k].solid().vertices().iter().map(|p| p.dot(up));
        heights.fold(f64::INFINITY, f64::min)
    };
    let lows: Vec<f64> = (0..count).map(lowest).collect();
    let ground = (0..count).filter(|&k| present[k]).map(|k| lows[k]).fold(f64::INFINITY, f64::min);
    let held = |k: usize| !present[k] || base[k] || lows[k] <= ground + near;
    let mut below: Vec<Option<Vec<usize>>> =
        (0..count).map(|k| (!held(k)).then(Vec::new)).collect();
    let mut carried = vec![Vec::new(); count];
    let down = matrix.directions().iter().position(|d| d.dot(-up) >= SAME_DIRECTION);
    let living = bodies.remaining_parts(present);
    let found: Vec<Vec<usize>> = below
        .par_iter()
        .enumerate()
        .map(|(part, below)| match (below, down) {
            (Some(_), Some(k)) => matrix.blockers_within(k, part, near, &living),
            _ => Vec::new(),
        })
        .collect();
    for (part, found) in found.into_iter().enumerate() {
        for &below in &found {
            carried[below].push(part);
        }
        below[part] = below[part].take().map(|_| found);
    }
    let base = |(part, on): (usize, &Option<Vec<usize>>)| {
        on.as_ref().map(|on| Support::new(bodies, part, on, up))
    };
    let supports = below.par_iter().enumerate().map(base).collect();
    (carried, supports)
}
