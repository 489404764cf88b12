//! The section of a body at one level, walked on the mesh.
//!
//! Every walk has a limit, the section's: how many mesh vertices it may pass, or edges of the
//! section. Where a walk begins is a guess, and where it ends does not depend on it.

use glam::DVec2;

use super::crossing::{Bracket, Chain, Crossing, is_horizontal};
use super::sectioned_body::Side;
use crate::body::convex::sections::{Turn, next_clockwise, next_counter_clockwise};

/// Steps of a walk before the body's chains, if it has some, tell where it leads, and between two such
/// questions.
pub(super) const PATIENCE: usize = 2;
const AGAIN: usize = 8;

/// A vertex of more edges is not looked around for the best one, if there are chains.
const FAN: usize = 16;

/// A face with more vertices is replaced by the part between two mesh edges.
pub(super) const FACE_SIDES: usize = 6;

/// Where a height was found on a chain.
#[derive(Debug, Clone, Copy)]
pub(super) enum Located {
    /// On this edge, or below it if that is the chain's first.
    Edge(Bracket),
    /// The chain ends below: its topmost edge.
    Beyond(Bracket),
}

impl Located {
    /// The edge there, or the nearest.
    pub(super) fn edge(self) -> Bracket {
        match self {
            Self::Edge(edge) | Self::Beyond(edge) => edge,
        }
    }
}

/// The lowest vertex of a section and the directions of its polygon edges up both chains.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bottom {
    pub(super) vertex: Crossing,
    pub(super) directions: [DVec2; 2],
}

/// The section of a body at one level.
#[derive(Debug, Clone, Copy)]
pub(super) struct Section<'a> {
    pub(super) side: &'a Side<'a>,
    pub(super) x: f64,
    /// Steps of a walk at most.
    pub(super) limit: usize,
}

impl Section<'_> {
    fn crossing(&self, up: u32) -> Crossing {
        self.side.count(1);
        let topology = self.side.topology;
        let vertices = [topology.origin(up), topology.target(up)];
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
    /// whose line has the least `score` at the level. `None` if that is too far, or if rounding hides
    /// the way.
    fn reach(&self, from: u32, score: impl Fn(f64) -> f64) -> Option<u32> {
        let topology = self.side.topology;
        let mut up = from;
        for step in 0..=self.limit {
            let (low, high) = (topology.origin(up), topology.target(up));
            let (vertex, sign) = if self.side.level(high) <= self.x {
                (high, 1.0)
            } else if self.side.level(low) > self.x {
                (low, -1.0)
            } else {
                return Some(up);
            };
            if let Some(search) = self.side.search(self.x) {
                if let Some(found) = search.along_faces(up) {
                    return Some(found);
                }
                if step == PATIENCE || topology.outgoing(vertex).len() > FAN {
                    return search.near(up);
                }
            }
            let h = self.best_edge(vertex, sign, &score)?;
            up = if sign > 0.0 { h } else { topology.half_edge(h).twin };
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

    /// The last vertex in the direction of `chain` for which `holds`, by the body's chains: it does for
    /// `from`, for those after it up to some vertex, and for none beyond on the way around.
    pub(super) fn skip(
        &self,
        chain: Chain,
        from: &Crossing,
        mut holds: impl FnMut(&Crossing) -> bool,
    ) -> Option<Crossing> {
        let search = self.side.search(self.x)?;
        let mut last = *from;
        search.last(from.up, self.side.turn_up(chain), |up| {
            let crossing = self.crossing(up);
            let found = holds(&crossing);
            last = if found { crossing } else { last };
            found
        })?;
        Some(last)
    }

    /// Down the chain opposite to `chain` and up it, if the polygon falls towards it at `from`: the last
    /// vertex from which it does.
    fn skip_down(&self, chain: Chain, from: &Crossing) -> Option<Crossing> {
        self.skip(chain, from, |v| v.h() <= from.h() && !chain.ascends(self.direction(chain, v)))
    }

    /// Up a chain: the last vertex not above height `h` from which it ascends.
    fn skip_up_to(&self, chain: Chain, from: &Crossing, h: f64) -> Option<Crossing> {
        self.skip(chain, from, |v| {
            (from.h()..=h).contains(&v.h()) && chain.ascends(self.direction(chain, v))
        })
    }

    /// Down a chain: the last vertex above height `h` to which it ascends.
    fn skip_down_to(&self, chain: Chain, from: &Crossing, h: f64) -> Option<Crossing> {
        let other = chain.opposite();
        self.skip(other, from, |v| {
            let below = -self.direction(other, v);
            v.h() > h && v.h() <= from.h() && chain.ascends(below) && !is_horizontal(below)
        })
    }

    /// The lowest vertex, from an edge upwards that crosses a level nearby.
    pub(super) fn bottom(&self, from: u32) -> Option<Bottom> {
        let vertex = self.crossing(self.reach(from, |h| h)?);
        let directions = [Chain::Left, Chain::Right].map(|chain| self.direction(chain, &vertex));
        let mut bottom = Bottom { vertex, directions };
        for step in 0..self.limit {
            let [left, right] = bottom.directions;
            let falls = if Chain::Left.ascends(left) { Chain::Right } else { Chain::Left };
            if step % AGAIN == PATIENCE
                && !falls.ascends(bottom.directions[usize::from(falls == Chain::Right)])
                && let Some(vertex) = self.skip_down(falls, &bottom.vertex)
            {
                let directions = [Chain::Left, Chain::Right].map(|c| self.direction(c, &vertex));
                bottom = Bottom { vertex, directions };
                continue;
            }
            if !Chain::Left.ascends(left) {
                let vertex = self.up(Chain::Left, &bottom.vertex);
                let ahead = self.direction(Chain::Left, &vertex);
                bottom = Bottom { vertex, directions: [ahead, -left] };
            } else if !Chain::Right.ascends(right) {
                let vertex = self.up(Chain::Right, &bottom.vertex);
                let ahead = self.direction(Chain::Right, &vertex);
                bottom = Bottom { vertex, directions: [-right, ahead] };
            } else {
                return Some(bottom);
            }
        }
        None
    }

    /// The end towards `chain` of the lowest edge if that is horizontal, else the lowest vertex.
    pub(super) fn bottom_end(&self, bottom: &Bottom, chain: Chain) -> Crossing {
        if is_horizontal(bottom.directions[usize::from(chain == Chain::Right)]) {
            self.up(chain, &bottom.vertex)
        } else {
            bottom.vertex
        }
    }

    /// The edge of a chain at height `h`, from an edge upwards that crosses a level nearby.
    pub(super) fn locate(&self, chain: Chain, h: f64, from: u32) -> Option<Located> {
        let start = self.crossing(self.reach(from, |height| (height - h).abs())?);
        let mut bracket = self.edge_toward(chain, start, h);
        if !chain.ascends(bracket.direction) {
            bracket = self.any_edge(chain, start)?;
        }
        self.move_to(chain, h, bracket)
    }

    /// The edge of a chain at height `h`, from another of its edges.
    pub(super) fn move_to(&self, chain: Chain, h: f64, from: Bracket) -> Option<Located> {
        let mut bracket = from;
        for step in 0..self.limit {
            if bracket.low.h() <= h {
                return self.climb(chain, bracket, h);
            }
            if step % AGAIN == PATIENCE
                && let Some(low) = self.skip_down_to(chain, &bracket.low, h)
            {
                bracket = Bracket::new(low, self.up(chain, &low));
            }
            match self.retreat(chain, &bracket) {
                Some(below) => bracket = below,
                None => return self.climb(chain, bracket, h),
            }
        }
        None
    }

    /// From an edge that is not above height `h`, or the chain's first, up to the one there.
    fn climb(&self, chain: Chain, from: Bracket, h: f64) -> Option<Located> {
        let mut bracket = from;
        for step in 0..self.limit {
            if step % AGAIN == PATIENCE
                && let Some(low) = self.skip_up_to(chain, &bracket.low, h)
            {
                bracket = Bracket::new(low, self.up(chain, &low));
            }
            if bracket.high.h() > h && !is_horizontal(bracket.direction) {
                return Some(Located::Edge(bracket));
            }
            match self.proceed(chain, &bracket) {
                Some(above) => bracket = above,
                None if bracket.high.h() >= h => return Some(Located::Edge(bracket)),
                None => return Some(Located::Beyond(bracket)),
            }
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
    fn any_edge(&self, chain: Chain, start: Crossing) -> Option<Bracket> {
        // Around the bottom or back over the top: whichever is shorter.
        let (mut ahead, mut back) = (start, start);
        for step in 0..self.limit {
            if step % AGAIN == PATIENCE
                && let Some(last) = self.skip_down(chain, &ahead)
            {
                // On the opposite chain: past its bottom.
                ahead = self.up(chain, &last);
            }
            let below = Bracket::new(self.down(chain, &back), back);
            if chain.ascends(below.direction) {
                return Some(below);
            }
            back = below.low;
            let above = Bracket::new(ahead, self.up(chain, &ahead));
            if chain.ascends(above.direction) {
                return Some(above);
            }
            ahead = above.high;
        }
        None
    }

    /// The edge of the section on the face of a half-edge, and its chain; `None` for a face of many
    /// sides, one that the level does not cut, or a horizontal edge.
    pub(super) fn on_face(&self, half_edge: u32) -> Option<(Chain, Bracket)> {
        let topology = self.side.topology;
        let boundary = topology.face(topology.half_edge(half_edge).face);
        if boundary.len() > FACE_SIDES {
            return None;
        }
        let above = |h: u32| self.side.level(topology.origin(h)) > self.x;
        let (mut from, mut to) = (None, None);
        let mut last = boundary.end - 1;
        for h in boundary {
            match (above(last), above(h)) {
                (true, false) => from = Some(topology.half_edge(last).twin),
                (false, true) => to = Some(last),
                _ => {}
            }
            last = h;
        }
        // Counter-clockwise.
        let (from, to) = (self.crossing(from?), self.crossing(to?));
        let chain = match self.side.turn_up(Chain::Left) {
            Turn::CounterClockwise => Chain::Left,
            Turn::Clockwise => Chain::Right,
        };
        let ahead = Bracket::new(from, to);
        if is_horizontal(ahead.direction) {
            return None;
        }
        Some(if chain.ascends(ahead.direction) {
            (chain, ahead)
        } else {
            (chain.opposite(), Bracket::new(to, from))
        })
    }

    /// The edge above `bracket` on its chain, if there is one.
    pub(super) fn proceed(&self, chain: Chain, bracket: &Bracket) -> Option<Bracket> {
        let above = Bracket::new(bracket.high, self.up(chain, &bracket.high));
        chain.ascends(above.direction).then_some(above)
    }

    /// The edge below `bracket` on its chain, if there is one; a horizontal one is none.
    pub(super) fn retreat(&self, chain: Chain, bracket: &Bracket) -> Option<Bracket> {
        let below = Bracket::new(self.down(chain, &bracket.low), bracket.low);
        let rises = chain.ascends(below.direction) && !is_horizontal(below.direction);
        rises.then_some(below)
    }
}
