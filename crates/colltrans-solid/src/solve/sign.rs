//! Signs of determinants of points: exact, by a filter first.
//!
//! With `x, y, z` differences of two points, each of whose coordinates is off by at most
//! `e = 2 noise`, and sizes in the sum norm (plane) or the maximum norm (space), the rounded
//! determinant is off by at most
//! `2 e (|x| + |y| + e) + 8 u |x| |y|` in the plane and
//! `8 e (|y||z| + |x||z| + |x||y| + e (|x| + |y| + |z|) + e^2) + 48 u |x||y||z|` in space.
//! Where that cannot tell, coordinates that are exact in `f64` go to the adaptive predicates of the
//! `robust` crate, others to numbers of twice the precision, and what these leave in doubt to whole numbers.

use std::cmp::Ordering;

use glam::{DVec2, DVec3, Vec3Swizzles};

use super::scene::{ExactPoint, Scene};
use colltrans_kernel::fine::{self, Fine};
use colltrans_kernel::integer::{Integer, LARGE, SMALL, determinant, difference};
use colltrans_kernel::predicates::{orient2d, orient3d, sign};

const U: f64 = f64::EPSILON / 2.0;

/// The sign of a number that has room for all there are.
fn decided(number: &Integer<LARGE>) -> Ordering {
    number.sign().unwrap_or(Ordering::Equal)
}

/// `det[b - a, c - a, d]` in shadow coordinates, and a bound of its error.
#[inline]
pub(crate) fn rough_turn(scene: &Scene, a: DVec3, b: DVec3, c: DVec3) -> (f64, f64) {
    let e = 2.0 * scene.noise;
    let (x, y) = ((b - a).xy(), (c - a).xy());
    let (m, n) = (x.x.abs() + x.y.abs(), y.x.abs() + y.y.abs());
    (x.perp_dot(y), 2.0 * e * (m + n + e) + 8.0 * U * m * n)
}

impl Scene<'_> {
    /// Sign of `det[b - a, c - a, d]`: which way the shadows turn.
    pub(crate) fn turn(
        &self,
        a: &impl ExactPoint,
        b: &impl ExactPoint,
        c: &impl ExactPoint,
    ) -> Ordering {
        let (value, error) = rough_turn(self, a.at(), b.at(), c.at());
        if value.abs() > error {
            return sign(value);
        }
        if a.is_exact() && b.is_exact() && c.is_exact() {
            return sign(orient2d(a.at().xy(), b.at().xy(), c.at().xy()));
        }
        self.turn_fine(a, b, c)
            .or_else(|| self.turn_wide::<SMALL>(a, b, c).sign())
            .unwrap_or_else(|| decided(&self.turn_wide::<LARGE>(a, b, c)))
    }

    /// Sign of `det[b - a, c - a, e - a]`: whether `e` is on the outer side of the facet `a b c`.
    pub fn outside(
        &self,
        a: &impl ExactPoint,
        b: &impl ExactPoint,
        c: &impl ExactPoint,
        e: &impl ExactPoint,
    ) -> Ordering {
        let noise = 2.0 * self.noise;
        let p = a.at();
        let [x, y, z] = [b.at() - p, c.at() - p, e.at() - p];
        let [l, m, n] = [x, y, z].map(|v| v.abs().max_element());
        let value = x.cross(y).dot(z);
        let pairs = l * m + m * n + n * l;
        let error = 8.0 * noise * (pairs + noise * (l + m + n + noise)) + 48.0 * U * l * m * n;
        if value.abs() > error {
            return sign(value);
        }
        if a.is_exact() && b.is_exact() && c.is_exact() && e.is_exact() {
            return sign(orient3d(p, b.at(), c.at(), e.at()));
        }
        if let (Some(a), Some(b), Some(c), Some(e)) =
            (a.world(self), b.world(self), c.world(self), e.world(self))
        {
            return sign(orient3d(a, b, c, e));
        }
        self.outside_fine(a, b, c, e)
            .or_else(|| self.outside_wide::<SMALL>(a, b, c, e).sign())
            .unwrap_or_else(|| decided(&self.outside_wide::<LARGE>(a, b, c, e)))
    }

    /// Points as seen from another, itself.
    pub(crate) fn spans_wide<const N: usize>(
        &self,
        from: &impl ExactPoint,
        points: [&impl ExactPoint; 3],
    ) -> [[Integer<N>; 3]; 3] {
        let p = from.wide(self);
        points.map(|q| difference(&q.wide(self), &p))
    }

    /// Sign of `det[b - a, c - a, e - a]` if twice the usual precision tells it.
    fn outside_fine(
        &self,
        a: &impl ExactPoint,
        b: &impl ExactPoint,
        c: &impl ExactPoint,
        e: &impl ExactPoint,
    ) -> Option<Ordering> {
        let (p, ends) = (a.fine(self), [b.fine(self), c.fine(self), e.fine(self)]);
        fine::determinant_sign(ends.each_ref().map(|q| p.to(q)))
    }

    /// Sign of `det[b - a, c - a, d]`, likewise.
    fn turn_fine(
        &self,
        a: &impl ExactPoint,
        b: &impl ExactPoint,
        c: &impl ExactPoint,
    ) -> Option<Ordering> {
        let [p, q, r] = [a.fine(self), b.fine(self), c.fine(self)];
        let d = Fine::exactly(self.setting.direction);
        fine::determinant_sign([p.to(&q), p.to(&r), Fine::ORIGIN.to(&d)])
    }

    /// Sign of `det[b - a, c - a, e]`, likewise.
    fn turn_about_fine(
        &self,
        axis: usize,
        a: &impl ExactPoint,
        b: &impl ExactPoint,
        c: &impl ExactPoint,
    ) -> Option<Ordering> {
        let [p, q, r] = [a.fine(self), b.fine(self), c.fine(self)];
        fine::minor_sign([p.to(&q), p.to(&r)], [(axis + 1) % 3, (axis + 2) % 3])
    }

    /// `det[b - a, c - a, e - a]` itself.
    fn outside_wide<const N: usize>(
        &self,
        a: &impl ExactPoint,
        b: &impl ExactPoint,
        c: &impl ExactPoint,
        e: &impl ExactPoint,
    ) -> Integer<N> {
        let p = a.wide(self);
        let [x, y, z] = [b.wide(self), c.wide(self), e.wide(self)].map(|q| difference(&q, &p));
        determinant(&x, &y, &z)
    }

    /// `det[b - a, c - a, d]` itself.
    fn turn_wide<const N: usize>(
        &self,
        a: &impl ExactPoint,
        b: &impl ExactPoint,
        c: &impl ExactPoint,
    ) -> Integer<N> {
        let (p, d) = (a.wide(self), self.setting.direction.to_array().map(Integer::number));
        let (x, y) = (difference(&b.wide(self), &p), difference(&c.wide(self), &p));
        determinant(&x, &y, &d)
    }

    /// Sign of `det[b - a, c - a, e]` with `e` the unit vector of an axis of the world.
    #[inline]
    pub fn turn_about(
        &self,
        axis: usize,
        a: &impl ExactPoint,
        b: &impl ExactPoint,
        c: &impl ExactPoint,
    ) -> Ordering {
        if let (Some(a), Some(b), Some(c)) = (a.world(self), b.world(self), c.world(self)) {
            let drop = |p: DVec3| DVec2::new(p[(axis + 1) % 3], p[(axis + 2) % 3]);
            return sign(orient2d(drop(a), drop(b), drop(c)));
        }
        let (value, error) = self.rough_turn_about(axis, a.at(), b.at(), c.at());
        if value.abs() > error {
            return sign(value);
        }
        self.turn_about_fine(axis, a, b, c)
            .or_else(|| self.turn_about_wide::<SMALL>(axis, a, b, c).sign())
            .unwrap_or_else(|| decided(&self.turn_about_wide::<LARGE>(axis, a, b, c)))
    }

    /// From the query frame, whose axes are orthogonal to within a few `u`: turned back, a coordinate
    /// is off by two noises.
    fn rough_turn_about(&self, axis: usize, a: DVec3, b: DVec3, c: DVec3) -> (f64, f64) {
        let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
        let back = self.frame.transpose();
        let (x, y) = (back * (b - a), back * (c - a));
        let (m, n, e) = (x[i].abs() + x[j].abs(), y[i].abs() + y[j].abs(), 4.0 * self.noise);
        (x[i] * y[j] - x[j] * y[i], 2.0 * e * (m + n + e) + 8.0 * U * m * n)
    }

    fn turn_about_wide<const N: usize>(
        &self,
        axis: usize,
        a: &impl ExactPoint,
        b: &impl ExactPoint,
        c: &impl ExactPoint,
    ) -> Integer<N> {
        let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
        let p = a.wide(self);
        let (x, y) = (difference(&b.wide(self), &p), difference(&c.wide(self), &p));
        x[i].multiply(&y[j]).subtract(&x[j].multiply(&y[i]))
    }

    /// Sign of `(b - a).(e x d)` with `e` the unit vector of an axis of the world: how
    /// `det[b - a, c - a, d]` changes when `c` moves along that axis.
    pub(crate) fn drift(&self, axis: usize, a: &impl ExactPoint, b: &impl ExactPoint) -> Ordering {
        let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
        let x = difference::<LARGE>(&b.wide(self), &a.wide(self));
        let d = self.setting.direction.to_array().map(Integer::number);
        // det[x, e, d] with e along `axis`: x_j d_i - x_i d_j, up to the order of axes.
        decided(&x[j].multiply(&d[i]).subtract(&x[i].multiply(&d[j])))
    }

    /// How `a` and `b` are ordered along an axis of the world.
    pub(crate) fn order(&self, axis: usize, a: &impl ExactPoint, b: &impl ExactPoint) -> Ordering {
        if let (Some(a), Some(b)) = (a.world(self), b.world(self)) {
            return sign(a[axis] - b[axis]);
        }
        let rough = (self.frame.transpose() * (a.at() - b.at()))[axis];
        if rough.abs() > 4.0 * self.noise {
            return sign(rough);
        }
        let fine = b.fine(self).to(&a.fine(self)).sign_along(axis);
        fine.unwrap_or_else(|| decided(&a.wide::<LARGE>(self)[axis].subtract(&b.wide(self)[axis])))
    }
}
