//! How far a solid can move from where it is.
//!
//! With a tolerance `L` both bodies are shrunk by `L / 2`. If their interiors then share a point, they
//! overlap: how much has a file of its own, [`tolerance`].

mod answer;
mod boxes;
#[cfg(feature = "serde")]
mod encoding;
mod hulls;
mod proof;
mod queries;
pub(crate) mod tolerance;
mod verify;
#[cfg(all(test, debug_assertions))]
mod work;

pub use proof::{Claim, Cover, SolidCertificate, StartProof, StopProof};
pub use queries::{SolidCast, SolidScene};
pub use verify::SolidProof;

use crate::body::Solid;
use crate::solve::contact::SolidContact;
use crate::solve::nearest::{SolidGap, SolidNear};
use crate::solve::overlap::{self, Overlap};
use crate::solve::search::Workspace;
use crate::solve::separate;
use crate::solve::steps::SolidSteps;
use colltrans_convex::answer::{
    Bounded, CertificateError, Clearance, ContactRange, Intersection, Outcome, RangeEnd, Separation,
};
use colltrans_convex::body::{Body, Placed, Pose};
use colltrans_convex::cast::{Cast, CastBody, common_end};
use colltrans_convex::setting::check_keep;
use colltrans_convex::setting::error::QueryError;

/// Default tolerance, in multiples of the rounding error of a coordinate.
const NOISES: f64 = 8.0;

/// What an overlap at the start means.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
pub enum StartOverlap {
    /// It is the answer.
    #[default]
    Refuse,
    /// Facets that cross now do not block; contacts that begin later do. [`SolidCast::start_overlap`] says
    /// what was ignored.
    Ignore,
}

colltrans_kernel::written::named!(
    "meaning of an overlap",
    StartOverlap { Refuse: "refuse", Ignore: "ignore" }
);

/// Choices of a query between solids. More may be added: begin with the default ones.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct SolidOptions {
    /// What an overlap at the start means.
    pub start_overlap: StartOverlap,
    /// Both bodies are shrunk by half of this length. `None` stands for 0 where both poses turn by
    /// quarter turns, and else for what rounding can do to a fit, `256 u S`.
    pub tolerance: Option<f64>,
    /// Contacts at this translation or beyond, of the shrunk bodies, are of no interest: the least `shrunk_distance` so
    /// far, where one body is asked against many. As they are, bodies may meet long before they do shrunk.
    pub before: Option<f64>,
    /// Whether the bodies overlap where they are: what [`SolidCast::overlaps`] has said of the same
    /// bodies, poses and tolerance. Whoever asks one pair along many directions asks once. `None`:
    /// it is looked at, as is an overlap that is the answer, to be named.
    pub overlapping: Option<bool>,
    /// How near to each other the bodies may come (world units): see
    /// [`Cast::keeping`]. `0`, the default: until they touch.
    #[cfg_attr(
        feature = "serde",
        serde(default, skip_serializing_if = "colltrans_kernel::written::is_zero")
    )]
    pub keep: f64,
}

impl SolidOptions {
    /// With a meaning of an overlap at the start.
    #[must_use]
    pub const fn with_start_overlap(self, start_overlap: StartOverlap) -> Self {
        Self { start_overlap, ..self }
    }

    /// With a tolerance, a length, or the default one. It is checked where it is used.
    #[must_use]
    pub fn with_tolerance(self, tolerance: impl Into<Option<f64>>) -> Self {
        Self { tolerance: tolerance.into(), ..self }
    }

    /// With an end, or without.
    #[must_use]
    pub fn with_before(self, before: impl Into<Option<f64>>) -> Self {
        Self { before: before.into(), ..self }
    }

    /// With a gap to be kept, a length. It is checked where it is used.
    #[must_use]
    pub const fn with_keep(self, keep: f64) -> Self {
        Self { keep, ..self }
    }

    /// With what is known of an overlap at the start.
    #[must_use]
    pub fn with_overlapping(self, overlapping: impl Into<Option<bool>>) -> Self {
        Self { overlapping: overlapping.into(), ..self }
    }
}

/// The overlap of two solids.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct SolidOverlap {
    /// One of the places where the bodies, shrunk by half the tolerance each, overlap: facets that
    /// cross, or a shell that is inside.
    pub place: Overlap,
    /// The least tolerance with which they would not overlap, from above; `None` if there is none, as
    /// where what overlaps is an open shell: see [`SolidCast::least_tolerance`].
    #[cfg_attr(feature = "serde", serde(rename = "depth"))]
    pub least_tolerance: Option<f64>,
    /// Work done.
    pub steps: SolidSteps,
}

/// Nothing stops the moving body, or it never meets the other one.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct SolidFree {
    /// A plane between the bodies, parallel to the direction, where there is one that rounding can
    /// tell; not looked for where a query ends at [`SolidOptions::before`].
    pub separation: Option<Separation>,
    /// Work done.
    pub steps: SolidSteps,
}

/// Whether solids meet where they are.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct SolidMeeting {
    /// Two facets with a point in common, or a shell that is inside; `None` if the bodies do not meet.
    pub place: Option<Overlap>,
    /// Work done.
    pub steps: SolidSteps,
}

impl RangeEnd for SolidContact {
    fn bounded(&self) -> Bounded {
        self.translation
    }
}

/// Solids do not graze: shadows that overlap, by however little, make a contact. There is no such value.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum NoGrazing {}

impl RangeEnd for NoGrazing {
    fn bounded(&self) -> Bounded {
        match *self {}
    }
}

impl Body for Solid {
    type Options = SolidOptions;
    type Contact = SolidContact;
    type Grazing = NoGrazing;
    type Separated = SolidFree;
    type Free = SolidFree;
    type Overlap = SolidOverlap;
    type Evidence = SolidMeeting;
    type Near = SolidNear;
    type Gap = SolidGap;
    type Steps = SolidSteps;
}

impl Solid {
    /// This body in a pose, for a [`Cast`].
    pub fn at(&self, pose: Pose) -> Placed<'_, Self> {
        Placed { body: self, pose }
    }
}

impl CastBody for Solid {
    type CastProof<'p> = SolidProof<'p>;

    fn check_options(cast: &Cast<'_, Self>) -> Result<(), QueryError> {
        check_keep(cast.options.keep)?;
        let Some(tolerance) = cast.options.tolerance else { return Ok(()) };
        if !(tolerance.is_finite() && tolerance >= 0.0) {
            return Err(QueryError::Tolerance { tolerance });
        }
        check_left(cast, tolerance)
    }

    #[inline]
    fn keeping(options: SolidOptions, gap: f64) -> SolidOptions {
        options.with_keep(gap)
    }

    fn first_contact(cast: &Cast<'_, Self>) -> Result<Outcome<Self>, QueryError> {
        cast.first_contact_in(&mut Workspace::default())
    }

    fn contact_range(cast: &Cast<'_, Self>) -> Result<ContactRange<Self>, QueryError> {
        let workspace = &mut Workspace::default();
        let first = cast.first_contact_in(workspace)?;
        Ok(match (first, cast.reversed().first_contact_in(workspace)?) {
            (Outcome::Contact(mut first), Outcome::Contact(mut last)) => {
                if let Some(both) = common_end(first.translation, last.exit()) {
                    (first.translation.value, last.translation.value) = (both, -both);
                }
                ContactRange::Contact { first, last }
            }
            (Outcome::Separated(free), _) | (_, Outcome::Separated(free)) => {
                ContactRange::Separated(free)
            }
        })
    }

    fn clearance(cast: &Cast<'_, Self>) -> Result<Clearance<Self>, QueryError> {
        cast.clearance_in(&mut Workspace::default())
    }

    fn intersects(cast: &Cast<'_, Self>) -> Result<Intersection<Self>, QueryError> {
        let mut steps = SolidSteps::default();
        let place = overlap::touch(&cast.scene(0.0), &mut steps);
        let evidence = SolidMeeting { place, steps };
        Ok(Intersection { meets: place.is_some(), evidence })
    }

    fn verify_cast(cast: &Cast<'_, Self>, proof: SolidProof<'_>) -> Result<f64, CertificateError> {
        match proof {
            SolidProof::Clearance(certificate) => verify::verify_clearance(cast, certificate),
            SolidProof::Separation(separation) => separate::verify(&cast.asked(), separation),
        }
    }
}

/// Refuses a tolerance that leaves nothing of a body.
fn check_left(cast: &Cast<'_, Solid>, tolerance: f64) -> Result<(), QueryError> {
    for (which, solid) in [("moving", cast.moving()), ("fixed", cast.fixed())] {
        if solid.vanishes(tolerance / 2.0) {
            let extent = solid.thickness();
            return Err(QueryError::NothingLeft { which, tolerance, extent });
        }
    }
    Ok(())
}

/// The tolerance of bodies for which none was given, whose matrices permute axes, or not.
fn default_tolerance(permuted: bool, noise: f64) -> f64 {
    if permuted { 0.0 } else { NOISES * noise }
}
