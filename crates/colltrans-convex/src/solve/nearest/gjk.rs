//! The descent (Gilbert, Johnson and Keerthi): from a simplex of points of `M` to the nearest one.
//!
//! While the plane across the nearest point of the simplex has points of `M` below it, the lowest joins the
//! simplex, whose nearest point is found anew.

use glam::DVec3;

use super::simplex::{Corner, Simplex};
use super::{Difference, Found};
use crate::setting::VertexPair;
use colltrans_kernel::real::{Real, Twice, Vector};

/// More steps than were ever seen.
const MOST: usize = 128;

/// When a descent may end.
#[derive(Debug, Clone, Copy)]
pub(super) struct Goal {
    /// As soon as the bounds are so near to each other.
    pub(super) gap: f64,
    /// As soon as the lower bound is more than the first, or the upper one less than the second.
    pub(super) than: Option<[f64; 2]>,
    /// As soon as they differ by no more than such a share of what the lower one is beyond a length.
    pub(super) share: Option<[f64; 2]>,
}

impl Goal {
    pub(super) fn is_reached(&self, found: &Found) -> bool {
        let decided = |[more, less]: [f64; 2]| found.lower > more || found.upper < less;
        let gap = found.upper - found.lower.max(0.0);
        let is_nearly = |[share, beyond]: [f64; 2]| gap <= share * (found.lower - beyond);
        gap <= self.gap || self.than.is_some_and(decided) || self.share.is_some_and(is_nearly)
    }
}

/// A number that a point of `M` has coordinates in.
pub(super) trait Coordinate: Real {
    fn point(difference: &Difference, pair: VertexPair) -> Vector<Self>;

    /// The same of a pair whose point is known as rounded.
    fn of_corner(difference: &Difference, corner: &Corner<f64>) -> Corner<Self> {
        Corner { at: Self::point(difference, corner.pair), pair: corner.pair }
    }
}

impl Coordinate for f64 {
    #[inline]
    fn point(difference: &Difference, pair: VertexPair) -> Vector<Self> {
        Vector(difference.point(pair).to_array())
    }

    #[inline]
    fn of_corner(_: &Difference, corner: &Corner<f64>) -> Corner<Self> {
        *corner
    }
}

impl Coordinate for Twice {
    fn point(difference: &Difference, pair: VertexPair) -> Vector<Self> {
        difference.bodies.terms(pair).twice()
    }
}

/// Goes down from a simplex, as far as its numbers tell, and leaves in `found` what is better than what
/// was there.
#[inline]
pub(super) fn descend<T: Coordinate>(
    difference: &Difference,
    mut simplex: Simplex<T>,
    goal: &Goal,
    found: &mut Found,
) {
    let noise = difference.noise.point();
    let mut last: Option<T> = None;
    for _ in 0..MOST {
        let mut nearest = simplex.reduce();
        if simplex.is_full() && nearest.value().length() > noise {
            nearest = simplex.reduce_to_face();
        }
        let square = nearest.dot(&nearest);
        if last.is_some_and(|last| square >= last) {
            return;
        }
        last = Some(square);
        let point = nearest.value();
        found.note_point(point.length(), &simplex);
        if found.upper <= noise || simplex.is_full() {
            return;
        }
        let Some(normal) = unit(simplex.normal(&nearest)).or_else(|| unit(point)) else { return };
        let mut lowest = difference.lowest(normal, found.lowest);
        found.supports += 1;
        found.note_plane(normal, &lowest);
        if goal.is_reached(found) || simplex.contains(lowest.pair) {
            // Among edges as short as rounding errors a climb may have stuck far away.
            found.settle(difference);
            let settled = found.lowest.unwrap_or_default();
            if goal.is_reached(found) || simplex.contains(settled) {
                return;
            }
            lowest = difference.corner(settled);
        }
        simplex.push(T::of_corner(difference, &lowest));
    }
}

/// A vector at length 1, unless it has no length to speak of: divided, so that axes stay axes.
#[inline]
pub(super) fn unit(v: DVec3) -> Option<DVec3> {
    let length = v.length();
    (length > 0.0 && length.is_finite()).then(|| v / length)
}
