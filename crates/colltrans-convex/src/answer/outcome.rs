//! The outcome of a cast. Each case carries its proof.

use derive_where::derive_where;
use glam::DVec3;

use super::certificate::{Certificate, Separation};
use super::steps::{Solver, Steps};
use crate::body::{Body, ConvexPolyhedron};
use crate::setting::VertexPair;
use colltrans_kernel::bounded::{Bounded, RangeEnd};

/// The answer of [`Cast::first_contact`](crate::Cast::first_contact): whether and where the bodies meet along
/// the direction.
///
/// The cases are distinguished by the overlap of the bodies' shadows, their projections along the direction:
/// more than the graze tolerance, at most the graze tolerance, or none. `Solid`s do not graze; their shadows
/// overlap or do not.
#[derive(Debug)]
#[derive_where(Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case", bound = "")
)]
pub enum Outcome<B: Body = ConvexPolyhedron> {
    /// The moving body meets the fixed one at some translation, which may be negative.
    Contact(B::Contact),
    /// The shadows overlap laterally by at most the graze tolerance: the bodies slide along each other.
    Grazing(B::Grazing),
    /// The bodies never meet along the direction, neither forwards nor backwards.
    Separated(B::Separated),
}

impl Outcome {
    /// Returns the work done for this outcome.
    pub fn steps(&self) -> Steps {
        match self {
            Self::Contact(contact) | Self::Grazing(Grazing { contact, .. }) => contact.steps,
            Self::Separated(separated) => separated.steps,
        }
    }
}

/// The first contact of two convex bodies along the direction.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Contact {
    /// The collision translation: the smallest `t` at which the moving body, moved by `t * direction`, meets
    /// the fixed one. Given in multiples of the direction (a length if the direction is a unit vector).
    ///
    /// It is the best estimate, between the certificate's bounds. A negative value means that the bodies
    /// overlap now, or that the contact lies behind.
    pub translation: f64,
    /// Unit contact normal in the world, pointing from the moving body to the fixed one;
    /// `normal . direction > 0`. It is not unique if vertices or parallel edges meet.
    pub normal: DVec3,
    /// A vertex of each body in the contact plane.
    pub support: VertexPair,
    /// Lower and upper bound of the translation, with their proofs.
    pub certificate: Certificate,
    /// The solver of the query, with `Auto` resolved. [`Steps::started_from`] is the start of the search.
    pub solver: Solver,
    /// Work done.
    pub steps: Steps,
}

impl Contact {
    /// Builds a contact from its fields, in their order.
    #[doc(hidden)]
    pub const fn new(
        translation: f64,
        normal: DVec3,
        support: VertexPair,
        certificate: Certificate,
        solver: Solver,
        steps: Steps,
    ) -> Self {
        Self { translation, normal, support, certificate, solver, steps }
    }

    /// Returns the translation with its proven bounds, in multiples of the direction. `upper` is infinite for
    /// sliding bodies whose overlap is below the rounding error.
    pub fn bounded(&self) -> Bounded {
        let Certificate { lower, upper, .. } = self.certificate;
        Bounded { value: self.translation, lower, upper }
    }

    /// Returns where the bodies meet last along the original direction, in multiples of it, if this is the
    /// first contact of the [reversed](crate::Cast::reversed) cast. The bodies never meet beyond `upper`.
    pub fn exit(&self) -> Bounded {
        self.bounded().negated()
    }
}

/// Result for bodies that slide along each other: their shadows overlap by at most the graze tolerance.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Grazing {
    /// Unit vector in the world, orthogonal to the direction, pointing from the moving body's shadow to the
    /// fixed one's.
    pub separating_direction: DVec3,
    /// Overlap of the shadows along `separating_direction`, in world units, at most the graze tolerance. It
    /// is negative if the shadows are separated by less than the rounding error.
    pub overlap: f64,
    /// The contact that results if the overlap counts as contact.
    ///
    /// Its certificate claims an upper bound only if the overlap exceeds the rounding error, which a graze
    /// tolerance may allow. Otherwise it is the contact of laterally widened bodies. This proves no upper
    /// bound of the original ones, and `upper` is infinite.
    pub contact: Contact,
}

/// Result for bodies that never meet along the direction.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Separated {
    /// The proof: a unit normal orthogonal to the direction, and the margin along it.
    pub certificate: Separation,
    /// The solver that computed the answer, with `Auto` resolved.
    pub solver: Solver,
    /// Work done.
    pub steps: Steps,
}

impl Separated {
    /// Builds a separation result from its fields, in their order.
    #[doc(hidden)]
    pub const fn new(certificate: Separation, solver: Solver, steps: Steps) -> Self {
        Self { certificate, solver, steps }
    }
}

impl RangeEnd for Contact {
    fn bounded_translation(&self) -> Bounded {
        Self::bounded(self)
    }
}

impl RangeEnd for Grazing {
    fn bounded_translation(&self) -> Bounded {
        self.contact.bounded()
    }
}
