//! Bounds on rounding errors, each as a constant or a method of [`Noise`].
//!
//! `docs/theory/rounding.md` derives every bound. Notation:
//!
//! - `u = 2^-53` is the unit roundoff.
//! - `S` is the size of a configuration: the reach of `P`, plus the reach of `Q`, plus the distance of their
//!   frames.
//! - `M = {q - p}` is the Minkowski difference, `d` the direction, `n` a unit normal.
//! - A *noise* is `32 u S`. It bounds the error of a coordinate of a point of `M` in the shadow frame.
//! - A *touching distance* is eight noises. Smaller lateral distances are not distinguished.
//!
//! Invariant: a bound that enters an answer is rounded outwards. Only guesses depend on [`SECTION`].

use crate::range::MIN_MAGNITUDE;

/// Unit roundoff `u`.
const UNIT_ROUNDOFF: f64 = 0.5 * f64::EPSILON;

/// Size of a noise, in `u S`.
const NOISE_IN_ROUNDOFFS: f64 = 32.0;

/// Bound on the length of two coordinate errors of `18 u S` each, in noises.
const LATERAL_ERROR: f64 = 0.8;

/// Length of a touching distance, in noises.
const TOUCHING_NOISES: f64 = 8.0;

/// Part of the longer half-side of the widening rectangle that does not depend on the margin, in touching
/// distances.
const WIDENING_TOUCHES: f64 = 4.0;

/// Half-sides of the widening rectangle, relative to the longer one. They differ, because a diagonal of a
/// square would often be parallel to an edge.
pub const WIDENING: [f64; 2] = [1.0, 0.8];

/// Upper bound on the length of [`WIDENING`].
const WIDENING_CORNER: f64 = 1.3;

/// Rounding error of the two bounds of an optimum together, in noises.
const BOUND_NOISES: f64 = 2.0;

/// Maximum excess of both bodies beyond their support points, in noises.
const EXCESS_NOISES: f64 = 8.0 * COPLANAR / (NOISE_IN_ROUNDOFFS * UNIT_ROUNDOFF);

/// Margin by which an upper bound is raised, in noises.
const UPPER_BOUND_NOISES: f64 = 4.0;

/// Maximum distance of the witness points of a certificate, in noises.
const RESIDUAL_NOISES: f64 = 3.0;

/// Margins by which the length of a weighted mean of points of `M` is raised to an upper bound, in noises: by a
/// search, and by a check. The margin of a check is smaller, because it computes the points nearly without rounding.
const MEAN_NOISES: [f64; 2] = [1.5, 0.375];

/// Margin by which a check raises the length of a weighted mean of points of `M` minus a translation, before it
/// compares the length with a minimum gap, in noises.
const GAP_NOISES: f64 = 0.5;

/// Maximum size of a slight minimum gap, in noises. Rounding may leave no points that are provably within it.
const MAX_SLIGHT_NOISES: f64 = 8.0;

/// Margins by which a height in the setting frame is lowered to a lower bound, in noises: by a search, and by a
/// check. The margin of a check is smaller, because it computes the points nearly without rounding.
const HEIGHT_NOISES: [f64; 2] = [0.75, 0.25];

/// Tolerance for the length of a unit vector, for its product with a vector that it should be orthogonal to, and
/// for a sum of weights that should be 1.
pub const UNIT_VECTOR: f64 = 32.0 * UNIT_ROUNDOFF;

/// Gain along an edge that a hill climb must exceed, in multiples of the sum of the magnitudes of the terms of the
/// gain. It is twice the rounding error of a gain.
pub const GAIN: f64 = 8.0 * UNIT_ROUNDOFF;

/// Distance from a face within which points are taken to lie on it, in multiples of the largest coordinate.
pub const COPLANAR: f64 = 64.0 * UNIT_ROUNDOFF;

/// Bound on the error of the distance between a point and a point of a triangle, in multiples of the largest
/// coordinate.
pub const WITNESS: f64 = 32.0 * UNIT_ROUNDOFF;

/// Bound on the error of a rotated point, in multiples of its distance from the origin of its frame.
pub const ROTATED_POINT: f64 = 96.0 * UNIT_ROUNDOFF;

/// Bound on the distance by which points of two moving bodies are displaced because coordinates of poses
/// below the exact range count as 0.
pub const FLUSHED_POSE_COORDINATES: f64 = 8.0 * MIN_MAGNITUDE;

/// Bound on the error of a displacement, in multiples of its length.
pub const DISPLACEMENT: f64 = 8.0 * UNIT_ROUNDOFF;

/// Relative rounding error of sums in section coordinates.
pub const SECTION: f64 = 128.0 * UNIT_ROUNDOFF;

/// Bounds on the rounding errors of a configuration of one size.
#[derive(Debug, Clone, Copy)]
pub struct Noise(f64);

impl Noise {
    /// Returns the bounds for the size `S`, a length in world units.
    #[inline]
    pub fn for_size(size: f64) -> Self {
        // Two coincident points have size 0. The smallest nonzero magnitude replaces it.
        Self(NOISE_IN_ROUNDOFFS * UNIT_ROUNDOFF * size.max(MIN_MAGNITUDE))
    }

    /// Returns the bound on the error of a coordinate of a point of `M`, and on the error of comparing two
    /// coordinates along a unit normal.
    #[inline]
    pub fn point_error(self) -> f64 {
        self.0
    }

    /// Returns the bound on the lateral error of the shadow of a point of `M`.
    #[inline]
    pub fn lateral_error(self) -> f64 {
        LATERAL_ERROR * self.0
    }

    /// Returns the touching distance, below which lateral distances are not distinguished.
    #[inline]
    pub fn touching_distance(self) -> f64 {
        TOUCHING_NOISES * self.0
    }

    /// Returns the bound on the excess of both bodies beyond their support points: twice four tolerances of
    /// [`COPLANAR`] of their size.
    #[inline]
    pub fn max_excess(self) -> f64 {
        EXCESS_NOISES * self.0
    }

    /// Returns the depth below a plane at which a point still counts as lying on the plane. `late` is true
    /// after the search has visited many portals.
    #[inline]
    pub fn plane_tolerance(self, late: bool) -> f64 {
        if late { self.touching_distance() } else { self.0 }
    }

    /// Returns the longer half-side of the widening rectangle for bodies whose shadows are `margin` apart.
    #[inline]
    pub fn widening_half_side(self, margin: f64) -> f64 {
        margin.max(0.0) + WIDENING_TOUCHES * self.touching_distance()
    }

    /// Returns the largest half-side of a widening rectangle. Its margin is at most one noise and `excess`, by which the
    /// bodies and their inputs reach beyond support points, because shadows that are farther apart are separated.
    #[inline]
    pub fn max_widening_half_side(self, excess: f64) -> f64 {
        self.widening_half_side(self.0 + excess)
    }

    /// Returns the largest difference of the estimates of the upper and the lower bound that rounding can cause, as a
    /// length along `n`. It does not include [`Self::lower_bound_margin`], [`Self::upper_bound_margin`] and
    /// [`Self::max_excess`]. `across` is the length of the part of `n` perpendicular to the direction, `widening`
    /// the longer half-side of the widening rectangle.
    #[inline]
    pub fn max_bound_gap(self, across: f64, widening: f64) -> f64 {
        // Depth at which the plane was accepted among ties.
        let bounds = self.plane_tolerance(true) + BOUND_NOISES * self.0;
        if widening == 0.0 { bounds } else { bounds + across * (2.0 * WIDENING_CORNER * widening) }
    }

    /// Returns the margin by which an estimate of a lower bound along `n` is lowered.
    #[inline]
    pub fn lower_bound_margin(self) -> f64 {
        self.0
    }

    /// Returns the margin by which an estimate of an upper bound along `n` is raised.
    #[inline]
    pub fn upper_bound_margin(self) -> f64 {
        UPPER_BOUND_NOISES * self.0
    }

    /// Returns the margin by which the length of a weighted mean of points of `M` is raised to an upper
    /// bound.
    #[inline]
    pub fn mean_length_margin(self) -> f64 {
        MEAN_NOISES[0] * self.0
    }

    /// Returns the margin by which a check raises the length of a weighted mean of points of `M`, which it
    /// computes nearly without rounding.
    #[inline]
    pub fn checked_mean_length_margin(self) -> f64 {
        MEAN_NOISES[1] * self.0
    }

    /// Checks whether a minimum gap is at most eight noises (a *slight* gap). Rounding may leave no points that are
    /// provably within such a gap. The size of this configuration includes the gap.
    #[inline]
    pub fn is_below_noise(self, min_gap: f64) -> bool {
        min_gap <= MAX_SLIGHT_NOISES * self.0
    }

    /// Returns the margin by which a check raises the length of a weighted mean of points of `M` minus a
    /// translation, before it compares the length with a minimum gap.
    #[inline]
    pub fn checked_gap_margin(self) -> f64 {
        GAP_NOISES * self.0
    }

    /// Returns the margin by which the height of a point of `M` is lowered to a lower bound.
    #[inline]
    pub fn height_margin(self) -> f64 {
        HEIGHT_NOISES[0] * self.0
    }

    /// Returns the margin by which a check lowers the height of a point of `M`, which it computes nearly
    /// without rounding.
    #[inline]
    pub fn checked_height_margin(self) -> f64 {
        HEIGHT_NOISES[1] * self.0
    }

    /// Returns the margin by which a check raises the proven upper bound along `n`, which it computes nearly
    /// without rounding. A certificate whose upper bound is lower is rejected.
    #[inline]
    pub fn checked_upper_bound_margin(self) -> f64 {
        (UPPER_BOUND_NOISES - 1.0) * self.0
    }

    /// Returns the maximum distance of the witness points of a certificate that claims an upper bound.
    #[inline]
    pub fn residual_tolerance(self) -> f64 {
        RESIDUAL_NOISES * self.0
    }

    /// Returns the maximum distance of the witness points of a certificate for bodies that were widened
    /// laterally. `excess` is that of [`Self::max_widening_half_side`].
    #[inline]
    pub fn widened_residual_tolerance(self, excess: f64) -> f64 {
        WIDENING_CORNER * self.max_widening_half_side(excess) + BOUND_NOISES * self.0
    }
}
