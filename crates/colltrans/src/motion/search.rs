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
//! Where a step is to go: as far as the bound reaches, if the gap closes as it does now; but not beyond where
//! it closes, by Newton: from the left first a little before that, so that a plane is there and the next step
//! is quadratically nearer; when left is as near as rounding tells a little beyond, where the bodies meet.
//! What is not joined waits, and time is halved. A search never ends because an estimate is small.

use glam::DVec3;

use super::answer::PlaneAt;
use super::bend::{SPARE, most_bend};
use super::course::Course;
use super::look::{Look, Looker};

/// More steps than an answer has taken.
const MOST: usize = 20_000;

/// Which share of the step that the bound allows is taken.
const STEP: f64 = 0.95;

/// A search ends when the bodies meet so many pads after the last plane.
const WIDTH: f64 = 40.0;

/// Bodies with more vertices have none looked at on its arc.
const ARCS: usize = 1_000;

/// Steps of which so many would be needed are short.
const SHORT: f64 = 64.0;

/// One plane alone is tried so many steps ahead, and may lose such a share of its gap, for the next one to
/// lead on.
const SWING: f64 = 4.0;
const KEPT: f64 = 0.75;

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
    left: Look<'a, C::Moved, C::Body>,
    stack: Vec<Look<'a, C::Moved, C::Body>>,
    end: f64,
    ahead: Ahead,
    /// `K`.
    curvature: f64,
}

/// Proves as much of a span as it can.
pub(super) fn advance<'a, C: Course<'a>, L: Looker<C::Body>>(
    course: &C,
    looker: &mut L,
) -> Advanced<L::Met> {
    let [from, to] = course.times();
    let left = looker.look(course, from);
    let mut search = Search {
        course,
        planes: Vec::new(),
        left,
        stack: Vec::new(),
        end: to,
        ahead: Ahead::Nothing,
        curvature: course.usual(),
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
        for _ in 0..MOST {
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

    fn note(&mut self, look: &Look<'a, C::Moved, C::Body>, alone: bool) {
        if let Some(last) = self.planes.last_mut() {
            last.alone = alone;
        }
        let Look { normal, gap, .. } = *look;
        self.planes.push(PlaneAt { time: look.time(), normal, gap, alone: false });
    }

    fn go_on(&mut self, look: &Look<'a, C::Moved, C::Body>) {
        self.note(look, false);
        self.left = *look;
    }

    /// Whether all between a plane at left and a later one is proven.
    fn joins(
        &mut self,
        left: &Look<'a, C::Moved, C::Body>,
        next: &Look<'a, C::Moved, C::Body>,
    ) -> bool {
        let enough = most_bend([left.gap, next.gap], 2.0 * SPARE);
        let normals = [left.normal, next.normal];
        let found = self.course.bend([&left.at, &next.at], normals, enough, &L::SUPPORTS);
        let h = next.time() - left.time();
        if h > 0.0 {
            self.curvature = (found.max(0.0) / h / h).max(1e-3 * self.course.usual());
        }
        h == 0.0 || found <= enough || self.is_carried(left, next.time())
    }

    /// Goes on to a later plane where a depth is tolerated, by either normal for all of the time in between: the shallowest
    /// way out may change from one time to the next, while both are shallow enough for a while.
    fn changes_to(&mut self, next: &Look<'a, C::Moved, C::Body>) -> bool {
        if self.course.keep() >= 0.0 {
            return false;
        }
        let left = self.left;
        let turned = |look: &Look<'a, C::Moved, C::Body>, normal: DVec3| Look {
            normal,
            gap: self.course.proven_gap(&look.at, normal),
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
    fn is_carried(&self, look: &Look<'a, C::Moved, C::Body>, time: f64) -> bool {
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
        let Look { gap, rate, floor, .. } = self.left;
        let (from, end) = (self.left.time(), self.end);
        if self.ahead == Ahead::Nothing && self.is_carried(&self.left, end) {
            return end;
        }
        let root = gap.sqrt();
        let c = STEP * (0.5 * self.curvature).sqrt();
        let step = if rate > c * root {
            let off = gap / rate;
            let error = self.curvature * off * off / (2.0 * rate);
            if gap <= 2.0 * floor {
                off + (2.0 * error).max(2.0 * self.pad())
            } else {
                let before = off - (2.0 * error).max(self.pad());
                if before > 0.0 { before } else { 0.5 * off }
            }
        } else if c > 0.0 {
            (2.0 * c * root - rate) / (c * c)
        } else {
            f64::INFINITY
        };
        let time = from + step;
        let between = |time: f64| time > from && time < end;
        match self.ahead {
            Ahead::Nothing if time >= end || time.is_nan() => end,
            _ if between(time) => time,
            _ => (from + 0.5 * (end - from)).max(from.next_up()).min(end),
        }
    }

    /// Goes on by the plane at left alone, where that leads farther than the bound: tried from a few steps
    /// on, and twice as far as long as that is proven.
    fn swings_on(&mut self) -> bool {
        let (from, course) = (self.left.time(), self.course);
        let Look { gap, rate, .. } = self.left;
        let corners = course.arcs();
        let step = self.next_time() - from;
        let (end, rest) = (self.end, self.end - from);
        // The sum of both may be rounded to before the end.
        let at = |length: f64| if length >= rest { end } else { from + length };
        let mut length = (SWING * step).min(rest);
        // As fast as the gap closes now, there is not enough left of it; but steps that are so short are
        // many.
        let closes = rate * length >= KEPT * gap && SHORT * step > rest;
        if corners == 0 || closes || corners > ARCS {
            return false;
        }
        let mut farthest = None;
        loop {
            let next = course.instant(at(length));
            if course.lost([&self.left.at, &next], self.left.normal) >= KEPT * gap {
                break;
            }
            farthest = Some(length);
            if length >= rest {
                break;
            }
            length = (2.0 * length).min(rest);
        }
        farthest.is_some_and(|length| self.swing_to(at(length)))
    }

    fn swing_to(&mut self, time: f64) -> bool {
        let next = self.looker.look(self.course, time);
        let normal = self.left.normal;
        let gap = self.course.proven_gap(&next.at, normal);
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
