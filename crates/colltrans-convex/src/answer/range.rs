//! Answers that need more than one cast: contact ranges, depths along a direction and intersections.

use derive_where::derive_where;
use glam::DVec3;

use super::clearance::{Clearance, FreeReason};
use super::outcome::Outcome;
use crate::body::{Body, ConvexPolyhedron};
use colltrans_kernel::bounded::{Bounded, RangeEnd};

/// The answer of [`Cast::contact_range`](crate::Cast::contact_range): the first and the last contact along
/// the direction.
///
/// Convex bodies meet at all translations between the two. `Solid`s may separate and meet again.
#[derive(Debug)]
#[derive_where(Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case", bound = "")
)]
pub enum ContactRange<B: Body = ConvexPolyhedron> {
    /// The bodies meet at translations in [`ContactRange::interval`] only.
    Contact {
        /// First contact along the direction.
        first: B::Contact,
        /// Last contact along the direction: the first one of the [reversed](crate::Cast::reversed) cast. Its
        /// certificate refers to the reversed direction, and its translation is a multiple of that direction.
        last: B::Contact,
    },
    /// The shadows overlap by at most the graze tolerance.
    Grazing {
        /// First contact along the direction.
        first: B::Grazing,
        /// Last contact along the direction: the first one of the reversed cast.
        last: B::Grazing,
    },
    /// The bodies never meet.
    Separated(B::Separated),
}

impl<B: Body> ContactRange<B> {
    /// Returns `[enter, exit]` in multiples of the direction, `None` if the bodies never meet. These are best
    /// estimates, enclosed by [`Self::bounds`].
    pub fn interval(&self) -> Option<[f64; 2]> {
        self.bounds().map(|ends| ends.map(|end| end.value))
    }

    /// Returns the translations of the first and of the last contact, in multiples of the direction, with
    /// proven bounds. `None` if the bodies never meet.
    pub fn bounds(&self) -> Option<[Bounded; 2]> {
        match self {
            Self::Contact { first, last } => {
                Some([first.bounded_translation(), last.exit_translation()])
            }
            Self::Grazing { first, last } => {
                Some([first.bounded_translation(), last.exit_translation()])
            }
            Self::Separated(_) => None,
        }
    }
}

impl ContactRange {
    /// Returns how far the moving body can move from its current pose, as
    /// [`Cast::clearance`](crate::Cast::clearance) does.
    pub fn clearance(&self) -> Clearance {
        match *self {
            Self::Contact { first, last } => Clearance::blocked_by(&first)
                .unwrap_or_else(|| Clearance::beyond_first(first, last)),
            Self::Grazing { first, .. } => Clearance::Free(FreeReason::Slides(first)),
            Self::Separated(separated) => Clearance::Free(FreeReason::Separated(separated)),
        }
    }
}

/// The answer of [`Cast::directional_depth`](crate::Cast::directional_depth).
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct DirectionalDepth {
    /// Distance by which the moving body must move back until the overlap ends, in multiples of the
    /// direction. If the clearance is [`Clearance::Overlapping`], it is not less than the true depth. Otherwise it
    /// is 0, also for an overlap within the rounding error or the graze tolerance.
    pub depth: f64,
    /// The clearance from which the depth is derived, with its proof.
    pub clearance: Clearance,
}

/// The answer of [`Cast::intersects`](crate::Cast::intersects).
#[derive(Debug)]
#[derive_where(Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(bound = ""))]
pub struct Intersection<B: Body = ConvexPolyhedron> {
    /// Whether the bodies, as closed sets, have a common point. Exact for solids, to within rounding error
    /// for convex bodies.
    pub meets: bool,
    /// The evidence: a [`CentralCast`] of convex bodies, a `SolidIntersection` of solids.
    #[cfg_attr(feature = "serde", serde(flatten))]
    pub evidence: B::Evidence,
}

/// A cast of convex bodies along the line through their centres.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct CentralCast {
    /// Direction of the cast: the unit vector from the centre of the moving body to that of the fixed one, or the x
    /// axis if the centres coincide.
    pub direction: DVec3,
    /// Outcome of the cast. A separation, or a first contact ahead, proves that the bodies do not meet.
    pub outcome: Outcome,
}
