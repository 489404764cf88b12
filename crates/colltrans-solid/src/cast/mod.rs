//! Casts of solids: how far a [`Solid`] can move before it blocks, with certificates.
//!
//! With a tolerance `L`, both bodies are offset inwards by `L / 2` before the query. If their interiors then have a
//! common point, or an open shell passes through the other body, the answer is an overlap. Of rounded bodies the cores
//! are offset, and the radii add to the minimum gap of the cores.
//!
//! - [`queries`] declares the queries as traits, `answer` implements them.
//! - [`boxes`] and [`hulls`] answer queries without a search.
//! - [`tolerance`] computes the least tolerance of an overlap.
//! - [`proof`] defines the certificates, [`verify`] verifies them, and `encoding` serialises them.

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
use colltrans_convex::cast::{Cast, CastBody, common_translation};
use colltrans_convex::setting::error::QueryError;
use colltrans_convex::setting::{check_length, check_min_gap};

/// Default tolerance of rotated bodies, in noises.
const DEFAULT_TOLERANCE_NOISES: f64 = 8.0;

/// Treatment of an overlap at the start.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
pub enum StartOverlap {
    /// The clearance is [`Clearance::Overlapping`].
    #[default]
    Refuse,
    /// Facets that cross at the start do not block, and contacts that begin later do. [`SolidCast::start_overlap`]
    /// returns the ignored overlap.
    Ignore,
}

colltrans_kernel::serialization::named!(
    "treatment of an overlap",
    StartOverlap { Refuse: "refuse", Ignore: "ignore" }
);

/// Options of a query between solids. More fields may be added, so start from the default options.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct SolidOptions {
    /// Treatment of an overlap at the start.
    pub start_overlap: StartOverlap,
    /// Tolerance, a length in world units. Both bodies are offset inwards by half of it. `None` is 0 if the rotations
    /// of both poses only permute axes and change signs, and eight noises (`256 u S`) otherwise, because rounding can
    /// change a fit by that length.
    pub tolerance: Option<f64>,
    /// End of the query, in multiples of the direction. Contacts of the offset bodies at this translation or beyond
    /// are ignored. For a body that is cast against many others, this is the smallest `offset_distance` found
    /// before. The nominal bodies may meet long before the offset ones.
    pub before: Option<f64>,
    /// Result of [`SolidCast::overlaps`] for the same bodies, poses and tolerance, if it is known. One test then
    /// serves many directions. With `None` the query tests for an overlap. It does so too for `Some(true)` with
    /// [`StartOverlap::Refuse`], because the answer contains the place.
    pub overlapping: Option<bool>,
    /// Minimum gap (world units), see [`Cast::with_min_gap`]. With `0`, the default, bodies block when they touch.
    #[cfg_attr(
        feature = "serde",
        serde(default, skip_serializing_if = "colltrans_kernel::serialization::is_zero")
    )]
    pub min_gap: f64,
}

impl SolidOptions {
    /// Returns the options with another treatment of an overlap at the start.
    #[must_use]
    pub const fn with_start_overlap(self, start_overlap: StartOverlap) -> Self {
        Self { start_overlap, ..self }
    }

    /// Returns the options with a tolerance in world units, or with the default one. [`Cast::with_options`] checks
    /// the value.
    #[must_use]
    pub fn with_tolerance(self, tolerance: impl Into<Option<f64>>) -> Self {
        Self { tolerance: tolerance.into(), ..self }
    }

    /// Returns the options with an end of the query in multiples of the direction, or without an end.
    /// [`Cast::with_options`] rejects a negative end and NaN.
    #[must_use]
    pub fn with_before(self, before: impl Into<Option<f64>>) -> Self {
        Self { before: before.into(), ..self }
    }

    /// Returns the options with a minimum gap in world units. [`Cast::with_options`] checks the value.
    #[must_use]
    pub const fn with_min_gap(self, min_gap: f64) -> Self {
        Self { min_gap, ..self }
    }

    /// Returns the options with a known result of [`SolidCast::overlaps`], or without one.
    #[must_use]
    pub fn with_overlapping(self, overlapping: impl Into<Option<bool>>) -> Self {
        Self { overlapping: overlapping.into(), ..self }
    }
}

/// Overlap of two solids at the start.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct SolidOverlap {
    /// One place of the overlap of the offset bodies: two facets, or a shell inside the other body. With a minimum gap,
    /// two facets that are nearer than the gap.
    pub place: Overlap,
    /// Upper bound of the least tolerance at which the bodies do not overlap. `None` if there is none, for example
    /// for an overlap with an open shell. See [`SolidCast::least_tolerance`].
    #[cfg_attr(feature = "serde", serde(rename = "depth"))]
    pub least_tolerance: Option<f64>,
    /// Work done.
    pub steps: SolidSteps,
}

/// Result of a query in which nothing blocks the moving body, or the bodies never meet.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct SolidFree {
    /// Separating plane parallel to the direction. `None` if no plane was found whose margin exceeds the minimum gap
    /// and the rounding errors, or if [`SolidOptions::before`] is set.
    pub separation: Option<Separation>,
    /// Work done.
    pub steps: SolidSteps,
}

/// Result of a test whether two solids have a common point. With a minimum gap, the test is whether their distance is
/// certainly at most the gap.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct SolidIntersection {
    /// Two facets with a common point, or not farther apart than the minimum gap, or a shell inside the other body.
    /// `None` if the test fails.
    pub place: Option<Overlap>,
    /// Work done.
    pub steps: SolidSteps,
}

impl RangeEnd for SolidContact {
    fn bounded_translation(&self) -> Bounded {
        self.translation
    }
}

/// Type without values. Solids do not graze: shadows that overlap make a contact, however small the overlap is.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum NoGrazing {}

impl RangeEnd for NoGrazing {
    fn bounded_translation(&self) -> Bounded {
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
    type Evidence = SolidIntersection;
    type Near = SolidNear;
    type Gap = SolidGap;
    type Steps = SolidSteps;
}

impl Solid {
    /// Places this body in a pose (body frame to world), for a [`Cast`].
    pub fn at(&self, pose: Pose) -> Placed<'_, Self> {
        Placed { body: self, pose }
    }
}

impl CastBody for Solid {
    type CastProof<'p> = SolidProof<'p>;

    fn check_options(cast: &Cast<'_, Self>) -> Result<(), QueryError> {
        check_min_gap(cast.options.min_gap)?;
        cast.options.before.map_or(Ok(()), check_length)?;
        let Some(tolerance) = cast.options.tolerance else { return Ok(()) };
        if !(tolerance.is_finite() && tolerance >= 0.0) {
            return Err(QueryError::Tolerance { tolerance });
        }
        check_thickness(cast, tolerance)
    }

    #[inline]
    fn with_min_gap(options: SolidOptions, gap: f64) -> SolidOptions {
        options.with_min_gap(gap)
    }

    fn first_contact(cast: &Cast<'_, Self>) -> Result<Outcome<Self>, QueryError> {
        cast.first_contact_in(&mut Workspace::default())
    }

    fn contact_range(cast: &Cast<'_, Self>) -> Result<ContactRange<Self>, QueryError> {
        let workspace = &mut Workspace::default();
        let first = cast.first_contact_in(workspace)?;
        Ok(match (first, cast.reversed().first_contact_in(workspace)?) {
            (Outcome::Contact(mut first), Outcome::Contact(mut last)) => {
                if let Some(both) = common_translation(first.translation, last.exit()) {
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
        let place = overlap::find_contact(&cast.scene_with_tolerance(0.0), &mut steps);
        let evidence = SolidIntersection { place, steps };
        Ok(Intersection { meets: place.is_some(), evidence })
    }

    fn verify_cast(cast: &Cast<'_, Self>, proof: SolidProof<'_>) -> Result<f64, CertificateError> {
        match proof {
            SolidProof::Clearance(certificate) => verify::verify_clearance(cast, certificate),
            SolidProof::Separation(separation) => {
                separate::verify_separation(&cast.query_scene(), separation)
            }
        }
    }
}

/// Returns the minimum gap of the cores of a cast, rounded up: that of the bodies plus their radii.
fn core_gap(cast: &Cast<'_, Solid>) -> f64 {
    cast.setting.core_gap_bounds(cast.options.min_gap)[1]
}

/// Checks that the offset of a tolerance leaves something of both bodies, by their boxes.
fn check_thickness(cast: &Cast<'_, Solid>, tolerance: f64) -> Result<(), QueryError> {
    for (which, solid) in [("moving", cast.moving()), ("fixed", cast.fixed())] {
        if solid.vanishes_under_offset(tolerance / 2.0) {
            let extent = solid.min_side();
            return Err(QueryError::NothingLeft { which, tolerance, extent });
        }
    }
    Ok(())
}

/// Returns the tolerance of casts without a given one. It is 0 if both matrices permute axes and change signs
/// (`permuted`), and eight times `noise` otherwise. For bodies from files, `colltrans_mesh::body::cast_between` raises
/// it to twice the sum of their precisions, if that is more.
fn default_tolerance(permuted: bool, noise: f64) -> f64 {
    if permuted { 0.0 } else { DEFAULT_TOLERANCE_NOISES * noise }
}
