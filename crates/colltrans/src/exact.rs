//! Exact arithmetic for the few decisions that rounding cannot make.
//!
//! Every coordinate, matrix entry and translation is a dyadic rational, so the determinant that
//! says on which side of a segment the line passes is an integer times a power of two. It is formed
//! here in whole numbers of fixed capacity, on the stack, only when the rounded determinant is too
//! close to zero to be trusted: in ties, which are the rule in designed parts.
//!
//! Capacity. The door admits magnitudes from `2^-200` to `2^200` with 53 significant bits. A
//! product of two spans `2^-505..2^400`, a coordinate of `M` (eight terms) stays below `2^404`: 909
//! bits. A product of two such coordinates and a component of the direction has at most `2 * 909 +
//! 453 + 3 = 2274` bits, 36 limbs.

use std::cmp::Ordering;

use glam::{DMat3, DVec2, DVec3, Vec3Swizzles};

const LIMBS: usize = 37;

/// Exponent of the unit: every product of two admitted numbers is a multiple of `2^UNIT`, and so is
/// every admitted number.
const UNIT: i32 = -505;

/// An integer with a sign; limbs above `len` are zero.
#[derive(Clone, Copy)]
struct Integer {
    negative: bool,
    len: usize,
    limbs: [u64; LIMBS],
}

impl Integer {
    const ZERO: Self = Self { negative: false, len: 0, limbs: [0; LIMBS] };

    /// `a b / 2^UNIT`, exactly.
    fn product(a: f64, b: f64) -> Self {
        let ((m, e), (n, f)) = (decode(a), decode(b));
        let negative = a.is_sign_negative() != b.is_sign_negative();
        Self::shifted(u128::from(m) * u128::from(n), e + f - UNIT, negative)
    }

    /// `bits 2^shift`; the exponents of admitted numbers keep the shift from being negative.
    fn shifted(bits: u128, shift: i32, negative: bool) -> Self {
        let mut result = Self::ZERO;
        if bits == 0 {
            return result;
        }
        result.negative = negative;
        let (limb, bit) = (shift as usize / 64, shift as usize % 64);
        let parts = [bits as u64, (bits >> 64) as u64];
        for (k, part) in parts.into_iter().enumerate() {
            let wide = u128::from(part) << bit;
            result.limbs[limb + k] |= wide as u64;
            result.limbs[limb + k + 1] |= (wide >> 64) as u64;
        }
        result.len = limb + 3;
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

    fn compare_magnitude(&self, other: &Self) -> Ordering {
        self.len.cmp(&other.len).then_with(|| {
            self.limbs[..self.len].iter().rev().cmp(other.limbs[..other.len].iter().rev())
        })
    }

    fn add(&self, other: &Self) -> Self {
        if self.negative == other.negative {
            return self.add_magnitude(other);
        }
        match self.compare_magnitude(other) {
            Ordering::Less => other.subtract_magnitude(self),
            Ordering::Equal => Self::ZERO,
            Ordering::Greater => self.subtract_magnitude(other),
        }
    }

    fn add_magnitude(&self, other: &Self) -> Self {
        let mut sum = *self;
        sum.len = self.len.max(other.len) + 1;
        let mut carry = false;
        for k in 0..sum.len {
            let (s, c) = self.limbs[k].overflowing_add(other.limbs[k]);
            let (s, d) = s.overflowing_add(u64::from(carry));
            sum.limbs[k] = s;
            carry = c || d;
        }
        sum.trim();
        sum
    }

    /// The larger magnitude minus the smaller one, with the sign of the larger.
    fn subtract_magnitude(&self, smaller: &Self) -> Self {
        let mut rest = *self;
        let mut borrow = false;
        for k in 0..self.len {
            let (s, c) = self.limbs[k].overflowing_sub(smaller.limbs[k]);
            let (s, d) = s.overflowing_sub(u64::from(borrow));
            rest.limbs[k] = s;
            borrow = c || d;
        }
        rest.trim();
        rest
    }

    fn multiply(&self, other: &Self) -> Self {
        let mut result = Self::ZERO;
        if self.len == 0 || other.len == 0 {
            return result;
        }
        result.negative = self.negative != other.negative;
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
        result.len = self.len + other.len;
        result.trim();
        result
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

/// An exact vector, in units of `2^UNIT`.
#[derive(Clone, Copy)]
pub(crate) struct ExactVector([Integer; 3]);

impl ExactVector {
    pub(crate) fn subtract(&self, other: &Self) -> Self {
        Self(std::array::from_fn(|k| self.0[k].add(&other.0[k].negate())))
    }

    /// Component `k` of the cross product with `d`.
    fn cross_component(&self, d: &Self, k: usize) -> Integer {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        self.0[i].multiply(&d.0[j]).add(&self.0[j].multiply(&d.0[i]).negate())
    }
}

/// `R_Q q - R_P p + high + low`, exactly.
pub(crate) fn difference(
    (fixed_matrix, q): (&DMat3, DVec3),
    (moving_matrix, p): (&DMat3, DVec3),
    [high, low]: [DVec3; 2],
) -> ExactVector {
    let q = q.to_array();
    let p = p.to_array();
    ExactVector(std::array::from_fn(|row| {
        let mut sum = Integer::product(high[row], 1.0).add(&Integer::product(low[row], 1.0));
        for column in 0..3 {
            sum = sum.add(&Integer::product(fixed_matrix.col(column)[row], q[column]));
            sum = sum.add(&Integer::product(-moving_matrix.col(column)[row], p[column]));
        }
        sum
    }))
}

/// Sign of `det[a - o, b - o, d]` with `o = (eps, eps^2)` on the two world axes along which `d` is
/// smaller.
///
/// Zero only if `a` and `b` have the same shadow along `d`.
pub(crate) fn orientation(a: &ExactVector, b: &ExactVector, d: DVec3) -> Ordering {
    let direction = ExactVector(d.to_array().map(direction_integer));
    // det[a, b, d] = a . (b x d), and det[a - o, b - o, d] = det[a, b, d] - o . ((b - a) x d).
    let mut det = Integer::ZERO;
    for k in 0..3 {
        det = det.add(&a.0[k].multiply(&b.cross_component(&direction, k)));
    }
    let magnitudes = d.abs();
    let main = usize::from(magnitudes.max_position() as u8);
    let along = b.subtract(a);
    det.sign()
        .then_with(|| along.cross_component(&direction, (main + 1) % 3).negate().sign())
        .then_with(|| along.cross_component(&direction, (main + 2) % 3).negate().sign())
}

/// A direction's component in units of `2^-252`.
fn direction_integer(x: f64) -> Integer {
    let (mantissa, exponent) = decode(x);
    Integer::shifted(u128::from(mantissa), exponent + 252, x.is_sign_negative())
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
            let sum = Integer::product(a, b).add(&Integer::product(c, d));
            let expected = rational(a) * rational(b) + rational(c) * rational(d);
            prop_assert_eq!(sum.sign(), expected.cmp(&RBig::ZERO));
        }

        #[test]
        fn orientation_agrees_with_rationals(q in vector(), p in vector(), r in vector(), t in vector(), d in vector(), s in number()) {
            let m = DMat3::from_diagonal(DVec3::new(s, 1.0, -s));
            let exact = |q, p| difference((&m, q), (&DMat3::IDENTITY, p), [t, DVec3::ZERO]);
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
            let found = orientation(&a, &b, d);
            if sign != Ordering::Equal {
                prop_assert_eq!(found, sign);
            }
            prop_assert_eq!(orientation(&b, &a, d), found.reverse());
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
