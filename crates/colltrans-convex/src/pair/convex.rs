//! Distances of two placed convex bodies.

use glam::{DMat3, DVec3};

use super::{PairProof, rounded, verify};
use crate::answer::{CertificateError, Distance, NearPoints, PlaneGap, StartedFrom, Steps, Within};
use crate::body::{ConvexPolyhedron, Features, OwnFeature, feature_in_plane};
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

    #[inline]
    fn distance_bounds(pair: &Pair<'_>) -> Result<[f64; 2], QueryError> {
        let bodies = &pair.bodies;
        let difference = Difference::new(bodies);
        let [core_gap, between_cores] = if let Some(bounds) = difference.point_bounds() {
            bounds
        } else {
            let found = nearest_points(&difference, &NearestPairs::default(), None);
            let (near, plane) = proofs_about_cores(&difference, &found)?;
            [plane.map_or(0.0, |plane| plane.gap.gap), near.distance]
        };
        Ok([bodies.less_radii(core_gap).max(0.0), bodies.distance_less_radii(between_cores)])
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
        let scratch = StartedFrom::Scratch;
        let answer = match decided {
            Some(decided) => decided,
            None => Within::Undecided(distance_of_search(&difference, &found, scratch)?),
        };
        Ok((answer, found.steps()))
    }

    fn verify_pair(pair: &Pair<'_>, proof: PairProof<'_>) -> Result<f64, CertificateError> {
        match proof {
            PairProof::Gap(plane) => verify::verify_plane(&pair.bodies, plane),
            PairProof::Near(points) => verify::verify_points(&pair.bodies, points),
            PairProof::Depth(depth) => verify::verify_depth(&pair.bodies, depth),
            PairProof::Enclosure(surface) => verify::enclosed_radius(&pair.bodies, surface),
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
    let started_from = if pairs.is_empty() { StartedFrom::Scratch } else { StartedFrom::Features };
    *pairs = found.start_pairs();
    distance_of_search(&difference, &found, started_from)
}

/// Returns the proofs of both bounds of the distance of the cores: points, and a plane if its gap is positive.
///
/// Returns [`QueryError::NotConverged`] if the bounds differ by more than rounding explains.
#[inline]
fn proofs_about_cores(
    difference: &Difference,
    found: &DescentResult,
) -> Result<(NearPoints, Option<GapPlane>), QueryError> {
    let near = found.near_points(difference);
    let plane = found.separating_plane(difference);
    let beyond = plane.map_or(0.0, |plane| plane.excess);
    let plane = plane.filter(|plane| plane.gap.gap > 0.0);
    let core_gap = plane.map_or(0.0, |plane| plane.gap.gap);
    let tolerance = MAX_BOUND_GAP * difference.noise.point_error() + beyond;
    if near.distance - core_gap > tolerance {
        let reason = Stalled::Distance { lower: core_gap, upper: near.distance, tolerance };
        return Err(QueryError::NotConverged { reason });
    }
    Ok((near, plane))
}

/// Builds the answer from a search result about the cores: the radii lower both bounds. The answer is built once, in the
/// return slot.
///
/// Returns [`QueryError::NotConverged`] if the bounds of the cores differ by more than rounding explains.
#[inline]
fn distance_of_search(
    difference: &Difference,
    found: &DescentResult,
    started_from: StartedFrom,
) -> Result<Distance, QueryError> {
    let bodies = difference.bodies;
    let noise = difference.noise.point_error();
    let (near, plane) = proofs_about_cores(difference, found)?;
    let core_gap = plane.map_or(0.0, |plane| plane.gap.gap);
    let cores = bodies.core_points(&near.pairs, &near.weights);
    let upper = bodies.distance_less_radii(near.distance);
    let steps = Steps { started_from, ..found.steps() };
    let near = NearPoints { distance: upper, ..near };
    let normal = plane.map_or(DVec3::ZERO, |plane| plane.gap.normal);
    let lower = bodies.less_radii(core_gap);
    let Some(plane) = plane.filter(|_| lower > 0.0) else {
        let [on_moving, on_fixed] = rounded::surface_points(bodies, cores, upper, normal);
        let (lower, normal, features, gap) = (0.0, None, None, None);
        let answer =
            Distance { lower, upper, on_moving, on_fixed, normal, features, near, gap, steps };
        return Ok(answer);
    };
    let [on_moving, on_fixed] = bodies.surface_points_along(cores, normal);
    Ok(Distance {
        lower,
        upper,
        on_moving,
        on_fixed,
        normal: Some(normal),
        features: Some(facing_features(bodies, normal, plane.lowest, noise)),
        near,
        gap: Some(PlaneGap { normal, gap: lower }),
        steps,
    })
}

/// Returns the nearest points of the moving and of the fixed body, in the world, rounded.
///
/// Those of rounded bodies are on the round surfaces. If the bodies meet, both are one point of both bodies.
#[inline]
pub fn nearest_points_in_world(bodies: &TwoBodies, near: &NearPoints) -> [DVec3; 2] {
    let cores = bodies.core_points(&near.pairs, &near.weights);
    rounded::surface_points(bodies, cores, near.distance, DVec3::ZERO)
}

/// Returns the features of the bodies in the planes perpendicular to a unit normal through the vertices of `lowest`.
/// `noise` is the tolerance of coplanarity, in world units.
#[inline]
fn facing_features(bodies: &TwoBodies, normal: DVec3, lowest: VertexPair, noise: f64) -> Features {
    let feature = |body: &ConvexPolyhedron, rotation: &DMat3, outward: DVec3, vertex: u32| {
        let own = if body.dimension() == 0 {
            OwnFeature::Vertex(vertex)
        } else {
            feature_in_plane(body, rotation.transpose() * outward, vertex, noise)
        };
        own.with_input_numbers(body)
    };
    Features {
        moving: feature(bodies.moving, &bodies.moving_matrix, normal, lowest.moving.0),
        fixed: feature(bodies.fixed, &bodies.fixed_matrix, -normal, lowest.fixed.0),
    }
}
