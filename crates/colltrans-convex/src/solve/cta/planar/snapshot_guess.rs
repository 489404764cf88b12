//! The planar problem on two snapshots: what its answer probably rests on.
//!
//! A snapshot, moved to the level in question, is nearly the section there. Its chains are searched
//! by halving: for the lower section's edges at the height of the upper one's bottom, or, where the
//! sections face each other, for the height at which the gap closes or no longer falls. On a convex
//! gap both are the end of the heights where it is positive and falls, so one search does for
//! contact and separation. Positions are rounded and edges between two snapshots are missing: the
//! answer is sought on the mesh, from here.

use glam::DVec2;

use super::Last;
use crate::body::convex::sections::{Snapshot, Turn};
use crate::solve::cta::crossing::Chain;
use crate::solve::cta::section::Section;
use crate::solve::cta::sectioned_body::Side;

/// What a sketch tells, and at what height.
pub(super) fn sketch(sections: &[Section; 2]) -> Option<(Last, f64)> {
    let outlines = [Outline::new(&sections[0])?, Outline::new(&sections[1])?];
    let bottoms = outlines.each_ref().map(|outline| outline.snapshot.point(outline.bottom));
    let upper = usize::from(bottoms[1].x > bottoms[0].x);
    let (lower, bottom) = (&outlines[1 - upper], bottoms[upper]);
    let [left, right] = [Chain::Left, Chain::Right].map(|chain| {
        let arc = lower.arc(chain);
        let at = arc.below(bottom.x, [0, arc.last]);
        (arc.g(at, bottom.x), at, arc)
    });
    let facing = if bottom.y < left.0 {
        (1 - upper, left)
    } else if bottom.y > right.0 {
        (upper, right)
    } else {
        let between = [left, right].map(|(_, at, arc)| arc.nearest(at, bottom.x));
        let vertex = outlines[upper].snapshot.up(outlines[upper].bottom);
        return Some((Last::Bottom { upper, vertex, between }, bottom.x));
    };
    let (right, (_, start, of_lower)) = facing;
    let of_upper = outlines[upper].arc(if right == upper { Chain::Left } else { Chain::Right });
    let (arcs, starts) = if upper == 0 {
        ([of_upper, of_lower], [0, start])
    } else {
        ([of_lower, of_upper], [start, 0])
    };
    let (at, height) = Facing { arcs, right }.stop(starts);
    let edges = [0, 1].map(|body| arcs[body].nearest(at[body], height));
    Some((Last::Facing { right, edges }, height))
}

/// The outline of a section, as a snapshot shows it.
struct Outline<'a> {
    side: &'a Side<'a>,
    snapshot: Snapshot<'a>,
    bottom: usize,
    top: usize,
}

impl<'a> Outline<'a> {
    /// `None` if rounding leaves the body no sections.
    fn new(section: &Section<'a>) -> Option<Self> {
        let side = section.side;
        let snapshot = side.sections.snapshot(&side.map, section.x);
        let halvings = snapshot.len().checked_ilog2()?;
        side.count(2 * halvings);
        let (bottom, top) = (snapshot.extreme(1.0), snapshot.extreme(-1.0));
        Some(Self { side, snapshot, bottom, top })
    }

    fn arc(&self, chain: Chain) -> Arc<'_> {
        let turn = self.side.turn_up(chain);
        let (from, to) = match turn {
            Turn::CounterClockwise => (self.bottom, self.top),
            Turn::Clockwise => (self.top, self.bottom),
        };
        let last = if to >= from { to - from } else { to + self.snapshot.len() - from };
        Arc { outline: self, turn, last }
    }
}

/// A chain of an outline; its vertices are counted from the bottom.
#[derive(Clone, Copy)]
struct Arc<'a> {
    outline: &'a Outline<'a>,
    turn: Turn,
    /// The number of the top.
    last: usize,
}

impl Arc<'_> {
    fn entry(&self, vertex: usize) -> usize {
        let (bottom, count) = (self.outline.bottom, self.outline.snapshot.len());
        match self.turn {
            Turn::CounterClockwise if bottom + vertex >= count => bottom + vertex - count,
            Turn::CounterClockwise => bottom + vertex,
            Turn::Clockwise if vertex > bottom => bottom + count - vertex,
            Turn::Clockwise => bottom - vertex,
        }
    }

    fn point(&self, vertex: usize) -> DVec2 {
        self.outline.snapshot.point(self.entry(vertex))
    }

    /// The last vertex in a range at most at height `h`, or its first.
    fn below(&self, h: f64, [from, to]: [usize; 2]) -> usize {
        let (mut low, mut candidates) = (from, to + 1 - from);
        while candidates > 1 {
            self.outline.side.count(1);
            let half = candidates / 2;
            let passed = self.point(low + half).x <= h;
            low += if passed { half } else { 0 };
            candidates -= half;
        }
        low
    }

    /// The ends of the edge that begins at a vertex; of the last one, if that is the top.
    fn edge(&self, vertex: usize) -> [DVec2; 2] {
        let low = vertex.min(self.last.saturating_sub(1));
        [self.point(low), self.point((low + 1).min(self.last))]
    }

    /// `g` at height `h` on the edge that begins at a vertex.
    fn g(&self, vertex: usize, h: f64) -> f64 {
        let edge = self.edge(vertex);
        on(edge, h)
    }

    /// The crossing edge at that end of an edge which is nearer to height `h`.
    fn nearest(&self, vertex: usize, h: f64) -> u32 {
        let [low, high] = self.edge(vertex);
        let vertex = vertex.min(self.last.saturating_sub(1));
        let nearer = if high.x - h < h - low.x { (vertex + 1).min(self.last) } else { vertex };
        self.outline.snapshot.up(self.entry(nearer))
    }
}

/// `g` at height `h` on an edge, or at its nearer end.
fn on([low, high]: [DVec2; 2], h: f64) -> f64 {
    let share = ((h - low.x) / (high.x - low.x)).clamp(0.0, 1.0);
    if share.is_nan() { low.y } else { low.y + (high.y - low.y) * share }
}

/// The arcs that two outlines show each other.
struct Facing<'a> {
    arcs: [Arc<'a>; 2],
    right: usize,
}

impl Facing<'_> {
    /// The edges where the gap, from vertices `starts` on, closes or no longer falls, and the height.
    fn stop(&self, starts: [usize; 2]) -> ([usize; 2], f64) {
        let mut low = starts;
        let mut high = self.arcs.map(|arc| arc.last);
        loop {
            let longer = usize::from(high[1] - low[1] > high[0] - low[0]);
            if high[longer] - low[longer] <= 1 {
                break;
            }
            let other = 1 - longer;
            self.arcs[longer].outline.side.count(1);
            let middle = usize::midpoint(low[longer], high[longer]);
            let h = self.arcs[longer].point(middle).x;
            let beside = self.arcs[other].below(h, [low[other], high[other]]);
            let mut at = [middle; 2];
            at[other] = beside;
            if beside < self.arcs[other].last && self.falls(at, h) {
                low = at;
            } else {
                high[longer] = middle;
                high[other] = high[other].min(beside + 1);
            }
        }
        (low, self.height(low))
    }

    /// Whether the gap is positive at height `h`, and falls along the edges there.
    fn falls(&self, at: [usize; 2], h: f64) -> bool {
        let edges = [0, 1].map(|body| self.arcs[body].edge(at[body]));
        self.gap(edges, h) > 0.0 && self.closes(edges)
    }

    fn gap(&self, edges: [[DVec2; 2]; 2], h: f64) -> f64 {
        on(edges[self.right], h) - on(edges[1 - self.right], h)
    }

    fn closes(&self, edges: [[DVec2; 2]; 2]) -> bool {
        let [r, l] = [1 - self.right, self.right].map(|body| edges[body][1] - edges[body][0]);
        r.perp_dot(l) < 0.0
    }

    /// Where the gap closes along two edges, or else is least.
    fn height(&self, at: [usize; 2]) -> f64 {
        let edges = [0, 1].map(|body| self.arcs[body].edge(at[body]));
        let from = edges[0][0].x.max(edges[1][0].x);
        let to = edges[0][1].x.min(edges[1][1].x);
        let [start, end] = [from, to].map(|h| self.gap(edges, h));
        if start <= 0.0 || to < from || !self.closes(edges) {
            from
        } else if end < 0.0 {
            from + (to - from) * (start / (start - end))
        } else {
            to
        }
    }
}
