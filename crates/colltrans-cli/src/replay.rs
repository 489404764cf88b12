//! `colltrans replay`: answers a saved query again.

use colltrans::motion::{MotionCase, MotionOutcome};
use colltrans::record::{MotionRecord, Question};
use colltrans::{Case, CaseError};

use crate::args::ReplayArguments;
use crate::body::convex_bounds;
use crate::failure::{Code, Failure, print};
use crate::inputs::read_text;
use crate::motion;
use crate::numbers::smaller_extent;
use crate::record::{self, Line};
use crate::report;

pub(crate) fn run(arguments: &ReplayArguments) -> Result<(), Failure> {
    let place = arguments.case.display();
    let input = |what: String| Failure::new(Code::Input, format!("{place}: {what}"));
    let json = read_text(&arguments.case)?;
    let text = match MotionCase::from_json(&json) {
        Err(CaseError::Format { .. }) => {
            let case = Case::from_json(&json).map_err(|error| input(error.to_string()))?;
            replay_cast(&case, arguments.json)?
        }
        case => replay_motion(&case.map_err(|error| input(error.to_string()))?, arguments.json)?,
    };
    print(&text)
}

/// Returns the answer of a saved cast as text or JSON.
fn replay_cast(case: &Case, as_json: bool) -> Result<String, Failure> {
    let cast = case.cast()?;
    let answer = Question::Contact.answer(&cast)?;
    let line = Line::from(answer.record(&cast));
    Ok(if as_json {
        record::json_line(&line)
    } else {
        let extent = smaller_extent([cast.moving(), cast.fixed()].map(convex_bounds));
        report::cast_answer_text(&answer, &line, cast.direction(), extent)
    })
}

/// Returns the answer of a saved motion as text or JSON.
///
/// # Errors
/// The query fails. If it is undecided, the answer is printed first.
fn replay_motion(case: &MotionCase, as_json: bool) -> Result<String, Failure> {
    let cast = case.cast();
    let outcome = cast.first_contact()?;
    let line = Line::from_record(MotionRecord::from_outcome(&outcome, &cast));
    let text = if as_json {
        record::json_line(&line)
    } else {
        {
            let extent = smaller_extent(cast.bodies().map(convex_bounds));
            motion::answer_text(&line, cast.motions(), extent)
        }
    };
    if let MotionOutcome::Undecided(open) = &outcome {
        print(&text)?;
        return Err(motion::step_limit_error(open.lower).into());
    }
    Ok(text)
}
