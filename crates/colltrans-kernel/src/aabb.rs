//! Axis-aligned bounding boxes.

use glam::DVec3;

/// An axis-aligned box: the points `x` with `low <= x <= high`.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct Aabb {
    /// The smallest coordinates.
    pub low: DVec3,
    /// The largest coordinates.
    pub high: DVec3,
}

impl Aabb {
    /// The empty box, which contains no point.
    pub const EMPTY: Self = Self { low: DVec3::INFINITY, high: DVec3::NEG_INFINITY };

    /// Returns the smallest box that contains all points; [`Self::EMPTY`] if there are none.
    #[inline]
    pub fn from_points(points: impl IntoIterator<Item = DVec3>) -> Self {
        let mut all = Self::EMPTY;
        points.into_iter().for_each(|p| all.extend_to(p));
        all
    }

    /// Returns the smallest box that contains the three corners of a triangle.
    #[inline]
    pub fn from_triangle([a, b, c]: [DVec3; 3]) -> Self {
        Self { low: a.min(b).min(c), high: a.max(b).max(c) }
    }

    /// Extends this box to contain `point`.
    #[inline]
    pub fn extend_to(&mut self, point: DVec3) {
        self.low = self.low.min(point);
        self.high = self.high.max(point);
    }

    /// Returns the smallest box that contains both boxes.
    #[inline]
    #[must_use]
    pub fn union(&self, other: &Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    /// Returns this box with all sides moved outwards by `by`, or inwards if `by` is negative.
    #[must_use]
    #[inline]
    pub fn expanded(&self, by: f64) -> Self {
        Self { low: self.low - by, high: self.high + by }
    }

    /// Checks whether the boxes have a point in common.
    #[inline]
    pub fn intersects(&self, other: &Self) -> bool {
        self.low.cmple(other.high).all() && self.high.cmpge(other.low).all()
    }

    /// Checks whether the distance of the boxes along an axis (0, 1 or 2) is greater than `by`.
    #[inline]
    pub fn is_separated_along(&self, other: &Self, axis: usize, by: f64) -> bool {
        self.low[axis] - other.high[axis] > by || other.low[axis] - self.high[axis] > by
    }

    /// Checks whether this box contains the other box.
    #[inline]
    pub fn contains_box(&self, other: &Self) -> bool {
        self.low.cmple(other.low).all() && self.high.cmpge(other.high).all()
    }

    /// Returns the lengths of the three sides.
    #[inline]
    pub fn side_lengths(&self) -> DVec3 {
        self.high - self.low
    }

    /// Returns half the surface area; not finite for [`Self::EMPTY`].
    #[inline]
    #[doc(hidden)]
    pub fn half_area(&self) -> f64 {
        let s = self.side_lengths();
        s.x * s.y + s.y * s.z + s.z * s.x
    }

    /// Returns the midpoint of the box.
    #[inline]
    pub fn center(&self) -> DVec3 {
        (self.low + self.high) * 0.5
    }
}
