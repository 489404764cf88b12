//! Distances of two placed convex bodies.

use glam::DVec3;

use super::{PairProof, rounded, verify};
use crate::answer::{CertificateError, Distance, NearPoints, StartedFrom, Steps, Within};
use crate::body::{ConvexPolyhedron, Features, feature_in_plane};
use crate::pair::{Pair, PairBody};
use crate::setting::error::{QueryError, Stalled};
use crate::setting::{TwoBodies, VertexPair, check_length};
use crate::solve::nearest::{DescentResult, Difference, GapPlane, NearestPairs, nearest_points};

/// Largest accepted difference of the bounds, in noises, in addition to the reach of the bodies beyond
/// support points.
pub(super) const MAX_BOUND_GAP: f64 = 64.0;

impl PairBody for ConvexPolyhedron {
    type PairProof<'p> = PairProof<'p>;

    fn distance(pair: &Pair<'_>) -> Result<Distance, QueryError> {
        distance_from(pair, &mut NearestPairs::default())
    }

    fn within(pair: &Pair<'_>, length: f64) -> Result<(Within, Steps), QueryError> {
        check_length(length)?;
        let bodies = &pair.bodies;
        let difference = Difference::new(bodies);
        let [_, between_cores] = bodies.core_gap_bounds(length);
        let mut found = nearest_points(&difference, &NearestPairs::default(), Some(between_cores));
        let mut decided = decide_within(&difference, &found, length);
        if decided.is_none() {
            let before = found.supports;
            found = nearest_points(&difference, &found.start_pairs(), None);
            found.supports += before;
            decided = decide_within(&difference, &found, length);
        }
        let answer = match decided {
            Some(decided) => decided,
            None => Within::Undecided(distance_of_search(&difference, &found)?),
        };
        Ok((answer, found.steps()))
    }

    fn verify_pair(pair: &Pair<'_>, proof: PairProof<'_>) -> Result<f64, CertificateError> {
        match proof {
            PairProof::Gap(plane) => verify::verify_plane(&pair.bodies, plane),
            PairProof::Near(points) => verify::verify_points(&pair.bodies, points),
            PairProof::Depth(depth) => verify::verify_depth(&pair.bodies, depth),
        }
    }
}

/// Returns the decision that the search result proves about a length, `None` if it proves none.
fn decide_within(difference: &Difference, found: &DescentResult, length: f64) -> Option<Within> {
    let bodies = difference.bodies;
    let near = rounded::near_points(bodies, found.near_points(difference));
    if near.distance <= length {
        return Some(Within::Closer(near));
    }
    let plane = rounded::plane_gap(bodies, found.separating_plane(difference)?.gap);
    (plane.gap > length).then_some(Within::Farther(plane))
}

/// Computes the distance by a search that starts from `pairs`. Replaces `pairs` by the pairs of the nearest points.
///
/// # Errors
/// Returns [`QueryError::NotConverged`] if the bounds differ by more than rounding explains.
#[inline]
pub fn distance_from(pair: &Pair, pairs: &mut NearestPairs) -> Result<Distance, QueryError> {
    let difference = Difference::new(&pair.bodies);
    let found = nearest_points(&difference, pairs, None);
    let is_new = pairs.is_empty();
    *pairs = found.start_pairs();
    let mut distance = distance_of_search(&difference, &found)?;
    if !is_new {
        distance.steps.started_from = StartedFrom::Features;
    }
    Ok(distance)
}

/// Builds the answer from a search result.
///
/// Returns [`QueryError::NotConverged`] if the bounds differ by more than rounding explains.
fn distance_of_search(
    difference: &Difference,
    found: &DescentResult,
) -> Result<Distance, QueryError> {
    let bodies = difference.bodies;
    let near = found.near_points(difference);
    let plane = found.separating_plane(difference);
    let beyond = plane.map_or(0.0, |plane| plane.excess);
    let plane = plane.filter(|plane| plane.gap.gap > 0.0);
    let lower = plane.map_or(0.0, |plane| plane.gap.gap);
    let tolerance = MAX_BOUND_GAP * difference.noise.point_error() + beyond;
    if near.distance - lower > tolerance {
        let reason = Stalled::Distance { lower, upper: near.distance, tolerance };
        return Err(QueryError::NotConverged { reason });
    }
    let [on_moving, on_fixed] = bodies.core_points(&near.pairs, &near.weights);
    let distance = Distance {
        lower,
        upper: near.distance,
        on_moving,
        on_fixed,
        normal: plane.map(|plane| plane.gap.normal),
        features: plane
            .map(|plane| facing_features(bodies, &plane, difference.noise.point_error())),
        near,
        gap: plane.map(|plane| plane.gap),
        steps: found.steps(),
    };
    Ok(if bodies.is_rounded() { rounded::distance(bodies, distance) } else { distance })
}

/// Returns the nearest points of the moving and of the fixed body, in the world, rounded.
///
/// Those of rounded bodies are on the round surfaces. If the bodies meet, both are one point of both bodies.
#[inline]
pub fn nearest_points_in_world(bodies: &TwoBodies, near: &NearPoints) -> [DVec3; 2] {
    let cores = bodies.core_points(&near.pairs, &near.weights);
    rounded::surface_points(bodies, cores, near.distance, DVec3::ZERO)
}

/// Returns the features of the bodies in the planes perpendicular to the normal of `plane`. `noise` is the
/// tolerance of coplanarity, in world units.
fn facing_features(bodies: &TwoBodies, plane: &GapPlane, noise: f64) -> Features {
    let normal = plane.gap.normal;
    let VertexPair { moving, fixed } = plane.lowest;
    let [out, back] = [bodies.moving_normal(normal), -bodies.fixed_normal(normal)];
    Features {
        moving: feature_in_plane(bodies.moving, out, moving.0, noise)
            .with_input_numbers(bodies.moving),
        fixed: feature_in_plane(bodies.fixed, back, fixed.0, noise)
            .with_input_numbers(bodies.fixed),
    }
}
