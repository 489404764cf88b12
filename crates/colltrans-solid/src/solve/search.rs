//! Least gap of two solids along a direction, best first through both trees.
//!
//! - A pair of nodes stands for all pairs of their facets. The least bound is split next, the newest of equal ones.
//! - Bounds of gaps that block are clamped at 0. Therefore a contact at the start is found by descending straight down:
//!   until a pair of facets is found, the search continues with the better child.
//! - The search ends when no bound is smaller than the best gap found, lowered by [`SLACK`] noises. Ties: a pair of
//!   facets replaces the best one only if its gap is smaller by more than this, so that of equal gaps the first one
//!   examined is reported.
//! - Every pair of nodes that is not split is a *cut* with a [`Reason`]. Together the cuts form the cover, which proves
//!   that nothing blocks earlier.

use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::ops::Range;

use super::bound::{Profile, Reason, dismissal_reason, least_gap};
use super::edge_on::{self, EdgeOnFacet};
use super::leaf::{self, Facet, Gap, GapFilter, Meeting, Opposed};
use super::projected::Projected;
use super::scene::{PairFrame, PlacedBody};
use super::separate;
use super::separating_axes::{Reach, SeparatingAxes};
use crate::solve::steps::SolidSteps;
use colltrans_kernel::descent::QueuedPair;

/// Noises by which an answer may exceed the least gap. A third of it covers the rounding of node bounds.
pub(crate) const SLACK: f64 = 12.0;

/// The gap that a search minimises.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Aim {
    /// Least gap that blocks, at least 0.
    Stop,
    /// Least gap that blocks, at least 0, without pairs of facets that cross at the start.
    LaterStop,
    /// Least gap of all pairs of facets that face each other.
    Least,
}

impl Aim {
    pub(crate) fn clamp_gap(self, gap: f64) -> f64 {
        if self == Self::Least { gap } else { gap.max(0.0) }
    }

    pub(crate) fn gap_filter(self) -> GapFilter {
        match self {
            Self::Least => GapFilter::All,
            Self::Stop => GapFilter::NotParting,
            Self::LaterStop => GapFilter::NotCrossing,
        }
    }

    /// Returns the value that a gap contributes; `None` if it does not count.
    pub(crate) fn contribution(self, gap: &Gap) -> Option<f64> {
        let counts = match self {
            Self::Least => true,
            Self::Stop => gap.counts(),
            Self::LaterStop => gap.counts() && gap.signs[0] != Ordering::Less,
        };
        counts.then(|| self.clamp_gap(gap.least))
    }
}

/// The pair of facets that attains the least gap.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LeastGap {
    /// The gap, as a length.
    pub(crate) gap: f64,
    pub(crate) moving: u32,
    pub(crate) fixed: u32,
    pub(crate) at: Meeting,
    pub(crate) error: f64,
    /// Lower bound on the contribution of every other pair: the least of their gaps minus their errors, and of the last
    /// limit minus the rounding of node bounds.
    pub(crate) others: f64,
}

impl LeastGap {
    /// Returns this pair with the lower bound on all other pairs that a completed search guarantees.
    pub(crate) fn with_least_others(self, scene: &PairFrame) -> Self {
        Self { others: self.gap - SLACK * scene.noise - 1.0625 * node_rounding(scene), ..self }
    }

    /// Returns this pair with its gap recomputed exactly if its error exceeds [`FINE`](leaf::FINE) noises.
    pub(crate) fn with_exact_gap(self, scene: &PairFrame, aim: Aim) -> Self {
        if self.at == Meeting::Near || self.error <= leaf::FINE * scene.noise {
            return self;
        }
        let f = Facet::facing(scene, true, self.moving as usize, Ordering::Greater);
        let g = Facet::facing(scene, false, self.fixed as usize, Ordering::Less);
        let (Some(f), Some(g)) = (f, g) else { return self };
        let (least, at) = leaf::least_exactly(scene, &f, &g);
        Self { gap: aim.clamp_gap(least), at, error: 0.0, ..self }
    }
}

/// The queue of a search and the nodes that it has visited. A workspace that is reused for the next query saves all
/// allocations.
#[derive(Debug, Clone, Default)]
pub struct Workspace {
    queue: BinaryHeap<QueuedPair>,
    /// Visited nodes of the moving and the fixed body.
    seen: [NodeCache; 2],
}

/// The constant part of a search.
struct Query<'s, 'a> {
    scene: &'s PairFrame<'a>,
    /// `None` if both bodies have the axes of the query frame, because their boxes give the same bounds then.
    axes: Option<SeparatingAxes>,
}

/// The nodes of a body that a search has visited, and the facets of its leaves. Each is part of many pairs.
#[derive(Debug, Clone, Default)]
struct NodeCache {
    views: Vec<NodeView>,
    /// Extents of all views; empty if the query has no separating axes.
    reaches: Vec<Reach>,
    facets: Vec<Facet>,
}

/// A node in the query frame.
#[derive(Debug, Clone, Copy)]
struct NodeView {
    projected: Projected,
    leaf: bool,
    size: f64,
    /// Position and number of its children among the views, or of its relevant facets among the facets; `None` until
    /// they are computed.
    parts: Option<[u32; 2]>,
}

impl NodeCache {
    fn reset_to_root(&mut self, query: &Query, moving: bool) {
        self.views.clear();
        self.reaches.clear();
        self.facets.clear();
        self.add_view(query, moving, 0);
    }

    fn add_view(&mut self, query: &Query, moving: bool, at: u32) {
        let side = query.scene.side(moving);
        let node = &side.solid.nodes()[at as usize];
        let (leaf, size) = (node.is_leaf(), node.squared_diagonal());
        let projected = Projected::new(query.scene, side, at as usize);
        if let Some(axes) = &query.axes {
            self.reaches.push(axes.node_extents(side, &projected));
        }
        self.views.push(NodeView { projected, leaf, size, parts: None });
    }

    fn view_profile(&self, view: u32) -> Profile<'_> {
        let at = view as usize;
        Profile { projected: &self.views[at].projected, reach: self.reaches.get(at) }
    }

    /// Returns the position of the first of the two children of a view.
    fn child_views(&mut self, query: &Query, moving: bool, view: u32) -> u32 {
        let &NodeView { projected: Projected { node, .. }, parts, .. } = &self.views[view as usize];
        if let Some([first, _]) = parts {
            return first;
        }
        let first = self.views.len() as u32;
        let nodes = query.scene.side(moving).solid.nodes();
        for part in nodes[node as usize].child_positions(node) {
            self.add_view(query, moving, part);
        }
        self.views[view as usize].parts = Some([first, 2]);
        first
    }

    /// Returns the facets of a leaf that face along the direction for the moving body, or against it for the fixed one,
    /// as positions among the stored facets.
    fn leaf_facets(&mut self, scene: &PairFrame, side: &PlacedBody, view: u32) -> Range<usize> {
        let &NodeView { projected: Projected { node, .. }, parts, .. } = &self.views[view as usize];
        let [first, count] = parts.unwrap_or_else(|| {
            let wanted = if side.moving { Ordering::Greater } else { Ordering::Less };
            let facing = |t| Facet::facing(scene, side.moving, t, wanted);
            let first = self.facets.len();
            self.facets.extend(side.solid.nodes()[node as usize].facets().filter_map(facing));
            let parts = [first as u32, (self.facets.len() - first) as u32];
            self.views[view as usize].parts = Some(parts);
            parts
        });
        first as usize..(first + count) as usize
    }
}

/// State of a search.
pub(crate) struct GapSearch<'s, 'a, F: FnMut([u32; 2], Reason)> {
    pub(crate) scene: &'s PairFrame<'a>,
    pub(crate) aim: Aim,
    /// Upper limit of gaps of interest.
    pub(crate) limit: f64,
    pub(crate) found: Option<LeastGap>,
    /// Least gap minus its error of all examined pairs other than `found`.
    pub(crate) others: f64,
    /// Callback that receives every pair of nodes that is not split, and the reason.
    pub(crate) cut: F,
    pub(crate) steps: SolidSteps,
}

impl<'s, 'a, F: FnMut([u32; 2], Reason)> GapSearch<'s, 'a, F> {
    pub(crate) fn new(scene: &'s PairFrame<'a>, aim: Aim, limit: f64, cut: F) -> Self {
        Self {
            scene,
            aim,
            limit,
            found: None,
            others: f64::INFINITY,
            cut,
            steps: SolidSteps::default(),
        }
    }

    /// Examines two triangles only, instead of a whole tree.
    pub(crate) fn compare_triangles(mut self, [s, t]: [u32; 2]) -> Option<LeastGap> {
        let scene = self.scene;
        let f = Facet::facing(scene, true, s as usize, Ordering::Greater);
        let g = Facet::facing(scene, false, t as usize, Ordering::Less);
        if let (Some(f), Some(g)) = (&f, &g) {
            self.compare_facets(f, g);
        } else {
            edge_on::each_gap_of(scene, [s, t], &mut |pair, gap| self.record_gap(pair, &gap));
        }
        self.found.map(|found| found.with_exact_gap(scene, self.aim))
    }

    pub(crate) fn find_least_gap(&mut self, workspace: &mut Workspace) -> Option<LeastGap> {
        let Workspace { queue, seen } = workspace;
        queue.clear();
        let scene = self.scene;
        let [p, q] = Projected::root_bounds(scene);
        if let Some(reason) = dismissal_reason(&p, &q, self.limit, self.aim != Aim::Least) {
            // Decides most pairs of parts before the separating axes are computed.
            self.steps.nodes += 1;
            (self.cut)([0, 0], reason);
            return None;
        }
        if !scene.is_aligned() && separate::shadows_apart(scene, &p, &q) {
            self.steps.nodes += 1;
            (self.cut)([0, 0], Reason::ShadowsApart);
            return None;
        }
        let query =
            Query { scene, axes: (!scene.is_aligned()).then(|| SeparatingAxes::new(scene)) };
        seen[0].reset_to_root(&query, true);
        seen[1].reset_to_root(&query, false);
        let mut next = self.bound_or_cut(seen, [0, 0], 0);
        let mut number = 0;
        while let Some(entry) = next.take().or_else(|| queue.pop()) {
            if entry.bound >= self.limit {
                (self.cut)(view_nodes(seen, entry.views), Reason::NotBefore);
                // All remaining entries have no smaller bound: this one is the least, or the limit is not positive.
                for rest in queue.drain() {
                    (self.cut)(view_nodes(seen, rest.views), Reason::NotBefore);
                }
                break;
            }
            let (a, b) =
                (&seen[0].views[entry.views[0] as usize], &seen[1].views[entry.views[1] as usize]);
            if a.leaf && b.leaf {
                self.compare_leaves(seen, entry.views);
                (self.cut)(view_nodes(seen, entry.views), Reason::Examined);
                continue;
            }
            let split_moving = !a.leaf && (b.leaf || a.size >= b.size);
            for views in split_pair(&query, seen, entry.views, split_moving) {
                number += 1;
                let Some(child) = self.bound_or_cut(seen, views, number) else { continue };
                // The better child continues without a detour through the queue.
                match next {
                    Some(best) if best.bound < child.bound => queue.push(child),
                    Some(best) => {
                        queue.push(best);
                        next = Some(child);
                    }
                    None => next = Some(child),
                }
            }
            // Until a pair is found the search descends straight down: its gap limits the queue.
            if let (true, Some(child), Some(top)) = (self.found.is_some(), next, queue.peek())
                && top.bound < child.bound
            {
                queue.push(child);
                next = None;
            }
        }
        // The factor covers the rounding of a bound when it is stored in a proof.
        let bounds = self.limit - 1.0625 * node_rounding(scene);
        let others = self.others.min(bounds);
        self.found.map(|found| LeastGap { others, ..found.with_exact_gap(scene, self.aim) })
    }

    /// Bounds a pair of views; returns `None` and reports the reason if the pair is cut.
    fn bound_or_cut(
        &mut self,
        seen: &[NodeCache; 2],
        views: [u32; 2],
        number: u32,
    ) -> Option<QueuedPair> {
        self.steps.nodes += 1;
        match self.pair_bound(seen, views) {
            Ok(bound) => {
                Some(QueuedPair { bound: self.aim.clamp_gap(bound), number, reason: (), views })
            }
            Err(reason) => {
                (self.cut)(view_nodes(seen, views), reason);
                None
            }
        }
    }

    fn pair_bound(&self, seen: &[NodeCache; 2], [a, b]: [u32; 2]) -> Result<f64, Reason> {
        let parting = self.aim != Aim::Least;
        let (a, b) = (seen[0].view_profile(a), seen[1].view_profile(b));
        least_gap(self.scene, a, b, self.limit, parting)
    }

    /// Examines all pairs of facets of two leaves.
    fn compare_leaves(&mut self, seen: &mut [NodeCache; 2], views: [u32; 2]) {
        self.steps.leaves += 1;
        let scene = self.scene;
        let front = seen[0].leaf_facets(scene, &scene.moving, views[0]);
        let back = seen[1].leaf_facets(scene, &scene.fixed, views[1]);
        for f in &seen[0].facets[front.clone()] {
            for g in &seen[1].facets[back.clone()] {
                self.compare_facets(f, g);
            }
        }
        let nodes = view_nodes(seen, views);
        if edge_on::may_have_edge_on(scene, nodes) {
            let [f, g] = [(front, true), (back, false)].map(|(facets, moving)| {
                let k = usize::from(!moving);
                (EdgeOnFacet::of_leaf(scene, moving, nodes[k]), facets, k)
            });
            let [f, g] = [f, g].map(|(uprights, facets, k)| (uprights, &seen[k].facets[facets]));
            edge_on::each_gap(scene, (&f.0, f.1), (&g.0, g.1), &mut |pair, gap| {
                self.record_gap(pair, &gap);
            });
        }
    }

    #[inline]
    fn compare_facets(&mut self, f: &Facet, g: &Facet) {
        if let Some(gap) = leaf::facet_gap(self.scene, f, g, self.limit, self.aim.gap_filter()) {
            self.record_gap([f.triangle, g.triangle], &gap);
        }
    }

    /// Stores a gap if it is the least one found until now.
    fn record_gap(&mut self, [moving, fixed]: [u32; 2], gap: &Gap) {
        let Some(value) = self.aim.contribution(gap) else { return };
        let (at, error, others) = (gap.at, gap.error, f64::INFINITY);
        let pair = LeastGap { gap: value, moving, fixed, at, error, others };
        if value >= self.limit {
            self.set_aside(pair);
        } else {
            // Improvements that rounding errors could explain are not searched for.
            self.limit = value - SLACK * self.scene.noise;
            if let Some(before) = self.found.replace(pair) {
                self.set_aside(before);
            }
        }
    }

    /// Updates the lower bound `others` with a pair that is not the best.
    fn set_aside(&mut self, pair: LeastGap) {
        // If the limit is not positive, such a pair matters only if all gaps are wanted.
        let matters =
            pair.gap - pair.error < self.limit && (self.limit > 0.0 || self.aim == Aim::Least);
        let pair = if matters { pair.with_exact_gap(self.scene, self.aim) } else { pair };
        self.others = self.others.min(pair.gap - pair.error);
    }
}

/// Returns the maximum rounding error of a bound of two nodes.
pub(crate) fn node_rounding(scene: &PairFrame) -> f64 {
    SLACK / 3.0 * scene.noise
}

/// Computes the gap of two facets that block each other, the moving body's first, and its error. The gap is exact
/// except for its last roundings. `None` if the pair does not block; edge-on facets of open shells are included.
pub(crate) fn exact_gap(scene: &PairFrame, aim: Aim, pair: [u32; 2]) -> Option<(f64, f64)> {
    let Some(facets) = Opposed::new(scene, pair) else {
        return edge_on::least_gap_of(scene, &|gap| aim.contribution(gap).is_some(), pair);
    };
    exact_gap_of(scene, aim, &facets)
}

/// Computes the least gap of two facets that face each other, exact except for its last roundings, and its error.
/// `None` if the pair has no gap that counts for `aim`.
pub(crate) fn exact_gap_of(scene: &PairFrame, aim: Aim, facets: &Opposed) -> Option<(f64, f64)> {
    let gap = facets.exact_gap(scene, aim.gap_filter())?;
    aim.contribution(&gap)?;
    Some((gap.least, gap.error))
}

/// Returns the nodes of a pair of views.
fn view_nodes(seen: &[NodeCache; 2], views: [u32; 2]) -> [u32; 2] {
    [0, 1].map(|k| seen[k].views[views[k] as usize].projected.node)
}

/// Splits one node of a pair and returns the two new pairs.
fn split_pair(
    query: &Query,
    seen: &mut [NodeCache; 2],
    [a, b]: [u32; 2],
    moving: bool,
) -> [[u32; 2]; 2] {
    if moving {
        let first = seen[0].child_views(query, true, a);
        [[first, b], [first + 1, b]]
    } else {
        let first = seen[1].child_views(query, false, b);
        [[a, first], [a, first + 1]]
    }
}
