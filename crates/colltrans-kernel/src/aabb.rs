//! Boxes along the axes.

use glam::DVec3;

/// A box along the axes: the points `x` with `low <= x <= high`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Aabb {
    /// The smallest coordinates.
    pub low: DVec3,
    /// The largest coordinates.
    pub high: DVec3,
}

impl Aabb {
    /// The box that holds nothing.
    pub const EMPTY: Self = Self { low: DVec3::INFINITY, high: DVec3::NEG_INFINITY };

    /// The least box that holds these points.
    #[inline]
    pub fn of_points(points: impl IntoIterator<Item = DVec3>) -> Self {
        let mut all = Self::EMPTY;
        points.into_iter().for_each(|p| all.add(p));
        all
    }

    /// The least box that holds three points.
    #[inline]
    pub fn of_triangle([a, b, c]: [DVec3; 3]) -> Self {
        Self { low: a.min(b).min(c), high: a.max(b).max(c) }
    }

    /// Makes room for a point.
    #[inline]
    pub fn add(&mut self, point: DVec3) {
        self.low = self.low.min(point);
        self.high = self.high.max(point);
    }

    /// The least box that holds both.
    #[inline]
    #[must_use]
    pub fn join(&self, other: &Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    /// The same with all sides moved outwards, or inwards if `by` is negative.
    #[must_use]
    #[inline]
    pub fn grown(&self, by: f64) -> Self {
        Self { low: self.low - by, high: self.high + by }
    }

    /// Whether the boxes have a point in common.
    #[inline]
    pub fn meets(&self, other: &Self) -> bool {
        self.low.cmple(other.high).all() && self.high.cmpge(other.low).all()
    }

    /// Whether there is more than so much between the boxes along an axis.
    #[inline]
    pub fn is_apart(&self, other: &Self, axis: usize, by: f64) -> bool {
        self.low[axis] - other.high[axis] > by || other.low[axis] - self.high[axis] > by
    }

    /// Whether this box holds all of the other one.
    #[inline]
    pub fn holds(&self, other: &Self) -> bool {
        self.low.cmple(other.low).all() && self.high.cmpge(other.high).all()
    }

    /// Length, width and height.
    #[inline]
    pub fn size(&self) -> DVec3 {
        self.high - self.low
    }

    /// Half the surface; of no box, nothing.
    #[inline]
    #[doc(hidden)]
    pub fn half_area(&self) -> f64 {
        let s = self.size();
        s.x * s.y + s.y * s.z + s.z * s.x
    }

    /// The middle.
    #[inline]
    pub fn center(&self) -> DVec3 {
        (self.low + self.high) * 0.5
    }
}
