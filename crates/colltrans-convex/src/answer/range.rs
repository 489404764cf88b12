//! Answers that take more than one cast: contact ranges, depths and intersections.

use derive_where::derive_where;
use glam::DVec3;

use super::clearance::{Clearance, WhyFree};
use super::outcome::Outcome;
use crate::body::{Body, ConvexPolyhedron};
use colltrans_kernel::bounded::{Bounded, RangeEnd};

/// The answer of [`Cast::contact_range`](crate::Cast::contact_range): the translations at which the
/// bodies meet first and last, with the contact at either end. Convex bodies meet at all between them;
/// `Solid`s may part and meet again.
#[derive(Debug)]
#[derive_where(Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case", bound = "")
)]
pub enum ContactRange<B: Body = ConvexPolyhedron> {
    /// The bodies meet at translations in [`ContactRange::interval`] and at no other.
    Contact {
        /// First contact along the direction.
        first: B::Contact,
        /// Last contact along the direction: the first of the [reversed](crate::Cast::reversed)
        /// cast, as that one gives it (its certificate is for that direction, and its translation
        /// counts in multiples of it).
        last: B::Contact,
    },
    /// The shadows overlap by no more than the graze tolerance.
    Grazing {
        /// First contact along the direction.
        first: B::Grazing,
        /// Last contact, of the reversed cast.
        last: B::Grazing,
    },
    /// The bodies never meet.
    Separated(B::Separated),
}

impl<B: Body> ContactRange<B> {
    /// `[enter, exit]` in multiples of the direction, `None` if the bodies never meet: best estimates, as
    /// [`Self::bounds`] encloses them.
    pub fn interval(&self) -> Option<[f64; 2]> {
        self.bounds().map(|ends| ends.map(|end| end.value))
    }

    /// Where the bodies meet first and last along the direction, with proven bounds.
    pub fn bounds(&self) -> Option<[Bounded; 2]> {
        match self {
            Self::Contact { first, last } => Some([first.bounded(), last.exit()]),
            Self::Grazing { first, last } => Some([first.bounded(), last.exit()]),
            Self::Separated(_) => None,
        }
    }
}

impl ContactRange {
    /// How far the moving body can move from where it is, as [`Cast::clearance`](crate::Cast::clearance)
    /// says.
    pub fn clearance(&self) -> Clearance {
        match *self {
            Self::Contact { first, last } => Clearance::blocked_by(&first)
                .unwrap_or_else(|| Clearance::beyond_first(first, last)),
            Self::Grazing { first, .. } => Clearance::Free(WhyFree::Slides(first)),
            Self::Separated(separated) => Clearance::Free(WhyFree::Separated(separated)),
        }
    }
}

/// The answer of [`Cast::directional_depth`](crate::Cast::directional_depth).
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct DirectionalDepth {
    /// How far the moving body has to go back, in multiples of the direction, until the overlap has
    /// ended: never less than the true depth; 0 if the bodies do not overlap.
    pub depth: f64,
    /// What it follows from, with its proof.
    pub clearance: Clearance,
}

/// The answer of [`Cast::intersects`](crate::Cast::intersects).
#[derive(Debug)]
#[derive_where(Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(bound = ""))]
pub struct Intersection<B: Body = ConvexPolyhedron> {
    /// Whether the bodies, as closed sets, have a point in common: of convex ones to within rounding
    /// error, of solids exactly.
    pub meets: bool,
    /// What shows it: a [`CentralCast`] of convex bodies, a `SolidMeeting`.
    #[cfg_attr(feature = "serde", serde(flatten))]
    pub evidence: B::Evidence,
}

/// A cast of convex bodies along the line through their centres.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct CentralCast {
    /// Its direction: between the centres.
    pub direction: DVec3,
    /// What it found: a separation, or a first contact ahead, proves that they do not meet.
    pub outcome: Outcome,
}
