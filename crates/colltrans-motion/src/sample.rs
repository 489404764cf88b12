//! Computes the separating plane or the overlap of two bodies at one time.

use derive_where::derive_where;
use glam::DVec3;

use super::answer::MotionSteps;
use super::curvature::{HillClimbing, SupportSearch};
use super::proof::ContactProof;
use super::relative_motion::{InstantOf, RelativeMotion};
use super::span::Instant;
use colltrans_convex::answer::{Distance, PlaneGap};
use colltrans_convex::body::{ConvexPolyhedron, VertexHull};
use colltrans_convex::pair::{Pair, distance_from};
use colltrans_convex::setting::{TwoBodies, VertexPair};
use colltrans_convex::solve::nearest::{
    DescentResult, Difference, NearestPairs, nearest_points_within_share,
};

/// Share of the size of the bodies. A distance beyond this share is computed only roughly, because an exact one is
/// needed only near a contact.
const FAR_SHARE: f64 = 1e-3;
/// Accuracy of such a distance, relative to its part beyond that share.
const ROUGH_ACCURACY: f64 = 0.2;

/// A distance sample: a plane between two bodies at one time.
#[derive(Debug)]
#[derive_where(Clone, Copy; M)]
pub(super) struct Sample<'a, M, B = ConvexPolyhedron> {
    pub(super) at: Instant<'a, M, B>,
    pub(super) normal: DVec3,
    /// Lower bound of the gap of the real motion minus the minimum gap; not positive if separation is not proven.
    pub(super) gap: f64,
    /// Closing speed of the gap.
    pub(super) rate: f64,
    /// Nearest points, in the frames of the moving and of the fixed body.
    pub(super) points: [DVec3; 2],
    /// Largest gap that rounding errors may close.
    pub(super) floor: f64,
}

/// A sample of the bodies of a relative motion.
pub(super) type SampleOf<'a, C> =
    Sample<'a, <C as RelativeMotion<'a>>::Moved, <C as RelativeMotion<'a>>::Body>;

impl<M, B> Sample<'_, M, B> {
    pub(super) fn time(&self) -> f64 {
        self.at.time
    }

    pub(super) fn is_apart(&self) -> bool {
        self.gap > 0.0
    }
}

/// Samples distances, and proves contacts.
pub(super) trait Sampler<B: VertexHull> {
    /// Proof of a contact.
    type Met;
    /// Method that finds support points.
    type SupportSearch: SupportSearch<B>;
    const SUPPORT_SEARCH: Self::SupportSearch;
    /// Depth, in floors, at which a contact is first tested for a proof; at least 1.
    const PROVING_DEPTH: f64 = 1.0;

    /// Computes the plane between the bodies at a time.
    fn sample<'a, C>(&mut self, motion: &C, time: f64) -> Sample<'a, C::Moved, B>
    where
        B: 'a,
        C: RelativeMotion<'a, Body = B>;

    /// Proves that the real bodies meet at a time. Returns `None` if that is not proven.
    fn prove_contact<'a, C>(&mut self, motion: &C, time: f64) -> Option<Self::Met>
    where
        B: 'a,
        C: RelativeMotion<'a, Body = B>;
}

/// Samples distances of convex bodies. Stores the nearest pairs of vertices for the next sample.
#[derive(Debug, Clone, Default)]
pub(super) struct ConvexSampler {
    pairs: NearestPairs,
    pub(super) steps: MotionSteps,
}

impl Sampler<ConvexPolyhedron> for ConvexSampler {
    type Met = ContactProof;
    type SupportSearch = HillClimbing;
    const SUPPORT_SEARCH: HillClimbing = HillClimbing;

    fn sample<'a, C>(&mut self, motion: &C, time: f64) -> Sample<'a, C::Moved>
    where
        C: RelativeMotion<'a, Body = ConvexPolyhedron>,
    {
        let at = motion.instant_at(time);
        let [min_gap, error] = [motion.min_gap(), motion.position_error()];
        let difference = Difference::new(&at.bodies);
        let [_, between_cores] = at.bodies.core_gap_bounds(min_gap.max(0.0));
        let beyond = between_cores + FAR_SHARE * difference.bodies.size();
        let found = self.nearest_points(&difference, beyond);
        let plane = found.gap_plane(&difference).map(|plane| plane.gap);
        let are_apart = plane.is_some_and(|plane| plane.gap > 0.0);
        let (plane, points) = if min_gap < 0.0 && !are_apart {
            self.least_overlap_plane(&difference, f64::INFINITY)
        } else {
            let of_bodies =
                |plane: PlaneGap| PlaneGap { gap: at.bodies.less_radii(plane.gap), ..plane };
            // Nothing reads the points of a sample whose gap is not positive.
            let points = if are_apart {
                found.weighted_pairs_and_weights(&difference)
            } else {
                at_one_pair(VertexPair::default())
            };
            (plane.map(of_bodies), points)
        };
        let floor = 4.0 * difference.noise.point_error()
            + error
            + difference.bodies.input_excess()
            + 4.0 * f64::EPSILON * (between_cores - min_gap.max(0.0));
        let (normal, gap) =
            plane.map_or((DVec3::X, f64::NEG_INFINITY), |plane| (plane.normal, plane.gap));
        let gap = gap - min_gap - error;
        let (pairs, weights) = &points;
        let points = at.bodies.weighted_points(pairs, weights);
        let rate = if gap > 0.0 { closing_speed(motion, &at, points, normal) } else { 0.0 };
        Sample { at, normal, gap, rate, points, floor }
    }

    fn prove_contact<'a, C>(&mut self, motion: &C, time: f64) -> Option<ContactProof>
    where
        C: RelativeMotion<'a, Body = ConvexPolyhedron>,
    {
        let pair = Pair { bodies: motion.instant_at(time).bodies };
        let [min_gap, error] = [motion.min_gap(), motion.position_error()];
        self.steps.looks += 1;
        if min_gap > error {
            let near = pair.distance().ok()?.near;
            return (near.distance + error <= min_gap).then_some(ContactProof::Near(near));
        }
        let enough = min_proving_depth(min_gap, error);
        let depth = pair.depth_until(enough).ok()?;
        (depth.lower > enough).then(|| ContactProof::Deep(Box::new(depth)))
    }
}

/// Returns the depth beyond which bodies with the position error `error` meet, for a minimum gap `min_gap` (negative: a
/// tolerated depth).
pub(super) fn min_proving_depth(min_gap: f64, error: f64) -> f64 {
    error - min_gap.min(0.0)
}

impl ConvexSampler {
    /// Computes the distance of two sampled bodies. Returns `None` if the search does not converge.
    pub(super) fn distance(&mut self, bodies: TwoBodies) -> Option<Distance> {
        distance_from(&Pair { bodies }, &mut self.pairs).ok()
    }

    /// Discards the nearest pairs, before other bodies are sampled.
    pub(super) fn discard_pairs(&mut self) {
        self.pairs = NearestPairs::default();
    }

    /// Computes the nearest points of two bodies: exactly if they are at most the length `beyond` apart, else roughly.
    fn nearest_points(&mut self, difference: &Difference, beyond: f64) -> DescentResult {
        let found = nearest_points_within_share(difference, &self.pairs, ROUGH_ACCURACY, beyond);
        self.steps.looks += 1;
        self.steps.supports += found.supports;
        let pairs = found.start_pairs();
        if !pairs.is_empty() {
            self.pairs = pairs;
        }
        found
    }

    /// Computes the normal of a plane between two bodies, and their nearest points in the frames of the bodies. Returns
    /// `None` if no plane separates them. Distances far above `core_gap` are computed roughly.
    pub(super) fn plane_between(
        &mut self,
        bodies: &TwoBodies,
        core_gap: f64,
    ) -> Option<(DVec3, [DVec3; 2])> {
        let difference = Difference::new(bodies);
        let found = self.nearest_points(&difference, core_gap + FAR_SHARE * bodies.size());
        let plane = found.gap_plane(&difference).filter(|plane| plane.gap.gap > 0.0)?;
        let (pairs, weights) = found.weighted_pairs_and_weights(&difference);
        Some((plane.gap.normal, bodies.weighted_points(&pairs, &weights)))
    }

    /// Computes the normal of the least overlap of two bodies. Returns `None` if they overlap by more than twice
    /// `most_depth`: the search ends as soon as the depth exceeds `most_depth`, at a plane that need not be the best.
    pub(super) fn shallow_normal(&mut self, bodies: &TwoBodies, most_depth: f64) -> Option<DVec3> {
        let (plane, _) = self.least_overlap_plane(&Difference::new(bodies), most_depth);
        let plane = plane.filter(|plane| -plane.gap <= 2.0 * most_depth)?;
        Some(plane.normal)
    }

    /// Computes the plane of least overlap, with the negative depth as its gap, and a vertex pair in it. Ends as soon
    /// as the depth exceeds `enough`.
    fn least_overlap_plane(
        &mut self,
        difference: &Difference,
        enough: f64,
    ) -> (Option<PlaneGap>, MeanPair) {
        let pair = Pair { bodies: *difference.bodies };
        let plane = pair.depth_until(enough).ok().map(|depth| {
            self.steps.supports += depth.steps.supports;
            PlaneGap { normal: -depth.direction, gap: -depth.upper }
        });
        let there =
            plane.map_or_else(VertexPair::default, |plane| difference.support_pair(plane.normal));
        (plane, at_one_pair(there))
    }
}

/// A mean of vertex pairs: the pairs and their weights.
type MeanPair = ([VertexPair; 3], [f64; 3]);

/// Returns one vertex pair as a mean.
fn at_one_pair(pair: VertexPair) -> MeanPair {
    ([pair; 3], [1.0, 0.0, 0.0])
}

/// Computes the closing speed, along a normal, of two points given in the frames of their bodies.
pub(super) fn closing_speed<'a, C: RelativeMotion<'a>>(
    motion: &C,
    at: &InstantOf<'a, C>,
    points: [DVec3; 2],
    normal: DVec3,
) -> f64 {
    let velocity = |which: usize| motion.point_velocity(at, which, points[which]);
    normal.dot(velocity(0) - velocity(1))
}
