//! Checks proofs about motions without a search, over all vertices.
//!
//! - Planes are in the order of time, from the start of their span on.
//! - The claimed gap of each plane is at most the computed one minus the error of computed poses. Each plane is joined
//!   to the next one.
//! - A contact is checked at its time, with the same margin for errors.

use super::MotionCast;
use super::curvature::VertexScan;
use super::proof::{ContactProof, MotionProof, ProvenContact, TimedPlane};
use super::relative_motion::{InstantOf, RelativeMotion};
use super::sample::min_proving_depth;
use super::span::split_into_spans;
use colltrans_convex::answer::CertificateError;
use colltrans_convex::body::ConvexPolyhedron;
use colltrans_convex::pair::Pair;
use colltrans_kernel::noise;
use thiserror::Error;

/// The entry of a proof about a motion that does not hold.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum MotionProofError {
    /// A plane or its time is invalid.
    #[error(
        "plane {index} of span {span} is invalid: the first plane must be at the start of the span, \
         times must not decrease, normals must have length 1, and a span must start where the \
         previous one ended"
    )]
    Plane {
        /// Index of the span.
        span: usize,
        /// Index of the plane in the span.
        index: usize,
    },
    /// A plane has a smaller gap than claimed.
    #[error("plane {index} of span {span} proves a gap of {proven}, not {claimed}")]
    Gap {
        /// Index of the span.
        span: usize,
        /// Index of the plane in the span.
        index: usize,
        /// Proven gap, in world units.
        proven: f64,
        /// Claimed gap, in world units.
        claimed: f64,
    },
    /// A plane is not joined to the next one: the bodies may meet between them.
    #[error("planes {index} and {} of span {span} do not prove the time between them", .index + 1)]
    Join {
        /// Index of the span.
        span: usize,
        /// Index of the first of both planes.
        index: usize,
    },
    /// The proof has a different tolerance than the query.
    #[error(
        "the proof has the tolerance {claimed}, the query {requested}; verify it with the tolerance of \
         the proof"
    )]
    Tolerance {
        /// Tolerance of the proof.
        claimed: f64,
        /// Tolerance of the query.
        requested: f64,
    },
    /// The proof does not show whether the solids overlap at the start of the motion. Also returned if a proof about
    /// solids has further entries that its kind of answer does not have, or if the query cannot have such a proof, for
    /// example because it tolerates a depth.
    #[error("the proof does not show whether the solids overlap at the start of the motion")]
    Start,
    /// An entry of a cover does not hold.
    #[error("entry {entry} of the cover of span {span} does not hold or does not fit the bodies")]
    Cover {
        /// Index of the span.
        span: usize,
        /// Index of the entry.
        entry: usize,
    },
    /// A contact is not proven.
    #[error("contact at time {time} is not proven{}", reason_suffix(.reason.as_ref()))]
    Meeting {
        /// Claimed time of the contact.
        time: f64,
        /// Reason why the proof of the contact fails; `None` if the proof holds but does not suffice.
        reason: Option<CertificateError>,
    },
}

/// Formats the reason of an error, with a leading colon.
fn reason_suffix(reason: Option<&CertificateError>) -> String {
    reason.map(|reason| format!(": {reason}")).unwrap_or_default()
}

/// Checks a proof of a cast of convex bodies. Returns the time up to which they do not meet, and the time at which they
/// do, or infinity.
pub(super) fn verify(cast: &MotionCast, proof: &MotionProof) -> Result<[f64; 2], MotionProofError> {
    if let Some(solids) = &proof.solids {
        let plain = proof.spans.is_empty() && proof.meeting.is_none();
        let solid_cast = cast.as_solid_cast().ok().filter(|_| plain);
        let [reached, meeting] = solid_cast.ok_or(MotionProofError::Start)?.verify(solids)?;
        return Ok([reached, cast.upper_bound_from_solids(meeting)]);
    }
    let mut reached = 0.0;
    let mut last = None;
    let spans = split_into_spans(cast.bodies(), cast.motions(), cast.min_gap);
    let count = spans.len();
    for (which, span) in spans.into_iter().enumerate() {
        let Some(planes) = proof.spans.get(which) else { break };
        let begins = planes.first().is_none_or(|first| first.time == span.from);
        let follows = which == 0 || reached == span.from;
        if !begins || !follows {
            return Err(MotionProofError::Plane { span: which, index: 0 });
        }
        check_planes(&span, planes).map_err(|broken| broken.in_span(which))?;
        reached = planes.last().map_or(reached, |plane| plane.time);
        last = Some(span);
    }
    if proof.spans.len() > count {
        return Err(MotionProofError::Plane { span: count, index: 0 });
    }
    let Some(ProvenContact { time, met }) = &proof.meeting else {
        return Ok([reached, f64::INFINITY]);
    };
    let span = last.filter(|span| (span.from..=span.to).contains(time) && *time >= reached);
    let span = span.ok_or(MotionProofError::Meeting { time: *time, reason: None })?;
    check_contact(&span, *time, met)?;
    Ok([reached, *time])
}

/// The entry of a list of planes that does not hold.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum PlaneListError {
    Plane { index: usize },
    Gap { index: usize, proven: f64, claimed: f64 },
    Join { index: usize },
}

impl PlaneListError {
    fn in_span(self, span: usize) -> MotionProofError {
        match self {
            Self::Plane { index } => MotionProofError::Plane { span, index },
            Self::Gap { index, proven, claimed } => {
                MotionProofError::Gap { span, index, proven, claimed }
            }
            Self::Join { index } => MotionProofError::Join { span, index },
        }
    }
}

/// Checks that each plane of a list has its gap and is joined to the next one.
pub(super) fn check_planes<'a, C: RelativeMotion<'a>>(
    motion: &C,
    planes: &[TimedPlane],
) -> Result<(), PlaneListError> {
    let to = motion.time_range()[1];
    let mut before: Option<(&TimedPlane, InstantOf<C>)> = None;
    for (index, plane) in planes.iter().enumerate() {
        let TimedPlane { time, normal, gap, .. } = *plane;
        let is_unit = (normal.length() - 1.0).abs() <= noise::UNIT_VECTOR;
        let is_later = before.is_none_or(|(last, _)| last.time <= time) && time <= to;
        if !is_unit || !is_later {
            return Err(PlaneListError::Plane { index });
        }
        let at = motion.instant_at(time);
        let proven = motion.proven_gap(&at, normal);
        if !(gap > 0.0 && gap <= proven) {
            return Err(PlaneListError::Gap { index, proven, claimed: gap });
        }
        if let Some((last, from)) = &before
            && !motion.proves_between([last, plane], [from, &at], &VertexScan)
        {
            return Err(PlaneListError::Join { index: index - 1 });
        }
        before = Some((plane, at));
    }
    Ok(())
}

/// Checks that the bodies meet at a time.
fn check_contact<'a, C: RelativeMotion<'a, Body = ConvexPolyhedron>>(
    motion: &C,
    time: f64,
    met: &ContactProof,
) -> Result<(), MotionProofError> {
    let fails = |reason| MotionProofError::Meeting { time, reason };
    let proves_contact = proves_contact(motion, time, met).map_err(|reason| fails(Some(reason)))?;
    if proves_contact { Ok(()) } else { Err(fails(None)) }
}

/// Checks whether the bodies are proven to meet at a time.
pub(super) fn proves_contact<'a, C: RelativeMotion<'a, Body = ConvexPolyhedron>>(
    motion: &C,
    time: f64,
    met: &ContactProof,
) -> Result<bool, CertificateError> {
    let pair = Pair { bodies: motion.instant_at(time).bodies };
    let [min_gap, error] = [motion.min_gap(), motion.position_error()];
    Ok(match met {
        ContactProof::Deep(depth) => {
            pair.verify(&**depth)?;
            depth.lower > min_proving_depth(min_gap, error)
        }
        ContactProof::Near(near) => {
            pair.verify(near)?;
            near.distance + error <= min_gap
        }
    })
}
