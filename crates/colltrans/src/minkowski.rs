//! The Minkowski difference `M = {q - p : p in P, q in Q}`, seen along the direction.
//!
//! Notation. The *shadow frame* has two lateral axes `e1, e2` and `d` at length 1; a point of `M` has the coordinates
//! `(s1, s2, h)`: its shadow `s` and its height `h`. The line `t d` is the axis `s = 0`; the collision translation is the lowest
//! height at which it meets `M`.
//!
//! Rounding. With `u = 2^-53` and `S = reach_P + reach_Q + |offset|`, a coordinate of a point of `M` is a sum of three
//! dot products. Rotating a lateral axis into a body costs a relative error of at most `3 u` in each component, the dot product `3 u`, adding the
//! three parts `2 u`, the axis itself `2 u`: together less than `10 u S sqrt(3) < 18 u S`. [`Difference::noise`] is `32 u S`, which also covers comparing
//! two such coordinates along a unit normal of the frame.

use glam::{DMat3, DVec2, DVec3};

use crate::certificate::VertexPair;
use crate::setting::Setting;

/// A vertex of `M`, in the shadow frame, and the pair of vertices it comes from.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Point {
    pub(crate) at: DVec3,
    pub(crate) pair: VertexPair,
}

impl Point {
    pub(crate) fn shadow(&self) -> DVec2 {
        self.at.truncate()
    }

    pub(crate) fn height(&self) -> f64 {
        self.at.z
    }
}

/// `M` in the shadow frame: support points and orientations.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Difference<'a> {
    pub(crate) setting: &'a Setting<'a>,
    /// Columns `e1, e2, d` in the setting frame.
    pub(crate) axes: DMat3,
    /// The same columns in the moving body's frame.
    moving_axes: DMat3,
    /// The same columns in the fixed body's frame.
    fixed_axes: DMat3,
    /// `offset` in the shadow frame.
    offset: DVec3,
    /// Bound on the rounding error of a coordinate of a point.
    pub(crate) noise: f64,
    /// Half-side of a square by which `M` is widened sideways: 0, or a little more than the rounding error when shadows
    /// only touch, so that the line passes through the widened body.
    pub(crate) widening: f64,
}

impl<'a> Difference<'a> {
    pub(crate) fn new(setting: &'a Setting<'a>) -> Self {
        let (e1, e2) = setting.unit.any_orthonormal_pair();
        let axes = DMat3::from_cols(e1, e2, setting.unit);
        Self {
            setting,
            axes,
            moving_axes: setting.moving_matrix.transpose() * axes,
            fixed_axes: setting.fixed_matrix.transpose() * axes,
            offset: axes.transpose() * setting.offset,
            noise: Self::noise_of(setting),
            widening: 0.0,
        }
    }

    /// Bound on the rounding error of a coordinate of a point of `M`, and of comparing two along a unit normal.
    pub(crate) fn noise_of(setting: &Setting) -> f64 {
        16.0 * f64::EPSILON * setting.scale()
    }

    /// The same body, widened sideways.
    pub(crate) fn widened(&self, widening: f64) -> Self {
        Self { widening, ..*self }
    }

    /// The point of `M` that is lowest along `normal` (shadow frame, any length).
    pub(crate) fn support(&self, normal: DVec3) -> Point {
        let moving = self.setting.moving.support(self.moving_axes * normal);
        let fixed = self.setting.fixed.support(-(self.fixed_axes * normal));
        self.point(VertexPair { moving, fixed }, normal)
    }

    /// The same, climbing from a pair believed to be near.
    pub(crate) fn support_from(&self, normal: DVec3, near: VertexPair) -> Point {
        let moving = self.setting.moving.support_from(self.moving_axes * normal, near.moving);
        let fixed = self.setting.fixed.support_from(-(self.fixed_axes * normal), near.fixed);
        self.point(VertexPair { moving, fixed }, normal)
    }

    fn point(&self, pair: VertexPair, normal: DVec3) -> Point {
        let p = self.setting.moving.vertices()[pair.moving as usize];
        let q = self.setting.fixed.vertices()[pair.fixed as usize];
        let mut at =
            (transposed(&self.fixed_axes, q) - transposed(&self.moving_axes, p)) + self.offset;
        if self.widening != 0.0 {
            at.x -= self.widening.copysign(normal.x);
            at.y -= self.widening.copysign(normal.y);
        }
        Point { at, pair }
    }

    /// The ellipsoid that `M` resembles: its centre and matrix in the shadow frame.
    ///
    /// The Minkowski sum of two ellipsoids with matrices `A, B` lies in the ellipsoid with matrix
    /// `K = (1 + r) A + (1 + 1/r) B`, for any `r > 0`; `r^2 = tr B / tr A` makes the sum of its squared axes least.
    pub(crate) fn ellipsoid(&self) -> (DVec3, DMat3) {
        let (moving, fixed) = (self.setting.moving.measure(), self.setting.fixed.measure());
        let center = (transposed(&self.fixed_axes, fixed.center)
            - transposed(&self.moving_axes, moving.center))
            + self.offset;
        let a = self.moving_axes.transpose() * (moving.shape * self.moving_axes);
        let b = self.fixed_axes.transpose() * (fixed.shape * self.fixed_axes);
        let r = (trace(&fixed.shape) / trace(&moving.shape)).sqrt();
        (center, a * (1.0 + r) + b * (1.0 + 1.0 / r))
    }

    /// Whether the line passes to the left (`true`) or to the right of the directed segment between two shadows.
    ///
    /// The sign is exact for the coordinates of the points. Where the line meets the segment's
    /// carrier, it is moved, in thought, by `(eps, eps^2)`: so it is never *on* a segment, and three
    /// consistent answers always mean a triangle that contains it.
    pub(crate) fn is_left(from: &Point, to: &Point) -> bool {
        let (a, b) = (from.shadow(), to.shadow());
        let coord = |v: DVec2| robust::Coord { x: v.x, y: v.y };
        // The expansion of orient(a, b, (eps, eps^2)) in powers of eps.
        let det = robust::orient2d(coord(a), coord(b), coord(DVec2::ZERO));
        if det != 0.0 {
            return det > 0.0;
        }
        if a.y != b.y { a.y > b.y } else { b.x > a.x }
    }
}

/// `m^T v`.
fn transposed(m: &DMat3, v: DVec3) -> DVec3 {
    DVec3::new(m.x_axis.dot(v), m.y_axis.dot(v), m.z_axis.dot(v))
}

fn trace(m: &DMat3) -> f64 {
    m.x_axis.x + m.y_axis.y + m.z_axis.z
}
