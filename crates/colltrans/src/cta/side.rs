//! One body as the planar problem sees it: sections in the shadow plane, walked on the mesh.
//!
//! Notation. A point of the body has a *level* (`x` for the moving, `y` for the fixed body) and shadow coordinates
//! `w = (h, g)`; all three are affine in the body frame. The *left* chain of a section runs from its lowest point (least `h`)
//! to its highest one where `g` is smaller, the *right* chain where `g` is greater. The *drift* of a crossing
//! edge is how its section vertex moves per unit of level.

use glam::{DVec2, DVec3};

use crate::polyhedron::topology::Topology;
use crate::section::{AxisSections, SectionForm, Turn, next_clockwise, next_counter_clockwise};

/// A mesh vertex: its level and its shadow.
#[derive(Debug, Clone, Copy)]
pub(super) struct Point {
    pub(super) level: f64,
    pub(super) shadow: DVec2,
}

/// A vertex of a section: a mesh edge that crosses the level.
#[derive(Debug, Clone, Copy)]
pub(super) struct Crossing {
    /// The half-edge that runs upwards.
    pub(super) up: u32,
    /// The mesh vertices of the edge, the one below first.
    pub(super) vertices: [u32; 2],
    /// Their levels.
    pub(super) levels: [f64; 2],
    /// The section vertex in the shadow plane.
    pub(super) w: DVec2,
    pub(super) drift: DVec2,
}

impl Crossing {
    pub(super) fn h(&self) -> f64 {
        self.w.x
    }

    pub(super) fn g(&self) -> f64 {
        self.w.y
    }

    /// Direction of the polygon edge to its neighbour `next`, of any length: exact even where a mesh vertex
    /// that both edges share makes the polygon edge vanish.
    pub(super) fn towards(&self, next: &Self) -> DVec2 {
        if self.vertices[0] == next.vertices[0] {
            next.drift - self.drift
        } else if self.vertices[1] == next.vertices[1] {
            self.drift - next.drift
        } else {
            next.w - self.w
        }
    }
}

/// The two chains of a section.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Chain {
    Left,
    Right,
}

impl Chain {
    /// The sign of `g` towards this chain.
    pub(super) fn sign(self) -> f64 {
        match self {
            Self::Left => -1.0,
            Self::Right => 1.0,
        }
    }

    pub(super) fn opposite(self) -> Self {
        match self {
            Self::Left => Self::Right,
            Self::Right => Self::Left,
        }
    }

    /// Whether `direction` leads up this chain; the horizontal edge at the bottom belongs to the chain that starts
    /// along it, the one at the top to none.
    pub(super) fn ascends(self, direction: DVec2) -> bool {
        direction.x > 0.0 || (direction.x == 0.0 && self.sign() * direction.y > 0.0)
    }
}

/// An edge of a section on one of its chains.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bracket {
    pub(super) low: Crossing,
    pub(super) high: Crossing,
    pub(super) direction: DVec2,
}

impl Bracket {
    pub(super) fn new(low: Crossing, high: Crossing) -> Self {
        Self { low, high, direction: low.towards(&high) }
    }

    /// `dg/dh` along the edge.
    pub(super) fn slope(&self) -> f64 {
        self.direction.y / self.direction.x
    }

    /// `g` at height `h` on the line of the edge.
    pub(super) fn g_at(&self, h: f64) -> f64 {
        let rise = h - self.low.h();
        if rise == 0.0 { self.low.g() } else { self.low.g() + rise * self.slope() }
    }
}

/// Where a height was found on a chain.
#[derive(Debug, Clone, Copy)]
pub(super) enum Located {
    /// On this edge.
    Edge(Bracket),
    /// The chain ends below: its topmost edge.
    Beyond(Bracket),
}

/// The lowest vertex of a section and its neighbours up both chains.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bottom {
    pub(super) vertex: Crossing,
    pub(super) left: Crossing,
    pub(super) right: Crossing,
}

/// A body with its section axis and shadow coordinates.
#[derive(Debug)]
pub(super) struct Side<'a> {
    vertices: &'a [DVec3],
    topology: &'a Topology,
    sections: &'a AxisSections,
    axis: DVec3,
    shadow: [DVec3; 2],
    constant: DVec2,
    height: SectionForm,
    /// The turn that leads up the left chain.
    left_turn: Turn,
}

/// Positions in the snapshot of one planar problem: bottom and top.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ends {
    bottom: usize,
    top: usize,
}

impl<'a> Side<'a> {
    /// The two covectors of the shadow are in the body frame, `constant` is the shadow of its origin.
    /// `along` is the axis' component along the direction.
    pub(super) fn new(
        (vertices, topology, sections): (&'a [DVec3], &'a Topology, &'a AxisSections),
        along: f64,
        shadow: [DVec3; 2],
        constant: DVec2,
    ) -> Self {
        Self {
            vertices,
            topology,
            sections,
            axis: sections.axis,
            shadow,
            constant,
            height: sections.form(shadow[0], constant.x),
            // (level, h, g) is right-handed if the axis points along the direction; then counter-clockwise leads from
            // +h to +g, and from the bottom, at -h, to -g: up the left chain.
            left_turn: if along > 0.0 { Turn::CounterClockwise } else { Turn::Clockwise },
        }
    }

    /// Lowest and highest level.
    pub(super) fn range(&self) -> [f64; 2] {
        self.sections.range
    }

    /// No point of the body has a smaller `h`.
    pub(super) fn least_height(&self) -> f64 {
        let any = self.point(0).shadow.x;
        any - self.shadow[0].length() * self.sections.diameter
    }

    /// More steps along one section than this are a walk in circles.
    pub(super) fn step_limit(&self) -> usize {
        self.topology.edge_count()
    }

    fn level(&self, vertex: u32) -> f64 {
        self.axis.dot(self.vertices[vertex as usize])
    }

    fn point(&self, vertex: u32) -> Point {
        let v = self.vertices[vertex as usize];
        Point {
            level: self.axis.dot(v),
            shadow: DVec2::new(self.shadow[0].dot(v), self.shadow[1].dot(v)) + self.constant,
        }
    }

    fn crossing(&self, up: u32, x: f64) -> Crossing {
        let vertices = [self.topology.half_edge(up).origin, self.topology.target(up)];
        let [low, high] = vertices.map(|v| self.point(v));
        let drift = (high.shadow - low.shadow) / (high.level - low.level);
        Crossing {
            up,
            vertices,
            levels: [low.level, high.level],
            w: low.shadow + drift * (x - low.level),
            drift,
        }
    }

    fn turn_up(&self, chain: Chain) -> Turn {
        match chain {
            Chain::Left => self.left_turn,
            Chain::Right => self.left_turn.reversed(),
        }
    }

    fn step(&self, from: &Crossing, turn: Turn, x: f64) -> Crossing {
        let above = |v: u32| self.level(v) > x;
        let up = match turn {
            Turn::CounterClockwise => next_counter_clockwise(self.topology, from.up, above),
            Turn::Clockwise => next_clockwise(self.topology, from.up, above),
        };
        self.crossing(up, x)
    }

    /// The neighbour up (or, past the top, down) the section in the direction of `chain`.
    pub(super) fn up(&self, chain: Chain, from: &Crossing, x: f64) -> Crossing {
        self.step(from, self.turn_up(chain), x)
    }

    /// The neighbour against the direction of `chain`.
    pub(super) fn down(&self, chain: Chain, from: &Crossing, x: f64) -> Crossing {
        self.step(from, self.turn_up(chain.opposite()), x)
    }

    /// From an edge that crosses at or below `x`, up the mesh to one that crosses at `x`, at each vertex by the edge
    /// whose line has the least `score` at `x`. `None` if rounding hides the way up.
    fn climb(&self, from: u32, x: f64, score: impl Fn(f64) -> f64) -> Option<u32> {
        let mut up = from;
        loop {
            let vertex = self.topology.target(up);
            let start = self.point(vertex);
            if start.level > x {
                return Some(up);
            }
            let mut best = f64::INFINITY;
            let mut next = None;
            for &h in self.topology.outgoing(vertex) {
                let end = self.point(self.topology.target(h));
                if end.level > start.level {
                    let drift = (end.shadow.x - start.shadow.x) / (end.level - start.level);
                    let candidate = score(start.shadow.x + drift * (x - start.level));
                    if candidate < best || next.is_none() {
                        (best, next) = (candidate, Some(h));
                    }
                }
            }
            up = next?;
        }
    }

    /// Where the snapshot below `x` has its bottom and its top.
    pub(super) fn ends(&self, x: f64) -> Option<Ends> {
        let snapshot = self.sections.snapshot(x);
        if snapshot.is_empty() {
            return None;
        }
        let bottom = snapshot.extreme(&self.height, 1.0);
        let top = snapshot.extreme(&self.height, -1.0);
        Some(Ends { bottom, top })
    }

    /// The lowest vertex of the section at `x`.
    pub(super) fn bottom(&self, ends: Ends, x: f64) -> Option<Bottom> {
        let seed = self.sections.snapshot(x).up(ends.bottom);
        let mut vertex = self.crossing(self.climb(seed, x, |h| h)?, x);
        let mut left = self.up(Chain::Left, &vertex, x);
        // The bottom is where both neighbours are up: go down whichever chain descends.
        if Chain::Left.ascends(vertex.towards(&left)) {
            let mut right = self.up(Chain::Right, &vertex, x);
            for _ in 0..self.step_limit() {
                if Chain::Right.ascends(vertex.towards(&right)) {
                    break;
                }
                (left, vertex) = (vertex, right);
                right = self.up(Chain::Right, &vertex, x);
            }
            return Some(Bottom { vertex, left, right });
        }
        let mut right = vertex;
        for _ in 0..self.step_limit() {
            (right, vertex) = (vertex, left);
            left = self.up(Chain::Left, &vertex, x);
            if Chain::Left.ascends(vertex.towards(&left)) {
                break;
            }
        }
        Some(Bottom { vertex, left, right })
    }

    /// The edge of a chain at height `h`, which is not below the bottom.
    pub(super) fn locate(&self, chain: Chain, ends: Ends, h: f64, x: f64) -> Option<Located> {
        let snapshot = self.sections.snapshot(x);
        let turn = self.turn_up(chain);
        let index = snapshot.locate(&self.height, (ends.bottom, ends.top), turn, (h, x));
        let up = self.climb(snapshot.up(index), x, |height| (height - h).abs())?;
        let mut start = self.crossing(up, x);
        let mut next = self.up(chain, &start, x);
        if !chain.ascends(start.towards(&next)) {
            let before = self.down(chain, &start, x);
            if chain.ascends(before.towards(&start)) {
                (next, start) = (start, before);
            } else {
                // On the opposite chain: around the bottom.
                for _ in 0..self.step_limit() {
                    (start, next) = (next, self.up(chain, &next, x));
                    if chain.ascends(start.towards(&next)) {
                        break;
                    }
                }
            }
        }
        let mut bracket = Bracket::new(start, next);
        for _ in 0..self.step_limit() {
            if bracket.low.h() <= h {
                break;
            }
            let before = self.down(chain, &bracket.low, x);
            if !chain.ascends(before.towards(&bracket.low)) {
                break;
            }
            bracket = Bracket::new(before, bracket.low);
        }
        Some(self.advance(chain, bracket, h, x))
    }

    /// From `bracket` up the chain to height `h`.
    pub(super) fn advance(&self, chain: Chain, bracket: Bracket, h: f64, x: f64) -> Located {
        let mut bracket = bracket;
        for _ in 0..self.step_limit() {
            if bracket.high.h() >= h && bracket.direction.x > 0.0 {
                return Located::Edge(bracket);
            }
            let next = self.up(chain, &bracket.high, x);
            let direction = bracket.high.towards(&next);
            if !chain.ascends(direction) {
                break;
            }
            bracket = Bracket { low: bracket.high, high: next, direction };
        }
        Located::Beyond(bracket)
    }

    /// The edge below `bracket` on its chain, if there is one.
    pub(super) fn retreat(&self, chain: Chain, bracket: &Bracket, x: f64) -> Option<Bracket> {
        let before = self.down(chain, &bracket.low, x);
        let below = Bracket::new(before, bracket.low);
        chain.ascends(below.direction).then_some(below)
    }

    /// The first edge of a chain.
    pub(super) fn first(bottom: &Bottom, chain: Chain) -> Bracket {
        match chain {
            Chain::Left => Bracket::new(bottom.vertex, bottom.left),
            Chain::Right => Bracket::new(bottom.vertex, bottom.right),
        }
    }
}
