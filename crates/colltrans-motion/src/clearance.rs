//! How far along its motion a body can go: three cases, as of a [`Cast`](colltrans_convex::Cast).
//!
//! Bodies are asked as a tolerance leaves them, so that what touches may slide, turn and leave, and is stopped where it
//! is pushed. That comes after the time at which the same bodies meet *in their true place*, as they are: from the last
//! time before at which they are seen apart on, that is searched as any contact is.

use super::answer::{MotionContact, MotionFree, MotionOutcome};
use super::look::{ConvexLooker, Look, Looker};
use super::proof::MotionProof;
use super::search::{Advanced, End, advance};
use super::span::{Span, spans};
use super::{MotionCast, check_fine, stalled, usual_tolerance};
use colltrans_convex::answer::Bounded;
use colltrans_convex::body::Hull;
use colltrans_convex::pair::Pair;
use colltrans_convex::setting::error::QueryError;
use colltrans_solid::Overlap;

/// How often the way back to a time at which bodies are apart as they are is doubled.
const BACK: i32 = 40;

/// The first way back, in parts of what the tolerance has added.
const FIRST: f64 = 0.125;

/// The answer of [`MotionCast::clearance`]: how far along its motion a body can go.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
pub enum MotionClearance<P = MotionProof> {
    /// Until it touches.
    Blocked {
        /// Up to this time it may go: at no time before do the bodies, as the tolerance leaves them, meet, nor has what
        /// stops them met in its true place.
        time: f64,
        /// What stops it.
        contact: Box<MotionStop<P>>,
    },
    /// To the end of the motion.
    Free(MotionFree<P>),
    /// The bodies overlap when the motion begins, by more than is tolerated.
    Overlapping(MotionOverlap),
}

/// What stops a body on its way.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct MotionStop<P = MotionProof> {
    /// When that meets in its true place, of solids the two facets that stop them: not before the lower bound, from the
    /// last time on at which they were apart; at the upper one they have met, or else the bodies as the tolerance leaves
    /// them. Without an upper bound that is not proven.
    pub time: Bounded,
    /// The length of the tolerance that was used.
    pub tolerance: f64,
    /// When the bodies meet as it leaves them; in [`MotionContact::upper`] infinity where that is not proven.
    pub shrunk: MotionContact<P>,
}

/// An overlap when a motion begins.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct MotionOverlap {
    /// The least tolerance with which they would not, from above, where there is one.
    pub least_tolerance: Option<f64>,
    /// Of solids: facets that cross, or a shell that is inside.
    pub place: Option<Overlap>,
}

impl<P> MotionClearance<P> {
    /// Up to which time the body may go: 1, the end, where nothing stops it; `None` if the bodies overlap when the motion
    /// begins.
    pub fn time(&self) -> Option<f64> {
        match self {
            Self::Blocked { time, .. } => Some(*time),
            Self::Free(_) => Some(1.0),
            Self::Overlapping(_) => None,
        }
    }

    /// Whether nothing stops it.
    pub const fn is_free(&self) -> bool {
        matches!(self, Self::Free(_))
    }

    pub(super) fn blocked(time: Bounded, tolerance: f64, shrunk: MotionContact<P>) -> Self {
        let safe = time.lower.min(shrunk.lower);
        Self::Blocked { time: safe, contact: Box::new(MotionStop { time, tolerance, shrunk }) }
    }
}

impl MotionCast<'_> {
    /// How far along its motion the body can go, with the [tolerance](Self::tolerating) or, where there is none, what
    /// rounding can do to a fit: so what touches may slide, turn and leave, and is stopped where it is pushed in.
    /// A gap that is [kept](Self::keeping) may be less by as much.
    ///
    /// The proof in the answer is one of the [cleared](Self::cleared) question. What an overlap
    /// when the motion begins may mean else is asked of [solids](MotionCast::between).
    ///
    /// # Errors
    /// As [`Self::first_contact`].
    ///
    /// ```
    /// use colltrans::glam::DVec3;
    /// use colltrans::motion::{Motion, MotionCast, MotionClearance};
    /// use colltrans::{ConvexPolyhedron, Pose};
    ///
    /// // A block that stands on a table turns there, and cannot be tipped through it.
    /// let block = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE)?;
    /// let table = ConvexPolyhedron::cuboid(DVec3::new(-4.0, -4.0, -1.0), DVec3::new(4.0, 4.0, 0.0))?;
    /// let clearance = |axis| {
    ///     let turn = Motion::turn(Pose::IDENTITY, DVec3::new(0.5, 0.5, 0.0), axis, 2.0)?;
    ///     let cast = MotionCast::new(block.along(&turn), table.at(Pose::IDENTITY))?;
    ///     Ok::<_, Box<dyn std::error::Error>>(cast.clearance()?)
    /// };
    /// assert!(clearance(DVec3::Z)?.is_free());
    /// let MotionClearance::Blocked { time, contact } = clearance(DVec3::X)? else { panic!() };
    /// assert!(time == 0.0 && contact.shrunk.lower < 1e-11);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn clearance(&self) -> Result<MotionClearance, QueryError> {
        let (bodies, motions) = (self.bodies(), self.motions());
        let tolerance = self.tolerance_or_usual();
        if self.tolerance() == 0.0 {
            check_fine(bodies, tolerance)?;
        }
        let cleared = self.cleared();
        let shrunk = match cleared.first_contact()? {
            MotionOutcome::Free(free) => return Ok(MotionClearance::Free(free)),
            MotionOutcome::Overlapping(_) => {
                return Ok(MotionClearance::Overlapping(self.overlap_at_start()));
            }
            MotionOutcome::Contact(shrunk) | MotionOutcome::Grazing(shrunk) => shrunk,
            MotionOutcome::Undecided(undecided) => return Err(stalled(&undecided)),
        };
        let bounds = [shrunk.lower, shrunk.upper];
        let closing = spans(bodies, motions, cleared.keep);
        let bare = spans(bodies, motions, self.keep());
        let mut looker = ConvexLooker::default();
        let rate = at(&closing, shrunk.lower, &mut looker).map_or(0.0, |look| look.rate);
        let time = true_time(&bare, &mut looker, [tolerance, rate], bounds);
        Ok(MotionClearance::blocked(time, tolerance, shrunk))
    }

    /// The same question with the tolerance of its [clearance](Self::clearance), whose proof is one of this.
    #[must_use]
    pub fn cleared(&self) -> Self {
        Self { keep: self.keep() - self.tolerance_or_usual(), ..self.clone() }
    }

    fn tolerance_or_usual(&self) -> f64 {
        let given = self.tolerance();
        if given > 0.0 { given } else { usual_tolerance(self.bodies(), self.motions()) }
    }

    /// By how much the bodies overlap, or are nearer than the gap to be kept, when the motion begins.
    fn overlap_at_start(&self) -> MotionOverlap {
        let first = spans(self.bodies(), self.motions(), 0.0).into_iter().next();
        let pair = first.map(|span| Pair { bodies: span.instant(0.0).bodies });
        let least = pair.and_then(|pair| {
            let deep = pair.depth().ok()?.upper;
            let far = if deep > 0.0 { 0.0 } else { pair.distance().ok()?.lower };
            Some(self.keep() + deep - far)
        });
        MotionOverlap { least_tolerance: least, place: None }
    }
}

/// What is to be seen at a time.
pub(super) fn at<'a, B: Hull, L: Looker<B>>(
    spans: &[Span<'a, B>],
    time: f64,
    looker: &mut L,
) -> Option<Look<'a, [colltrans_kernel::motion::Moved; 2], B>> {
    let span = spans.iter().rev().find(|span| span.from <= time)?;
    Some(looker.look(span, time))
}

/// When bodies that meet between two times as a tolerance leaves them do as they are; what the tolerance has added is so
/// `much` that is closed at this `rate`.
///
/// They are looked at further and further back until they are apart; where they never are, as of what lies on the other
/// from the start, it is as they close now.
pub(super) fn true_time<B: Hull, L: Looker<B>>(
    spans: &[Span<B>],
    looker: &mut L,
    [much, rate]: [f64; 2],
    [lower, upper]: [f64; 2],
) -> Bounded {
    let back = if rate > 0.0 { (much / rate).min(lower) } else { 0.0 };
    let guess = lower - back;
    let first = FIRST * back.max(64.0 * f64::EPSILON);
    let mut since = None;
    for k in 0..BACK {
        let time = (guess - first * 2.0_f64.powi(k)).max(0.0);
        if at(spans, time, looker).is_some_and(|look| look.is_apart()) {
            since = Some(time);
            break;
        }
        if time == 0.0 {
            break;
        }
    }
    let passed = Bounded { value: guess, lower: guess, upper };
    let Some(since) = since else { return passed };
    let end = if upper.is_finite() { upper } else { lower };
    for span in spans.iter().filter(|span| span.to > since && span.from < end) {
        let part = span.within([span.from.max(since), span.to.min(end)]);
        let Advanced { planes, end } = advance(&part, looker);
        let reached = planes.last().map_or(part.from, |plane| plane.time);
        let met = match end {
            End::Free => continue,
            End::Met(time, _) => time.min(upper),
            End::Blurred | End::Stalled => upper,
        };
        let value = if met.is_finite() { reached + 0.5 * (met - reached) } else { reached };
        return Bounded { value, lower: reached, upper: met };
    }
    passed
}
