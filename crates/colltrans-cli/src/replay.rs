//! `colltrans replay`: a saved query once more; and the file that a query without an answer leaves.

use std::io::ErrorKind;
use std::path::PathBuf;

use colltrans::motion::{MotionCase, MotionCast, MotionOutcome};
use colltrans::record::{Question, Record};
use colltrans::{Case, CaseError, Cast, QueryError};

use crate::args::ReplayArguments;
use crate::failure::{Code, Failure, print};
use crate::motion;
use crate::outputs;
use crate::record::Line;
use crate::report;

pub(crate) fn run(arguments: &ReplayArguments) -> Result<(), Failure> {
    let place = arguments.case.display();
    let input = |what: String| Failure::new(Code::Input, format!("{place}: {what}"));
    let text = colltrans_mesh::file::text(&arguments.case)
        .map_err(|error| input(format!("cannot be read: {error}")))?;
    let told = match MotionCase::from_json(&text) {
        Err(CaseError::Format { .. }) => {
            let case = Case::from_json(&text).map_err(|error| input(error.to_string()))?;
            of_cast(&case, arguments.json)?
        }
        case => of_motion(&case.map_err(|error| input(error.to_string()))?, arguments.json)?,
    };
    print(&told)
}

fn of_cast(case: &Case, as_json: bool) -> Result<String, Failure> {
    let cast = case.cast()?;
    let answer = Question::Contact.ask(&cast)?;
    let told = Line::from(answer.record(&cast));
    Ok(if as_json { told.json() } else { report::answer(&answer, &told, cast.direction()) })
}

fn of_motion(case: &MotionCase, as_json: bool) -> Result<String, Failure> {
    let cast = case.cast();
    let found = cast.first_contact()?;
    let told = Line::from(Record::of_motion(&found, &cast));
    let told = if as_json { told.json() } else { motion::words(&told, cast.motions()) };
    if let MotionOutcome::Undecided(open) = &found {
        print(&told)?;
        return Err(motion::stalled(open.lower).into());
    }
    Ok(told)
}

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
