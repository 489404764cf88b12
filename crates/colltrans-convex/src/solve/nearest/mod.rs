//! Nearest points of two convex bodies, and a plane between the bodies, with proven bounds of the distance.
//!
//! `M = {q - p}` is in the setting frame: the axes of the world, the origin at the moving body's translation. `v` is
//! its point nearest to the origin and `n` a unit normal. [`gjk`] descends to `v` over simplices of points of `M`, in
//! rounded numbers, and again in numbers of twice the precision if the bounds remain apart. `docs/theory/distance.md`
//! explains the choice of planes and the width of the bounds.
//!
//! Invariant: the bounds hold for the plane and the points that are returned, regardless of how these were found.
//! - *Upper*: the points are weighted means of vertices. Their distance is raised by its rounding error
//!   ([`Noise::mean_length_margin`]).
//! - *Lower*: the height along a rounded unit normal is lowered by one noise and by the excess of the bodies beyond the
//!   support points ([`TwoBodies::support_with_excess`]). Near contact, if this bound is not positive, the heights of
//!   all vertices are computed nearly without rounding ([`TwoBodies::input_core_gap`]).

mod closed_form;
mod depth;
mod gjk;
mod point_bounds;
mod point_start;
pub mod simplex;
mod winding;

use glam::{DMat3, DVec3};

pub(crate) use self::depth::penetration_depth;
use self::gjk::{Goal, descend_to_nearest, unit_vector};
use self::simplex::{Corner, Simplex};
pub(crate) use self::winding::surrounds_origin;
use crate::answer::{NearPoints, PlaneGap, Steps};
use crate::body::Inertia;
use crate::setting::{TwoBodies, VertexPair};
use colltrans_kernel::noise::Noise;
use colltrans_kernel::plane::triangle_normal;
use colltrans_kernel::real::{DoubleWord, Real, RealVector};
use colltrans_kernel::symmetric::Symmetric;
use colltrans_kernel::volume::{contains_origin, weights_of_origin};

/// Maximum computed distance, in noises, of bodies that are near contact.
const MAX_NEAR_CONTACT: f64 = 4.0;

/// Maximum number of Newton steps for a guess from ellipsoids (measured).
const MAX_GUESS_STEPS: usize = 6;
/// Error `|f(t)^2 - 1|` below which a guess from ellipsoids is accepted.
const GUESS_TOLERANCE: f64 = 0.01;

/// The Minkowski difference `M` in the setting frame.
pub struct Difference<'a> {
    pub bodies: &'a TwoBodies<'a>,
    pub noise: Noise,
}

impl<'a> Difference<'a> {
    /// Builds the difference of two placed bodies, with their noise.
    #[inline]
    pub fn new(bodies: &'a TwoBodies<'a>) -> Self {
        Self { bodies, noise: bodies.noise() }
    }

    /// Returns the point of `M` of a vertex pair.
    #[inline]
    fn point(&self, pair: VertexPair) -> DVec3 {
        self.bodies.difference_point(pair)
    }

    /// Returns the point of `M` that is lowest along `normal`. Starts the search at `near`, if given.
    #[inline]
    fn support_point(&self, normal: DVec3, near: Option<VertexPair>) -> Corner<f64> {
        let bodies = self.bodies;
        self.corner_at(
            self.climbed_pair(&[bodies.moving_normal(normal), bodies.fixed_normal(normal)], near),
        )
    }

    /// Returns the vertex pair at which a climb along a normal stops. The normal is given in the frames of the moving
    /// and of the fixed body.
    #[inline]
    fn climbed_pair(&self, normals: &[DVec3; 2], near: Option<VertexPair>) -> VertexPair {
        let bodies = self.bodies;
        let (in_moving, in_fixed) = (normals[0], -normals[1]);
        let (moving, fixed) = match near {
            Some(near) => (
                bodies.moving.support_point_from(in_moving, near.moving.0),
                bodies.fixed.support_point_from(in_fixed, near.fixed.0),
            ),
            None => (bodies.moving.support(in_moving).0, bodies.fixed.support(in_fixed).0),
        };
        VertexPair::from_indices(moving, fixed)
    }

    /// Returns the vertex pair that is lowest along `normal` (setting frame, any length).
    #[inline]
    pub fn support_pair(&self, normal: DVec3) -> VertexPair {
        self.support_point(normal, None).pair
    }

    /// Returns the point of `M` of a vertex pair, as a corner of a simplex.
    #[inline]
    fn corner_at(&self, pair: VertexPair) -> Corner<f64> {
        Corner { at: RealVector(self.point(pair).to_array()), pair }
    }

    /// Returns the vector from the centre of the moving body to that of the fixed one.
    fn center_offset(&self) -> DVec3 {
        let bodies = self.bodies;
        let [p, q] = [bodies.moving.inertia().center, bodies.fixed.inertia().center];
        bodies.fixed_matrix * q - bodies.moving_matrix * p + bodies.offset
    }

    /// Returns the vertex pair from which to start a search for the depth: the support pair along the line of centres.
    ///
    /// The polytope that grows from this pair is wide. A start near the shortest separating translation would not
    /// give a wide one.
    pub(crate) fn depth_start(&self) -> NearestPairs {
        let pair = self.support_point(direction_or_x(self.center_offset()), None).pair;
        NearestPairs { pairs: [pair; 3], count: 1 }
    }

    /// Guesses the direction from the moving to the fixed body (setting frame, any length).
    ///
    /// The guess approximates the normal of the nearest points of the inertia ellipsoids. For bodies that resemble
    /// balls it is the line of centres.
    fn guessed_direction(&self) -> DVec3 {
        let bodies = self.bodies;
        let [p, q] = [bodies.moving.inertia(), bodies.fixed.inertia()];
        let center = self.center_offset();
        if bodies.moving.is_like_ball() && bodies.fixed.is_like_ball() {
            return direction_or_x(center);
        }
        let ellipsoid = |inertia: &Inertia, rotation: &DMat3| {
            Symmetric::gram_matrix(&inertia.transposed_factor_product(&rotation.transpose()))
        };
        let [a, b] = [ellipsoid(p, &bodies.moving_matrix), ellipsoid(q, &bodies.fixed_matrix)];
        direction_or_x(ellipsoid_gap_normal(&a, &b, center, q.radius / p.radius))
    }
}

/// Returns `v`, or `X` if `v` is zero or not finite.
#[inline]
fn direction_or_x(v: DVec3) -> DVec3 {
    if v.length_squared() > 0.0 && v.is_finite() { v } else { DVec3::X }
}

/// Approximates the normal at the nearest points of two ellipsoids with the matrices `A` and `B`, whose centres
/// differ by `c`.
///
/// One ellipsoid `K = (1 + r) A + (1 + 1/r) B` replaces both. It contains their sum, and touches it along `y` if
/// `r^2 = y.B y / y.A y`. Its point nearest to the origin is `t y`, where `(K + t) y = c` and `f(t) = sqrt(y.K y) = 1`.
/// Newton's method is applied to `1 / f`, which is nearly linear, and exactly linear for a ball. Each step updates `r`.
#[inline]
fn ellipsoid_gap_normal(a: &Symmetric, b: &Symmetric, center: DVec3, mut r: f64) -> DVec3 {
    let (mut t, mut normal) = (0.0_f64, center);
    for _ in 0..MAX_GUESS_STEPS {
        let k = a.linear_combination(1.0 + r, b, 1.0 + 1.0 / r);
        let (inverse, det) = k.plus_diagonal(t).adjugate();
        let y = inverse.times_vector(center) * (1.0 / det);
        let ky = k.times_vector(y);
        let square = y.dot(ky);
        let slope = ky.dot(inverse.times_vector(y)) * (1.0 / det);
        let next = t + (square.sqrt() - 1.0) * square / slope;
        let ratio = (b.quadratic_form(y) / a.quadratic_form(y)).sqrt();
        if !(next.is_finite() && ratio > 0.0 && ratio.is_finite()) {
            break;
        }
        (t, r, normal) = (next.max(0.0), ratio, y);
        if (square - 1.0).abs() < GUESS_TOLERANCE {
            break;
        }
    }
    normal
}

/// Up to three vertex pairs from which a descent starts: those with which an earlier one ended.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct NearestPairs {
    pairs: [VertexPair; 3],
    count: usize,
}

impl NearestPairs {
    /// Checks whether there is no pair, so that a descent starts from scratch.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Iterates over the pairs.
    fn iter(&self) -> impl Iterator<Item = VertexPair> + '_ {
        self.pairs[..self.count].iter().copied()
    }
}

/// The best plane and the best points of a descent.
#[derive(Debug, Clone, Copy)]
pub struct DescentResult {
    /// Computed gap of the plane.
    lower: f64,
    /// Unit normal of the plane (setting frame).
    normal: DVec3,
    /// Vertex pair lowest along the normal, as a climb has found it, or verified.
    lowest: Option<VertexPair>,
    /// Bound on the distance that the bodies reach beyond this pair. `None` until the pair is verified.
    excess: Option<f64>,
    /// Computed distance of the points.
    upper: f64,
    /// Vertex pairs of the points. Those with a weight are first; the others are not used.
    pairs: [VertexPair; 4],
    /// Weights of the pairs.
    weights: [f64; 4],
    /// Whether four pairs seem to enclose the origin.
    full: bool,
    /// Number of support points computed.
    pub supports: u32,
}

impl DescentResult {
    /// Returns a result with infinite bounds, without a plane and points.
    fn unbounded() -> Self {
        Self {
            lower: f64::NEG_INFINITY,
            normal: DVec3::ZERO,
            lowest: None,
            excess: None,
            upper: f64::INFINITY,
            pairs: [VertexPair::default(); 4],
            weights: [0.0; 4],
            full: false,
            supports: 0,
        }
    }

    /// Stores the point of `simplex`, if it is nearer than the stored one.
    #[inline]
    fn record_point<T: Real>(&mut self, distance: f64, simplex: &Simplex<T>) {
        if distance < self.upper {
            self.upper = distance;
            (self.pairs, self.weights) = simplex.pairs_and_weights();
            self.full = simplex.is_full();
        }
    }

    /// Stores four pairs that enclose the origin, with its weights.
    fn record_enclosure(&mut self, pairs: [VertexPair; 4], weights: [f64; 4]) {
        (self.upper, self.pairs, self.weights, self.full) = (0.0, pairs, weights, true);
    }

    /// Stores the plane perpendicular to the unit vector `normal` at `lowest`, if its gap exceeds the stored one.
    #[inline]
    fn record_plane(&mut self, normal: DVec3, lowest: &Corner<f64>) {
        let lower = normal.dot(lowest.at.to_dvec3());
        if lower > self.lower || self.lowest.is_none() {
            self.lower = lower;
            self.normal = normal;
            self.lowest = Some(lowest.pair);
            self.excess = None;
        }
    }

    /// Verifies the vertex pair of the plane, and replaces it if the climb to it had stopped short. Computes the excess
    /// beyond the pair.
    #[inline]
    fn verify_plane(&mut self, difference: &Difference) {
        let Some(pair) = self.lowest.filter(|_| self.excess.is_none()) else { return };
        let bodies = difference.bodies;
        let normals = [bodies.moving_normal(self.normal), bodies.fixed_normal(self.normal)];
        let (verified, excess) = bodies.support_with_excess(&normals, pair);
        (self.lowest, self.excess) = (Some(verified), Some(excess));
        if verified != pair {
            self.lower = self.normal.dot(difference.point(verified));
        }
    }

    /// Returns the work counts.
    #[inline]
    pub(crate) fn steps(&self) -> Steps {
        Steps { supports: self.supports, ..Steps::default() }
    }

    /// Returns the pairs from which a later descent may start.
    #[inline]
    pub fn start_pairs(&self) -> NearestPairs {
        let mut pairs = NearestPairs::default();
        for pair in self.weighted_pairs().take(3) {
            pairs.pairs[pairs.count] = pair;
            pairs.count += 1;
        }
        pairs
    }

    /// Iterates over the pairs with a positive weight, whose mean is the nearest point.
    fn weighted_pairs(&self) -> impl Iterator<Item = VertexPair> + '_ {
        let weighted = self.pairs.iter().zip(self.weights);
        weighted.filter(|(_, weight)| *weight > 0.0).map(|(pair, _)| *pair)
    }
}

/// Computes nearest points and a plane between the bodies, starting from the pairs `start`.
///
/// If `length` is given, ends as soon as the distance is decided to be smaller or larger.
#[inline]
pub(crate) fn nearest_points(
    difference: &Difference,
    start: &NearestPairs,
    length: Option<f64>,
) -> DescentResult {
    let noise = difference.noise.point_error();
    // The proven bounds are mostly weaker than the computed ones by these amounts.
    let thresholds = length.map(|length| [length + 3.0 * noise, length - 1.5 * noise]);
    search_until(difference, start, &Goal { max_gap: noise, thresholds, relative: None })
}

/// Computes nearest points and a plane to a relative accuracy, for bodies farther apart than the length `beyond`.
///
/// Ends as soon as the computed bounds differ by at most the fraction `share` of `lower - beyond`, or by one noise.
#[inline]
pub fn nearest_points_within_share(
    difference: &Difference,
    start: &NearestPairs,
    share: f64,
    beyond: f64,
) -> DescentResult {
    let relative = Some([share, beyond]);
    search_until(
        difference,
        start,
        &Goal { max_gap: difference.noise.point_error(), thresholds: None, relative },
    )
}

/// Computes nearest points in closed form if possible. Otherwise searches in up to three stages, until `goal` is
/// reached: by a descent in rounded numbers, by the plane of the simplex, and by a descent in numbers of twice the
/// precision.
#[inline]
fn search_until(difference: &Difference, start: &NearestPairs, goal: &Goal) -> DescentResult {
    if difference.is_of_rounded_segments()
        && let Some(found) = closed_form::nearest_of_segments(difference, goal)
    {
        return found;
    }
    let mut found =
        DescentResult { supports: u32::from(start.is_empty()), ..DescentResult::unbounded() };
    let simplex = starting_simplex(difference, start);
    descend_to_nearest::<f64>(difference, simplex, goal, &mut found);
    if !goal.is_reached(&found) {
        try_simplex_plane(difference, &mut found);
    }
    if !goal.is_reached(&found) {
        descend_in_twice_precision(difference, goal, &mut found);
    }
    found.verify_plane(difference);
    found
}

/// Returns the simplex of the given pairs. If there are none, returns that of a point and a polytope, or a support
/// point along the guessed direction.
fn starting_simplex(difference: &Difference, start: &NearestPairs) -> Simplex<f64> {
    let corners = start.iter().map(|pair| difference.corner_at(pair));
    Simplex::from_corners(corners)
        .or_else(|| point_start::starting_simplex(difference))
        .unwrap_or_else(|| {
            Simplex::new(difference.support_point(difference.guessed_direction(), None))
        })
}

/// Computes the plane perpendicular to the simplex, and keeps it if its gap is larger.
fn try_simplex_plane(difference: &Difference, found: &mut DescentResult) {
    let Some(normal) = simplex_normal(difference, found) else { return };
    let normal = if normal.dot(found.normal) < 0.0 { -normal } else { normal };
    let lowest = difference.support_point(normal, found.lowest);
    found.supports += 1;
    found.record_plane(normal, &lowest);
    found.verify_plane(difference);
}

/// Computes the unit normal of a simplex of two or three points. The edges are differences of vertices of each body,
/// not of points of `M`, because rounding then changes the normal of a simplex with short edges less.
///
/// `None` if the simplex has another number of points, or if the normal has no length.
fn simplex_normal(difference: &Difference, found: &DescentResult) -> Option<DVec3> {
    let bodies = difference.bodies;
    let NearestPairs { pairs: [a, b, c], count } = found.start_pairs();
    let normal = match count {
        2 => {
            let edge = bodies.displacement_between(a, b);
            let nearest =
                difference.point(a) * found.weights[0] + difference.point(b) * found.weights[1];
            nearest - edge * (nearest.dot(edge) / edge.length_squared())
        }
        3 => triangle_normal([
            DVec3::ZERO,
            bodies.displacement_between(a, b),
            bodies.displacement_between(a, c),
        ]),
        _ => return None,
    };
    unit_vector(normal)
}

/// Continues the descent in numbers of twice the precision, which resolve ties within rounding error.
#[cold]
#[inline(never)]
fn descend_in_twice_precision(difference: &Difference, goal: &Goal, found: &mut DescentResult) {
    let corners = found.weighted_pairs().take(3).map(|pair| double_word_corner(difference, pair));
    if let Some(simplex) = Simplex::from_corners(corners) {
        descend_to_nearest(difference, simplex, goal, found);
    }
}

/// Returns the point of `M` of a vertex pair in numbers of twice the precision, as a corner of a simplex.
fn double_word_corner(difference: &Difference, pair: VertexPair) -> Corner<DoubleWord> {
    Corner { at: difference.bodies.terms(pair).double_word_point(), pair }
}

/// A plane between the bodies.
#[derive(Debug, Clone, Copy)]
pub struct GapPlane {
    /// Gap that the plane proves, if it is positive.
    pub gap: PlaneGap,
    /// Vertex pair lowest along the normal.
    pub(crate) lowest: VertexPair,
    /// Bound on the distance that the bodies, and the points that they were built from, reach beyond this pair.
    pub(crate) excess: f64,
}

impl DescentResult {
    /// Returns the best plane, with a proven gap. `None` if no plane was verified.
    #[inline]
    pub fn gap_plane(&self, difference: &Difference) -> Option<GapPlane> {
        let (normal, lowest, excess) = (self.normal, self.lowest?, self.excess?);
        let gap = (self.lower - difference.noise.lower_bound_margin() - excess).next_down();
        Some(GapPlane { gap: PlaneGap { normal, gap }, lowest, excess })
    }

    /// Returns the best plane. If its gap is not positive and the bodies are near contact, tries planes whose gaps are
    /// computed nearly without rounding ([`Self::sharpest_plane`]).
    #[inline]
    pub(crate) fn separating_plane(&self, difference: &Difference) -> Option<GapPlane> {
        let plane = self.gap_plane(difference);
        let is_open = plane.is_none_or(|plane| plane.gap.gap <= 0.0);
        let is_near = self.upper <= MAX_NEAR_CONTACT * difference.noise.point_error();
        if is_open && is_near { self.sharpest_plane(difference).or(plane) } else { plane }
    }

    /// Returns the best of three planes by the gap that verification computes ([`TwoBodies::input_core_gap`]).
    ///
    /// The normals are that of the simplex (or of its first point) in both senses, and that of the stored plane. `None`
    /// if no gap is positive, or the simplex has no normal.
    #[cold]
    #[inline(never)]
    fn sharpest_plane(&self, difference: &Difference) -> Option<GapPlane> {
        let first =
            self.weighted_pairs().next().and_then(|pair| unit_vector(difference.point(pair)));
        let normal = simplex_normal(difference, self).or(first)?;
        let planes = [normal, -normal, self.normal]
            .into_iter()
            .filter_map(unit_vector)
            .map(|normal| PlaneGap { normal, gap: difference.bodies.input_core_gap(normal) });
        let gap = planes.max_by(|a, b| a.gap.total_cmp(&b.gap)).filter(|plane| plane.gap > 0.0)?;
        let lowest = difference.support_point(gap.normal, self.lowest).pair;
        Some(GapPlane { gap, lowest, excess: 0.0 })
    }

    /// Returns the difference of the computed bounds, where the lower bound counts as at least 0.
    pub(crate) fn computed_gap(&self) -> f64 {
        self.upper - self.lower.max(0.0)
    }

    /// Returns the nearest points as up to three vertex pairs and their weights. Unused weights are 0. If four pairs
    /// enclose the origin, the points are those of the nearest of their faces.
    #[inline]
    pub fn weighted_pairs_and_weights(
        &self,
        difference: &Difference,
    ) -> ([VertexPair; 3], [f64; 3]) {
        if self.weights[3] > 0.0 {
            return self.nearest_face(difference);
        }
        first_three_weighted(&self.pairs, &self.weights)
    }

    /// Returns the point of the faces of the four pairs that is nearest to the origin.
    #[cold]
    fn nearest_face(&self, difference: &Difference) -> ([VertexPair; 3], [f64; 3]) {
        let corners = self.pairs.map(|pair| double_word_corner(difference, pair));
        let mut simplex = Simplex::new(corners[0]);
        corners[1..].iter().for_each(|corner| simplex.push(*corner));
        simplex.reduce_to_face();
        let (pairs, weights) = simplex.pairs_and_weights();
        first_three_weighted(&pairs, &weights)
    }

    /// Returns the nearest points with the proven upper bound of the distance. The bound is 0 if four pairs are proven
    /// to enclose the origin.
    #[inline]
    pub(crate) fn near_points(&self, difference: &Difference) -> NearPoints {
        let Self { mut pairs, weights, .. } = *self;
        for k in 1..4 {
            if weights[k] == 0.0 {
                pairs[k] = pairs[0];
            }
        }
        let bodies = difference.bodies;
        if self.full && contains_origin(&pairs.map(|pair| bodies.terms(pair)), bodies.size()) {
            return common_point(difference, pairs, weights);
        }
        let is_near = self.upper <= MAX_NEAR_CONTACT * difference.noise.point_error();
        let common = if is_near { self.points_around_origin(difference) } else { None };
        common.unwrap_or_else(|| {
            let distance = (self.upper + difference.noise.mean_length_margin()).next_up();
            NearPoints { pairs, weights, distance }
        })
    }

    /// Completes the simplex to four pairs that enclose the origin, with support points along the axes.
    ///
    /// Needed if the origin lies on a simplex of fewer pairs up to rounding, as for aligned boxes. `None` if no
    /// choice encloses the origin.
    #[cold]
    #[inline(never)]
    fn points_around_origin(&self, difference: &Difference) -> Option<NearPoints> {
        let bodies = difference.bodies;
        let axes = DVec3::AXES.into_iter().flat_map(|axis| [axis, -axis]);
        let axis_pairs: Vec<VertexPair> =
            axes.map(|normal| difference.support_point(normal, None).pair).collect();
        let (corners, mut weights) = (self.weighted_pairs().count(), [0.0; 4]);
        let given = self.weights.iter().filter(|weight| **weight > 0.0);
        weights.iter_mut().zip(given).for_each(|(place, weight)| *place = *weight);
        // Each choice is a set of the six support points, as bits.
        let choices = (0_u32..1 << 6).filter(|bits| corners + bits.count_ones() as usize == 4);
        let mut completions = choices.map(|bits| {
            let more = (0..6).filter(|k| bits >> k & 1 == 1).map(|k| axis_pairs[k]);
            let mut pairs = [VertexPair::default(); 4];
            pairs
                .iter_mut()
                .zip(self.weighted_pairs().chain(more))
                .for_each(|(place, pair)| *place = pair);
            pairs
        });
        let pairs = completions
            .find(|pairs| contains_origin(&pairs.map(|pair| bodies.terms(pair)), bodies.size()))?;
        Some(common_point(difference, pairs, weights))
    }
}

/// Returns the first three pairs with a positive weight. Unused weights are 0.
#[inline]
fn first_three_weighted(
    pairs: &[VertexPair; 4],
    weights: &[f64; 4],
) -> ([VertexPair; 3], [f64; 3]) {
    let mut points = ([pairs[0]; 3], [0.0; 3]);
    let weighted = pairs.iter().zip(weights).filter(|(_, weight)| **weight > 0.0);
    for (k, (pair, weight)) in weighted.take(3).enumerate() {
        (points.0[k], points.1[k]) = (*pair, *weight);
    }
    points
}

/// Returns the common point of bodies, given four pairs that enclose the origin.
///
/// If the pairs are nearly coplanar, rounded weights leave the points of both bodies apart by more than a noise. Then
/// exact volumes yield the weights.
fn common_point(
    difference: &Difference,
    pairs: [VertexPair; 4],
    mut weights: [f64; 4],
) -> NearPoints {
    let apart: DVec3 = pairs.iter().zip(weights).map(|(p, w)| difference.point(*p) * w).sum();
    if apart.length() > difference.noise.point_error() {
        let corners = pairs.map(|pair| difference.bodies.terms(pair));
        weights = weights_of_origin(&corners).unwrap_or(weights);
    }
    NearPoints { pairs, weights, distance: 0.0 }
}
