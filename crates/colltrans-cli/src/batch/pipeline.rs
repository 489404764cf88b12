//! Distributes chunks of lines to threads, and writes their results in order, in bounded memory.
//!
//! Invariants:
//! - Chunks are numbered in the order of reading. At most `window` chunks have been read but not written.
//! - No chunk is read while more than [`MAX_BYTES`] are held, except for the one to be written next. Therefore a slow
//!   chunk stops the reading.
//! - A thread that reads holds the lock of the input while it waits. Writing needs only the lock of the output.

use std::collections::BTreeMap;
use std::io::{self, BufRead, Read, Write};
use std::ops::Range;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

use indicatif::ProgressBar;

use super::Queries;
use super::results::Writer;

/// Maximum length of a line in bytes.
const LINE_LIMIT: u64 = 64 << 20;
/// Maximum number of lines of a chunk.
const CHUNK_LINES: usize = 256;
/// Number of bytes after which a chunk ends.
const CHUNK_BYTES: usize = 1 << 20;
/// Maximum number of unwritten chunks per thread.
const CHUNKS_PER_THREAD: u64 = 4;
/// Number of bytes of lines that are being answered and of results that wait for earlier ones, above which no chunk is
/// read. The chunk to be written next is read in any case. One chunk, and results that are longer than their lines, may
/// exceed the limit.
const MAX_BYTES: usize = 64 << 20;

/// A line of the input.
#[derive(Clone, Copy)]
pub(crate) enum Line<'a> {
    /// The line without its line feed.
    Text(&'a [u8]),
    /// A line beyond the limit, which was skipped.
    TooLong,
}

/// The numbers of answers and the errors at the end.
pub(crate) struct Summary {
    pub(crate) answered: u64,
    pub(crate) failed: u64,
    pub(crate) read_error: Option<io::Error>,
    pub(crate) write_error: Option<io::Error>,
}

/// The state that all threads share.
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
    /// Number of the chunk to be written next.
    next: u64,
    waiting: BTreeMap<u64, Answers>,
    /// Bytes of chunks and results that are not written yet.
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
    /// Whether to flush after these results, because no further line is available at the moment.
    flush: bool,
}

struct Chunk {
    number: u64,
    /// The lines, concatenated.
    text: Vec<u8>,
    /// The number of each line and its range in the text; `None` if it was too long.
    lines: Vec<(u64, Option<Range<usize>>)>,
    flush: bool,
    bytes_read: u64,
}

/// Bytes reserved for a result. Most results are shorter.
const RESULT_BYTES: usize = 768;

impl Pipeline {
    /// Returns the pipeline from queries to results for a number of threads.
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

    /// Answers chunks until the input ends or the results cannot be written. `answer` gets a line with its number,
    /// appends the result to the buffer and returns whether the result is an answer.
    pub(crate) fn answer_chunks(
        &self,
        mut answer: impl FnMut(u64, Line<'_>, &mut Vec<u8>) -> bool,
        bar: &ProgressBar,
    ) {
        let mut buffer = Vec::new();
        while let Some(chunk) = self.next_chunk(buffer) {
            let text = Vec::with_capacity(chunk.lines.len() * RESULT_BYTES);
            let mut answers = Answers { text, flush: chunk.flush, ..Answers::default() };
            for (number, range) in chunk.lines {
                let line = range.map_or(Line::TooLong, |range| Line::Text(&chunk.text[range]));
                let is_answer = answer(number, line, &mut answers.text);
                answers.answered += 1;
                answers.failed += u64::from(!is_answer);
            }
            let answered = self.deliver(chunk.number, chunk.text.len(), answers);
            buffer = chunk.text;
            // Releases the memory of very long lines.
            buffer.clear();
            buffer.shrink_to(2 * CHUNK_BYTES);
            bar.set_position(chunk.bytes_read);
            bar.set_message(answered.to_string());
        }
    }

    /// Flushes the results. Returns the numbers of answers and the errors.
    pub(crate) fn finish(self) -> Summary {
        let input = self.input.into_inner().unwrap_or_else(PoisonError::into_inner);
        let mut output = self.output.into_inner().unwrap_or_else(PoisonError::into_inner);
        let write_error = output.error.take().or_else(|| output.results.flush().err());
        Summary {
            answered: output.answered,
            failed: output.failed,
            read_error: input.error,
            write_error,
        }
    }

    /// Waits until a chunk may be read, and reads it into `buffer`. Returns `None` at the end of the input, or after an
    /// error of writing.
    fn next_chunk(&self, buffer: Vec<u8>) -> Option<Chunk> {
        let mut input = lock(&self.input);
        let mut output = lock(&self.output);
        while output.error.is_none() && output.is_full(input.chunk_number, self.window) {
            output = self.written.wait(output).unwrap_or_else(PoisonError::into_inner);
        }
        if output.error.is_some() {
            return None;
        }
        drop(output);
        let chunk = input.next_chunk(buffer)?;
        lock(&self.output).held += chunk.text.len();
        Some(chunk)
    }

    /// Stores the results of a chunk, and writes all that are next in order. Returns the number of written answers.
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
    /// Reads a chunk into `text`; returns `None` at the end of the input.
    fn next_chunk(&mut self, mut text: Vec<u8>) -> Option<Chunk> {
        text.clear();
        let mut lines = Vec::with_capacity(CHUNK_LINES);
        // Does not wait for a second line while the first one could be answered.
        while !self.ended
            && lines.len() < CHUNK_LINES
            && text.len() < CHUNK_BYTES
            && (lines.is_empty() || self.has_line())
        {
            match self.next_line(&mut text) {
                Ok(Some(line)) => match line.clone() {
                    // Blank lines are dropped.
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

    /// Checks whether the buffer has a complete line.
    fn has_line(&self) -> bool {
        memchr::memchr(b'\n', self.queries.buffer()).is_some()
    }

    /// Appends a line to the text. Returns its range, `Some(None)` if it was too long and skipped, or `None` at the end.
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

/// Appends bytes up to a line feed, at most [`LINE_LIMIT`]. Returns their number. `memchr` searches in SIMD lanes, in
/// contrast to [`BufRead::read_until`].
fn read_line(queries: &mut Queries, text: &mut Vec<u8>) -> io::Result<usize> {
    let mut queries = queries.take(LINE_LIMIT);
    let mut read = 0;
    loop {
        let ahead = match queries.fill_buf() {
            Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
            ahead => ahead?,
        };
        let end = memchr::memchr(b'\n', ahead).map(|end| end + 1);
        let consumed = end.unwrap_or(ahead.len());
        text.extend_from_slice(&ahead[..consumed]);
        queries.consume(consumed);
        read += consumed;
        if end.is_some() || consumed == 0 {
            return Ok(read);
        }
    }
}

impl Output {
    /// Checks whether a chunk must wait before it is read. The one to be written next never waits.
    fn is_full(&self, chunk: u64, window: u64) -> bool {
        chunk >= self.next + window || chunk > self.next && self.held > MAX_BYTES
    }

    /// Writes all results that are next in order.
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

/// Locks a state. A poisoned lock is usable, because no thread leaves the shared state half changed.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
