//! How a command ends when it does not succeed: one message, one exit code.

use std::fmt::Display;
use std::io;
use std::process::ExitCode;

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
}

/// Says something on standard error that does not end the command.
pub(crate) fn note(text: &str) {
    // Not `eprintln!`, which panics when standard error is closed.
    let _ = io::Write::write_all(&mut io::stderr(), format!("note: {text}\n").as_bytes());
}

/// Says an answer on standard output.
pub(crate) fn print(text: &str) -> Result<(), Failure> {
    io::Write::write_all(&mut io::stdout(), text.as_bytes())
        .map_err(|error| Failure::output("standard output", &error))
}

/// Why a command did not succeed.
#[derive(Debug)]
pub(crate) struct Failure {
    code: Code,
    /// `None` where nobody listens any more: the reader of a pipe has gone.
    message: Option<String>,
}

impl Failure {
    pub(crate) fn new(code: Code, message: impl Into<String>) -> Self {
        Self { code, message: Some(message.into()) }
    }

    /// The answer could not be written to `place`.
    pub(crate) fn output(place: impl Display, error: &io::Error) -> Self {
        let message = (error.kind() != io::ErrorKind::BrokenPipe)
            .then(|| format!("{place}: cannot be written: {error}"));
        Self { code: Code::Output, message }
    }

    /// What is said, for a line among others.
    pub(crate) fn into_message(self) -> String {
        self.message.unwrap_or_default()
    }

    pub(crate) fn report(self) -> ExitCode {
        let Some(message) = self.message else { return ExitCode::SUCCESS };
        // Not `eprintln!`, which panics when standard error is closed.
        let _ = io::Write::write_all(&mut io::stderr(), format!("error: {message}\n").as_bytes());
        ExitCode::from(self.code as u8)
    }
}

impl From<colltrans::QueryError> for Failure {
    fn from(error: colltrans::QueryError) -> Self {
        use colltrans::QueryError::{Direction, GrazeTolerance};
        let code = match error {
            Direction { .. } | GrazeTolerance { .. } => Code::Usage,
            _ => Code::Query,
        };
        Self::new(code, error.to_string())
    }
}
