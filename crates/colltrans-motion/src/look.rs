//! The distance at one time: a plane, or an overlap.

use derive_where::derive_where;
use glam::DVec3;

use super::answer::MotionSteps;
use super::bend::{Climbing, Supports};
use super::course::{At, Course};
use super::proof::Met;
use super::span::Instant;
use colltrans_convex::answer::{Distance, PlaneGap};
use colltrans_convex::body::{ConvexPolyhedron, Hull};
use colltrans_convex::pair::{Pair, distance_from};
use colltrans_convex::setting::{TwoBodies, VertexPair};
use colltrans_convex::solve::nearest::{Difference, NearestPairs, nearly};

/// Bodies that are farther apart than such a share of their size are looked at to such a share of what is beyond it: how
/// near they are counts where they may meet.
const FAR: f64 = 1e-3;
const ROUGHLY: f64 = 0.2;

/// What is to be seen at a time.
#[derive(Debug)]
#[derive_where(Clone, Copy; M)]
pub(super) struct Look<'a, M, B = ConvexPolyhedron> {
    pub(super) at: Instant<'a, M, B>,
    pub(super) normal: DVec3,
    /// The real motion's gap beyond what is to be kept, at least; not positive if that is not proven.
    pub(super) gap: f64,
    /// How fast the gap closes.
    pub(super) rate: f64,
    /// Points that are near, in the frames of the moving and the fixed body.
    pub(super) points: [DVec3; 2],
    /// Below this a gap is none, as rounding goes.
    pub(super) floor: f64,
}

/// A look at the bodies of a course.
pub(super) type LookAt<'a, C> = Look<'a, <C as Course<'a>>::Moved, <C as Course<'a>>::Body>;

impl<M, B> Look<'_, M, B> {
    pub(super) fn time(&self) -> f64 {
        self.at.time
    }

    pub(super) fn is_apart(&self) -> bool {
        self.gap > 0.0
    }
}

/// Who looks: how far bodies are apart at a time, and that they meet.
pub(super) trait Looker<B: Hull> {
    /// What proves that they meet.
    type Met;
    /// How it is asked how far they reach.
    type Supports: Supports<B>;
    const SUPPORTS: Self::Supports;

    fn look<'a, C>(&mut self, course: &C, time: f64) -> Look<'a, C::Moved, B>
    where
        B: 'a,
        C: Course<'a, Body = B>;

    /// What proves that the real bodies meet at a time.
    fn met<'a, C>(&mut self, course: &C, time: f64) -> Option<Self::Met>
    where
        B: 'a,
        C: Course<'a, Body = B>;
}

/// Looks at convex bodies: what is asked again and again, and what is kept from one time to the next.
#[derive(Debug, Clone, Default)]
pub(super) struct ConvexLooker {
    pairs: NearestPairs,
    pub(super) steps: MotionSteps,
}

impl Looker<ConvexPolyhedron> for ConvexLooker {
    type Met = Met;
    type Supports = Climbing;
    const SUPPORTS: Climbing = Climbing;

    fn look<'a, C>(&mut self, course: &C, time: f64) -> Look<'a, C::Moved>
    where
        C: Course<'a, Body = ConvexPolyhedron>,
    {
        let at = course.instant(time);
        let [keep, error] = [course.keep(), course.error()];
        let difference = Difference::new(&at.bodies);
        let beyond = keep.max(0.0) + FAR * difference.bodies.scale();
        let found = nearly(&difference, &self.pairs, ROUGHLY, beyond);
        self.steps.looks += 1;
        self.steps.supports += found.supports;
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
        let floor = 4.0 * difference.noise.point() + error + difference.bodies.input_excess();
        let (normal, gap) =
            plane.map_or((DVec3::X, f64::NEG_INFINITY), |plane| (plane.normal, plane.gap));
        let gap = gap - keep - error;
        let (pairs, weights) = &points;
        let points = at.bodies.weighted(pairs, weights);
        let rate = if gap > 0.0 { closing(course, &at, points, normal) } else { 0.0 };
        Look { at, normal, gap, rate, points, floor }
    }

    fn met<'a, C>(&mut self, course: &C, time: f64) -> Option<Met>
    where
        C: Course<'a, Body = ConvexPolyhedron>,
    {
        let pair = Pair { bodies: course.instant(time).bodies };
        let [keep, error] = [course.keep(), course.error()];
        self.steps.looks += 1;
        if keep > error {
            let near = pair.distance().ok()?.near;
            return (near.distance + error <= keep).then_some(Met::Near(near));
        }
        let enough = deep_enough(keep, error);
        let depth = pair.depth_until(enough).ok()?;
        (depth.lower > enough).then(|| Met::Deep(Box::new(depth)))
    }
}

/// Returns the depth beyond which bodies meet that may be off by an `error`: of a gap to be kept they use all up.
pub(super) fn deep_enough(keep: f64, error: f64) -> f64 {
    error - keep.min(0.0)
}

impl ConvexLooker {
    /// How far apart two bodies are that were looked at.
    pub(super) fn distance(&mut self, bodies: TwoBodies) -> Option<Distance> {
        distance_from(&Pair { bodies }, &mut self.pairs).ok()
    }

    /// Nothing is known of the next bodies.
    pub(super) fn forget(&mut self) {
        self.pairs = NearestPairs::default();
    }

    /// The plane by which the bodies overlap least, with its depth as a negative gap, and the points there.
    fn least_overlap(&mut self, difference: &Difference) -> (Option<PlaneGap>, MeanPair) {
        let pair = Pair { bodies: *difference.bodies };
        let plane = pair.depth().ok().map(|depth| {
            self.steps.supports += depth.steps.supports;
            PlaneGap { normal: -depth.direction, gap: -depth.upper }
        });
        let there =
            plane.map_or_else(VertexPair::default, |plane| difference.support_pair(plane.normal));
        (plane, ([there; 3], [1.0, 0.0, 0.0]))
    }
}

/// Means of pairs of vertices: pairs and weights.
type MeanPair = ([VertexPair; 3], [f64; 3]);

/// How fast points, given in the bodies' frames, come together along a normal.
pub(super) fn closing<'a, C: Course<'a>>(
    course: &C,
    at: &At<'a, C>,
    points: [DVec3; 2],
    normal: DVec3,
) -> f64 {
    let velocity = |which: usize| course.velocity(at, which, points[which]);
    normal.dot(velocity(0) - velocity(1))
}
