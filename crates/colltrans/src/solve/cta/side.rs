//! One body as the planar problem sees it: sections in the shadow plane, walked on the mesh.
//!
//! Notation. A point of the body has a *level* (`x` for the moving, `y` for the fixed body) and
//! shadow coordinates `w = (h, g)`; all three are affine in the body frame. The *left* chain of a
//! section runs from its lowest point (least `h`) to its highest one where `g` is smaller, the
//! *right* chain where `g` is greater. The *drift* of a crossing edge is how its section vertex
//! moves per unit of level.

use std::cell::{Cell, OnceCell};

use glam::{DVec2, DVec3};

use crate::body::convex::sections::{
    AxisSections, SectionForm, Snapshot, Turn, next_clockwise, next_counter_clockwise,
};
use crate::body::topology::Topology;
use crate::number::noise;

/// Newton's method walks so far up a chain before it searches the snapshot.
const STEPS_BEFORE_SEARCH: usize = 2;

/// Edges of a vertex that are compared one by one.
const EDGES_TRIED: usize = 16;

/// Edges of the opposite chain that are passed on the way to the bottom.
const STEPS_TO_CHAIN: usize = 4;

/// Vertices on the way from a support vertex to a level.
const VERTICES_TRIED: usize = 4;

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

    /// Direction of the polygon edge to its neighbour `next`, of any length: exact even where a
    /// mesh vertex that both edges share makes the polygon edge vanish.
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

    /// Whether `direction` leads up this chain; the horizontal edge at the bottom belongs to the
    /// chain that starts along it, the one at the top to none.
    pub(super) fn ascends(self, direction: DVec2) -> bool {
        if is_horizontal(direction) { self.sign() * direction.y > 0.0 } else { direction.x > 0.0 }
    }
}

/// Whether an edge is horizontal up to rounding.
pub(super) fn is_horizontal(direction: DVec2) -> bool {
    direction.x.abs() <= noise::SECTION * direction.y.abs()
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

    /// `g` at height `h` on the edge; its ends bound it, since on a nearly horizontal edge the
    /// quotient has no digits.
    pub(super) fn g_at(&self, h: f64) -> f64 {
        let (low, high) = (self.low.g(), self.high.g());
        let g = low + (h - self.low.h()) * self.slope();
        if low < high { g.clamp(low, high) } else { g.clamp(high, low) }
    }

    /// Positive where a point lies to the side of greater `g`.
    pub(super) fn side_of(&self, w: DVec2) -> f64 {
        self.direction.perp_dot(w - self.low.w)
    }
}

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
    /// Iterations of the loops of planar problems so far: section vertices computed, mesh vertices
    /// climbed over, halvings of a snapshot.
    pub(super) iterations: Cell<u32>,
}

impl<'a> Side<'a> {
    /// The two covectors of the shadow are in the body frame, `constant` is the shadow of its
    /// origin. `along` is the axis' component along the direction.
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
            // (level, h, g) is right-handed if the axis points along the direction; then
            // counter-clockwise leads from +h to +g, and from the bottom, at -h, to -g: up the left
            // chain.
            left_turn: if along > 0.0 { Turn::CounterClockwise } else { Turn::Clockwise },
            iterations: Cell::new(0),
        }
    }

    fn count(&self, iterations: u32) {
        self.iterations.set(self.iterations.get() + iterations);
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

    /// The section at level `x` of the range.
    pub(super) fn section(&self, x: f64) -> Section<'_> {
        Section { side: self, lowest: OnceCell::new(), highest: OnceCell::new(), x }
    }

    /// A mesh edge that crosses level `x`, as the half-edge that runs upwards: the way there from a
    /// support vertex leads along edges that stay close to the supporting plane with this normal
    /// (body frame). `None` if it is long.
    pub(super) fn edge_near(&self, support: u32, normal: DVec3, x: f64) -> Option<u32> {
        let mut vertex = support;
        let upwards = self.level(vertex) <= x;
        for _ in 0..VERTICES_TRIED {
            let here = self.vertices[vertex as usize];
            let neighbours = self.topology.neighbours(vertex);
            if neighbours.len() > EDGES_TRIED {
                return None;
            }
            let (mut best, mut least) = (None, f64::INFINITY);
            for (k, &neighbour) in neighbours.iter().enumerate() {
                let edge = self.vertices[neighbour as usize] - here;
                let rise = self.axis.dot(edge);
                let depth = normal.dot(edge).abs() / rise.abs();
                let better = (rise > 0.0) == upwards && depth < least;
                (best, least) = if better { (Some(k), depth) } else { (best, least) };
            }
            let best = best?;
            if (self.level(neighbours[best]) <= x) != upwards {
                let out = self.topology.outgoing(vertex)[best];
                return Some(if upwards { out } else { self.topology.half_edge(out).twin });
            }
            vertex = neighbours[best];
        }
        None
    }

    pub(super) fn level(&self, vertex: u32) -> f64 {
        self.level_of(self.vertices[vertex as usize])
    }

    /// The level of a point of the body frame.
    pub(super) fn level_of(&self, point: DVec3) -> f64 {
        self.axis.dot(point)
    }

    #[inline]
    fn point(&self, vertex: u32) -> Point {
        let v = self.vertices[vertex as usize];
        Point {
            level: self.axis.dot(v),
            shadow: DVec2::new(self.shadow[0].dot(v), self.shadow[1].dot(v)) + self.constant,
        }
    }

    fn turn_up(&self, chain: Chain) -> Turn {
        match chain {
            Chain::Left => self.left_turn,
            Chain::Right => self.left_turn.reversed(),
        }
    }
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
}

impl<'a> Section<'a> {
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

    /// From an edge that crosses at or below the level, up the mesh to one that crosses, at each
    /// vertex by the edge whose line has the least `score` at the level. `None` if rounding hides
    /// the way up.
    fn climb(&self, from: u32, score: impl Fn(f64) -> f64) -> Option<u32> {
        let topology = self.side.topology;
        let mut up = from;
        loop {
            let vertex = topology.target(up);
            if self.side.level(vertex) > self.x {
                return Some(up);
            }
            self.side.count(1);
            let start = self.side.point(vertex);
            let mut best = f64::INFINITY;
            let mut next = None;
            for (&h, &neighbour) in
                topology.outgoing(vertex).iter().zip(topology.neighbours(vertex))
            {
                let end = self.side.point(neighbour);
                let drift = (end.shadow.x - start.shadow.x) / (end.level - start.level);
                let candidate = score(start.shadow.x + drift * (self.x - start.level));
                let better = end.level > start.level && (next.is_none() || candidate < best);
                (best, next) = if better { (candidate, Some(h)) } else { (best, next) };
            }
            up = next?;
        }
    }

    /// The lowest vertex.
    pub(super) fn bottom(&self) -> Option<Bottom> {
        let (snapshot, lowest) = self.lowest()?;
        let up = self.climb(snapshot.up(lowest), |h| h)?;
        let mut vertex = self.crossing(up);
        let mut left = self.direction(Chain::Left, &vertex);
        let mut right = self.direction(Chain::Right, &vertex);
        for _ in 0..self.step_limit() {
            if !Chain::Left.ascends(left) {
                vertex = self.up(Chain::Left, &vertex);
                (right, left) = (-left, self.direction(Chain::Left, &vertex));
            } else if !Chain::Right.ascends(right) {
                vertex = self.up(Chain::Right, &vertex);
                (left, right) = (-right, self.direction(Chain::Right, &vertex));
            } else {
                break;
            }
        }
        Some(Bottom { vertex, directions: [left, right] })
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
        let up = self.climb(snapshot.up(index), |height| (height - h).abs())?;
        let start = self.crossing(up);
        let mut bracket = if start.h() <= h {
            Bracket::new(start, self.up(chain, &start))
        } else {
            Bracket::new(self.down(chain, &start), start)
        };
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

    /// An edge of the chain at or near the crossing mesh edge `up`: also from the other side of the
    /// bottom.
    pub(super) fn edge_at(&self, chain: Chain, up: u32) -> Option<Bracket> {
        let mut low = self.crossing(up);
        for _ in 0..STEPS_TO_CHAIN {
            let above = Bracket::new(low, self.up(chain, &low));
            if chain.ascends(above.direction) {
                return Some(above);
            }
            low = above.high;
        }
        None
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
