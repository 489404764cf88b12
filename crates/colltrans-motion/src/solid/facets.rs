//! Two facets in motion: their distance, and proofs that they cross.
//!
//! - *Distance*: that of two triangles in closed form ([`triangle`]). Its plane is only a guess; a sample claims the
//!   gap that the plane proves.
//! - *Minimum gap and radii*: facets meet where points of their cores are not farther apart than the sum of the minimum
//!   gap and both radii.
//! - *Crossing*: an edge of one facet passes through the other. The signs of five volumes prove it if they hold for all
//!   positions within the error of computed points.
//! - *Error of a volume*: points of both facets have errors below `e`, from rounding and motion. The volume of vectors
//!   `x, y, z` between them has an error below `8 e (|y||z| + |x||z| + |x||y| + e (|x| + |y| + |z| + e)) + 48 u
//!   |x||y||z|` in the maximum norm.

use glam::DVec3;

use super::super::answer::MotionSteps;
use super::super::curvature::VertexScan;
use super::super::proof::FacetContactProof;
use super::super::relative_motion::RelativeMotion;
use super::super::sample::{Sample, Sampler, closing_speed};
use super::super::search::{SpanEnd, SpanResult, prove_span};
use super::super::span::Span;
use super::tree::Facet;
use colltrans_convex::answer::are_weights;
use colltrans_convex::body::VertexHull;
use colltrans_convex::setting::TwoBodies;
use colltrans_kernel::pose::MAX_STRETCH;
use colltrans_solid::solve::nearest::triangle::{self, Corners, GAP_NOISES, LENGTH_NOISES};

/// Samples distances of two facets.
#[derive(Debug, Clone, Default)]
pub(super) struct FacetSampler {
    pub(super) steps: MotionSteps,
}

/// Returns the corners of both facets in the setting frame.
pub(super) fn placed_corners(bodies: &TwoBodies<'_, Facet>) -> [Corners; 2] {
    let [f, g] = [bodies.moving.corners, bodies.fixed.corners];
    [f.map(|v| bodies.moving_matrix * v), g.map(|v| bodies.fixed_matrix * v + bodies.offset)]
}

impl Sampler<Facet> for FacetSampler {
    type Met = FacetContactProof;
    type SupportSearch = VertexScan;
    const SUPPORT_SEARCH: VertexScan = VertexScan;

    fn sample<'a, C>(&mut self, motion: &C, time: f64) -> Sample<'a, C::Moved, Facet>
    where
        C: RelativeMotion<'a, Body = Facet>,
    {
        self.steps.looks += 1;
        let at = motion.instant_at(time);
        let noise = at.bodies.noise().point_error();
        let [f, g] = placed_corners(&at.bodies);
        let found = triangle::nearest_points(&f, &g, noise);
        let gap = at.bodies.less_radii(found.gap - GAP_NOISES * noise)
            - motion.min_gap()
            - motion.position_error();
        let [p, q] = [at.bodies.moving.corners, at.bodies.fixed.corners];
        let points = [
            triangle::weighted_point(&p, found.weights[0]),
            triangle::weighted_point(&q, found.weights[1]),
        ];
        let (normal, floor) = (found.normal, 4.0 * noise + motion.position_error());
        let rate = if gap > 0.0 { closing_speed(motion, &at, points, normal) } else { 0.0 };
        Sample { at, normal, gap, rate, points, floor }
    }

    fn prove_contact<'a, C>(&mut self, motion: &C, time: f64) -> Option<FacetContactProof>
    where
        C: RelativeMotion<'a, Body = Facet>,
    {
        self.steps.looks += 1;
        let bodies = motion.instant_at(time).bodies;
        prove_contact(&bodies, [motion.min_gap(), motion.position_error()])
    }
}

/// Proves that two facets meet, for a minimum gap and an error of their places. Returns `None` if that is not proven.
pub(super) fn prove_contact(
    bodies: &TwoBodies<'_, Facet>,
    gap_and_error: [f64; 2],
) -> Option<FacetContactProof> {
    if bodies.core_gap_bounds(gap_and_error[0])[0] > 0.0 {
        let [f, g] = placed_corners(bodies);
        let weights = triangle::nearest_points(&f, &g, bodies.noise().point_error()).weights;
        let met = FacetContactProof::Near { weights: weights.map(|w| w.to_array()) };
        return is_contact_proven(bodies, gap_and_error, met).then_some(met);
    }
    let off = bodies.noise().point_error() + gap_and_error[1];
    let [f, g] = placed_corners(bodies);
    [(true, f, g), (false, g, f)].into_iter().find_map(|(moving, own, other)| {
        let sides = own.map(|corner| side_of_facet(corner, other, off));
        let crosses = |edge: &u8| {
            let ends = [*edge as usize, (*edge as usize + 1) % 3];
            let [below, above] = ends.map(|k| sides[k]);
            are_opposite(below, above) && passes_inside(ends.map(|k| own[k]), other, off)
        };
        (0..3).find(crosses).map(|edge| FacetContactProof::Crossing { moving, edge })
    })
}

/// Checks whether two facets are proven to meet by the given proof, for a minimum gap and an error of their places.
pub(super) fn is_contact_proven(
    bodies: &TwoBodies<'_, Facet>,
    [min_gap, error]: [f64; 2],
    met: FacetContactProof,
) -> bool {
    let (noise, [f, g]) = (bodies.noise().point_error(), placed_corners(bodies));
    // That of the facets plus their radii, rounded down.
    let core_gap = bodies.core_gap_bounds(min_gap)[0];
    match met {
        FacetContactProof::Crossing { moving, edge } => {
            let (own, other) = if moving { (f, g) } else { (g, f) };
            let (k, off) = (edge as usize, noise + error);
            k < 3
                && core_gap == 0.0
                && segment_crosses_triangle(own[k], own[(k + 1) % 3], other, off)
        }
        FacetContactProof::Near { weights } => {
            let length = triangle::weighted_distance(&f, &g, weights.map(DVec3::from_array));
            weights.iter().all(|weights| are_weights(&weights[..]))
                && length + LENGTH_NOISES * noise + error <= core_gap
        }
        // These proofs are about whole solids, not about two facets.
        FacetContactProof::Inside { .. } | FacetContactProof::Contained { .. } => false,
    }
}

/// Checks whether a segment passes through a triangle for all positions of its points within `e`.
fn segment_crosses_triangle(p: DVec3, q: DVec3, triangle: Corners, e: f64) -> bool {
    let [below, above] = [p, q].map(|end| side_of_facet(end, triangle, e));
    are_opposite(below, above) && passes_inside([p, q], triangle, e)
}

/// Returns the side of the plane of a triangle on which a point lies, for all positions within `e`; 0 if that is not
/// certain.
fn side_of_facet(point: DVec3, [a, b, c]: Corners, e: f64) -> i32 {
    volume_sign([b - a, c - a, point - a], e)
}

/// Checks whether two sides are certain and opposite.
fn are_opposite(below: i32, above: i32) -> bool {
    below != 0 && below + above == 0
}

/// Checks whether the line through a segment passes through a triangle for all positions of its points within `e`.
fn passes_inside([p, q]: [DVec3; 2], [a, b, c]: Corners, e: f64) -> bool {
    let relative_velocity = q - p;
    let turns =
        [(a, b), (b, c), (c, a)].map(|(u, v)| volume_sign([relative_velocity, u - p, v - p], e));
    turns[0] != 0 && turns == [turns[0]; 3]
}

/// Returns the sign of the volume of three vectors between points with the error `e`; 0 if it is not certain.
fn volume_sign([x, y, z]: [DVec3; 3], e: f64) -> i32 {
    let [l, m, n] = [x, y, z].map(|v| v.abs().max_element());
    let value = x.cross(y).dot(z);
    let pairs = l * m + m * n + n * l;
    let rounded = 24.0 * f64::EPSILON * l * m * n;
    let error = 8.0 * e * (pairs + e * (l + m + n + e)) + rounded;
    if value.abs() > error { value.signum() as i32 } else { 0 }
}

/// Number of equal intervals at whose ends two facets are sampled until they are separated.
const SAMPLES: i32 = 8;
/// Number of bisections of the interval before the first sample at which they are separated.
const BISECTIONS: i32 = 40;

/// Time from an ignored contact to the next sample, as a share of the span. It doubles at each such contact.
const FIRST_RETRY_SHARE: f64 = 1e-9;
/// Maximum of this share.
const MAX_RETRY_SHARE: f64 = 1e-3;

/// Relative rounding error of a computed speed along a normal.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// Maximum cosine between normal and direction of motion at which a facet counts as parallel to the motion.
const MIN_COSINE: f64 = 1e-12;

/// A contact that begins after two facets were separated.
#[derive(Debug, Clone, Copy)]
pub(super) struct LaterContact {
    /// Time up to which they are separated, from the last time on at which the search found them separated.
    pub(super) lower: f64,
    /// Whether a search took its maximum number of steps, so that it is open whether they meet.
    pub(super) is_open: bool,
    /// Time of a proven contact and the proof.
    pub(super) met: Option<(f64, FacetContactProof)>,
}

/// Finds the first contact of two facets that begins within a span while they face each other. `sided` states which
/// facets have an outer side. Facets that are not separated at the start of the span are ignored until they are. An
/// exception are facets that may only touch at the start of the motion.
///
/// `None` is proven, except for times at which facets count as ignored: up to the sampled time at which they are
/// separated, and for at most a thousandth of the span after a contact at which they do not face each other.
pub(super) fn find_later_contact(
    span: &Span<Facet>,
    sided: [bool; 2],
    sampler: &mut FacetSampler,
) -> Option<LaterContact> {
    let begins = span.from == 0.0 && !sampler.sample(span, 0.0).is_apart();
    if begins
        && sampler.prove_contact(span, 0.0).is_none()
        && face_each_other(span, 0.0, sided, sampler)
    {
        return Some(LaterContact { lower: 0.0, is_open: false, met: None });
    }
    if never_face_each_other(span, sided) {
        return None;
    }
    let mut from = find_separation_from(span, span.from, sampler)?;
    let duration = span.to - span.from;
    let mut skipped = FIRST_RETRY_SHARE * duration;
    loop {
        let part = span.restricted_to([from, span.to]);
        let SpanResult { planes, end } = prove_span(&part, sampler);
        let lower = planes.last().map_or(from, |plane| plane.time);
        let found = match end {
            SpanEnd::Free => return None,
            SpanEnd::Met(time, met) => {
                LaterContact { lower, is_open: false, met: Some((time, met)) }
            }
            SpanEnd::Indeterminate => LaterContact { lower, is_open: false, met: None },
            SpanEnd::Stalled => LaterContact { lower, is_open: true, met: None },
        };
        // Facets are separated where the search took its maximum number of steps: there is no contact to ignore.
        if found.is_open || face_each_other(span, lower, sided, sampler) {
            return Some(found);
        }
        let after = found.met.map_or(lower, |(time, _)| time) + skipped;
        from = find_separation_from(span, after, sampler)?;
        skipped = (2.0 * skipped).min(MAX_RETRY_SHARE * duration);
    }
}

/// Returns the first sampled time, from `from` on, at which two facets are separated, refined by bisection. Returns
/// `None` if there is none.
fn find_separation_from(span: &Span<Facet>, from: f64, sampler: &mut FacetSampler) -> Option<f64> {
    if from > span.to {
        return None;
    }
    let time = |k: i32| from + (span.to - from) * (f64::from(k) / f64::from(SAMPLES));
    let mut is_apart = |time: f64| sampler.sample(span, time).is_apart();
    let first = (0..=SAMPLES).find(|k| is_apart(time(*k)))?;
    if first == 0 {
        return Some(from);
    }
    let [mut low, mut high] = [time(first - 1), time(first).min(span.to)];
    for _ in 0..BISECTIONS {
        let middle = low + 0.5 * (high - low);
        *(if is_apart(middle) { &mut high } else { &mut low }) = middle;
    }
    Some(high)
}

/// Checks whether each facet that has an outer side moves, relative to the other one, along its own outward normal.
/// Facets without an outer side always pass.
fn face_each_other(
    span: &Span<Facet>,
    time: f64,
    sided: [bool; 2],
    sampler: &mut FacetSampler,
) -> bool {
    let at = span.instant_at(time);
    let [f, g] = placed_corners(&at.bodies);
    sampler.steps.looks += 1;
    let weights = triangle::nearest_points(&f, &g, at.bodies.noise().point_error()).weights;
    let bodies = [at.bodies.moving.corners, at.bodies.fixed.corners];
    let speed =
        |k: usize| span.point_velocity(&at, k, triangle::weighted_point(&bodies[k], weights[k]));
    // Velocity of the moving facet relative to the fixed one.
    let relative_velocity = speed(0) - speed(1);
    let normal = |[a, b, c]: Corners| (b - a).cross(c - a);
    let is_towards = |n: DVec3, relative_velocity: DVec3| {
        n.dot(relative_velocity) > MIN_COSINE * n.length() * relative_velocity.length()
    };
    (!sided[0] || is_towards(normal(f), relative_velocity))
        && (!sided[1] || is_towards(normal(g), -relative_velocity))
}

/// Checks whether it is proven that two facets do not face each other during a span, up to rounding errors: throughout
/// a motion, from 0 to 1, at these velocities the plane of a facet with an outer side would approach the other facet by
/// less than the error of a computed gap. This applies to facets that slide along each other.
///
/// The velocity of a point of a body is `u + w k x y`, where `y` leads from the axis to the point. The normal `n`
/// rotates with its own body `i`. Therefore `n . k_i` is constant, and `n` differs from a vector along `k_i` by at most
/// `|n x k_i|`.
fn never_face_each_other(span: &Span<Facet>, sided: [bool; 2]) -> bool {
    let noise = span.instant_at(span.from).bodies.noise().point_error();
    let max_approach = GAP_NOISES * noise + span.error;
    let approaches = |own: usize| {
        let [piece, other] = [span.piece(own), span.piece(1 - own)];
        let [a, b, c] = span.body(own).corners.map(|v| piece.start_pose.matrix() * v);
        let Some(normal) = (b - a).cross(c - a).try_normalize() else { return true };
        let velocity = piece.velocity - other.velocity;
        // Distance of all points from the axis of each body. The pose may stretch its body slightly.
        let [reach, other_reach] = [own, 1 - own].map(|k| {
            let piece = span.piece(k);
            piece.axis.cross(piece.arm).length() + MAX_STRETCH * span.body(k).reach()
        });
        let tilt = normal.cross(piece.axis).length();
        let (along, other_tilt) = if piece.rate == 0.0 {
            (normal.dot(velocity), normal.cross(other.axis).length())
        } else {
            let along =
                normal.dot(piece.axis) * piece.axis.dot(velocity) + tilt * velocity.length();
            (along, tilt + piece.axis.cross(other.axis).length())
        };
        let speed =
            along + tilt * piece.rate.abs() * reach + other_tilt * other.rate.abs() * other_reach;
        let rounding = ROUNDING
            * (velocity.length() + piece.rate.abs() * reach + other.rate.abs() * other_reach);
        speed + rounding > max_approach
    };
    (0..2).any(|own| sided[own] && !approaches(own))
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use colltrans_convex::body::{ConvexPolyhedron, Pose};
    use colltrans_kernel::motion::Motion;
    use colltrans_solid::StartOverlap;
    use colltrans_solid::body::Solid;

    use super::super::super::MotionCast;
    use super::super::super::clearance::MotionClearance;
    use super::super::super::span::split_into_spans;
    use super::*;

    /// Finds the first later contact of two facets along a motion of the first one.
    fn later_contact(facets: [&Facet; 2], motion: &Motion, rest: &Motion) -> Option<LaterContact> {
        let spans = split_into_spans(facets, [motion, rest], 0.0);
        find_later_contact(&spans[0], [true; 2], &mut FacetSampler::default())
    }

    /// The tip of a blade rises on a helix of 40 turns. In each turn it passes through a wall from behind, which is
    /// ignored. In the turns after the thirtieth it also runs into the front of the wall.
    #[test]
    fn contact_after_many_ignored_ones_is_found() {
        let tip =
            Facet::new([[0.97, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 0.0, 0.01]].map(DVec3::from), 0.0);
        let wall = Facet::new(
            [[0.5, -0.95, -0.5], [0.5, 1.5, 1.2], [0.5, -0.95, 1.5]].map(DVec3::from),
            0.0,
        );
        let [a, b, c] = wall.corners;
        assert!((b - a).cross(c - a).x > 0.0);
        let turn = glam::DQuat::from_rotation_z(-2.5);
        let start = Pose::new(turn, DVec3::ZERO).expect("a pose");
        let rest = Motion::at_rest(Pose::IDENTITY);
        for turns in [2.0, 40.0] {
            let motion = Motion::screw(start, DVec3::ZERO, DVec3::Z, turns * TAU, 1.0);
            // The tip has no outer side.
            let spans = split_into_spans([&tip, &wall], [&motion.expect("a motion"), &rest], 0.0);
            let found = find_later_contact(&spans[0], [false, true], &mut FacetSampler::default());
            let found = found.expect("the tip hits the front");
            // The height of the tip when it first hits the front, found by samples of its two corners.
            assert!(!found.is_open && (0.7..0.85).contains(&found.lower), "{found:?}");
        }
    }

    /// Facets slide along each other at distances about as large as rounding errors. Their contacts are ignored, and
    /// none of them may stop the motion or leave it open.
    #[test]
    fn facets_that_slide_within_rounding_errors_do_not_stop() {
        let f =
            Facet::new([[0.1, 0.2, 0.0], [1.3, 0.1, 0.0], [0.3, 1.7, 0.0]].map(DVec3::from), 0.0);
        let g = Facet::new(
            [[-4.1, -5.2, 0.0], [0.3, 5.7, 0.0], [6.3, -4.1, 0.0]].map(DVec3::from),
            0.0,
        );
        for tilt in [0.0, 0.3, 0.7] {
            let turn = glam::DQuat::from_euler(glam::EulerRot::ZYX, tilt, 2.0 * tilt, 0.5 * tilt);
            let up = turn * DVec3::Z;
            let rest = Motion::at_rest(Pose::new(turn, DVec3::ZERO).expect("a pose"));
            for k in 0..400 {
                let start = Pose::new(turn, up * (1e-16 * f64::from(k))).expect("a pose");
                let turned = Motion::rotation_about(start, DVec3::ZERO, up, 0.7);
                let moved = Motion::translation(start, turn * DVec3::new(0.9, 0.4, 0.0));
                for motion in [turned, moved] {
                    let found = later_contact([&f, &g], &motion.expect("a motion"), &rest);
                    assert!(found.is_none(), "{tilt} {k} {found:?}");
                }
            }
        }
    }

    /// A cube that overlaps another one is rotated out of it. Two pairs of their faces slide along each other.
    #[test]
    fn coplanar_faces_of_overlapping_cubes_do_not_stop() {
        let cube = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE).expect("a cube");
        let solid = Solid::from_pieces(&[cube]).expect("a solid");
        let start = Pose::from_translation(DVec3::Z * 0.75).expect("a pose");
        let rest = Motion::at_rest(Pose::IDENTITY);
        for (axis, turns) in [(DVec3::NEG_Y, 0.25), (DVec3::X, 0.25), (DVec3::NEG_Y, 0.1)] {
            let motion = Motion::rotation_about(start, DVec3::Z, axis, turns * TAU);
            let motion = motion.expect("a motion");
            let bodies = (solid.with_motion(&motion), solid.with_motion(&rest));
            let cast = MotionCast::between_any(bodies.0, bodies.1).expect("a cast");
            let found = cast.with_start_overlap(StartOverlap::Ignore).clearance();
            assert!(matches!(found, Ok(MotionClearance::Free(_))), "{axis} {turns} {found:?}");
        }
    }
}
