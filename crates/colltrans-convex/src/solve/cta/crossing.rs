//! The parts of a section in the shadow plane: vertices, edges and chains.
//!
//! Notation. `w = (h, g)` are shadow coordinates. The *left* chain of a section runs from its lowest
//! point (least `h`) to its highest one where `g` is smaller, the *right* chain where `g` is
//! greater. The *drift* of a crossing edge is how its section vertex moves per unit of level.

use glam::DVec2;

use colltrans_kernel::noise;

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

    /// The levels that the mesh edge spans.
    pub(super) fn span(&self) -> f64 {
        self.levels[1] - self.levels[0]
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

    /// The end whose mesh edge spans more levels: the drift of one that rounding alone lifts across
    /// the level has no digits.
    pub(super) fn steeper(&self) -> &Crossing {
        if self.low.span() > self.high.span() { &self.low } else { &self.high }
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
