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

struct Problem<'a> {
    sections: [Section<'a>; 2],
    upper: usize,
    h0: f64,
}

/// What pieces and the planar problem before tell about an answer.
#[derive(Debug, Clone, Copy)]
pub(super) struct Hint {
    /// The answer does not lie below this height.
    pub(super) height: f64,
    /// The body that is probably on the right there.
    pub(super) right: Option<usize>,
}

impl Hint {
    /// Nothing is known.
    pub(super) const NONE: Self = Self { height: f64::NEG_INFINITY, right: None };
}

/// Solves the planar problem for the sections at `levels`, each in its body's range. `None` if
/// rounding errors of the mesh hide a section.
pub(super) fn solve(sides: &[Side; 2], levels: [f64; 2], hint: &Hint) -> Option<Planar> {
    let sections = [Section::new(&sides[0], levels[0]), Section::new(&sides[1], levels[1])];
    // Where the guess of the right body holds, the bottoms need not be known.
    if let Some(right) = hint.right
        && let Some(found) = Slide::new(&sections, right).solve_from(hint.height)
    {
        return Some(found);
    }
    let bottoms = [sections[0].bottom()?, sections[1].bottom()?];
    let upper = usize::from(bottoms[1].vertex.h() > bottoms[0].vertex.h());
    let h0 = bottoms[upper].vertex.h();
    if hint.height > h0 && hint.right.is_none() {
        let right = usize::from(bottoms[1].vertex.g() > bottoms[0].vertex.g());
        if let Some(found) = Slide::new(&sections, right).solve_from(hint.height) {
            return Some(found);
        }
    }
    Problem { sections, upper, h0 }.solve(&bottoms)
}

impl Problem<'_> {
    fn solve(&self, bottoms: &[Bottom; 2]) -> Option<Planar> {
        let lower = 1 - self.upper;
        let bottom = &bottoms[self.upper];
        let left_end = self.sections[self.upper].bottom_end(bottom, Chain::Left);
        let right_end = self.sections[self.upper].bottom_end(bottom, Chain::Right);
        let nearer =
            if right_end.g() < bottoms[lower].vertex.g() { Chain::Left } else { Chain::Right };
        let mut found = [None; 2];
        for chain in [nearer, nearer.opposite()] {
            let edge = match self.sections[lower].locate(chain, self.h0)? {
                Located::Edge(edge) => edge,
                Located::Beyond(topmost) => {
                    return Some(self.separated_by_height(&bottom.vertex, &topmost.high));
                }
                Located::Short => return None,
            };
            let g = edge.g_at(self.h0);
            if chain == Chain::Left && right_end.g() < g {
                return self.slide(right_end, chain, edge);
            }
            if chain == Chain::Right && left_end.g() > g {
                return self.slide(left_end, chain, edge);
            }
            found[usize::from(chain == Chain::Right)] = Some(edge);
        }
        let (left, right) = (found[0]?, found[1]?);
        let inside =
            |end: &Crossing| left.g_at(self.h0) <= end.g() && end.g() <= right.g_at(self.h0);
        if let Some(vertex) = [left_end, right_end].into_iter().find(inside) {
            return Some(Planar::Vertex { upper: self.upper, vertex, left, right });
        }
        // The lower section is narrower than the flat bottom of the upper one.
        let flat = Bracket::new(left_end, right_end);
        Some(crossing_edges(&self.by_body(flat, left)))
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
        Slide::new(&self.sections, right).solve(&self.by_body(first, edge), self.h0)
    }
}

impl Planar {
    /// The body on the right where the sections face each other; not known of a vertex inside the
    /// other section.
    pub(super) fn right(&self) -> Option<usize> {
        match self {
            Self::Vertex { .. } => None,
            // The gap falls: the edges turn towards each other.
            Self::Edges { edges: [p, q], .. } => {
                Some(usize::from(p.direction.perp_dot(q.direction) < 0.0))
            }
            Self::Separated { u, .. } => Some(usize::from(u.y > 0.0)),
        }
    }
}
