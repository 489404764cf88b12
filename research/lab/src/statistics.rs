//! Statistics of many measurements with intervals by the bootstrap (Efron and Tibshirani, "An Introduction to the
//! Bootstrap", 1993, chapters 8 and 13; for clusters Davison and Hinkley, "Bootstrap Methods and their Application",
//! 1997, section 3.8).
//!
//! - A *sample* contains values in groups, and groups in passes. Values of one setting, or of one sequence of
//!   settings, form a group. A *pass* is one pair of bodies of each size, measured in one period of time. It captures
//!   the effects of the bodies and of other activity of the machine.
//! - A *replicate* draws with replacement as many passes as there are, and from each as many groups as it has, and
//!   computes the statistic. The middle 95 % of the replicates are the interval. Few passes underestimate the spread,
//!   so the interval is widened by the ratio of Student's distribution and the normal distribution.
//! - Invariant: replicate `r` draws the same passes in all samples with the same number of passes, and the same
//!   groups in those with the same number of groups. Values from the same bodies, time or settings stay together.

use std::collections::BTreeMap;

use colltrans_testkit::random::Random;
use colltrans_testkit::timing::quantile;

/// A number with its interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// Value from all measurements.
    pub value: f64,
    /// Lower end of the 95 % interval.
    pub low: f64,
    /// Upper end of the 95 % interval.
    pub high: f64,
}

/// Unit of drawing: a pass, and in it a setting or a sequence of settings.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Group {
    pub(crate) pass: u32,
    pub(crate) number: u32,
}

/// Values by pass and group.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Sample(Vec<Vec<Vec<f64>>>);

/// Number of replicates.
const REPLICATES: u64 = 200;

impl Sample {
    /// Creates a sample from values with their groups.
    pub(crate) fn of(values: impl Iterator<Item = (Group, f64)>) -> Self {
        let mut passes: BTreeMap<u32, BTreeMap<u32, Vec<f64>>> = BTreeMap::new();
        for (group, value) in values {
            let pass = passes.entry(group.pass).or_default();
            pass.entry(group.number).or_default().push(value);
        }
        Self(passes.into_values().map(|pass| pass.into_values().collect()).collect())
    }

    /// Returns all values.
    pub(crate) fn values(&self) -> Vec<f64> {
        self.0.iter().flatten().flatten().copied().collect()
    }

    /// Returns the mean of every group.
    pub(crate) fn group_means(&self) -> Vec<f64> {
        self.0.iter().flatten().map(|group| mean(group)).collect()
    }

    /// Returns the values of a replicate.
    fn replicate_values(&self, replicate: u64) -> Vec<f64> {
        let passes = self.0.len() as u64;
        let mut random = Random::stream(replicate, &[passes]);
        let mut values = Vec::with_capacity(self.0.iter().flatten().map(Vec::len).sum());
        for place in 0..passes {
            let groups = &self.0[random.index(self.0.len())];
            let mut within = Random::stream(replicate, &[passes, place, groups.len() as u64]);
            for _ in 0..groups.len() {
                values.extend_from_slice(&groups[within.index(groups.len())]);
            }
        }
        values
    }
}

/// Computes a statistic of samples with its interval.
pub(crate) fn estimate(samples: &[Sample], statistic: impl Fn(&[Vec<f64>]) -> f64) -> Estimate {
    let value = statistic(&samples.iter().map(Sample::values).collect::<Vec<_>>());
    let replicate =
        |r| statistic(&samples.iter().map(|s| s.replicate_values(r)).collect::<Vec<_>>());
    let mut replicates: Vec<f64> = (0..REPLICATES).map(replicate).collect();
    replicates.retain(|r| r.is_finite());
    let [low, high] = [0.025, 0.975].map(|share| quantile(&replicates, share));
    // For samples with different numbers of passes, the mean number is used.
    let passes: usize = samples.iter().map(|sample| sample.0.len()).sum();
    let wider = widening_factor(passes / samples.len().max(1));
    // Ratios and times vary by factors, so their intervals are widened as powers.
    let ends = if low > 0.0 && value > 0.0 {
        [low, high].map(|end| value * (end / value).powf(wider))
    } else {
        [low, high].map(|end| value + (end - value) * wider)
    };
    Estimate { value, low: ends[0].min(value), high: ends[1].max(value) }
}

/// Returns the factor that widens an interval from few passes: the 97.5 % quantile of Student's distribution
/// over that of the normal distribution, times the square root that corrects a variance of few values. A
/// single pass is not widened.
fn widening_factor(passes: usize) -> f64 {
    const STUDENT: [f64; 10] = [12.71, 4.30, 3.18, 2.78, 2.57, 2.45, 2.36, 2.31, 2.26, 2.23];
    if passes < 2 {
        return 1.0;
    }
    let quantile = STUDENT.get(passes - 2).copied().unwrap_or(2.1);
    let passes = passes as f64;
    quantile / 1.96 * (passes / (passes - 1.0)).sqrt()
}

/// Returns the mean; NaN without values.
pub(crate) fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

impl std::fmt::Display for Estimate {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let [value, low, high] = [self.value, self.low, self.high].map(short);
        write!(f, "{value} ({low} to {high})")
    }
}

/// Formats a number with about three digits.
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

    fn at(pass: u32, number: u32) -> Group {
        Group { pass, number }
    }

    /// In one pass, the interval of a mean is that of the normal distribution and contains the true value
    /// with the stated frequency.
    #[test]
    fn mean_interval_of_one_pass_is_normal_interval() {
        let mut random = Random::new(1);
        let (mut inside, runs) = (0, 200);
        for _ in 0..runs {
            let sample = Sample::of((0..100).map(|k| (at(0, k), random.range(0.0, 1.0))));
            let Estimate { value, low, high } = estimate(&[sample], |s| mean(&s[0]));
            let expected = 2.0 * 1.96 * (1.0 / 1200.0_f64).sqrt();
            assert!(((high - low) / expected - 1.0).abs() < 0.35, "{low} {value} {high}");
            inside += i32::from(low <= 0.5 && 0.5 <= high);
        }
        assert!((180..=198).contains(&inside), "{inside} of {runs}");
    }

    /// If passes differ, intervals from few passes contain the true value with the stated frequency, and two
    /// runs nearly always overlap.
    #[test]
    fn intervals_of_few_passes_contain_true_value() {
        let mut random = Random::new(3);
        for passes in [4, 8] {
            let mut run = || {
                let mut values = Vec::new();
                for pass in 0..passes {
                    let bodies = random.range(0.8, 1.2);
                    values.extend((0..50).map(|k| (at(pass, k), bodies + random.range(-0.3, 0.3))));
                }
                estimate(&[Sample::of(values.into_iter())], |s| mean(&s[0]))
            };
            let (mut inside, mut overlap) = (0, 0);
            for _ in 0..100 {
                let [a, b] = [run(), run()];
                inside += [a, b].iter().filter(|e| e.low <= 1.0 && 1.0 <= e.high).count();
                overlap += usize::from(a.low <= b.high && b.low <= a.high);
            }
            assert!(inside >= 184 && overlap >= 97, "{passes}: {inside} of 200, {overlap} of 100");
        }
    }

    /// Values of one group are drawn together: a hundred copies of each of four values contain no more
    /// information than four values.
    #[test]
    fn values_of_a_group_are_drawn_together() {
        let apart = Sample::of((0..400).map(|k| (at(0, k), f64::from(k % 4))));
        let together = Sample::of((0..400).map(|k| (at(0, k % 4), f64::from(k % 4))));
        let width = |sample| {
            let e = estimate(&[sample], |s| mean(&s[0]));
            e.high - e.low
        };
        assert!(width(together) > 5.0 * width(apart));
    }

    /// Two samples of the same settings have an exact ratio, whatever their spread.
    #[test]
    fn samples_of_equal_settings_have_exact_ratio() {
        let mut random = Random::new(2);
        let values: Vec<f64> = (0..50).map(|_| random.range(1.0, 9.0)).collect();
        let sample = |by: f64| {
            Sample::of(
                (0..).zip(values.iter().map(move |v| by * v)).map(|(k, v)| (at(k / 10, k), v)),
            )
        };
        let ratio = estimate(&[sample(3.0), sample(1.0)], |s| mean(&s[0]) / mean(&s[1]));
        assert!((ratio.high - ratio.low).abs() < 1e-12 && (ratio.value - 3.0).abs() < 1e-12);
    }

    #[test]
    fn short_numbers_have_three_digits() {
        for (value, expected) in [(0.123, "0.12"), (-4.5, "-4.50"), (12.34, "12.3"), (123.4, "123")]
        {
            assert_eq!(short(value), expected);
        }
    }
}
