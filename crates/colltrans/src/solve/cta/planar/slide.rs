//! Newton's method up two chains that face each other.
//!
//! With the left chain `l` of the section on the right (convex) and the right chain `r` of the one
//! on the left (concave) `gap(h) = l(h) - r(h)` is convex: from a height where it is positive
//! Newton's method never overshoots, and ends on the pair of edges that meet first, or where the gap
//! no longer falls.

use glam::DVec2;

use super::Planar;
use crate::number::noise;
use crate::solve::cta::crossing::{Bracket, Chain};
use crate::solve::cta::section::{Located, Section};

/// Halvings of a height: none are left between two numbers after so many.
const HALVINGS: usize = 64;

/// Steps from a guess of the edges that cross before the problem is solved from scratch.
const STEPS_NEAR: usize = 24;

/// Newton's method walks so far back down a chain before it searches the snapshot.
const STEPS_DOWN: usize = 4;

/// Two edges that cross, and where.
pub(super) fn crossing_edges(edges: &[Bracket; 2]) -> Planar {
    Planar::Edges { edges: *edges, contact: crossing_of(edges) }
}

/// The body whose edge begins higher.
fn higher(edges: &[Bracket; 2]) -> usize {
    usize::from(edges[1].low.h() > edges[0].low.h())
}

/// Where the lines of two edges cross.
fn crossing_of([r, s]: &[Bracket; 2]) -> DVec2 {
    let step = (s.low.w - r.low.w).perp_dot(s.direction) / r.direction.perp_dot(s.direction);
    r.low.w + r.direction * step
}

/// Newton's method up two chains that face each other.
pub(super) struct Slide<'a, 'b> {
    pub(super) sections: &'a [Section<'b>; 2],
    /// The chain that each body shows to the other.
    pub(super) chains: [Chain; 2],
    /// The body on the right.
    right: usize,
}

impl<'a, 'b> Slide<'a, 'b> {
    pub(super) fn new(sections: &'a [Section<'b>; 2], right: usize) -> Self {
        let mut chains = [Chain::Right; 2];
        chains[right] = Chain::Left;
        Self { sections, chains, right }
    }

    /// From a height that both sections reach, with the edges there sought from those of the problem
    /// before: up by Newton's method if the gap is positive and falls there, down to where it is
    /// least if it is positive and grows. If the sections overlap there, a step of Newton's method
    /// leads down to where they do not, because the gap is convex.
    pub(super) fn solve_from(&self, height: f64, last: [u32; 2]) -> Option<Planar> {
        let edge =
            |body: usize| self.sections[body].locate_from(self.chains[body], height, last[body]);
        let mut edges = [edge(0)?, edge(1)?];
        let mut h = height;
        let gap = self.gap(&edges, h);
        if gap <= 0.0 {
            if !self.closes(&edges) {
                return None;
            }
            h -= gap.abs() / self.slope(&edges).abs();
            edges = [self.down_to(0, edges[0], h)?, self.down_to(1, edges[1], h)?];
            let covers = |edge: &Bracket| edge.low.h() <= h;
            if !edges.iter().all(covers) || self.gap(&edges, h) <= 0.0 {
                return None;
            }
        }
        if self.closes(&edges) {
            return self.solve(&edges, h);
        }
        let found = self.separated_at_least_gap(&edges, STEPS_NEAR)?;
        found.misses().then_some(found)
    }

    /// Whether the gap falls along these edges.
    pub(super) fn closes(&self, edges: &[Bracket; 2]) -> bool {
        let [r, s] = [&edges[1 - self.right].direction, &edges[self.right].direction];
        let sine = r.perp_dot(*s);
        sine < 0.0
            && sine * sine
                > noise::SECTION * noise::SECTION * r.length_squared() * s.length_squared()
    }

    /// From the edges at height `start`, where the gap is positive.
    pub(super) fn solve(&self, edges: &[Bracket; 2], start: f64) -> Option<Planar> {
        let mut edges = *edges;
        let mut h = start;
        let mut closing = start;
        for _ in 0..self.step_limit() {
            if !self.closes(&edges) {
                return self.separated_between(&edges, closing, h);
            }
            closing = h;
            // The edge that ends first decides whether they have met, without a quotient.
            let ending = usize::from(edges[1].high.h() < edges[0].high.h());
            let end = &edges[ending].high;
            let beyond = edges[1 - ending].side_of(end.w);
            if if ending == self.right { beyond <= 0.0 } else { beyond >= 0.0 } {
                return Some(crossing_edges(&edges));
            }
            let meet = (h - self.gap(&edges, h) / self.slope(&edges)).max(end.h());
            let Some(next) = self.proceed(ending, &edges[ending]) else {
                return Some(self.separated_at_top(ending, &edges));
            };
            edges[ending] = next;
            h = meet;
            for (body, edge) in edges.iter_mut().enumerate() {
                let section = &self.sections[body];
                *edge = match section.advance(self.chains[body], edge, meet)? {
                    Located::Edge(edge) => edge,
                    Located::Beyond(edge) => {
                        h = h.min(edge.high.h());
                        edge
                    }
                    Located::Short => return None,
                };
            }
            if h < meet {
                for (body, edge) in edges.iter_mut().enumerate() {
                    *edge = self.down_to(body, *edge, h)?;
                }
            }
            // NaN: an edge too flat for its slope to be a number.
            if h.is_nan() {
                return None;
            }
        }
        None
    }

    fn step_limit(&self) -> usize {
        self.sections[0].step_limit() + self.sections[1].step_limit()
    }

    fn slope(&self, edges: &[Bracket; 2]) -> f64 {
        edges[self.right].slope() - edges[1 - self.right].slope()
    }

    pub(super) fn gap(&self, edges: &[Bracket; 2], h: f64) -> f64 {
        edges[self.right].g_at(h) - edges[1 - self.right].g_at(h)
    }

    fn proceed(&self, body: usize, edge: &Bracket) -> Option<Bracket> {
        self.sections[body].proceed(self.chains[body], edge)
    }

    fn retreat(&self, body: usize, edge: &Bracket) -> Option<Bracket> {
        self.sections[body].retreat(self.chains[body], edge)
    }

    /// Down to height `h`: a few steps along the mesh, or a search from scratch.
    fn down_to(&self, body: usize, edge: Bracket, h: f64) -> Option<Bracket> {
        let mut edge = edge;
        for _ in 0..STEPS_DOWN {
            if edge.low.h() <= h {
                return Some(edge);
            }
            match self.retreat(body, &edge) {
                Some(below) => edge = below,
                None => return Some(edge),
            }
        }
        match self.sections[body].locate(self.chains[body], h)? {
            Located::Edge(edge) | Located::Beyond(edge) => Some(edge),
            Located::Short => None,
        }
    }

    /// The gap grows at height `high`, where `edges` are, falls at height `low`, and is positive
    /// between: to where it is least, by halving and at the end in steps.
    fn separated_between(
        &self,
        edges: &[Bracket; 2],
        mut low: f64,
        mut high: f64,
    ) -> Option<Planar> {
        let mut edges = *edges;
        let mut lowered = true;
        for _ in 0..HALVINGS {
            if lowered && let Some(found) = self.separated_at_least_gap(&edges, STEPS_NEAR) {
                return Some(found);
            }
            let h = f64::midpoint(low, high);
            let locate = |body: usize| self.sections[body].locate(self.chains[body], h);
            let (Located::Edge(p), Located::Edge(q)) = (locate(0)?, locate(1)?) else { break };
            lowered = !self.closes(&[p, q]);
            if lowered {
                (edges, high) = ([p, q], h);
            } else {
                low = h;
            }
        }
        self.separated_at_least_gap(&edges, self.step_limit())
    }

    /// The gap grows along `edges` and is positive: back to where it is least, at a vertex of one
    /// chain, where a line along the other's edge separates best. `None` if that is more than
    /// `limit` steps away.
    fn separated_at_least_gap(&self, edges: &[Bracket; 2], limit: usize) -> Option<Planar> {
        let mut edges = *edges;
        for _ in 0..limit {
            let body = higher(&edges);
            let mut candidate = edges;
            let below = self.retreat(body, &edges[body]);
            if let Some(below) = below {
                candidate[body] = below;
            }
            if below.is_none() || self.closes(&candidate) {
                return Some(self.separated(&edges[1 - body], edges.map(|edge| edge.low)));
            }
            edges = candidate;
        }
        None
    }

    /// `body`'s chain ends, at the top of its section, before the gap closes.
    fn separated_at_top(&self, body: usize, edges: &[Bracket; 2]) -> Planar {
        let mut supports = edges.map(|edge| edge.low);
        supports[body] = edges[body].high;
        self.separated(&edges[1 - body], supports)
    }

    fn separated(&self, along: &Bracket, supports: [super::Crossing; 2]) -> Planar {
        // Points to the right, where g grows, and from body 0 to body 1.
        let sign = if self.right == 1 { 1.0 } else { -1.0 };
        let u = sign * DVec2::new(-along.direction.y, along.direction.x).normalize();
        Planar::Separated { u, supports }
    }
}
