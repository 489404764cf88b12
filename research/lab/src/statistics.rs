//! What many measurements come to, and how far chance may have moved it: the bootstrap.
//!
//! Notation. A *sample* holds values in groups; what belongs to one setting, or to one sequence of
//! settings, is one group. A *replicate* draws as many groups as there are, with replacement, and
//! computes the statistic anew; the middle 95 % of the replicates are the interval.
//!
//! Invariant. Replicate `r` draws the same places in all samples with equally many groups, so what
//! was measured on the same settings stays together.
//!
//! Source: Efron and Tibshirani, "An Introduction to the Bootstrap", 1993, chapters 8 and 13.

use std::collections::BTreeMap;

use colltrans_testkit::random::Random;
use colltrans_testkit::timing::quantile;

/// A number with its interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// From all measurements.
    pub value: f64,
    /// Lower end of the 95 % interval.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

/// Values in the groups that are drawn together.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Sample(Vec<Vec<f64>>);

/// How often a statistic is computed anew.
const REPLICATES: u64 = 200;

impl Sample {
    /// From values with the numbers of their groups.
    pub(crate) fn of(values: impl Iterator<Item = (u32, f64)>) -> Self {
        let mut groups: BTreeMap<u32, Vec<f64>> = BTreeMap::new();
        for (group, value) in values {
            groups.entry(group).or_default().push(value);
        }
        Self(groups.into_values().collect())
    }

    /// All values.
    pub(crate) fn values(&self) -> Vec<f64> {
        self.0.concat()
    }

    fn drawn(&self, replicate: u64) -> Vec<f64> {
        let mut random = Random::stream(replicate, &[self.0.len() as u64]);
        let mut values = Vec::with_capacity(self.0.iter().map(Vec::len).sum());
        for _ in 0..self.0.len() {
            values.extend_from_slice(&self.0[random.index(self.0.len())]);
        }
        values
    }
}

/// A statistic of samples, with its interval.
pub(crate) fn estimate(samples: &[Sample], statistic: impl Fn(&[Vec<f64>]) -> f64) -> Estimate {
    let value = statistic(&samples.iter().map(Sample::values).collect::<Vec<_>>());
    let replicate = |r| statistic(&samples.iter().map(|s| s.drawn(r)).collect::<Vec<_>>());
    let mut replicates: Vec<f64> = (0..REPLICATES).map(replicate).collect();
    replicates.retain(|r| r.is_finite());
    let [low, high] = [0.025, 0.975].map(|share| quantile(&replicates, share));
    Estimate { value, low: low.min(value), high: high.max(value) }
}

/// The mean; NaN if there are no values.
pub(crate) fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

impl std::fmt::Display for Estimate {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let [value, low, high] = [self.value, self.low, self.high].map(short);
        write!(f, "{value} ({low} to {high})")
    }
}

/// A number with about three digits.
pub(crate) fn short(value: f64) -> String {
    match value.abs() {
        size if size >= 99.5 => format!("{value:.0}"),
        size if size >= 9.95 => format!("{value:.1}"),
        _ => format!("{value:.2}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The interval of a mean is that of the normal distribution, and holds the truth as often as it
    /// says.
    #[test]
    fn intervals_of_means() {
        let mut random = Random::new(1);
        let (mut inside, runs) = (0, 200);
        for _ in 0..runs {
            let sample = Sample::of((0..100).map(|k| (k, random.range(0.0, 1.0))));
            let Estimate { value, low, high } = estimate(&[sample], |s| mean(&s[0]));
            let expected = 2.0 * 1.96 * (1.0 / 1200.0_f64).sqrt();
            assert!(((high - low) / expected - 1.0).abs() < 0.35, "{low} {value} {high}");
            inside += i32::from(low <= 0.5 && 0.5 <= high);
        }
        assert!((180..=198).contains(&inside), "{inside} of {runs}");
    }

    /// Values of one group are one draw: a hundred copies of each of four values know no more than
    /// four values.
    #[test]
    fn groups_stay_together() {
        let apart = Sample::of((0..400).map(|k| (k, f64::from(k % 4))));
        let together = Sample::of((0..400).map(|k| (k % 4, f64::from(k % 4))));
        let width = |sample| {
            let e = estimate(&[sample], |s| mean(&s[0]));
            e.high - e.low
        };
        assert!(width(together) > 5.0 * width(apart));
    }

    /// Twice the same settings: their ratio is known exactly, however they scatter.
    #[test]
    fn samples_of_the_same_settings_are_drawn_together() {
        let mut random = Random::new(2);
        let values: Vec<f64> = (0..50).map(|_| random.range(1.0, 9.0)).collect();
        let sample = |by: f64| Sample::of((0..).zip(values.iter().map(move |v| by * v)));
        let ratio = estimate(&[sample(3.0), sample(1.0)], |s| mean(&s[0]) / mean(&s[1]));
        assert!((ratio.high - ratio.low).abs() < 1e-12 && (ratio.value - 3.0).abs() < 1e-12);
    }

    #[test]
    fn numbers_for_people() {
        for (value, expected) in [(0.123, "0.12"), (-4.5, "-4.50"), (12.34, "12.3"), (123.4, "123")]
        {
            assert_eq!(short(value), expected);
        }
    }
}
