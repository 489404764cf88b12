//! [Best first](best_first) through both trees.
//!
//! Bounds of gaps that block are clamped at 0, so that a contact at the start is found by going straight down. The search
//! ends when no bound is smaller than the best gap found. Every pair of nodes that is not split is a *cut*, with its
//! reason: together they are the proof that nothing blocks earlier.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use super::bound::{Profile, Reason, dismissed, least_gap};
use super::leaf::{self, Facet, Gap, Meeting, Opposed, Wanted};
use super::projected::Projected;
use super::rim::{self, Upright};
use super::scene::Scene;
use super::separate;
use super::separating_axes::{Reach, SeparatingAxes};
use crate::solve::steps::SolidSteps;
use colltrans_kernel::descent::{self, Entry, Pairs, best_first, node_to_split, replaced};

/// An answer may be larger than the least gap by so many times the noise of coordinates: bounds of
/// nodes are rounded by a third of that.
pub(crate) const SLACK: f64 = 12.0;

/// What is looked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Aim {
    /// The least gap that blocks, at least 0.
    Stop,
    /// The same, without pairs of facets that cross now.
    LaterStop,
    /// The least gap of all pairs of facets that face each other.
    Least,
}

impl Aim {
    pub(crate) fn clamp(self, gap: f64) -> f64 {
        if self == Self::Least { gap } else { gap.max(0.0) }
    }

    pub(crate) fn wanted(self) -> Wanted {
        match self {
            Self::Least => Wanted::All,
            Self::Stop => Wanted::NotParting,
            Self::LaterStop => Wanted::NotCrossing,
        }
    }

    /// What a pair contributes, if it counts.
    pub(crate) fn value(self, gap: &Gap) -> Option<f64> {
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
pub(crate) struct Found {
    /// The gap, as a length.
    pub(crate) gap: f64,
    pub(crate) moving: u32,
    pub(crate) fixed: u32,
    pub(crate) at: Meeting,
    pub(crate) error: f64,
    /// No other pair contributes less: their gaps less their errors, and the limit up to which bounds
    /// were looked at, less what bounds are off by.
    pub(crate) others: f64,
}

impl Found {
    /// The same where no pair contributes less by more than a search may leave open.
    pub(crate) fn among_all(self, scene: &Scene) -> Self {
        Self { others: self.gap - SLACK * scene.noise - 1.0625 * node_rounding(scene), ..self }
    }

    /// The same with the gap taken exactly, if it is not sharp.
    pub(crate) fn sharpened(self, scene: &Scene, aim: Aim) -> Self {
        if self.at == Meeting::Near || self.error <= leaf::FINE * scene.noise {
            return self;
        }
        let f = Facet::facing(scene, true, self.moving as usize, Ordering::Greater);
        let g = Facet::facing(scene, false, self.fixed as usize, Ordering::Less);
        let (Some(f), Some(g)) = (f, g) else { return self };
        let (least, at) = leaf::least_exactly(scene, &f, &g);
        Self { gap: aim.clamp(least), at, error: 0.0, ..self }
    }
}

/// The queue of a search and what it has seen of both bodies, which can be kept from one query to the
/// next: then a query allocates nothing.
#[derive(Debug, Clone, Default)]
pub struct Workspace {
    queue: BinaryHeap<Entry>,
    /// Of the moving body, and of the fixed one.
    seen: [Seen; 2],
}

/// What all of a search is about.
struct Query<'s, 'a> {
    scene: &'s Scene<'a>,
    /// `None` where boxes say all that it could.
    axes: Option<SeparatingAxes>,
}

impl Query<'_, '_> {
    /// Takes a node into the query frame, and notes how far it reaches.
    fn look(&self, moving: bool, at: u32, reaches: &mut Vec<Reach>) -> View {
        let side = self.scene.side(moving);
        let node = &side.solid.nodes()[at as usize];
        let (leaf, size) = (node.is_leaf(), node.size());
        let projected = Projected::new(self.scene, side, at as usize);
        if let Some(axes) = &self.axes {
            reaches.push(axes.reach(side, &projected));
        }
        View { projected, leaf, size }
    }
}

/// What a search has seen of a body.
#[derive(Debug, Clone, Default)]
struct Seen {
    /// The nodes that it has come to, and the facets of leaves that look the right way.
    nodes: descent::Seen<View, Facet>,
    /// Of all views, or of none.
    reaches: Vec<Reach>,
}

/// A node in the query frame.
#[derive(Debug, Clone, Copy)]
struct View {
    projected: Projected,
    leaf: bool,
    size: f64,
}

impl Seen {
    fn start(&mut self, query: &Query, moving: bool) {
        self.reaches.clear();
        self.nodes.start(query.look(moving, 0, &mut self.reaches));
    }

    fn profile(&self, view: u32) -> Profile<'_> {
        let projected = &self.nodes.view(view).projected;
        Profile { projected, reach: self.reaches.get(view as usize) }
    }
}

/// One search under way.
pub(crate) struct Search<'s, 'a, F: FnMut([u32; 2], Reason)> {
    pub(crate) scene: &'s Scene<'a>,
    pub(crate) aim: Aim,
    /// What a gap has to stay below to be of interest.
    pub(crate) limit: f64,
    pub(crate) found: Option<Found>,
    /// The least of the gaps of pairs that were looked at and are not `found`, each less its error.
    pub(crate) others: f64,
    /// Told of every pair of nodes that is not split, and why.
    pub(crate) cut: F,
    pub(crate) steps: SolidSteps,
}

impl<'s, 'a, F: FnMut([u32; 2], Reason)> Search<'s, 'a, F> {
    pub(crate) fn new(scene: &'s Scene<'a>, aim: Aim, limit: f64, cut: F) -> Self {
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

    /// What two triangles make.
    pub(crate) fn of_pair(mut self, [s, t]: [u32; 2]) -> Option<Found> {
        let scene = self.scene;
        let f = Facet::facing(scene, true, s as usize, Ordering::Greater);
        let g = Facet::facing(scene, false, t as usize, Ordering::Less);
        if let (Some(f), Some(g)) = (&f, &g) {
            self.facets(f, g);
        } else {
            rim::each_gap_of(scene, [s, t], &mut |pair, gap| self.take(pair, &gap));
        }
        self.found.map(|found| found.sharpened(scene, self.aim))
    }

    pub(crate) fn run(&mut self, workspace: &mut Workspace) -> Option<Found> {
        let Workspace { queue, seen } = workspace;
        let scene = self.scene;
        let [p, q] = Projected::roots(scene);
        if let Some(reason) = dismissed(&p, &q, self.limit, self.aim != Aim::Least) {
            // Most pairs of parts: no need for the directions of the query.
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
        seen[0].start(&query, true);
        seen[1].start(&query, false);
        best_first(&mut Descent { search: self, query, seen }, queue);
        // A little more, for the roundings of a bound on its way into a proof.
        let bounds = self.limit - 1.0625 * node_rounding(scene);
        let others = self.others.min(bounds);
        self.found.map(|found| Found { others, ..found.sharpened(scene, self.aim) })
    }

    fn bound(&self, seen: &[Seen; 2], [a, b]: [u32; 2]) -> Result<f64, Reason> {
        let parting = self.aim != Aim::Least;
        let (a, b) = (seen[0].profile(a), seen[1].profile(b));
        least_gap(self.scene, a, b, self.limit, parting)
    }

    /// All pairs of facets of two leaves.
    fn leaves(&mut self, seen: &mut [Seen; 2], views: [u32; 2]) {
        self.steps.leaves += 1;
        let scene = self.scene;
        let [front, back] = [0, 1].map(|k| {
            let (moving, wanted) = [(true, Ordering::Greater), (false, Ordering::Less)][k];
            let facing = |t| Facet::facing(scene, moving, t, wanted);
            let all = |view: &View| {
                let nodes = scene.side(moving).solid.nodes();
                nodes[view.projected.node as usize].facets().filter_map(facing)
            };
            seen[k].nodes.leaf(views[k], all)
        });
        for f in seen[0].nodes.items(front.clone()) {
            for g in seen[1].nodes.items(back.clone()) {
                self.facets(f, g);
            }
        }
        let nodes = nodes(seen, views);
        if rim::matters(scene, nodes) {
            let [f, g] = [(front, true), (back, false)].map(|(facets, moving)| {
                let k = usize::from(!moving);
                (Upright::of_leaf(scene, moving, nodes[k]), facets, k)
            });
            let [f, g] =
                [f, g].map(|(uprights, facets, k)| (uprights, seen[k].nodes.items(facets)));
            rim::each_gap(scene, (&f.0, f.1), (&g.0, g.1), &mut |pair, gap| self.take(pair, &gap));
        }
    }

    #[inline]
    fn facets(&mut self, f: &Facet, g: &Facet) {
        if let Some(gap) = leaf::gap(self.scene, f, g, self.limit, self.aim.wanted()) {
            self.take([f.triangle, g.triangle], &gap);
        }
    }

    /// A gap, if it is the least so far.
    fn take(&mut self, [moving, fixed]: [u32; 2], gap: &Gap) {
        let Some(value) = self.aim.value(gap) else { return };
        let (at, error, others) = (gap.at, gap.error, f64::INFINITY);
        let pair = Found { gap: value, moving, fixed, at, error, others };
        if value >= self.limit {
            self.set_aside(pair);
        } else {
            // What could be better by less is not worth a look: rounding is as much.
            self.limit = value - SLACK * self.scene.noise;
            if let Some(before) = self.found.replace(pair) {
                self.set_aside(before);
            }
        }
    }

    /// A pair that is not the best: how much less than the best it might be is kept.
    fn set_aside(&mut self, pair: Found) {
        // Below 0 nothing is of interest, unless all is.
        let matters =
            pair.gap - pair.error < self.limit && (self.limit > 0.0 || self.aim == Aim::Least);
        let pair = if matters { pair.sharpened(self.scene, self.aim) } else { pair };
        self.others = self.others.min(pair.gap - pair.error);
    }
}

/// What bounds of nodes may be off by.
pub(crate) fn node_rounding(scene: &Scene) -> f64 {
    SLACK / 3.0 * scene.noise
}

/// The gap of two facets that block each other, the moving body's first, exact but for its last roundings,
/// with its error: of their shadows, or of what is on edge.
pub(crate) fn exact_gap(scene: &Scene, aim: Aim, pair: [u32; 2]) -> Option<(f64, f64)> {
    let Some(facets) = Opposed::new(scene, pair) else {
        return rim::least_gap_of(scene, &|gap| aim.value(gap).is_some(), pair);
    };
    exact_gap_of(scene, aim, &facets)
}

/// The same of two facets that look the right way.
pub(crate) fn exact_gap_of(scene: &Scene, aim: Aim, facets: &Opposed) -> Option<(f64, f64)> {
    let gap = facets.exact_gap(scene, aim.wanted())?;
    aim.value(&gap)?;
    Some((gap.least, gap.error))
}

/// The nodes of a pair.
fn nodes(seen: &[Seen; 2], views: [u32; 2]) -> [u32; 2] {
    [0, 1].map(|k| seen[k].nodes.view(views[k]).projected.node)
}

/// A search on its way down both trees.
struct Descent<'d, 's, 'a, F: FnMut([u32; 2], Reason)> {
    search: &'d mut Search<'s, 'a, F>,
    query: Query<'s, 'a>,
    seen: &'d mut [Seen; 2],
}

impl<F: FnMut([u32; 2], Reason)> Pairs for Descent<'_, '_, '_, F> {
    type Reason = ();
    const FIRST_OF_EQUALS: bool = false;

    #[inline]
    fn limit(&self) -> f64 {
        self.search.limit
    }

    #[inline]
    fn is_found(&self) -> bool {
        self.search.found.is_some()
    }

    #[inline]
    fn bound(&mut self, views: [u32; 2]) -> Option<(f64, ())> {
        self.search.steps.nodes += 1;
        match self.search.bound(self.seen, views) {
            Ok(bound) => Some((self.search.aim.clamp(bound), ())),
            Err(reason) => {
                (self.search.cut)(nodes(self.seen, views), reason);
                None
            }
        }
    }

    #[inline]
    fn split(&mut self, views: [u32; 2]) -> Option<[[u32; 2]; 2]> {
        let [a, b] = [0, 1].map(|k| self.seen[k].nodes.view(views[k]));
        let Some(which) = node_to_split([a.leaf, b.leaf], |k| [a.size, b.size][k]) else {
            self.search.leaves(self.seen, views);
            (self.search.cut)(nodes(self.seen, views), Reason::Examined);
            return None;
        };
        let (query, moving) = (&self.query, which == 0);
        let Seen { nodes, reaches } = &mut self.seen[which];
        let parts = nodes.children(views[which], |view, k| {
            let at = view.projected.node;
            let node = &query.scene.side(moving).solid.nodes()[at as usize];
            query.look(moving, node.children(at)[k], reaches)
        });
        Some(parts.map(|part| replaced(views, which, part)))
    }

    fn dismiss(&mut self, entry: &Entry) {
        (self.search.cut)(nodes(self.seen, entry.views), Reason::NotBefore);
    }
}
