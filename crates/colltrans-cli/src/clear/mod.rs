//! `colltrans clear`: how far a part that need not be convex can move before other parts block it.

mod words;

use std::path::Path;

use colltrans::record::{Ending, Record};

use crate::args::ClearArguments;
use crate::cast::{Directions, all_answered, directions};
use crate::failure::{Code, Failure, note, print};
use crate::inputs::refuse_picture;
use crate::outputs;
use crate::picture::draw_solids;
use crate::progress;
use crate::proof::{self, refuse_proof};
use crate::record::Line;
use crate::solid::{Body, Question};

pub(crate) fn run(arguments: &ClearArguments) -> Result<(), Failure> {
    let files = arguments.moving.iter().chain(&arguments.from);
    let inputs: Vec<&Path> = files.map(AsRef::as_ref).collect();
    let picture = arguments.picture.as_deref();
    refuse_picture(picture, &inputs)?;
    refuse_proof(arguments.save_proof.as_deref(), picture, &inputs)?;
    let places = &arguments.places;
    let [moving_pose, fixed_pose] = places.poses()?;
    let directions = directions(&arguments.directions)?;
    let [moving, fixed] = load(arguments, inputs.len())?;
    let question = |direction| Question {
        moving: &moving,
        moving_pose,
        fixed: &fixed,
        fixed_pose,
        direction,
        tolerance: arguments.tolerance,
        ignore_start_overlaps: arguments.ignore_start_overlaps,
    };
    let placed = places.notes();
    let told = moving.notes.iter().chain(&fixed.notes);
    placed.iter().flatten().chain(told).for_each(|text| note(text));
    match directions {
        Directions::One(direction) => answer_one(arguments, &question(direction)),
        Directions::Many(all) => scan(arguments.json, all.into_iter().map(question)),
    }
}

fn answer_one(arguments: &ClearArguments, question: &Question<'_>) -> Result<(), Failure> {
    let bar = progress::steps(question.pairs(), "looking");
    let answer = question.ask(|| bar.inc(1));
    bar.finish_and_clear();
    let answer = answer?;
    answer.notes.iter().for_each(|text| note(text));
    let is_default = arguments.tolerance.is_none();
    let text = if arguments.json {
        Line::from(answer.record.clone()).json()
    } else {
        words::answer(&answer, question.direction, is_default)
    };
    print(&text)?;
    if let Some(path) = &arguments.save_proof {
        proof::save(path, &question.prove(answer.record.tolerance.unwrap_or_default())?)?;
    }
    match &arguments.picture {
        Some(path) => outputs::write(path, draw_solids(question, &answer).as_bytes()),
        None => Ok(()),
    }
}

/// One line for each direction, also for those without an answer.
fn scan<'a>(
    as_json: bool,
    questions: impl ExactSizeIterator<Item = Question<'a>>,
) -> Result<(), Failure> {
    let (count, mut failed) = (questions.len(), 0);
    if !as_json {
        print(&words::scan_head())?;
    }
    let mut noted = false;
    for question in questions {
        let mut record = match question.ask(|| ()) {
            Ok(answer) => {
                // The same bodies and tolerance for all directions.
                if !noted {
                    answer.notes.iter().for_each(|text| note(text));
                    noted = true;
                }
                answer.record
            }
            Err(error) => Record::error(Failure::from(error).into_message()),
        };
        failed += usize::from(record.outcome == Ending::Error);
        record.direction = Some(question.direction.to_array());
        let text = if as_json { Line::from(record).json() } else { words::scan_line(&record) };
        print(&text)?;
    }
    all_answered(count, failed)
}

/// Both bodies.
fn load(arguments: &ClearArguments, files: usize) -> Result<[Body; 2], Failure> {
    let bar = progress::steps(files, "reading");
    let [moving, fixed] = arguments.body_options();
    let load = |files, options| Body::load(files, options, || bar.inc(1));
    let moving = load(&arguments.moving, &moving);
    let bodies = moving.and_then(|moving| Ok([moving, load(&arguments.from, &fixed)?]));
    bar.finish_and_clear();
    bodies.map_err(|message| Failure::new(Code::Input, message))
}
