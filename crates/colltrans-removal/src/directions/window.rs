//! Rectangles of directions, and a conservative test whether a pair of nodes blocks no direction of a rectangle.
//!
//! Two facets `f` and `g` block a direction `d` only if a difference `g - f` of their points equals `t d` with
//! `t > 0`, or if they are coplanar and share a point. The directions that they block are an open cone. If the
//! cone contains a direction of a rectangle with a non-empty interior, it also contains a direction of this
//! interior. Therefore a cone that reaches only the boundary of such a rectangle is ignored. It counts for a
//! rectangle that is a segment or a point.

use glam::DVec3;

use super::bodies::{Bodies, NodeBounds};
use super::cell::{Cell, CubeSide};

/// Upper bound on the relative error of ratios of differences.
const RATIO_ERROR: f64 = 8.0 * f64::EPSILON;

/// Rectangle on a side of the cube.
#[derive(Debug, Clone, Copy)]
pub(super) struct Window {
    side: CubeSide,
    pub(super) u: [f64; 2],
    pub(super) v: [f64; 2],
    /// Whether the rectangle has a non-empty interior.
    has_interior: bool,
    corners: [DVec3; 4],
    lengths: [f64; 4],
    /// Number of corners that are tested: 1 for a single direction, otherwise 4.
    count: usize,
}

impl Window {
    pub(super) fn new(side: CubeSide, u: [f64; 2], v: [f64; 2]) -> Self {
        let places = [[u[0], v[0]], [u[1], v[0]], [u[1], v[1]], [u[0], v[1]]];
        let corners = places.map(|place| side.direction_at(place));
        let count = if u[0] == u[1] && v[0] == v[1] { 1 } else { 4 };
        let has_interior = u[0] < u[1] && v[0] < v[1];
        Self { side, u, v, has_interior, corners, lengths: corners.map(DVec3::length), count }
    }

    pub(super) fn of_cell(cell: &Cell) -> Self {
        Self::new(cell.side, cell.coordinate_range(0), cell.coordinate_range(1))
    }

    pub(super) fn at_place(side: CubeSide, [u, v]: [f64; 2]) -> Self {
        Self::new(side, [u; 2], [v; 2])
    }

    /// Checks whether no facet of `a`, of the moving body, blocks a facet of `b`, of the fixed body, along
    /// any direction of the rectangle.
    pub(super) fn is_missed(&self, bodies: &Bodies, a: &NodeBounds, b: &NodeBounds) -> bool {
        let (low, high) = (b.low - a.high, b.high - a.low);
        self.is_missed_by_box(low, high)
            || self.faces_away(a.axis, a.spread, bodies.permutes[0])
            || self.faces_away(-b.axis, b.spread, bodies.permutes[1])
            || self.is_behind_slab(a.axis, a.slab, [b.low, b.high], false)
            || self.is_behind_slab(b.axis, b.slab, [a.low, a.high], true)
    }

    /// Checks whether a box of differences contains neither zero nor a positive multiple of a direction of
    /// the rectangle. For a rectangle with interior, multiples of directions on its boundary alone are ignored.
    /// Returns `false` if rounding leaves this uncertain.
    fn is_missed_by_box(&self, low: DVec3, high: DVec3) -> bool {
        if low.max_element() <= 0.0 && high.min_element() >= 0.0 {
            return false;
        }
        let [k, i, j] = self.side.axes();
        let [near, far] =
            if self.side.sign() > 0.0 { [low[k], high[k]] } else { [-high[k], -low[k]] };
        if far <= 0.0 {
            return true;
        }
        let mut range = [near.max(0.0) * (1.0 - RATIO_ERROR), far * (1.0 + RATIO_ERROR)];
        self.restrict_range(&mut range, self.u[1], low[i])
            || self.restrict_range(&mut range, -self.u[0], -high[i])
            || self.restrict_range(&mut range, self.v[1], low[j])
            || self.restrict_range(&mut range, -self.v[0], -high[j])
            || range[0] > range[1]
    }

    /// Restricts a range of positive `t` to `t slope > limit`, or to `t slope >= limit` for a rectangle
    /// without interior. Returns `true` if the condition excludes all positive `t`.
    fn restrict_range(&self, range: &mut [f64; 2], slope: f64, limit: f64) -> bool {
        if slope > 0.0 {
            if limit > 0.0 {
                range[0] = range[0].max(limit / slope * (1.0 - RATIO_ERROR));
            }
            return false;
        }
        if limit > 0.0 || limit == 0.0 && (self.has_interior || slope < 0.0) {
            return true;
        }
        if slope < 0.0 {
            range[1] = range[1].min(limit / slope * (1.0 + RATIO_ERROR));
        }
        false
    }

    /// Checks whether no facet with a normal near `axis` faces along any of the directions.
    fn faces_away(&self, axis: DVec3, spread: f64, permutes: bool) -> bool {
        let away = |k: usize| {
            let terms = axis * self.corners[k];
            // Terms that vanish after a quarter turn vanish exactly.
            let size = if permutes { terms.abs().element_sum() } else { self.lengths[k] };
            terms.element_sum()
                <= -(spread * self.lengths[k] * (1.0 + RATIO_ERROR) + RATIO_ERROR * size)
        };
        spread < 1.0 && (0..self.count).all(away)
    }

    /// Checks whether a box lies behind a slab along all of the directions. `of_fixed` selects a slab of the
    /// fixed body.
    fn is_behind_slab(
        &self,
        axis: DVec3,
        slab: [f64; 2],
        bounds: [DVec3; 2],
        of_fixed: bool,
    ) -> bool {
        if slab[1] == f64::INFINITY {
            return false;
        }
        let (middle, half) = ((bounds[0] + bounds[1]) * 0.5, (bounds[1] - bounds[0]) * 0.5);
        let (center, reach) = (axis.dot(middle), axis.abs().dot(half));
        let slack = RATIO_ERROR * (axis.abs().dot(middle.abs()) + reach);
        let [low, high] = [center - reach - slack, center + reach + slack];
        let [least, most] = if of_fixed {
            [slab[0] - high, slab[1] - low]
        } else {
            [low - slab[1], high - slab[0]]
        };
        if least <= 0.0 && most >= 0.0 {
            return false;
        }
        let vector = if most < 0.0 { axis } else { -axis };
        (0..self.count).all(|k| {
            let terms = vector * self.corners[k];
            terms.element_sum() >= RATIO_ERROR * terms.abs().element_sum()
        })
    }
}
