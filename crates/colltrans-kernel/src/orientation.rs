//! Exact arithmetic for the few decisions that rounding cannot make.
//!
//! Every coordinate, matrix entry and translation is a dyadic rational, so on which side of a
//! segment the line passes is decided by integers times powers of two: the *exact shadows* of both
//! points. With `m` the axis along which `d` is largest and `u`, `v` the next two in cyclic order,
//! the shadow of `x` is `(x_u d_m - x_m d_u, x_v d_m - x_m d_v)`, and `det[a, b, d] d_m` is the
//! determinant of the shadows of `a` and `b`.
//!
//! Ties are the rule in designed parts, so three steps are tried, each exact when it answers:
//! numbers of twice the usual precision with a bound on what they lost ([`Double`]; a bound of 0
//! means nothing was), whole numbers of the usual size, whole numbers of the largest size.
//!
//! Capacity. Input has magnitudes from `2^-200` to `2^200` with 53 significant bits. A
//! product of two spans `2^-505..2^400`, a coordinate of `M` (eight terms) stays below `2^404`: 909
//! bits. A component of a shadow spans `2^-757..2^605`: 1362 bits, 23 limbs. Their products have 46
//! limbs, but numbers of like size need few: an integer keeps only the limbs it has.

#![expect(clippy::inline_always, reason = "these sums are meant to stay in registers")]

use std::cmp::Ordering;

use glam::{DMat3, DVec2, DVec3};

use super::double::{Double, Sums};
use super::error_free::{difference_error, sum_error};
use super::integer::{Integer, LARGE, SMALL};
use super::real::{Twice, Vector};

/// A point of `M` as the sum of products that defines it: `R_Q q - R_P p + high + low`.
#[derive(Debug, Clone, Copy)]
pub struct Terms<'a> {
    pub fixed: (&'a DMat3, DVec3),
    pub moving: (&'a DMat3, DVec3),
    pub offset: [DVec3; 2],
}

impl Terms<'_> {
    /// Factors of the products whose sum is a coordinate.
    #[inline]
    fn row(&self, row: usize) -> [(f64, f64); 8] {
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

    /// The point, rounded as if its coordinates had been computed without rounding, or nearly so.
    #[inline]
    pub fn point(&self) -> DVec3 {
        DVec3::from_array(self.rounded([0, 1, 2]).map(|coordinate| coordinate.high))
    }

    /// The point in twice the usual precision.
    #[inline]
    pub fn twice(&self) -> Vector<Twice> {
        Vector(
            self.rounded([0, 1, 2]).map(|coordinate| Twice::new(coordinate.high, coordinate.low)),
        )
    }

    /// The point, exactly.
    #[inline]
    pub fn coordinates<const N: usize>(&self) -> [Integer<N>; 3] {
        std::array::from_fn(|row| self.coordinate(row))
    }

    #[inline]
    fn coordinate<const N: usize>(&self, row: usize) -> Integer<N> {
        self.row(row).iter().fold(Integer::ZERO, |sum, &(a, b)| sum.add(&Integer::product(a, b)))
    }

    /// The exact shadow.
    #[inline]
    fn shadow<const N: usize>(&self, d: DVec3, [m, u, v]: [usize; 3]) -> [Integer<N>; 2] {
        let times = |x: &Integer<N>, k: usize| x.multiply(&Integer::number(d[k]));
        let along_m = self.coordinate(m);
        [u, v].map(|k| times(&self.coordinate(k), m).subtract(&times(&along_m, k)))
    }
}

/// Sign of `det[a - o, b - o, d]` with `o = (eps, eps^2)` on the two world axes along which `d` is
/// smaller.
///
/// Zero only if `a` and `b` have the same shadow along `d`.
///
/// `base` is to return the [`shadow`] of `a` or `b`.
#[inline]
pub fn orientation(a: &Terms, b: &Terms, d: DVec3, base: impl FnOnce() -> Shadow) -> Ordering {
    let axes = axes_of(d);
    by_doubles(a, b, d, axes, base)
        .or_else(|| by_integers::<SMALL>(a, b, d, axes))
        .or_else(|| by_integers::<LARGE>(a, b, d, axes))
        .unwrap_or(Ordering::Equal)
}

#[inline(never)]
fn by_integers<const N: usize>(
    a: &Terms,
    b: &Terms,
    d: DVec3,
    axes: [usize; 3],
) -> Option<Ordering> {
    let ([au, av], [bu, bv]) = (a.shadow::<N>(d, axes), b.shadow::<N>(d, axes));
    let det = au.multiply(&bv).subtract(&av.multiply(&bu)).sign()?;
    if det != Ordering::Equal {
        return Some(if d[axes[0]] < 0.0 { det.reverse() } else { det });
    }
    // det[a - o, b - o, d] = det[a, b, d] - o . ((b - a) x d)
    let first = av.subtract(&bv).sign()?;
    if first.is_ne() { Some(first) } else { bu.subtract(&au).sign() }
}

/// A shadow in numbers of twice the usual precision.
pub type Shadow = [Double; 2];

/// Rows of a matrix's column.
#[inline(always)]
fn rows<const L: usize>(column: DVec3, axes: [usize; L]) -> [f64; L] {
    axes.map(|k| column[k])
}

impl Terms<'_> {
    /// Coordinates.
    #[inline(always)]
    fn rounded<const L: usize>(&self, axes: [usize; L]) -> [Double; L] {
        let mut sums = Sums { high: rows(self.offset[0], axes), ..Sums::ZERO };
        sums.low = rows(self.offset[1], axes);
        for column in 0..3 {
            sums.add_products(rows(self.fixed.0.col(column), axes), self.fixed.1[column]);
            sums.add_products(rows(self.moving.0.col(column), axes), -self.moving.1[column]);
        }
        std::array::from_fn(|k| sums.get(k))
    }

    /// Coordinates of the way to `other`: most terms are the same and leave no error.
    #[inline(always)]
    fn rounded_way<const L: usize>(&self, other: &Self, axes: [usize; L]) -> [Double; L] {
        let mut sums = Sums::ZERO;
        for ((matrix, from), to, sign) in
            [(self.fixed, other.fixed.1, 1.0), (self.moving, other.moving.1, -1.0)]
        {
            for column in 0..3 {
                let way = sign * (to[column] - from[column]);
                if way != 0.0 {
                    let entries = rows(matrix.col(column), axes);
                    sums.add_products(entries, way);
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

/// The shadow of a point with these coordinates along the axes `u`, `v`, `m`.
#[inline(always)]
fn rounded_shadow([along_u, along_v, along_m]: [Double; 3], [u, v, m]: [f64; 3]) -> [Double; 2] {
    [(along_u, u), (along_v, v)].map(|(x, d)| {
        let mut sum = Double::ZERO;
        sum.add_scaled(&x, m);
        sum.add_scaled(&along_m, -d);
        sum.tidy()
    })
}

/// The axis along which `d` is largest, and the next two.
#[inline]
fn axes_of(d: DVec3) -> [usize; 3] {
    let main = usize::from(d.abs().max_position() as u8);
    [main, (main + 1) % 3, (main + 2) % 3]
}

/// The shadow of a point, without the positive or negative factor `d_m` if `d` has no other
/// component.
#[inline]
pub fn shadow(x: &Terms, d: DVec3) -> Shadow {
    let [m, u, v] = axes_of(d);
    if d[u] == 0.0 && d[v] == 0.0 {
        return x.rounded([u, v]);
    }
    rounded_shadow(x.rounded([u, v, m]), [d[u], d[v], d[m]])
}

/// A shadow in the coordinates of lateral axes `e1, e2`, with a small error relative to its length;
/// zero only if it is. `None` if the shadow is not known that well.
#[inline]
pub fn rounded(shadow: &Shadow, axes: &DMat3, d: DVec3) -> Option<DVec2> {
    let [u_error, v_error] = [shadow[0].error, shadow[1].error];
    let [along_u, along_v] = [&shadow[0], &shadow[1]].map(|x| x.high + x.low);
    let size = along_u.abs().max(along_v.abs());
    if u_error + v_error > RELATIVE_ERROR * size {
        return None;
    }
    // Lateral vectors are determined by their components across the main axis.
    let [m, u, v] = axes_of(d);
    let factor = if d[u] == 0.0 && d[v] == 0.0 { 1.0 } else { d[m] };
    let along = |e: DVec3| (e[u] * along_u + e[v] * along_v) / factor;
    Some(DVec2::new(along(axes.x_axis), along(axes.y_axis)))
}

/// Error that a shadow may have to be of use as a direction.
const RELATIVE_ERROR: f64 = 1e-9;

/// The side on which a line passes, from the shadow of one of the segment's ends, known well, and
/// the way between them in the shadow frame, whose coordinates have errors of two noises; if that
/// is enough, as it is where the end is close to the line and the way is not.
#[inline]
pub fn side(base: &Shadow, way: DVec2, axes: &DMat3, d: DVec3, noise: f64) -> Option<bool> {
    let [m, u, v] = axes_of(d);
    let bare = d[u] == 0.0 && d[v] == 0.0;
    let factor = if bare { 1.0 } else { d[m] };
    let component = |k: usize| {
        let along = |e: DVec3| factor * e[k] - d[k] * e[m];
        along(axes.x_axis) * way.x + along(axes.y_axis) * way.y
    };
    let way = [component(u), component(v)];
    let way_error = 9.0 * noise * (factor.abs() + d[u].abs() + d[v].abs());
    let det = base[0].high * way[1] - base[1].high * way[0];
    let size = |x: &Double| (x.high.abs(), x.low.abs() + x.error);
    let ((a, a_error), (b, b_error)) = (size(&base[0]), size(&base[1]));
    let error = (a + b) * way_error
        + (a_error + b_error) * (way[0].abs() + way[1].abs() + way_error)
        + f64::MIN_POSITIVE;
    (det.abs() > 1.01 * error).then_some((det > 0.0) == (d[m] > 0.0))
}

/// Decides with numbers of twice the usual precision, if that is enough.
#[inline]
fn by_doubles(
    a: &Terms,
    b: &Terms,
    d: DVec3,
    [m, u, v]: [usize; 3],
    base: impl FnOnce() -> Shadow,
) -> Option<Ordering> {
    let sign = if d[m] < 0.0 { Ordering::Less } else { Ordering::Greater };
    if d[u] == 0.0 && d[v] == 0.0 {
        // Positive factors do not matter.
        let way = a.rounded_way(b, [u, v]);
        return decide(way, base, [sign, Ordering::Greater]);
    }
    let along = [d[u], d[v], d[m]];
    let way = rounded_shadow(a.rounded_way(b, [u, v, m]), along);
    decide(way, base, [Ordering::Greater, sign])
}

/// The side, from the shadow of the way and of the point where it begins or ends; `signs` of the shadows'
/// and of the determinant's factor.
#[inline(always)]
fn decide(
    way: [Double; 2],
    start: impl FnOnce() -> [Double; 2],
    signs: [Ordering; 2],
) -> Option<Ordering> {
    let times = |x: Ordering, sign: Ordering| if sign == Ordering::Less { x.reverse() } else { x };
    let [u, v] = [way[0].sign(), way[1].sign()];
    if u == Some(Ordering::Equal) && v == u {
        return u;
    }
    let det = minor(&start(), &way).sign()?;
    if det != Ordering::Equal {
        return Some(times(times(det, signs[0]), signs[1]));
    }
    let first = times(v?.reverse(), signs[0]);
    Some(if first.is_ne() { first } else { times(u?, signs[0]) })
}

/// `a.x b.y - a.y b.x`.
#[inline]
fn minor(a: &[Double; 2], b: &[Double; 2]) -> Double {
    let mut sum = Double::ZERO;
    sum.add_double_product(&a[0], &b[1], 1.0);
    sum.add_double_product(&a[1], &b[0], -1.0);
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::{number, rational, vector};
    use dashu_ratio::RBig;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn orientation_agrees_with_rationals(q in vector(), p in vector(), r in vector(), t in vector(), d in vector(), s in number()) {
            let m = DMat3::from_diagonal(DVec3::new(s, 1.0, -s));
            let exact = |q, p| Terms {
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
            let found = orientation(&a, &b, d, || shadow(&a, d));
            if sign != Ordering::Equal {
                prop_assert_eq!(found, sign);
            }
            prop_assert_eq!(orientation(&b, &a, d, || shadow(&a, d)), found.reverse());
        }
    }
}
