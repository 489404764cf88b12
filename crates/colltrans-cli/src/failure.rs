//! Failures of a command, with messages and an exit code, and notes on standard error.

use std::fmt::Display;
use std::io::{self, Write};
use std::process::ExitCode;

use crate::streams::standard_output;
use crate::terminal::{escape_json, escape_line, escape_lines};

/// The exit codes other than 0, as `colltrans help files` documents them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Code {
    /// Some lines of a batch have no answer, or pairs of an audit violate their clearance.
    Lines = 1,
    /// The command line is wrong.
    Usage = 2,
    /// A file cannot be read, or is not an acceptable body.
    Input = 3,
    /// The query has no certified answer.
    Query = 4,
    /// The answer cannot be written.
    Output = 5,
    /// A proof does not hold.
    Refused = 6,
    /// With --strict, the answer is about less than the input.
    Partial = 7,
}

/// Prints a note on standard error. The command continues.
pub(crate) fn note(text: &str) {
    // `eprintln!` would panic if standard error is closed.
    let line = format!("note: {}\n", escape_line(text));
    let _ = io::stderr().write_all(line.as_bytes());
}

/// Prints an answer as text on standard output.
pub(crate) fn print(text: &str) -> Result<(), Failure> {
    write_output(&escape_lines(text))
}

/// Prints an answer in JSON on standard output.
pub(crate) fn print_json(text: &str) -> Result<(), Failure> {
    write_output(&escape_json(text))
}

/// Writes text to standard output, and flushes it.
fn write_output(text: &str) -> Result<(), Failure> {
    let written = standard_output().and_then(|mut out| {
        out.write_all(text.as_bytes())?;
        out.flush()
    });
    written.map_err(|error| Failure::write_error("standard output", &error))
}

/// The error of a command.
#[derive(Debug)]
pub(crate) struct Failure {
    code: Code,
    /// Empty if the reader of a pipe has closed it, which is not an error.
    messages: Vec<String>,
}

impl Failure {
    /// Returns a failure with one message.
    pub(crate) fn new(code: Code, message: impl Into<String>) -> Self {
        Self { code, messages: vec![message.into()] }
    }

    /// Returns a failure with several messages.
    pub(crate) fn with_messages(code: Code, messages: Vec<String>) -> Self {
        Self { code, messages }
    }

    /// Returns the failure that an output cannot be written to `place`. A closed pipe has no message.
    pub(crate) fn write_error(place: impl Display, error: &io::Error) -> Self {
        let is_reported = error.kind() != io::ErrorKind::BrokenPipe;
        let message = is_reported.then(|| format!("{place}: cannot be written: {error}"));
        Self { code: Code::Output, messages: message.into_iter().collect() }
    }

    /// Returns all messages as one line.
    pub(crate) fn into_message(self) -> String {
        self.messages.join("; ")
    }

    /// Returns the exit code of a failure with messages.
    pub(crate) const fn code(&self) -> Code {
        self.code
    }

    /// Prints the messages on standard error.
    pub(crate) fn print_messages(&self) {
        // `eprintln!` would panic if standard error is closed.
        for message in &self.messages {
            let line = format!("error: {}\n", escape_line(message));
            let _ = io::stderr().write_all(line.as_bytes());
        }
    }

    /// Prints the messages on standard error. Returns the exit code: success if there are none.
    pub(crate) fn report(self) -> ExitCode {
        self.print_messages();
        if self.messages.is_empty() { ExitCode::SUCCESS } else { ExitCode::from(self.code as u8) }
    }
}

impl From<colltrans::removal::directions::FreeError> for Failure {
    fn from(error: colltrans::removal::directions::FreeError) -> Self {
        use colltrans::removal::directions::FreeError::{Open, Query};
        match error {
            Query(error) => error.into(),
            Open { .. } => Self::new(Code::Input, error.to_string()),
            _ => Self::new(Code::Query, error.to_string()),
        }
    }
}

impl From<colltrans::QueryError> for Failure {
    fn from(error: colltrans::QueryError) -> Self {
        use colltrans::QueryError::{
            Direction, GrazeTolerance, Length, MinGap, NotASolid, NothingLeft, Obstacle,
        };
        let code = match error {
            Direction { .. }
            | GrazeTolerance { .. }
            | MinGap { .. }
            | Length { .. }
            | NothingLeft { .. } => Code::Usage,
            NotASolid { .. } => Code::Input,
            Obstacle { ref reason, .. } if matches!(**reason, NotASolid { .. }) => Code::Input,
            _ => Code::Query,
        };
        Self::new(code, error.to_string())
    }
}
