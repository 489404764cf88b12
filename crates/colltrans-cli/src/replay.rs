//! `colltrans replay`: a saved query once more; and the file that a query without an answer leaves.

use std::io::ErrorKind;
use std::path::PathBuf;

use colltrans::record::Question;
use colltrans::{Case, Cast, QueryError};

use crate::args::ReplayArguments;
use crate::failure::{Code, Failure, print};
use crate::outputs;
use crate::record::Line;
use crate::report;

pub(crate) fn run(arguments: &ReplayArguments) -> Result<(), Failure> {
    let place = arguments.case.display();
    let input = |what: String| Failure::new(Code::Input, format!("{place}: {what}"));
    let text = colltrans_mesh::file::text(&arguments.case)
        .map_err(|error| input(format!("cannot be read: {error}")))?;
    let case = Case::from_json(&text).map_err(|error| input(error.to_string()))?;
    let cast = case.cast()?;
    let answer = Question::Contact.ask(&cast)?;
    let told = Line::from(answer.record(&cast));
    let text =
        if arguments.json { told.json() } else { report::answer(&answer, &told, cast.direction()) };
    print(&text)
}

/// What to say about a query that has no answer: one that did not converge is saved as a file.
pub(crate) fn failure(error: QueryError, cast: &Cast<'_>) -> Failure {
    let QueryError::NotConverged { .. } = error else { return error.into() };
    match save(cast) {
        Some(path) => {
            Failure::new(Code::Query, format!("{error}; it was saved as {}", path.display()))
        }
        None => error.into(),
    }
}

/// Writes the query to a file of the working directory that does not exist yet.
fn save(cast: &Cast<'_>) -> Option<PathBuf> {
    let json = cast.to_json();
    for number in 1..1000 {
        let path = PathBuf::from(format!("colltrans-case-{number}.json"));
        match outputs::write_new(&path, json.as_bytes()) {
            Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
            written => return written.ok().map(|()| path),
        }
    }
    None
}
