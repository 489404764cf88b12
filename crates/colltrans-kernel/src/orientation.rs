//! Exact orientation predicate: the side of a segment of the shadow plane on which the line passes.
//!
//! Let `m` be the axis along which `d` is largest by magnitude, and `u`, `v` the next two in cyclic order. The
//! *exact shadow* of `x` is `(x_u d_m - x_m d_u, x_v d_m - x_m d_v)`. `det[a, b, d] d_m` is the determinant of
//! the exact shadows of `a` and `b`.
//!
//! Ties are frequent in designed parts. Therefore three methods are tried, each exact if it returns a sign:
//!
//! 1. numbers of twice the usual precision with an error bound ([`Double`]; exact if the bound is 0),
//! 2. integers of [`SMALL_LIMBS`] capacity,
//! 3. integers of [`LARGE_LIMBS`] capacity, which always suffices (`docs/theory/exact-arithmetic.md`).

#![expect(clippy::inline_always, reason = "inlining keeps the sums in registers")]

use std::cmp::Ordering;

use glam::{DMat3, DVec2, DVec3};

use super::double::{Double, ParallelSums};
use super::error_free::{difference_error, sum_error};
use super::integer::{Integer, LARGE_LIMBS, SMALL_LIMBS};
use super::real::{DoubleWord, RealVector};

/// A point of `M` as the sum of products that defines it: `R_Q q - R_P p + high + low`.
#[derive(Debug, Clone, Copy)]
pub struct PointTerms<'a> {
    /// Rotation `R_Q` of the fixed body, and its vertex `q`.
    pub fixed: (&'a DMat3, DVec3),
    /// Rotation `R_P` of the moving body, and its vertex `p`.
    pub moving: (&'a DMat3, DVec3),
    /// The two parts `high`, `low` of the offset between the bodies.
    pub offset: [DVec3; 2],
}

impl PointTerms<'_> {
    /// Returns the factors of the products whose sum is a coordinate.
    #[inline]
    fn coordinate_factors(&self, row: usize) -> [(f64, f64); 8] {
        let ((f, q), (m, p), [high, low]) = (self.fixed, self.moving, self.offset);
        [
            (f.x_axis[row], q.x),
            (f.y_axis[row], q.y),
            (f.z_axis[row], q.z),
            (-m.x_axis[row], p.x),
            (-m.y_axis[row], p.y),
            (-m.z_axis[row], p.z),
            (high[row], 1.0),
            (low[row], 1.0),
        ]
    }

    /// Returns the point, computed nearly without rounding and then rounded.
    #[inline]
    pub fn rounded_point(&self) -> DVec3 {
        DVec3::from_array(self.double_coordinates([0, 1, 2]).map(|coordinate| coordinate.high))
    }

    /// Returns the point in twice the usual precision.
    #[inline]
    pub fn double_word_point(&self) -> RealVector<DoubleWord> {
        RealVector(
            self.double_coordinates([0, 1, 2])
                .map(|coordinate| DoubleWord::new(coordinate.high, coordinate.low)),
        )
    }

    /// Returns the exact coordinates of the point.
    #[inline]
    pub fn exact_coordinates<const N: usize>(&self) -> [Integer<N>; 3] {
        std::array::from_fn(|row| self.exact_coordinate(row))
    }

    /// Returns one exact coordinate of the point.
    #[inline]
    fn exact_coordinate<const N: usize>(&self, row: usize) -> Integer<N> {
        self.coordinate_factors(row)
            .iter()
            .fold(Integer::ZERO, |sum, &(a, b)| sum.add(&Integer::exact_product(a, b)))
    }

    /// Returns the exact shadow for the axes `[m, u, v]`.
    #[inline]
    fn exact_shadow<const N: usize>(&self, d: DVec3, [m, u, v]: [usize; 3]) -> [Integer<N>; 2] {
        let times = |x: &Integer<N>, k: usize| x.multiply(&Integer::exact_number(d[k]));
        let along_m = self.exact_coordinate(m);
        [u, v].map(|k| times(&self.exact_coordinate(k), m).subtract(&times(&along_m, k)))
    }
}

/// Returns the sign of `det[a - o, b - o, d]` for an infinitesimal offset `o`, which is `eps` along the world
/// axis `u` and `eps^2` along `v` (simulation of simplicity). The sign is `Equal` only if `a` and `b` have the
/// same shadow along `d`.
///
/// `base` computes the [`shadow_of_point`] of `a` or `b`.
#[inline]
pub fn perturbed_orientation(
    a: &PointTerms,
    b: &PointTerms,
    d: DVec3,
    base: impl FnOnce() -> Shadow,
) -> Ordering {
    let axes = ordered_axes(d);
    sign_by_doubles(a, b, d, axes, base)
        .or_else(|| sign_by_integers::<SMALL_LIMBS>(a, b, d, axes))
        .or_else(|| sign_by_integers::<LARGE_LIMBS>(a, b, d, axes))
        .unwrap_or(Ordering::Equal)
}

/// Computes the sign with integers of `N` limbs; `None` if a number did not fit.
#[inline(never)]
fn sign_by_integers<const N: usize>(
    a: &PointTerms,
    b: &PointTerms,
    d: DVec3,
    axes: [usize; 3],
) -> Option<Ordering> {
    let ([au, av], [bu, bv]) = (a.exact_shadow::<N>(d, axes), b.exact_shadow::<N>(d, axes));
    let det = au.multiply(&bv).subtract(&av.multiply(&bu)).sign()?;
    if det != Ordering::Equal {
        return Some(if d[axes[0]] < 0.0 { det.reverse() } else { det });
    }
    // The first order of `eps` decides: `det[a - o, b - o, d] = det[a, b, d] - o . ((b - a) x d)`.
    let first = av.subtract(&bv).sign()?;
    if first.is_ne() { Some(first) } else { bu.subtract(&au).sign() }
}

/// A shadow in twice the usual precision.
pub type Shadow = [Double; 2];

/// Returns the components of a vector along some axes.
#[inline(always)]
fn components<const L: usize>(column: DVec3, axes: [usize; L]) -> [f64; L] {
    axes.map(|k| column[k])
}

impl PointTerms<'_> {
    /// Computes the coordinates along some axes in twice the usual precision.
    #[inline(always)]
    fn double_coordinates<const L: usize>(&self, axes: [usize; L]) -> [Double; L] {
        let mut sums =
            ParallelSums { high: components(self.offset[0], axes), ..ParallelSums::ZERO };
        sums.low = components(self.offset[1], axes);
        for column in 0..3 {
            sums.add_products(components(self.fixed.0.col(column), axes), self.fixed.1[column]);
            sums.add_products(components(self.moving.0.col(column), axes), -self.moving.1[column]);
        }
        std::array::from_fn(|k| sums.get(k))
    }

    /// Computes the coordinates of the displacement from `self` to `other`. Terms that both have in common
    /// cancel without error.
    #[inline(always)]
    fn double_displacement<const L: usize>(&self, other: &Self, axes: [usize; L]) -> [Double; L] {
        let mut sums = ParallelSums::ZERO;
        for ((matrix, from), to, sign) in
            [(self.fixed, other.fixed.1, 1.0), (self.moving, other.moving.1, -1.0)]
        {
            for column in 0..3 {
                let displacement = sign * (to[column] - from[column]);
                if displacement != 0.0 {
                    let entries = components(matrix.col(column), axes);
                    sums.add_products(entries, displacement);
                    let rest = sign * difference_error(to[column], from[column]);
                    if rest != 0.0 {
                        for (k, e) in entries.into_iter().enumerate() {
                            let p = e * rest;
                            let low = sums.low[k] + p;
                            sums.error[k] +=
                                p.abs() * f64::EPSILON + sum_error(sums.low[k], p, low).abs();
                            sums.low[k] = low;
                        }
                    }
                }
            }
        }
        std::array::from_fn(|k| sums.get(k))
    }
}

/// Computes the shadow of a vector from its coordinates along the axes `u`, `v`, `m` and those of `d`.
#[inline(always)]
fn double_shadow([along_u, along_v, along_m]: [Double; 3], [u, v, m]: [f64; 3]) -> [Double; 2] {
    [(along_u, u), (along_v, v)].map(|(x, d)| {
        let mut sum = Double::ZERO;
        sum.add_scaled(&x, m);
        sum.add_scaled(&along_m, -d);
        sum.normalized()
    })
}

/// Returns the axis along which `d` is largest, and the next two in cyclic order.
#[inline]
fn ordered_axes(d: DVec3) -> [usize; 3] {
    let main = usize::from(d.abs().max_position() as u8);
    [main, (main + 1) % 3, (main + 2) % 3]
}

/// Computes the exact shadow of a point in twice the usual precision. If `d` is parallel to the axis `m`, the
/// result is the exact shadow divided by `d_m`, which may be negative.
#[inline]
pub fn shadow_of_point(x: &PointTerms, d: DVec3) -> Shadow {
    let [m, u, v] = ordered_axes(d);
    if d[u] == 0.0 && d[v] == 0.0 {
        return x.double_coordinates([u, v]);
    }
    double_shadow(x.double_coordinates([u, v, m]), [d[u], d[v], d[m]])
}

/// Converts a shadow to coordinates along the lateral axes, which are the first two columns of `axes`. The
/// result is zero only if the shadow is zero. `None` if the errors of the shadow together exceed
/// [`MAX_RELATIVE_ERROR`] times its larger component.
#[inline]
pub fn lateral_coordinates(shadow: &Shadow, axes: &DMat3, d: DVec3) -> Option<DVec2> {
    let [u_error, v_error] = [shadow[0].error, shadow[1].error];
    let [along_u, along_v] = [&shadow[0], &shadow[1]].map(|x| x.high + x.low);
    let size = along_u.abs().max(along_v.abs());
    if u_error + v_error > MAX_RELATIVE_ERROR * size {
        return None;
    }
    // A lateral vector is determined by its components along `u` and `v`.
    let [m, u, v] = ordered_axes(d);
    let factor = if d[u] == 0.0 && d[v] == 0.0 { 1.0 } else { d[m] };
    let along = |e: DVec3| (e[u] * along_u + e[v] * along_v) / factor;
    Some(DVec2::new(along(axes.x_axis), along(axes.y_axis)))
}

/// Maximum relative error of a shadow that is used as a direction.
const MAX_RELATIVE_ERROR: f64 = 1e-9;

/// Checks whether the line passes to the left of a segment; `None` if rounding leaves the side uncertain.
///
/// `base` is the accurate shadow of one end. `displacement` leads from the first end to the second in the
/// shadow frame, with errors of two noises in its coordinates. This suffices if the end is near the line and
/// the displacement is long.
#[inline]
pub fn is_left_of_segment(
    base: &Shadow,
    displacement: DVec2,
    axes: &DMat3,
    d: DVec3,
    noise: f64,
) -> Option<bool> {
    let [m, u, v] = ordered_axes(d);
    let bare = d[u] == 0.0 && d[v] == 0.0;
    let factor = if bare { 1.0 } else { d[m] };
    let component = |k: usize| {
        let along = |e: DVec3| factor * e[k] - d[k] * e[m];
        along(axes.x_axis) * displacement.x + along(axes.y_axis) * displacement.y
    };
    let displacement = [component(u), component(v)];
    let displacement_error = 9.0 * noise * (factor.abs() + d[u].abs() + d[v].abs());
    let det = base[0].high * displacement[1] - base[1].high * displacement[0];
    let size = |x: &Double| (x.high.abs(), x.low.abs() + x.error);
    let ((a, a_error), (b, b_error)) = (size(&base[0]), size(&base[1]));
    let error = (a + b) * displacement_error
        + (a_error + b_error)
            * (displacement[0].abs() + displacement[1].abs() + displacement_error)
        + f64::MIN_POSITIVE;
    (det.abs() > 1.01 * error).then_some((det > 0.0) == (d[m] > 0.0))
}

/// Computes the sign with numbers of twice the usual precision; `None` if that leaves it uncertain.
#[inline]
fn sign_by_doubles(
    a: &PointTerms,
    b: &PointTerms,
    d: DVec3,
    [m, u, v]: [usize; 3],
    base: impl FnOnce() -> Shadow,
) -> Option<Ordering> {
    let sign = if d[m] < 0.0 { Ordering::Less } else { Ordering::Greater };
    if d[u] == 0.0 && d[v] == 0.0 {
        // Positive factors do not change the sign.
        let displacement = a.double_displacement(b, [u, v]);
        return sign_from_shadows(displacement, base, [sign, Ordering::Greater]);
    }
    let along = [d[u], d[v], d[m]];
    let displacement = double_shadow(a.double_displacement(b, [u, v, m]), along);
    sign_from_shadows(displacement, base, [Ordering::Greater, sign])
}

/// Returns the sign of [`perturbed_orientation`] from the shadows of the displacement and of one of its ends. `None`
/// if the errors leave the sign uncertain.
///
/// `signs` are the sign of `d_m` and `Greater`, in this order for shadows that were divided by `d_m`, in the opposite
/// order for exact shadows.
#[inline(always)]
fn sign_from_shadows(
    displacement: [Double; 2],
    start: impl FnOnce() -> [Double; 2],
    signs: [Ordering; 2],
) -> Option<Ordering> {
    let times = |x: Ordering, sign: Ordering| if sign == Ordering::Less { x.reverse() } else { x };
    let [u, v] = [displacement[0].certain_sign(), displacement[1].certain_sign()];
    if u == Some(Ordering::Equal) && v == u {
        return u;
    }
    let det = cross_product(&start(), &displacement).certain_sign()?;
    if det != Ordering::Equal {
        return Some(times(times(det, signs[0]), signs[1]));
    }
    let first = times(v?.reverse(), signs[0]);
    Some(if first.is_ne() { first } else { times(u?, signs[0]) })
}

/// Computes `a.x b.y - a.y b.x`.
#[inline]
fn cross_product(a: &[Double; 2], b: &[Double; 2]) -> Double {
    let mut sum = Double::ZERO;
    sum.add_double_product(&a[0], &b[1], 1.0);
    sum.add_double_product(&a[1], &b[0], -1.0);
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::{any_number, any_vector, rational};
    use dashu_ratio::RBig;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn orientation_agrees_with_rationals(
            q in any_vector(), p in any_vector(), r in any_vector(),
            t in any_vector(), d in any_vector(), s in any_number(),
        ) {
            let m = DMat3::from_diagonal(DVec3::new(s, 1.0, -s));
            let exact = |q, p| PointTerms {
                fixed: (&m, q),
                moving: (&DMat3::IDENTITY, p),
                offset: [t, DVec3::ZERO],
            };
            let value = |q: DVec3, p: DVec3, k: usize| {
                rational(m.col(k)[k]) * rational(q[k]) - rational(p[k]) + rational(t[k])
            };
            let (a, b) = (exact(q, p), exact(r, p));
            let (x, y): (Vec<RBig>, Vec<RBig>) = (0..3).map(|k| (value(q, p, k), value(r, p, k))).unzip();
            let z: Vec<RBig> = d.to_array().map(rational).to_vec();
            let det: RBig = (0..3)
                .map(|k| {
                    let (i, j) = ((k + 1) % 3, (k + 2) % 3);
                    x[k].clone() * (y[i].clone() * &z[j] - y[j].clone() * &z[i])
                })
                .fold(RBig::ZERO, |u, v| u + v);
            let sign = det.cmp(&RBig::ZERO);
            let found = perturbed_orientation(&a, &b, d, || shadow_of_point(&a, d));
            if sign != Ordering::Equal {
                prop_assert_eq!(found, sign);
            }
            prop_assert_eq!(perturbed_orientation(&b, &a, d, || shadow_of_point(&a, d)), found.reverse());
        }
    }
}
