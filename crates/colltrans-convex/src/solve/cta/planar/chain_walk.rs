//! Walks along two facing chains, edge by edge, to where the gap closes or is least.
//!
//! The left chain `l` of the section on the right is convex, the right chain `r` of the section on the left is
//! concave. Therefore `gap(h) = l(h) - r(h)` is convex:
//!
//! - where the gap is positive and falls, the answer is above,
//! - where it is not positive, or does not fall, the answer is below.
//!
//! The edges at the answer prove it, independent of the start of the walk. Either they are the first pair, from below,
//! that crosses, or the gap is positive and least at their vertex: to each side of it, the gap does not decrease or a
//! chain ends.

use glam::DVec2;

use super::{Crossing, PlanarAnswer};
use crate::solve::cta::crossing::{Chain, SectionEdge};
use crate::solve::cta::section::{Located, STEPS_BEFORE_SEARCH, Section};
use colltrans_kernel::noise;

/// Maximum number of steps of Newton's method.
const NEWTON_STEPS: usize = 4;

/// Returns the contact of two crossing edges.
pub(super) fn edge_contact(edges: &[SectionEdge; 2]) -> PlanarAnswer {
    PlanarAnswer::Edges { edges: *edges, contact: line_intersection(edges) }
}

/// Returns the body whose edge begins higher.
fn higher_start(edges: &[SectionEdge; 2]) -> usize {
    usize::from(edges[1].low.h() > edges[0].low.h())
}

fn line_intersection([r, s]: &[SectionEdge; 2]) -> DVec2 {
    let step = (s.low.w - r.low.w).perp_dot(s.direction) / r.direction.perp_dot(s.direction);
    r.low.w + r.direction * step
}

/// Two facing chains.
pub(super) struct FacingChains<'a, 'b> {
    sections: &'a [Section<'b>; 2],
    /// Chain of each body that faces the other body.
    chains: [Chain; 2],
    /// Body on the right.
    right: usize,
}

/// Result of a walk along two chains.
#[expect(clippy::large_enum_variant, reason = "a query allocates nothing")]
pub(super) enum ChainWalk {
    /// The answer.
    Solved(PlanarAnswer),
    /// The walk has reached the bottom of this body's section, and the bottom is not beyond the edge of the other
    /// body.
    Within(usize),
}

impl<'a, 'b> FacingChains<'a, 'b> {
    /// Chooses the facing chains if body `right` is on the right.
    pub(super) fn new(sections: &'a [Section<'b>; 2], right: usize) -> Self {
        let mut chains = [Chain::Right; 2];
        chains[right] = Chain::Left;
        Self { sections, chains, right }
    }

    /// Finds the edges at a height, or the nearest ones, from half-edges upwards, and stores them in `edges`. `None` if a
    /// walk fails.
    pub(super) fn edges_at_height(
        &self,
        height: f64,
        from: [u32; 2],
        edges: &mut [SectionEdge; 2],
    ) -> Option<()> {
        for (body, edge) in edges.iter_mut().enumerate() {
            self.sections[body].edge_at_height(self.chains[body], height, from[body], edge)?;
        }
        Some(())
    }

    /// Goes from two edges towards the height at which the gap closes, by Newton's method. Because the gap is
    /// convex, all steps but the first come from below. Only for bodies with chains, on which a walk may be
    /// long.
    fn approach_by_newton(&self, edges: &mut [SectionEdge; 2]) {
        if !self.has_chains() {
            return;
        }
        for _ in 0..NEWTON_STEPS {
            let h = line_intersection(edges).x;
            let is_there = edges.iter().all(|edge| edge.low.h() <= h && h <= edge.high.h());
            if is_there || !self.gap_closes(edges) {
                break;
            }
            let Some(next) = self.move_to_height(h, edges) else { break };
            *edges = next;
        }
    }

    /// Finds the edges at a height from others on the same chains. `None` if a walk fails.
    fn move_to_height(&self, h: f64, from: &[SectionEdge; 2]) -> Option<[SectionEdge; 2]> {
        let mut edges = *from;
        for (body, edge) in edges.iter_mut().enumerate() {
            self.sections[body].walk_to_height(self.chains[body], h, edge)?;
        }
        Some(edges)
    }

    fn has_chains(&self) -> bool {
        self.sections.iter().any(|section| section.side.sections.chains().is_some())
    }

    /// Skips edges along the chain of a body by a search: up to the last vertex at which the gap is positive
    /// and falls, or down to the last vertex at which it is not positive or does not fall. Returns the edge
    /// there and the other chain's edge at its height. `None` if the body has no chains or no edge is skipped.
    fn skip_along_chain(
        &self,
        body: usize,
        is_up: bool,
        from: &[SectionEdge; 2],
    ) -> Option<[SectionEdge; 2]> {
        let section = &self.sections[body];
        let chain = self.chains[body];
        let mut other = from[1 - body];
        let along = if is_up { chain } else { chain.opposite() };
        let start = from[body].low.h();
        let last = section.last_vertex_where(along, &from[body].low, |v| {
            if if is_up { v.h() < start } else { v.h() > start } {
                return false;
            }
            let edge = SectionEdge::new(*v, section.next_vertex(chain, v));
            let mut beside = other;
            let located =
                self.sections[1 - body].walk_to_height(self.chains[1 - body], v.h(), &mut beside);
            if located != Some(Located::AtHeight) {
                return false;
            }
            let mut edges = [edge; 2];
            edges[1 - body] = beside;
            let falls = beside.low.h() > v.h()
                || chain.is_ascending(edge.direction)
                    && self.is_on_own_side(body, v, &edges)
                    && self.gap_closes(&edges);
            let mut below = edge;
            let ahead = if is_up { falls } else { !falls && self.move_below(body, &mut below) };
            other = if ahead { beside } else { other };
            ahead
        })?;
        if last.half_edge == from[body].low.half_edge {
            return None;
        }
        let mut edges = [SectionEdge::new(last, section.next_vertex(chain, &last)); 2];
        let before = &from[1 - body];
        edges[1 - body] = if is_up && other.low.h() < before.low.h() { *before } else { other };
        Some(edges)
    }

    /// Walks from any edges down to a height at which the gap is positive and falls, and from there up to the answer.
    /// `None` if a walk fails.
    pub(super) fn walk_to_answer(&self, edges: &mut [SectionEdge; 2]) -> Option<ChainWalk> {
        self.approach_by_newton(edges);
        for step in 1..=self.max_steps() {
            let upper = higher_start(edges);
            let lower = 1 - upper;
            if step % STEPS_BEFORE_SEARCH == 0 {
                let top = edges[lower].high.h();
                if edges[upper].low.h() <= top {
                    if let Some(skipped) = self.skip_along_chain(upper, false, edges) {
                        *edges = skipped;
                    }
                } else if self.has_chains() {
                    let section = &self.sections[upper];
                    section.walk_to_height(self.chains[upper], top, &mut edges[upper])?;
                }
                if higher_start(edges) != upper {
                    continue;
                }
            }
            if edges[upper].low.h() > edges[lower].high.h() {
                if !self.move_below(upper, &mut edges[upper])
                    && !self.move_above(lower, &mut edges[lower])
                {
                    let [bottom, top] = [&edges[upper].low, &edges[lower].high];
                    return Some(ChainWalk::Solved(PlanarAnswer::separated_by_height(
                        upper, bottom, top,
                    )));
                }
                continue;
            }
            let is_apart = self.is_on_own_side(upper, &edges[upper].low, edges);
            if is_apart && self.gap_closes(edges) {
                return self.walk_up(edges).map(ChainWalk::Solved);
            }
            let supports = edges.each_ref().map(|edge| edge.low);
            if !self.move_below(upper, &mut edges[upper]) {
                return Some(if is_apart {
                    ChainWalk::Solved(self.separation_along(&edges[lower], supports))
                } else {
                    ChainWalk::Within(upper)
                });
            }
            if is_apart && self.gap_closes(edges) {
                return Some(ChainWalk::Solved(self.separation_along(&edges[lower], supports)));
            }
        }
        None
    }

    /// Walks up from edges where the gap is positive. `None` after the maximum number of steps.
    pub(super) fn walk_up(&self, edges: &mut [SectionEdge; 2]) -> Option<PlanarAnswer> {
        // Body whose vertex was passed last.
        let mut passed = higher_start(edges);
        for step in 1..=self.max_steps() {
            if step % STEPS_BEFORE_SEARCH == 0 {
                let ending = usize::from(edges[1].high.h() < edges[0].high.h());
                if let Some(skipped) = self.skip_along_chain(ending, true, edges) {
                    *edges = skipped;
                }
            }
            if !self.gap_closes(edges) {
                let supports = edges.each_ref().map(|edge| edge.low);
                return Some(self.separation_along(&edges[1 - passed], supports));
            }
            // The edge that ends first decides without a quotient whether the edges meet.
            let ending = usize::from(edges[1].high.h() < edges[0].high.h());
            if !self.is_on_own_side(ending, &edges[ending].high, edges) {
                return Some(edge_contact(edges));
            }
            if !self.move_above(ending, &mut edges[ending]) {
                let mut supports = edges.each_ref().map(|edge| edge.low);
                supports[ending] = edges[ending].high;
                return Some(self.separation_along(&edges[1 - ending], supports));
            }
            passed = ending;
        }
        None
    }

    fn max_steps(&self) -> usize {
        self.sections[0].max_steps.saturating_add(self.sections[1].max_steps)
    }

    /// Checks whether a vertex of a body's chain is on its own side of the other body's edge.
    fn is_on_own_side(&self, body: usize, vertex: &Crossing, edges: &[SectionEdge; 2]) -> bool {
        let side = edges[1 - body].signed_side(vertex.w);
        if body == self.right { side > 0.0 } else { side < 0.0 }
    }

    /// Checks whether the gap falls along these edges, by more than rounding.
    pub(super) fn gap_closes(&self, edges: &[SectionEdge; 2]) -> bool {
        let [r, s] = [&edges[1 - self.right].direction, &edges[self.right].direction];
        let sine = r.perp_dot(*s);
        sine < 0.0
            && sine * sine
                > noise::SECTION * noise::SECTION * r.length_squared() * s.length_squared()
    }

    /// Moves an edge up the chain of a body. Returns `false` at its top.
    fn move_above(&self, body: usize, edge: &mut SectionEdge) -> bool {
        self.sections[body].move_above(self.chains[body], edge)
    }

    /// Moves an edge down the chain of a body. Returns `false` at its bottom.
    fn move_below(&self, body: usize, edge: &mut SectionEdge) -> bool {
        self.sections[body].move_below(self.chains[body], edge)
    }

    /// Returns the separation by a line along the edge `along`, with these closest vertices.
    pub(super) fn separation_along(
        &self,
        along: &SectionEdge,
        supports: [Crossing; 2],
    ) -> PlanarAnswer {
        // Points to the right, where g grows, and from body 0 to body 1.
        let sign = if self.right == 1 { 1.0 } else { -1.0 };
        // Its length is arbitrary, and is kept in range.
        let across = DVec2::new(-along.direction.y, along.direction.x);
        let u = across * (sign / across.abs().element_sum());
        PlanarAnswer::Separated { u, supports }
    }
}
