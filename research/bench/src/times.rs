//! Measures queries of contestants in turns, and summarises the times.

use std::hint::black_box;

use colltrans::{Outcome, QueryError, StartedFrom, Steps};
use colltrans_lab::settings::Setting;
use colltrans_lab::shapes::Bodies;
use colltrans_testkit::timing::{Stopwatch, mean_and_deviation, quantile, without_disturbed};
use serde::{Serialize, Serializer};
use serde_json::{Value, json};

use crate::harness::merge_objects;
use crate::parry::ReferenceCasts;

/// Times of single queries, in nanoseconds. As JSON: `median_ns`, `mean_ns`, `p90_ns` and `p99_ns`.
#[derive(Debug, Clone, Default)]
pub struct Times(Vec<f64>);

impl Times {
    /// Adds a time.
    pub fn add(&mut self, nanoseconds: f64) {
        self.0.push(nanoseconds);
    }

    /// Returns the number of times.
    pub fn count(&self) -> usize {
        self.0.len()
    }

    /// Returns the time that this share of the times does not exceed; NaN if there are no times.
    pub fn quantile(&self, share: f64) -> f64 {
        quantile(&self.0, share)
    }

    /// Returns the median; NaN if there are no times.
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

/// Measures the time of queries.
#[derive(Debug, Clone, Copy)]
pub struct Clock {
    stopwatch: Stopwatch,
    /// Number of repetitions of each query; their mean is the query's time.
    pub repeat: u32,
}

impl Clock {
    /// Returns a clock that takes the mean of `repeat` repetitions of each query, at least one.
    pub fn new(repeat: u32) -> Self {
        Self { stopwatch: Stopwatch::new(), repeat: repeat.max(1) }
    }

    /// Returns the last answer of a query, and the nanoseconds of one repetition.
    pub fn time<T>(self, mut query: impl FnMut() -> T) -> (T, f64) {
        let all = || {
            (1..self.repeat).for_each(|_| drop(black_box(query())));
            query()
        };
        let (answer, spent) = self.stopwatch.time(all);
        (answer, spent / f64::from(self.repeat))
    }

    /// Returns the answers and times of two queries. Their order changes from turn to turn.
    pub fn time_both<A, B>(
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

/// Times of the same queries in this library and in another one.
#[derive(Debug, Clone, Default)]
pub struct Comparison {
    /// Times of this library.
    pub ours: Times,
    /// Times of the other library.
    pub theirs: Times,
    /// Ratios of the times of each query, theirs over ours.
    pub ratios: Times,
}

impl Comparison {
    /// Adds the times of a query.
    pub fn add(&mut self, ours: f64, theirs: f64) {
        self.ours.add(ours);
        self.theirs.add(theirs);
        self.ratios.add(theirs / ours);
    }

    /// Sends a query to both libraries and returns the answers. The order changes from query to query.
    pub fn compare_query<A, B>(
        &mut self,
        clock: Clock,
        us: impl FnMut() -> A,
        them: impl FnMut() -> B,
    ) -> (A, B) {
        let ((mine, ours), (other, theirs)) = clock.time_both(self.ours.count(), us, them);
        self.add(ours, theirs);
        (mine, other)
    }

    /// Sends all queries to both libraries, in alternating blocks of `length`, and passes both answers of each
    /// query on.
    ///
    /// The contestants return an answer and its time.
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

    /// Returns the medians of our times, of theirs, and of the ratios.
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
        merge_objects(ours, more)
    }
}

/// Measurements of one solver in one row: times, work, failures.
#[derive(Debug, Clone, Default)]
pub struct SolverFigures {
    /// Times of its queries.
    pub times: Times,
    /// Work of all answered queries.
    pub steps: Steps,
    /// Number of queries that started from the features of the last answer.
    pub by_features: u32,
    /// Number of queries without an answer.
    pub failures: u32,
}

impl SolverFigures {
    /// Adds the time and the outcome of a query.
    pub fn add_outcome(&mut self, spent: f64, outcome: &Result<Outcome, QueryError>) {
        self.times.add(spent);
        self.count(outcome);
    }

    /// Counts the outcome of a query, and returns whether it was answered.
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

/// As JSON: the figures of the times; the means of planar problems, supports, pivots, iterations and starts
/// from features; the failures.
impl Serialize for SolverFigures {
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
        merge_objects(&self.times, more).serialize(serializer)
    }
}

/// Bodies, and the settings of them that a contestant answers in a row.
pub type Block<'a> = (&'a Bodies, Vec<Setting>);

/// Draws `count` blocks, of several pairs in turn.
pub fn blocks(
    bodies: &[Bodies],
    count: usize,
    mut draw: impl FnMut(&Bodies) -> Vec<Setting>,
) -> Vec<Block<'_>> {
    bodies.iter().cycle().take(count).map(|bodies| (bodies, draw(bodies))).collect()
}

/// Measures contestants on blocks in turns, and parry's casts after each block.
///
/// The order changes from block to block. `answer` answers a block as one of the contestants. `compare` takes
/// the answers of all contestants to a block.
pub fn measure_in_turns<'a, R: Default, const N: usize>(
    blocks: &[Block<'a>],
    scale: &ReferenceCasts,
    mut answer: impl FnMut(usize, &Block<'a>, &mut SolverFigures) -> R,
    mut compare: impl FnMut(&[R; N]),
) -> ([SolverFigures; N], Times) {
    let mut measured = [(); N].map(|()| SolverFigures::default());
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
