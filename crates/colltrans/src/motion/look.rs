//! The distance at one time: a plane, or an overlap.

use super::span::{Instant, Span};
use crate::answer::{Depth, NearPoints};
use crate::pair::Pair;
use crate::setting::TwoBodies;
use crate::solve::nearest::{Difference, Found, NearestPairs, nearest};
use glam::DVec3;

/// What is to be seen at a time.
#[derive(Debug, Clone, Copy)]
pub(super) struct Look<'a> {
    pub(super) at: Instant<'a>,
    pub(super) normal: DVec3,
    /// The real motion's gap beyond what is to be kept, at least; not positive if that is not proven.
    pub(super) gap: f64,
    /// How fast the gap closes.
    pub(super) rate: f64,
    /// Below this a gap is none, as rounding goes.
    pub(super) floor: f64,
}

impl Look<'_> {
    pub(super) fn time(&self) -> f64 {
        self.at.time
    }

    pub(super) fn is_apart(&self) -> bool {
        self.gap > 0.0
    }
}

/// What proves that the bodies are too near at a time.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
pub enum Met {
    /// They overlap.
    Deep(Box<Depth>),
    /// Two points are no farther apart than what is to be kept.
    Near(NearPoints),
}

/// What is asked again and again, and what is kept from one time to the next.
#[derive(Debug, Clone)]
pub(super) struct Looker {
    pub(super) keep: f64,
    pairs: NearestPairs,
    pub(super) looks: u32,
    pub(super) supports: u32,
}

impl Looker {
    pub(super) fn new(keep: f64) -> Self {
        Self { keep, pairs: NearestPairs::default(), looks: 0, supports: 0 }
    }

    pub(super) fn look<'a>(&mut self, span: &Span<'a>, time: f64) -> Look<'a> {
        let at = span.instant(time);
        let difference = Difference::new(&at.bodies);
        let found = nearest(&difference, &self.pairs, None);
        self.looks += 1;
        self.supports += found.supports;
        let pairs = found.pairs();
        if !pairs.is_empty() {
            self.pairs = pairs;
        }
        let plane = found.best_plane(&difference).map(|plane| plane.gap);
        let floor = 4.0 * difference.noise.point() + span.error;
        let (normal, gap) =
            plane.map_or((DVec3::X, f64::NEG_INFINITY), |plane| (plane.normal, plane.gap));
        let gap = gap - self.keep - span.error;
        let rate = if gap > 0.0 { closing(span, &at, &found, normal) } else { 0.0 };
        Look { at, normal, gap, rate, floor }
    }

    /// What proves that the real bodies meet at a time.
    pub(super) fn met(&mut self, span: &Span, time: f64) -> Option<Met> {
        let at = span.instant(time);
        self.looks += 1;
        proof_that_met(&at.bodies, self.keep, span.error)
    }
}

fn proof_that_met(bodies: &TwoBodies, keep: f64, error: f64) -> Option<Met> {
    let pair = Pair { bodies: *bodies };
    if keep > 0.0 {
        let near = pair.distance().ok()?.near;
        return (near.distance + error <= keep).then_some(Met::Near(near));
    }
    let depth = pair.depth().ok()?;
    (depth.lower > error).then(|| Met::Deep(Box::new(depth)))
}

/// How fast the nearest points come together along a normal.
fn closing(span: &Span, at: &Instant, found: &Found, normal: DVec3) -> f64 {
    let (pairs, weights) = found.points();
    let means = at.bodies.weighted(&pairs, &weights);
    let velocity = |which: usize| {
        let moved = &at.moved[which];
        span.piece(which).velocity_of(moved.arm + moved.rotation * means[which])
    };
    normal.dot(velocity(0) - velocity(1))
}
