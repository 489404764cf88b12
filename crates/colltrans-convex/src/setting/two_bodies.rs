//! Two placed bodies in the *setting frame*: the axes of the world, the origin at the moving body's
//! translation.
//!
//! Notation: a vertex `v` of `P` is at `p = R_P v`, a vertex `v` of `Q` at `q = R_Q v + offset`, with
//! `offset = t_Q - t_P`. A common displacement of both bodies therefore costs no accuracy, however large it
//! is.

use derive_where::derive_where;
use glam::{DMat3, DVec3};

use crate::body::{ConvexPolyhedron, Placed, Pose, VertexHull};
use crate::setting::VertexPair;
use colltrans_kernel::error_free::{difference_error, sum_error};
use colltrans_kernel::height_bounds;
use colltrans_kernel::noise::Noise;
use colltrans_kernel::orientation::PointTerms;
use colltrans_kernel::pose::MAX_STRETCH;
use colltrans_kernel::range::MIN_MAGNITUDE;

/// Returns lower and upper bounds of a sum, equal if it is exact.
#[inline]
fn sum_bounds(a: f64, b: f64) -> [f64; 2] {
    let sum = a + b;
    match sum_error(a, b, sum) {
        0.0 => [sum; 2],
        error if error > 0.0 => [sum, sum.next_up()],
        _ => [sum.next_down(), sum],
    }
}

/// Two placed bodies in the setting frame.
#[derive(Debug)]
#[derive_where(Clone, Copy)]
pub struct TwoBodies<'a, B = ConvexPolyhedron> {
    /// The moving body `P`.
    pub moving: &'a B,
    /// Rotation `R_P` of the moving body.
    pub moving_matrix: DMat3,
    /// The fixed body `Q`.
    pub fixed: &'a B,
    /// Rotation `R_Q` of the fixed body.
    pub fixed_matrix: DMat3,
    /// Translations `[t_P, t_Q]` in the world.
    pub translations: [DVec3; 2],
    /// `t_Q - t_P`, rounded.
    pub offset: DVec3,
    /// Rounding error of `offset`. For unmoved bodies `offset + offset_error` is exactly `t_Q - t_P`.
    offset_error: DVec3,
}

impl<'a, B> TwoBodies<'a, B> {
    /// Computes the offset of two placed bodies and its rounding error.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "a copy through memory stalls its reader")]
    pub fn new(moving: Placed<'a, B>, fixed: Placed<'a, B>) -> Self {
        let translations = [moving.pose.translation(), fixed.pose.translation()];
        let [t_p, t_q] = translations;
        Self {
            moving: moving.body,
            moving_matrix: moving.pose.matrix(),
            fixed: fixed.body,
            fixed_matrix: fixed.pose.matrix(),
            translations,
            offset: t_q - t_p,
            offset_error: DVec3::new(
                difference_error(t_q.x, t_p.x),
                difference_error(t_q.y, t_p.y),
                difference_error(t_q.z, t_p.z),
            ),
        }
    }

    /// Returns the moving body with its pose in the world.
    #[inline]
    pub fn moving_placed(&self) -> Placed<'a, B> {
        let pose = Pose::from_checked_entries(self.moving_matrix, self.translations[0]);
        Placed { body: self.moving, pose }
    }

    /// Returns the fixed body with its pose in the world.
    #[inline]
    pub fn fixed_placed(&self) -> Placed<'a, B> {
        let pose = Pose::from_checked_entries(self.fixed_matrix, self.translations[1]);
        Placed { body: self.fixed, pose }
    }

    /// Returns the bodies after a translation of the moving one by `by`. Only the offset changes, not
    /// `translations`.
    ///
    /// The sum of the new offset and its error is the exact offset up to little more than the last digit of
    /// the error.
    pub(crate) fn moved_by(&self, by: DVec3) -> Self {
        let [mut offset, mut error] = [self.offset, self.offset_error];
        for k in 0..3 {
            let low = error[k] + difference_error(offset[k], by[k]);
            let high = offset[k] - by[k];
            offset[k] = high + low;
            let lost = sum_error(high, low, offset[k]);
            // A remainder below the exact range is negligible compared with the rounding of `by`.
            error[k] = if lost.abs() < MIN_MAGNITUDE { 0.0 } else { lost };
        }
        Self { offset, offset_error: error, ..*self }
    }

    /// Returns the bodies with new `rotations`, translated by `by`, each for the moving and the fixed body.
    ///
    /// A coordinate of the new offset below [`MIN_MAGNITUDE`] becomes 0.
    #[must_use]
    #[inline]
    pub fn with_poses_moved(&self, rotations: [DMat3; 2], by: [DVec3; 2]) -> Self {
        let mut moved = self.moved_by(by[0] - by[1]);
        for k in 0..3 {
            if moved.offset[k].abs() < MIN_MAGNITUDE {
                moved.offset[k] = 0.0;
            }
        }
        let [p, q] = self.translations;
        let [moving_matrix, fixed_matrix] = rotations;
        Self { moving_matrix, fixed_matrix, translations: [p + by[0], q + by[1]], ..moved }
    }

    /// Returns other bodies in the poses of these.
    #[inline]
    pub fn with_bodies<'b, C>(&self, [moving, fixed]: [&'b C; 2]) -> TwoBodies<'b, C> {
        let Self { moving_matrix, fixed_matrix, translations, offset, offset_error, .. } = *self;
        TwoBodies { moving, moving_matrix, fixed, fixed_matrix, translations, offset, offset_error }
    }

    /// Returns `t_Q - t_P` as a rounded value and its error.
    #[inline]
    pub fn offset_and_error(&self) -> [DVec3; 2] {
        [self.offset, self.offset_error]
    }
}

impl<B: VertexHull> TwoBodies<'_, B> {
    /// Returns the size `S` of the configuration. It bounds `|q - p|` over all points of the bodies, except for
    /// rounding and the stretch of the poses by a factor of at most `MAX_STRETCH`.
    #[inline]
    pub fn size(&self) -> f64 {
        self.moving.reach() + self.fixed.reach() + self.offset.length()
    }

    /// Returns the bounds on rounding errors for the size `S`.
    #[inline]
    pub fn noise(&self) -> Noise {
        Noise::for_size(self.size())
    }

    /// Returns a lower bound of `min_Q n.q - max_P n.p` for `n = normal`, accurate to little more than one
    /// rounding. Takes `O(n)` steps, because it examines all corners.
    #[inline]
    pub fn distance_along(&self, normal: DVec3) -> f64 {
        let fixed = (self.fixed.hull_vertices(), &self.fixed_matrix);
        let moving = (self.moving.hull_vertices(), &self.moving_matrix);
        height_bounds::distance_lower_bound(normal, fixed, moving, self.offset_and_error())
    }

    /// Returns lower and upper bounds of the sum of both radii, equal if it is exact. `None` if no body is rounded.
    #[inline]
    fn radii_bounds(&self) -> Option<[f64; 2]> {
        let [r, s] = [self.moving.radius(), self.fixed.radius()];
        (r + s != 0.0).then(|| sum_bounds(r, s))
    }

    /// Checks whether a body is rounded.
    #[inline]
    pub fn is_rounded(&self) -> bool {
        self.moving.radius() + self.fixed.radius() != 0.0
    }

    /// Returns lower and upper bounds of the sum of `min_gap` and the radii of both bodies, in world units. They
    /// are equal if the sum is exact.
    ///
    /// The distance of rounded bodies is at least `min_gap` where that of their cores is at least this sum.
    #[inline]
    pub fn core_gap_bounds(&self, min_gap: f64) -> [f64; 2] {
        match self.radii_bounds() {
            None => [min_gap; 2],
            Some(radii) if min_gap == 0.0 => radii,
            Some([low, high]) => [sum_bounds(low, min_gap)[0], sum_bounds(high, min_gap)[1]],
        }
    }

    /// Returns the gap that the plane with this normal proves between the cores of the bodies, in world units,
    /// rounded down.
    #[inline]
    fn proven_core_gap(&self, normal: DVec3) -> f64 {
        let [_, square] = height_bounds::dot_bounds(normal, normal);
        (self.distance_along(normal) / square.sqrt().next_up()).next_down()
    }

    /// Returns the gap that the plane with this normal proves between the bodies, in world units, rounded
    /// down. A check accepts any gap up to this one.
    #[inline]
    pub fn proven_gap(&self, normal: DVec3) -> f64 {
        self.less_radii(self.proven_core_gap(normal))
    }

    /// Returns a gap of the cores less both radii, rounded down; the gap itself if no body is rounded.
    #[inline]
    pub fn less_radii(&self, core_gap: f64) -> f64 {
        self.radii_bounds().map_or(core_gap, |[_, radii]| (core_gap - radii).next_down())
    }

    /// Returns an upper bound of the distance of the cores less both radii, rounded up; 0 if that is negative, and the
    /// bound itself if no body is rounded.
    #[inline]
    pub fn distance_less_radii(&self, of_cores: f64) -> f64 {
        match self.radii_bounds() {
            None => of_cores,
            Some([radii, _]) if of_cores <= radii => 0.0,
            Some([radii, _]) => (of_cores - radii).next_up(),
        }
    }

    /// Returns the gap that the plane with this normal proves between the inputs of the cores of the bodies, in
    /// world units.
    ///
    /// It is the gap of the cores less [`Self::input_excess`].
    #[inline]
    pub fn input_core_gap(&self, normal: DVec3) -> f64 {
        let (gap, excess) = (self.proven_core_gap(normal), self.input_excess());
        if excess == 0.0 { gap } else { (gap - excess).next_down() }
    }

    /// Returns the gap that the plane with this normal proves between the inputs of the bodies, in world
    /// units: [`Self::input_core_gap`] less both radii. A search claims this gap.
    #[inline]
    pub fn input_gap(&self, normal: DVec3) -> f64 {
        self.less_radii(self.input_core_gap(normal))
    }

    /// Returns the points of the surfaces of the rounded bodies that correspond to points of their cores, in the
    /// world: each moved by its body's radius towards the other body, along the unit vector `normal`.
    #[inline]
    pub fn surface_points_along(&self, [p, q]: [DVec3; 2], normal: DVec3) -> [DVec3; 2] {
        if !self.is_rounded() {
            return [p, q];
        }
        [p + normal * self.moving.radius(), q - normal * self.fixed.radius()]
    }

    /// Returns [`Self::surface_points_along`] the direction between the points, after the moving body is translated by
    /// `by`. `normal` replaces this direction if the points coincide.
    #[inline]
    pub fn surface_points(&self, [p, q]: [DVec3; 2], by: DVec3, normal: DVec3) -> [DVec3; 2] {
        if !self.is_rounded() {
            return [p, q];
        }
        self.surface_points_along([p, q], (q - (p + by)).try_normalize().unwrap_or(normal))
    }

    /// Returns a bound on the sum of the distances by which input points lie outside of their bodies, in
    /// world units.
    #[inline]
    pub fn input_excess(&self) -> f64 {
        (self.moving.input_excess() + self.fixed.input_excess()) * MAX_STRETCH
    }
}

impl TwoBodies<'_> {
    /// Returns the weighted sums of several pairs' vertices in the world, rounded: a point of each core. See
    /// [`Self::weighted_points`].
    #[inline]
    pub(crate) fn core_points<const N: usize>(
        &self,
        pairs: &[VertexPair; N],
        weights: &[f64; N],
    ) -> [DVec3; 2] {
        let [p, q] = self.weighted_points(pairs, weights);
        let origin = self.translations[0];
        [self.moving_matrix * p + origin, self.fixed_matrix * q + self.offset + origin]
    }

    /// Returns the vertices of a pair, in the frames of the moving and of the fixed body.
    #[inline]
    pub(crate) fn vertices(&self, pair: VertexPair) -> [DVec3; 2] {
        [self.moving.vertices()[pair.moving.index()], self.fixed.vertices()[pair.fixed.index()]]
    }

    /// Returns the weighted sums of several pairs' vertices, in the frames of the moving and of the fixed
    /// body. They are means if the weights have sum 1.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "a copy through memory stalls its reader")]
    pub fn weighted_points<const N: usize>(
        &self,
        pairs: &[VertexPair; N],
        weights: &[f64; N],
    ) -> [DVec3; 2] {
        let mut means = [DVec3::ZERO; 2];
        for (pair, &weight) in pairs.iter().zip(weights).filter(|(_, weight)| **weight != 0.0) {
            let [p, q] = self.vertices(*pair);
            means = [means[0] + p * weight, means[1] + q * weight];
        }
        means
    }

    /// Computes the point `q - p` of a pair of vertices, in the setting frame, with an error below `9 u S`.
    #[inline]
    pub fn difference_point(&self, pair: VertexPair) -> DVec3 {
        let [p, q] = self.vertices(pair);
        self.fixed_matrix * q - self.moving_matrix * p + self.offset
    }

    /// Computes the vector from the point `q - p` of one pair to that of another. Its error is a few `u` of
    /// the distances between the vertices of each body.
    #[inline]
    pub(crate) fn displacement_between(&self, from: VertexPair, to: VertexPair) -> DVec3 {
        let ([p, q], [r, s]) = (self.vertices(from), self.vertices(to));
        self.fixed_matrix * (s - q) - self.moving_matrix * (r - p)
    }

    /// Transforms a normal from the setting frame to the moving body's frame: `n.(R v) = (R^T n).v`.
    #[inline]
    pub(crate) fn moving_normal(&self, normal: DVec3) -> DVec3 {
        self.moving_matrix.transpose() * normal
    }

    /// Transforms a normal from the setting frame to the fixed body's frame.
    #[inline]
    pub(crate) fn fixed_normal(&self, normal: DVec3) -> DVec3 {
        self.fixed_matrix.transpose() * normal
    }

    /// Returns support points along a unit normal, and a bound on how far the bodies and their inputs reach
    /// towards each other beyond these points.
    ///
    /// `normals` holds the normal in the frames of the moving and of the fixed body. `found` is the result of
    /// a hill climb.
    #[inline]
    pub(crate) fn support_with_excess(
        &self,
        normals: &[DVec3; 2],
        found: VertexPair,
    ) -> (VertexPair, f64) {
        let (moving, p) = self.moving.support_with_excess(normals[0], found.moving.0);
        let (fixed, q) = self.fixed.support_with_excess(-normals[1], found.fixed.0);
        (VertexPair::from_indices(moving, fixed), p + q + self.input_excess())
    }

    /// Returns the sum of products that defines `q - p` for a pair of vertices, for exact evaluation.
    pub(crate) fn terms(&self, pair: VertexPair) -> PointTerms<'_> {
        let [p, q] = self.vertices(pair);
        PointTerms {
            fixed: (&self.fixed_matrix, q),
            moving: (&self.moving_matrix, p),
            offset: [self.offset, self.offset_error],
        }
    }
}
