//! The planar problem: the lowest point of the intersection of two convex polygons, or a line that
//! separates them (the paper, section III-B).
//!
//! Notation. Body 0 is P with its section at `x`, body 1 is Q with its section at `y`, in the
//! shadow plane `w = (h, g)`. The *upper* section is the one with the higher bottom, at height
//! `h0`. If that bottom lies in the other section it is the answer. Otherwise one section is to the
//! left of the other at `h0`, and the answer is where the two chains that face each other meet
//! first, or where the gap between them is least.
//!
//! An answer can be told from the edges that it rests on, so it is sought near edges that are
//! guessed: those of the problem before, if its levels are near and they are, else those of a
//! [`sketch()`].

mod chain_walk;
mod snapshot_guess;

use glam::DVec2;

use super::crossing::{Bracket, Chain, Crossing};
use super::section::{Bottom, Located, Section};
use super::sectioned_body::Side;
use chain_walk::{Slid, Slide, crossing_edges};
use snapshot_guess::sketch;

/// Steps of a walk from the answer of the problem before.
const STEPS_NEAR: usize = 8;

/// What the planar problem found.
#[derive(Debug, Clone, Copy)]
pub(super) enum Planar {
    /// The bottom of one section lies in the other, between two edges of it.
    Vertex { upper: usize, vertex: Crossing, left: Bracket, right: Bracket },
    /// Two edges cross at the lowest common point.
    Edges { edges: [Bracket; 2], contact: DVec2 },
    /// Nothing in common: along `u` every point of section 1 is beyond every point of section 0;
    /// `supports` are the closest.
    Separated { u: DVec2, supports: [Crossing; 2] },
}

/// What pieces and the planar problem before tell about an answer.
#[derive(Debug, Clone, Copy)]
pub(super) struct Hint {
    /// Where the answer probably is, or below it.
    pub(super) height: f64,
    /// The levels of the problem before.
    pub(super) levels: [f64; 2],
    pub(super) last: Last,
}

/// The answer of the problem before, by edges upwards that cross its levels.
#[derive(Debug, Clone, Copy)]
pub(super) enum Last {
    Nothing,
    /// The sections faced each other, with `right` on the right.
    Facing {
        right: usize,
        edges: [u32; 2],
    },
    /// The bottom of one section lay in the other, between two edges.
    Bottom {
        upper: usize,
        vertex: u32,
        between: [u32; 2],
    },
}

impl Hint {
    /// Nothing is known.
    pub(super) const NONE: Self =
        Self { height: f64::NEG_INFINITY, levels: [f64::NAN; 2], last: Last::Nothing };
}

/// Solves the planar problem for the sections at `levels`, each in its body's range. `None` if
/// rounding errors of the mesh hide a section.
pub(super) fn solve(sides: &[Side; 2], levels: [f64; 2], hint: &Hint) -> Option<Planar> {
    let problem = |limit: usize| {
        let section = |body: usize| Section { side: &sides[body], x: levels[body], limit };
        Problem { sections: [section(0), section(1)] }
    };
    let near = |body: usize| (levels[body] - hint.levels[body]).abs() <= sides[body].near;
    if near(0)
        && near(1)
        && let Some(found) = problem(STEPS_NEAR).solve(&hint.last, hint.height)
    {
        return Some(found);
    }
    // More steps than this along one section are a walk in circles.
    let [p, q] = sides.each_ref().map(|side| side.topology.edge_count());
    let problem = problem(p + q);
    let (guess, height) = sketch(&problem.sections)?;
    problem.solve(&guess, height)
}

/// The answer for sections at `levels` if it is where their edges on two faces, by half-edges, cross.
pub(super) fn on_faces(sides: &[Side; 2], levels: [f64; 2], faces: [u32; 2]) -> Option<Planar> {
    let section = |body: usize| Section { side: &sides[body], x: levels[body], limit: 0 };
    let sections = [section(0), section(1)];
    let (of_p, p) = sections[0].on_face(faces[0])?;
    let (of_q, q) = sections[1].on_face(faces[1])?;
    let slide = Slide::new(&sections, usize::from(of_q == Chain::Left));
    let edges = [p, q];
    (of_p != of_q && slide.closes(&edges)).then(|| crossing_edges(&edges))
}

struct Problem<'a> {
    sections: [Section<'a>; 2],
}

impl Problem<'_> {
    /// From edges that the answer may rest on, at some height.
    fn solve(&self, guess: &Last, height: f64) -> Option<Planar> {
        match *guess {
            Last::Nothing => None,
            Last::Facing { right, edges } => {
                let slide = Slide::new(&self.sections, right);
                match slide.settle(&slide.edges_at(height, edges)?)? {
                    Slid::Solved(found) => Some(found),
                    Slid::Within(upper, edges) => {
                        let between = [edges[1 - upper].low.up; 2];
                        self.at_bottom(upper, edges[upper].low.up, between, true)
                    }
                }
            }
            Last::Bottom { upper, vertex, between } => {
                self.at_bottom(upper, vertex, between, false)
            }
        }
    }

    /// The bottom of one section, and the edges of the other at its height; if the other bottom turns
    /// out to be higher, the other way round, unless that was said to be `known`.
    fn at_bottom(
        &self,
        upper: usize,
        vertex: u32,
        between: [u32; 2],
        known: bool,
    ) -> Option<Planar> {
        let lower = &self.sections[1 - upper];
        let bottom = self.sections[upper].bottom(vertex)?;
        let h0 = bottom.vertex.h();
        let ends = self.ends(upper, &bottom);
        let mut found = [None; 2];
        for (chain, from) in [Chain::Left, Chain::Right].into_iter().zip(between) {
            match lower.locate(chain, h0, from)? {
                Located::Beyond(topmost) => {
                    return Some(Planar::by_height(upper, &bottom.vertex, &topmost.high));
                }
                Located::Edge(edge) if edge.low.h() > h0 && !known => {
                    return self.at_bottom(1 - upper, edge.low.up, [vertex; 2], true);
                }
                Located::Edge(edge) => {
                    if let Some(end) = beyond(chain, &edge, h0, &ends) {
                        return self.slide(upper, *end, chain, edge);
                    }
                    found[usize::from(chain == Chain::Right)] = Some(edge);
                }
            }
        }
        Some(inside(upper, &ends, [found[0]?, found[1]?], h0))
    }

    /// Both ends of a section's bottom, from left to right.
    fn ends(&self, upper: usize, bottom: &Bottom) -> [Crossing; 2] {
        [Chain::Left, Chain::Right].map(|chain| self.sections[upper].bottom_end(bottom, chain))
    }

    /// The upper section's bottom, with its end `end`, is beyond `chain` of the lower one, whose
    /// edge at its height is `edge`.
    fn slide(&self, upper: usize, end: Crossing, chain: Chain, edge: Bracket) -> Option<Planar> {
        let facing = chain.opposite();
        let first = Bracket::new(end, self.sections[upper].up(facing, &end));
        // The body that shows its left chain is the one on the right.
        let right = if chain == Chain::Left { 1 - upper } else { upper };
        let slide = Slide::new(&self.sections, right);
        let edges = by_body(upper, first, edge);
        if slide.closes(&edges) {
            slide.rise(&edges)
        } else {
            Some(slide.separated(&edge, by_body(upper, end, edge.low)))
        }
    }
}

/// The end of the upper section's bottom that faces a chain of the lower one, if all of it is
/// beyond.
fn beyond<'c>(
    chain: Chain,
    edge: &Bracket,
    h0: f64,
    [left, right]: &'c [Crossing; 2],
) -> Option<&'c Crossing> {
    let g = edge.g_at(h0);
    match chain {
        Chain::Left => (right.g() < g).then_some(right),
        Chain::Right => (left.g() > g).then_some(left),
    }
}

/// The upper section's bottom lies between two edges of the lower one, or reaches beyond both.
fn inside(upper: usize, ends: &[Crossing; 2], [left, right]: [Bracket; 2], h0: f64) -> Planar {
    let inside = |end: &&Crossing| left.g_at(h0) <= end.g() && end.g() <= right.g_at(h0);
    if let Some(&vertex) = ends.iter().find(inside) {
        return Planar::Vertex { upper, vertex, left, right };
    }
    // The lower section is narrower than the flat bottom of the upper one.
    let flat = Bracket::new(ends[0], ends[1]);
    crossing_edges(&by_body(upper, flat, left))
}

/// What belongs to the upper and to the lower section, by body.
fn by_body<T>(upper: usize, of_upper: T, of_lower: T) -> [T; 2] {
    if upper == 0 { [of_upper, of_lower] } else { [of_lower, of_upper] }
}

impl Planar {
    /// The bottom of the upper section is above the top of the lower one.
    fn by_height(upper: usize, bottom: &Crossing, top: &Crossing) -> Self {
        let sign = if upper == 1 { 1.0 } else { -1.0 };
        let supports = by_body(upper, *bottom, *top);
        Self::Separated { u: DVec2::new(sign, 0.0), supports }
    }

    /// What this answer, at levels `at`, tells about that at others, which is not below `height`.
    pub(super) fn hint(&self, at: [f64; 2], levels: [f64; 2], height: f64) -> Hint {
        match self {
            Self::Vertex { upper, vertex, left, right } => {
                let between = [left.low.up, right.low.up];
                let last = Last::Bottom { upper: *upper, vertex: vertex.up, between };
                Hint { height, levels: at, last }
            }
            Self::Edges { edges, .. } => {
                let [p, q] = edges.each_ref().map(|edge| edge.direction);
                // The gap falls: the edges turn towards each other.
                let right = usize::from(p.perp_dot(q) < 0.0);
                let edges = edges.each_ref().map(|edge| edge.low.up);
                Hint { height, levels: at, last: Last::Facing { right, edges } }
            }
            Self::Separated { u, supports } => {
                let moved = [0, 1].map(|body| {
                    let Crossing { w, drift, .. } = supports[body];
                    w.x + drift.x * (levels[body] - at[body])
                });
                let edges = supports.each_ref().map(|support| support.up);
                let last = Last::Facing { right: usize::from(u.y > 0.0), edges };
                Hint { height: moved[0].max(moved[1]), levels: at, last }
            }
        }
    }
}
