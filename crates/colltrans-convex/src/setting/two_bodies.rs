//! Two placed bodies, in the *setting frame*: the axes of the world, the origin at the moving body's
//! translation.
//!
//! `p = R_P v` and `q = R_Q v + offset` with `offset = t_Q - t_P`, so a common displacement of both
//! bodies, however large, costs no accuracy.

use derive_where::derive_where;
use glam::{DMat3, DVec3};

use crate::body::{ConvexPolyhedron, Hull, Placed, Pose};
use crate::setting::VertexPair;
use colltrans_kernel::error_free::{difference_error, sum_error};
use colltrans_kernel::extent;
use colltrans_kernel::noise::Noise;
use colltrans_kernel::orientation::Terms;
use colltrans_kernel::pose::STRETCHED;
use colltrans_kernel::range::MIN_MAGNITUDE;

/// Two placed bodies.
#[derive(Debug)]
#[derive_where(Clone, Copy)]
pub struct TwoBodies<'a, B = ConvexPolyhedron> {
    /// The moving body P.
    pub moving: &'a B,
    /// Its rotation `R_P`.
    pub moving_matrix: DMat3,
    /// The fixed body Q.
    pub fixed: &'a B,
    /// Its rotation `R_Q`.
    pub fixed_matrix: DMat3,
    /// `t_P` and `t_Q`.
    pub translations: [DVec3; 2],
    /// `t_Q - t_P`, rounded.
    pub offset: DVec3,
    /// What rounding took from `offset`, exactly.
    offset_error: DVec3,
}

impl<'a, B> TwoBodies<'a, B> {
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "passed through memory it stalls its reader")]
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

    /// The moving body where it is.
    #[inline]
    pub fn moving_placed(&self) -> Placed<'a, B> {
        let pose = Pose::checked(self.moving_matrix, self.translations[0]);
        Placed { body: self.moving, pose }
    }

    /// The fixed body where it is.
    #[inline]
    pub fn fixed_placed(&self) -> Placed<'a, B> {
        let pose = Pose::checked(self.fixed_matrix, self.translations[1]);
        Placed { body: self.fixed, pose }
    }

    /// The same with the moving body moved by so much: to hardly more than the last digit of the error.
    pub(crate) fn moved_by(&self, by: DVec3) -> Self {
        let [mut offset, mut error] = [self.offset, self.offset_error];
        for k in 0..3 {
            let low = error[k] + difference_error(offset[k], by[k]);
            let high = offset[k] - by[k];
            offset[k] = high + low;
            let lost = sum_error(high, low, offset[k]);
            // What is beyond the exact range is nothing beside the rounding of `by`.
            error[k] = if lost.abs() < MIN_MAGNITUDE { 0.0 } else { lost };
        }
        Self { offset, offset_error: error, ..*self }
    }

    /// The same bodies with other rotations, displaced by so much from where they are.
    #[must_use]
    #[inline]
    pub fn carried(&self, rotations: [DMat3; 2], by: [DVec3; 2]) -> Self {
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

    /// Other bodies in their places.
    #[inline]
    pub fn holding<'b, C>(&self, [moving, fixed]: [&'b C; 2]) -> TwoBodies<'b, C> {
        let Self { moving_matrix, fixed_matrix, translations, offset, offset_error, .. } = *self;
        TwoBodies { moving, moving_matrix, fixed, fixed_matrix, translations, offset, offset_error }
    }

    /// `t_Q - t_P`, and what rounding took from it.
    #[inline]
    pub fn exact_offset(&self) -> [DVec3; 2] {
        [self.offset, self.offset_error]
    }
}

impl<B: Hull> TwoBodies<'_, B> {
    /// The size `S` of the configuration: `|q - p|` is at most this for all its points.
    #[inline]
    pub fn scale(&self) -> f64 {
        self.moving.reach() + self.fixed.reach() + self.offset.length()
    }

    /// The bounds on rounding errors that belong to the size.
    #[inline]
    pub fn noise(&self) -> Noise {
        Noise::of(self.scale())
    }

    /// At most `min_Q n.q - max_P n.p`, and less by hardly more than a rounding: all corners are looked at.
    #[inline]
    pub fn distance_along(&self, normal: DVec3) -> f64 {
        let fixed = (self.fixed.corners(), &self.fixed_matrix);
        let moving = (self.moving.corners(), &self.moving_matrix);
        extent::distance(normal, fixed, moving, self.exact_offset())
    }

    /// The gap that a plane proves, in world units, rounded down: what a check accepts.
    #[inline]
    pub fn proven_gap(&self, normal: DVec3) -> f64 {
        let [_, square] = extent::dot(normal, normal);
        (self.distance_along(normal) / square.sqrt().next_up()).next_down()
    }

    /// The gap that a plane proves between the points that the bodies were made from: what a search claims.
    #[inline]
    pub fn input_gap(&self, normal: DVec3) -> f64 {
        let (gap, excess) = (self.proven_gap(normal), self.input_excess());
        if excess == 0.0 { gap } else { (gap - excess).next_down() }
    }

    /// How much nearer to each other points of both inputs may be than the bodies are, in the world.
    #[inline]
    pub fn input_excess(&self) -> f64 {
        (self.moving.input_excess() + self.fixed.input_excess()) * STRETCHED
    }
}

impl TwoBodies<'_> {
    /// A pair's vertices, in the frames of the moving and the fixed body.
    #[inline]
    pub(crate) fn vertices(&self, pair: VertexPair) -> [DVec3; 2] {
        [self.moving.vertices()[pair.moving.index()], self.fixed.vertices()[pair.fixed.index()]]
    }

    /// Means of several pairs' vertices by weight, in the frames of the moving and the fixed body.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "passed through memory they stall their reader")]
    pub fn weighted<const N: usize>(
        &self,
        pairs: &[VertexPair; N],
        weights: &[f64; N],
    ) -> [DVec3; 2] {
        let mut means = [DVec3::ZERO; 2];
        for (pair, &weight) in pairs.iter().zip(weights) {
            let [p, q] = self.vertices(*pair);
            means = [means[0] + p * weight, means[1] + q * weight];
        }
        means
    }

    /// The point `q - p` of a pair of vertices, off by less than `9 u S`.
    #[inline]
    pub fn difference(&self, pair: VertexPair) -> DVec3 {
        let [p, q] = self.vertices(pair);
        self.fixed_matrix * q - self.moving_matrix * p + self.offset
    }

    /// The way from one such point to another, off by a few `u` of how far the vertices are apart.
    #[inline]
    pub(crate) fn displacement_between(&self, from: VertexPair, to: VertexPair) -> DVec3 {
        let ([p, q], [r, s]) = (self.vertices(from), self.vertices(to));
        self.fixed_matrix * (s - q) - self.moving_matrix * (r - p)
    }

    /// A normal of the setting frame in the moving body's frame: `n.(R v) = (R^T n).v`.
    #[inline]
    pub(crate) fn moving_normal(&self, normal: DVec3) -> DVec3 {
        self.moving_matrix.transpose() * normal
    }

    /// A normal of the setting frame in the fixed body's frame.
    #[inline]
    pub(crate) fn fixed_normal(&self, normal: DVec3) -> DVec3 {
        self.fixed_matrix.transpose() * normal
    }

    /// A pair of support points along a unit normal, given in both bodies' frames, from one that climbs
    /// have found; and how far the bodies, and the points that they were made from, may reach towards each
    /// other beyond it.
    #[inline]
    pub(crate) fn support_with_excess(
        &self,
        normals: &[DVec3; 2],
        found: VertexPair,
    ) -> (VertexPair, f64) {
        let (moving, p) = self.moving.settled(normals[0], found.moving.0);
        let (fixed, q) = self.fixed.settled(-normals[1], found.fixed.0);
        (VertexPair::of(moving, fixed), p + q + self.input_excess())
    }

    /// `q - p` for a pair of vertices, as the sum of products that defines it.
    pub(crate) fn terms(&self, pair: VertexPair) -> Terms<'_> {
        let [p, q] = self.vertices(pair);
        Terms {
            fixed: (&self.fixed_matrix, q),
            moving: (&self.moving_matrix, p),
            offset: [self.offset, self.offset_error],
        }
    }
}
