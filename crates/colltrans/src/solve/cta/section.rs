//! The section of a body at one level: searched in a snapshot, walked on the mesh.

use std::cell::OnceCell;

use glam::DVec2;

use super::crossing::{Bracket, Chain, Crossing, is_horizontal};
use super::side::Side;
use crate::body::convex::sections::{Snapshot, Turn, next_clockwise, next_counter_clockwise};

/// Newton's method walks so far up a chain before it searches the snapshot.
const STEPS_BEFORE_SEARCH: usize = 2;

/// Mesh vertices passed, and edges of a section walked, from the answer at other levels before the
/// snapshot is searched.
const STEPS_NEAR: usize = 6;

/// Where a height was found on a chain.
#[derive(Debug, Clone, Copy)]
pub(super) enum Located {
    /// On this edge.
    Edge(Bracket),
    /// The chain ends below: its topmost edge.
    Beyond(Bracket),
    /// Further up than the walk went.
    Short,
}

/// The lowest vertex of a section and the directions of its polygon edges up both chains.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bottom {
    pub(super) vertex: Crossing,
    pub(super) directions: [DVec2; 2],
}

/// The section of a body at one level.
#[derive(Debug)]
pub(super) struct Section<'a> {
    side: &'a Side<'a>,
    /// Once asked for: the nearest snapshot and its lowest entry. `None` if rounding leaves the
    /// body no sections.
    lowest: OnceCell<Option<(Snapshot<'a>, usize)>>,
    /// Once asked for: its highest entry.
    highest: OnceCell<usize>,
    x: f64,
    /// Whether edges that cross the level of the problem before are a few vertices away.
    is_near: bool,
}

impl<'a> Section<'a> {
    /// At level `x` of the side's range, after a problem at level `last`.
    pub(super) fn new(side: &'a Side<'a>, x: f64, last: f64) -> Self {
        let is_near = (x - last).abs() <= side.near;
        Self { side, lowest: OnceCell::new(), highest: OnceCell::new(), x, is_near }
    }

    /// Whether the level of the problem before is near.
    pub(super) fn is_near(&self) -> bool {
        self.is_near
    }

    fn lowest(&self) -> Option<(Snapshot<'a>, usize)> {
        *self.lowest.get_or_init(|| {
            let snapshot = self.side.sections.snapshot(self.x);
            let lowest = || snapshot.extreme(&self.side.height, 1.0);
            (!snapshot.is_empty()).then(|| (snapshot, lowest()))
        })
    }

    /// More steps along one section than this are a walk in circles.
    pub(super) fn step_limit(&self) -> usize {
        self.side.topology.edge_count()
    }

    fn crossing(&self, up: u32) -> Crossing {
        self.side.count(1);
        let topology = self.side.topology;
        let vertices = [topology.half_edge(up).origin, topology.target(up)];
        let (low, high) = (self.side.point(vertices[0]), self.side.point(vertices[1]));
        let drift = (high.shadow - low.shadow) * (1.0 / (high.level - low.level));
        Crossing {
            up,
            vertices,
            levels: [low.level, high.level],
            w: low.shadow + drift * (self.x - low.level),
            drift,
        }
    }

    /// The neighbour up (or, past the top, down) the section in the direction of `chain`.
    pub(super) fn up(&self, chain: Chain, from: &Crossing) -> Crossing {
        let topology = self.side.topology;
        let above = |v: u32| self.side.level(v) > self.x;
        self.crossing(match self.side.turn_up(chain) {
            Turn::CounterClockwise => next_counter_clockwise(topology, from.up, above),
            Turn::Clockwise => next_clockwise(topology, from.up, above),
        })
    }

    /// The neighbour against the direction of `chain`.
    pub(super) fn down(&self, chain: Chain, from: &Crossing) -> Crossing {
        self.up(chain.opposite(), from)
    }

    /// The direction of the polygon edge from `from` to its neighbour in the direction of `chain`,
    /// from one more vertex of the face.
    fn direction(&self, chain: Chain, from: &Crossing) -> DVec2 {
        let topology = self.side.topology;
        let along = match self.side.turn_up(chain) {
            Turn::CounterClockwise => topology.half_edge(from.up).twin,
            Turn::Clockwise => from.up,
        };
        let third = topology.target(topology.next(along));
        let third = self.side.point(third);
        // The part of the way to the third vertex that keeps the level.
        let base = from.w - from.drift * (self.x - from.levels[0]);
        (third.shadow - base) - from.drift * (third.level - from.levels[0])
    }

    /// From an edge upwards along the mesh to one that crosses the level, at each vertex by the edge
    /// whose line has the least `score` at the level. `None` if it passes more than `limit` vertices,
    /// or if rounding hides the way.
    fn reach(&self, from: u32, limit: usize, score: impl Fn(f64) -> f64) -> Option<u32> {
        let topology = self.side.topology;
        let mut up = from;
        for _ in 0..=limit {
            let (low, high) = (topology.half_edge(up).origin, topology.target(up));
            if self.side.level(high) <= self.x {
                up = self.best_edge(high, 1.0, &score)?;
            } else if self.side.level(low) > self.x {
                up = topology.half_edge(self.best_edge(low, -1.0, &score)?).twin;
            } else {
                return Some(up);
            }
        }
        None
    }

    /// The half-edge from a vertex towards the level, which is above it for a `sign` of 1 and below
    /// it for -1, whose line has the least `score` there.
    fn best_edge(&self, vertex: u32, sign: f64, score: impl Fn(f64) -> f64) -> Option<u32> {
        self.side.count(1);
        let topology = self.side.topology;
        let start = self.side.point(vertex);
        let mut best = f64::INFINITY;
        let mut found = None;
        for (&h, &neighbour) in topology.outgoing(vertex).iter().zip(topology.neighbours(vertex)) {
            let end = self.side.point(neighbour);
            let rise = end.level - start.level;
            let drift = (end.shadow.x - start.shadow.x) / rise;
            let candidate = score(start.shadow.x + drift * (self.x - start.level));
            let better = sign * rise > 0.0 && (found.is_none() || candidate < best);
            (best, found) = if better { (candidate, Some(h)) } else { (best, found) };
        }
        found
    }

    /// The lowest vertex.
    pub(super) fn bottom(&self) -> Option<Bottom> {
        let (snapshot, lowest) = self.lowest()?;
        let up = self.reach(snapshot.up(lowest), usize::MAX, |h| h)?;
        Some(self.descend(up, self.step_limit()).unwrap_or_else(|last| last))
    }

    /// The same, from an edge upwards that crosses a level nearby.
    pub(super) fn bottom_from(&self, last: u32) -> Option<Bottom> {
        if let Some(up) = self.reach(last, STEPS_NEAR, |h| h)
            && let Ok(found) = self.descend(up, STEPS_NEAR)
        {
            return Some(found);
        }
        self.bottom()
    }

    /// Down the section from the vertex on an edge to its lowest one; where it came to, if that is
    /// more than `limit` steps away.
    fn descend(&self, up: u32, limit: usize) -> Result<Bottom, Bottom> {
        let vertex = self.crossing(up);
        let directions = [Chain::Left, Chain::Right].map(|chain| self.direction(chain, &vertex));
        let mut bottom = Bottom { vertex, directions };
        for _ in 0..limit {
            let [left, right] = bottom.directions;
            if !Chain::Left.ascends(left) {
                let vertex = self.up(Chain::Left, &bottom.vertex);
                let ahead = self.direction(Chain::Left, &vertex);
                bottom = Bottom { vertex, directions: [ahead, -left] };
            } else if !Chain::Right.ascends(right) {
                let vertex = self.up(Chain::Right, &bottom.vertex);
                let ahead = self.direction(Chain::Right, &vertex);
                bottom = Bottom { vertex, directions: [-right, ahead] };
            } else {
                return Ok(bottom);
            }
        }
        Err(bottom)
    }

    /// The end towards `chain` of the lowest edge if that is horizontal, else the lowest vertex.
    pub(super) fn bottom_end(&self, bottom: &Bottom, chain: Chain) -> Crossing {
        if is_horizontal(bottom.directions[usize::from(chain == Chain::Right)]) {
            self.up(chain, &bottom.vertex)
        } else {
            bottom.vertex
        }
    }

    /// The edge of a chain at height `h`, which is not below the bottom.
    pub(super) fn locate(&self, chain: Chain, h: f64) -> Option<Located> {
        let height = &self.side.height;
        let (snapshot, lowest) = self.lowest()?;
        let highest = *self.highest.get_or_init(|| snapshot.extreme(height, -1.0));
        let turn = self.side.turn_up(chain);
        self.side.count(snapshot.halvings());
        let index = snapshot.locate(height, (lowest, highest), turn, (h, self.x));
        let up = self.reach(snapshot.up(index), usize::MAX, |height| (height - h).abs())?;
        let start = self.crossing(up);
        let mut bracket = self.edge_toward(chain, start, h);
        if !chain.ascends(bracket.direction) {
            bracket = self.any_edge(chain, start);
        }
        for _ in 0..self.step_limit() {
            if bracket.low.h() <= h {
                break;
            }
            match self.retreat(chain, &bracket) {
                Some(below) => bracket = below,
                None => break,
            }
        }
        Some(self.walk(chain, bracket, h, self.step_limit()))
    }

    /// The edge of a chain at height `h`, from an edge upwards that crosses the level before, if that
    /// is near; `None` if the chain does not reach the height.
    pub(super) fn locate_from(&self, chain: Chain, h: f64, last: u32) -> Option<Bracket> {
        if self.is_near
            && let Some(found) = self.locate_near(chain, h, last)
        {
            return Some(found);
        }
        match self.locate(chain, h)? {
            Located::Edge(edge) if edge.low.h() <= h => Some(edge),
            _ => None,
        }
    }

    /// The same in a few steps.
    fn locate_near(&self, chain: Chain, h: f64, last: u32) -> Option<Bracket> {
        let start = self.crossing(self.reach(last, STEPS_NEAR, |height| (height - h).abs())?);
        let mut bracket = self.edge_toward(chain, start, h);
        if !chain.ascends(bracket.direction) {
            return None;
        }
        for _ in 0..STEPS_NEAR {
            if bracket.low.h() <= h {
                return match self.walk(chain, bracket, h, STEPS_NEAR) {
                    Located::Edge(edge) => Some(edge),
                    Located::Beyond(_) | Located::Short => None,
                };
            }
            bracket = self.retreat(chain, &bracket)?;
        }
        None
    }

    /// The edge at a vertex of the section that leads towards height `h`, on a chain or past its ends.
    fn edge_toward(&self, chain: Chain, start: Crossing, h: f64) -> Bracket {
        if start.h() <= h {
            Bracket::new(start, self.up(chain, &start))
        } else {
            Bracket::new(self.down(chain, &start), start)
        }
    }

    /// An edge of the chain near `start`, which lies at its top or bottom, or on the opposite
    /// chain.
    fn any_edge(&self, chain: Chain, start: Crossing) -> Bracket {
        let mut bracket = Bracket::new(self.down(chain, &start), start);
        if chain.ascends(bracket.direction) {
            return bracket;
        }
        // Down the opposite chain and around the bottom, or back over the top: whichever is shorter.
        let (mut ahead, mut back) = (start, bracket.low);
        for _ in 0..self.step_limit() {
            bracket = Bracket::new(ahead, self.up(chain, &ahead));
            if chain.ascends(bracket.direction) {
                break;
            }
            ahead = bracket.high;
            let below = Bracket::new(self.down(chain, &back), back);
            if chain.ascends(below.direction) {
                return below;
            }
            back = below.low;
        }
        bracket
    }

    /// From `bracket` up the chain to height `h`: a few steps along the mesh, or a search from
    /// scratch.
    pub(super) fn advance(&self, chain: Chain, bracket: &Bracket, h: f64) -> Option<Located> {
        match self.walk(chain, *bracket, h, STEPS_BEFORE_SEARCH) {
            Located::Short => self.locate(chain, h),
            found => Some(found),
        }
    }

    fn walk(&self, chain: Chain, bracket: Bracket, h: f64, limit: usize) -> Located {
        let mut bracket = bracket;
        for _ in 0..limit {
            if bracket.high.h() > h && !is_horizontal(bracket.direction) {
                return Located::Edge(bracket);
            }
            match self.proceed(chain, &bracket) {
                Some(above) => bracket = above,
                None if bracket.high.h() >= h => return Located::Edge(bracket),
                None => return Located::Beyond(bracket),
            }
        }
        Located::Short
    }

    /// The edge above `bracket` on its chain, if there is one.
    pub(super) fn proceed(&self, chain: Chain, bracket: &Bracket) -> Option<Bracket> {
        let above = Bracket::new(bracket.high, self.up(chain, &bracket.high));
        chain.ascends(above.direction).then_some(above)
    }

    /// The edge below `bracket` on its chain, if there is one.
    pub(super) fn retreat(&self, chain: Chain, bracket: &Bracket) -> Option<Bracket> {
        let below = Bracket::new(self.down(chain, &bracket.low), bracket.low);
        chain.ascends(below.direction).then_some(below)
    }
}
