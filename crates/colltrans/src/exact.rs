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
//! Capacity. The door admits magnitudes from `2^-200` to `2^200` with 53 significant bits. A
//! product of two spans `2^-505..2^400`, a coordinate of `M` (eight terms) stays below `2^404`: 909
//! bits. A component of a shadow spans `2^-757..2^605`: 1362 bits, 23 limbs. Their products have 46
//! limbs, but numbers of like size need few: an integer keeps only the limbs it has.

#![expect(clippy::inline_always, reason = "these sums are meant to stay in registers")]

use std::cmp::Ordering;

use glam::{DMat3, DVec2, DVec3, Vec3Swizzles};

/// Limbs that are enough for all that is admitted, and for what is usual.
const ALL: usize = 48;
const USUAL: usize = 14;

/// `sum_k limbs[k] 2^(64 (lowest + k))` with a sign; not zero: the limbs at both ends are not.
/// Limbs beyond `len` are zero.
#[derive(Clone, Copy)]
struct Integer<const N: usize> {
    negative: bool,
    lowest: i32,
    len: usize,
    limbs: [u64; N],
}

impl<const N: usize> Integer<N> {
    const ZERO: Self = Self { negative: false, lowest: 0, len: 0, limbs: [0; N] };

    /// `a b`, exactly.
    fn product(a: f64, b: f64) -> Self {
        let mut result = Self::ZERO;
        let ((m, e), (n, f)) = (decode(a), decode(b));
        let bits = u128::from(m) * u128::from(n);
        if bits == 0 {
            return result;
        }
        result.negative = a.is_sign_negative() != b.is_sign_negative();
        let zeros = bits.trailing_zeros();
        let bits = bits >> zeros;
        let shift = e + f + zeros as i32;
        result.lowest = shift.div_euclid(64);
        let bit = shift.rem_euclid(64);
        let high = u128::from((bits >> 64) as u64) << bit;
        let low = u128::from(bits as u64) << bit;
        result.limbs[0] = low as u64;
        result.limbs[1] = (low >> 64) as u64 | high as u64;
        result.limbs[2] = (high >> 64) as u64;
        result.len = 3;
        result.trim();
        result
    }

    fn trim(&mut self) {
        while self.len > 0 && self.limbs[self.len - 1] == 0 {
            self.len -= 1;
        }
    }

    fn negate(mut self) -> Self {
        self.negative = !self.negative;
        self
    }

    /// Limb with the weight `2^(64 place)`.
    fn limb(&self, place: i32) -> u64 {
        let k = place - self.lowest;
        if (0..self.len as i32).contains(&k) { self.limbs[k as usize] } else { 0 }
    }

    /// Place above the highest limb.
    fn top(&self) -> i32 {
        self.lowest + self.len as i32
    }

    fn compare_magnitude(&self, other: &Self) -> Ordering {
        let (top, lowest) = (self.top().max(other.top()), self.lowest.min(other.lowest));
        for place in (lowest..top).rev() {
            match self.limb(place).cmp(&other.limb(place)) {
                Ordering::Equal => {}
                unequal => return unequal,
            }
        }
        Ordering::Equal
    }

    /// The sum; `None` if it has too many limbs.
    fn add(&self, other: &Self) -> Option<Self> {
        if self.len == 0 {
            return Some(*other);
        }
        if other.len == 0 {
            return Some(*self);
        }
        if self.negative == other.negative {
            return self.combine(other, false);
        }
        match self.compare_magnitude(other) {
            Ordering::Less => other.combine(self, true),
            Ordering::Equal => Some(Self::ZERO),
            Ordering::Greater => self.combine(other, true),
        }
    }

    fn subtract(&self, other: &Self) -> Option<Self> {
        self.add(&other.negate())
    }

    /// The sum of the magnitudes, or the larger one minus the smaller one, with the sign of the
    /// first.
    fn combine(&self, other: &Self, subtract: bool) -> Option<Self> {
        let lowest = self.lowest.min(other.lowest);
        let len = (self.top().max(other.top()) - lowest) as usize + 1;
        if len > N {
            return None;
        }
        let mut result = Self { negative: self.negative, lowest, len, ..Self::ZERO };
        let mut carry = false;
        for k in 0..len {
            let (a, b) = (self.limb(lowest + k as i32), other.limb(lowest + k as i32));
            let (s, c, d);
            if subtract {
                (s, c) = a.overflowing_sub(b);
                (result.limbs[k], d) = s.overflowing_sub(u64::from(carry));
            } else {
                (s, c) = a.overflowing_add(b);
                (result.limbs[k], d) = s.overflowing_add(u64::from(carry));
            }
            carry = c || d;
        }
        result.trim();
        Some(result)
    }

    /// The product; `None` if it has too many limbs.
    fn multiply(&self, other: &Self) -> Option<Self> {
        if self.len == 0 || other.len == 0 {
            return Some(Self::ZERO);
        }
        let len = self.len + other.len;
        if len > N {
            return None;
        }
        let negative = self.negative != other.negative;
        let mut result = Self { negative, lowest: self.lowest + other.lowest, len, ..Self::ZERO };
        for i in 0..self.len {
            let mut carry = 0_u128;
            for j in 0..other.len {
                let wide = u128::from(self.limbs[i]) * u128::from(other.limbs[j])
                    + u128::from(result.limbs[i + j])
                    + carry;
                result.limbs[i + j] = wide as u64;
                carry = wide >> 64;
            }
            result.limbs[i + other.len] = carry as u64;
        }
        result.trim();
        Some(result)
    }

    fn sign(&self) -> Ordering {
        match (self.len, self.negative) {
            (0, _) => Ordering::Equal,
            (_, true) => Ordering::Less,
            (_, false) => Ordering::Greater,
        }
    }
}

/// Mantissa and exponent: `|x| = mantissa 2^exponent`.
fn decode(x: f64) -> (u64, i32) {
    let bits = x.to_bits();
    let fraction = bits & ((1 << 52) - 1);
    let exponent = (bits >> 52 & 0x7ff) as i32;
    if exponent == 0 { (fraction, -1074) } else { (fraction | 1 << 52, exponent - 1075) }
}

/// A point of `M` as the sum of products that defines it: `R_Q q - R_P p + high + low`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Terms<'a> {
    pub(crate) fixed: (&'a DMat3, DVec3),
    pub(crate) moving: (&'a DMat3, DVec3),
    pub(crate) offset: [DVec3; 2],
}

impl Terms<'_> {
    /// Factors of the products whose sum is a coordinate.
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

    fn coordinate<const N: usize>(&self, row: usize) -> Option<Integer<N>> {
        let mut sum = Integer::ZERO;
        for (a, b) in self.row(row) {
            if a != 0.0 && b != 0.0 {
                sum = sum.add(&Integer::product(a, b))?;
            }
        }
        Some(sum)
    }

    /// The exact shadow.
    fn shadow<const N: usize>(&self, d: DVec3, [m, u, v]: [usize; 3]) -> Option<[Integer<N>; 2]> {
        let (along_u, along_v) = (self.coordinate(u)?, self.coordinate(v)?);
        let times = |x: &Integer<N>, k: usize| x.multiply(&Integer::product(d[k], 1.0));
        if d[u] == 0.0 && d[v] == 0.0 {
            return Some([times(&along_u, m)?, times(&along_v, m)?]);
        }
        let along_m = self.coordinate(m)?;
        Some([
            times(&along_u, m)?.subtract(&times(&along_m, u)?)?,
            times(&along_v, m)?.subtract(&times(&along_m, v)?)?,
        ])
    }
}

/// Sign of `det[a - o, b - o, d]` with `o = (eps, eps^2)` on the two world axes along which `d` is
/// smaller.
///
/// Zero only if `a` and `b` have the same shadow along `d`.
///
/// `base` is to return the [`shadow`] of `a` or `b`.
pub(crate) fn orientation(
    a: &Terms,
    b: &Terms,
    d: DVec3,
    base: impl FnOnce() -> Shadow,
) -> Ordering {
    let axes = axes_of(d);
    by_doubles(a, b, d, axes, base)
        .or_else(|| by_integers::<USUAL>(a, b, d, axes))
        .or_else(|| by_integers::<ALL>(a, b, d, axes))
        .unwrap_or(Ordering::Equal)
}

#[inline(never)]
fn by_integers<const N: usize>(
    a: &Terms,
    b: &Terms,
    d: DVec3,
    axes: [usize; 3],
) -> Option<Ordering> {
    let ([au, av], [bu, bv]) = (a.shadow::<N>(d, axes)?, b.shadow::<N>(d, axes)?);
    let det = au.multiply(&bv)?.subtract(&av.multiply(&bu)?)?.sign();
    if det != Ordering::Equal {
        return Some(if d[axes[0]] < 0.0 { det.reverse() } else { det });
    }
    // det[a - o, b - o, d] = det[a, b, d] - o . ((b - a) x d)
    let first = av.subtract(&bv)?.sign();
    Some(if first.is_ne() { first } else { bu.subtract(&au)?.sign() })
}

/// A shadow in numbers of twice the usual precision.
pub(crate) type Shadow = [Double; 2];

/// The number `high + low`, up to `error`; exact if that is 0.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Double {
    high: f64,
    low: f64,
    error: f64,
}

impl Double {
    const ZERO: Self = Self { high: 0.0, low: 0.0, error: 0.0 };

    #[inline(always)]
    fn add(&mut self, x: f64) {
        let high = self.high + x;
        self.add_low(sum_error(self.high, x, high));
        self.high = high;
    }

    /// Adds what is small against the sum.
    #[inline(always)]
    fn add_low(&mut self, x: f64) {
        let low = self.low + x;
        self.error += sum_error(self.low, x, low).abs();
        self.low = low;
    }

    /// Adds a product of numbers that are not tiny.
    #[inline(always)]
    fn add_product(&mut self, a: f64, b: f64) {
        let p = a * b;
        self.add(p);
        self.add_low(product_error(a, b, p));
    }

    /// Adds a product.
    #[inline(always)]
    fn add_scaled(&mut self, x: &Self, factor: f64) {
        if x.is_zero() || factor == 0.0 {
            return;
        }
        self.add_product(x.high, factor);
        if x.low != 0.0 {
            self.add_product(x.low, factor);
        }
        self.error += x.error * factor.abs();
    }

    /// Adds a product of two, with a sign.
    #[inline(always)]
    fn add_double_product(&mut self, x: &Self, y: &Self, sign: f64) {
        if x.is_zero() || y.is_zero() {
            return;
        }
        for (a, b) in [(x.high, y.high), (x.low, y.high), (x.high, y.low), (x.low, y.low)] {
            if a != 0.0 && b != 0.0 {
                if (a * b).abs() < LEAST_PRODUCT {
                    self.error = f64::INFINITY;
                }
                self.add_product(sign * a, b);
            }
        }
        if x.error + y.error != 0.0 {
            let (a, b) = (1.01 * x.high.abs(), 1.01 * y.high.abs());
            self.error += x.error * (b + y.error) + y.error * a + LEAST_PRODUCT;
        }
    }

    /// Whether the number is 0, certainly.
    #[inline(always)]
    fn is_zero(&self) -> bool {
        self.high == 0.0 && self.low == 0.0 && self.error == 0.0
    }

    /// The same with `low` less than a rounding of `high`.
    #[inline(always)]
    fn tidy(self) -> Self {
        let high = self.high + self.low;
        Self { high, low: sum_error(self.high, self.low, high), ..self }
    }

    /// The sign, if it is certain.
    fn sign(&self) -> Option<Ordering> {
        let sum = self.high + self.low;
        // The rounding of the errors' sum and of this one.
        if sum.abs() > 1.01 * self.error {
            return sum.partial_cmp(&0.0);
        }
        (sum == 0.0 && self.error == 0.0).then_some(Ordering::Equal)
    }
}

/// Several sums of the same shape at once, as [`Double`].
#[derive(Clone, Copy)]
struct Sums<const L: usize> {
    high: [f64; L],
    low: [f64; L],
    error: [f64; L],
}

impl<const L: usize> Sums<L> {
    const ZERO: Self = Self { high: [0.0; L], low: [0.0; L], error: [0.0; L] };

    /// Adds products with a common factor.
    #[inline(always)]
    fn add_products(&mut self, entries: [f64; L], x: f64) {
        let (x_high, x_low) = split(x);
        for (k, e) in entries.into_iter().enumerate() {
            let p = e * x;
            let (e_high, e_low) = split(e);
            let tail = e_low * x_low - (((p - e_high * x_high) - e_low * x_high) - e_high * x_low);
            let high = self.high[k] + p;
            let rest = sum_error(self.high[k], p, high);
            self.high[k] = high;
            let some = self.low[k] + rest;
            let low = some + tail;
            self.error[k] +=
                sum_error(self.low[k], rest, some).abs() + sum_error(some, tail, low).abs();
            self.low[k] = low;
        }
    }

    #[inline(always)]
    fn get(&self, k: usize) -> Double {
        Double { high: self.high[k], low: self.low[k], error: self.error[k] }.tidy()
    }
}

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
fn axes_of(d: DVec3) -> [usize; 3] {
    let main = usize::from(d.abs().max_position() as u8);
    [main, (main + 1) % 3, (main + 2) % 3]
}

/// The shadow of a point, without the positive or negative factor `d_m` if `d` has no other
/// component.
pub(crate) fn shadow(x: &Terms, d: DVec3) -> Shadow {
    let [m, u, v] = axes_of(d);
    if d[u] == 0.0 && d[v] == 0.0 {
        return x.rounded([u, v]);
    }
    rounded_shadow(x.rounded([u, v, m]), [d[u], d[v], d[m]])
}

/// The side on which a line passes, from the shadow of one of the segment's ends, known well, and
/// the way between them in the shadow frame, whose coordinates have errors of two noises; if that
/// is enough, as it is where the end is close to the line and the way is not.
pub(crate) fn side(base: &Shadow, way: DVec2, axes: &DMat3, d: DVec3, noise: f64) -> Option<bool> {
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
fn minor(a: &[Double; 2], b: &[Double; 2]) -> Double {
    let mut sum = Double::ZERO;
    sum.add_double_product(&a[0], &b[1], 1.0);
    sum.add_double_product(&a[1], &b[0], -1.0);
    sum
}

/// Products of this size or more have low parts that are not lost.
const LEAST_PRODUCT: f64 = f64::from_bits((1023 - 900) << 52);

/// The rounding error of the sum `s = fl(a + b)`, exactly (Knuth).
#[inline(always)]
fn sum_error(a: f64, b: f64, s: f64) -> f64 {
    let b_virtual = s - a;
    let a_virtual = s - b_virtual;
    (a - a_virtual) + (b - b_virtual)
}

/// The rounding error of `a - b`, exactly: `a - b = fl(a - b) + error`.
pub(crate) fn difference_error(a: f64, b: f64) -> f64 {
    let difference = a - b;
    let b_virtual = a - difference;
    let a_virtual = difference + b_virtual;
    (a - a_virtual) + (b_virtual - b)
}

/// `a.x b.y - a.y b.x` with an error relative to the result, not to its terms.
pub(crate) fn accurate_det(a: DVec2, b: DVec2) -> f64 {
    let (p, q) = (a.x * b.y, a.y * b.x);
    if (p - q).abs() > 0.25 * (p.abs() + q.abs()) {
        // Little cancels: the roundings of both products are a few of the result's.
        return p - q;
    }
    (p - q) + (product_error(a.x, b.y, p) - product_error(a.y, b.x, q))
}

/// `a x b` with an error relative to each component.
pub(crate) fn accurate_cross(a: DVec3, b: DVec3) -> DVec3 {
    DVec3::new(
        accurate_det(a.yz(), b.yz()),
        accurate_det(a.zx(), b.zx()),
        accurate_det(a.xy(), b.xy()),
    )
}

/// The rounding error of the product `p = fl(a b)`, exactly (Dekker).
fn product_error(a: f64, b: f64, p: f64) -> f64 {
    let ((a_high, a_low), (b_high, b_low)) = (split(a), split(b));
    a_low * b_low - (((p - a_high * b_high) - a_low * b_high) - a_high * b_low)
}

/// `a` as a sum of two numbers with at most 26 significant bits (Veltkamp).
fn split(a: f64) -> (f64, f64) {
    const SPLITTER: f64 = ((1_u64 << 27) + 1) as f64;
    let c = SPLITTER * a;
    let high = c - (c - a);
    (high, a - high)
}

#[cfg(test)]
mod tests {
    use super::*;
    use dashu_ratio::RBig;
    use proptest::prelude::*;

    fn rational(x: f64) -> RBig {
        RBig::try_from(x).unwrap()
    }

    /// Numbers of very different size, zero and ties among them.
    fn number() -> impl Strategy<Value = f64> {
        prop_oneof![
            Just(0.0),
            (-4_i32..=4).prop_map(f64::from),
            -1.0..1.0_f64,
            (-1.0..1.0_f64, -180_i32..180).prop_map(|(x, e)| x * 2.0_f64.powi(e)),
        ]
    }

    fn vector() -> impl Strategy<Value = DVec3> {
        [number(), number(), number()].prop_map(DVec3::from_array)
    }

    proptest! {
        #[test]
        fn integers_agree_with_rationals(a in number(), b in number(), c in number(), d in number()) {
            let sum = Integer::<ALL>::product(a, b).add(&Integer::product(c, d)).unwrap();
            let expected = rational(a) * rational(b) + rational(c) * rational(d);
            prop_assert_eq!(sum.sign(), expected.cmp(&RBig::ZERO));
        }

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

        #[test]
        fn accurate_determinants_are(a in 0.5..1.0_f64, b in 0.5..1.0_f64, k in 1..1_000_i32) {
            // Nearly parallel: the terms agree to 10 digits or more.
            let tiny = f64::from(k) * 1e-13;
            let (v, w) = (DVec2::new(a, b), DVec2::new(a + tiny, b));
            let exact = rational(v.x) * rational(w.y) - rational(v.y) * rational(w.x);
            let off = (rational(accurate_det(v, w)) - exact.clone()).to_f64().value();
            prop_assert!(off.abs() <= 4.0 * f64::EPSILON * exact.to_f64().value().abs());
        }

        #[test]
        fn difference_errors_are_exact(a in number(), b in number()) {
            let sum = rational(a - b) + rational(difference_error(a, b));
            prop_assert_eq!(sum, rational(a) - rational(b));
        }
    }
}
