//! A natural order: which of the groups that can leave goes next, and along which direction.
//!
//! What can leave stays able to leave, since nothing is put back: so any choice leads as far as any other, and what is
//! chosen is a matter of work. A mechanic takes away what carries nothing, by the shortest way, does likes one after
//! another, keeps the direction, and lifts rather than drops.
//!
//! Notation: `up` is against gravity. A part *rests on* those that it meets at once along `-up`; what rests on nothing
//! that is left *falls*, unless it stands on the ground, as the lowest parts do, or is held: the *base* and parts that
//! are fixed. The *travel* of a group along `d` is how far it goes until it is beyond all that is left and in the shadow
//! of whose box it is ([`Bodies::past`]). Of a group's directions those count whose travel is at most [`LONGER`] times
//! the least. Among all of these the one of least [cost](Order::cost) is taken, of equal ones that of the first part. Before
//! it is, it is asked whether the group can leave by a much shorter way, along samples of the sphere: of several like parts
//! in one housing each may have a gap of its own.

use std::collections::BTreeMap;

use colltrans::Bounded;
use colltrans::solid::StartOverlap;
use glam::DVec3;
use rayon::prelude::*;

use super::ranking::{OwnCost, ShapeState, is_better};
use super::shadow::Shadow;
use super::single::Single;
use super::stand::{Base, Standing};
use crate::bodies::Bodies;
use crate::boxes::Living;
use crate::constraints::Constraints;
use crate::liaisons::reach;
use crate::matrix::{Matrix, bits};
use crate::sphere::Sphere;
use crate::witness::Memory;

/// Ways that are up to so much longer than the shortest one are as good.
const LONGER: f64 = 1.1;
/// A way that is so much longer than one along a sample is not taken, ...
const MUCH_LONGER: f64 = 1.5;
/// ... unless it is shorter than this share of the assembly's size.
const SHORT: f64 = 1e-3;
/// A part rests on what it meets within so many reaches of contacts: both are shrunk, and touch at a slant.
const RESTS: f64 = 4.0;
/// Directions with a larger product are one: 0.8 degrees.
const SAME: f64 = 0.9999;

/// What a step costs, beside its travel as a share of the assembly's size: each part that falls, ...
const FALL: f64 = 2.0;
/// ... each part that is off balance then, ...
const TIP: f64 = 1.0;
/// ... each part of another shape than the one before: another tool, ...
const OTHER_SHAPE: f64 = 0.8;
/// ... and that while others of its shape cannot leave yet, so that there will be a third time, ...
const NOT_ALL: f64 = 0.4;
/// ... another direction than before, ...
const TURN: f64 = 0.3;
/// ... down, rather than up, ...
const DOWN: f64 = 0.3;
/// ... along no axis of the world, ...
const OBLIQUE: f64 = 0.2;
/// ... and a group of all, of a smaller one its share.
const GROUP: f64 = 0.3;

/// What was chosen: some parts, and a direction.
pub(super) struct Choice {
    pub(super) parts: Vec<usize>,
    pub(super) direction: DVec3,
}

/// What decides about the order, among some of the parts.
pub(super) struct Order<'a> {
    bodies: &'a Bodies<'a>,
    up: DVec3,
    size: f64,
    /// The first part of the same shape, by part.
    likes: &'a [usize],
    living: Living,
    /// By shape, that is its first part: how many of those that move are there.
    counts: Vec<usize>,
    /// What does not move: the base, and what is not to be moved.
    stays: Vec<bool>,
    /// By part: what rests on it, of all parts.
    carried: Vec<Vec<usize>>,
    /// By part: on what it rests; `None` if it does not fall whatever goes.
    bases: Vec<Option<Base>>,
    /// By direction, those of the matrix first.
    shadows: Vec<Shadow>,
    last: Option<(DVec3, usize)>,
    shortcuts: Shortcuts,
    /// Parts whose own share of a cost has changed since they were ranked.
    changed: Vec<usize>,
}

/// What is asked for much shorter ways.
#[derive(Default)]
struct Shortcuts {
    /// How many samples, at least, and what overlaps at the start mean.
    samples: usize,
    start: StartOverlap,
    /// Along the samples, once they are asked.
    shadows: Vec<Shadow>,
    /// By group: the positions of directions that were found.
    found: BTreeMap<Vec<usize>, Vec<usize>>,
    memory: Memory,
}

impl<'a> Order<'a> {
    /// Of the parts of a group that are there; of these `movable` ones move, if not all but the base, which none of
    /// the `wanted` ones is.
    pub(super) fn new(
        bodies: &'a Bodies,
        matrix: &Matrix,
        likes: &'a [usize],
        there: &[bool],
        up: DVec3,
        movable: Option<&[usize]>,
        wanted: &[usize],
    ) -> Self {
        let moves = |part: usize| movable.unwrap_or(wanted).contains(&part);
        let base = base(bodies, there, up, moves);
        let shadows = matrix.directions().iter().map(|d| Shadow::new(bodies, there, *d));
        let shadows = shadows.collect();
        let size = bodies.assembly().bounds().size().max_element().max(f64::MIN_POSITIVE);
        let (carried, bases) = supports(bodies, matrix, there, &base, up);
        let living = bodies.living(there);
        let stays = if movable.is_some() {
            (0..likes.len()).map(|part| there[part] && !moves(part)).collect()
        } else {
            base
        };
        let mut counts = vec![0; likes.len()];
        for part in (0..likes.len()).filter(|&part| there[part]) {
            counts[likes[part]] += usize::from(!stays[part]);
        }
        let (last, shortcuts, changed) = (None, Shortcuts::default(), Vec::new());
        Self {
            bodies,
            up,
            size,
            likes,
            living,
            counts,
            stays,
            carried,
            bases,
            shadows,
            last,
            shortcuts,
            changed,
        }
    }

    /// Much shorter ways are looked for along so many samples of the sphere, beside all directions that are known.
    pub(super) fn with_shortcuts(self, samples: usize, start: StartOverlap) -> Self {
        let shortcuts = Shortcuts { samples, start, ..self.shortcuts };
        Self { shortcuts, ..self }
    }

    /// By part, whether it is still there.
    pub(super) fn there(&self) -> &[bool] {
        self.living.there()
    }

    /// The arcs of the order that is asked for.
    pub(super) fn arcs(&self) -> Vec<(usize, usize)> {
        self.constraints().arcs(self.there())
    }

    fn constraints(&self) -> &'a Constraints {
        self.bodies.assembly().constraints()
    }

    /// What moves if a group goes one way, or the others the other way, increasing: what nothing that stays is in; `None`
    /// if such is in both, or the order does not let it go.
    pub(super) fn moving(&self, group: &[usize], left: &[usize]) -> Option<Vec<usize>> {
        let stays = |&part: &usize| self.stays[part];
        let mut moving = group.to_vec();
        if group.iter().any(stays) {
            moving = left.iter().copied().filter(|k| !group.contains(k)).collect();
        }
        let may = !moving.is_empty() && !moving.iter().any(stays);
        (may && self.constraints().lets_go(&moving, self.there())).then_some(moving)
    }

    /// What moves, and where to, if a group goes along `d`, or the others along `-d`; `None` if nothing may.
    pub(super) fn way(&self, group: &[usize], left: &[usize], d: DVec3) -> Option<Choice> {
        let parts = self.moving(group, left)?;
        let direction = if parts == group { d } else { DVec3::ZERO - d };
        self.constraints().allows(&parts, direction).then_some(Choice { parts, direction })
    }

    /// How many parts move so, if any may.
    pub(super) fn how_many(&self, group: &[usize], left: &[usize], d: DVec3) -> Option<usize> {
        self.way(group, left, d).map(|way| way.parts.len())
    }

    /// Whether a part stays where it is, for others to be taken from it.
    pub(super) fn stays(&self, part: usize) -> bool {
        self.stays[part]
    }

    /// These parts have gone, along a direction.
    pub(super) fn remove(&mut self, parts: &[usize], direction: DVec3) {
        for &part in parts {
            self.bodies.remove(&mut self.living, part);
            // Parts that stay are not counted. They leave only where some of them are moved against others.
            let count = &mut self.counts[self.likes[part]];
            *count = count.saturating_sub(1);
            self.changed.extend(self.shadows.iter_mut().flat_map(|shadow| shadow.remove(part)));
            for shadow in &mut self.shortcuts.shadows {
                shadow.remove(part);
            }
            // What it rests on, and what carries the same parts as it does, now unsettles others when it leaves.
            let below = |part: usize| self.bases[part].iter().flat_map(Base::below);
            let beside = self.carried[part].iter().flat_map(|&above| below(above));
            self.changed.extend(below(part).chain(beside));
        }
        self.last = parts.first().map(|&part| (direction, self.likes[part]));
    }

    /// The best of the parts that can leave alone.
    pub(super) fn alone(&mut self, single: &mut Single) -> Option<Choice> {
        let mut changed = std::mem::take(&mut self.changed);
        changed.append(&mut single.changed);
        changed.sort_unstable();
        changed.dedup();
        for &part in &changed {
            self.rank(single, part);
        }
        for shape in changed.into_iter().map(|part| self.likes[part]) {
            single.ranking.set_count(shape, self.counts[shape]);
        }
        let last = self.last.map(|last| last.1);
        loop {
            let (part, k) = single.ranking.best(last, |state, way| self.cost(1, state, way))?;
            if !self.find_shortcut(&[part], k) {
                let direction = self.shadows[k].direction;
                return Some(Choice { parts: vec![part], direction });
            }
            self.rank(single, part);
        }
    }

    /// Ranks a part anew among those that can leave alone, if it is one of them.
    fn rank(&mut self, single: &mut Single, part: usize) {
        single.ranking.remove(part);
        let Some(ways) = single.ways(part) else { return };
        let ways = self.own_costs(&[part], ways);
        single.ranking.insert(part, self.likes[part], ways);
    }

    /// The best of some groups, each with positions of directions along which it can leave.
    pub(super) fn best<'g>(
        &mut self,
        groups: &(impl Iterator<Item = (&'g [usize], &'g [usize])> + Clone),
    ) -> Option<Choice> {
        let mut ready: BTreeMap<usize, usize> = BTreeMap::new();
        for (parts, _) in groups.clone() {
            *ready.entry(self.likes[parts[0]]).or_default() += 1;
        }
        loop {
            let (parts, k) = self.cheapest(groups.clone(), &ready)?;
            if !self.find_shortcut(parts, k) {
                let (parts, direction) = (parts.to_vec(), self.shadows[k].direction);
                return Some(Choice { parts, direction });
            }
        }
    }

    /// The group of least cost, and the position of its direction; `ready` is by shape how many groups can leave.
    fn cheapest<'g>(
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
                let cost = self.cost(parts.len(), state, way);
                if is_better(cost, best.map(|best| best.0)) {
                    best = Some((cost, parts, way.0));
                }
            }
        }
        best.map(|(_, parts, k)| (parts, k))
    }

    /// The ways of a group that are not much longer than the shortest one, each with what it costs whatever was taken
    /// away before: what falls then, and the travel. Shortcuts that were found are ways as well.
    fn own_costs(&mut self, parts: &[usize], ways: &[usize]) -> Vec<OwnCost> {
        self.bodies.count_look();
        let more = self.shortcuts.found.get(parts).map_or(&[][..], |found| found);
        let (bodies, shadows, living) = (self.bodies, &mut self.shadows, &self.living);
        let travel = |&k: &usize| (k, shadows[k].travel(bodies, parts, living));
        let travels: Vec<(usize, f64)> = ways.iter().chain(more).map(travel).collect();
        let least = travels.iter().map(|way| way.1).fold(f64::INFINITY, f64::min);
        let unsettled = self.unsettled(parts).map(|parts| parts.len() as f64);
        let falls = FALL * unsettled[0] + TIP * unsettled[1];
        let mut near = travels;
        near.retain(|way| way.1 <= LONGER * least + bodies.noise());
        near.into_iter().map(|(k, travel)| (k, falls + travel / self.size)).collect()
    }

    /// Looks for a shortcut of a group that is to go along `k`, and keeps it as a way; checks whether there is one.
    fn find_shortcut(&mut self, parts: &[usize], k: usize) -> bool {
        let Some(shortcut) = self.shortcut(parts, k) else { return false };
        self.shortcuts.found.entry(parts.to_vec()).or_default().push(shortcut);
        true
    }

    /// The position of the direction of the shortest way of a group, if that along `k` is [`MUCH_LONGER`].
    fn shortcut(&mut self, parts: &[usize], k: usize) -> Option<usize> {
        let Self { bodies, living, shadows, shortcuts, .. } = self;
        let there = living.there();
        let way = shadows[k].travel(bodies, parts, living);
        if way <= SHORT * self.size {
            return None;
        }
        if shortcuts.shadows.is_empty() && shortcuts.samples > 0 {
            let samples = Sphere::with_directions(shortcuts.samples).directions;
            let shadow = |d: &DVec3| Shadow::new(bodies, there, *d);
            shortcuts.shadows = samples.par_iter().map(shadow).collect();
        }
        let mut shorter: Vec<(f64, DVec3)> = Vec::new();
        for shadow in shadows.iter_mut().chain(&mut shortcuts.shadows) {
            let travel = shadow.travel(bodies, parts, living);
            if MUCH_LONGER * travel < way {
                shorter.push((travel, shadow.direction));
            }
        }
        shorter.sort_by(|a, b| a.0.total_cmp(&b.0));
        let constraints = bodies.assembly().constraints();
        let (memory, start) = (&mut shortcuts.memory, shortcuts.start);
        let mut free = shorter.into_iter().map(|(_, d)| d).filter(|&d| {
            constraints.allows(parts, d) && memory.is_free(bodies, parts, there, d, start)
        });
        let direction = free.next()?;
        Some(self.position(direction))
    }

    /// How far a group that has gone goes along a direction until it is beyond all that are left, with bounds.
    pub(super) fn bounded_travel(&self, parts: &[usize], direction: DVec3) -> Bounded {
        let known = self.shadows.iter().find(|s| bits(s.direction) == bits(direction));
        let new = || Shadow::new(self.bodies, self.there(), direction);
        let travel = |shadow: &Shadow| shadow.bounded_travel(self.bodies, parts, &self.living);
        known.map_or_else(|| travel(&new()), travel)
    }

    /// The position of a direction, which need not be one of the matrix.
    pub(super) fn position(&mut self, direction: DVec3) -> usize {
        let known = self.shadows.iter().position(|s| bits(s.direction) == bits(direction));
        known.unwrap_or_else(|| {
            self.shadows.push(Shadow::new(self.bodies, self.living.there(), direction));
            self.shadows.len() - 1
        })
    }

    /// What it costs to take a group of so many parts away.
    fn cost(&self, count: usize, ShapeState { other, all }: ShapeState, (k, own): OwnCost) -> f64 {
        let when = |what: bool, cost: f64| if what { cost } else { 0.0 };
        let d = self.shadows[k].direction;
        let turn = self.last.is_some_and(|(last, _)| last.dot(d) < SAME);
        own + when(turn, TURN)
            + when(other, OTHER_SHAPE)
            + when(other && !all, NOT_ALL)
            + when(d.abs().max_element() < SAME, OBLIQUE)
            + DOWN * (1.0 - d.dot(self.up)) / 2.0
            + GROUP * (count - 1) as f64 / self.likes.len() as f64
    }

    /// Of the parts that are left once these have gone: which then rest on nothing, and which are then off balance, if they
    /// stood before.
    pub(super) fn unsettled(&self, parts: &[usize]) -> [Vec<usize>; 2] {
        if parts.iter().all(|&part| self.carried[part].is_empty()) {
            return [Vec::new(), Vec::new()];
        }
        let mut above: Vec<usize> =
            parts.iter().flat_map(|&part| self.carried[part].iter().copied()).collect();
        above.sort_unstable();
        above.dedup();
        above.retain(|part| self.living.has(*part) && !parts.contains(part));
        let (mut falls, mut tips) = (Vec::new(), Vec::new());
        for part in above {
            let Some(base) = &self.bases[part] else { continue };
            let carries = |below: usize| self.living.has(below) && !parts.contains(&below);
            match base.standing(carries) {
                Standing::Falls => falls.push(part),
                Standing::OffBalance
                    if base.standing(|below| self.living.has(below)) == Standing::Stands =>
                {
                    tips.push(part);
                }
                _ => (),
            }
        }
        [falls, tips]
    }
}

/// The parts that stay: those that are fixed, or the largest one, by its box and then its volume, and of equal ones the
/// lowest; none that `moves`, nor, if there are others, any that has to leave before others.
fn base(bodies: &Bodies, there: &[bool], up: DVec3, moves: impl Fn(usize) -> bool) -> Vec<bool> {
    let parts = bodies.assembly().parts();
    let mut base: Vec<bool> = parts.iter().zip(there).map(|(p, t)| *t && p.fixed()).collect();
    if base.contains(&true) {
        return base;
    }
    // Digits of single precision do not decide.
    let digits = |x: f64| x as f32;
    let key = |k: usize| {
        let bounds = parts[k].solid().bounds();
        let size = bounds.size();
        // Boxes of flat sheets have no volume.
        let area = size.x * size.y + size.y * size.z + size.z * size.x;
        let height = bounds.center().dot(up);
        [size.element_product(), area, parts[k].solid().volume(), -height].map(digits)
    };
    let first = |k: usize| bodies.assembly().constraints().is_first(k);
    let all: Vec<usize> = (0..parts.len()).filter(|&k| there[k] && !moves(k)).collect();
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

/// By part, what rests on it, and on what it rests.
fn supports(
    bodies: &Bodies,
    matrix: &Matrix,
    there: &[bool],
    base: &[bool],
    up: DVec3,
) -> (Vec<Vec<usize>>, Vec<Option<Base>>) {
    let count = bodies.len();
    let near = RESTS * reach(bodies);
    let lowest = |k: usize| {
        let heights = bodies.assembly().parts()[k].solid().vertices().iter().map(|p| p.dot(up));
        heights.fold(f64::INFINITY, f64::min)
    };
    let lows: Vec<f64> = (0..count).map(lowest).collect();
    let ground = (0..count).filter(|&k| there[k]).map(|k| lows[k]).fold(f64::INFINITY, f64::min);
    let held = |k: usize| !there[k] || base[k] || lows[k] <= ground + near;
    let mut below: Vec<Option<Vec<usize>>> =
        (0..count).map(|k| (!held(k)).then(Vec::new)).collect();
    let mut carried = vec![Vec::new(); count];
    let down = matrix.directions().iter().position(|d| d.dot(-up) >= SAME);
    let living = bodies.living(there);
    let found: Vec<Vec<usize>> = below
        .par_iter()
        .enumerate()
        .map(|(part, below)| match (below, down) {
            (Some(_), Some(k)) => matrix.within(k, part, near, &living),
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
        on.as_ref().map(|on| Base::new(bodies, part, on, up))
    };
    let bases = below.par_iter().enumerate().map(base).collect();
    (carried, bases)
}
