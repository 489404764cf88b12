//! Searches a span for the first contact of two bodies.
//!
//! Algorithm: conservative advancement (Mirtich 1996) with a curvature bound instead of a velocity bound
//! (`docs/theory/conservative-advancement.md`).
//!
//! - The *front* is the last plane up to which all times are proven. `gap` and `rate` are its gap and its closing
//!   speed.
//! - `K` is the last curvature bound divided by the square of the interval.
//! - The *floor* is the largest gap that rounding errors may close. The *floor time* is the time in which one floor
//!   closes.
//! - Invariant: all planes in the list are joined, each to the next one.
//! - Invariant: `end_time` is the end of the span, or the earliest sampled time without a plane.
//! - Invariant: the pending samples have planes between front and `end_time`, the earliest on top of the stack.

use glam::DVec3;

use super::curvature::{ROOT_MARGIN, max_provable_curvature};
use super::proof::TimedPlane;
use super::relative_motion::RelativeMotion;
use super::sample::{Sample, SampleOf, Sampler};

/// Maximum number of steps of a search between bodies that do not rotate.
const MAX_STEPS: usize = 20_000;
/// Additional number of steps for each radian of the rotation of both bodies together.
const MAX_STEPS_PER_RADIAN: f64 = 200.0;

/// Number of planes above which a search counts as long.
const LONG_SEARCH_PLANES: usize = 500;

/// Factor of `sqrt(K / 2)` in the equation of a step. Below 1, it makes a step longer than `K` proves for the predicted
/// gap.
const STEP_SHARE: f64 = 0.95;

/// Amount by which the second derivative of the gap may be below the sampled one, as a share of `K` or of the sampled
/// closing acceleration, whichever is larger.
const ACCELERATION_MARGIN: f64 = 0.5;

/// Maximum ratio of a gap to the previous one for which the gap is assumed to close.
const DROP_RATIO: f64 = 0.1;

/// Maximum gap, in floors, from which the next sample is taken beyond the contact.
const NEAR_FLOORS: f64 = 1.5;

/// Minimum distance of that sample from the contact, in floor times. There a depth exceeds the error of computed
/// places.
const OVERSHOOT_FLOOR_TIMES: f64 = 1.5;

/// Maximum width, in floor times, of the interval between the last plane and a contact at which a search ends.
const MAX_WIDTH_FLOOR_TIMES: f64 = 4.0;

/// Maximum number of rotating vertices for which single planes are tried.
const MAX_ARC_VERTICES: usize = 1_000;

/// Number of steps to the end of the interval above which steps count as short.
const SHORT_STEPS: f64 = 64.0;

/// Length of the first trial of a single plane, in steps.
const FIRST_TRIAL_STEPS: f64 = 4.0;

/// Maximum share of its gap that a single plane may lose up to the next plane.
const MAX_LOSS_SHARE: f64 = 0.75;

/// Share of its gap that a carried plane is predicted to lose up to the next sample.
const CARRIED_LOSS_SHARE: f64 = 0.7;

/// Maximum share of its gap that a single plane may lose up to the end of a span.
const MAX_END_LOSS_SHARE: f64 = 0.999;

/// Maximum number of times that the distance of a sample from an indeterminate time is doubled.
const MAX_DOUBLINGS: i32 = 48;

/// The result at the end of a span.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum SpanEnd<M> {
    /// The last plane is at the end of the span.
    Free,
    /// The bodies are proven to meet at this time.
    Met(f64, M),
    /// The bodies are so near that rounding errors hide whether they meet. A contact is not proven.
    Indeterminate,
    /// The search took its maximum number of steps.
    Stalled,
}

/// The result of a search in a span.
#[derive(Debug, Clone)]
pub(super) struct SpanResult<M> {
    /// Planes in the order of time. Empty if the bodies are not separated at the start.
    pub(super) planes: Vec<TimedPlane>,
    pub(super) end: SpanEnd<M>,
}

/// The event at the end of the searched interval.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Ahead {
    /// The end of the span.
    SpanEnd,
    /// Bodies that meet or cannot be separated.
    PossibleContact,
}

struct SpanSearch<'s, 'a, C: RelativeMotion<'a>, L> {
    motion: &'s C,
    sampler: &'s mut L,
    planes: Vec<TimedPlane>,
    front: SampleOf<'a, C>,
    pending: Vec<SampleOf<'a, C>>,
    end_time: f64,
    ahead: Ahead,
    /// `K`, and its typical maximum.
    curvature: f64,
    typical_curvature: f64,
    /// Estimated lower bound of the second derivative of the gap.
    gap_acceleration: f64,
    /// Whether the gap at the front is far smaller than that of the previous plane.
    gap_dropped: bool,
    /// Whether the last sample before a possible contact at `end_time` had no plane either.
    sampled_past_end: bool,
    /// Whether a contact just beyond the front was already tested without success.
    is_contact_tested: bool,
}

/// Proves separation in as much of a span as possible.
pub(super) fn prove_span<'a, C: RelativeMotion<'a>, L: Sampler<C::Body>>(
    motion: &C,
    sampler: &mut L,
) -> SpanResult<L::Met> {
    let [from, to] = motion.time_range();
    let front = sampler.sample(motion, from);
    let typical_curvature = motion.typical_curvature();
    let mut search = SpanSearch {
        motion,
        planes: Vec::new(),
        front,
        pending: Vec::new(),
        end_time: to,
        ahead: Ahead::SpanEnd,
        curvature: typical_curvature,
        typical_curvature,
        gap_acceleration: -typical_curvature,
        gap_dropped: false,
        sampled_past_end: false,
        is_contact_tested: false,
        sampler,
    };
    let end = if front.is_apart() {
        search.append_plane(&front, false);
        search.search_span()
    } else {
        search.find_contact_from(from)
    };
    SpanResult { planes: search.planes, end }
}

impl<'a, C: RelativeMotion<'a>, L: Sampler<C::Body>> SpanSearch<'_, 'a, C, L> {
    /// Repeats steps until the end of the span, a contact or the maximum number of steps.
    fn search_span(&mut self) -> SpanEnd<L::Met> {
        let [from, to] = self.motion.time_range();
        let turned = self.motion.angular_speed() * (to - from);
        for _ in 0..MAX_STEPS + (MAX_STEPS_PER_RADIAN * turned) as usize {
            if let Some(next) = self.pending.last().copied() {
                if self.is_joined(&{ self.front }, &next) {
                    self.pending.pop();
                    self.move_front_to(&next);
                } else if self.switches_normal_before(&next) {
                    self.pending.pop();
                } else if !self.sample_midpoint(next.time()) {
                    return self.find_contact_from(self.front.time());
                }
                continue;
            }
            if self.ahead == Ahead::SpanEnd && self.front.time() >= self.end_time {
                return SpanEnd::Free;
            }
            if let Some((time, met)) = self.find_contact_ahead() {
                return SpanEnd::Met(time, met);
            }
            if self.ahead == Ahead::PossibleContact && self.is_interval_minimal() {
                return self.find_contact_from(self.end_time);
            }
            if self.advance_by_single_plane() {
                continue;
            }
            let time = self.next_time();
            self.sample_time(time);
        }
        SpanEnd::Stalled
    }

    /// Appends a plane to the list. `alone` states whether the previous plane proves the time up to this one alone.
    fn append_plane(&mut self, sample: &SampleOf<'a, C>, alone: bool) {
        if let Some(last) = self.planes.last_mut() {
            last.alone = alone;
        }
        let Sample { normal, gap, .. } = *sample;
        self.planes.push(TimedPlane { time: sample.time(), normal, gap, alone: false });
    }

    /// Moves the front to a joined plane and updates the estimates.
    fn move_front_to(&mut self, sample: &SampleOf<'a, C>) {
        self.append_plane(sample, false);
        let h = sample.time() - self.front.time();
        if h > 0.0 {
            let k = self.curvature;
            let sampled = ((self.front.rate - sample.rate) / h).min(k);
            self.gap_acceleration = sampled - ACCELERATION_MARGIN * k.max(-sampled);
            self.gap_dropped = sample.gap < DROP_RATIO * self.front.gap;
            self.sampled_past_end = false;
        }
        self.front = *sample;
    }

    /// Checks whether all times between the front and a later plane are proven. Updates `K`.
    fn is_joined(&mut self, front: &SampleOf<'a, C>, next: &SampleOf<'a, C>) -> bool {
        let enough = max_provable_curvature([front.gap, next.gap], 2.0 * ROOT_MARGIN);
        let normals = [front.normal, next.normal];
        // The loose bound is cheaper. In a long search, the longer steps of the tight bound save more.
        let is_long = self.planes.len() > LONG_SEARCH_PLANES;
        let (sufficient, min_ratio) =
            if is_long { (f64::NEG_INFINITY, 1e-9) } else { (enough, 1e-3) };
        let found = self.motion.curvature_bound(
            [&front.at, &next.at],
            normals,
            sufficient,
            &L::SUPPORT_SEARCH,
        );
        let h = next.time() - front.time();
        if h > 0.0 {
            self.curvature = (found.max(0.0) / h / h).max(min_ratio * self.typical_curvature);
        }
        h == 0.0 || found <= enough || self.is_proven_by_carrying(front, next.time())
    }

    /// Moves the front to a later plane by using one of the two normals at both times. This applies only with a
    /// tolerated depth: the direction of least depth may change discontinuously, while both normals bound the depth for
    /// a while.
    fn switches_normal_before(&mut self, next: &SampleOf<'a, C>) -> bool {
        if self.motion.min_gap() >= 0.0 {
            return false;
        }
        let front = self.front;
        let with_normal = |sample: &SampleOf<'a, C>, normal: DVec3| Sample {
            normal,
            gap: self.motion.claimed_gap(&sample.at, normal),
            ..*sample
        };
        let (last, first) = (with_normal(next, front.normal), with_normal(&front, next.normal));
        let between = if last.is_apart() && self.is_joined(&front, &last) {
            last
        } else if first.is_apart() && self.is_joined(&first, next) {
            first
        } else {
            return false;
        };
        self.append_plane(&between, false);
        self.move_front_to(next);
        true
    }

    /// Checks whether a plane that the moving body carries proves all times up to `time`.
    fn is_proven_by_carrying(&self, sample: &SampleOf<'a, C>, time: f64) -> bool {
        let Sample { at, gap, normal, .. } = sample;
        self.motion.carried_gap_loss(at, time, *normal) < MAX_LOSS_SHARE * gap
    }

    /// Samples the middle between the front and a time. Returns `false` if no number lies between them.
    fn sample_midpoint(&mut self, until: f64) -> bool {
        let middle = self.front.time() + 0.5 * (until - self.front.time());
        let is_between = middle > self.front.time() && middle < until;
        if is_between {
            self.sample_time(middle);
        }
        is_between
    }

    /// Samples a time: a plane becomes pending, otherwise the time becomes the new end.
    fn sample_time(&mut self, time: f64) {
        let sample = self.sampler.sample(self.motion, time);
        if sample.is_apart() {
            self.pending.push(sample);
        } else {
            self.pending.clear();
            self.sampled_past_end = self.ahead == Ahead::PossibleContact;
            (self.end_time, self.ahead) = (time, Ahead::PossibleContact);
        }
    }

    /// Returns the time in which a gap of one floor closes.
    fn floor_time(&self) -> f64 {
        let Sample { rate, floor, .. } = self.front;
        let rate = rate.max((self.curvature * floor).sqrt());
        if rate > 0.0 { floor / rate } else { f64::INFINITY }
    }

    /// Checks whether the front is as near to the end as rounding errors allow.
    fn is_interval_minimal(&self) -> bool {
        let width = self.end_time - self.front.time();
        let ulps = 4.0 * f64::EPSILON * self.end_time;
        width <= ulps
            || (self.front.gap <= 2.0 * self.front.floor
                && width <= MAX_WIDTH_FLOOR_TIMES * self.floor_time())
    }

    /// Returns the time of the next sample.
    fn next_time(&self) -> f64 {
        let (from, end) = (self.front.time(), self.end_time);
        if self.ahead == Ahead::SpanEnd && self.is_proven_by_carrying(&self.front, end) {
            return end;
        }
        let time = from
            + if self.is_front_near_contact() {
                self.overshoot_step()
            } else {
                self.extended_step()
            };
        let between = |time: f64| time > from && time < end;
        match self.ahead {
            Ahead::SpanEnd if time >= end || time.is_nan() => end,
            _ if between(time) => time,
            _ => (end - self.retreat_from_end()).max(from.next_up()).min(end),
        }
    }

    /// Returns how long before the end to sample if the gap is predicted to close only at the end or later. The length
    /// is the possible error of this prediction, at most half of the interval. It is half of the interval if the last
    /// such sample had no plane.
    fn retreat_from_end(&self) -> f64 {
        let remaining = self.end_time - self.front.time();
        let off = ACCELERATION_MARGIN
            * self.curvature.max(-self.gap_acceleration)
            * remaining
            * remaining
            / self.front.rate;
        let half = 0.5 * remaining;
        if self.sampled_past_end || off.is_nan() || off <= 0.0 {
            half
        } else {
            off.max(self.floor_time()).min(half)
        }
    }

    /// Returns [`Self::bounded_step`], or a longer step that the plane of the front proves if the moving body carries
    /// it.
    fn extended_step(&self) -> f64 {
        let (step, from) = (self.bounded_step(), self.front.time());
        let lost = self.motion.carried_gap_loss(&self.front.at, from + step, self.front.normal);
        // The loss grows slightly less than in proportion to the time.
        let carried = CARRIED_LOSS_SHARE * step * self.front.gap / lost;
        let is_longer = carried > FIRST_TRIAL_STEPS * step
            && self.is_proven_by_carrying(&self.front, from + carried);
        if is_longer { carried } else { step }
    }

    /// Returns the step after which `sqrt(gap) + sqrt(predicted gap)` is [`STEP_SHARE`] of the sum that `K` requires,
    /// or a step to slightly before the predicted time of contact.
    fn bounded_step(&self) -> f64 {
        let Sample { gap, rate, .. } = self.front;
        let (root, c) = (gap.sqrt(), STEP_SHARE * (0.5 * self.curvature).sqrt());
        let closed = closing_time(gap, rate, self.gap_acceleration);
        if c * closed <= root {
            let before = closed - self.floor_time();
            if before > 0.0 { before } else { 0.5 * closed }
        } else {
            // Solves sqrt(predicted gap) = c t - sqrt(gap) for t.
            (2.0 * c * root - rate) / (c * c - 0.5 * self.gap_acceleration)
        }
    }

    /// Checks whether the front is so near to a contact that the next sample is beyond it.
    fn is_front_near_contact(&self) -> bool {
        let Sample { gap, rate, floor, .. } = self.front;
        gap <= NEAR_FLOORS * floor && rate > STEP_SHARE * (0.5 * self.curvature * gap).sqrt()
    }

    /// Returns the step to slightly beyond the predicted contact, for a gap of about one floor.
    fn overshoot_step(&self) -> f64 {
        let Sample { gap, rate, .. } = self.front;
        let off = gap / rate;
        let error = self.curvature * off * off / (2.0 * rate);
        off + (2.0 * error).max(OVERSHOOT_FLOOR_TIMES * self.floor_time())
    }

    /// Tests once whether the bodies meet just beyond a front that is within rounding errors of a contact. Returns the
    /// time and the proof, or `None`.
    fn find_contact_ahead(&mut self) -> Option<(f64, L::Met)> {
        if self.is_contact_tested || !self.is_front_near_contact() {
            return None;
        }
        let width = self.overshoot_step() * L::PROVING_DEPTH;
        let time = self.front.time() + width;
        if !(time > self.front.time()
            && time < self.end_time
            && width <= MAX_WIDTH_FLOOR_TIMES * L::PROVING_DEPTH * self.floor_time())
        {
            return None;
        }
        self.is_contact_tested = true;
        Some((time, self.sampler.prove_contact(self.motion, time)?))
    }

    /// Moves the front by a single plane, if this proves more than the next step. Up to the end of the span, several
    /// normals are tried. Otherwise the normal of the front is tried at lengths that double from a few steps.
    fn advance_by_single_plane(&mut self) -> bool {
        let (from, motion) = (self.front.time(), self.motion);
        let Sample { gap, rate, .. } = self.front;
        let corners = motion.arc_vertex_count();
        if corners == 0 || corners > MAX_ARC_VERTICES {
            return false;
        }
        let step = self.next_time() - from;
        let (end, remaining) = (self.end_time, self.end_time - from);
        let first = (FIRST_TRIAL_STEPS * step).min(remaining);
        // At the present rate, the plane would lose too much of its gap in the first trial. The trial is still made if
        // the steps are short, and therefore many, and the gap has not dropped, which predicts a contact.
        if rate * first >= MAX_LOSS_SHARE * gap
            && (SHORT_STEPS * step > remaining || self.gap_dropped)
        {
            return false;
        }
        if self.ahead == Ahead::SpanEnd && self.finish_by_single_plane() {
            return true;
        }
        // The rounded sum may be before the end.
        let at = |length: f64| if length >= remaining { end } else { from + length };
        let (mut length, mut farthest) = (first, None);
        while motion.gap_loss([&self.front.at, &motion.instant_at(at(length))], self.front.normal)
            < MAX_LOSS_SHARE * gap
        {
            farthest = Some(length);
            if length >= remaining {
                break;
            }
            length = (2.0 * length).min(remaining);
        }
        farthest.is_some_and(|length| self.move_front_by_single_plane(at(length)))
    }

    /// Proves the rest of the span by a single plane: with the normal of the front, a radial one, or one between the
    /// axes. Returns `false` if none of them does.
    fn finish_by_single_plane(&mut self) -> bool {
        let (front, motion) = (self.front, self.motion);
        let at = motion.instant_at(self.end_time);
        let ends_with = |sample: SampleOf<'a, C>, most: f64| {
            if motion.gap_loss([&front.at, &at], sample.normal) >= most {
                return None;
            }
            let gap = motion.claimed_gap(&at, sample.normal);
            (gap > 0.0).then_some((sample, gap))
        };
        let along = |normal: DVec3| {
            let gap = motion.claimed_gap(&front.at, normal);
            (gap > 0.0).then_some(Sample { normal, gap, ..front })
        };
        let plain = |sample: SampleOf<'a, C>| ends_with(sample, MAX_END_LOSS_SHARE * sample.gap);
        let aside = || plain(along(motion.radial_normal(&front.at, front.points)?)?);
        let between = || {
            let sample = along(motion.normal_between_axes(&front.at)?)?;
            ends_with(sample, sample.gap - sample.floor)
        };
        let Some((first, gap)) = plain(front).or_else(aside).or_else(between) else {
            return false;
        };
        if first.normal != front.normal {
            self.append_plane(&first, false);
        }
        let last = Sample { at, gap, rate: 0.0, ..first };
        self.append_plane(&last, true);
        self.front = last;
        true
    }

    /// Samples a time, up to which the normal of the front alone was proven, and moves the front there. Returns `false`
    /// if the plane with this normal or the sampled plane has no positive gap there.
    fn move_front_by_single_plane(&mut self, time: f64) -> bool {
        let next = self.sampler.sample(self.motion, time);
        let normal = self.front.normal;
        let gap = self.motion.claimed_gap(&next.at, normal);
        if !(gap > 0.0 && next.is_apart()) {
            return false;
        }
        self.append_plane(&Sample { normal, gap, ..next }, true);
        self.move_front_to(&next);
        true
    }

    /// Searches for a proven contact at a time and at doubling distances after it. Stops when the bodies are separated
    /// again.
    fn find_contact_from(&mut self, time: f64) -> SpanEnd<L::Met> {
        let floor_time = self.floor_time();
        let ulp = 2.0 * f64::EPSILON * time.max(f64::EPSILON);
        let first = if floor_time.is_finite() { floor_time.max(ulp) } else { ulp };
        let first = first * L::PROVING_DEPTH;
        // A contact at `time` itself is proven only if a depth of about one floor suffices.
        let begin = if L::PROVING_DEPTH > 1.0 { 0 } else { -1 };
        for k in begin..MAX_DOUBLINGS {
            let later = if k < 0 { time } else { time + first * 2.0_f64.powi(k) };
            if later > self.motion.time_range()[1] {
                break;
            }
            if let Some(met) = self.sampler.prove_contact(self.motion, later) {
                return SpanEnd::Met(later, met);
            }
            if self.sampler.sample(self.motion, later).is_apart() && later > self.front.time() {
                break;
            }
        }
        SpanEnd::Indeterminate
    }
}

/// Returns the time at which a gap closes, for a closing speed `rate` and a second derivative `gap_acceleration`.
/// Returns infinity if it does not close.
fn closing_time(gap: f64, rate: f64, gap_acceleration: f64) -> f64 {
    let square = rate * rate - 2.0 * gap_acceleration * gap;
    let sum = rate + square.max(0.0).sqrt();
    if square >= 0.0 && sum > 0.0 { 2.0 * gap / sum } else { f64::INFINITY }
}
