//! Best first through both trees, straight down until something is found.
//!
//! A pair of nodes stands for all pairs of their facets. The pair with the least bound is split next, the newest
//! first among equals, until no bound is below the *limit*: the least length found less [`SLACK`] noises, as
//! bounds of nodes that are exactly as far apart as the nearest facets are lowered by their rounding. Every pair
//! that is not split is a *cut*, with its reason: together they are the proof that nothing is nearer.

use std::collections::BinaryHeap;

use super::bound::{Apart, Axes, Couple, View};
use super::triangle::{self, Corners, GAP, Nearest};
use crate::solve::scene::{Scene, Side};
use crate::solve::search;
use crate::solve::steps::SolidSteps;
use colltrans_kernel::work;

/// How far, in noises, the limit is below the least length found.
const SLACK: f64 = 3.0;

/// The two facets that are nearest to each other.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Found {
    pub(crate) triangles: [u32; 2],
    pub(crate) nearest: Nearest,
}

/// When a search may end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Until {
    /// Pairs at this distance or beyond are of no interest.
    pub(crate) beyond: f64,
    /// A pair that is no farther apart will do, as computed.
    pub(crate) enough: f64,
}

impl Until {
    /// The least distance.
    pub(crate) const LEAST: Self = Self { beyond: f64::INFINITY, enough: f64::NEG_INFINITY };
}

/// The nodes of a body that a search has come to, and the facets of leaves.
#[derive(Debug, Clone, Default)]
struct Seen {
    views: Vec<View>,
    /// Where the children of each view are, or its facets; once they have been asked for.
    parts: Vec<Option<u32>>,
    facets: Vec<Corners>,
}

impl Seen {
    fn start(&mut self, axes: &Axes, side: &Side) {
        self.views.clear();
        self.parts.clear();
        self.facets.clear();
        self.look(axes, side, 0);
    }

    fn look(&mut self, axes: &Axes, side: &Side, at: u32) {
        self.views.push(View::new(axes, side, at));
        self.parts.push(None);
    }

    /// The first of the two children of a view.
    fn children(&mut self, axes: &Axes, side: &Side, view: u32) -> u32 {
        if let Some(first) = self.parts[view as usize] {
            return first;
        }
        let first = self.views.len() as u32;
        let at = self.views[view as usize].node;
        for part in side.solid.nodes()[at as usize].children(at) {
            self.look(axes, side, part);
        }
        self.parts[view as usize] = Some(first);
        first
    }

    /// The first facet of a leaf.
    fn leaf(&mut self, side: &Side, view: u32) -> usize {
        let first = self.parts[view as usize].unwrap_or_else(|| {
            let first = self.facets.len() as u32;
            let node = self.views[view as usize].node;
            self.facets.extend(facets(side, node));
            self.parts[view as usize] = Some(first);
            first
        });
        first as usize
    }
}

/// The facets of a leaf.
fn facets(side: &Side, node: u32) -> impl Iterator<Item = Corners> {
    side.solid.nodes()[node as usize].facets().map(|t| corners(side, t))
}

/// A facet in the setting frame.
pub(crate) fn corners(side: &Side, triangle: usize) -> Corners {
    let vertices = side.solid.vertices();
    side.solid.triangles()[triangle].map(|v| side.matrix * vertices[v as usize] + side.offset[0])
}

type Entry = search::Entry<Apart>;

/// One search under way.
pub(crate) struct Search<'s, 'a, F: FnMut([u32; 2], Apart)> {
    scene: &'s Scene<'a>,
    axes: Axes,
    seen: [Seen; 2],
    queue: BinaryHeap<Entry>,
    number: u32,
    until: Until,
    /// Pairs at this distance or beyond are of no interest.
    limit: f64,
    found: Option<Found>,
    /// No pair of facets that was looked at is nearer.
    examined: f64,
    /// Told of every pair of nodes that is not split, and why.
    cut: F,
    pub(crate) steps: SolidSteps,
}

impl<'s, 'a, F: FnMut([u32; 2], Apart)> Search<'s, 'a, F> {
    pub(crate) fn new(scene: &'s Scene<'a>, until: Until, cut: F) -> Self {
        Self {
            scene,
            axes: Axes::new(scene),
            seen: Default::default(),
            queue: BinaryHeap::new(),
            number: 0,
            until,
            limit: until.beyond,
            found: None,
            examined: f64::INFINITY,
            cut,
            steps: SolidSteps::default(),
        }
    }

    /// The nearest pair below the limit, and a length that no pair is below.
    pub(crate) fn run(&mut self) -> (Option<Found>, f64) {
        let scene = self.scene;
        self.seen[0].start(&self.axes, &scene.moving);
        self.seen[1].start(&self.axes, &scene.fixed);
        let mut next = self.judge([0, 0]);
        while let Some(entry) = next.take().or_else(|| self.queue.pop()) {
            if entry.bound >= self.limit {
                self.end(entry);
                break;
            }
            if let Some(child) = self.step(&entry) {
                // Straight down at first: what is found bounds what has to be kept.
                let first = self.found.is_none()
                    || self.queue.peek().is_none_or(|top| child.bound <= top.bound);
                if first { next = Some(child) } else { self.queue.push(child) }
            }
            if self.found.is_some_and(|found| found.nearest.length <= self.until.enough) {
                return (self.found, 0.0);
            }
        }
        (self.found, self.examined.min(self.limit).max(0.0))
    }

    /// The least bound is not below the limit: nor are all others.
    fn end(&mut self, entry: Entry) {
        let nodes = self.nodes(entry.views);
        (self.cut)(nodes, entry.reason);
        for rest in std::mem::take(&mut self.queue) {
            let nodes = self.nodes(rest.views);
            (self.cut)(nodes, rest.reason);
        }
    }

    fn nodes(&self, [a, b]: [u32; 2]) -> [u32; 2] {
        [self.seen[0].views[a as usize].node, self.seen[1].views[b as usize].node]
    }

    /// Looks at two leaves, or splits a pair; the better one of the two.
    fn step(&mut self, entry: &Entry) -> Option<Entry> {
        let [i, j] = entry.views;
        let (a, b) = (&self.seen[0].views[i as usize], &self.seen[1].views[j as usize]);
        if a.leaf && b.leaf {
            let nodes = [a.node, b.node];
            self.leaves(entry.views, nodes);
            (self.cut)(nodes, Apart::Examined);
            return None;
        }
        let parts = if !a.leaf && (b.leaf || a.size >= b.size) {
            let first = self.seen[0].children(&self.axes, &self.scene.moving, i);
            [[first, j], [first + 1, j]]
        } else {
            let first = self.seen[1].children(&self.axes, &self.scene.fixed, j);
            [[i, first], [i, first + 1]]
        };
        let [x, y] = parts.map(|views| self.judge(views));
        let (Some(x), Some(y)) = (x, y) else { return x.or(y) };
        let (better, other) = if x.bound <= y.bound { (x, y) } else { (y, x) };
        self.queue.push(other);
        Some(better)
    }

    /// A pair with its bound, unless it is cut.
    fn judge(&mut self, views: [u32; 2]) -> Option<Entry> {
        work::count(1);
        self.steps.nodes += 1;
        self.number += 1;
        let [i, j] = views;
        let couple = Couple {
            scene: self.scene,
            axes: &self.axes,
            moving: &self.seen[0].views[i as usize],
            fixed: &self.seen[1].views[j as usize],
        };
        let (bound, reason) = couple.best(self.limit);
        if bound >= self.limit {
            let nodes = [couple.moving.node, couple.fixed.node];
            (self.cut)(nodes, reason);
            return None;
        }
        Some(Entry { bound, number: self.number, reason, views })
    }

    /// All pairs of facets of two leaves.
    fn leaves(&mut self, [i, j]: [u32; 2], nodes: [u32; 2]) {
        self.steps.leaves += 1;
        let scene = self.scene;
        let [a, b] = [(&scene.moving, nodes[0]), (&scene.fixed, nodes[1])]
            .map(|(side, at)| side.solid.nodes()[at as usize].facets());
        let first = [self.seen[0].leaf(&scene.moving, i), self.seen[1].leaf(&scene.fixed, j)];
        for (s, of_moving) in a.enumerate() {
            for (t, of_fixed) in b.clone().enumerate() {
                let f = self.seen[0].facets[first[0] + s];
                let g = self.seen[1].facets[first[1] + t];
                self.facets([of_moving as u32, of_fixed as u32], &f, &g);
            }
        }
    }

    #[inline]
    fn facets(&mut self, triangles: [u32; 2], f: &Corners, g: &Corners) {
        let noise = self.scene.noise;
        // Most of what is near the best pair is beyond a plane across the same normal.
        if let Some(best) = &self.found
            && triangle::gap(f, g, best.nearest.normal) - GAP * noise >= self.limit
        {
            return;
        }
        let Some(nearest) = triangle::examine(f, g, self.limit, noise) else { return };
        self.examined = self.examined.min(nearest.gap - GAP * noise);
        if self.found.is_none_or(|found| nearest.length < found.nearest.length) {
            self.found = Some(Found { triangles, nearest });
            self.limit = self.limit.min(nearest.length - SLACK * noise);
        }
    }
}

/// What a reason proves of two nodes: no pair of their facets is nearer.
pub(crate) fn proven(scene: &Scene, axes: &AxesOf, nodes: [u32; 2], reason: Apart) -> f64 {
    if reason != Apart::Examined {
        let moving = View::new(&axes.0, &scene.moving, nodes[0]);
        let fixed = View::new(&axes.0, &scene.fixed, nodes[1]);
        return Couple { scene, axes: &axes.0, moving: &moving, fixed: &fixed }.bound(reason);
    }
    let mut least = f64::INFINITY;
    for f in facets(&scene.moving, nodes[0]) {
        for g in facets(&scene.fixed, nodes[1]) {
            least = least.min(triangle::nearest(&f, &g, scene.noise).gap - GAP * scene.noise);
        }
    }
    least.max(0.0)
}

/// The axes along which proofs are checked.
pub(crate) struct AxesOf(Axes);

impl AxesOf {
    pub(crate) fn new(scene: &Scene) -> Self {
        Self(Axes::new(scene))
    }
}
