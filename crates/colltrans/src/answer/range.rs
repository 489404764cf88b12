//! Answers that take more than one cast: contact ranges, clearances, depths and intersections.

use glam::DVec3;

use super::outcome::{Contact, Grazing, Outcome, Separated};

/// The answer of [`Cast::contact_range`](crate::Cast::contact_range): all translations at which the
/// bodies meet, an interval, with the contact at either end.
#[derive(Debug, Clone, Copy, PartialEq)]
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
    /// Best estimates; the certificates' bounds enclose them.
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
            Self::Grazing { first, .. } => Clearance::Slides(first),
            Self::Separated(separated) => Clearance::Separated(separated),
        }
    }
}

/// The answer of [`Cast::clearance`](crate::Cast::clearance): how far the moving body can move *from
/// where it is* along the direction, with the proof of each case.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Clearance {
    /// Until it touches.
    Blocked {
        /// How far it may safely move, in multiples of the direction: never negative, never more
        /// than the true distance. Less than [`Contact::translation`] by the rounding error.
        distance: f64,
        /// The contact that stops it.
        contact: Contact,
    },
    /// As far as it likes, sliding along the other body or past it within the graze tolerance.
    Slides(Grazing),
    /// As far as it likes: the last contact, that of the [reversed](crate::Cast::reversed) cast,
    /// lies behind, or is where it is now and it moves away from it.
    Behind(Contact),
    /// As far as it likes: it never meets the other body along this direction.
    Separated(Separated),
    /// The bodies overlap now, by more than rounding error.
    Overlapping {
        /// The first contact, behind.
        first: Contact,
        /// The last contact, ahead: that of the reversed cast.
        last: Contact,
    },
}

impl Clearance {
    /// That of a first contact which is ahead, or here to within rounding.
    #[inline]
    pub(crate) fn blocked(first: &Contact) -> Option<Self> {
        let is_ahead = first.translation >= -first.certificate.tolerance;
        let distance = first.certificate.lower.max(0.0);
        is_ahead.then_some(Self::Blocked { distance, contact: *first })
    }

    /// That of a first contact which is not.
    #[inline]
    pub(crate) fn past(first: Contact, last: Contact) -> Self {
        if last.translation < -last.certificate.tolerance {
            Self::Overlapping { first, last }
        } else {
            Self::Behind(last)
        }
    }

    /// How far the moving body may safely move, in multiples of the direction: infinite where
    /// nothing stops it, `None` if the bodies overlap now.
    pub fn distance(&self) -> Option<f64> {
        match self {
            Self::Blocked { distance, .. } => Some(*distance),
            Self::Slides(_) | Self::Behind(_) | Self::Separated(_) => Some(f64::INFINITY),
            Self::Overlapping { .. } => None,
        }
    }

    /// Whether nothing stops the moving body.
    pub fn is_free(&self) -> bool {
        self.distance() == Some(f64::INFINITY)
    }
}

/// The answer of [`Cast::directional_depth`](crate::Cast::directional_depth).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DirectionalDepth {
    /// How far the moving body has to go back, in multiples of the direction, until the overlap has
    /// ended: never less than the true depth; 0 if the bodies do not overlap.
    pub depth: f64,
    /// What it follows from, with its proof.
    pub clearance: Clearance,
}

/// The answer of [`Cast::intersects`](crate::Cast::intersects).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Intersection {
    /// Whether the bodies, as closed sets and to within rounding error, have a point in common.
    pub meets: bool,
    /// The direction along which the moving body was cast to find out: between the centres.
    pub direction: DVec3,
    /// What that cast found: a separation, or a first contact ahead, proves that they do not meet.
    pub outcome: Outcome,
}
