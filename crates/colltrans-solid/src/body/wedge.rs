//! Wedges of material around an edge, compared by signs only.
//!
//! - Directions around an axis `u` are ordered counter-clockwise, as seen with `u` pointing at the viewer.
//! - A facet that runs along `u` has its material on its clockwise side, a facet that runs against `u` on its
//!   counter-clockwise side. Therefore the wedge of an edge is the open arc from its backward to its forward facet.
//! - A [`Ray`] is a half-plane bounded by the axis, given by a point in it or by a point in the opposite half-plane. A
//!   facet through whose interior the axis runs has one ray of each kind, with the same point.

use std::cmp::Ordering;

/// Signs of determinants of points around an axis. Points are given by indices.
pub(crate) trait AxisSigns {
    /// Returns the sign of `det[u, x, y]`.
    fn determinant_sign(&self, x: usize, y: usize) -> Ordering;
    /// Checks whether `x` and `y`, in one plane with the axis, lie on the same side of the axis.
    fn same_half(&self, x: usize, y: usize) -> bool;
}

/// The direction from the axis to a point, or the opposite direction.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Ray {
    pub(crate) point: usize,
    pub(crate) opposite: bool,
}

impl Ray {
    /// Returns the ray towards a point.
    pub(crate) fn towards(point: usize) -> Self {
        Self { point, opposite: false }
    }
}

/// An open arc of material, from `start` counter-clockwise to `end`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Wedge {
    pub(crate) start: Ray,
    pub(crate) end: Ray,
}

impl Wedge {
    /// Checks whether two wedges have a common interior point. A wedge between coincident facets has no interior.
    pub(crate) fn intersects(&self, other: &Self, axis: &impl AxisSigns) -> bool {
        !self.is_empty(axis)
            && !other.is_empty(axis)
            && (self.contains(other.start, axis) || other.contains(self.start, axis))
    }

    /// Checks whether the facets of the wedge coincide.
    pub(crate) fn is_empty(&self, axis: &impl AxisSigns) -> bool {
        angle_class(self.start, self.end, axis) == 0
    }

    /// Checks whether a ray lies in the open arc.
    pub(crate) fn contains_strictly(&self, ray: Ray, axis: &impl AxisSigns) -> bool {
        angle_class(self.start, ray, axis) != 0 && self.contains(ray, axis)
    }

    /// Checks whether a ray lies in the arc, including its start.
    pub(crate) fn contains(&self, ray: Ray, axis: &impl AxisSigns) -> bool {
        match (angle_class(self.start, ray, axis), angle_class(self.start, self.end, axis)) {
            (0, _) => true,
            (a, b) if a != b => a < b,
            (2, _) => false,
            _ => ray_determinant(ray, self.end, axis) == Ordering::Greater,
        }
    }
}

/// Returns the sign of `det[u, x, y]` for two rays.
fn ray_determinant(x: Ray, y: Ray, axis: &impl AxisSigns) -> Ordering {
    let sign = axis.determinant_sign(x.point, y.point);
    if x.opposite == y.opposite { sign } else { sign.reverse() }
}

/// Returns the class of the angle from `x` to `y`: 0 for zero, 1 below a half turn, 2 for a half turn, 3 above.
fn angle_class(x: Ray, y: Ray, axis: &impl AxisSigns) -> u8 {
    match ray_determinant(x, y, axis) {
        Ordering::Greater => 1,
        Ordering::Less => 3,
        Ordering::Equal => {
            let same = axis.same_half(x.point, y.point) == (x.opposite == y.opposite);
            if same { 0 } else { 2 }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Directions at multiples of 45 degrees.
    struct Rose;

    impl AxisSigns for Rose {
        fn determinant_sign(&self, x: usize, y: usize) -> Ordering {
            match (y + 8 - x) % 8 {
                0 | 4 => Ordering::Equal,
                1..=3 => Ordering::Greater,
                _ => Ordering::Less,
            }
        }
        fn same_half(&self, x: usize, y: usize) -> bool {
            x % 8 == y % 8
        }
    }

    #[test]
    fn wedges_intersect_where_their_arcs_overlap() {
        for (a, b, c, d) in (0..4096).map(|i| (i & 7, i >> 3 & 7, i >> 6 & 7, i >> 9 & 7)) {
            let wedge = |s, e| Wedge { start: Ray::towards(s), end: Ray::towards(e) };
            // Eighths of the circle in the arc, as bits.
            let cover = |s: usize, e: usize| {
                (0..(e + 8 - s) % 8).fold(0_u8, |mask, k| mask | 1 << ((s + k) % 8))
            };
            let expected = cover(a, b) & cover(c, d) != 0;
            assert_eq!(wedge(a, b).intersects(&wedge(c, d), &Rose), expected, "{a} {b} {c} {d}");
            let opposite =
                Wedge { start: Ray { point: (a + 4) % 8, opposite: true }, end: Ray::towards(b) };
            assert_eq!(opposite.intersects(&wedge(c, d), &Rose), expected);
        }
    }
}
