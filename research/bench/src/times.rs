//! Times of queries, the turns in which contestants answer them, and what both come to.

use std::hint::black_box;

use colltrans::{Outcome, QueryError, StartedFrom, Steps};
use colltrans_lab::settings::Setting;
use colltrans_lab::shapes::Bodies;
use colltrans_testkit::timing::{Stopwatch, mean_and_deviation, quantile, without_disturbed};
use serde::{Serialize, Serializer};
use serde_json::{Value, json};

use crate::harness::merged;
use crate::parry::Scale;

/// Times of single queries, in nanoseconds. As JSON: `median_ns`, `mean_ns`, `p90_ns` and `p99_ns`.
#[derive(Debug, Clone, Default)]
pub struct Times(Vec<f64>);

impl Times {
    /// Adds one.
    pub fn add(&mut self, nanoseconds: f64) {
        self.0.push(nanoseconds);
    }

    /// Returns their number.
    pub fn count(&self) -> usize {
        self.0.len()
    }

    /// Returns the time that a share of them does not exceed; NaN if there are none.
    pub fn quantile(&self, share: f64) -> f64 {
        quantile(&self.0, share)
    }

    /// Returns the median; NaN if there are none.
    pub fn median(&self) -> f64 {
        self.quantile(0.5)
    }

    /// Returns the mean of all but the slowest hundredth, which other programs on the machine cause.
    pub fn mean(&self) -> f64 {
        mean_and_deviation(&without_disturbed(&self.0))[0]
    }
}

impl Serialize for Times {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let figures = json!({
            "median_ns": self.median(),
            "mean_ns": self.mean(),
            "p90_ns": self.quantile(0.9),
            "p99_ns": self.quantile(0.99),
        });
        figures.serialize(serializer)
    }
}

/// Times queries.
#[derive(Debug, Clone, Copy)]
pub struct Clock {
    stopwatch: Stopwatch,
    /// Number of repetitions of each query, of whose times the mean counts.
    pub repeat: u32,
}

impl Clock {
    /// Returns a clock that takes the mean of so many repetitions of each query, at least one.
    pub fn new(repeat: u32) -> Self {
        Self { stopwatch: Stopwatch::new(), repeat: repeat.max(1) }
    }

    /// Returns the last answer of a query, and the nanoseconds of one.
    pub fn time<T>(self, mut query: impl FnMut() -> T) -> (T, f64) {
        let all = || {
            (1..self.repeat).for_each(|_| drop(black_box(query())));
            query()
        };
        let (answer, spent) = self.stopwatch.time(all);
        (answer, spent / f64::from(self.repeat))
    }

    /// Returns the answers and times of two queries, of which the second one is asked first in every other turn.
    pub fn both<A, B>(
        self,
        turn: usize,
        us: impl FnMut() -> A,
        them: impl FnMut() -> B,
    ) -> ((A, f64), (B, f64)) {
        if turn.is_multiple_of(2) {
            let first = self.time(us);
            (first, self.time(them))
        } else {
            let first = self.time(them);
            (self.time(us), first)
        }
    }
}

/// Times of the same queries asked of this library and of another one.
#[derive(Debug, Clone, Default)]
pub struct Beside {
    /// Times of this library.
    pub ours: Times,
    /// Times of the other one.
    pub theirs: Times,
    /// Ratio of the times of each query, theirs over ours.
    pub ratios: Times,
}

impl Beside {
    /// Adds the times of a query.
    pub fn add(&mut self, ours: f64, theirs: f64) {
        self.ours.add(ours);
        self.theirs.add(theirs);
        self.ratios.add(theirs / ours);
    }

    /// Asks both a query, which of them first changes from query to query, and returns the answers.
    pub fn ask<A, B>(
        &mut self,
        clock: Clock,
        us: impl FnMut() -> A,
        them: impl FnMut() -> B,
    ) -> (A, B) {
        let ((mine, ours), (other, theirs)) = clock.both(self.ours.count(), us, them);
        self.add(ours, theirs);
        (mine, other)
    }

    /// Asks both all queries, a block of so many in turns, and hands on both answers to each.
    ///
    /// The contestants return an answer and the time that it took.
    pub fn in_blocks<S, A, B>(
        queries: &[S],
        length: usize,
        mut us: impl FnMut(&S) -> (A, f64),
        mut them: impl FnMut(&S) -> (B, f64),
        mut note: impl FnMut(A, B),
    ) -> Self {
        let mut beside = Self::default();
        for block in queries.chunks(length) {
            let answers: Vec<_> = block.iter().map(&mut us).collect();
            for (query, (answer, ours)) in block.iter().zip(answers) {
                let (other, theirs) = them(query);
                beside.add(ours, theirs);
                note(answer, other);
            }
        }
        beside
    }

    /// Returns the medians of ours, of theirs and of the ratios.
    pub fn medians(&self) -> [f64; 3] {
        [&self.ours, &self.theirs, &self.ratios].map(Times::median)
    }

    /// Returns our figures, `parry_median_ns`, `parry_mean_ns`, `ratio` (of means) and `ratio_of_medians`.
    pub fn to_json(&self) -> Value {
        let (ours, theirs) = (&self.ours, &self.theirs);
        let more = json!({
            "parry_median_ns": theirs.median(),
            "parry_mean_ns": theirs.mean(),
            "ratio": theirs.mean() / ours.mean(),
            "ratio_of_medians": theirs.median() / ours.median(),
        });
        merged(ours, more)
    }
}

/// Measurements of one solver in one row: times, work, failures.
#[derive(Debug, Clone, Default)]
pub struct Measured {
    /// Times of its queries.
    pub times: Times,
    /// Work of all queries that were answered.
    pub steps: Steps,
    /// Number of queries that began with the features of the last answer.
    pub by_features: u32,
    /// Number of queries without an answer.
    pub failures: u32,
}

impl Measured {
    /// Adds the time of a query, and what it came to.
    pub fn note(&mut self, spent: f64, outcome: &Result<Outcome, QueryError>) {
        self.times.add(spent);
        self.count(outcome);
    }

    /// Counts what a query came to, and returns whether it was answered.
    pub fn count(&mut self, outcome: &Result<Outcome, QueryError>) -> bool {
        let Ok(outcome) = outcome else {
            self.failures += 1;
            return false;
        };
        let steps = outcome.steps();
        self.steps.planar_problems += steps.planar_problems;
        self.steps.supports += steps.supports;
        self.steps.pivots += steps.pivots;
        self.steps.iterations += steps.iterations;
        self.by_features += u32::from(steps.started_from == StartedFrom::Features);
        true
    }
}

/// The figures of the times; planar problems, supports, pivots, iterations and starts from features on average; failures.
impl Serialize for Measured {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let average = |count: u32| f64::from(count) / self.times.count().max(1) as f64;
        let more = json!({
            "planar_problems": average(self.steps.planar_problems),
            "supports": average(self.steps.supports),
            "pivots": average(self.steps.pivots),
            "iterations": average(self.steps.iterations),
            "by_features": average(self.by_features),
            "failures": self.failures,
        });
        merged(&self.times, more).serialize(serializer)
    }
}

/// Bodies, and settings of them that a contestant answers one after the other.
pub type Block<'a> = (&'a Bodies, Vec<Setting>);

/// Draws so many blocks of several pairs in turn.
pub fn blocks(
    bodies: &[Bodies],
    count: usize,
    mut draw: impl FnMut(&Bodies) -> Vec<Setting>,
) -> Vec<Block<'_>> {
    bodies.iter().cycle().take(count).map(|bodies| (bodies, draw(bodies))).collect()
}

/// Lets contestants answer blocks in turns, and measures parry's casts after each.
///
/// Who comes first changes from block to block. `answer` answers a block as one of the contestants, `compare` takes
/// the answers of all to a block.
pub fn in_rotation<'a, R: Default, const N: usize>(
    blocks: &[Block<'a>],
    scale: &Scale,
    mut answer: impl FnMut(usize, &Block<'a>, &mut Measured) -> R,
    mut compare: impl FnMut(&[R; N]),
) -> ([Measured; N], Times) {
    let mut measured = [(); N].map(|()| Measured::default());
    let mut parry = Times::default();
    for (turn, block) in blocks.iter().enumerate() {
        let mut answers = [(); N].map(|()| R::default());
        for who in (0..N).map(|k| (turn + k) % N) {
            answers[who] = answer(who, block, &mut measured[who]);
        }
        scale.measure(&mut parry);
        compare(&answers);
    }
    (measured, parry)
}
