//! How far a body can move along its motion, as [`Cast::clearance`](colltrans_convex::Cast::clearance) does for
//! translations.
//!
//! The bodies are searched with a tolerance. Bodies in contact may then slide, rotate and separate, and they stop where
//! they would be pushed together. The time at which the nominal bodies meet is earlier. It is searched from the last
//! sampled time, before this stop, at which they are separated.

use super::answer::{MotionContact, MotionFree, MotionOutcome};
use super::proof::MotionProof;
use super::sample::{ConvexSampler, Sample, Sampler};
use super::search::{SpanEnd, SpanResult, prove_span};
use super::span::{Span, split_into_spans};
use super::{MotionCast, check_accuracy, default_tolerance, step_limit_error};
use colltrans_convex::answer::Bounded;
use colltrans_convex::body::VertexHull;
use colltrans_convex::pair::Pair;
use colltrans_convex::setting::error::QueryError;
use colltrans_solid::Overlap;

/// Maximum number of doublings of the step back to a time at which the nominal bodies are separated.
const MAX_BACK_DOUBLINGS: i32 = 40;

/// First step back, as a share of the time in which the tolerance closes.
const FIRST_BACK_SHARE: f64 = 0.125;

/// The answer of [`MotionCast::clearance`]: how far a body can move along its motion.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
pub enum MotionClearance<P = MotionProof> {
    /// The body moves until it touches the other body.
    Blocked {
        /// Time up to which the body can move: the smaller of the lower bounds of the nominal contact
        /// ([`MotionStop::time`]) and of the contact with the tolerance ([`MotionStop::shrunk`]). The bodies with the
        /// tolerance do not meet before.
        time: f64,
        /// The contact that stops the body.
        contact: Box<MotionStop<P>>,
    },
    /// The body can move to the end of the motion.
    Free(MotionFree<P>),
    /// The bodies overlap at the start of the motion, by more than the tolerance.
    Overlapping(MotionOverlap),
}

/// The contact that stops a body in motion.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct MotionStop<P = MotionProof> {
    /// Bounds of the time at which the nominal bodies meet; for solids, the two facets that stop them. The search
    /// starts at the last sampled time at which they are separated, and proves that they do not meet from there to the
    /// lower bound. If they are separated at no sampled time, for example because they are in contact from the start,
    /// or if this search finds no contact, the time is extrapolated and its lower bound is not proven.
    ///
    /// At the upper bound the nominal bodies meet, or the bodies with the tolerance do. It is infinity if neither is
    /// proven.
    pub time: Bounded,
    /// Length of the tolerance, in world units.
    pub tolerance: f64,
    /// Contact of the bodies with the tolerance. [`MotionContact::upper`] is infinity if it is not proven.
    pub shrunk: MotionContact<P>,
}

/// An overlap at the start of a motion.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct MotionOverlap {
    /// Upper bound of the least tolerance without an overlap. `None` if there is no such tolerance.
    pub least_tolerance: Option<f64>,
    /// For solids: two facets that cross, or a shell that is inside the other solid.
    pub place: Option<Overlap>,
}

impl<P> MotionClearance<P> {
    /// Returns the time up to which the body can move. It is 1 if the motion is free, and `None` if the bodies overlap
    /// at the start.
    pub fn time(&self) -> Option<f64> {
        match self {
            Self::Blocked { time, .. } => Some(*time),
            Self::Free(_) => Some(1.0),
            Self::Overlapping(_) => None,
        }
    }

    /// Checks whether the body can move to the end of the motion.
    pub const fn is_free(&self) -> bool {
        matches!(self, Self::Free(_))
    }

    /// Builds the answer for a blocked body. The time is the smaller of both lower bounds.
    pub(super) fn blocked(time: Bounded, tolerance: f64, shrunk: MotionContact<P>) -> Self {
        let safe = time.lower.min(shrunk.lower);
        Self::Blocked { time: safe, contact: Box::new(MotionStop { time, tolerance, shrunk }) }
    }
}

impl MotionCast<'_> {
    /// Computes how far the body can move along its motion.
    ///
    /// The query uses the [tolerance](Self::with_tolerance), or a default: a multiple of the error bound of computed
    /// points. Bodies in contact may therefore slide, rotate and separate, and are stopped where they would be pushed
    /// together. The distance may fall below a [minimum gap](Self::with_min_gap) by the tolerance.
    ///
    /// The proof in the answer belongs to the query [`Self::with_clearance_tolerance`]. For [solids](MotionCast::between_any),
    /// [`MotionCast::with_start_overlap`] selects how an overlap at the start is treated.
    ///
    /// # Errors
    /// Returns the errors of [`Self::first_contact`], and [`QueryError::NotConverged`] if the search took its maximum
    /// number of steps.
    ///
    /// ```
    /// use colltrans::glam::DVec3;
    /// use colltrans::motion::{Motion, MotionCast, MotionClearance};
    /// use colltrans::{ConvexPolyhedron, Pose};
    ///
    /// // A block on a table can rotate about the vertical axis, but cannot be tipped through the table.
    /// let block = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE)?;
    /// let table = ConvexPolyhedron::cuboid(DVec3::new(-4.0, -4.0, -1.0), DVec3::new(4.0, 4.0, 0.0))?;
    /// let clearance = |axis| {
    ///     let turn = Motion::rotation_about(Pose::IDENTITY, DVec3::new(0.5, 0.5, 0.0), axis, 2.0)?;
    ///     let cast = MotionCast::new(block.with_motion(&turn), table.at(Pose::IDENTITY))?;
    ///     Ok::<_, Box<dyn std::error::Error>>(cast.clearance()?)
    /// };
    /// assert!(clearance(DVec3::Z)?.is_free());
    /// let MotionClearance::Blocked { time, contact } = clearance(DVec3::X)? else { panic!() };
    /// assert!(time == 0.0 && contact.shrunk.lower < 1e-11);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn clearance(&self) -> Result<MotionClearance, QueryError> {
        let (bodies, motions) = (self.bodies(), self.motions());
        let tolerance = self.tolerance_or_default();
        if self.tolerance() == 0.0 {
            check_accuracy(bodies, tolerance)?;
        }
        let cleared = self.with_clearance_tolerance();
        let shrunk = match cleared.first_contact()? {
            MotionOutcome::Free(free) => return Ok(MotionClearance::Free(free)),
            MotionOutcome::Overlapping(_) => {
                return Ok(MotionClearance::Overlapping(self.overlap_depth_at_start()));
            }
            MotionOutcome::Contact(shrunk) | MotionOutcome::Grazing(shrunk) => shrunk,
            MotionOutcome::Undecided(undecided) => return Err(step_limit_error(&undecided)),
        };
        let bounds = [shrunk.lower, shrunk.upper];
        let shrunk_spans = split_into_spans(bodies, motions, cleared.min_gap);
        let nominal_spans = split_into_spans(bodies, motions, self.min_gap());
        let mut sampler = ConvexSampler::default();
        let rate = sample_in_spans(&shrunk_spans, shrunk.lower, &mut sampler)
            .map_or(0.0, |sample| sample.rate);
        let time = nominal_contact_time(&nominal_spans, &mut sampler, [tolerance, rate], bounds);
        Ok(MotionClearance::blocked(time, tolerance, shrunk))
    }

    /// Returns the cast with the tolerance of its [clearance](Self::clearance). The proof of the clearance can be
    /// verified with it.
    #[must_use]
    pub fn with_clearance_tolerance(&self) -> Self {
        Self { min_gap: self.min_gap() - self.tolerance_or_default(), ..self.clone() }
    }

    /// Returns the tolerated depth, or the default tolerance if none was set.
    fn tolerance_or_default(&self) -> f64 {
        let given = self.tolerance();
        if given > 0.0 { given } else { default_tolerance(self.bodies(), self.motions()) }
    }

    /// Computes how much the bodies overlap at the start, or how much nearer than the minimum gap they are.
    fn overlap_depth_at_start(&self) -> MotionOverlap {
        let first = split_into_spans(self.bodies(), self.motions(), 0.0).into_iter().next();
        let pair = first.map(|span| Pair { bodies: span.instant_at(0.0).bodies });
        let least = pair.and_then(|pair| {
            let deep = pair.depth().ok()?.upper;
            let far = if deep > 0.0 { 0.0 } else { pair.distance().ok()?.lower };
            Some(self.min_gap() + deep - far)
        });
        MotionOverlap { least_tolerance: least, place: None }
    }
}

/// Samples the distance at a time, in the span that contains it. Returns `None` if the time is before the first span.
pub(super) fn sample_in_spans<'a, B: VertexHull, L: Sampler<B>>(
    spans: &[Span<'a, B>],
    time: f64,
    sampler: &mut L,
) -> Option<Sample<'a, [colltrans_kernel::motion::PiecePlacement; 2], B>> {
    let span = spans.iter().rev().find(|span| span.from <= time)?;
    Some(sampler.sample(span, time))
}

/// Computes bounds of the time at which the nominal bodies meet, for bodies that meet with the tolerance between
/// `lower` and `upper`. `added_gap` is the gap that the tolerance has added, `rate` its closing speed.
///
/// Samples times at growing distances before the extrapolated contact, until the bodies are separated, and searches for
/// the contact from there on. If they are never separated, for example if one rests on the other from the start, or if
/// this search finds no contact, the time is extrapolated with the present rate.
pub(super) fn nominal_contact_time<B: VertexHull, L: Sampler<B>>(
    spans: &[Span<B>],
    sampler: &mut L,
    [added_gap, rate]: [f64; 2],
    [lower, upper]: [f64; 2],
) -> Bounded {
    let back = if rate > 0.0 { (added_gap / rate).min(lower) } else { 0.0 };
    let guess = lower - back;
    let first = FIRST_BACK_SHARE * back.max(64.0 * f64::EPSILON);
    let mut since = None;
    for k in 0..MAX_BACK_DOUBLINGS {
        let time = (guess - first * 2.0_f64.powi(k)).max(0.0);
        if sample_in_spans(spans, time, sampler).is_some_and(|sample| sample.is_apart()) {
            since = Some(time);
            break;
        }
        if time == 0.0 {
            break;
        }
    }
    let extrapolated = Bounded { value: guess, lower: guess, upper };
    let Some(since) = since else { return extrapolated };
    let end = if upper.is_finite() { upper } else { lower };
    for span in spans.iter().filter(|span| span.to > since && span.from < end) {
        let part = span.restricted_to([span.from.max(since), span.to.min(end)]);
        let SpanResult { planes, end } = prove_span(&part, sampler);
        let reached = planes.last().map_or(part.from, |plane| plane.time);
        let met = match end {
            SpanEnd::Free => continue,
            SpanEnd::Met(time, _) => time.min(upper),
            SpanEnd::Indeterminate | SpanEnd::Stalled => upper,
        };
        let value = if met.is_finite() { reached + 0.5 * (met - reached) } else { reached };
        return Bounded { value, lower: reached, upper: met };
    }
    extrapolated
}
