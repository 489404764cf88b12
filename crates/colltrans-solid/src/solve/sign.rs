//! Exact signs of determinants of points, by a filter first.
//!
//! Each of `x, y, z` is the difference of two points. A coordinate of a point has an error of at most one noise, and a
//! coordinate of a difference an error of at most `e = 2 noise`. Let `|x|` be the sum norm in the plane and the maximum
//! norm in space. Then the rounded determinant has an error of at most
//! - `2 e (|x| + |y| + e) + 8 u |x| |y|` in the plane,
//! - `8 e (|y||z| + |x||z| + |x||y| + e (|x| + |y| + |z|) + e^2) + 48 u |x||y||z|` in space.
//!
//! If this does not decide the sign, coordinates that `f64` represents exactly use the adaptive predicates of the
//! `robust` crate. All others use double-double numbers, and then large integers.

use std::cmp::Ordering;

use glam::{DVec2, DVec3, Vec3Swizzles};

use super::scene::{ExactPoint, PairFrame};
use colltrans_kernel::extended::{self, ExtendedPoint};
use colltrans_kernel::integer::{Integer, LARGE_LIMBS, SMALL_LIMBS, determinant, difference};
use colltrans_kernel::predicates::{orient2d, orient3d, sign_of};

const U: f64 = f64::EPSILON / 2.0;

/// Returns the sign of a number whose size suffices for all inputs.
fn sign_of_large(number: &Integer<LARGE_LIMBS>) -> Ordering {
    number.sign().unwrap_or(Ordering::Equal)
}

/// Computes `det[b - a, c - a, d]` in shadow coordinates, and a bound on its error.
#[inline]
pub(crate) fn rough_turn(scene: &PairFrame, a: DVec3, b: DVec3, c: DVec3) -> (f64, f64) {
    let e = 2.0 * scene.noise;
    let (x, y) = ((b - a).xy(), (c - a).xy());
    let (m, n) = (x.x.abs() + x.y.abs(), y.x.abs() + y.y.abs());
    (x.perp_dot(y), 2.0 * e * (m + n + e) + 8.0 * U * m * n)
}

impl PairFrame<'_> {
    /// Returns the sign of `det[b - a, c - a, d]`: the orientation of the shadows.
    pub(crate) fn turn(
        &self,
        a: &impl ExactPoint,
        b: &impl ExactPoint,
        c: &impl ExactPoint,
    ) -> Ordering {
        let (value, error) =
            rough_turn(self, a.query_position(), b.query_position(), c.query_position());
        if value.abs() > error {
            return sign_of(value);
        }
        if a.is_exact() && b.is_exact() && c.is_exact() {
            return sign_of(orient2d(
                a.query_position().xy(),
                b.query_position().xy(),
                c.query_position().xy(),
            ));
        }
        self.turn_fine(a, b, c)
            .or_else(|| self.turn_wide::<SMALL_LIMBS>(a, b, c).sign())
            .unwrap_or_else(|| sign_of_large(&self.turn_wide::<LARGE_LIMBS>(a, b, c)))
    }

    /// Returns the sign of `det[b - a, c - a, e - a]`: `Greater` if `e` is on the outer side of the facet `a b c`.
    pub fn side_of_plane(
        &self,
        a: &impl ExactPoint,
        b: &impl ExactPoint,
        c: &impl ExactPoint,
        e: &impl ExactPoint,
    ) -> Ordering {
        let noise = 2.0 * self.noise;
        let p = a.query_position();
        let [x, y, z] = [b.query_position() - p, c.query_position() - p, e.query_position() - p];
        let [l, m, n] = [x, y, z].map(|v| v.abs().max_element());
        let value = x.cross(y).dot(z);
        let pairs = l * m + m * n + n * l;
        let error = 8.0 * noise * (pairs + noise * (l + m + n + noise)) + 48.0 * U * l * m * n;
        if value.abs() > error {
            return sign_of(value);
        }
        if a.is_exact() && b.is_exact() && c.is_exact() && e.is_exact() {
            return sign_of(orient3d(
                p,
                b.query_position(),
                c.query_position(),
                e.query_position(),
            ));
        }
        if let (Some(a), Some(b), Some(c), Some(e)) = (
            a.exact_position(self),
            b.exact_position(self),
            c.exact_position(self),
            e.exact_position(self),
        ) {
            return sign_of(orient3d(a, b, c, e));
        }
        self.outside_fine(a, b, c, e)
            .or_else(|| self.outside_wide::<SMALL_LIMBS>(a, b, c, e).sign())
            .unwrap_or_else(|| sign_of_large(&self.outside_wide::<LARGE_LIMBS>(a, b, c, e)))
    }

    /// Returns points relative to another point, exactly.
    pub(crate) fn spans_wide<const N: usize>(
        &self,
        from: &impl ExactPoint,
        points: [&impl ExactPoint; 3],
    ) -> [[Integer<N>; 3]; 3] {
        let p = from.integer_position(self);
        points.map(|q| difference(&q.integer_position(self), &p))
    }

    /// Returns the sign of `det[b - a, c - a, e - a]`; `None` if double-double precision does not decide it.
    fn outside_fine(
        &self,
        a: &impl ExactPoint,
        b: &impl ExactPoint,
        c: &impl ExactPoint,
        e: &impl ExactPoint,
    ) -> Option<Ordering> {
        let (p, ends) = (
            a.double_double_position(self),
            [
                b.double_double_position(self),
                c.double_double_position(self),
                e.double_double_position(self),
            ],
        );
        extended::determinant_sign(ends.each_ref().map(|q| p.displacement_to(q)))
    }

    /// Returns the sign of `det[b - a, c - a, d]`; `None` if double-double precision does not decide it.
    fn turn_fine(
        &self,
        a: &impl ExactPoint,
        b: &impl ExactPoint,
        c: &impl ExactPoint,
    ) -> Option<Ordering> {
        let [p, q, r] = [
            a.double_double_position(self),
            b.double_double_position(self),
            c.double_double_position(self),
        ];
        let d = ExtendedPoint::from_exact(self.setting.direction);
        extended::determinant_sign([
            p.displacement_to(&q),
            p.displacement_to(&r),
            ExtendedPoint::ORIGIN.displacement_to(&d),
        ])
    }

    /// Returns the sign of `det[b - a, c - a, e]`; `None` if double-double precision does not decide it.
    fn turn_about_fine(
        &self,
        axis: usize,
        a: &impl ExactPoint,
        b: &impl ExactPoint,
        c: &impl ExactPoint,
    ) -> Option<Ordering> {
        let [p, q, r] = [
            a.double_double_position(self),
            b.double_double_position(self),
            c.double_double_position(self),
        ];
        extended::minor_sign(
            [p.displacement_to(&q), p.displacement_to(&r)],
            [(axis + 1) % 3, (axis + 2) % 3],
        )
    }

    /// Computes `det[b - a, c - a, e - a]` exactly.
    fn outside_wide<const N: usize>(
        &self,
        a: &impl ExactPoint,
        b: &impl ExactPoint,
        c: &impl ExactPoint,
        e: &impl ExactPoint,
    ) -> Integer<N> {
        let p = a.integer_position(self);
        let [x, y, z] =
            [b.integer_position(self), c.integer_position(self), e.integer_position(self)]
                .map(|q| difference(&q, &p));
        determinant(&x, &y, &z)
    }

    /// Computes `det[b - a, c - a, d]` exactly.
    fn turn_wide<const N: usize>(
        &self,
        a: &impl ExactPoint,
        b: &impl ExactPoint,
        c: &impl ExactPoint,
    ) -> Integer<N> {
        let (p, d) = (
            a.integer_position(self),
            self.setting.direction.to_array().map(Integer::exact_number),
        );
        let (x, y) =
            (difference(&b.integer_position(self), &p), difference(&c.integer_position(self), &p));
        determinant(&x, &y, &d)
    }

    /// Returns the sign of `det[b - a, c - a, e]` for the unit vector `e` of an axis of the world.
    #[inline]
    pub fn projected_orientation(
        &self,
        axis: usize,
        a: &impl ExactPoint,
        b: &impl ExactPoint,
        c: &impl ExactPoint,
    ) -> Ordering {
        if let (Some(a), Some(b), Some(c)) =
            (a.exact_position(self), b.exact_position(self), c.exact_position(self))
        {
            let drop = |p: DVec3| DVec2::new(p[(axis + 1) % 3], p[(axis + 2) % 3]);
            return sign_of(orient2d(drop(a), drop(b), drop(c)));
        }
        let (value, error) =
            self.rough_turn_about(axis, a.query_position(), b.query_position(), c.query_position());
        if value.abs() > error {
            return sign_of(value);
        }
        self.turn_about_fine(axis, a, b, c)
            .or_else(|| self.turn_about_wide::<SMALL_LIMBS>(axis, a, b, c).sign())
            .unwrap_or_else(|| sign_of_large(&self.turn_about_wide::<LARGE_LIMBS>(axis, a, b, c)))
    }

    /// Computes the determinant of [`Self::projected_orientation`] from the query frame, and a bound on its error. The
    /// axes of that frame are orthogonal within a few `u`. Therefore a coordinate of a point that is rotated back has
    /// an error of at most two noises.
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
        let p = a.integer_position(self);
        let (x, y) =
            (difference(&b.integer_position(self), &p), difference(&c.integer_position(self), &p));
        x[i].multiply(&y[j]).subtract(&x[j].multiply(&y[i]))
    }

    /// Returns the sign of `(b - a).(e x d)` for the unit vector `e` of an axis of the world. It shows how `det[b - a,
    /// c - a, d]` changes when `c` moves along that axis.
    pub(crate) fn drift_sign(
        &self,
        axis: usize,
        a: &impl ExactPoint,
        b: &impl ExactPoint,
    ) -> Ordering {
        let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
        let x = difference::<LARGE_LIMBS>(&b.integer_position(self), &a.integer_position(self));
        let d = self.setting.direction.to_array().map(Integer::exact_number);
        // det[x, e, d] with e along `axis`: x_j d_i - x_i d_j, up to the order of axes.
        sign_of_large(&x[j].multiply(&d[i]).subtract(&x[i].multiply(&d[j])))
    }

    /// Returns the order of `a` and `b` along an axis of the world.
    pub(crate) fn axis_order(
        &self,
        axis: usize,
        a: &impl ExactPoint,
        b: &impl ExactPoint,
    ) -> Ordering {
        if let (Some(a), Some(b)) = (a.exact_position(self), b.exact_position(self)) {
            return sign_of(a[axis] - b[axis]);
        }
        let rough = (self.frame.transpose() * (a.query_position() - b.query_position()))[axis];
        if rough.abs() > 4.0 * self.noise {
            return sign_of(rough);
        }
        let fine = b
            .double_double_position(self)
            .displacement_to(&a.double_double_position(self))
            .sign_along(axis);
        fine.unwrap_or_else(|| {
            sign_of_large(
                &a.integer_position::<LARGE_LIMBS>(self)[axis]
                    .subtract(&b.integer_position(self)[axis]),
            )
        })
    }
}
