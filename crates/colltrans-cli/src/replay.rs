//! `colltrans replay`: a saved query once more.

use colltrans::motion::{MotionCase, MotionOutcome};
use colltrans::record::{MotionRecord, Question};
use colltrans::{Case, CaseError};

use crate::args::ReplayArguments;
use crate::failure::{Code, Failure, print};
use crate::inputs::read_text;
use crate::motion;
use crate::record::{self, Line};
use crate::report;

pub(crate) fn run(arguments: &ReplayArguments) -> Result<(), Failure> {
    let place = arguments.case.display();
    let input = |what: String| Failure::new(Code::Input, format!("{place}: {what}"));
    let text = read_text(&arguments.case)?;
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
    Ok(if as_json { record::json(&told) } else { report::answer(&answer, &told, cast.direction()) })
}

fn of_motion(case: &MotionCase, as_json: bool) -> Result<String, Failure> {
    let cast = case.cast();
    let found = cast.first_contact()?;
    let told = Line::of(MotionRecord::of(&found, &cast));
    let told = if as_json { record::json(&told) } else { motion::words(&told, cast.motions()) };
    if let MotionOutcome::Undecided(open) = &found {
        print(&told)?;
        return Err(motion::stalled(open.lower).into());
    }
    Ok(told)
}
