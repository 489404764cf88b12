//! Bulk queries: rows are answered on any number of threads, without the interpreter's lock.
//!
//! The rows are cut into chunks, each with its own part of every column, and threads take chunks until none
//! is left. Threads live for one call, because a forked process would lose a pool, and because starting a
//! thread costs only as much as some ten casts. A row without an answer has the outcome *error* and a
//! message, even if a panic ended it.
//!
//! The calling thread answers rows too. Between rows it polls for signals, at most ten times a second, so that
//! Ctrl-C ends the call. It does not poll while it waits for the last rows of other threads.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use numpy::IntoPyArray;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::table;
use crate::columns::{Corners, FEATURES, Places, Row};

/// Number of rows between two reads of the clock.
const LOOK: usize = 16;
/// Time between two polls for signals.
const PATIENCE: Duration = Duration::from_millis(100);

/// The columns by name, the names of the outcomes, and the messages by row.
pub(crate) type Answered<'py> = (Bound<'py, PyDict>, &'static [&'static str], Bound<'py, PyDict>);

/// The rows, columns and threads of a bulk query.
pub(crate) struct Plan<'a> {
    pub(crate) rows: usize,
    /// Number of rows that a thread takes at a time.
    pub(crate) chunk: usize,
    pub(crate) columns: &'a [String],
    /// Whether to add the columns of features.
    pub(crate) featured: bool,
    /// Names of the outcomes. The last one is that of a row without an answer.
    pub(crate) outcomes: &'static [&'static str],
    /// Number of threads; `None` for all processors.
    pub(crate) threads: Option<usize>,
}

impl Plan<'_> {
    /// Answers all rows. `answer` writes the answer of a row, or returns the reason for its absence.
    pub(crate) fn run<'py>(
        &self,
        py: Python<'py>,
        answer: impl Fn(usize, &mut Row<'_>) -> Result<(), String> + Sync,
    ) -> PyResult<Answered<'py>> {
        let mut columns = Columns::new(self.rows, self.columns, self.featured);
        let failures = Failures::default();
        let error = self.outcomes.len() as u8 - 1;
        let ask = |number: usize, row: &mut Row<'_>| {
            if let Err(message) = answer_or_bug(|| answer(number, row)) {
                row.clear();
                row.set_outcome(error);
                failures.lock().unwrap_or_else(PoisonError::into_inner).push((number, message));
            }
        };
        let parts = columns.chunks(self.chunk);
        py.detach(|| {
            run_on_threads(parts, self.threads, |(first, part), stop| {
                answer_chunk(&ask, first, part, stop);
            })
        })?;
        let mut failures = failures.into_inner().unwrap_or_else(PoisonError::into_inner);
        failures.sort_unstable();
        let messages = PyDict::new(py);
        failures.into_iter().try_for_each(|(row, message)| messages.set_item(row, message))?;
        Ok((columns.into_python(py)?, self.outcomes, messages))
    }
}

/// All columns.
struct Columns {
    places: Places,
    outcome: Vec<u8>,
    numbers: Vec<Vec<f64>>,
    vectors: Vec<Vec<[f64; 3]>>,
    features: Vec<Vec<Corners>>,
}

impl Columns {
    fn new(n: usize, names: &[String], featured: bool) -> Self {
        let places = Places::new(names);
        let [numbers, vectors] = places.names().map(|names| names.len());
        // Memory of zeros is provided on first access, by the threads that answer the rows.
        let (numbers, vectors) = (vec![vec![0.0; n]; numbers], vec![vec![[0.0; 3]; n]; vectors]);
        let corners = vec![vec![[0; 3]; n]; if featured { FEATURES.len() } else { 0 }];
        Self { places, outcome: vec![0; n], numbers, vectors, features: corners }
    }

    /// Returns the columns by their names.
    fn into_python(self, py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
        let found = PyDict::new(py);
        found.set_item("outcome", self.outcome.into_pyarray(py))?;
        let [numbers, vectors] = self.places.names();
        for (name, column) in numbers.into_iter().zip(self.numbers) {
            found.set_item(name, column.into_pyarray(py))?;
        }
        for (name, column) in vectors.into_iter().zip(self.vectors) {
            found.set_item(name, table(py, column)?)?;
        }
        for (name, column) in FEATURES.iter().zip(self.features) {
            found.set_item(name, table(py, column)?)?;
        }
        Ok(found)
    }

    /// Cuts all columns into chunks of rows, each with the number of its first row.
    fn chunks(&mut self, chunk: usize) -> Vec<(usize, Row<'_>)> {
        let mut numbers: Vec<_> = self.numbers.iter_mut().map(|c| c.chunks_mut(chunk)).collect();
        let mut vectors: Vec<_> = self.vectors.iter_mut().map(|c| c.chunks_mut(chunk)).collect();
        let mut features: Vec<_> = self.features.iter_mut().map(|c| c.chunks_mut(chunk)).collect();
        let part = |(k, outcomes)| {
            let row = Row {
                at: 0,
                places: &self.places,
                outcomes,
                numbers: numbers.iter_mut().filter_map(Iterator::next).collect(),
                vectors: vectors.iter_mut().filter_map(Iterator::next).collect(),
                features: features.iter_mut().filter_map(Iterator::next).collect(),
            };
            (k * chunk, row)
        };
        self.outcome.chunks_mut(chunk).enumerate().map(part).collect()
    }
}

/// Rows without an answer, with the reasons.
type Failures = Mutex<Vec<(usize, String)>>;

/// Answers the rows of a chunk, until `stop` returns true. `first` is the number of the first row.
fn answer_chunk(
    ask: &impl Fn(usize, &mut Row<'_>),
    first: usize,
    mut row: Row<'_>,
    stop: &mut dyn FnMut() -> bool,
) {
    row.clear_all();
    for at in 0..row.outcomes.len() {
        if at % LOOK == 0 && stop() {
            return;
        }
        row.at = at;
        ask(first + at, &mut row);
    }
}

/// Returns the answer of a row or the reason for its absence. A panic becomes a message.
fn answer_or_bug<T>(answer: impl FnOnce() -> Result<T, String>) -> Result<T, String> {
    catch_unwind(AssertUnwindSafe(answer))
        .unwrap_or_else(|_| Err("internal error; please report it".into()))
}

/// Answers rows on `threads` threads, each with its answer or the reason for its absence.
pub(crate) fn each<T: Send>(
    rows: usize,
    chunk: usize,
    threads: Option<usize>,
    ask: impl Fn(usize) -> Result<T, String> + Sync,
) -> PyResult<Vec<Result<T, String>>> {
    let mut answers: Vec<_> = std::iter::repeat_with(|| None).take(rows).collect();
    let parts = answers.chunks_mut(chunk).enumerate().collect();
    run_on_threads(parts, threads, |(k, part), stop| {
        for (row, answer) in (k * chunk..).zip(part) {
            if stop() {
                return;
            }
            *answer = Some(answer_or_bug(|| ask(row)));
        }
    })?;
    Ok(answers.into_iter().flatten().collect())
}

/// Returns the requested number of threads, or the number of processors.
pub(crate) fn thread_count(requested: Option<usize>) -> usize {
    let all = || std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    requested.unwrap_or_else(all)
}

/// Processes all parts on `threads` threads, or on all processors.
///
/// If a signal handler raises, the second argument of `work` returns true from then on, and the exception is
/// returned after all threads have ended.
fn run_on_threads<P: Send>(
    parts: Vec<P>,
    threads: Option<usize>,
    work: impl Fn(P, &mut dyn FnMut() -> bool) + Sync,
) -> PyResult<()> {
    let threads = thread_count(threads).clamp(1, parts.len().max(1));
    let parts = Mutex::new(parts.into_iter());
    let next = || parts.lock().unwrap_or_else(PoisonError::into_inner).next();
    let stopped = AtomicBool::new(false);
    let mut raised = Ok(());
    let mut looked = Instant::now();
    let mut look = || {
        if looked.elapsed() > PATIENCE {
            looked = Instant::now();
            raised = Python::attach(|py| py.check_signals());
            stopped.store(raised.is_err(), Ordering::Relaxed);
        }
        stopped.load(Ordering::Relaxed)
    };
    std::thread::scope(|scope| {
        for _ in 1..threads {
            scope.spawn(|| {
                while let Some(part) = next() {
                    work(part, &mut || stopped.load(Ordering::Relaxed));
                }
            });
        }
        while let Some(part) = next() {
            work(part, &mut look);
        }
    });
    raised
}
