//! Clearance: how far a body can move from its current pose. The three cases are the same for all kinds of
//! bodies.

use super::outcome::{Contact, Grazing, Separated};
use crate::body::{Body, ConvexPolyhedron};
use derive_where::derive_where;

/// The answer of [`Cast::clearance`](crate::Cast::clearance): how far the moving body can move from its
/// current pose along the direction.
///
/// The cases are the same for all bodies. Their contents depend on the kind of body:
///
/// | | [`ConvexPolyhedron`] | `Solid` |
/// |---|---|---|
/// | `Blocked` | [`Contact`] | `SolidContact` |
/// | `Free` | [`FreeReason`] | `SolidFree`: a separating plane, if one was found |
/// | `Overlapping` | [`OverlapAhead`] | `SolidOverlap` |
#[derive(Debug)]
#[derive_where(Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case", bound = "")
)]
pub enum Clearance<B: Body = ConvexPolyhedron> {
    /// The body can move until it touches the other one.
    Blocked {
        /// Safe translation, in multiples of the direction: the lower bound of the contact, or 0 if that is
        /// negative.
        ///
        /// Unless it is 0, it is at most the estimate, [`Contact::translation`] or
        /// `SolidContact::translation`.
        distance: f64,
        /// The blocking contact.
        contact: B::Contact,
    },
    /// The body can move without limit.
    Free(B::Free),
    /// The bodies overlap in their current poses: convex bodies by more than the rounding error, solids by more
    /// than the tolerance.
    Overlapping(B::Overlap),
}

/// Reason why nothing blocks a convex body.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
pub enum FreeReason {
    /// The body slides along the other one or past it, within the graze tolerance.
    Slides(Grazing),
    /// The last contact, that of the [reversed](crate::Cast::reversed) cast, lies behind or at the current
    /// pose, and the body moves away from it.
    Behind(Contact),
    /// The bodies never meet along this direction.
    Separated(Separated),
}

/// Overlap of two convex bodies, given by the contacts at its ends.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct OverlapAhead {
    /// The first contact, which lies behind.
    pub first: Contact,
    /// The last contact, which lies ahead: the first contact of the reversed cast.
    pub last: Contact,
}

impl Clearance {
    /// Returns [`Self::Blocked`] by a first contact. Returns `None` if the contact lies behind by more than
    /// its rounding.
    #[inline]
    pub(crate) fn blocked_by(first: &Contact) -> Option<Self> {
        let is_ahead = first.translation >= -first.certificate.rounding;
        let distance = first.certificate.lower.max(0.0);
        is_ahead.then_some(Self::Blocked { distance, contact: *first })
    }

    /// Returns the clearance of bodies whose first contact lies behind: an overlap if the last contact lies
    /// ahead by more than its rounding, otherwise free.
    ///
    /// `last` is the first contact of the reversed cast.
    #[inline]
    pub(crate) fn beyond_first(first: Contact, last: Contact) -> Self {
        if last.translation < -last.certificate.rounding {
            Self::Overlapping(OverlapAhead { first, last })
        } else {
            Self::Free(FreeReason::Behind(last))
        }
    }
}

impl<B: Body> Clearance<B> {
    /// Returns the safe translation in multiples of the direction. It is infinite if nothing blocks the body,
    /// and `None` if the bodies overlap now.
    pub fn distance(&self) -> Option<f64> {
        match self {
            Self::Blocked { distance, .. } => Some(*distance),
            Self::Free(_) => Some(f64::INFINITY),
            Self::Overlapping(_) => None,
        }
    }

    /// Checks whether nothing blocks the moving body.
    pub const fn is_free(&self) -> bool {
        matches!(self, Self::Free(_))
    }
}
