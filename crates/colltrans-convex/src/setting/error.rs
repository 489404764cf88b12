//! Why a query has no answer.

use glam::DVec3;
use thiserror::Error;

use crate::body::ObstacleId;

/// Why a query has no answer.
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
        /// The direction as given.
        direction: DVec3,
    },
    /// The graze tolerance is negative or not finite.
    #[error("the graze tolerance {tolerance} is negative or not finite")]
    GrazeTolerance {
        /// The tolerance as given.
        tolerance: f64,
    },
    /// The gap that is to be kept is negative, not finite or larger than a coordinate may be; or the library
    /// was built without its feature `keep`.
    #[error(
        "the gap {gap} to be kept is negative, not finite or larger than 2^200{}",
        if cfg!(feature = "keep") { "" } else { ", or this build keeps none" }
    )]
    Keep {
        /// The gap as given.
        gap: f64,
    },
    /// The length that a distance is compared with is negative or not a number.
    #[error("the length {length} is negative or not a number")]
    Length {
        /// The length as given.
        length: f64,
    },
    /// The tolerance by which solids are shrunk is negative or not finite.
    #[error("the tolerance {tolerance} is negative or not finite")]
    Tolerance {
        /// The tolerance as given.
        tolerance: f64,
    },
    /// Nothing is left of a closed body that is shrunk by half the tolerance: each of its points is that
    /// near to its surface. Nothing follows for the body as it is; a part of which only walls are thinner
    /// than the tolerance is not refused (`Solid::shrink_report`).
    #[error(
        "the tolerance {tolerance} leaves nothing of the {which} body, which is {extent} thick: \
         it has to be less than that"
    )]
    NothingLeft {
        /// `"moving"` or `"fixed"`.
        which: &'static str,
        /// The tolerance, as given or as chosen.
        tolerance: f64,
        /// The smallest side of the body's box in its own frame. Any tolerance below leaves something.
        extent: f64,
    },
    /// A convex body that is no solid.
    #[error("a convex body is not a solid: {reason}")]
    NoSolid {
        /// Why it is none.
        reason: String,
    },
    /// The gap at which narrowing ends is negative or not a number.
    #[error("the gap {gap} at which narrowing ends is negative or not a number")]
    NarrowingGap {
        /// The gap as given.
        gap: f64,
    },
    /// The half-side of a region focus is negative or not a number.
    #[error("the half-side {half_side} of the region focus is negative or not a number")]
    RegionFocus {
        /// The half-side as given.
        half_side: f64,
    },
    /// The search ended without an answer, and nothing is proven by it. Known only where one body is
    /// thinner than the rounding error at the size of the configuration (ratios beyond 1e11): please
    /// report another case (it can be saved as a file).
    #[error("the search ended without an answer: {reason}; please report this case")]
    NotConverged {
        /// What went wrong.
        reason: Stalled,
    },
    /// A motion goes so far that what computed places may be off is more than the bodies are large, so that nothing can be
    /// said of when they meet.
    #[error(
        "the motion goes so far, or so far away, that its places may be off by {off:e}, more than the bodies are \
         large, {size:e}"
    )]
    Coarse {
        /// By how much, at most.
        off: f64,
        /// How far both reach from their origins, together.
        size: f64,
    },
    /// One of many obstacles has no answer.
    #[error("obstacle {obstacle}: {reason}")]
    Obstacle {
        /// Which one.
        obstacle: ObstacleId,
        /// Why.
        #[source]
        reason: Box<Self>,
    },
}

impl QueryError {
    #[doc(hidden)]
    #[must_use]
    #[inline]
    pub fn of_obstacle(self, obstacle: ObstacleId) -> Self {
        Self::Obstacle { obstacle, reason: Box::new(self) }
    }
}

/// Why a search ended without an answer.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[non_exhaustive]
pub enum Stalled {
    /// No triangle of points of the Minkowski difference around the line was found, and no
    /// direction that separates.
    #[error("no portal was found")]
    NoPortal,
    /// The search along a motion took its maximum number of steps.
    #[error(
        "the search along the motion took its maximum number of steps; the bodies are proven not to meet before \
         {free_until}, what comes later is open"
    )]
    Motion {
        /// The bodies do not meet before this time.
        free_until: f64,
    },
    /// Portals followed each other without an end.
    #[error("portals followed each other in a circle")]
    Cycle,
    /// The plane and the points of a distance, or of a depth, are farther apart than rounding explains. In
    /// world units; both are proven bounds.
    #[error("the bounds did not meet: {lower} to {upper}, gap tolerated: {tolerance:e}")]
    Distance {
        /// The lower bound.
        lower: f64,
        /// The upper bound.
        upper: f64,
        /// The gap that would have been accepted.
        tolerance: f64,
    },
    /// The lowest plane found and the portal are farther apart than rounding explains. All in multiples
    /// of the direction, and as computed: neither number is a proven bound.
    #[error("the bounds did not meet: {lower} <= t <= {upper}, gap tolerated: {tolerance:e}")]
    Gap {
        /// Where the line meets the plane.
        lower: f64,
        /// Where it meets the portal.
        upper: f64,
        /// The gap that would have been accepted.
        tolerance: f64,
    },
}
