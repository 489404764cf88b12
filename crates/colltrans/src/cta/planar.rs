//! The planar problem: the lowest point of the intersection of two convex polygons, or a line that separates them (the paper, section III-B).
//!
//! Notation. Body 0 is P with its section at `x`, body 1 is Q with its section at `y`, in the shadow plane `w = (h, g)`. The
//! *upper* section is the one with the higher bottom, at height `h0`. If that bottom lies in the other section it is
//! the answer. Otherwise one section is to the left of the other at `h0`, and with the left chain `l` of the one on the right (convex) and the right chain `r` of the
//! one on the left (concave) `gap(h) = l(h) - r(h)` is convex and positive at `h0`: Newton's method from there never
//! overshoots and ends on the pair of edges that meet first, or where the gap no longer falls.

use glam::DVec2;

use super::side::{Bottom, Bracket, Chain, Crossing, Ends, Located, Side};

/// What the planar problem found.
#[derive(Debug, Clone, Copy)]
pub(super) enum Planar {
    /// The bottom of one section lies in the other, between two edges of it.
    Vertex { upper: usize, vertex: Crossing, left: Bracket, right: Bracket },
    /// Two edges cross at the lowest common point.
    Edges { edges: [Bracket; 2], h: f64 },
    /// Nothing in common: along `u` every point of section 1 is beyond every point of section 0;
    /// `supports` are the closest.
    Separated { u: DVec2, supports: [Crossing; 2] },
}

struct Problem<'a, 'b> {
    sides: &'a [Side<'b>; 2],
    levels: [f64; 2],
    ends: [Ends; 2],
    upper: usize,
    h0: f64,
}

/// Solves the planar problem for the sections at `levels`, each in its body's range. `None` if rounding errors of the mesh hide a
/// section.
pub(super) fn solve(sides: &[Side; 2], levels: [f64; 2]) -> Option<Planar> {
    let ends = [sides[0].ends(levels[0])?, sides[1].ends(levels[1])?];
    let bottoms = [sides[0].bottom(ends[0], levels[0])?, sides[1].bottom(ends[1], levels[1])?];
    let upper = usize::from(bottoms[1].vertex.h() > bottoms[0].vertex.h());
    let h0 = bottoms[upper].vertex.h();
    Problem { sides, levels, ends, upper, h0 }.solve(&bottoms)
}

impl Problem<'_, '_> {
    fn solve(&self, bottoms: &[Bottom; 2]) -> Option<Planar> {
        let lower = 1 - self.upper;
        let bottom = &bottoms[self.upper];
        let left_end = flat_end(&bottom.vertex, &bottom.left);
        let right_end = flat_end(&bottom.vertex, &bottom.right);
        let nearer =
            if right_end.g() < bottoms[lower].vertex.g() { Chain::Left } else { Chain::Right };
        let mut found = [None; 2];
        for chain in [nearer, nearer.opposite()] {
            let edge = match self.sides[lower].locate(
                chain,
                self.ends[lower],
                self.h0,
                self.levels[lower],
            )? {
                Located::Edge(edge) => edge,
                Located::Beyond(topmost) => {
                    return Some(self.separated_by_height(&bottom.vertex, &topmost.high));
                }
            };
            let outside = match chain {
                Chain::Left => right_end.g() < edge.g_at(self.h0),
                Chain::Right => left_end.g() > edge.g_at(self.h0),
            };
            if outside {
                return self.slide(bottom, chain, edge);
            }
            found[usize::from(chain == Chain::Right)] = Some(edge);
        }
        let (left, right) = (found[0]?, found[1]?);
        let inside =
            |end: &Crossing| left.g_at(self.h0) <= end.g() && end.g() <= right.g_at(self.h0);
        let ends = [left_end, right_end];
        if let Some(vertex) = ends.into_iter().find(inside) {
            return Some(Planar::Vertex { upper: self.upper, vertex, left, right });
        }
        // The lower section is narrower than the flat bottom of the upper one.
        let flat = Bracket::new(left_end, right_end);
        Some(Planar::Edges { edges: self.by_body(flat, left), h: self.h0 })
    }

    /// What belongs to the upper and to the lower section, by body.
    fn by_body<T>(&self, of_upper: T, of_lower: T) -> [T; 2] {
        if self.upper == 0 { [of_upper, of_lower] } else { [of_lower, of_upper] }
    }

    fn separated_by_height(&self, bottom: &Crossing, top: &Crossing) -> Planar {
        let sign = if self.upper == 1 { 1.0 } else { -1.0 };
        Planar::Separated { u: DVec2::new(sign, 0.0), supports: self.by_body(*bottom, *top) }
    }

    /// The upper section's bottom is beyond `chain` of the lower one, whose edge at `h0` is `edge`.
    fn slide(&self, bottom: &Bottom, chain: Chain, edge: Bracket) -> Option<Planar> {
        let facing = chain.opposite();
        let mut first = Side::first(bottom, facing);
        if first.direction.x == 0.0 {
            let next = self.sides[self.upper].up(facing, &first.high, self.levels[self.upper]);
            first = Bracket::new(first.high, next);
        }
        Slide {
            problem: self,
            chains: self.by_body(facing, chain),
            // The body that shows its left chain is the one on the right.
            right: if chain == Chain::Left { 1 - self.upper } else { self.upper },
        }
        .solve(self.by_body(first, edge))
    }
}

/// The other end of the edge from `vertex` to `next` if it is horizontal, else `vertex`.
fn flat_end(vertex: &Crossing, next: &Crossing) -> Crossing {
    if vertex.towards(next).x == 0.0 { *next } else { *vertex }
}

/// Newton's method up two chains that face each other.
struct Slide<'a, 'b, 'c> {
    problem: &'a Problem<'b, 'c>,
    /// The chain that each body shows to the other.
    chains: [Chain; 2],
    /// The body on the right.
    right: usize,
}

impl Slide<'_, '_, '_> {
    fn solve(&self, start: [Bracket; 2]) -> Option<Planar> {
        let mut edges = start;
        let mut h = self.problem.h0;
        for _ in 0..self.problem.sides[0].step_limit() + self.problem.sides[1].step_limit() {
            let slope = self.slope(&edges);
            if slope >= 0.0 {
                return self.separated_at_least_gap(edges);
            }
            let meet = h - self.gap(&edges, h) / slope;
            if meet <= edges[0].high.h().min(edges[1].high.h()) {
                return Some(Planar::Edges { edges, h: meet });
            }
            let advanced = [self.advance(0, edges[0], meet), self.advance(1, edges[1], meet)];
            let mut topped = None;
            for (body, located) in advanced.into_iter().enumerate() {
                edges[body] = match located {
                    Located::Edge(edge) => edge,
                    Located::Beyond(edge) => {
                        let lower_top =
                            topped.is_none_or(|other: usize| edge.high.h() < edges[other].high.h());
                        if lower_top {
                            topped = Some(body);
                        }
                        edge
                    }
                };
            }
            h = meet;
            if let Some(body) = topped {
                h = edges[body].high.h();
                edges[1 - body] = self.down_to(1 - body, edges[1 - body], h);
                if self.gap(&edges, h) > 0.0 && self.slope(&edges) < 0.0 {
                    return self.separated_at_top(body, &edges);
                }
            }
            // NaN: an edge too flat for its slope to be a number.
            if h.is_nan() {
                return None;
            }
        }
        None
    }

    fn slope(&self, edges: &[Bracket; 2]) -> f64 {
        edges[self.right].slope() - edges[1 - self.right].slope()
    }

    fn gap(&self, edges: &[Bracket; 2], h: f64) -> f64 {
        edges[self.right].g_at(h) - edges[1 - self.right].g_at(h)
    }

    fn advance(&self, body: usize, edge: Bracket, h: f64) -> Located {
        self.problem.sides[body].advance(self.chains[body], edge, h, self.problem.levels[body])
    }

    fn retreat(&self, body: usize, edge: &Bracket) -> Option<Bracket> {
        self.problem.sides[body].retreat(self.chains[body], edge, self.problem.levels[body])
    }

    fn down_to(&self, body: usize, edge: Bracket, h: f64) -> Bracket {
        let mut edge = edge;
        while edge.low.h() > h {
            match self.retreat(body, &edge) {
                Some(below) => edge = below,
                None => break,
            }
        }
        edge
    }

    /// The gap grows along `edges` and is positive: back to where it is least, at a vertex of one chain, where a line along the
    /// other's edge separates best.
    fn separated_at_least_gap(&self, edges: [Bracket; 2]) -> Option<Planar> {
        let mut edges = edges;
        for _ in 0..self.problem.sides[0].step_limit() + self.problem.sides[1].step_limit() {
            let body = usize::from(edges[1].low.h() > edges[0].low.h());
            if edges[body].low.h() <= self.problem.h0 {
                let upper = self.problem.upper;
                return Some(self.separated(&edges[1 - upper], edges.map(|edge| edge.low)));
            }
            let mut candidate = edges;
            let below = self.retreat(body, &edges[body]);
            if let Some(below) = below {
                candidate[body] = below;
            }
            if below.is_none() || self.slope(&candidate) < 0.0 {
                return Some(self.separated(&edges[1 - body], edges.map(|edge| edge.low)));
            }
            edges = candidate;
        }
        None
    }

    /// `body`'s chain ends, at the top of its section, before the gap closes.
    fn separated_at_top(&self, body: usize, edges: &[Bracket; 2]) -> Option<Planar> {
        let mut supports = edges.map(|edge| edge.low);
        supports[body] = edges[body].high;
        Some(self.separated(&edges[1 - body], supports))
    }

    fn separated(&self, along: &Bracket, supports: [Crossing; 2]) -> Planar {
        // Points to the right, where g grows, and from body 0 to body 1.
        let sign = if self.right == 1 { 1.0 } else { -1.0 };
        let u = sign * DVec2::new(-along.direction.y, along.direction.x).normalize();
        Planar::Separated { u, supports }
    }
}
