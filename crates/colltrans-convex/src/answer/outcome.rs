//! What a query answers: every case has a name and carries its proof.

use derive_where::derive_where;
use glam::DVec3;

use super::certificate::{Certificate, Separation};
use super::steps::{Solver, Steps};
use crate::body::{Body, ConvexPolyhedron};
use crate::setting::VertexPair;
use colltrans_kernel::bounded::{Bounded, RangeEnd};

/// The answer of [`Cast::first_contact`](crate::Cast::first_contact): do the bodies meet along the direction, and where.
///
/// Told apart by the bodies' shadows (projections along the direction): they overlap by more than
/// the graze tolerance, by no more than it, or not at all. Between `Solid`s there is no
/// grazing: shadows overlap, or do not.
#[derive(Debug)]
#[derive_where(Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case", bound = "")
)]
pub enum Outcome<B: Body = ConvexPolyhedron> {
    /// The moving body meets the fixed one at some translation (which may be negative).
    Contact(B::Contact),
    /// The shadows along the direction overlap sideways by no more than the graze tolerance:
    /// the bodies slide along each other.
    Grazing(B::Grazing),
    /// The bodies never meet along the direction, however far one moves, forwards or backwards.
    Separated(B::Separated),
}

impl Outcome {
    /// The work done for it.
    pub fn steps(&self) -> Steps {
        match self {
            Self::Contact(contact) | Self::Grazing(Grazing { contact, .. }) => contact.steps,
            Self::Separated(separated) => separated.steps,
        }
    }
}

/// Where the bodies first meet along the direction.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Contact {
    /// The collision translation in multiples of the direction (a length if the direction is a
    /// unit vector): the smallest `t` at which the moving body, moved by `t * direction`, meets the
    /// fixed one. Negative: the bodies overlap now, or the contact lies behind. The best estimate,
    /// between the certificate's bounds.
    pub translation: f64,
    /// Unit contact normal in the world, from the moving body to the fixed one;
    /// `normal . direction > 0`. Where corners meet, or parallel edges, it is one of several.
    pub normal: DVec3,
    /// A vertex of each body in the contact plane.
    pub support: VertexPair,
    /// Lower and upper bound with their proofs.
    pub certificate: Certificate,
    /// The solver asked for (never `Auto`); what the search began with is [`Steps::started_from`].
    pub solver: Solver,
    /// Work done.
    pub steps: Steps,
}

impl Contact {
    /// Of what an answer tells, in the order of the fields.
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

    /// The translation with its proven bounds. `upper` is infinite where the bodies slide so lightly
    /// that they may not touch.
    pub fn bounded(&self) -> Bounded {
        let Certificate { lower, upper, .. } = self.certificate;
        Bounded { value: self.translation, lower, upper }
    }

    /// Of the first contact of a [reversed](crate::Cast::reversed) cast: where the bodies meet last
    /// along the direction itself, in multiples of it, with its proven bounds. Beyond `upper` they
    /// never meet.
    pub fn exit(&self) -> Bounded {
        self.bounded().negated()
    }
}

/// The bodies slide along each other: their shadows overlap by no more than the graze tolerance.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Grazing {
    /// Unit vector in the world, orthogonal to the direction, from the moving body's shadow to the
    /// fixed one's.
    pub separating_direction: DVec3,
    /// How far the shadows overlap along `separating_direction`, in world units: at most the graze
    /// tolerance; negative when they miss each other by less than rounding error can tell.
    pub overlap: f64,
    /// The contact that results if the overlap is taken for real. Its certificate claims an upper
    /// bound only where the shadows overlap by more than rounding can tell (a graze tolerance may be
    /// larger than that): there the line pierces the triangle of its pairs, as of any other contact.
    /// Else bodies widened sideways were asked, of which nothing is known from above, and `upper` is
    /// infinite.
    pub contact: Contact,
}

/// The bodies never meet along the direction.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Separated {
    /// The proof: a unit normal orthogonal to the direction, and the margin along it.
    pub certificate: Separation,
    /// The solver that found it.
    pub solver: Solver,
    /// Work done.
    pub steps: Steps,
}

impl Separated {
    /// Of what an answer tells, in the order of the fields.
    #[doc(hidden)]
    pub const fn new(certificate: Separation, solver: Solver, steps: Steps) -> Self {
        Self { certificate, solver, steps }
    }
}

impl RangeEnd for Contact {
    fn bounded(&self) -> Bounded {
        Self::bounded(self)
    }
}

impl RangeEnd for Grazing {
    fn bounded(&self) -> Bounded {
        self.contact.bounded()
    }
}
