//! The planar problem: the lowest point of the intersection of two convex polygons, or a line that separates
//! them (the paper, section III-B).
//!
//! - *Section* 0 is that of P at level `x`, section 1 that of Q at level `y`, in the shadow plane `w = (h, g)`.
//! - The *upper* section has the higher bottom, at height `h0`.
//! - If this bottom lies in the other section, it is the answer. Otherwise one section is to the left of the
//!   other at `h0`. The answer is where the two facing chains first meet, or where the gap between them is
//!   least.
//!
//! The edges that determine an answer prove it. Therefore the search starts near guessed edges: those of the
//! preceding problem if its levels are near, else those of [`guess_from_snapshots()`].

mod chain_walk;
mod snapshot_guess;

use glam::DVec2;

use super::crossing::{Chain, Crossing, SectionEdge};
use super::section::{Located, Section, SectionBottom};
use super::sectioned_body::SectionedBody;
use chain_walk::{ChainWalk, FacingChains, edge_contact};
use snapshot_guess::guess_from_snapshots;

/// Maximum number of steps of a walk from the answer of the preceding problem.
const MAX_STEPS_FROM_HINT: usize = 8;

/// Answer of the planar problem. Bodies are given by index.
#[derive(Debug, Clone, Copy)]
pub(super) enum PlanarAnswer {
    /// The bottom `vertex` of section `upper` lies in the other section, between the edges `left` and `right`.
    Vertex { upper: usize, vertex: Crossing, left: SectionEdge, right: SectionEdge },
    /// Two edges cross in the lowest common point.
    Edges { edges: [SectionEdge; 2], contact: DVec2 },
    /// The sections have no point in common: along `u`, each point of section 1 is beyond each point of section
    /// 0. `supports` are the closest vertices along `u`.
    Separated { u: DVec2, supports: [Crossing; 2] },
}

/// Guess of an answer from pieces and from the preceding problem.
#[derive(Debug, Clone, Copy)]
pub(super) struct PlanarHint {
    /// Height at which the answer probably is, or a height below it.
    pub(super) height: f64,
    /// Levels of the preceding problem.
    pub(super) levels: [f64; 2],
    pub(super) last: LastAnswer,
}

/// Answer of the preceding problem. Its edges and its vertex are given by half-edges upwards that cross its levels.
#[derive(Debug, Clone, Copy)]
pub(super) enum LastAnswer {
    /// No answer is known.
    Nothing,
    /// The sections faced each other, with section `right` on the right.
    Facing { right: usize, edges: [u32; 2] },
    /// The bottom of section `upper` lay in the other section, between two edges.
    Bottom { upper: usize, vertex: u32, between: [u32; 2] },
}

impl PlanarHint {
    /// The empty hint: no height, no levels and no answer.
    pub(super) const NONE: Self =
        Self { height: f64::NEG_INFINITY, levels: [f64::NAN; 2], last: LastAnswer::Nothing };
}

/// Solves the planar problem for the sections at `levels`, each in the range of its body. `None` if rounding
/// errors of the mesh hide a section.
pub(super) fn solve_planar(
    sides: &[SectionedBody; 2],
    levels: [f64; 2],
    hint: &PlanarHint,
) -> Option<PlanarAnswer> {
    let problem = |max_steps: usize| {
        let section = |body: usize| Section { side: &sides[body], level: levels[body], max_steps };
        SectionProblem { sections: [section(0), section(1)] }
    };
    let near = |body: usize| (levels[body] - hint.levels[body]).abs() <= sides[body].near_distance;
    if near(0)
        && near(1)
        && let Some(found) = problem(MAX_STEPS_FROM_HINT).solve_from_guess(&hint.last, hint.height)
    {
        return Some(found);
    }
    // A walk with more steps along one section runs in circles.
    let [p, q] = sides.each_ref().map(|side| side.topology.edge_count());
    let problem = problem(p + q);
    let (guess, height) = guess_from_snapshots(&problem.sections)?;
    problem.solve_from_guess(&guess, height)
}

/// Returns the edge contact in which the section edges on two faces, given by half-edges, cross. `None` if a face has no
/// such edge, if the edges do not approach each other, or if their lines cross farther than `tolerance` from an edge.
pub(super) fn solve_on_faces(
    sides: &[SectionedBody; 2],
    levels: [f64; 2],
    faces: [u32; 2],
    tolerance: f64,
) -> Option<PlanarAnswer> {
    let section = |body: usize| Section { side: &sides[body], level: levels[body], max_steps: 0 };
    let sections = [section(0), section(1)];
    let (of_p, p) = sections[0].edge_on_face(faces[0])?;
    let (of_q, q) = sections[1].edge_on_face(faces[1])?;
    let chains = FacingChains::new(&sections, usize::from(of_q == Chain::Left));
    let edges = [p, q];
    if of_p == of_q || !chains.gap_closes(&edges) {
        return None;
    }
    let answer = edge_contact(&edges);
    let PlanarAnswer::Edges { contact, .. } = answer else { return None };
    edges.iter().all(|edge| edge.is_beside(contact, tolerance)).then_some(answer)
}

/// Two sections, and the maximum number of steps along them.
struct SectionProblem<'a> {
    sections: [Section<'a>; 2],
}

impl SectionProblem<'_> {
    /// Solves the problem from edges that may determine the answer, at the guessed height. `None` if there is
    /// no guess or a walk fails.
    fn solve_from_guess(&self, guess: &LastAnswer, height: f64) -> Option<PlanarAnswer> {
        match *guess {
            LastAnswer::Nothing => None,
            LastAnswer::Facing { right, edges } => {
                let chains = FacingChains::new(&self.sections, right);
                let from = edges;
                let mut edges = [SectionEdge::default(); 2];
                chains.edges_at_height(height, from, &mut edges)?;
                match chains.walk_to_answer(&mut edges)? {
                    ChainWalk::Solved(found) => Some(found),
                    ChainWalk::Within(upper) => {
                        let between = [edges[1 - upper].low.half_edge; 2];
                        self.solve_at_bottom(upper, edges[upper].low.half_edge, between, true)
                    }
                }
            }
            LastAnswer::Bottom { upper, vertex, between } => {
                self.solve_at_bottom(upper, vertex, between, false)
            }
        }
    }

    /// Solves the problem for the bottom of section `upper` and the two edges of the other section at the height of
    /// this bottom. The search for the bottom starts at the half-edge `vertex`, that for the edges at the half-edges
    /// `between`.
    ///
    /// If the bottom of the other section is higher, exchanges the sections, unless `is_upper_known`. `None` if a walk
    /// fails.
    fn solve_at_bottom(
        &self,
        upper: usize,
        vertex: u32,
        between: [u32; 2],
        is_upper_known: bool,
    ) -> Option<PlanarAnswer> {
        let lower = &self.sections[1 - upper];
        let bottom = self.sections[upper].find_bottom(vertex)?;
        let h0 = bottom.vertex.h();
        let ends = self.bottom_ends(upper, &bottom);
        let mut edges = [SectionEdge::default(); 2];
        let chains = [Chain::Left, Chain::Right].into_iter().zip(between);
        for ((chain, from), edge) in chains.zip(&mut edges) {
            let located = lower.edge_at_height(chain, h0, from, edge)?;
            if located == Located::AboveTop {
                let [bottom, top] = [&bottom.vertex, &edge.high];
                return Some(PlanarAnswer::separated_by_height(upper, bottom, top));
            }
            if edge.low.h() > h0 && !is_upper_known {
                return self.solve_at_bottom(1 - upper, edge.low.half_edge, [vertex; 2], true);
            }
            if let Some(end) = end_beyond_chain(chain, edge, h0, &ends) {
                return self.solve_facing(upper, *end, chain, *edge);
            }
        }
        Some(bottom_contact(upper, &ends, edges, h0))
    }

    /// Returns both ends of a section's bottom, from left to right.
    fn bottom_ends(&self, upper: usize, bottom: &SectionBottom) -> [Crossing; 2] {
        [Chain::Left, Chain::Right].map(|chain| self.sections[upper].bottom_end(bottom, chain))
    }

    /// Solves the problem if the upper section's bottom is beyond `chain` of the lower one. `end` is the end of
    /// the bottom that faces this chain, `edge` the chain's edge at its height.
    fn solve_facing(
        &self,
        upper: usize,
        end: Crossing,
        chain: Chain,
        edge: SectionEdge,
    ) -> Option<PlanarAnswer> {
        let facing = chain.opposite();
        let first = SectionEdge::new(end, self.sections[upper].next_vertex(facing, &end));
        // The body whose left chain faces the other body is on the right.
        let right = if chain == Chain::Left { 1 - upper } else { upper };
        let chains = FacingChains::new(&self.sections, right);
        let mut edges = order_by_body(upper, first, edge);
        if chains.gap_closes(&edges) {
            chains.walk_up(&mut edges)
        } else {
            Some(chains.separation_along(&edge, order_by_body(upper, end, edge.low)))
        }
    }
}

/// Returns the end of the upper section's bottom that faces `chain` of the lower section. `None` if this end is
/// not beyond the chain.
fn end_beyond_chain<'c>(
    chain: Chain,
    edge: &SectionEdge,
    h0: f64,
    [left, right]: &'c [Crossing; 2],
) -> Option<&'c Crossing> {
    let g = edge.g_at(h0);
    match chain {
        Chain::Left => (right.g() < g).then_some(right),
        Chain::Right => (left.g() > g).then_some(left),
    }
}

/// Returns the answer if the upper section's bottom lies between two edges of the lower one, or extends beyond
/// both.
fn bottom_contact(
    upper: usize,
    ends: &[Crossing; 2],
    [left, right]: [SectionEdge; 2],
    h0: f64,
) -> PlanarAnswer {
    let inside = |end: &&Crossing| left.g_at(h0) <= end.g() && end.g() <= right.g_at(h0);
    if let Some(&vertex) = ends.iter().find(inside) {
        return PlanarAnswer::Vertex { upper, vertex, left, right };
    }
    // The lower section is narrower than the flat bottom of the upper one.
    let flat = SectionEdge::new(ends[0], ends[1]);
    edge_contact(&order_by_body(upper, flat, left))
}

/// Orders the values of the upper and the lower section by body.
fn order_by_body<T>(upper: usize, of_upper: T, of_lower: T) -> [T; 2] {
    if upper == 0 { [of_upper, of_lower] } else { [of_lower, of_upper] }
}

impl PlanarAnswer {
    /// Returns the separation of an upper section whose bottom is above the top of the lower one.
    fn separated_by_height(upper: usize, bottom: &Crossing, top: &Crossing) -> Self {
        let sign = if upper == 1 { 1.0 } else { -1.0 };
        let supports = order_by_body(upper, *bottom, *top);
        Self::Separated { u: DVec2::new(sign, 0.0), supports }
    }

    /// Returns a hint for the problem at `levels` from this answer at `own_levels`. `height` is a lower bound
    /// of the next answer's height.
    pub(super) fn hint_for_levels(
        &self,
        own_levels: [f64; 2],
        levels: [f64; 2],
        height: f64,
    ) -> PlanarHint {
        match self {
            Self::Vertex { upper, vertex, left, right } => {
                let between = [left.low.half_edge, right.low.half_edge];
                let last = LastAnswer::Bottom { upper: *upper, vertex: vertex.half_edge, between };
                PlanarHint { height, levels: own_levels, last }
            }
            Self::Edges { edges, .. } => {
                let [p, q] = edges.each_ref().map(|edge| edge.direction);
                // The gap falls because the edges turn towards each other.
                let right = usize::from(p.perp_dot(q) < 0.0);
                let edges = edges.each_ref().map(|edge| edge.low.half_edge);
                PlanarHint { height, levels: own_levels, last: LastAnswer::Facing { right, edges } }
            }
            Self::Separated { u, supports } => {
                let moved = [0, 1].map(|body| {
                    let Crossing { w, drift, .. } = supports[body];
                    w.x + drift.x * (levels[body] - own_levels[body])
                });
                let edges = supports.each_ref().map(|support| support.half_edge);
                let last = LastAnswer::Facing { right: usize::from(u.y > 0.0), edges };
                PlanarHint { height: moved[0].max(moved[1]), levels: own_levels, last }
            }
        }
    }
}
