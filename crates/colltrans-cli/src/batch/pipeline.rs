//! Lines to threads and results back in order, in bounded memory.
//!
//! Invariant: chunks are numbered as they are read; at most `window` chunks are read but not yet
//! written, so a slow chunk stops the reading, not the memory. A thread that reads holds
//! the input's lock while it waits for room; whoever makes room needs only the output's lock.

use std::collections::BTreeMap;
use std::io::{self, BufRead, Read, Write};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

use indicatif::ProgressBar;

use super::Queries;
use super::results::Writer;

/// A line may have this many bytes.
const LINE_LIMIT: u64 = 64 << 20;
/// A chunk ends after this many lines or bytes.
const CHUNK_LINES: usize = 256;
const CHUNK_BYTES: usize = 1 << 20;
/// Chunks under way per thread.
const CHUNKS_PER_THREAD: u64 = 4;

/// A line of the input.
pub(crate) enum Line {
    /// Without its end.
    Text(Vec<u8>),
    /// It was longer than the limit and was skipped.
    TooLong,
}

/// How the work ended.
pub(crate) struct End {
    pub(crate) answered: u64,
    pub(crate) failed: u64,
    pub(crate) read_error: Option<io::Error>,
    pub(crate) write_error: Option<io::Error>,
}

/// What all threads share.
pub(crate) struct Pipeline {
    input: Mutex<Input>,
    output: Mutex<Output>,
    written: Condvar,
    window: u64,
}

struct Input {
    queries: Queries,
    line_number: u64,
    chunk_number: u64,
    ended: bool,
    bytes: u64,
    error: Option<io::Error>,
}

struct Output {
    results: Writer,
    /// Number of the chunk that is to be written next.
    next: u64,
    waiting: BTreeMap<u64, Answers>,
    answered: u64,
    failed: u64,
    error: Option<io::Error>,
}

#[derive(Default)]
struct Answers {
    text: Vec<u8>,
    answered: u64,
    failed: u64,
    /// Nothing more to read right now: whoever waits for the results should have them.
    flush: bool,
}

struct Chunk {
    number: u64,
    lines: Vec<(u64, Line)>,
    flush: bool,
    bytes_read: u64,
}

impl Pipeline {
    pub(crate) fn new(queries: Queries, results: Writer, threads: usize) -> Self {
        Self {
            input: Mutex::new(Input {
                queries,
                line_number: 0,
                chunk_number: 0,
                ended: false,
                bytes: 0,
                error: None,
            }),
            output: Mutex::new(Output {
                results,
                next: 0,
                waiting: BTreeMap::new(),
                answered: 0,
                failed: 0,
                error: None,
            }),
            written: Condvar::new(),
            window: CHUNKS_PER_THREAD * threads as u64,
        }
    }

    /// Answers chunk after chunk until the input ends. `answer` gets a line with its number and
    /// returns the result and whether it is one.
    pub(crate) fn work(&self, answer: impl Fn(u64, Line) -> (String, bool), bar: &ProgressBar) {
        while let Some(chunk) = self.next_chunk() {
            let mut answers = Answers { flush: chunk.flush, ..Answers::default() };
            for (number, line) in chunk.lines {
                let (text, good) = answer(number, line);
                answers.text.extend_from_slice(text.as_bytes());
                answers.text.push(b'\n');
                answers.answered += 1;
                answers.failed += u64::from(!good);
            }
            let answered = self.deliver(chunk.number, answers);
            bar.set_position(chunk.bytes_read);
            bar.set_message(answered.to_string());
        }
    }

    pub(crate) fn finish(self) -> End {
        let input = self.input.into_inner().unwrap_or_else(PoisonError::into_inner);
        let mut output = self.output.into_inner().unwrap_or_else(PoisonError::into_inner);
        let write_error = output.error.take().or_else(|| output.results.flush().err());
        End {
            answered: output.answered,
            failed: output.failed,
            read_error: input.error,
            write_error,
        }
    }

    fn next_chunk(&self) -> Option<Chunk> {
        let mut input = lock(&self.input);
        let mut output = lock(&self.output);
        while output.error.is_none() && input.chunk_number >= output.next + self.window {
            output = self.written.wait(output).unwrap_or_else(PoisonError::into_inner);
        }
        if output.error.is_some() {
            return None;
        }
        drop(output);
        input.next_chunk()
    }

    /// Writes what can be written in order; returns how many queries are answered.
    fn deliver(&self, number: u64, answers: Answers) -> u64 {
        let mut output = lock(&self.output);
        output.waiting.insert(number, answers);
        output.write_in_order();
        self.written.notify_all();
        output.answered
    }
}

impl Input {
    fn next_chunk(&mut self) -> Option<Chunk> {
        let mut lines = Vec::new();
        let mut bytes = 0;
        // Never wait for a second line while the first could be answered.
        while !self.ended
            && lines.len() < CHUNK_LINES
            && bytes < CHUNK_BYTES
            && (lines.is_empty() || self.queries.buffer().contains(&b'\n'))
        {
            match self.next_line() {
                Ok(Some(line)) => {
                    bytes += if let Line::Text(text) = &line { text.len() } else { 0 };
                    if !matches!(&line, Line::Text(text) if text.trim_ascii().is_empty()) {
                        lines.push((self.line_number, line));
                    }
                }
                Ok(None) => self.ended = true,
                Err(error) => {
                    self.ended = true;
                    self.error = Some(error);
                }
            }
        }
        if lines.is_empty() {
            return None;
        }
        let number = self.chunk_number;
        self.chunk_number += 1;
        let flush = !self.queries.buffer().contains(&b'\n');
        Some(Chunk { number, lines, flush, bytes_read: self.bytes })
    }

    fn next_line(&mut self) -> io::Result<Option<Line>> {
        let mut text = Vec::new();
        let read = (&mut self.queries).take(LINE_LIMIT).read_until(b'\n', &mut text)?;
        if read == 0 {
            return Ok(None);
        }
        self.bytes += read as u64;
        self.line_number += 1;
        if text.last() == Some(&b'\n') {
            text.pop();
            return Ok(Some(Line::Text(text)));
        }
        if (read as u64) < LINE_LIMIT {
            return Ok(Some(Line::Text(text)));
        }
        drop(text);
        self.bytes += self.queries.skip_until(b'\n')? as u64;
        Ok(Some(Line::TooLong))
    }
}

impl Output {
    fn write_in_order(&mut self) {
        while let Some(answers) = self.waiting.remove(&self.next) {
            self.next += 1;
            self.answered += answers.answered;
            self.failed += answers.failed;
            if self.error.is_some() {
                continue;
            }
            let written = self
                .results
                .write_all(&answers.text)
                .and_then(|()| if answers.flush { self.results.flush() } else { Ok(()) });
            self.error = written.err();
        }
    }
}

/// No thread leaves the shared state half changed, so a poisoned lock is as good as any.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
