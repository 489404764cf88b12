//! What many measurements come to, and how far chance may have moved it: the bootstrap.
//!
//! Notation. A *sample* holds values in groups, and groups in passes. What belongs to one setting, or to
//! one sequence of settings, is one group. A *pass* is one pair of bodies of each size, measured in one
//! stretch of time: in it are what the bodies do to a number, and what else the machine did meanwhile.
//! A *replicate* draws as many passes as there are, with replacement, and of each as many groups as it has,
//! and computes the statistic anew; the middle 95 % of the replicates are the interval. Few passes spread less
//! than they should: the interval is as much wider as Student's is than that of the normal distribution.
//!
//! Invariant. Replicate `r` draws the same passes in all samples with equally many of them, and the same
//! groups in those with equally many of these: what was measured on the same bodies, at the same time or on the
//! same settings stays together.
//!
//! Source: Efron and Tibshirani, "An Introduction to the Bootstrap", 1993, chapters 8 and 13; of clusters
//! Davison and Hinkley, "Bootstrap Methods and their Application", 1997, section 3.8.

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

/// What is drawn together: a pass, and in it a setting or a sequence of settings.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Group {
    pub(crate) pass: u32,
    pub(crate) number: u32,
}

/// Values by pass and group.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Sample(Vec<Vec<Vec<f64>>>);

/// How often a statistic is computed anew.
const REPLICATES: u64 = 200;

impl Sample {
    /// From values with their groups.
    pub(crate) fn of(values: impl Iterator<Item = (Group, f64)>) -> Self {
        let mut passes: BTreeMap<u32, BTreeMap<u32, Vec<f64>>> = BTreeMap::new();
        for (group, value) in values {
            let pass = passes.entry(group.pass).or_default();
            pass.entry(group.number).or_default().push(value);
        }
        Self(passes.into_values().map(|pass| pass.into_values().collect()).collect())
    }

    /// All values.
    pub(crate) fn values(&self) -> Vec<f64> {
        self.0.iter().flatten().flatten().copied().collect()
    }

    /// The mean of every group.
    pub(crate) fn group_means(&self) -> Vec<f64> {
        self.0.iter().flatten().map(|group| mean(group)).collect()
    }

    fn drawn(&self, replicate: u64) -> Vec<f64> {
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

/// A statistic of samples, with its interval.
pub(crate) fn estimate(samples: &[Sample], statistic: impl Fn(&[Vec<f64>]) -> f64) -> Estimate {
    let value = statistic(&samples.iter().map(Sample::values).collect::<Vec<_>>());
    let replicate = |r| statistic(&samples.iter().map(|s| s.drawn(r)).collect::<Vec<_>>());
    let mut replicates: Vec<f64> = (0..REPLICATES).map(replicate).collect();
    replicates.retain(|r| r.is_finite());
    let [low, high] = [0.025, 0.975].map(|share| quantile(&replicates, share));
    // Statistics over samples with more and with fewer passes vary as something between.
    let passes: usize = samples.iter().map(|sample| sample.0.len()).sum();
    let wider = widening(passes / samples.len().max(1));
    // Ratios and times are as likely twice as large as half as large.
    let ends = if low > 0.0 && value > 0.0 {
        [low, high].map(|end| value * (end / value).powf(wider))
    } else {
        [low, high].map(|end| value + (end - value) * wider)
    };
    Estimate { value, low: ends[0].min(value), high: ends[1].max(value) }
}

/// By how much an interval from a few passes is to be wider: Student's quantile of 97.5 % over that of the normal
/// distribution, and the root of what a variance of few lacks. One pass says nothing of others.
fn widening(passes: usize) -> f64 {
    const STUDENT: [f64; 10] = [12.71, 4.30, 3.18, 2.78, 2.57, 2.45, 2.36, 2.31, 2.26, 2.23];
    if passes < 2 {
        return 1.0;
    }
    let quantile = STUDENT.get(passes - 2).copied().unwrap_or(2.1);
    let passes = passes as f64;
    quantile / 1.96 * (passes / (passes - 1.0)).sqrt()
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

    fn at(pass: u32, number: u32) -> Group {
        Group { pass, number }
    }

    /// In one pass the interval of a mean is that of the normal distribution, and holds the truth as
    /// often as it says.
    #[test]
    fn intervals_of_means() {
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

    /// Where passes differ, intervals of few of them hold the truth as often as they say, and two runs
    /// nearly always overlap.
    #[test]
    fn intervals_over_passes() {
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

    /// Values of one group are one draw: a hundred copies of each of four values know no more than
    /// four values.
    #[test]
    fn groups_stay_together() {
        let apart = Sample::of((0..400).map(|k| (at(0, k), f64::from(k % 4))));
        let together = Sample::of((0..400).map(|k| (at(0, k % 4), f64::from(k % 4))));
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
        let sample = |by: f64| {
            Sample::of(
                (0..).zip(values.iter().map(move |v| by * v)).map(|(k, v)| (at(k / 10, k), v)),
            )
        };
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
