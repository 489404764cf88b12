//! Answers that take more than one cast: contact ranges, depths and intersections.

use glam::DVec3;

use super::clearance::{Clearance, WhyFree};
use super::outcome::{Contact, Grazing, Outcome, Separated};

/// The answer of [`Cast::contact_range`](crate::Cast::contact_range): all translations at which the
/// bodies meet, an interval, with the contact at either end.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
pub enum ContactRange {
    /// The bodies meet exactly for the translations in [`ContactRange::interval`].
    Contact {
        /// First contact along the direction.
        first: Contact,
        /// Last contact along the direction: the first of the [reversed](crate::Cast::reversed)
        /// cast, as that one gives it (its certificate is for that direction, and its translation
        /// counts in multiples of it).
        last: Contact,
    },
    /// The shadows overlap by no more than the graze tolerance.
    Grazing {
        /// First contact along the direction.
        first: Grazing,
        /// Last contact, of the reversed cast.
        last: Grazing,
    },
    /// The bodies never meet.
    Separated(Separated),
}

impl ContactRange {
    /// `[enter, exit]` in multiples of the direction, `None` if the bodies never meet.
    ///
    /// Best estimates; the certificates' bounds enclose them, and are those of [`Contact::bounded`] of
    /// the first contact and of [`Contact::exit`] of the last one.
    pub fn interval(&self) -> Option<[f64; 2]> {
        let (first, last) = match self {
            Self::Contact { first, last } => (first, last),
            Self::Grazing { first, last } => (&first.contact, &last.contact),
            Self::Separated(_) => return None,
        };
        Some([first.translation, -last.translation])
    }

    /// How far the moving body can move from where it is, as [`Cast::clearance`](crate::Cast::clearance)
    /// says.
    pub fn clearance(&self) -> Clearance {
        match *self {
            Self::Contact { first, last } => {
                Clearance::blocked(&first).unwrap_or_else(|| Clearance::past(first, last))
            }
            Self::Grazing { first, .. } => Clearance::Free(WhyFree::Slides(first)),
            Self::Separated(separated) => Clearance::Free(WhyFree::Separated(separated)),
        }
    }
}

/// The answer of [`Cast::directional_depth`](crate::Cast::directional_depth).
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct DirectionalDepth {
    /// How far the moving body has to go back, in multiples of the direction, until the overlap has
    /// ended: never less than the true depth; 0 if the bodies do not overlap.
    pub depth: f64,
    /// What it follows from, with its proof.
    pub clearance: Clearance,
}

/// The answer of [`Cast::intersects`](crate::Cast::intersects).
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Intersection {
    /// Whether the bodies, as closed sets and to within rounding error, have a point in common.
    pub meets: bool,
    /// The direction along which the moving body was cast to find out: between the centres.
    pub direction: DVec3,
    /// What that cast found: a separation, or a first contact ahead, proves that they do not meet.
    pub outcome: Outcome,
}
