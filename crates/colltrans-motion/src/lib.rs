//! Motions with rotation: the time at which two bodies first meet.
//!
//! A [`Motion`] defines the pose of a body at every time from 0 to 1: a translation, a rotation, a screw, a free
//! flight, or a sequence of poses. A [`MotionCast`] computes when two such bodies first meet, with proven bounds of the
//! time, or proves that they never meet.
//!
//! ```
//! use colltrans::glam::DVec3;
//! use colltrans::motion::{Motion, MotionCast, MotionOutcome};
//! use colltrans::{ConvexPolyhedron, Pose};
//!
//! // A door, 1 wide, swings by 90 degrees about the z axis; a post is in its way at 45 degrees.
//! let door = ConvexPolyhedron::cuboid(DVec3::new(0.0, -0.02, 0.0), DVec3::new(1.0, 0.02, 2.0))?;
//! let post = ConvexPolyhedron::cuboid(DVec3::splat(-0.05), DVec3::splat(0.05))?;
//! let swing = Motion::rotation_about(Pose::IDENTITY, DVec3::ZERO, DVec3::Z, std::f64::consts::FRAC_PI_2)?;
//! let post_pose = Pose::from_translation(DVec3::new(0.6, 0.6, 1.0))?;
//!
//! let cast = MotionCast::new(door.with_motion(&swing), post.at(post_pose))?;
//! let MotionOutcome::Contact(contact) = cast.first_contact()? else { panic!("no contact") };
//! assert!(0.4 < contact.lower && contact.lower <= contact.upper && contact.upper < 0.5);
//! assert!(contact.upper - contact.lower < 1e-11);
//! assert!(cast.verify(&contact.proof).is_ok());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Guarantee
//!
//! Answers hold for the motion *as the real function of its numbers*, not for computed poses. The bodies do not meet at
//! any time before `lower`, and they meet at `upper`. The error bound of computed poses is subtracted from every gap.
//! Contact is claimed only where the overlap exceeds this error.
//!
//! # Method
//!
//! - A *plane* at a time is a unit normal `n` with its gap `s = min_Q n.q - max_P n.p`.
//! - In a *span* both bodies rotate at a constant rate.
//! - `curvature` proves separation between the times of two planes, by a bound of the second derivative of the gap.
//! - `arc` proves an interval by one plane, on whose sides all vertices stay on their arcs.
//! - `search` chooses the times and joins the planes; `sample` computes the distance at one time.
//!
//! The search is conservative advancement (Mirtich) with a curvature bound in place of a velocity bound. Steps are
//! proportional to the square root of the remaining gap instead of the gap, because a rotation differs from a
//! translation only to second order. Near a contact the sampled times converge to it quadratically. See
//! `docs/theory/conservative-advancement.md` and `docs/theory/motion-bounds.md`.
//!
//! # Modules
//!
//! In the order of dependence: `proof`, `answer`, `span`, `curvature` and `arc`, `relative_motion`, `sample`, `search`,
//! `verify`, `clearance`. `crossing_time` searches for a proven contact after a search has ended.
//!
//! - `solid` is for solids. It searches both bounding volume trees and time, and treats two facets like two convex
//!   bodies.
//! - [`path`] is for bodies that joints carry. `mechanism` defines frames and rows of joint values. `chain` bounds how
//!   joints move a body, `link_pair` combines two chains. `follow` and `search` search over rows and bounding volume
//!   trees.

#![allow(
    rustdoc::private_intra_doc_links,
    reason = "hidden modules are read with their private parts"
)]

mod answer;
mod arc;
mod clearance;
mod crossing_time;
mod curvature;
pub mod path;
mod proof;
mod relative_motion;
mod sample;
mod search;
mod solid;
mod span;
mod verify;

use std::borrow::Cow;

use derive_where::derive_where;

pub use self::answer::{HasProof, MotionContact, MotionFree, MotionOutcome, MotionSteps};
pub use self::clearance::{MotionClearance, MotionOverlap, MotionStop};
pub use self::proof::{
    ContactProof, FacetContact, FacetContactProof, MotionCover, MotionProof, ProvenContact,
    SolidMotionProof, SpanProof, TimedPlane,
};
use self::sample::ConvexSampler;
use self::search::{SpanEnd, SpanResult, prove_span};
#[cfg(feature = "json")]
pub use self::solid::ProofFacets;
use self::span::{Span, split_into_spans};
pub use self::verify::MotionProofError;
pub use colltrans_convex::body::Moving;
use colltrans_convex::body::{ConvexPolyhedron, VertexHull};
use colltrans_convex::setting::check_min_gap;
use colltrans_convex::setting::error::{QueryError, Stalled};
pub use colltrans_kernel::error::MotionError;
pub use colltrans_kernel::motion::{Motion, Piece as MotionPiece};
use colltrans_kernel::noise::Noise;
use colltrans_kernel::pose::MAX_STRETCH;
use colltrans_kernel::range::MAX_MAGNITUDE;
use colltrans_solid::StartOverlap;
use colltrans_solid::body::Solid;

/// Factor from the error of two points (rounding and motion) to the default tolerance.
const DEFAULT_TOLERANCE_FACTOR: f64 = 32.0;

/// Two bodies of one kind, of which one or both move from time 0 to time 1: convex polyhedra or
/// [solids](colltrans_solid::Solid).
#[derive(Debug)]
#[derive_where(Clone)]
pub struct MotionCast<'a, B = ConvexPolyhedron> {
    moving: Moving<'a, B>,
    fixed: Moving<'a, B>,
    /// Minimum gap, in world units. For convex bodies a negative value is a tolerated depth.
    min_gap: f64,
    /// Tolerance of solids, which are shrunk by half of it. `None` selects the default.
    tolerance: Option<f64>,
    /// Meaning of an overlap of solids at time 0 for their clearance.
    start_overlap: StartOverlap,
}

impl<'a, B> MotionCast<'a, B> {
    /// Builds the cast of two bodies, both convex or both solids. Each of them has a
    /// [motion](ConvexPolyhedron::with_motion) or [rests at a pose](ConvexPolyhedron::at). For bodies of different
    /// kinds, see [`MotionCast::between_any`].
    ///
    /// # Errors
    /// Returns no error at present, because bodies and motions are checked when they are built.
    pub fn new(
        moving: impl Into<Moving<'a, B>>,
        fixed: impl Into<Moving<'a, B>>,
    ) -> Result<Self, QueryError> {
        let (moving, fixed) = (moving.into(), fixed.into());
        Ok(Self {
            moving,
            fixed,
            min_gap: 0.0,
            tolerance: None,
            start_overlap: StartOverlap::Refuse,
        })
    }

    /// Returns the minimum gap, in world units; 0 if none was set.
    pub fn min_gap(&self) -> f64 {
        self.min_gap.max(0.0)
    }

    /// Returns the motions of the moving and of the fixed body.
    pub fn motions(&self) -> [&Motion; 2] {
        [&self.moving.motion, &self.fixed.motion]
    }

    /// Returns the moving and the fixed body.
    pub fn bodies(&self) -> [&'a B; 2] {
        [self.moving.body, self.fixed.body]
    }
}

impl MotionCast<'_> {
    /// Returns the tolerated depth, in world units; 0 if none was set.
    pub fn tolerance(&self) -> f64 {
        (-self.min_gap).max(0.0)
    }

    /// Returns the cast with a minimum gap, in world units. The queries then find when the distance of the bodies falls
    /// to the gap. Replaces a tolerated depth.
    ///
    /// # Errors
    /// Returns [`QueryError::MinGap`] if the gap is negative, not finite or out of range.
    pub fn with_min_gap(self, gap: f64) -> Result<Self, QueryError> {
        check_min_gap(gap)?;
        Ok(Self { min_gap: gap, ..self })
    }

    /// Returns the cast with a tolerated depth, in world units. The bodies count as meeting if every translation that
    /// separates them is longer than this depth. Replaces a minimum gap.
    ///
    /// A part may then rest on a table and rotate on it or leave it. Without a tolerance, bodies in contact at time 0
    /// are *grazing*, because rounding errors hide whether they overlap.
    ///
    /// # Errors
    /// Returns [`QueryError::Tolerance`] if the depth is negative, not finite or out of range.
    pub fn with_tolerance(self, depth: f64) -> Result<Self, QueryError> {
        check_depth(depth)?;
        Ok(Self { min_gap: -depth, ..self })
    }

    /// Finds the first time at which the bodies meet.
    ///
    /// If the search between convex bodies takes its maximum number of steps, the same bodies are searched as solids.
    /// The answer is [`MotionOutcome::Undecided`] if the second search has no answer either, or if a depth is
    /// tolerated.
    ///
    /// # Errors
    /// Returns [`QueryError::PositionError`] if the bodies may meet and the error of computed places exceeds their
    /// size.
    pub fn first_contact(&self) -> Result<MotionOutcome, QueryError> {
        let found = self.first_contact_of_convex()?;
        let MotionOutcome::Undecided(undecided) = &found else { return Ok(found) };
        Ok(self.outcome_of_solids(undecided).unwrap_or(found))
    }

    /// Returns the cast of the same bodies as solids, without a tolerance. The minimum gap is increased by the distance
    /// of input points from the faces of the bodies.
    ///
    /// # Errors
    /// Returns [`QueryError::MinGap`] if a depth is tolerated, and the errors of [`MotionCast::between_any`].
    #[doc(hidden)]
    pub fn as_solid_cast(&self) -> Result<MotionCast<'_, Solid>, QueryError> {
        // Input points may increase the gap above 0, but a check rejects all such proofs with a tolerated depth.
        check_min_gap(self.min_gap)?;
        let moving = Moving { body: self.moving.body, motion: Cow::Borrowed(&*self.moving.motion) };
        let fixed = Moving { body: self.fixed.body, motion: Cow::Borrowed(&*self.fixed.motion) };
        MotionCast::between_any(moving, fixed)?
            .with_tolerance(0.0)?
            .with_min_gap(self.min_gap + self.input_excess())
    }

    /// Returns how far the input points of both bodies may be outside their faces, in world units; 0 if none is
    /// outside.
    fn input_excess(&self) -> f64 {
        let beyond = |body: &ConvexPolyhedron| body.hull_error() + body.input_excess();
        (beyond(self.moving.body) + beyond(self.fixed.body)) * MAX_STRETCH
    }

    /// Returns the upper bound of the contact time for a contact of the solids at `time`. It is infinite if input
    /// points may be outside the faces, because the solids then have a minimum gap and may not touch.
    fn upper_bound_from_solids(&self, time: f64) -> f64 {
        if self.input_excess() == 0.0 { time } else { f64::INFINITY }
    }

    /// Returns the answer of the search between solids. Returns `None` if it proves no more than `undecided`.
    fn outcome_of_solids(&self, undecided: &MotionContact) -> Option<MotionOutcome> {
        let outcome = self.as_solid_cast().ok()?.certified_first_contact().ok()?;
        let mut steps = undecided.steps;
        steps += outcome.steps();
        let solids = Some(Box::new(outcome.proof().clone()));
        let proof = MotionProof { solids, ..MotionProof::default() };
        let build_touching_contact = |bounds: [f64; 2], proof| {
            let all = split_into_spans(self.bodies(), self.motions(), self.min_gap);
            let span = all.iter().rev().find(|span| span.from <= bounds[0])?;
            Some(build_contact(span, &mut ConvexSampler::default(), bounds, proof, steps))
        };
        match &outcome {
            MotionOutcome::Free(_) => Some(MotionOutcome::Free(MotionFree { proof, steps })),
            MotionOutcome::Contact(of) if self.input_excess() == 0.0 => {
                build_touching_contact([of.lower, of.upper], proof).map(MotionOutcome::Contact)
            }
            MotionOutcome::Contact(of) | MotionOutcome::Grazing(of) => {
                let upper = self.upper_bound_from_solids(of.upper);
                build_touching_contact([of.lower, upper], proof).map(MotionOutcome::Grazing)
            }
            MotionOutcome::Undecided(of) if of.lower > undecided.lower => {
                let upper = self.upper_bound_from_solids(of.upper);
                build_touching_contact([of.lower, upper], proof).map(MotionOutcome::Undecided)
            }
            MotionOutcome::Undecided(_) | MotionOutcome::Overlapping(_) => None,
        }
    }

    /// Searches all spans of the motion for the first contact of the convex bodies.
    fn first_contact_of_convex(&self) -> Result<MotionOutcome, QueryError> {
        use MotionOutcome::{Contact, Free, Grazing, Overlapping, Undecided};
        let (mut proof, mut steps) = (MotionProof::default(), MotionSteps::default());
        for span in split_into_spans(self.bodies(), self.motions(), self.min_gap) {
            let mut sampler = ConvexSampler::default();
            let SpanResult { planes, end } = prove_span(&span, &mut sampler);
            steps += sampler.steps;
            proof.spans.push(planes);
            match end {
                SpanEnd::Free => {}
                SpanEnd::Met(time, met) => {
                    let bounds = [proof.reached(), time];
                    proof.meeting = Some(ProvenContact { time, met });
                    let contact = build_contact(&span, &mut sampler, bounds, proof, steps);
                    let of = if time == 0.0 { Overlapping } else { Contact };
                    return Ok(of(contact));
                }
                SpanEnd::Indeterminate | SpanEnd::Stalled => {
                    if end == SpanEnd::Indeterminate {
                        check_accuracy(self.bodies(), span.error)?;
                    }
                    let bounds = [proof.reached(), f64::INFINITY];
                    let contact = build_contact(&span, &mut sampler, bounds, proof, steps);
                    let of = if end == SpanEnd::Indeterminate { Grazing } else { Undecided };
                    return Ok(of(contact));
                }
            }
        }
        Ok(Free(MotionFree { proof, steps }))
    }

    /// Checks a proof without a search, over all vertices. Returns the time up to which the bodies are proven not to
    /// meet, and the time at which they are proven to meet. The latter is infinite if the proof claims no contact.
    ///
    /// # Errors
    /// Returns the first entry of the proof that does not hold.
    pub fn verify(&self, proof: &MotionProof) -> Result<[f64; 2], MotionProofError> {
        verify::verify(self, proof)
    }
}

/// Checks that a depth is in the accepted range.
fn check_depth(depth: f64) -> Result<(), QueryError> {
    let is_one = (0.0..=MAX_MAGNITUDE).contains(&depth);
    if is_one { Ok(()) } else { Err(QueryError::Tolerance { tolerance: depth }) }
}

/// Checks that the bodies are larger than the error `off` of computed places. Two points always pass, because no body
/// is smaller.
fn check_accuracy<B: VertexHull>(bodies: [&B; 2], off: f64) -> Result<(), QueryError> {
    let size = bodies.iter().map(|body| body.reach() + body.radius()).sum();
    if size > 0.0 && off > size { Err(QueryError::PositionError { off, size }) } else { Ok(()) }
}

/// Builds the report of a contact, or of a possible contact, between two times of a span.
fn build_contact(
    span: &Span,
    sampler: &mut ConvexSampler,
    [lower, upper]: [f64; 2],
    proof: MotionProof,
    steps: MotionSteps,
) -> MotionContact {
    let bodies = span.instant_at(lower).bodies;
    let poses = [bodies.moving_placed().pose, bodies.fixed_placed().pose];
    // The bounds do not depend on this distance.
    let near = sampler.distance(bodies);
    let points = near.map(|near| [near.on_moving, near.on_fixed]);
    let (normal, features) = near.map_or((None, None), |near| (near.normal, near.features));
    MotionContact { lower, upper, poses, points, normal, features, proof, steps }
}

/// Returns the error for a search that took its maximum number of steps, in a query whose answer cannot express it.
fn step_limit_error(undecided: &MotionContact<impl Sized>) -> QueryError {
    QueryError::NotConverged { reason: Stalled::Motion { free_until: undecided.lower } }
}

/// Computes the default tolerance of bodies along their motions, in world units: a multiple of the error of computed
/// points.
fn default_tolerance<B: VertexHull>(bodies: [&B; 2], motions: [&Motion; 2]) -> f64 {
    let off = split_into_spans(bodies, motions, 0.0).into_iter().map(|span| {
        let ends = [span.from, span.to].map(|time| span.instant_at(time).bodies.size());
        let radii = bodies[0].radius() + bodies[1].radius();
        Noise::for_size(ends[0].max(ends[1]) + radii).point_error() + span.error
    });
    DEFAULT_TOLERANCE_FACTOR * off.fold(0.0, f64::max)
}
