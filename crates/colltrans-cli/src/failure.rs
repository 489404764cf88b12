//! How a command fails: with one message and one exit code.

use std::fmt::Display;
use std::io::{self, Write};
use std::process::ExitCode;

use crate::streams::standard_output;
use crate::terminal::{plain, plain_json, shown};

/// The exit codes that are not 0, as `--help` documents them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Code {
    /// Some lines of a batch have no answer.
    Lines = 1,
    /// The command line is wrong.
    Usage = 2,
    /// A file cannot be read or is no convex body.
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

/// Says something on standard error that does not end the command.
pub(crate) fn note(text: &str) {
    // Not `eprintln!`, which panics when standard error is closed.
    let line = format!("note: {}\n", shown(text));
    let _ = io::stderr().write_all(line.as_bytes());
}

/// Says an answer in words on standard output.
pub(crate) fn print(text: &str) -> Result<(), Failure> {
    put(&plain(text))
}

/// Says an answer in JSON on standard output.
pub(crate) fn print_json(text: &str) -> Result<(), Failure> {
    put(&plain_json(text))
}

fn put(text: &str) -> Result<(), Failure> {
    let written = standard_output().and_then(|mut out| {
        out.write_all(text.as_bytes())?;
        out.flush()
    });
    written.map_err(|error| Failure::output("standard output", &error))
}

/// Why a command did not succeed.
#[derive(Debug)]
pub(crate) struct Failure {
    code: Code,
    /// None where nobody listens any more: the reader of a pipe has gone.
    messages: Vec<String>,
}

impl Failure {
    pub(crate) fn new(code: Code, message: impl Into<String>) -> Self {
        Self { code, messages: vec![message.into()] }
    }

    /// Several things that are wrong, each with a message of its own.
    pub(crate) fn several(code: Code, messages: Vec<String>) -> Self {
        Self { code, messages }
    }

    /// The answer could not be written to `place`.
    pub(crate) fn output(place: impl Display, error: &io::Error) -> Self {
        let is_heard = error.kind() != io::ErrorKind::BrokenPipe;
        let message = is_heard.then(|| format!("{place}: cannot be written: {error}"));
        Self { code: Code::Output, messages: message.into_iter().collect() }
    }

    /// What is said, for a line among others.
    pub(crate) fn into_message(self) -> String {
        self.messages.join("; ")
    }

    pub(crate) fn report(self) -> ExitCode {
        if self.messages.is_empty() {
            return ExitCode::SUCCESS;
        }
        // Not `eprintln!`, which panics when standard error is closed.
        for message in &self.messages {
            let line = format!("error: {}\n", shown(message));
            let _ = io::stderr().write_all(line.as_bytes());
        }
        ExitCode::from(self.code as u8)
    }
}

impl From<colltrans::free::FreeError> for Failure {
    fn from(error: colltrans::free::FreeError) -> Self {
        use colltrans::free::FreeError::{Open, Query};
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
            Direction, GrazeTolerance, Keep, Length, NoSolid, NothingLeft, Obstacle,
        };
        let code = match error {
            Direction { .. }
            | GrazeTolerance { .. }
            | Keep { .. }
            | Length { .. }
            | NothingLeft { .. } => Code::Usage,
            NoSolid { .. } => Code::Input,
            Obstacle { ref reason, .. } if matches!(**reason, NoSolid { .. }) => Code::Input,
            _ => Code::Query,
        };
        Self::new(code, error.to_string())
    }
}
