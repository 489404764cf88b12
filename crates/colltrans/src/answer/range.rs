//! Answers that take more than one cast: contact ranges and clearances.

use super::outcome::{Contact, Grazing, Separated};

/// The answer of [`contact_range`](crate::contact_range): all translations at which the bodies
/// meet, an interval, with the contact at either end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ContactRange {
    /// The bodies meet exactly for the translations in [`ContactRange::interval`].
    Contact {
        /// First contact along the direction.
        first: Contact,
        /// Last contact along the direction: the contact of the cast along the *opposite*
        /// direction, as that cast gives it (its certificate is for that direction, and its
        /// translation counts in multiples of it).
        last: Contact,
    },
    /// The shadows overlap by no more than the graze tolerance.
    Grazing {
        /// First contact along the direction.
        first: Grazing,
        /// Last contact, of the cast along the opposite direction.
        last: Grazing,
    },
    /// The bodies never meet.
    Separated(Separated),
}

impl ContactRange {
    /// `[enter, exit]` in multiples of the direction, `None` if the bodies never meet.
    pub fn interval(&self) -> Option<[f64; 2]> {
        let (first, last) = match self {
            Self::Contact { first, last } => (first, last),
            Self::Grazing { first, last } => (&first.contact, &last.contact),
            Self::Separated(_) => return None,
        };
        // Where both ends are one, rounding may have turned them round.
        let (enter, exit) = (first.translation, -last.translation);
        Some([enter.min(exit), enter.max(exit)])
    }
}

/// The answer of [`clearance`](crate::clearance): how far the moving body can move *from where it
/// is* along the direction.
#[derive(Debug, Clone, Copy, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "a query allocates nothing, so nothing is boxed")]
pub enum Clearance {
    /// As far as it likes: the bodies never meet, or only slide, or the contact lies behind.
    Free,
    /// Until it touches.
    Blocked {
        /// How far, in multiples of the direction; never negative.
        distance: f64,
        /// The contact that stops it.
        contact: Contact,
    },
    /// The bodies overlap now, by more than rounding error.
    Overlapping {
        /// The translations at which they do: `[enter, exit]`, with 0 inside.
        range: [f64; 2],
    },
}
