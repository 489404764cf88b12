//! Numbers with twice the usual precision (double-word arithmetic) and a bound on their absolute error.

#![expect(clippy::inline_always, reason = "inlining keeps the sums in registers")]

use std::cmp::Ordering;

use super::error_free::{difference_error, product_error, split_mantissa, sum_error};

/// Minimum magnitude of a product whose rounding error does not underflow.
pub(crate) const MIN_PRODUCT: f64 = f64::from_bits((1023 - 900) << 52);

/// The number `high + low` with an absolute error of at most `error`; exact if `error` is 0.
#[derive(Debug, Clone, Copy)]
pub struct Double {
    /// The leading part, at least as large as `low` after [`Self::normalized`].
    pub high: f64,
    pub low: f64,
    /// Bound on the absolute error; infinite if there is no bound.
    pub error: f64,
}

impl Double {
    pub const ZERO: Self = Self { high: 0.0, low: 0.0, error: 0.0 };

    /// Returns `a - b` exactly.
    #[inline]
    pub fn exact_difference(a: f64, b: f64) -> Self {
        Self { high: a - b, low: difference_error(a, b), error: 0.0 }
    }

    /// Returns the sum of both parts, rounded to the nearest `f64`.
    #[inline]
    pub fn rounded_value(&self) -> f64 {
        self.high + self.low
    }

    #[inline(always)]
    pub fn add_number(&mut self, x: f64) {
        let high = self.high + x;
        self.add_low(sum_error(self.high, x, high));
        self.high = high;
    }

    /// Adds a number that is small compared with the sum.
    #[inline(always)]
    pub fn add_low(&mut self, x: f64) {
        let low = self.low + x;
        self.error += sum_error(self.low, x, low).abs();
        self.low = low;
    }

    /// Adds the product `a b` of numbers that are not tiny.
    #[inline(always)]
    pub fn add_product(&mut self, a: f64, b: f64) {
        let p = a * b;
        self.add_number(p);
        self.add_low(product_error(a, b, p));
    }

    /// Adds the product `x factor`, with the error of `x`.
    #[inline(always)]
    pub fn add_scaled(&mut self, x: &Self, factor: f64) {
        if x.is_exactly_zero() || factor == 0.0 {
            return;
        }
        self.add_product(x.high, factor);
        if x.low != 0.0 {
            self.add_product(x.low, factor);
        }
        self.error += x.error * factor.abs();
    }

    /// Adds the product `sign x y`, with the errors of both factors. The error becomes infinite if a partial
    /// product is below [`MIN_PRODUCT`].
    #[inline(always)]
    pub fn add_double_product(&mut self, x: &Self, y: &Self, sign: f64) {
        if x.is_exactly_zero() || y.is_exactly_zero() {
            return;
        }
        for (a, b) in [(x.high, y.high), (x.low, y.high), (x.high, y.low), (x.low, y.low)] {
            if a != 0.0 && b != 0.0 {
                if (a * b).abs() < MIN_PRODUCT {
                    self.error = f64::INFINITY;
                }
                self.add_product(sign * a, b);
            }
        }
        if x.error + y.error != 0.0 {
            let (a, b) = (1.01 * x.high.abs(), 1.01 * y.high.abs());
            self.error += x.error * (b + y.error) + y.error * a + MIN_PRODUCT;
        }
    }

    /// Checks whether the number is exactly 0.
    #[inline(always)]
    pub fn is_exactly_zero(&self) -> bool {
        self.high == 0.0 && self.low == 0.0 && self.error == 0.0
    }

    /// Returns an equal number whose `low` is at most half a unit in the last place of `high`.
    #[inline(always)]
    #[must_use]
    pub fn normalized(self) -> Self {
        let high = self.high + self.low;
        Self { high, low: sum_error(self.high, self.low, high), ..self }
    }

    /// Returns the sign; `None` if the error leaves it uncertain.
    #[inline]
    pub fn certain_sign(&self) -> Option<Ordering> {
        let sum = self.high + self.low;
        // The factor covers the rounding of the accumulated errors and of `sum`.
        if sum.abs() > 1.01 * self.error {
            return sum.partial_cmp(&0.0);
        }
        (sum == 0.0 && self.error == 0.0).then_some(Ordering::Equal)
    }
}

/// `L` sums that have one factor of each product in common, as an array of [`Double`].
#[derive(Clone, Copy)]
pub(crate) struct ParallelSums<const L: usize> {
    pub(crate) high: [f64; L],
    pub(crate) low: [f64; L],
    pub(crate) error: [f64; L],
}

impl<const L: usize> ParallelSums<L> {
    pub(crate) const ZERO: Self = Self { high: [0.0; L], low: [0.0; L], error: [0.0; L] };

    /// Adds the products `entries[k] x` to the sums.
    #[inline(always)]
    pub(crate) fn add_products(&mut self, entries: [f64; L], x: f64) {
        let (x_high, x_low) = split_mantissa(x);
        for (k, e) in entries.into_iter().enumerate() {
            let p = e * x;
            let (e_high, e_low) = split_mantissa(e);
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

    /// Returns sum number `k`, normalised.
    #[inline(always)]
    pub(crate) fn get(&self, k: usize) -> Double {
        Double { high: self.high[k], low: self.low[k], error: self.error[k] }.normalized()
    }
}
