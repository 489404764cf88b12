//! The planar problem: the lowest point of the intersection of two convex polygons, or a line that
//! separates them (the paper, section III-B).
//!
//! Notation. Body 0 is P with its section at `x`, body 1 is Q with its section at `y`, in the
//! shadow plane `w = (h, g)`. The *upper* section is the one with the higher bottom, at height
//! `h0`. If that bottom lies in the other section it is the answer. Otherwise one section is to the
//! left of the other at `h0`, and with the left chain `l` of the one on the right (convex) and the
//! right chain `r` of the one on the left (concave) `gap(h) = l(h) - r(h)` is convex and positive
//! at `h0`: Newton's method from there never overshoots and ends on the pair of edges that meet
//! first, or where the gap no longer falls. Pieces found
//! earlier bound the answer from below: then Newton's method starts at that height.

mod slide;

use glam::DVec2;

use super::crossing::{Bracket, Chain, Crossing};
use super::section::{Bottom, Located, Section};
use super::side::Side;
use slide::{Slide, crossing_edges};

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

struct Problem<'a, 'b> {
    sections: &'a [Section<'b>; 2],
    upper: usize,
    /// The height of its bottom.
    h0: f64,
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
    let section = |body: usize| Section::new(&sides[body], levels[body], hint.levels[body]);
    let sections = [section(0), section(1)];
    if let Some(found) = solve_near(&sections, hint) {
        return Some(found);
    }
    let bottoms = [sections[0].bottom()?, sections[1].bottom()?];
    let upper = usize::from(bottoms[1].vertex.h() > bottoms[0].vertex.h());
    let h0 = bottoms[upper].vertex.h();
    if hint.height > h0 && !matches!(hint.last, Last::Facing { .. }) {
        let right = usize::from(bottoms[1].vertex.g() > bottoms[0].vertex.g());
        let lows = bottoms.each_ref().map(|bottom| bottom.vertex.up);
        if let Some(found) = Slide::new(&sections, right).solve_from(hint.height, lows) {
            return Some(found);
        }
    }
    let problem = Problem { sections: &sections, upper, h0 };
    problem.solve(&bottoms[upper], bottoms[1 - upper].vertex.g())
}

/// From the answer of the problem before. Where what it tells still holds, the bottoms of both
/// sections need not be known.
fn solve_near(sections: &[Section; 2], hint: &Hint) -> Option<Planar> {
    match hint.last {
        Last::Facing { right, edges } => Slide::new(sections, right).solve_from(hint.height, edges),
        Last::Bottom { upper, vertex, between } if sections.iter().all(Section::is_near) => {
            let bottom = sections[upper].bottom_from(vertex)?;
            let problem = Problem { sections, upper, h0: bottom.vertex.h() };
            problem.solve_near(&bottom, between)
        }
        Last::Nothing | Last::Bottom { .. } => None,
    }
}

impl Problem<'_, '_> {
    /// With the bottom of the upper section, and where the other one's is sideways.
    fn solve(&self, bottom: &Bottom, aside: f64) -> Option<Planar> {
        let lower = &self.sections[1 - self.upper];
        let ends = self.ends(bottom);
        let nearer = if ends[1].g() < aside { Chain::Left } else { Chain::Right };
        self.solve_between(bottom, &ends, nearer, |chain| lower.locate(chain, self.h0))
    }

    /// With the bottom of one section, if the other one, which had these edges in the problem before,
    /// reaches its height.
    fn solve_near(&self, bottom: &Bottom, last: [u32; 2]) -> Option<Planar> {
        let lower = &self.sections[1 - self.upper];
        self.solve_between(bottom, &self.ends(bottom), Chain::Left, |chain| {
            let last = last[usize::from(chain == Chain::Right)];
            lower.locate_from(chain, self.h0, last).map(Located::Edge)
        })
    }

    /// With a way to find the lower section's edges at the bottom's height, and the chain to look at
    /// first.
    fn solve_between(
        &self,
        bottom: &Bottom,
        ends: &[Crossing; 2],
        first: Chain,
        locate: impl Fn(Chain) -> Option<Located>,
    ) -> Option<Planar> {
        let mut found = [None; 2];
        for chain in [first, first.opposite()] {
            let edge = match locate(chain)? {
                Located::Edge(edge) => edge,
                Located::Beyond(topmost) => {
                    return Some(self.separated_by_height(&bottom.vertex, &topmost.high));
                }
                Located::Short => return None,
            };
            if let Some(end) = self.beyond(chain, &edge, ends) {
                return self.slide(*end, chain, edge);
            }
            found[usize::from(chain == Chain::Right)] = Some(edge);
        }
        Some(self.inside(ends, [found[0]?, found[1]?]))
    }

    /// Both ends of the upper section's bottom, from left to right.
    fn ends(&self, bottom: &Bottom) -> [Crossing; 2] {
        [Chain::Left, Chain::Right].map(|chain| self.sections[self.upper].bottom_end(bottom, chain))
    }

    /// The end of the bottom that faces a chain of the lower section, if all of it is beyond.
    fn beyond<'c>(
        &self,
        chain: Chain,
        edge: &Bracket,
        [left, right]: &'c [Crossing; 2],
    ) -> Option<&'c Crossing> {
        let g = edge.g_at(self.h0);
        match chain {
            Chain::Left => (right.g() < g).then_some(right),
            Chain::Right => (left.g() > g).then_some(left),
        }
    }

    /// The bottom lies between two edges of the lower section, or reaches beyond both.
    fn inside(&self, ends: &[Crossing; 2], [left, right]: [Bracket; 2]) -> Planar {
        let inside =
            |end: &&Crossing| left.g_at(self.h0) <= end.g() && end.g() <= right.g_at(self.h0);
        if let Some(&vertex) = ends.iter().find(inside) {
            return Planar::Vertex { upper: self.upper, vertex, left, right };
        }
        // The lower section is narrower than the flat bottom of the upper one.
        let flat = Bracket::new(ends[0], ends[1]);
        crossing_edges(&self.by_body(flat, left))
    }

    /// What belongs to the upper and to the lower section, by body.
    fn by_body<T>(&self, of_upper: T, of_lower: T) -> [T; 2] {
        if self.upper == 0 { [of_upper, of_lower] } else { [of_lower, of_upper] }
    }

    fn separated_by_height(&self, bottom: &Crossing, top: &Crossing) -> Planar {
        let sign = if self.upper == 1 { 1.0 } else { -1.0 };
        Planar::Separated { u: DVec2::new(sign, 0.0), supports: self.by_body(*bottom, *top) }
    }

    /// The upper section's bottom, with its end `end`, is beyond `chain` of the lower one, whose
    /// edge at `h0` is `edge`.
    fn slide(&self, end: Crossing, chain: Chain, edge: Bracket) -> Option<Planar> {
        let facing = chain.opposite();
        let first = Bracket::new(end, self.sections[self.upper].up(facing, &end));
        // The body that shows its left chain is the one on the right.
        let right = if chain == Chain::Left { 1 - self.upper } else { self.upper };
        Slide::new(self.sections, right).solve(&self.by_body(first, edge), self.h0)
    }
}

impl Planar {
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

    /// Whether this is a separation, by more than nothing.
    fn misses(&self) -> bool {
        match self {
            Self::Separated { u, supports } => u.dot(supports[1].w - supports[0].w) > 0.0,
            Self::Vertex { .. } | Self::Edges { .. } => false,
        }
    }
}
