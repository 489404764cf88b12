//! `colltrans replay`: a saved query once more; and the file that a query without an answer leaves.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::PathBuf;

use colltrans::{Case, Cast, QueryError};

use crate::args::ReplayArguments;
use crate::failure::{Code, Failure};
use crate::query::Query;
use crate::record::Record;
use crate::report;

pub(crate) fn run(arguments: &ReplayArguments) -> Result<(), Failure> {
    let place = arguments.case.display();
    let input = |what: String| Failure::new(Code::Input, format!("{place}: {what}"));
    let text = fs::read_to_string(&arguments.case)
        .map_err(|error| input(format!("cannot be read: {error}")))?;
    let case = Case::from_json(&text).map_err(|error| input(error.to_string()))?;
    let cast = case.cast()?;
    let query = Query {
        moving: cast.moving(),
        moving_pose: cast.moving_pose(),
        fixed: cast.fixed(),
        fixed_pose: cast.fixed_pose(),
        direction: cast.direction(),
        options: cast.options(),
    };
    let answer = query.contact_range()?;
    let record = Record::of_answer(&answer, &cast);
    let text = if arguments.json {
        let line = serde_json::to_string(&record);
        line.map_err(|error| Failure::new(Code::Output, error.to_string()))? + "\n"
    } else {
        report::cast(&answer, &record, cast.direction())
    };
    io::stdout()
        .write_all(text.as_bytes())
        .map_err(|error| Failure::output("standard output", &error))
}

/// What to say about a query that has no answer: one that did not converge is saved as a file.
pub(crate) fn failure(error: QueryError, query: &Query<'_>) -> Failure {
    let QueryError::NotConverged { .. } = error else { return error.into() };
    let saved = query.cast().ok().and_then(|cast| save(&cast));
    match saved {
        Some(path) => {
            Failure::new(Code::Query, format!("{error}; it was saved as {}", path.display()))
        }
        None => error.into(),
    }
}

/// Writes the query to a file of the working directory that does not exist yet.
fn save(cast: &Cast<'_>) -> Option<PathBuf> {
    for number in 1..1000 {
        let path = PathBuf::from(format!("colltrans-case-{number}.json"));
        if let Ok(mut file) = File::create_new(&path) {
            return file.write_all(cast.to_json().as_bytes()).ok().map(|()| path);
        }
    }
    None
}
