//! Saves a query that does not converge as a file for `colltrans replay`.

use std::io::ErrorKind;
use std::path::PathBuf;

use colltrans::motion::{MotionCase, MotionCast};
use colltrans::{Cast, QueryError};

use crate::failure::{Code, Failure};
use crate::outputs;

/// Returns the failure of a cast. Saves the query if it did not converge; the message then names the file.
pub(crate) fn cast_failure(error: QueryError, cast: &Cast<'_>) -> Failure {
    failure_with_case(error, || cast.to_json())
}

/// Returns the failure of a motion. Saves the query if it did not converge; the message then names the file.
pub(crate) fn motion_failure(error: QueryError, cast: &MotionCast<'_>) -> Failure {
    failure_with_case(error, || MotionCase::from_cast(cast).to_json())
}

/// Returns the failure of a query, whose case is `json`.
fn failure_with_case(error: QueryError, json: impl FnOnce() -> String) -> Failure {
    let QueryError::NotConverged { .. } = error else { return error.into() };
    match save_case(&json()) {
        Some(path) => {
            Failure::new(Code::Query, format!("{error}; it was saved as {}", path.display()))
        }
        None => error.into(),
    }
}

/// Writes a query to a new file in the working directory. Returns its name; `None` if it cannot be written, or if
/// all names up to `colltrans-case-999.json` are in use.
fn save_case(json: &str) -> Option<PathBuf> {
    for number in 1..1000 {
        let path = PathBuf::from(format!("colltrans-case-{number}.json"));
        match outputs::write_new(&path, json.as_bytes()) {
            Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
            written => return written.ok().map(|()| path),
        }
    }
    None
}
