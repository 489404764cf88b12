//! Checks of proofs about motions: nothing of the search is used, all vertices are looked at.
//!
//! What is checked: planes stand in the order of their times, from the beginning of their span on; each has
//! its gap then, less what computed poses may be off; each is joined to the next. That bodies meet is checked
//! where they are then, and has to hold with as much to spare.

use super::MotionCast;
use super::bend::Looking;
use super::course::{At, Course};
use super::look::deep_enough;
use super::proof::{Meeting, Met, MotionProof, PlaneAt};
use super::span::spans;
use colltrans_convex::answer::CertificateError;
use colltrans_convex::body::ConvexPolyhedron;
use colltrans_convex::pair::Pair;
use colltrans_kernel::noise;
use thiserror::Error;

/// What of a proof about a motion is not proven.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum MotionProofError {
    /// A plane is not at a time, or not a plane.
    #[error(
        "plane {index} of span {span} is not in order: planes begin where the span does, times do not \
         go back, normals have length 1, and a span begins where the one before it ended"
    )]
    Plane {
        /// Of which span.
        span: usize,
        /// Which one.
        index: usize,
    },
    /// A plane has not the gap that is claimed.
    #[error("plane {index} of span {span} proves a gap of {proven}, not {claimed}")]
    Gap {
        /// Of which span.
        span: usize,
        /// Which one.
        index: usize,
        /// What is proven.
        proven: f64,
        /// What is claimed.
        claimed: f64,
    },
    /// A plane is not joined to the next one: in between the bodies may meet.
    #[error("planes {index} and {} of span {span} do not prove the time in between", .index + 1)]
    Join {
        /// Of which span.
        span: usize,
        /// The first of them.
        index: usize,
    },
    /// Another tolerance than that which is asked about.
    #[error("the proof is of a tolerance of {claimed}, not {asked}")]
    Tolerance {
        /// What is claimed.
        claimed: f64,
        /// What is asked about.
        asked: f64,
    },
    /// What solids do when the motion begins is not proven.
    #[error("whether the solids overlap when the motion begins is not proven")]
    Start,
    /// Not all pairs of facets are parted at all times.
    #[error("entry {entry} of the cover of span {span} does not hold, or does not fit the bodies")]
    Cover {
        /// Of which span.
        span: usize,
        /// Which one.
        entry: usize,
    },
    /// That the bodies meet is not proven.
    #[error("that the bodies meet at {time} is not proven{}", because(.reason.as_ref()))]
    Meeting {
        /// When they are to.
        time: f64,
        /// Why not; nothing if they do too little.
        reason: Option<CertificateError>,
    },
}

fn because(reason: Option<&CertificateError>) -> String {
    reason.map(|reason| format!(": {reason}")).unwrap_or_default()
}

pub(super) fn verify(cast: &MotionCast, proof: &MotionProof) -> Result<[f64; 2], MotionProofError> {
    if let Some(solids) = &proof.solids {
        let plain = proof.spans.is_empty() && proof.meeting.is_none();
        let asked = cast.between_solids().ok().filter(|_| plain && cast.keep >= 0.0);
        let [reached, meeting] = asked.ok_or(MotionProofError::Start)?.verify(solids)?;
        return Ok([reached, cast.meeting_of_solids(meeting)]);
    }
    let mut reached = 0.0;
    let mut last = None;
    let spans = spans(cast.bodies(), cast.motions(), cast.keep);
    let count = spans.len();
    for (which, span) in spans.into_iter().enumerate() {
        let Some(planes) = proof.spans.get(which) else { break };
        let begins = planes.first().is_none_or(|first| first.time == span.from);
        let follows = which == 0 || reached == span.from;
        if !begins || !follows {
            return Err(MotionProofError::Plane { span: which, index: 0 });
        }
        chain(&span, planes).map_err(|broken| broken.of(which))?;
        reached = planes.last().map_or(reached, |plane| plane.time);
        last = Some(span);
    }
    if proof.spans.len() > count {
        return Err(MotionProofError::Plane { span: count, index: 0 });
    }
    let Some(Meeting { time, met }) = &proof.meeting else { return Ok([reached, f64::INFINITY]) };
    let span = last.filter(|span| (span.from..=span.to).contains(time) && *time >= reached);
    let span = span.ok_or(MotionProofError::Meeting { time: *time, reason: None })?;
    meets(&span, *time, met)?;
    Ok([reached, *time])
}

/// What of a list of planes is not proven.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Broken {
    Plane { index: usize },
    Gap { index: usize, proven: f64, claimed: f64 },
    Join { index: usize },
}

impl Broken {
    fn of(self, span: usize) -> MotionProofError {
        match self {
            Self::Plane { index } => MotionProofError::Plane { span, index },
            Self::Gap { index, proven, claimed } => {
                MotionProofError::Gap { span, index, proven, claimed }
            }
            Self::Join { index } => MotionProofError::Join { span, index },
        }
    }
}

/// Each plane with its gap, each joined to the next.
pub(super) fn chain<'a, C: Course<'a>>(course: &C, planes: &[PlaneAt]) -> Result<(), Broken> {
    let to = course.times()[1];
    let mut before: Option<(&PlaneAt, At<C>)> = None;
    for (index, plane) in planes.iter().enumerate() {
        let PlaneAt { time, normal, gap, .. } = *plane;
        let is_unit = (normal.length() - 1.0).abs() <= noise::UNIT_VECTOR;
        let is_later = before.is_none_or(|(last, _)| last.time <= time) && time <= to;
        if !is_unit || !is_later {
            return Err(Broken::Plane { index });
        }
        let at = course.instant(time);
        let proven = course.proven_gap(&at, normal);
        if !(gap > 0.0 && gap <= proven) {
            return Err(Broken::Gap { index, proven, claimed: gap });
        }
        if let Some((last, from)) = &before
            && !course.joins([last, plane], [from, &at], &Looking)
        {
            return Err(Broken::Join { index: index - 1 });
        }
        before = Some((plane, at));
    }
    Ok(())
}

fn meets<'a, C: Course<'a, Body = ConvexPolyhedron>>(
    course: &C,
    time: f64,
    met: &Met,
) -> Result<(), MotionProofError> {
    let fails = |reason| MotionProofError::Meeting { time, reason };
    let is_met = is_met(course, time, met).map_err(|reason| fails(Some(reason)))?;
    if is_met { Ok(()) } else { Err(fails(None)) }
}

/// Whether bodies are proven to meet at a time.
pub(super) fn is_met<'a, C: Course<'a, Body = ConvexPolyhedron>>(
    course: &C,
    time: f64,
    met: &Met,
) -> Result<bool, CertificateError> {
    let pair = Pair { bodies: course.instant(time).bodies };
    let [keep, error] = [course.keep(), course.error()];
    Ok(match met {
        Met::Deep(depth) => {
            pair.verify(&**depth)?;
            depth.lower > deep_enough(keep, error)
        }
        Met::Near(near) => {
            pair.verify(near)?;
            near.distance + error <= keep
        }
    })
}
