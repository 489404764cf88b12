//! The distance at one time: a plane, or an overlap.

use super::course::Course;
use super::span::Instant;
use crate::answer::{Depth, NearPoints, PlaneGap};
use crate::pair::Pair;
use crate::setting::VertexPair;
use crate::solve::nearest::{Difference, NearestPairs, nearest};
use glam::DVec3;

/// What is to be seen at a time.
#[derive(Debug, Clone, Copy)]
pub(super) struct Look<'a, M> {
    pub(super) at: Instant<'a, M>,
    pub(super) normal: DVec3,
    /// The real motion's gap beyond what is to be kept, at least; not positive if that is not proven.
    pub(super) gap: f64,
    /// How fast the gap closes.
    pub(super) rate: f64,
    /// Below this a gap is none, as rounding goes.
    pub(super) floor: f64,
}

impl<M> Look<'_, M> {
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
    /// They overlap, deeper than is tolerated.
    Deep(Box<Depth>),
    /// Two points are no farther apart than what is to be kept.
    Near(NearPoints),
}

/// What is asked again and again, and what is kept from one time to the next.
#[derive(Debug, Clone, Default)]
pub(super) struct Looker {
    pairs: NearestPairs,
    pub(super) looks: u32,
    pub(super) supports: u32,
}

impl Looker {
    pub(super) fn look<'a, C: Course<'a>>(&mut self, course: &C, time: f64) -> Look<'a, C::Moved> {
        let at = course.instant(time);
        let [keep, error] = [course.keep(), course.error()];
        let difference = Difference::new(&at.bodies);
        let found = nearest(&difference, &self.pairs, None);
        self.looks += 1;
        self.supports += found.supports;
        let pairs = found.pairs();
        if !pairs.is_empty() {
            self.pairs = pairs;
        }
        let plane = found.plane(&difference).map(|plane| plane.gap);
        let (plane, points) = match plane {
            Some(plane) if plane.gap > 0.0 || keep >= 0.0 => (Some(plane), found.points()),
            _ if keep < 0.0 => self.least_overlap(&difference),
            _ => (None, found.points()),
        };
        let floor = 4.0 * difference.noise.point() + error;
        let (normal, gap) =
            plane.map_or((DVec3::X, f64::NEG_INFINITY), |plane| (plane.normal, plane.gap));
        let gap = gap - keep - error;
        let rate = if gap > 0.0 { closing(course, &at, &points, normal) } else { 0.0 };
        Look { at, normal, gap, rate, floor }
    }

    /// The plane by which the bodies overlap least, with its depth as a negative gap, and the points there.
    fn least_overlap(&mut self, difference: &Difference) -> (Option<PlaneGap>, MeanPair) {
        let pair = Pair { bodies: *difference.bodies };
        let plane = pair.depth().ok().map(|depth| {
            self.supports += depth.steps.supports;
            PlaneGap { normal: -depth.direction, gap: -depth.upper }
        });
        let there =
            plane.map_or_else(VertexPair::default, |plane| difference.lowest_pair(plane.normal));
        (plane, ([there; 3], [1.0, 0.0, 0.0]))
    }

    /// What proves that the real bodies meet at a time.
    pub(super) fn met<'a>(&mut self, course: &impl Course<'a>, time: f64) -> Option<Met> {
        let pair = Pair { bodies: course.instant(time).bodies };
        let [keep, error] = [course.keep(), course.error()];
        self.looks += 1;
        if keep > 0.0 {
            let near = pair.distance().ok()?.near;
            return (near.distance + error <= keep).then_some(Met::Near(near));
        }
        let depth = pair.depth().ok()?;
        (depth.lower > error - keep).then(|| Met::Deep(Box::new(depth)))
    }
}

/// Means of pairs of vertices: pairs and weights.
type MeanPair = ([VertexPair; 3], [f64; 3]);

/// How fast such points come together along a normal.
fn closing<'a, C: Course<'a>>(
    course: &C,
    at: &Instant<'a, C::Moved>,
    (pairs, weights): &MeanPair,
    normal: DVec3,
) -> f64 {
    let means = at.bodies.weighted(pairs, weights);
    let velocity = |which: usize| course.velocity(at, which, means[which]);
    normal.dot(velocity(0) - velocity(1))
}
