//! How far a body can move from where it is: three cases, told apart for all bodies in the same way.

use super::outcome::{Contact, Grazing, Separated};
use crate::body::{Body, ConvexPolyhedron};
use derive_where::derive_where;

/// The answer of [`Cast::clearance`](crate::Cast::clearance): how far the moving body can move *from
/// where it is* along the direction. One definition for all bodies; what is known of each case, its
/// proof included, is the body's.
///
/// | | [`ConvexPolyhedron`] | `Solid` |
/// |---|---|---|
/// | `Blocked` | [`Contact`] | `SolidContact` |
/// | `Free` | [`WhyFree`] | `SolidFree`: a separating plane, where one was found |
/// | `Overlapping` | [`OverlapAhead`] | `SolidOverlap` |
#[derive(Debug)]
#[derive_where(Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case", bound = "")
)]
pub enum Clearance<B: Body = ConvexPolyhedron> {
    /// Until it touches.
    Blocked {
        /// How far it may safely move, in multiples of the direction: the lower bound of where it is
        /// stopped, and never negative. So it is less than the estimate, [`Contact::translation`] or
        /// `SolidContact::translation`, by the rounding error.
        distance: f64,
        /// The contact that stops it.
        contact: B::Contact,
    },
    /// As far as it likes.
    Free(B::Free),
    /// The bodies overlap now, by more than is tolerated.
    Overlapping(B::Overlap),
}

/// Why nothing stops a convex body.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
pub enum WhyFree {
    /// It slides along the other body or past it within the graze tolerance.
    Slides(Grazing),
    /// The last contact, that of the [reversed](crate::Cast::reversed) cast, lies behind, or is where
    /// it is now and it moves away from it.
    Behind(Contact),
    /// It never meets the other body along this direction.
    Separated(Separated),
}

/// The overlap of two convex bodies, by the contacts at its ends.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct OverlapAhead {
    /// The first contact, behind.
    pub first: Contact,
    /// The last contact, ahead: that of the reversed cast.
    pub last: Contact,
}

impl Clearance {
    /// That of a first contact which is ahead, or here to within rounding.
    #[inline]
    pub(crate) fn blocked_by(first: &Contact) -> Option<Self> {
        let is_ahead = first.translation >= -first.certificate.rounding;
        let distance = first.certificate.lower.max(0.0);
        is_ahead.then_some(Self::Blocked { distance, contact: *first })
    }

    /// That of a first contact which is not.
    #[inline]
    pub(crate) fn beyond_first(first: Contact, last: Contact) -> Self {
        if last.translation < -last.certificate.rounding {
            Self::Overlapping(OverlapAhead { first, last })
        } else {
            Self::Free(WhyFree::Behind(last))
        }
    }
}

impl<B: Body> Clearance<B> {
    /// How far the moving body may safely move, in multiples of the direction: infinite where
    /// nothing stops it, `None` if the bodies overlap now.
    pub fn distance(&self) -> Option<f64> {
        match self {
            Self::Blocked { distance, .. } => Some(*distance),
            Self::Free(_) => Some(f64::INFINITY),
            Self::Overlapping(_) => None,
        }
    }

    /// Whether nothing stops the moving body.
    pub const fn is_free(&self) -> bool {
        matches!(self, Self::Free(_))
    }
}
