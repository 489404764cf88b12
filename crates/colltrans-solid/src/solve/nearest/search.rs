//! Distance of two solids, [best first](best_first) through both trees.
//!
//! - The search ends when no bound is below the *limit*: the least length found, minus [`SLACK`] noises. Without this
//!   slack, rounded bounds of nodes exactly as distant as the nearest facets would be below the limit.
//! - Every pair of nodes that is not split is a *cut* with a reason. Together the cuts form the cover, which proves
//!   that no pair of facets is nearer.

use std::collections::BinaryHeap;

use glam::DVec3;

use super::bound::{Apart, Axes, NodeExtents, NodePair};
use super::triangle::{self, Corners, GAP_NOISES, Nearest};
use super::{NearestPoints, SolidNear};
use crate::solve::scene::{PairFrame, PlacedBody};
use crate::solve::separate::HEIGHTS;
use crate::solve::steps::SolidSteps;
use colltrans_kernel::descent::{
    PairSearch, QueuedPair, VisitedNodes, best_first, node_to_split, pair_with_node,
};
use colltrans_kernel::visit_counter;

/// Distance, in noises, of the limit below the least length found.
const SLACK: f64 = 3.0;

/// The two nearest facets.
#[derive(Debug, Clone, Copy)]
pub(crate) struct NearestFacets {
    pub(crate) triangles: [u32; 2],
    pub(crate) nearest: Nearest,
}

/// Conditions under which a search may end early.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SearchEnd {
    /// Distance from which on pairs are of no interest.
    pub(crate) beyond: f64,
    /// Computed distance up to which a pair is sufficient.
    pub(crate) enough: f64,
}

impl SearchEnd {
    /// Searches for the least distance.
    pub(crate) const LEAST: Self = Self { beyond: f64::INFINITY, enough: f64::NEG_INFINITY };
}

/// Returns the facets of a leaf.
fn leaf_facets(side: &PlacedBody, node: u32) -> impl Iterator<Item = Corners> {
    side.solid.nodes()[node as usize].facets().map(|t| facet_corners(side, t))
}

/// Returns the corners of a facet in the setting frame.
pub(crate) fn facet_corners(side: &PlacedBody, triangle: usize) -> Corners {
    let vertices = side.solid.vertices();
    side.solid.triangles()[triangle].map(|v| side.matrix * vertices[v as usize] + side.offset[0])
}

/// State of a search.
pub(crate) struct DistanceSearch<'s, 'a, F: FnMut([u32; 2], Apart)> {
    scene: &'s PairFrame<'a>,
    axes: Axes,
    /// The visited nodes of each body, and the facets of their leaves.
    seen: [VisitedNodes<NodeExtents, Corners>; 2],
    until: SearchEnd,
    /// Distance from which on pairs are of no interest now.
    limit: f64,
    found: Option<NearestFacets>,
    /// Lower bound on the distance of all pairs of facets that were examined.
    examined: f64,
    /// Callback that receives every pair of nodes that is not split, and the reason.
    cut: F,
    pub(crate) steps: SolidSteps,
}

impl<'s, 'a, F: FnMut([u32; 2], Apart)> DistanceSearch<'s, 'a, F> {
    pub(crate) fn new(scene: &'s PairFrame<'a>, until: SearchEnd, cut: F) -> Self {
        Self {
            scene,
            axes: Axes::new(scene),
            seen: Default::default(),
            until,
            limit: until.beyond,
            found: None,
            examined: f64::INFINITY,
            cut,
            steps: SolidSteps::default(),
        }
    }

    /// Returns the nearest pair below the limit, if there is one, and a lower bound of the distance of all pairs. The
    /// bound is 0 if a sufficient pair ended the search.
    pub(crate) fn find_nearest(&mut self) -> (Option<NearestFacets>, f64) {
        self.seen[0].reset_to_root(NodeExtents::new(&self.axes, &self.scene.moving, 0));
        self.seen[1].reset_to_root(NodeExtents::new(&self.axes, &self.scene.fixed, 0));
        best_first(self, &mut BinaryHeap::new());
        let lower = if self.is_sufficient() { 0.0 } else { self.examined.min(self.limit).max(0.0) };
        (self.found, lower)
    }

    fn view_nodes(&self, views: [u32; 2]) -> [u32; 2] {
        [0, 1].map(|k| self.seen[k].view(views[k]).node)
    }

    /// Examines all pairs of facets of two leaves.
    fn compare_leaves(&mut self, views: [u32; 2], nodes: [u32; 2]) {
        self.steps.leaves += 1;
        let sides = [&self.scene.moving, &self.scene.fixed];
        let triangles = [0, 1].map(|k| sides[k].solid.nodes()[nodes[k] as usize].facets());
        let held =
            [0, 1].map(|k| self.seen[k].leaf_items(views[k], |_| leaf_facets(sides[k], nodes[k])));
        for (s, i) in triangles[0].clone().zip(held[0].clone()) {
            for (t, j) in triangles[1].clone().zip(held[1].clone()) {
                let (f, g) = (*self.seen[0].cached_item(i), *self.seen[1].cached_item(j));
                self.compare_facets([s as u32, t as u32], &f, &g);
            }
        }
    }

    #[inline]
    fn compare_facets(&mut self, triangles: [u32; 2], f: &Corners, g: &Corners) {
        let noise = self.scene.noise;
        // A plane with the normal of the best pair excludes most pairs near it.
        if let Some(best) = &self.found
            && triangle::gap_along(f, g, best.nearest.normal) - GAP_NOISES * noise >= self.limit
        {
            return;
        }
        let Some(nearest) = triangle::nearest_below(f, g, self.limit, noise) else { return };
        self.examined = self.examined.min(nearest.gap - GAP_NOISES * noise);
        if self.found.is_none_or(|found| nearest.length < found.nearest.length) {
            self.found = Some(NearestFacets { triangles, nearest });
            self.limit = self.limit.min(nearest.length - SLACK * noise);
        }
    }
}

impl<F: FnMut([u32; 2], Apart)> PairSearch for DistanceSearch<'_, '_, F> {
    type Reason = Apart;
    const PREFERS_FIRST_OF_EQUALS: bool = true;

    #[inline]
    fn bound_limit(&self) -> f64 {
        self.limit
    }

    #[inline]
    fn is_found(&self) -> bool {
        self.found.is_some()
    }

    #[inline]
    fn is_sufficient(&self) -> bool {
        self.found.is_some_and(|found| found.nearest.length <= self.until.enough)
    }

    #[inline]
    fn lower_bound(&mut self, [i, j]: [u32; 2]) -> Option<(f64, Apart)> {
        visit_counter::count_visits(1);
        self.steps.nodes += 1;
        let (moving, fixed) = (self.seen[0].view(i), self.seen[1].view(j));
        let pair = NodePair { scene: self.scene, axes: &self.axes, moving, fixed };
        let (bound, reason) = pair.best_bound(self.limit);
        if bound >= self.limit {
            (self.cut)([moving.node, fixed.node], reason);
            return None;
        }
        Some((bound, reason))
    }

    #[inline]
    fn split_pair(&mut self, views: [u32; 2]) -> Option<[[u32; 2]; 2]> {
        let [a, b] = [0, 1].map(|k| self.seen[k].view(views[k]));
        let nodes = [a.node, b.node];
        let Some(which) = node_to_split([a.leaf, b.leaf], |k| [a.size, b.size][k]) else {
            self.compare_leaves(views, nodes);
            (self.cut)(nodes, Apart::Examined);
            return None;
        };
        let (axes, side) = (&self.axes, self.scene.side(which == 0));
        let parts = side.solid.nodes()[nodes[which] as usize].child_positions(nodes[which]);
        let views_of =
            self.seen[which].children(views[which], |_, k| NodeExtents::new(axes, side, parts[k]));
        Some(views_of.map(|part| pair_with_node(views, which, part)))
    }

    fn skip_pair(&mut self, entry: &QueuedPair<Apart>) {
        let nodes = self.view_nodes(entry.views);
        (self.cut)(nodes, entry.reason);
    }
}

/// Returns the lower bound, proven by `reason`, of the distance of all facets of two nodes. `near` proves the upper bound
/// of the distance of the bodies, by facets that exist.
pub(crate) fn proven_bound(
    (scene, axes): (&PairFrame, &Axes),
    near: &SolidNear,
    nodes: [u32; 2],
    reason: Apart,
) -> f64 {
    if reason == Apart::NearestPlane {
        return match *near {
            SolidNear::Points { triangles, .. } => {
                nearest_plane_bound(scene, triangles, |side, local| {
                    max_height_of_node(side, nodes[usize::from(!side.moving)], local)
                })
            }
            SolidNear::Meeting(_) => 0.0,
        };
    }
    if reason != Apart::Examined {
        let moving = NodeExtents::new(axes, &scene.moving, nodes[0]);
        let fixed = NodeExtents::new(axes, &scene.fixed, nodes[1]);
        return NodePair { scene, axes, moving: &moving, fixed: &fixed }.distance_bound(reason);
    }
    let mut least = f64::INFINITY;
    for f in leaf_facets(&scene.moving, nodes[0]) {
        for g in leaf_facets(&scene.fixed, nodes[1]) {
            least = least
                .min(triangle::nearest_points(&f, &g, scene.noise).gap - GAP_NOISES * scene.noise);
        }
    }
    least.max(0.0)
}

/// Returns a lower bound of the distance of two bodies: the gap of the plane between two of their facets. `max_height`
/// returns the largest height of the vertices of a body along a vector of its frame. Returns 0 if the plane does not
/// separate the bodies.
pub(crate) fn nearest_plane_bound(
    scene: &PairFrame,
    triangles: [u32; 2],
    max_height: impl Fn(&PlacedBody, DVec3) -> f64,
) -> f64 {
    let normal = NearestPoints::from_triangles(scene, triangles).nearest.normal;
    let height =
        |side: &PlacedBody, normal: DVec3| max_height(side, side.matrix.transpose() * normal);
    let (moving, fixed) = (height(&scene.moving, normal), height(&scene.fixed, -normal));
    // One noise covers the length of the normal.
    let gap = normal.dot(scene.fixed.offset[0]) - fixed - moving - (HEIGHTS + 1.0) * scene.noise;
    if gap.is_nan() { 0.0 } else { gap.max(0.0) }
}

/// Returns the largest height of the vertices of a node along a vector of the frame of its body.
pub(crate) fn max_height_of_node(side: &PlacedBody, node: u32, local: DVec3) -> f64 {
    let facets = side.solid.nodes()[node as usize].facets();
    let vertices = side.solid.triangles()[facets].as_flattened();
    let heights = vertices.iter().map(|v| local.dot(side.offset_vertex(*v)));
    heights.fold(f64::NEG_INFINITY, f64::max)
}
