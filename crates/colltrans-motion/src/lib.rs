//! Motions that turn: when do two bodies first touch?
//!
//! A [`Motion`] says where a body is at every time from 0 to 1: it slides, turns, unscrews, is thrown, or
//! goes through poses. A [`MotionCast`] answers when two such bodies first meet, with bounds on that time
//! that are bounds, or proves that they never do.
//!
//! ```
//! use colltrans::glam::DVec3;
//! use colltrans::motion::{Motion, MotionCast, MotionOutcome};
//! use colltrans::{ConvexPolyhedron, Pose};
//!
//! // A door, 1 wide, swings by 90 degrees about the z axis; a post stands in its way at 45 degrees.
//! let door = ConvexPolyhedron::cuboid(DVec3::new(0.0, -0.02, 0.0), DVec3::new(1.0, 0.02, 2.0))?;
//! let post = ConvexPolyhedron::cuboid(DVec3::splat(-0.05), DVec3::splat(0.05))?;
//! let swing = Motion::turn(Pose::IDENTITY, DVec3::ZERO, DVec3::Z, std::f64::consts::FRAC_PI_2)?;
//! let there = Pose::from_translation(DVec3::new(0.6, 0.6, 1.0))?;
//!
//! let cast = MotionCast::new(door.along(&swing), post.at(there))?;
//! let MotionOutcome::Contact(contact) = cast.first_contact()? else { panic!("no contact") };
//! assert!(0.4 < contact.lower && contact.lower <= contact.upper && contact.upper < 0.5);
//! assert!(contact.upper - contact.lower < 1e-11);
//! assert!(cast.verify(&contact.proof).is_ok());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # What is promised
//!
//! Answers hold of the motion *as the real function of its numbers*, not of poses computed from it: at each
//! time before `lower` the bodies do not meet, and at the time `upper` they do. What a computed pose may be
//! off is taken off every gap, and that bodies meet is claimed where they overlap by more than that.
//!
//! # Method
//!
//! Notation. A *plane* at a time is a unit normal `n` with the gap `s = min_Q n.q - max_P n.p` that it leaves
//! then. In a *span* both bodies spin evenly. The search proves a span
//!
//! - *between two planes* by how far supporting planes may bend in between (`bend`): two gaps bound all times
//!   in between, whatever the normals;
//! - *by one plane* over vertices that stay below it on their arcs (`arc`).
//!
//! `search` proposes times, by Newton's method at the end, and `look` asks the distance at one. This is
//! conservative advancement (Mirtich) with a bound of second order: a rotation is a translation to first
//! order only, so that steps shrink with the square root of what is left, not with what is left.
//!
//! The modules, each using only those before it: `proof`, `answer`, `span`, `bend` and `arc`, `course`,
//! `look`, `search`, `verify`, `clearance`.
//!
//! `solid` is of solids: down both trees and through time, two facets as convex bodies are. [`path`] is bodies that joints
//! carry: `mechanism` has frames and rows of values, `chain` bounds how joints move a body, `couple` is two of them, `follow`
//! and `search` search over rows and down trees of boxes.

#![allow(
    rustdoc::private_intra_doc_links,
    reason = "hidden modules are read with their private parts"
)]

mod answer;
mod arc;
mod bend;
mod clearance;
mod course;
mod look;
pub mod path;
mod proof;
mod search;
mod solid;
mod soon;
mod span;
mod verify;

use std::borrow::Cow;

use derive_where::derive_where;

pub use self::answer::{MotionContact, MotionFree, MotionOutcome, MotionSteps, Proven};
pub use self::clearance::{MotionClearance, MotionOverlap, MotionStop};
use self::look::ConvexLooker;
pub use self::proof::{Meeting, Met, MotionProof, PlaneAt};
use self::search::{Advanced, End, advance};
#[cfg(feature = "json")]
pub use self::solid::Parts;
pub use self::solid::{FacetsMeeting, FacetsMet, MotionCover, SolidMotionProof, SpanProof};
use self::span::{Span, spans};
pub use self::verify::MotionProofError;
pub use colltrans_convex::body::Moving;
use colltrans_convex::body::{ConvexPolyhedron, Hull};
use colltrans_convex::setting::check_min_gap;
use colltrans_convex::setting::error::{QueryError, Stalled};
pub use colltrans_kernel::error::MotionError;
pub use colltrans_kernel::motion::{Motion, Piece as MotionPiece};
use colltrans_kernel::noise::Noise;
use colltrans_kernel::pose::MAX_STRETCH;
use colltrans_kernel::range::MAX_MAGNITUDE;
use colltrans_solid::StartOverlap;
use colltrans_solid::body::Solid;

/// The default tolerance, in multiples of what two points may be off each other: noise, and motion.
const TOLERANCE: f64 = 32.0;

/// Two bodies, either of which may move, from time 0 to 1: convex ones, or [solids](colltrans_solid::Solid).
#[derive(Debug)]
#[derive_where(Clone)]
pub struct MotionCast<'a, B = ConvexPolyhedron> {
    moving: Moving<'a, B>,
    fixed: Moving<'a, B>,
    /// A gap to be kept; negative, of convex bodies, a depth that is tolerated.
    keep: f64,
    /// By half of which solids are shrunk; none stands for what rounding can do.
    tolerance: Option<f64>,
    /// Of solids, what an overlap at time 0 means for their clearance.
    start_overlap: StartOverlap,
}

impl<'a, B> MotionCast<'a, B> {
    /// Of two bodies [along](ConvexPolyhedron::along) a motion or [at](ConvexPolyhedron::at) a pose, both convex or
    /// both solids. One of each kind: [`Self::between`](MotionCast::between).
    ///
    /// # Errors
    /// None today: what a body and a motion admit, a cast does.
    pub fn new(
        moving: impl Into<Moving<'a, B>>,
        fixed: impl Into<Moving<'a, B>>,
    ) -> Result<Self, QueryError> {
        let (moving, fixed) = (moving.into(), fixed.into());
        Ok(Self { moving, fixed, keep: 0.0, tolerance: None, start_overlap: StartOverlap::Refuse })
    }

    /// The gap that is kept; 0 if there is none.
    pub fn keep(&self) -> f64 {
        self.keep.max(0.0)
    }

    /// What the moving and the fixed body do.
    pub fn motions(&self) -> [&Motion; 2] {
        [&self.moving.motion, &self.fixed.motion]
    }

    /// The moving and the fixed body.
    pub fn bodies(&self) -> [&'a B; 2] {
        [self.moving.body, self.fixed.body]
    }
}

impl MotionCast<'_> {
    /// The depth that is tolerated; 0 if none is.
    pub fn tolerance(&self) -> f64 {
        (-self.keep).max(0.0)
    }

    /// The same with a gap to be kept, in world units: what counts is when the bodies are no farther apart.
    /// In the place of a depth that is tolerated.
    ///
    /// # Errors
    /// A gap that is negative, not finite or out of range.
    pub fn keeping(self, gap: f64) -> Result<Self, QueryError> {
        check_min_gap(gap)?;
        Ok(Self { keep: gap, ..self })
    }

    /// The same with a depth that is tolerated, in world units: bodies count as meeting where every
    /// translation that parts them is longer. So a part may rest on a table and turn there, or leave it; with
    /// no tolerance, what touches at time 0 is *grazing* then, as rounding cannot tell it from an overlap.
    ///
    /// # Errors
    /// A depth that is negative, not finite or out of range.
    pub fn tolerating(self, depth: f64) -> Result<Self, QueryError> {
        check_tolerated(depth)?;
        Ok(Self { keep: -depth, ..self })
    }

    /// When do the bodies first meet?
    ///
    /// If the search between convex bodies takes its maximum number of steps, the question is asked of the same bodies as
    /// solids. If that search has no answer either, or a depth is tolerated, the answer is [`MotionOutcome::Undecided`].
    ///
    /// # Errors
    /// Where the bodies may meet in a motion whose places are off by more than they are large.
    pub fn first_contact(&self) -> Result<MotionOutcome, QueryError> {
        let found = self.first_contact_of_convex()?;
        let MotionOutcome::Undecided(undecided) = &found else { return Ok(found) };
        Ok(self.as_solids(undecided).unwrap_or(found))
    }

    /// The question about the same bodies as solids, as they are. A gap is added by which the points that a body was
    /// made of may be beyond its faces.
    #[doc(hidden)]
    pub fn between_solids(&self) -> Result<MotionCast<'_, Solid>, QueryError> {
        let moving = Moving { body: self.moving.body, motion: Cow::Borrowed(&*self.moving.motion) };
        let fixed = Moving { body: self.fixed.body, motion: Cow::Borrowed(&*self.fixed.motion) };
        MotionCast::between(moving, fixed)?.tolerating(0.0)?.keeping(self.keep + self.left_out())
    }

    /// Returns how far the points that both bodies were made of may be beyond their faces; 0 if they are not.
    fn left_out(&self) -> f64 {
        let beyond = |body: &ConvexPolyhedron| body.hull_error() + body.input_excess();
        (beyond(self.moving.body) + beyond(self.fixed.body)) * MAX_STRETCH
    }

    /// Returns when the bodies certainly meet, if they do as solids from this time on: never for certain, if what the
    /// solids come as near as need not be a contact.
    fn meeting_of_solids(&self, time: f64) -> f64 {
        if self.left_out() == 0.0 { time } else { f64::INFINITY }
    }

    /// Returns the answer of the search between solids; `None` if it proves no more than what is undecided.
    fn as_solids(&self, undecided: &MotionContact) -> Option<MotionOutcome> {
        let outcome = self.between_solids().ok()?.certified_first_contact().ok()?;
        let mut steps = undecided.steps;
        steps += outcome.steps();
        let solids = Some(Box::new(outcome.proof().clone()));
        let proof = MotionProof { solids, ..MotionProof::default() };
        let touching = |bounds: [f64; 2], proof| {
            let all = spans(self.bodies(), self.motions(), self.keep);
            let span = all.iter().rev().find(|span| span.from <= bounds[0])?;
            Some(contact(span, &mut ConvexLooker::default(), bounds, proof, steps))
        };
        match &outcome {
            MotionOutcome::Free(_) => Some(MotionOutcome::Free(MotionFree { proof, steps })),
            MotionOutcome::Contact(of) if self.left_out() == 0.0 => {
                touching([of.lower, of.upper], proof).map(MotionOutcome::Contact)
            }
            MotionOutcome::Contact(of) | MotionOutcome::Grazing(of) => {
                let upper = self.meeting_of_solids(of.upper);
                touching([of.lower, upper], proof).map(MotionOutcome::Grazing)
            }
            MotionOutcome::Undecided(of) if of.lower > undecided.lower => {
                let upper = self.meeting_of_solids(of.upper);
                touching([of.lower, upper], proof).map(MotionOutcome::Undecided)
            }
            MotionOutcome::Undecided(_) | MotionOutcome::Overlapping(_) => None,
        }
    }

    fn first_contact_of_convex(&self) -> Result<MotionOutcome, QueryError> {
        use MotionOutcome::{Contact, Free, Grazing, Overlapping, Undecided};
        let (mut proof, mut steps) = (MotionProof::default(), MotionSteps::default());
        for span in spans(self.bodies(), self.motions(), self.keep) {
            let mut looker = ConvexLooker::default();
            let Advanced { planes, end } = advance(&span, &mut looker);
            steps += looker.steps;
            proof.spans.push(planes);
            match end {
                End::Free => {}
                End::Met(time, met) => {
                    let bounds = [proof.reached(), time];
                    proof.meeting = Some(Meeting { time, met });
                    let contact = contact(&span, &mut looker, bounds, proof, steps);
                    let of = if time == 0.0 { Overlapping } else { Contact };
                    return Ok(of(contact));
                }
                End::Blurred | End::Stalled => {
                    if end == End::Blurred {
                        check_fine(self.bodies(), span.error)?;
                    }
                    let bounds = [proof.reached(), f64::INFINITY];
                    let contact = contact(&span, &mut looker, bounds, proof, steps);
                    let of = if end == End::Blurred { Grazing } else { Undecided };
                    return Ok(of(contact));
                }
            }
        }
        Ok(Free(MotionFree { proof, steps }))
    }

    /// Checks a proof without a search: all vertices are looked at. Returns up to which time the bodies are
    /// proven not to meet, and when they are proven to, infinity if that is not claimed.
    ///
    /// # Errors
    /// What is not proven.
    pub fn verify(&self, proof: &MotionProof) -> Result<[f64; 2], MotionProofError> {
        verify::verify(self, proof)
    }
}

/// Whether a depth may be tolerated.
fn check_tolerated(depth: f64) -> Result<(), QueryError> {
    let is_one = (0.0..=MAX_MAGNITUDE).contains(&depth);
    if is_one { Ok(()) } else { Err(QueryError::Tolerance { tolerance: depth }) }
}

/// Whether places that may be off by so much say anything of bodies. Of two points they do, as nothing is smaller.
fn check_fine<B: Hull>(bodies: [&B; 2], off: f64) -> Result<(), QueryError> {
    let size = bodies[0].reach() + bodies[1].reach();
    if size > 0.0 && off > size { Err(QueryError::Coarse { off, size }) } else { Ok(()) }
}

/// Returns what is reported where the bodies meet, or may, between two times of a span.
fn contact(
    span: &Span,
    looker: &mut ConvexLooker,
    [lower, upper]: [f64; 2],
    proof: MotionProof,
    steps: MotionSteps,
) -> MotionContact {
    let bodies = span.instant(lower).bodies;
    let poses = [bodies.moving_placed().pose, bodies.fixed_placed().pose];
    // What is proven does not hang on it.
    let near = looker.distance(bodies);
    let points = near.map(|near| [near.on_moving, near.on_fixed]);
    let (normal, features) = near.map_or((None, None), |near| (near.normal, near.features));
    MotionContact { lower, upper, poses, points, normal, features, proof, steps }
}

/// Returns the error of a search that took its maximum number of steps, where an answer cannot carry that.
fn stalled(undecided: &MotionContact<impl Sized>) -> QueryError {
    QueryError::NotConverged { reason: Stalled::Motion { free_until: undecided.lower } }
}

/// What rounding can do to a fit, of bodies as they are.
fn usual_tolerance<B: Hull>(bodies: [&B; 2], motions: [&Motion; 2]) -> f64 {
    let off = spans(bodies, motions, 0.0).into_iter().map(|span| {
        let ends = [span.from, span.to].map(|time| span.instant(time).bodies.scale());
        Noise::of(ends[0].max(ends[1])).point() + span.error
    });
    TOLERANCE * off.fold(0.0, f64::max)
}
