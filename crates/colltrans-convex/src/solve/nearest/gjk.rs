//! Descent over simplices of points of `M` to the point nearest to the origin (Gilbert, Johnson and Keerthi).
//!
//! While points of `M` lie below the plane at the nearest point of the simplex, the lowest of them joins the simplex.
//! The nearest point of the new simplex follows.

use glam::DVec3;

use super::simplex::{Corner, Simplex};
use super::{DescentResult, Difference};
use crate::setting::VertexPair;
use colltrans_kernel::real::{DoubleWord, Real, RealVector};
use colltrans_kernel::volume::{contains_origin, weights_of_origin};

/// Maximum number of steps, above all that were observed.
const MAX_STEPS: usize = 128;

/// Conditions at which a descent ends. Any one of them suffices.
#[derive(Debug, Clone, Copy)]
pub(super) struct Goal {
    /// Maximum difference of the computed bounds.
    pub(super) max_gap: f64,
    /// Thresholds: the first one for the lower bound to exceed, the second one for the upper bound to fall below.
    pub(super) thresholds: Option<[f64; 2]>,
    /// Fraction and length: the bounds differ by at most this fraction of the lower bound minus the length.
    pub(super) relative: Option<[f64; 2]>,
}

impl Goal {
    /// Checks whether the computed bounds fulfil one of the conditions.
    pub(super) fn is_reached(&self, found: &DescentResult) -> bool {
        let is_decided = |[above, below]: [f64; 2]| found.lower > above || found.upper < below;
        let gap = found.upper - found.lower.max(0.0);
        let is_accurate = |[share, beyond]: [f64; 2]| gap <= share * (found.lower - beyond);
        gap <= self.max_gap
            || self.thresholds.is_some_and(is_decided)
            || self.relative.is_some_and(is_accurate)
    }
}

/// Number type of the coordinates of a point of `M`.
pub(super) trait Coordinate: Real {
    /// Computes the point of a vertex pair.
    fn point(difference: &Difference, pair: VertexPair) -> RealVector<Self>;

    /// Returns the weights of the origin in a tetrahedron so flat that rounded weights miss it, in exact arithmetic.
    /// `None` if the origin is not inside, or if the type leaves the decision to a more accurate one.
    fn weights_in_flat_tetrahedron(_: &Difference, _: &[VertexPair; 4]) -> Option<[f64; 4]> {
        None
    }

    /// Converts a corner with rounded coordinates to this number type.
    fn convert_corner(difference: &Difference, corner: &Corner<f64>) -> Corner<Self> {
        Corner { at: Self::point(difference, corner.pair), pair: corner.pair }
    }
}

impl Coordinate for f64 {
    #[inline]
    fn point(difference: &Difference, pair: VertexPair) -> RealVector<Self> {
        RealVector(difference.point(pair).to_array())
    }

    #[inline]
    fn convert_corner(_: &Difference, corner: &Corner<f64>) -> Corner<Self> {
        *corner
    }
}

impl Coordinate for DoubleWord {
    fn point(difference: &Difference, pair: VertexPair) -> RealVector<Self> {
        difference.bodies.terms(pair).double_word_point()
    }

    fn weights_in_flat_tetrahedron(
        difference: &Difference,
        pairs: &[VertexPair; 4],
    ) -> Option<[f64; 4]> {
        let corners = pairs.map(|pair| difference.bodies.terms(pair));
        let is_inside = contains_origin(&corners, difference.bodies.size());
        let weights = if is_inside { weights_of_origin(&corners) } else { None };
        weights.filter(|weights| weights.iter().all(|weight| *weight > 0.0))
    }
}

/// Descends from `simplex` to the point of `M` nearest to the origin.
///
/// Stores planes and points in `found` that are better than the stored ones. Ends when `goal` is reached, when the
/// simplex contains the origin up to rounding, or when no step decreases the distance in numbers of type `T`.
#[inline]
pub(super) fn descend_to_nearest<T: Coordinate>(
    difference: &Difference,
    mut simplex: Simplex<T>,
    goal: &Goal,
    found: &mut DescentResult,
) {
    let noise = difference.noise.point_error();
    let mut last: Option<T> = None;
    for _ in 0..MAX_STEPS {
        let mut nearest = simplex.reduce();
        if simplex.is_full() && nearest.to_dvec3().length() > noise {
            let (pairs, _) = simplex.pairs_and_weights();
            if let Some(weights) = T::weights_in_flat_tetrahedron(difference, &pairs) {
                found.record_enclosure(pairs, weights);
                return;
            }
            nearest = simplex.reduce_to_face();
        }
        let square = nearest.dot(&nearest);
        if last.is_some_and(|last| square >= last) {
            return;
        }
        last = Some(square);
        let point = nearest.to_dvec3();
        found.record_point(point.length(), &simplex);
        if found.upper <= noise || simplex.is_full() {
            return;
        }
        let Some(normal) = unit_vector(simplex.normal(&nearest)).or_else(|| unit_vector(point))
        else {
            return;
        };
        let mut lowest = difference.support_point(normal, found.lowest);
        found.supports += 1;
        found.record_plane(normal, &lowest);
        if goal.is_reached(found) || simplex.contains(lowest.pair) {
            // Between edges as short as rounding errors a climb may have stopped far from the support point.
            found.verify_plane(difference);
            let verified = found.lowest.unwrap_or_default();
            if goal.is_reached(found) || simplex.contains(verified) {
                return;
            }
            lowest = difference.corner_at(verified);
        }
        simplex.push(T::convert_corner(difference, &lowest));
    }
}

/// Returns the unit vector along `v`. `None` if the length of `v` is 0 or not finite.
///
/// Divides by the length, so that a vector along an axis becomes exactly the axis.
#[inline]
pub(super) fn unit_vector(v: DVec3) -> Option<DVec3> {
    let length = v.length();
    (length > 0.0 && length.is_finite()).then(|| v / length)
}
