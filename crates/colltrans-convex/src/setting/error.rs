//! Errors of queries.

use glam::DVec3;
use thiserror::Error;

use crate::body::ObstacleId;

/// Reason why a query has no answer.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum QueryError {
    /// The direction is zero, not finite, or beyond the exact range.
    #[error(
        "the direction {:?} is zero, not finite or has a component outside the exact range \
         (0, or a magnitude from 2^-200 to 2^200)",
        .direction.to_array()
    )]
    Direction {
        /// The direction, as given.
        direction: DVec3,
    },
    /// The graze tolerance is negative or not finite.
    #[error("the graze tolerance {tolerance} is negative or not finite")]
    GrazeTolerance {
        /// The tolerance, as given.
        tolerance: f64,
    },
    /// The minimum gap is negative, not finite or larger than 2^200, or is not 0 and the library was built
    /// without its feature `min-gap`.
    #[error(
        "the minimum gap {gap} is negative, not finite or larger than 2^200{}",
        if cfg!(feature = "min-gap") { "" } else { "; this build accepts only 0" }
    )]
    MinGap {
        /// The gap, as given.
        gap: f64,
    },
    /// The length with which a distance is compared is negative or not a number.
    #[error("the length {length} is negative or not a number")]
    Length {
        /// The length, as given.
        length: f64,
    },
    /// The tolerance by which solids are shrunk is negative or not finite.
    #[error("the tolerance {tolerance} is negative or not finite")]
    Tolerance {
        /// The tolerance, as given.
        tolerance: f64,
    },
    /// Shrinking by half of the tolerance removes a closed body completely, because each of its points is
    /// within that distance of its surface.
    ///
    /// This error proves nothing about the nominal body. A body of which only some walls are thinner than the
    /// tolerance is accepted; see `Solid::shrink_report`.
    #[error(
        "the tolerance {tolerance} leaves nothing of the {which} body, which is {extent} thick: \
         give a tolerance below that"
    )]
    NothingLeft {
        /// `"moving"` or `"fixed"`.
        which: &'static str,
        /// The tolerance, as given or as chosen by default.
        tolerance: f64,
        /// Smallest side of the body's box in its own frame, a length. With any tolerance below it, part of
        /// the body is left.
        extent: f64,
    },
    /// A body cannot be used as a solid.
    #[error("the body cannot be used as a solid: {reason}")]
    NotASolid {
        /// Message of the failed conversion.
        reason: String,
    },
    /// The gap at which narrowing ends is negative or not a number ([`Until::Gap`](crate::cta::Until::Gap)).
    #[error("the gap {gap} at which narrowing ends is negative or not a number")]
    NarrowingGap {
        /// The gap, as given.
        gap: f64,
    },
    /// The half-side of a region focus is negative or not a number.
    #[error("the half-side {half_side} of the region focus is negative or not a number")]
    RegionFocus {
        /// The half-side, as given.
        half_side: f64,
    },
    /// The search ended without an answer. The fields of [`Stalled`] state which bounds are proven nevertheless.
    ///
    /// The known cases have a body that is thinner than the rounding error at the size of the configuration
    /// (ratios above 1e11). Please report any other case; it can be saved as a file.
    #[error("the search ended without an answer: {reason}; please report this case")]
    NotConverged {
        /// Cause of the failure.
        reason: Stalled,
    },
    /// The motion goes so far that the error of computed positions exceeds the size of the bodies. No time of
    /// contact can be bounded then.
    #[error(
        "the motion goes too far: the error of computed positions, up to {off:e}, exceeds the size of the bodies, \
         {size:e}; use a shorter motion, or poses closer to the origin"
    )]
    PositionError {
        /// Bound on the error of a position, in world units.
        off: f64,
        /// Sum of the bodies' largest distances from their origins.
        size: f64,
    },
    /// The query about one of many obstacles has no answer.
    #[error("obstacle {obstacle}: {reason}")]
    Obstacle {
        /// The obstacle.
        obstacle: ObstacleId,
        /// Error of the query about this obstacle.
        #[source]
        reason: Box<Self>,
    },
}

impl QueryError {
    /// Wraps this error as that of one obstacle.
    #[doc(hidden)]
    #[must_use]
    #[inline]
    pub fn of_obstacle(self, obstacle: ObstacleId) -> Self {
        Self::Obstacle { obstacle, reason: Box::new(self) }
    }
}

/// Reason why a search ended without an answer.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[non_exhaustive]
pub enum Stalled {
    /// The search found neither a triangle of points of the Minkowski difference around the line nor a
    /// separating direction.
    #[error("no portal was found")]
    NoPortal,
    /// The search along a motion reached its maximum number of steps.
    #[error(
        "the search along the motion reached its maximum number of steps; the bodies are proven not to meet before \
         {free_until}, later times are undecided"
    )]
    Motion {
        /// Time before which the bodies are proven not to meet.
        free_until: f64,
    },
    /// The exchanges of portals did not end.
    #[error("the exchanges of portals did not end")]
    Cycle,
    /// The bounds of a distance or of a depth differ by more than rounding explains. Both are proven, in
    /// world units.
    #[error("the bounds did not converge: {lower} to {upper}, accepted difference: {tolerance:e}")]
    Distance {
        /// The lower bound.
        lower: f64,
        /// The upper bound.
        upper: f64,
        /// The largest difference that would have been accepted.
        tolerance: f64,
    },
    /// The lowest plane that was found and the portal differ by more than rounding explains.
    ///
    /// All numbers are in multiples of the direction. The bounds of a cast without a minimum gap are estimates, and
    /// neither is proven. The bounds of a cast with a minimum gap are proven, and `upper` may be infinite.
    #[error(
        "the bounds did not converge: {lower} <= t <= {upper}, accepted difference: {tolerance:e}"
    )]
    Gap {
        /// Translation at which the line intersects the plane; with a minimum gap, the proven lower bound.
        lower: f64,
        /// Translation at which the line intersects the portal; with a minimum gap, the proven upper bound.
        upper: f64,
        /// The largest difference that would have been accepted.
        tolerance: f64,
    },
}
