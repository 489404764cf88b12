//! From the beginning of a span to its end, or to where the bodies meet.
//!
//! Notation. *Left* is the last plane up to which all is proven, `s` its gap and `rate` how fast that closes;
//! `K` is the last `C / h^2`. The *floor* is a gap that rounding may make of none, the *pad* the time in
//! which one closes.
//!
//! Invariant. All planes in the list are joined, each to the next one. `end` is the end of the span, or the
//! first time seen at which the bodies meet or are not told apart; those that wait on the stack are planes
//! between left and `end`, the earliest on top.
//!
//! Where a step is to go: as far as the bound reaches, if the gap goes on as a parabola through what the last two
//! planes saw, a little lower; but not beyond where that closes, so that a plane is there and the next step
//! is quadratically nearer; when left is as near as rounding tells a little beyond, where the bodies meet.
//! What is not joined waits, and time is halved. A search never ends because an estimate is small.

use glam::DVec3;

use super::bend::{SPARE, most_bend};
use super::course::Course;
use super::look::{Look, LookAt, Looker};
use super::proof::PlaneAt;

/// Maximum number of steps of a search, and how many more for each radian by which the bodies turn.
const MOST: usize = 20_000;
const MOST_A_RADIAN: f64 = 200.0;

/// Number of planes from which on a search is long.
const PATIENCE: usize = 500;

/// Which share of the step that the bound allows is taken.
const STEP: f64 = 0.95;

/// By which share of `K` the gap may close faster than it was seen to.
const DOUBT: f64 = 0.5;

/// A gap that is so much smaller than the one before closes for good.
const FELL: f64 = 0.1;

/// The next look is beyond a contact from so many floors on: those before aim at one.
const AT_FLOOR: f64 = 1.5;

/// It is so many pads beyond, where a depth can be told from what places may be off.
const BEYOND_FLOOR: f64 = 1.5;

/// A search ends when the bodies meet so many pads after the last plane.
const WIDTH: f64 = 4.0;

/// Bodies with more vertices have none looked at on its arc.
const ARCS: usize = 1_000;

/// Steps of which so many would be needed are short.
const SHORT: f64 = 64.0;

/// One plane alone is tried so many steps ahead, and may lose such a share of its gap: for the next one to
/// lead on, or at the end of a span.
const SWING: f64 = 4.0;
const KEPT: f64 = 0.75;

/// Share of its gap that a plane may lose while both bodies carry it along to the next sample.
const CARRIED: f64 = 0.7;
const SPENT: f64 = 0.999;

/// How often a time after a blur is doubled to find bodies that meet.
const BEYOND: i32 = 48;

/// How a span ends.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum End<M> {
    /// With its last plane.
    Free,
    /// The bodies meet at a time, as is proven.
    Met(f64, M),
    /// They come nearer than rounding can tell; that they meet is not proven.
    Blurred,
    /// Too many steps.
    Stalled,
}

/// What has become of a span.
#[derive(Debug, Clone)]
pub(super) struct Advanced<M> {
    /// In the order of their times; none if there is none at the beginning.
    pub(super) planes: Vec<PlaneAt>,
    pub(super) end: End<M>,
}

/// What is at the end of what is searched.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Ahead {
    /// The end of the span.
    Nothing,
    /// Bodies that meet, or are not told apart.
    Something,
}

struct Search<'s, 'a, C: Course<'a>, L> {
    course: &'s C,
    looker: &'s mut L,
    planes: Vec<PlaneAt>,
    left: LookAt<'a, C>,
    stack: Vec<LookAt<'a, C>>,
    end: f64,
    ahead: Ahead,
    /// `K`, and what it usually is at most.
    curvature: f64,
    usual: f64,
    /// How the gap goes on, at least: its second derivative.
    slowing: f64,
    /// Whether left's gap is far smaller than that of the plane before.
    fell: bool,
    /// Whether the last look before a later one was no plane.
    missed: bool,
    /// Whether it was asked in vain if the bodies meet just beyond left.
    is_asked: bool,
}

/// Proves as much of a span as it can.
pub(super) fn advance<'a, C: Course<'a>, L: Looker<C::Body>>(
    course: &C,
    looker: &mut L,
) -> Advanced<L::Met> {
    let [from, to] = course.times();
    let left = looker.look(course, from);
    let usual = course.usual();
    let mut search = Search {
        course,
        planes: Vec::new(),
        left,
        stack: Vec::new(),
        end: to,
        ahead: Ahead::Nothing,
        curvature: usual,
        usual,
        slowing: -usual,
        fell: false,
        missed: false,
        is_asked: false,
        looker,
    };
    let end = if left.is_apart() {
        search.note(&left, false);
        search.run()
    } else {
        search.met_from(from)
    };
    Advanced { planes: search.planes, end }
}

impl<'a, C: Course<'a>, L: Looker<C::Body>> Search<'_, 'a, C, L> {
    fn run(&mut self) -> End<L::Met> {
        let [from, to] = self.course.times();
        let turned = self.course.turning() * (to - from);
        for _ in 0..MOST + (MOST_A_RADIAN * turned) as usize {
            if let Some(next) = self.stack.last().copied() {
                if self.joins(&{ self.left }, &next) {
                    self.stack.pop();
                    self.go_on(&next);
                } else if self.changes_to(&next) {
                    self.stack.pop();
                } else if !self.halve(next.time()) {
                    return self.met_from(self.left.time());
                }
                continue;
            }
            if self.ahead == Ahead::Nothing && self.left.time() >= self.end {
                return End::Free;
            }
            if let Some((time, met)) = self.meets_soon() {
                return End::Met(time, met);
            }
            if self.ahead == Ahead::Something && self.is_narrow() {
                return self.met_from(self.end);
            }
            if self.swings_on() {
                continue;
            }
            let time = self.next_time();
            self.visit(time);
        }
        End::Stalled
    }

    fn note(&mut self, look: &LookAt<'a, C>, alone: bool) {
        if let Some(last) = self.planes.last_mut() {
            last.alone = alone;
        }
        let Look { normal, gap, .. } = *look;
        self.planes.push(PlaneAt { time: look.time(), normal, gap, alone: false });
    }

    fn go_on(&mut self, look: &LookAt<'a, C>) {
        self.note(look, false);
        let h = look.time() - self.left.time();
        if h > 0.0 {
            let k = self.curvature;
            let seen = ((self.left.rate - look.rate) / h).min(k);
            self.slowing = seen - DOUBT * k.max(-seen);
            self.fell = look.gap < FELL * self.left.gap;
            self.missed = false;
        }
        self.left = *look;
    }

    /// Whether all between a plane at left and a later one is proven.
    fn joins(&mut self, left: &LookAt<'a, C>, next: &LookAt<'a, C>) -> bool {
        let enough = most_bend([left.gap, next.gap], 2.0 * SPARE);
        let normals = [left.normal, next.normal];
        // A loose bound costs less. A long search gains more by steps as long as the tight one allows.
        let is_long = self.planes.len() > PATIENCE;
        let (asked, least) = if is_long { (f64::NEG_INFINITY, 1e-9) } else { (enough, 1e-3) };
        let found = self.course.bend([&left.at, &next.at], normals, asked, &L::SUPPORTS);
        let h = next.time() - left.time();
        if h > 0.0 {
            self.curvature = (found.max(0.0) / h / h).max(least * self.usual);
        }
        h == 0.0 || found <= enough || self.is_carried(left, next.time())
    }

    /// Goes on to a later plane where a depth is tolerated, by either normal for all of the time in between: the shallowest
    /// way out may change from one time to the next, while both are shallow enough for a while.
    fn changes_to(&mut self, next: &LookAt<'a, C>) -> bool {
        if self.course.keep() >= 0.0 {
            return false;
        }
        let left = self.left;
        let turned = |look: &LookAt<'a, C>, normal: DVec3| Look {
            normal,
            gap: self.course.claimed_gap(&look.at, normal),
            ..*look
        };
        let (last, first) = (turned(next, left.normal), turned(&left, next.normal));
        let between = if last.is_apart() && self.joins(&left, &last) {
            last
        } else if first.is_apart() && self.joins(&first, next) {
            first
        } else {
            return false;
        };
        self.note(&between, false);
        self.go_on(next);
        true
    }

    /// Whether a plane proves all up to a time, carried along.
    fn is_carried(&self, look: &LookAt<'a, C>, time: f64) -> bool {
        let Look { at, gap, normal, .. } = look;
        self.course.carried(at, time, *normal) < KEPT * gap
    }

    /// Looks in the middle before a time; `false` if there is none.
    fn halve(&mut self, until: f64) -> bool {
        let middle = self.left.time() + 0.5 * (until - self.left.time());
        let is_between = middle > self.left.time() && middle < until;
        if is_between {
            self.visit(middle);
        }
        is_between
    }

    fn visit(&mut self, time: f64) {
        let look = self.looker.look(self.course, time);
        if look.is_apart() {
            self.stack.push(look);
        } else {
            self.stack.clear();
            self.missed = self.ahead == Ahead::Something;
            (self.end, self.ahead) = (time, Ahead::Something);
        }
    }

    /// The time in which a gap of one floor closes.
    fn pad(&self) -> f64 {
        let Look { rate, floor, .. } = self.left;
        let rate = rate.max((self.curvature * floor).sqrt());
        if rate > 0.0 { floor / rate } else { f64::INFINITY }
    }

    /// Whether left is as near to the end as rounding tells.
    fn is_narrow(&self) -> bool {
        let width = self.end - self.left.time();
        let ulps = 4.0 * f64::EPSILON * self.end;
        width <= ulps || (self.left.gap <= 2.0 * self.left.floor && width <= WIDTH * self.pad())
    }

    /// Where to look next.
    fn next_time(&self) -> f64 {
        let (from, end) = (self.left.time(), self.end);
        if self.ahead == Ahead::Nothing && self.is_carried(&self.left, end) {
            return end;
        }
        let time = from + if self.is_at_floor() { self.beyond() } else { self.far_step() };
        let between = |time: f64| time > from && time < end;
        match self.ahead {
            Ahead::Nothing if time >= end || time.is_nan() => end,
            _ if between(time) => time,
            _ => (end - self.back_from_end()).max(from.next_up()).min(end),
        }
    }

    /// How far before the end to look, where the gap seems to close only there or later: as far as that may be wrong,
    /// if the last such look was not so wrong, and at most halfway.
    fn back_from_end(&self) -> f64 {
        let rest = self.end - self.left.time();
        let off = DOUBT * self.curvature.max(-self.slowing) * rest * rest / self.left.rate;
        let half = 0.5 * rest;
        if self.missed || off.is_nan() || off <= 0.0 { half } else { off.max(self.pad()).min(half) }
    }

    /// Returns the step of [`Self::step`], or a longer one up to which both bodies carry the plane along.
    fn far_step(&self) -> f64 {
        let (step, from) = (self.step(), self.left.time());
        let lost = self.course.carried(&self.left.at, from + step, self.left.normal);
        // Little more is lost in proportion to the time.
        let carried = CARRIED * step * self.left.gap / lost;
        let is_longer = carried > SWING * step && self.is_carried(&self.left, from + carried);
        if is_longer { carried } else { step }
    }

    /// As far as the bound reaches, but to a little before the gap closes.
    fn step(&self) -> f64 {
        let Look { gap, rate, .. } = self.left;
        let (root, c) = (gap.sqrt(), STEP * (0.5 * self.curvature).sqrt());
        let closed = closes_in(gap, rate, self.slowing);
        if c * closed <= root {
            let before = closed - self.pad();
            if before > 0.0 { before } else { 0.5 * closed }
        } else {
            // Where the root of the gap that is left is `c` times the way less that of this one.
            (2.0 * c * root - rate) / (c * c - 0.5 * self.slowing)
        }
    }

    /// Whether left is so near to a contact that the next look is beyond it.
    fn is_at_floor(&self) -> bool {
        let Look { gap, rate, floor, .. } = self.left;
        gap <= AT_FLOOR * floor && rate > STEP * (0.5 * self.curvature * gap).sqrt()
    }

    /// A little beyond where a gap of hardly more than nothing closes.
    fn beyond(&self) -> f64 {
        let Look { gap, rate, .. } = self.left;
        let off = gap / rate;
        let error = self.curvature * off * off / (2.0 * rate);
        off + (2.0 * error).max(BEYOND_FLOOR * self.pad())
    }

    /// That the bodies meet just beyond a left that is as near as rounding tells; asked once.
    fn meets_soon(&mut self) -> Option<(f64, L::Met)> {
        if self.is_asked || !self.is_at_floor() {
            return None;
        }
        let width = self.beyond();
        let time = self.left.time() + width;
        if !(time > self.left.time() && time < self.end && width <= WIDTH * self.pad()) {
            return None;
        }
        self.is_asked = true;
        Some((time, self.looker.met(self.course, time)?))
    }

    /// Goes on by the plane at left alone, or by one across the way from an axis, where that leads farther than the
    /// bound: to the end, or from a few steps on twice as far as long as that is proven.
    fn swings_on(&mut self) -> bool {
        let (from, course) = (self.left.time(), self.course);
        let Look { gap, rate, .. } = self.left;
        let corners = course.arcs();
        if corners == 0 || corners > ARCS {
            return false;
        }
        let step = self.next_time() - from;
        let (end, rest) = (self.end, self.end - from);
        let first = (SWING * step).min(rest);
        // As fast as the gap closes now, there is not enough left of it; but steps that are so short are
        // many, if they do not lead to where it closes.
        if rate * first >= KEPT * gap && (SHORT * step > rest || self.fell) {
            return false;
        }
        if self.ahead == Ahead::Nothing && self.swings_to_end() {
            return true;
        }
        // The sum of both may be rounded to before the end.
        let at = |length: f64| if length >= rest { end } else { from + length };
        let (mut length, mut farthest) = (first, None);
        while course.lost([&self.left.at, &course.instant(at(length))], self.left.normal)
            < KEPT * gap
        {
            farthest = Some(length);
            if length >= rest {
                break;
            }
            length = (2.0 * length).min(rest);
        }
        farthest.is_some_and(|length| self.swing_to(at(length)))
    }

    /// Ends the span by one plane alone.
    fn swings_to_end(&mut self) -> bool {
        let (left, course) = (self.left, self.course);
        let at = course.instant(self.end);
        let ends_with = |look: LookAt<'a, C>, most: f64| {
            if course.lost([&left.at, &at], look.normal) >= most {
                return None;
            }
            let gap = course.claimed_gap(&at, look.normal);
            (gap > 0.0).then_some((look, gap))
        };
        let along = |normal: DVec3| {
            let gap = course.claimed_gap(&left.at, normal);
            (gap > 0.0).then_some(Look { normal, gap, ..left })
        };
        let plain = |look: LookAt<'a, C>| ends_with(look, SPENT * look.gap);
        let aside = || plain(along(course.aside(&left.at, left.points)?)?);
        let between = || {
            let look = along(course.between_axes(&left.at)?)?;
            ends_with(look, look.gap - look.floor)
        };
        let Some((first, gap)) = plain(left).or_else(aside).or_else(between) else {
            return false;
        };
        if first.normal != left.normal {
            self.note(&first, false);
        }
        let last = Look { at, gap, rate: 0.0, ..first };
        self.note(&last, true);
        self.left = last;
        true
    }

    fn swing_to(&mut self, time: f64) -> bool {
        let next = self.looker.look(self.course, time);
        let normal = self.left.normal;
        let gap = self.course.claimed_gap(&next.at, normal);
        if !(gap > 0.0 && next.is_apart()) {
            return false;
        }
        self.note(&Look { normal, gap, ..next }, true);
        self.go_on(&next);
        true
    }

    /// That the bodies meet, from a time on at which they may; doubled steps later, as long as they do not
    /// part.
    fn met_from(&mut self, time: f64) -> End<L::Met> {
        let pad = self.pad();
        let ulp = 2.0 * f64::EPSILON * time.max(f64::EPSILON);
        let first = if pad.is_finite() { pad.max(ulp) } else { ulp };
        for k in -1..BEYOND {
            let later = if k < 0 { time } else { time + first * 2.0_f64.powi(k) };
            if later > self.course.times()[1] {
                break;
            }
            if let Some(met) = self.looker.met(self.course, later) {
                return End::Met(later, met);
            }
            if self.looker.look(self.course, later).is_apart() && later > self.left.time() {
                break;
            }
        }
        End::Blurred
    }
}

/// When a gap closes that does so at a rate, which changes as fast as this; infinity if it does not.
fn closes_in(gap: f64, rate: f64, slowing: f64) -> f64 {
    let square = rate * rate - 2.0 * slowing * gap;
    let sum = rate + square.max(0.0).sqrt();
    if square >= 0.0 && sum > 0.0 { 2.0 * gap / sum } else { f64::INFINITY }
}
