//! Guesses the answer of a planar problem on two snapshots.
//!
//! A snapshot, mapped to the level of the section, approximates the section. Bisection on its chains finds the
//! lower section's edges at the height of the upper one's bottom. If the sections face each other, it finds the
//! height up to which the gap is positive and falls. Because the gap is convex, the same search serves contact
//! and separation.
//!
//! Positions are rounded, and mesh edges between two snapshots are missing. Therefore the answer is searched on
//! the mesh from here.

use glam::DVec2;

use super::LastAnswer;
use crate::body::convex::sections::{Snapshot, Turn};
use crate::solve::cta::crossing::Chain;
use crate::solve::cta::section::Section;
use crate::solve::cta::sectioned_body::SectionedBody;

/// Returns the edges that probably determine the answer, and its height. `None` if a body has no snapshot.
pub(super) fn guess_from_snapshots(sections: &[Section; 2]) -> Option<(LastAnswer, f64)> {
    let outlines = [SnapshotOutline::new(&sections[0])?, SnapshotOutline::new(&sections[1])?];
    let bottoms =
        outlines.each_ref().map(|outline| outline.snapshot.extrapolated_point(outline.bottom));
    let upper = usize::from(bottoms[1].x > bottoms[0].x);
    let (lower, bottom) = (&outlines[1 - upper], bottoms[upper]);
    let [left, right] = [Chain::Left, Chain::Right].map(|chain| {
        let arc = lower.chain_arc(chain);
        let at = arc.last_below(bottom.x, [0, arc.last]);
        (arc.g_at(at, bottom.x), at, arc)
    });
    let chain_beyond = if bottom.y < left.0 {
        (1 - upper, left)
    } else if bottom.y > right.0 {
        (upper, right)
    } else {
        let between = [left, right].map(|(_, at, arc)| arc.nearest_crossing(at, bottom.x));
        let vertex = outlines[upper].snapshot.crossing_edge(outlines[upper].bottom);
        return Some((LastAnswer::Bottom { upper, vertex, between }, bottom.x));
    };
    let (right, (_, start, of_lower)) = chain_beyond;
    let of_upper =
        outlines[upper].chain_arc(if right == upper { Chain::Left } else { Chain::Right });
    let (arcs, starts) = if upper == 0 {
        ([of_upper, of_lower], [0, start])
    } else {
        ([of_lower, of_upper], [start, 0])
    };
    let (at, height) = FacingArcs { arcs, right }.closing_edges(starts);
    let edges = [0, 1].map(|body| arcs[body].nearest_crossing(at[body], height));
    Some((LastAnswer::Facing { right, edges }, height))
}

/// A snapshot of a section, with its lowest and highest entries.
struct SnapshotOutline<'a> {
    side: &'a SectionedBody<'a>,
    snapshot: Snapshot<'a>,
    bottom: usize,
    top: usize,
}

impl<'a> SnapshotOutline<'a> {
    /// Takes the last snapshot at or below the level of a section. `None` if rounding leaves the body no
    /// sections.
    fn new(section: &Section<'a>) -> Option<Self> {
        let side = section.side;
        let snapshot = side.sections.snapshot_below(&side.section_map, section.level);
        let halvings = snapshot.len().checked_ilog2()?;
        side.count_iterations(2 * halvings);
        let (bottom, top) = (snapshot.extreme_entry(1.0), snapshot.extreme_entry(-1.0));
        Some(Self { side, snapshot, bottom, top })
    }

    /// Returns a chain of the outline.
    fn chain_arc(&self, chain: Chain) -> ChainArc<'_> {
        let turn = self.side.turn_up_chain(chain);
        let (from, to) = match turn {
            Turn::CounterClockwise => (self.bottom, self.top),
            Turn::Clockwise => (self.top, self.bottom),
        };
        let last = if to >= from { to - from } else { to + self.snapshot.len() - from };
        ChainArc { outline: self, turn, last }
    }
}

/// A chain of an outline. Its vertices are numbered from the bottom.
#[derive(Clone, Copy)]
struct ChainArc<'a> {
    outline: &'a SnapshotOutline<'a>,
    turn: Turn,
    /// Number of the top.
    last: usize,
}

impl ChainArc<'_> {
    /// Returns the index of a vertex in the snapshot.
    fn snapshot_index(&self, vertex: usize) -> usize {
        let (bottom, count) = (self.outline.bottom, self.outline.snapshot.len());
        match self.turn {
            Turn::CounterClockwise if bottom + vertex >= count => bottom + vertex - count,
            Turn::CounterClockwise => bottom + vertex,
            Turn::Clockwise if vertex > bottom => bottom + count - vertex,
            Turn::Clockwise => bottom - vertex,
        }
    }

    /// Returns a vertex in the shadow plane.
    fn arc_point(&self, vertex: usize) -> DVec2 {
        self.outline.snapshot.extrapolated_point(self.snapshot_index(vertex))
    }

    /// Finds the last vertex in a range that is not above height `h`, or the first of the range.
    fn last_below(&self, h: f64, [from, to]: [usize; 2]) -> usize {
        let (mut low, mut candidates) = (from, to + 1 - from);
        while candidates > 1 {
            self.outline.side.count_iterations(1);
            let half = candidates / 2;
            let passed = self.arc_point(low + half).x <= h;
            low += if passed { half } else { 0 };
            candidates -= half;
        }
        low
    }

    /// Returns the ends of the edge that begins at a vertex, or of the last edge if the vertex is the top.
    fn edge_ends(&self, vertex: usize) -> [DVec2; 2] {
        let low = vertex.min(self.last.saturating_sub(1));
        [self.arc_point(low), self.arc_point((low + 1).min(self.last))]
    }

    /// Returns `g` at height `h` on the edge that begins at a vertex.
    fn g_at(&self, vertex: usize, h: f64) -> f64 {
        let edge = self.edge_ends(vertex);
        interpolate_g(edge, h)
    }

    /// Returns the crossing mesh edge at the end of an edge that is nearer to height `h`.
    fn nearest_crossing(&self, vertex: usize, h: f64) -> u32 {
        let [low, high] = self.edge_ends(vertex);
        let vertex = vertex.min(self.last.saturating_sub(1));
        let nearer = if high.x - h < h - low.x { (vertex + 1).min(self.last) } else { vertex };
        self.outline.snapshot.crossing_edge(self.snapshot_index(nearer))
    }
}

/// Returns `g` at height `h` on an edge, or at its nearer end.
fn interpolate_g([low, high]: [DVec2; 2], h: f64) -> f64 {
    let share = ((h - low.x) / (high.x - low.x)).clamp(0.0, 1.0);
    if share.is_nan() { low.y } else { low.y + (high.y - low.y) * share }
}

/// The facing chains of two outlines, with body `right` on the right.
struct FacingArcs<'a> {
    arcs: [ChainArc<'a>; 2],
    right: usize,
}

impl FacingArcs<'_> {
    /// Finds the edges where the gap, from vertices `starts` on, closes or no longer falls, and the height.
    fn closing_edges(&self, starts: [usize; 2]) -> ([usize; 2], f64) {
        let mut low = starts;
        let mut high = self.arcs.map(|arc| arc.last);
        loop {
            let longer = usize::from(high[1] - low[1] > high[0] - low[0]);
            if high[longer] - low[longer] <= 1 {
                break;
            }
            let other = 1 - longer;
            self.arcs[longer].outline.side.count_iterations(1);
            let middle = usize::midpoint(low[longer], high[longer]);
            let h = self.arcs[longer].arc_point(middle).x;
            let other_vertex = self.arcs[other].last_below(h, [low[other], high[other]]);
            let mut at = [middle; 2];
            at[other] = other_vertex;
            if other_vertex < self.arcs[other].last && self.is_below_answer(at, h) {
                low = at;
            } else {
                high[longer] = middle;
                high[other] = high[other].min(other_vertex + 1);
            }
        }
        (low, self.closing_height(low))
    }

    /// Checks whether the gap is positive at height `h` and falls along the edges there.
    fn is_below_answer(&self, at: [usize; 2], h: f64) -> bool {
        let edges = [0, 1].map(|body| self.arcs[body].edge_ends(at[body]));
        self.gap_at(edges, h) > 0.0 && self.gap_closes(edges)
    }

    /// Returns the gap between two edges at height `h`.
    fn gap_at(&self, edges: [[DVec2; 2]; 2], h: f64) -> f64 {
        interpolate_g(edges[self.right], h) - interpolate_g(edges[1 - self.right], h)
    }

    fn gap_closes(&self, edges: [[DVec2; 2]; 2]) -> bool {
        let [r, l] = [1 - self.right, self.right].map(|body| edges[body][1] - edges[body][0]);
        r.perp_dot(l) < 0.0
    }

    /// Returns the height at which the gap closes along two edges, or at which it is least.
    fn closing_height(&self, at: [usize; 2]) -> f64 {
        let edges = [0, 1].map(|body| self.arcs[body].edge_ends(at[body]));
        let from = edges[0][0].x.max(edges[1][0].x);
        let to = edges[0][1].x.min(edges[1][1].x);
        let [start, end] = [from, to].map(|h| self.gap_at(edges, h));
        if start <= 0.0 || to < from || !self.gap_closes(edges) {
            from
        } else if end < 0.0 {
            from + (to - from) * (start / (start - end))
        } else {
            to
        }
    }
}
