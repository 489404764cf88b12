//! Best first through both trees.
//!
//! A pair of nodes stands for all pairs of their facets. The pair with the least bound is split next,
//! the newest first among equals; bounds of gaps that block are clamped at 0, so that a contact at the
//! start is found by going straight down. It ends when no bound is smaller than the best gap found.
//! Every pair that is not split is a *cut*, with its reason: together they are the proof that nothing
//! blocks earlier.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use super::bound::{Reason, Shade, least_gap};
use super::leaf::{self, Facet, Gap, Meeting, Wanted};
use super::scene::Scene;
use crate::body::solid::tree::{LEAF, Node};

/// An answer may be larger than the least gap by so many times the blur of coordinates: bounds of
/// nodes are rounded by a third of that.
pub(super) const SLACK: f64 = 12.0;

/// What is looked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Aim {
    /// The least gap that blocks, at least 0.
    Stop,
    /// The same, without pairs of facets that cross now.
    LaterStop,
    /// The least gap of all pairs of facets that face each other.
    Least,
}

impl Aim {
    pub(super) fn clamp(self, gap: f64) -> f64 {
        if self == Self::Least { gap } else { gap.max(0.0) }
    }

    pub(super) fn wanted(self) -> Wanted {
        match self {
            Self::Least => Wanted::All,
            Self::Stop => Wanted::NotParting,
            Self::LaterStop => Wanted::NotCrossing,
        }
    }

    /// What a pair contributes, if it counts.
    pub(super) fn value(self, gap: &Gap) -> Option<f64> {
        let counts = match self {
            Self::Least => true,
            Self::Stop => gap.counts(),
            Self::LaterStop => gap.counts() && gap.signs[0] != Ordering::Less,
        };
        counts.then(|| self.clamp(gap.least))
    }
}

/// The pair of facets that decides.
#[derive(Debug, Clone, Copy)]
pub(super) struct Found {
    /// The gap, as a length.
    pub(super) gap: f64,
    pub(super) moving: u32,
    pub(super) fixed: u32,
    pub(super) at: Meeting,
    pub(super) error: f64,
}

impl Found {
    /// The same with the gap taken exactly, if it is not sharp.
    pub(super) fn sharpened(self, scene: &Scene, aim: Aim) -> Self {
        if self.error <= leaf::FINE * scene.blur {
            return self;
        }
        let f = Facet::facing(scene, true, self.moving as usize, Ordering::Greater);
        let g = Facet::facing(scene, false, self.fixed as usize, Ordering::Less);
        let (Some(f), Some(g)) = (f, g) else { return self };
        let gap = leaf::sharpened(scene, &f, &g);
        Self { gap: aim.clamp(gap.least), at: gap.at, error: gap.error, ..self }
    }
}

/// The queue of a search, which can be kept from one query to the next: then a query allocates
/// nothing.
#[derive(Debug, Clone, Default)]
pub struct Workspace {
    queue: BinaryHeap<Entry>,
}

#[derive(Debug, Clone, Copy)]
struct Entry {
    bound: f64,
    number: u32,
    nodes: [u32; 2],
}

impl Ord for Entry {
    fn cmp(&self, other: &Self) -> Ordering {
        other.bound.total_cmp(&self.bound).then(self.number.cmp(&other.number))
    }
}

impl PartialOrd for Entry {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Entry {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Entry {}

/// Whether the moving node of a pair is the one to be split: the larger one, unless it is a leaf.
pub(super) fn splits_moving(a: &Node, b: &Node) -> bool {
    let size = |n: &Node| (n.high - n.low).length_squared();
    !a.is_leaf() && (b.is_leaf() || size(a) >= size(b))
}

/// The children of a node.
pub(super) fn children(node: &Node, at: u32) -> [u32; 2] {
    [at + 1, at + node.skip]
}

/// One search under way.
pub(super) struct Search<'s, 'a, F: FnMut([u32; 2], Reason)> {
    pub(super) scene: &'s Scene<'a>,
    pub(super) aim: Aim,
    /// What a gap has to stay below to be of interest.
    pub(super) limit: f64,
    pub(super) found: Option<Found>,
    /// Told of every pair of nodes that is not split, and why.
    pub(super) cut: F,
    /// Pairs of nodes looked at, and pairs of leaves.
    pub(super) steps: [u32; 2],
}

impl<F: FnMut([u32; 2], Reason)> Search<'_, '_, F> {
    pub(super) fn run(&mut self, workspace: &mut Workspace) -> Option<Found> {
        let queue = &mut workspace.queue;
        queue.clear();
        let (a, b) = (self.shade(true, 0), self.shade(false, 0));
        let mut next =
            self.judge([0, 0], &a, &b).map(|bound| Entry { bound, number: 0, nodes: [0, 0] });
        let mut number = 0;
        while let Some(entry) = next.take().or_else(|| queue.pop()) {
            if entry.bound >= self.limit {
                (self.cut)(entry.nodes, Reason::NotBefore);
                continue;
            }
            let nodes = entry.nodes.map(|n| n as usize);
            let (a, b) = (
                &self.scene.moving.solid.nodes()[nodes[0]],
                &self.scene.fixed.solid.nodes()[nodes[1]],
            );
            if a.is_leaf() && b.is_leaf() {
                self.leaves(a, b);
                (self.cut)(entry.nodes, Reason::Examined);
                continue;
            }
            for bound in self.split(entry.nodes, a, b).into_iter().flatten() {
                number += 1;
                let child = Entry { number, ..bound };
                // The better child goes on without a detour through the queue.
                match next {
                    Some(best) if best.bound < child.bound => queue.push(child),
                    Some(best) => {
                        queue.push(best);
                        next = Some(child);
                    }
                    None => next = Some(child),
                }
            }
            if let (Some(child), Some(top)) = (next, queue.peek())
                && top.bound < child.bound
            {
                queue.push(child);
                next = None;
            }
        }
        self.found.map(|found| found.sharpened(self.scene, self.aim))
    }

    fn shade(&self, moving: bool, at: u32) -> Shade {
        Shade::new(self.scene, self.scene.side(moving), at as usize)
    }

    /// The bound of a pair of nodes, unless it is cut.
    fn judge(&mut self, nodes: [u32; 2], a: &Shade, b: &Shade) -> Option<f64> {
        self.steps[0] += 1;
        match least_gap(self.scene, a, b, self.limit, self.aim != Aim::Least) {
            Ok(bound) => Some(self.aim.clamp(bound)),
            Err(reason) => {
                (self.cut)(nodes, reason);
                None
            }
        }
    }

    fn split(&mut self, nodes: [u32; 2], a: &Node, b: &Node) -> [Option<Entry>; 2] {
        let moving = splits_moving(a, b);
        let (parts, whole) = if moving {
            (children(a, nodes[0]), self.shade(false, nodes[1]))
        } else {
            (children(b, nodes[1]), self.shade(true, nodes[0]))
        };
        parts.map(|part| {
            let shade = self.shade(moving, part);
            let nodes = if moving { [part, nodes[1]] } else { [nodes[0], part] };
            let bound = if moving {
                self.judge(nodes, &shade, &whole)
            } else {
                self.judge(nodes, &whole, &shade)
            };
            bound.map(|bound| Entry { bound, number: 0, nodes })
        })
    }

    /// All pairs of facets of two leaves.
    fn leaves(&mut self, a: &Node, b: &Node) {
        self.steps[1] += 1;
        let scene = self.scene;
        let mut back: [Option<Facet>; LEAF] = [None; LEAF];
        for (slot, triangle) in back.iter_mut().zip(b.facets()) {
            *slot = Facet::facing(scene, false, triangle, Ordering::Less);
        }
        for triangle in a.facets() {
            let Some(f) = Facet::facing(scene, true, triangle, Ordering::Greater) else { continue };
            for g in back.iter().flatten() {
                let wanted = self.aim.wanted();
                let Some(gap) = leaf::gap(scene, &f, g, self.limit, wanted) else { continue };
                let Some(value) = self.aim.value(&gap) else { continue };
                if value < self.limit {
                    // What could be better by less is not worth a look: rounding is as much.
                    self.limit = value - SLACK * scene.blur;
                    let (moving, fixed) = (f.triangle, g.triangle);
                    let (at, error) = (gap.at, gap.error);
                    self.found = Some(Found { gap: value, moving, fixed, at, error });
                }
            }
        }
    }
}
