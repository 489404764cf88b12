//! What every report of measurements needs: many times in a few numbers, and where they come from.

use std::fs;
use std::process::ExitCode;

use colltrans::{Outcome, QueryError, StartedFrom, Steps};
use colltrans_testkit::provenance::Provenance;
use serde_json::{Value, json};

use crate::arguments::Arguments;

/// Times of single queries, in nanoseconds.
#[derive(Debug, Clone, Default)]
pub struct Times {
    nanoseconds: Vec<f64>,
    is_sorted: bool,
}

impl Times {
    /// One more.
    pub fn add(&mut self, nanoseconds: f64) {
        self.nanoseconds.push(nanoseconds);
        self.is_sorted = false;
    }

    /// How many.
    pub fn count(&self) -> usize {
        self.nanoseconds.len()
    }

    /// Sorts them, for what follows.
    pub fn sort(&mut self) {
        self.nanoseconds.sort_by(f64::total_cmp);
        self.is_sorted = true;
    }

    /// The time that a share of them does not exceed; NaN if there are none.
    ///
    /// # Panics
    /// If they are not sorted.
    pub fn quantile(&self, share: f64) -> f64 {
        assert!(self.is_sorted || self.nanoseconds.is_empty(), "times are sorted first");
        let last = self.nanoseconds.len().saturating_sub(1);
        let at = (last as f64 * share).round() as usize;
        self.nanoseconds.get(at).copied().unwrap_or(f64::NAN)
    }

    /// The median.
    pub fn median(&self) -> f64 {
        self.quantile(0.5)
    }

    /// Mean of all but the slowest hundredth, which other programs on the machine cause.
    ///
    /// # Panics
    /// If they are not sorted.
    pub fn mean(&self) -> f64 {
        assert!(self.is_sorted || self.nanoseconds.is_empty(), "times are sorted first");
        let kept = &self.nanoseconds[..(self.nanoseconds.len() * 99).div_ceil(100)];
        kept.iter().sum::<f64>() / kept.len() as f64
    }

    /// `median_ns`, `mean_ns`, `p90_ns` and `p99_ns`.
    pub fn to_json(&self) -> serde_json::Map<String, Value> {
        let figures = [
            ("median_ns", self.median()),
            ("mean_ns", self.mean()),
            ("p90_ns", self.quantile(0.9)),
            ("p99_ns", self.quantile(0.99)),
        ];
        figures.into_iter().map(|(name, value)| (name.into(), json!(value))).collect()
    }
}

/// Measurements of one solver in one row: times, work, failures.
#[derive(Debug, Clone, Default)]
pub struct Measured {
    /// Of its queries.
    pub times: Times,
    /// Work of all queries that were answered.
    pub steps: Steps,
    /// How many of them began with the features of the last answer.
    pub by_features: u32,
    /// Queries without an answer.
    pub failures: u32,
}

impl Measured {
    /// The time of a query, and what it came to.
    pub fn note(&mut self, spent: f64, outcome: &Result<Outcome, QueryError>) {
        self.times.add(spent);
        self.count(outcome);
    }

    /// What a query came to; whether it was answered.
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

    /// A count for each time.
    pub fn average(&self, count: u32) -> f64 {
        f64::from(count) / self.times.count().max(1) as f64
    }

    /// The times, the work on average, more counts of this program's, and the failures.
    pub fn to_json(&self, more: &[(&str, u32)]) -> serde_json::Map<String, Value> {
        let mut json = self.times.to_json();
        let counts = [
            ("planar_problems", self.steps.planar_problems),
            ("supports", self.steps.supports),
            ("pivots", self.steps.pivots),
        ];
        for &(name, count) in counts.iter().chain(more) {
            json.insert(name.into(), json!(self.average(count)));
        }
        json.insert("failures".into(), json!(self.failures));
        json
    }
}

/// Writes the rows with what they were measured on, and by which program, if a file was named.
pub fn write(program: &str, arguments: &Arguments, rows: &[Value]) -> ExitCode {
    let Some(path) = &arguments.json else { return ExitCode::SUCCESS };
    let mut report = Provenance::of_this_process("parry3d-f64 0.31.1").to_json();
    report["program"] = json!(program);
    report["seed"] = json!(arguments.seed);
    report["rows"] = json!(rows);
    match fs::write(path, format!("{report:#}\n")) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {}: {error}", path.display());
            ExitCode::FAILURE
        }
    }
}
