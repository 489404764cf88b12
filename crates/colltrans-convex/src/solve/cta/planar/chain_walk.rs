//! Steps along two chains that face each other, edge by edge, to where the gap closes or is least.
//!
//! With the left chain `l` of the section on the right (convex) and the right chain `r` of the one
//! on the left (concave) `gap(h) = l(h) - r(h)` is convex. Where it is positive and falls, the answer
//! is above; where it is not positive, or grows, below. So the answer is known from the edges that
//! meet there, wherever the steps began: the first pair that crosses coming from below, or a vertex
//! past which the gap grows.

use glam::DVec2;

use super::{Crossing, Planar};
use crate::solve::cta::crossing::{Bracket, Chain};
use crate::solve::cta::section::{Located, PATIENCE, Section};
use colltrans_kernel::noise;

/// Steps of Newton's method at most.
const NEWTON_STEPS: usize = 4;

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

/// Two chains that face each other.
pub(super) struct Slide<'a, 'b> {
    sections: &'a [Section<'b>; 2],
    /// The chain that each body shows to the other.
    chains: [Chain; 2],
    /// The body on the right.
    right: usize,
}

/// Where steps along two chains led.
pub(super) enum Slid {
    Solved(Planar),
    /// The bottom of this body's section, from which this edge begins, is not beyond the other's
    /// edge.
    Within(usize, [Bracket; 2]),
}

impl<'a, 'b> Slide<'a, 'b> {
    pub(super) fn new(sections: &'a [Section<'b>; 2], right: usize) -> Self {
        let mut chains = [Chain::Right; 2];
        chains[right] = Chain::Left;
        Self { sections, chains, right }
    }

    /// The edges at a height, or where the chains are nearest to it, sought from edges upwards.
    pub(super) fn edges_at(&self, height: f64, from: [u32; 2]) -> Option<[Bracket; 2]> {
        let edge = |body: usize| {
            let section = &self.sections[body];
            Some(section.locate(self.chains[body], height, from[body])?.edge())
        };
        Some([edge(0)?, edge(1)?])
    }

    /// From two edges towards where the gap closes, by Newton's method: on a convex gap steps come from
    /// below but for the first. Only for bodies with chains, where a walk may be long.
    fn approach(&self, from: &[Bracket; 2]) -> [Bracket; 2] {
        let mut edges = *from;
        if !self.has_chains() {
            return edges;
        }
        for _ in 0..NEWTON_STEPS {
            let h = crossing_of(&edges).x;
            let is_there = edges.iter().all(|edge| edge.low.h() <= h && h <= edge.high.h());
            if is_there || !self.closes(&edges) {
                break;
            }
            let Some(next) = self.at(h, &edges) else { break };
            edges = next;
        }
        edges
    }

    /// The edges at a height, from others on the same chains.
    fn at(&self, h: f64, from: &[Bracket; 2]) -> Option<[Bracket; 2]> {
        let edge = |body: usize| {
            Some(self.sections[body].move_to(self.chains[body], h, from[body])?.edge())
        };
        Some([edge(0)?, edge(1)?])
    }

    fn has_chains(&self) -> bool {
        self.sections.iter().any(|section| section.side.sections.chains().is_some())
    }

    /// Far along the chain of a body, up it or down: to its last vertex where the gap is still positive and
    /// falls, or still does not, and the other chain's edge at that height.
    fn skip(&self, body: usize, is_up: bool, from: &[Bracket; 2]) -> Option<[Bracket; 2]> {
        let section = &self.sections[body];
        let chain = self.chains[body];
        let mut other = from[1 - body];
        let along = if is_up { chain } else { chain.opposite() };
        let start = from[body].low.h();
        let last = section.skip(along, &from[body].low, |v| {
            if if is_up { v.h() < start } else { v.h() > start } {
                return false;
            }
            let edge = Bracket::new(*v, section.up(chain, v));
            let Some(Located::Edge(beside)) =
                self.sections[1 - body].move_to(self.chains[1 - body], v.h(), other)
            else {
                return false;
            };
            let mut edges = [edge; 2];
            edges[1 - body] = beside;
            let falls = beside.low.h() > v.h()
                || chain.ascends(edge.direction)
                    && self.is_beyond(body, v, &edges)
                    && self.closes(&edges);
            let ahead = if is_up { falls } else { !falls && self.retreat(body, &edge).is_some() };
            other = if ahead { beside } else { other };
            ahead
        })?;
        if last.up == from[body].low.up {
            return None;
        }
        let mut edges = [Bracket::new(last, section.up(chain, &last)); 2];
        let before = &from[1 - body];
        edges[1 - body] = if is_up && other.low.h() < before.low.h() { *before } else { other };
        Some(edges)
    }

    /// From any edges, down to where the gap is positive and falls, and up from there.
    pub(super) fn settle(&self, from: &[Bracket; 2]) -> Option<Slid> {
        let mut edges = self.approach(from);
        for step in 1..=self.limit() {
            let upper = higher(&edges);
            let lower = 1 - upper;
            if step % PATIENCE == 0 {
                let top = edges[lower].high.h();
                if edges[upper].low.h() <= top {
                    edges = self.skip(upper, false, &edges).unwrap_or(edges);
                } else if self.has_chains() {
                    let section = &self.sections[upper];
                    edges[upper] = section.move_to(self.chains[upper], top, edges[upper])?.edge();
                }
                if higher(&edges) != upper {
                    continue;
                }
            }
            if edges[upper].low.h() > edges[lower].high.h() {
                if let Some(below) = self.retreat(upper, &edges[upper]) {
                    edges[upper] = below;
                } else if let Some(above) = self.proceed(lower, &edges[lower]) {
                    edges[lower] = above;
                } else {
                    let [bottom, top] = [&edges[upper].low, &edges[lower].high];
                    return Some(Slid::Solved(Planar::by_height(upper, bottom, top)));
                }
                continue;
            }
            let apart = self.is_beyond(upper, &edges[upper].low, &edges);
            if apart && self.closes(&edges) {
                return self.rise(&edges).map(Slid::Solved);
            }
            let Some(below) = self.retreat(upper, &edges[upper]) else {
                return Some(if apart {
                    Slid::Solved(self.separated(&edges[lower], edges.map(|edge| edge.low)))
                } else {
                    Slid::Within(upper, edges)
                });
            };
            let supports = edges.map(|edge| edge.low);
            edges[upper] = below;
            if apart && self.closes(&edges) {
                return Some(Slid::Solved(self.separated(&edges[lower], supports)));
            }
        }
        None
    }

    /// From edges where the gap is positive, upwards.
    pub(super) fn rise(&self, from: &[Bracket; 2]) -> Option<Planar> {
        let mut edges = *from;
        // The body whose vertex was passed last.
        let mut passed = higher(&edges);
        for step in 1..=self.limit() {
            if step % PATIENCE == 0 {
                let ending = usize::from(edges[1].high.h() < edges[0].high.h());
                edges = self.skip(ending, true, &edges).unwrap_or(edges);
            }
            if !self.closes(&edges) {
                return Some(self.separated(&edges[1 - passed], edges.map(|edge| edge.low)));
            }
            // The edge that ends first decides whether they have met, without a quotient.
            let ending = usize::from(edges[1].high.h() < edges[0].high.h());
            if !self.is_beyond(ending, &edges[ending].high, &edges) {
                return Some(crossing_edges(&edges));
            }
            let Some(above) = self.proceed(ending, &edges[ending]) else {
                let mut supports = edges.map(|edge| edge.low);
                supports[ending] = edges[ending].high;
                return Some(self.separated(&edges[1 - ending], supports));
            };
            edges[ending] = above;
            passed = ending;
        }
        None
    }

    fn limit(&self) -> usize {
        self.sections[0].limit.saturating_add(self.sections[1].limit)
    }

    /// Whether a vertex of a body's chain is on its own side of the other's edge.
    fn is_beyond(&self, body: usize, vertex: &Crossing, edges: &[Bracket; 2]) -> bool {
        let side = edges[1 - body].side_of(vertex.w);
        if body == self.right { side > 0.0 } else { side < 0.0 }
    }

    /// Whether the gap falls along these edges.
    pub(super) fn closes(&self, edges: &[Bracket; 2]) -> bool {
        let [r, s] = [&edges[1 - self.right].direction, &edges[self.right].direction];
        let sine = r.perp_dot(*s);
        sine < 0.0
            && sine * sine
                > noise::SECTION * noise::SECTION * r.length_squared() * s.length_squared()
    }

    fn proceed(&self, body: usize, edge: &Bracket) -> Option<Bracket> {
        self.sections[body].proceed(self.chains[body], edge)
    }

    fn retreat(&self, body: usize, edge: &Bracket) -> Option<Bracket> {
        self.sections[body].retreat(self.chains[body], edge)
    }

    /// A vertex of one chain and an edge of the other, along which a line separates.
    pub(super) fn separated(&self, along: &Bracket, supports: [Crossing; 2]) -> Planar {
        // Points to the right, where g grows, and from body 0 to body 1.
        let sign = if self.right == 1 { 1.0 } else { -1.0 };
        // Nothing depends on its length, which is kept in range.
        let across = DVec2::new(-along.direction.y, along.direction.x);
        let u = across * (sign / across.abs().element_sum());
        Planar::Separated { u, supports }
    }
}
