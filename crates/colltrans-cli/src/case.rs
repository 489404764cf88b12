//! Saves a query that does not converge as a file, which `colltrans replay` reads.

use std::io::ErrorKind;
use std::path::PathBuf;

use colltrans::motion::{MotionCase, MotionCast};
use colltrans::{Cast, QueryError};

use crate::failure::{Code, Failure};
use crate::outputs;

/// What to say about a query that has no answer: one that did not converge is saved as a file.
pub(crate) fn failure(error: QueryError, cast: &Cast<'_>) -> Failure {
    saved(error, || cast.to_json())
}

/// The same of a motion.
pub(crate) fn motion_failure(error: QueryError, cast: &MotionCast<'_>) -> Failure {
    saved(error, || MotionCase::of(cast).to_json())
}

fn saved(error: QueryError, json: impl FnOnce() -> String) -> Failure {
    let QueryError::NotConverged { .. } = error else { return error.into() };
    match save(&json()) {
        Some(path) => {
            Failure::new(Code::Query, format!("{error}; it was saved as {}", path.display()))
        }
        None => error.into(),
    }
}

/// Writes the query to a file of the working directory that does not exist yet.
fn save(json: &str) -> Option<PathBuf> {
    for number in 1..1000 {
        let path = PathBuf::from(format!("colltrans-case-{number}.json"));
        match outputs::write_new(&path, json.as_bytes()) {
            Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
            written => return written.ok().map(|()| path),
        }
    }
    None
}
