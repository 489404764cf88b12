//! Casts of convex solids by those of their convex hulls, before any search.
//!
//! - [`transferred`] uses the answer of the hulls' cast, if its certificate holds for the solids too.
//! - [`contact_facets`] uses only the normal and the points of the hulls' contact. It proves a lower bound by a plane
//!   with that normal, or by the bounding boxes. The gap of two facets around the points gives the upper bound.
//!
//! One of these decides nearly all casts of convex solids; the others are searched. The second method is valid for
//! any rounding of the hulls and for solids that are not exactly convex. Derivations:
//! `docs/theory/hulls-of-solids.md`.

mod contact_facets;
mod transferred;

use std::cell::OnceCell;

use super::core_gap;
use crate::body::Solid;
use crate::solve::hulls::{HullPair, Surface};
use colltrans_convex::answer::{Contact, Outcome};
use colltrans_convex::cast::Cast;
pub(super) use contact_facets::ContactGuess;

/// Convex hulls of the two solids of a query, and their cast.
pub(super) struct Hulls<'a> {
    bodies: [Surface<'a>; 2],
    cast: Cast<'a>,
    /// Outcome of the cast.
    first_outcome: Outcome,
    /// Last contact of the hulls, computed on the first request.
    last_contact: OnceCell<Option<Contact>>,
}

impl<'a> Hulls<'a> {
    /// Casts the hulls of two convex solids. `None` if a body is not convex or is rounded, a minimum gap is
    /// set, the options state an overlap, or the cast fails.
    pub(super) fn of_cast(cast: &Cast<'a, Solid>) -> Option<Self> {
        let options = cast.options();
        if core_gap(cast) > 0.0 || options.overlapping == Some(true) {
            return None;
        }
        let pair = HullPair::of_convex(&cast.setting.bodies)?;
        let cast = pair.cast(&cast.setting);
        Some(Self {
            bodies: pair.surfaces,
            cast,
            first_outcome: cast.first_contact().ok()?,
            last_contact: OnceCell::new(),
        })
    }

    /// Returns the last contact of hulls whose first contact is behind, as the first one of the reversed cast.
    /// `None` if the hulls certainly overlap at the start or the cast finds no contact.
    fn last_contact(&self) -> Option<&Contact> {
        let last = || match self.cast.reversed().first_contact().ok()? {
            Outcome::Contact(last) if last.certificate.upper >= 0.0 => Some(last),
            _ => None,
        };
        self.last_contact.get_or_init(last).as_ref()
    }
}
