//! Lines to threads and results back in order, in bounded memory.
//!
//! Invariant: chunks are numbered as they are read; at most `window` chunks are read but not yet
//! written, and no more is read while those hold [`MOST_BYTES`], so a slow chunk stops the reading, not
//! the memory. A thread that reads holds
//! the input's lock while it waits for room; whoever makes room needs only the output's lock.

use std::collections::BTreeMap;
use std::io::{self, BufRead, Read, Write};
use std::ops::Range;
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
/// Bytes of lines that are being answered and of results that wait for those before them. One more line
/// may be read, and its result written.
const MOST_BYTES: usize = 64 << 20;

/// A line of the input.
#[derive(Clone, Copy)]
pub(crate) enum Line<'a> {
    /// Without its end.
    Text(&'a [u8]),
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
    /// Bytes of chunks and results under way.
    held: usize,
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
    /// The lines, one behind the other.
    text: Vec<u8>,
    /// The number of each, and where it is; `None` if it was too long.
    lines: Vec<(u64, Option<Range<usize>>)>,
    flush: bool,
    bytes_read: u64,
}

/// Bytes that are set aside for a result; most take fewer.
const RESULT_BYTES: usize = 768;

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
                held: 0,
                answered: 0,
                failed: 0,
                error: None,
            }),
            written: Condvar::new(),
            window: CHUNKS_PER_THREAD * threads as u64,
        }
    }

    /// Answers chunk after chunk until the input ends. `answer` gets a line with its number, appends
    /// the result and returns whether it is an answer.
    pub(crate) fn work(
        &self,
        mut answer: impl FnMut(u64, Line<'_>, &mut Vec<u8>) -> bool,
        bar: &ProgressBar,
    ) {
        let mut spent = Vec::new();
        while let Some(chunk) = self.next_chunk(spent) {
            let text = Vec::with_capacity(chunk.lines.len() * RESULT_BYTES);
            let mut answers = Answers { text, flush: chunk.flush, ..Answers::default() };
            for (number, range) in chunk.lines {
                let line = range.map_or(Line::TooLong, |range| Line::Text(&chunk.text[range]));
                let good = answer(number, line, &mut answers.text);
                answers.answered += 1;
                answers.failed += u64::from(!good);
            }
            let answered = self.deliver(chunk.number, chunk.text.len(), answers);
            spent = chunk.text;
            // Not for ever as much as the longest line took.
            spent.clear();
            spent.shrink_to(2 * CHUNK_BYTES);
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

    /// The next lines, in the memory of those that are done with.
    fn next_chunk(&self, spent: Vec<u8>) -> Option<Chunk> {
        let mut input = lock(&self.input);
        let mut output = lock(&self.output);
        while output.error.is_none() && output.is_full(input.chunk_number, self.window) {
            output = self.written.wait(output).unwrap_or_else(PoisonError::into_inner);
        }
        if output.error.is_some() {
            return None;
        }
        drop(output);
        let chunk = input.next_chunk(spent)?;
        lock(&self.output).held += chunk.text.len();
        Some(chunk)
    }

    /// Writes what can be written in order; returns how many queries are answered.
    fn deliver(&self, number: u64, read: usize, mut answers: Answers) -> u64 {
        answers.text.shrink_to_fit();
        let mut output = lock(&self.output);
        output.held = output.held - read + answers.text.len();
        output.waiting.insert(number, answers);
        output.write_in_order();
        self.written.notify_all();
        output.answered
    }
}

impl Input {
    fn next_chunk(&mut self, mut text: Vec<u8>) -> Option<Chunk> {
        text.clear();
        let mut lines = Vec::with_capacity(CHUNK_LINES);
        // Never wait for a second line while the first could be answered.
        while !self.ended
            && lines.len() < CHUNK_LINES
            && text.len() < CHUNK_BYTES
            && (lines.is_empty() || self.has_line())
        {
            match self.next_line(&mut text) {
                Ok(Some(line)) => match line.clone() {
                    // Nothing of a blank line is kept, however many there are.
                    Some(line) if text[line.clone()].trim_ascii().is_empty() => {
                        text.truncate(line.start);
                    }
                    _ => lines.push((self.line_number, line)),
                },
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
        let flush = !self.has_line();
        Some(Chunk { number, text, lines, flush, bytes_read: self.bytes })
    }

    /// Whether a whole line has been read ahead.
    fn has_line(&self) -> bool {
        memchr::memchr(b'\n', self.queries.buffer()).is_some()
    }

    /// Appends a line to the text; where it is, or `Some(None)` if it is too long and was skipped.
    #[expect(clippy::option_option, reason = "the input may end, and a line may be too long")]
    fn next_line(&mut self, text: &mut Vec<u8>) -> io::Result<Option<Option<Range<usize>>>> {
        let start = text.len();
        let read = read_line(&mut self.queries, text)?;
        if read == 0 {
            return Ok(None);
        }
        self.bytes += read as u64;
        self.line_number += 1;
        let ends = text.last() == Some(&b'\n');
        if ends || (read as u64) < LINE_LIMIT {
            return Ok(Some(Some(start..text.len() - usize::from(ends))));
        }
        text.truncate(start);
        self.bytes += self.queries.skip_until(b'\n')? as u64;
        Ok(Some(None))
    }
}

/// Appends what is read up to the end of a line, or [`LINE_LIMIT`] bytes; how many there were. Searched in
/// lanes, which [`BufRead::read_until`] does not.
fn read_line(queries: &mut Queries, text: &mut Vec<u8>) -> io::Result<usize> {
    let mut queries = queries.take(LINE_LIMIT);
    let mut read = 0;
    loop {
        let ahead = match queries.fill_buf() {
            Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
            ahead => ahead?,
        };
        let end = memchr::memchr(b'\n', ahead).map(|end| end + 1);
        let taken = end.unwrap_or(ahead.len());
        text.extend_from_slice(&ahead[..taken]);
        queries.consume(taken);
        read += taken;
        if end.is_some() || taken == 0 {
            return Ok(read);
        }
    }
}

impl Output {
    /// Whether the chunk of a number must wait. The one that is to be written next never does.
    fn is_full(&self, chunk: u64, window: u64) -> bool {
        chunk >= self.next + window || chunk > self.next && self.held > MOST_BYTES
    }

    fn write_in_order(&mut self) {
        while let Some(answers) = self.waiting.remove(&self.next) {
            self.held -= answers.text.len();
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
