//! Vertices, edges and chains of a section in the shadow plane.
//!
//! - *Shadow coordinates* `w = (h, g)`. `h` is the height.
//! - *Left chain*: the boundary of a section from its lowest to its highest point on the side of smaller `g`.
//!   *Right chain*: the boundary on the side of greater `g`.
//! - *Drift* of a section vertex: its change in the shadow plane per unit of level.

use glam::DVec2;

use colltrans_kernel::noise;

/// A vertex of a section: the point where a mesh edge crosses the level.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Crossing {
    /// Half-edge of the mesh edge in the direction of increasing level.
    pub(super) half_edge: u32,
    /// Ends of the mesh edge, the lower one first.
    pub(super) vertices: [u32; 2],
    /// Levels of both ends.
    pub(super) levels: [f64; 2],
    /// Position in the shadow plane.
    pub(super) w: DVec2,
    /// Change of `w` per unit of level.
    pub(super) drift: DVec2,
}

impl Crossing {
    pub(super) fn h(&self) -> f64 {
        self.w.x
    }

    pub(super) fn g(&self) -> f64 {
        self.w.y
    }

    /// Returns the length of the interval of levels that the mesh edge spans.
    pub(super) fn level_span(&self) -> f64 {
        self.levels[1] - self.levels[0]
    }

    /// Returns the direction of the polygon edge to the neighbour `next`, of any length. For two mesh edges
    /// with a common vertex it follows from the drifts, so that it is valid even if the polygon edge has length
    /// zero.
    pub(super) fn edge_direction_to(&self, next: &Self) -> DVec2 {
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
    /// Returns the sign of `g` towards this chain.
    pub(super) fn g_sign(self) -> f64 {
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

    /// Checks whether `direction` leads up this chain. A horizontal edge at the bottom belongs to the chain
    /// that starts along it. A horizontal edge at the top belongs to neither chain.
    pub(super) fn is_ascending(self, direction: DVec2) -> bool {
        if is_horizontal(direction) { self.g_sign() * direction.y > 0.0 } else { direction.x > 0.0 }
    }
}

/// Checks whether a direction is horizontal (constant `h`) up to rounding.
pub(super) fn is_horizontal(direction: DVec2) -> bool {
    direction.x.abs() <= noise::SECTION * direction.y.abs()
}

/// An edge of a section, directed up its chain.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct SectionEdge {
    /// Lower end.
    pub(super) low: Crossing,
    /// Upper end.
    pub(super) high: Crossing,
    /// Direction from the lower to the upper end, of any length.
    pub(super) direction: DVec2,
}

impl SectionEdge {
    /// Builds the edge between two neighbours.
    pub(super) fn new(low: Crossing, high: Crossing) -> Self {
        Self { low, high, direction: low.edge_direction_to(&high) }
    }

    /// Checks whether the perpendicular foot of a point is on the edge, up to `tolerance`.
    pub(super) fn is_beside(&self, point: DVec2, tolerance: f64) -> bool {
        let edge = self.high.w - self.low.w;
        let along = (point - self.low.w).dot(edge);
        let slack = tolerance * edge.abs().element_sum();
        -slack <= along && along <= edge.length_squared() + slack
    }

    /// Returns the end whose mesh edge spans more levels. The drift of a mesh edge that only rounding lifts
    /// across the level has no significant digits.
    pub(super) fn longer_end(&self) -> &Crossing {
        if self.low.level_span() > self.high.level_span() { &self.low } else { &self.high }
    }

    /// Returns `dg/dh` along the edge.
    pub(super) fn g_slope(&self) -> f64 {
        self.direction.y / self.direction.x
    }

    /// Returns `g` at height `h`, limited to the range of the edge's ends because the quotient has no
    /// significant digits on a nearly horizontal edge.
    pub(super) fn g_at(&self, h: f64) -> f64 {
        let (low, high) = (self.low.g(), self.high.g());
        let g = low + (h - self.low.h()) * self.g_slope();
        if low < high { g.clamp(low, high) } else { g.clamp(high, low) }
    }

    /// Returns a positive number if `w` lies on the side of greater `g`, a negative one on the other side.
    pub(super) fn signed_side(&self, w: DVec2) -> f64 {
        self.direction.perp_dot(w - self.low.w)
    }
}
