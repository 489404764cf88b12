//! Pairs of facets with a minimum gap.
//!
//! - Each pair is decided by the cast of a point against the difference of two triangles, grown by a ball
//!   ([`min_gap`](colltrans_convex::solve::min_gap)). The bounds of nodes of the moving body are enlarged by the gap
//!   (`PlacedBody::swell`).
//! - The distance first falls below the gap between a facet that faces along the direction and one that faces against
//!   it. Let `p`, `q` be the nearest points, and `n`, with `n.d > 0`, the normal from one to the other. If no facet at
//!   `p` faced along `d`, `d` would lead into the body, but no part of the body is beyond the plane across `n`.
//! - All facets of open shells are tested, because they have no side. Of closed shells, which may have no thickness,
//!   edge-on facets are tested if others are folded back onto them.
//! - *Grazing*: rounding errors hide whether facets pass each other at exactly the gap. Facets do not block if a plane
//!   parallel to the direction proves a distance of the gap minus [`GRAZE`] noises, or if they start that near and do
//!   not approach. A gap of at most as many noises is ignored.

use glam::DVec3;

use super::super::nearest::triangle::{self, Corners};
use super::super::scene::{PairFrame, PlacedVertex};
use super::{Facet, Gap, GapFilter, Meeting};
use colltrans_convex::solve::min_gap::{
    CrossingBounds, DistanceSample, GapLine, SampledSet, SetPlane, bound_crossing, distance_to_line,
};
use colltrans_kernel::noise::UNIT_VECTOR;

/// Distance below the gap, in noises, at which facets may pass each other.
const GRAZE: f64 = 8.0;

/// Maximum number of distance samples for a point that is near enough, if the search found none on its way.
const MAX_SAMPLES: usize = 8;

/// The difference of two triangles in the setting frame.
pub(crate) struct FacetDifference {
    moving: Corners,
    fixed: Corners,
    noise: f64,
}

impl FacetDifference {
    pub(crate) fn new(scene: &PairFrame, f: &[PlacedVertex; 3], g: &[PlacedVertex; 3]) -> Self {
        let placed =
            |corners: &[PlacedVertex; 3]| corners.each_ref().map(|c| scene.corner_position(c));
        Self { moving: placed(f), fixed: placed(g), noise: scene.noise }
    }

    /// Returns the line of the search along the direction of a scene (`sign` 1) or against it (-1).
    fn search_line(scene: &PairFrame, sign: f64) -> GapLine {
        let unit = scene.setting.direction / scene.setting.length * sign;
        GapLine::new(unit, scene.min_gap(), scene.size() - scene.min_gap())
    }

    fn plane_along(&self, normal: DVec3) -> SetPlane<()> {
        let height = triangle::gap_along(&self.moving, &self.fixed, normal) - self.noise;
        SetPlane { normal, height, excess: 0.0, support: () }
    }

    /// Checks whether the facets are certainly nearer than a gap or, with `touching`, at most as far.
    pub(crate) fn are_within(&self, gap: f64, touching: bool) -> bool {
        let nearest = triangle::nearest_points(&self.moving, &self.fixed, self.noise);
        let length = nearest.length + triangle::LENGTH_NOISES * self.noise;
        length < gap || touching && length == gap
    }

    /// Checks whether the distance of the facets remains at least the gap from the start on, except for grazing.
    fn remain_apart(&mut self, line: &GapLine) -> bool {
        let Some(plane) = self.sample(DVec3::ZERO).plane else { return false };
        line.direction_cosine(plane.normal) <= UNIT_VECTOR
            && plane.height >= line.min_gap - GRAZE * self.noise
    }

    /// Returns a point of the difference near the line, from distance samples that begin at `lower`. It ends at the
    /// first point nearer to the line than the gap, or after [`MAX_SAMPLES`] samples.
    fn sample_near_line(&mut self, line: &GapLine, lower: f64) -> DVec3 {
        let mut point = self.sample(line.unit * lower).point;
        for _ in 0..MAX_SAMPLES {
            if line.crossing_upper_bound(point).is_some() {
                break;
            }
            point = self.sample(line.unit * point.dot(line.unit)).point;
        }
        point
    }

    /// Checks whether a plane parallel to the line separates the facets, except for grazing.
    fn pass_laterally(&mut self, line: &GapLine) -> bool {
        let toward = self.fixed[0] - self.moving[0];
        let found = distance_to_line(self, line, toward);
        found.is_some_and(|found| found.plane.height >= line.min_gap - GRAZE * self.noise)
    }
}

impl SampledSet for FacetDifference {
    type PlaneId = ();
    type PointId = [DVec3; 2];

    fn supporting_plane(&mut self, normal: DVec3) -> (SetPlane<()>, DVec3) {
        let least = |corners: &Corners, n: DVec3| {
            let [a, b, c] = *corners;
            let nearer = if n.dot(b) < n.dot(a) { b } else { a };
            if n.dot(c) < n.dot(nearer) { c } else { nearer }
        };
        let point = least(&self.fixed, normal) - least(&self.moving, -normal);
        (self.plane_along(normal), point)
    }

    fn sample(&mut self, from: DVec3) -> DistanceSample<(), [DVec3; 2]> {
        let there = self.moving.map(|p| p + from);
        let nearest = triangle::nearest_points(&there, &self.fixed, self.noise);
        let weights = nearest.weights;
        let plane = (nearest.gap > self.noise).then(|| self.plane_along(nearest.normal));
        let mean = triangle::weighted_point(&self.fixed, weights[1])
            - triangle::weighted_point(&self.moving, weights[0]);
        let of = |k: usize| (0..3).filter(move |&i| weights[k][i] > 0.0);
        let (mut corners, mut count) = ([mean; 3], 0);
        for (i, j) in of(0).flat_map(|i| of(1).map(move |j| (i, j))) {
            if count < 3 {
                corners[count] = self.fixed[j] - self.moving[i];
            }
            count += 1;
        }
        DistanceSample { plane, point: mean, spot: weights, corners, count }
    }
}

/// Computes the travel at which the distance of two facets falls to the minimum gap. `None` if it does not fall below
/// the gap by more than rounding errors, if its lower bound is not below `limit`, or if the pair is not wanted.
pub(crate) fn min_gap_crossing(
    scene: &PairFrame,
    f: &Facet,
    g: &Facet,
    limit: f64,
    wanted: GapFilter,
) -> Option<Gap> {
    let reach = scene.min_gap() + 4.0 * scene.noise;
    let apart = |axis: usize| f.bounds.is_separated_along(&g.bounds, axis, reach);
    if apart(0) || apart(1) || g.bounds.low.z - f.bounds.high.z - reach >= limit {
        return None;
    }
    if wanted != GapFilter::All && g.bounds.high.z - f.bounds.low.z < -reach {
        return None;
    }
    let facets = &mut FacetDifference::new(scene, &f.corners, &g.corners);
    let line = &FacetDifference::search_line(scene, 1.0);
    if wanted == GapFilter::NotCrossing && facets.are_within(scene.core_gap[0], false) {
        return None;
    }
    let start = facets.plane_along(line.unit);
    let found = bound_crossing(facets, line, start, limit);
    if found.lower >= limit
        || wanted != GapFilter::All && found.lower <= 4.0 * scene.noise && facets.remain_apart(line)
        || is_shallow(&found, line) && facets.pass_laterally(line)
    {
        return None;
    }
    Some(crossing_as_gap(facets, &found, line))
}

/// Checks whether the line may merely graze.
fn is_shallow(found: &CrossingBounds<FacetDifference>, line: &GapLine) -> bool {
    let Some(near) = found.near_point else { return true };
    let aside = near.point.reject_from_normalized(line.unit).length();
    line.min_gap - aside <= 2.0 * GRAZE * line.noise.point_error()
}

/// Converts the bounds of a search to a gap with its error, for facets that come nearer than the minimum gap.
fn crossing_as_gap(
    facets: &mut FacetDifference,
    found: &CrossingBounds<FacetDifference>,
    line: &GapLine,
) -> Gap {
    use std::cmp::Ordering::Greater;
    let near = found.near_point.map(|near| near.point);
    let point = near.unwrap_or_else(|| facets.sample_near_line(line, found.lower));
    let upper =
        line.crossing_upper_bound(point).unwrap_or_else(|| point.dot(line.unit)).max(found.lower);
    let least = line.estimate_crossing(point).unwrap_or(upper).clamp(found.lower, upper);
    let error = (least - found.lower).max(upper - least);
    // Pairs that cross are excluded earlier if they are not wanted.
    Gap { least, largest: f64::INFINITY, signs: [Greater; 2], at: Meeting::Near, error }
}

/// Returns the weights of the nearest points of two facets after a travel `distance` along the direction, and the
/// normal from one to the other.
pub(crate) fn nearest_after(
    scene: &PairFrame,
    f: &[PlacedVertex; 3],
    g: &[PlacedVertex; 3],
    distance: f64,
) -> ([DVec3; 2], DVec3) {
    let FacetDifference { moving, fixed, noise } = FacetDifference::new(scene, f, g);
    let by = scene.setting.direction / scene.setting.length * distance;
    let nearest = triangle::nearest_points(&moving.map(|p| p + by), &fixed, noise);
    (nearest.weights, nearest.normal)
}
