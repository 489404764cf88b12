//! Measures the times of single queries, and computes statistics of times.

use std::hint::black_box;
use std::time::Instant;

/// A stopwatch for single calls, which subtracts the cost of reading the clock.
#[derive(Debug, Clone, Copy)]
pub struct Stopwatch {
    /// The smallest time between two readings, in nanoseconds.
    cost: f64,
}

impl Stopwatch {
    /// Measures the cost of reading the clock.
    #[expect(clippy::new_without_default, reason = "it measures the clock")]
    pub fn new() -> Self {
        let once = |_| Instant::now().elapsed().as_nanos();
        Self { cost: (0..256).map(once).min().unwrap_or(0) as f64 }
    }

    /// Returns the result of a call, and its time in nanoseconds. The time is at least 1, so that ratios exist.
    pub fn time<T>(self, call: impl FnOnce() -> T) -> (T, f64) {
        let started = Instant::now();
        let result = black_box(call());
        let spent = started.elapsed().as_nanos() as f64 - self.cost;
        (result, spent.max(1.0))
    }
}

/// Returns the value below which a share of the values lies; NaN if there are no values.
pub fn quantile(values: &[f64], share: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let last = sorted.len().saturating_sub(1);
    sorted.get((last as f64 * share).round() as usize).copied().unwrap_or(f64::NAN)
}

/// Returns the median; NaN if there are no values.
pub fn median(values: &[f64]) -> f64 {
    quantile(values, 0.5)
}

/// Returns the mean and the standard deviation.
pub fn mean_and_deviation(values: &[f64]) -> [f64; 2] {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let variance = values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / count;
    [mean, variance.sqrt()]
}

/// Returns the values in increasing order, without the largest hundredth, which other programs cause in
/// measured times.
pub fn without_disturbed(values: &[f64]) -> Vec<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.truncate((values.len() * 99).div_ceil(100));
    sorted
}

/// Returns the exponent `k` of `y = c x^k`, fitted by least squares of the logarithms.
pub fn exponent(points: impl Iterator<Item = (f64, f64)> + Clone) -> f64 {
    let logs: Vec<_> = points.map(|(x, y)| (x.ln(), y.ln())).collect();
    let count = logs.len() as f64;
    let [mx, my] = [
        logs.iter().map(|l| l.0).sum::<f64>() / count,
        logs.iter().map(|l| l.1).sum::<f64>() / count,
    ];
    let covariance: f64 = logs.iter().map(|(x, y)| (x - mx) * (y - my)).sum();
    covariance / logs.iter().map(|(x, _)| (x - mx) * (x - mx)).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn statistics_of_small_samples() {
        let values = [4.0, 1.0, 3.0, 2.0, 5.0];
        assert_eq!([0.25, 0.5, 0.75].map(|share| quantile(&values, share)), [2.0, 3.0, 4.0]);
        assert_eq!(mean_and_deviation(&values), [3.0, 2.0_f64.sqrt()]);
        assert!(median(&[]).is_nan());
        let hundred: Vec<f64> = (0..100).rev().map(f64::from).collect();
        assert_eq!(without_disturbed(&hundred).last(), Some(&98.0));
    }

    #[test]
    fn exponents_are_those_of_powers() {
        let cubes = (1..9).map(|x| (f64::from(x), 5.0 * f64::from(x).powi(3)));
        assert!((exponent(cubes) - 3.0).abs() < 1e-12);
    }

    #[test]
    fn a_stopwatch_sees_work() {
        let stopwatch = Stopwatch::new();
        let work = |n: u32| (0..n).fold(1.0_f64, |a, b| black_box(a.mul_add(0.5, f64::from(b))));
        let best = |n| {
            (0..20).map(|_| stopwatch.time(|| work(black_box(n))).1).fold(f64::INFINITY, f64::min)
        };
        assert!(best(100_000) > 10.0 * best(1_000));
    }
}
