//! `colltrans clearance`: how far a body can move before another blocks it. Two convex meshes are asked as
//! `cast` asks them; this is the way of all others, the parts.

mod words;

use std::path::{Path, PathBuf};

use colltrans::record::{Ending, Question, Record};
use colltrans_mesh::body::BodyOptions;

use crate::among;
use crate::args::{ClearanceArguments, PairArguments, Sides, Taken};
use crate::body::{is_part, refusal};
use crate::cast::{self, Directions, Request, all_answered};
use crate::failure::{Code, Failure, note, print};
use crate::outputs;
use crate::picture::draw_solids;
use crate::progress;
use crate::record::Line;
use crate::solid::{self, Body, PartsQuery};
pub(crate) use words::{overlaps, remedy};

pub(crate) fn run(arguments: &ClearanceArguments) -> Result<(), Failure> {
    if !arguments.among.is_empty() {
        return among::clearance(arguments);
    }
    let Sides { files, taken } = arguments.sides()?;
    let inputs: Vec<&Path> = files.into_iter().flatten().map(AsRef::as_ref).collect();
    let request = Request::of(&arguments.pair, &inputs)?;
    if let ([moving, fixed], true) = (inputs.as_slice(), taken != Taken::Parts) {
        match cast::load([moving, fixed], &arguments.pair.body_options()) {
            Ok([moving, fixed]) => return request.convex(Question::Clearance, [&moving, &fixed]),
            Err(error) if taken == Taken::AsTheyAre && is_part(&error) => {}
            Err(error) => return Err(Failure::new(Code::Input, refusal(&error))),
        }
    }
    parts(arguments, request, files)
}

/// Asked of parts that need not be convex.
fn parts(
    arguments: &ClearanceArguments,
    request: Request<'_>,
    files: [&[PathBuf]; 2],
) -> Result<(), Failure> {
    let [moving, fixed] = load(files, &arguments.part_options())?;
    request.tell([&moving.notes, &fixed.notes]);
    let [moving_pose, fixed_pose] = request.poses;
    let question = |direction| PartsQuery {
        moving: &moving,
        moving_pose,
        fixed: &fixed,
        fixed_pose,
        direction,
        tolerance: arguments.tolerance,
        ignore_start_overlaps: arguments.ignore_start_overlaps,
        keep: arguments.pair.keep,
    };
    match request.directions {
        Directions::One(direction) => answer_one(&arguments.pair, &question(direction)),
        Directions::Many(all) => scan(arguments.pair.json, all.into_iter().map(question)),
    }
}

fn answer_one(arguments: &PairArguments, question: &PartsQuery<'_>) -> Result<(), Failure> {
    let bar = progress::steps(question.pairs(), "looking");
    let answer = question.ask(|| bar.inc(1));
    bar.finish_and_clear();
    let bodies = [question.moving, question.fixed];
    let answer = answer.map_err(|error| solid::refused(error, bodies, question.tolerance))?;
    answer.notes.iter().for_each(|text| note(text));
    let is_default = question.tolerance.is_none();
    let text = if arguments.json {
        Line { notes: answer.notes.clone(), ..answer.record.clone().into() }.json()
    } else {
        words::answer(&answer, question.direction, is_default)
    };
    print(&text)?;
    if let Some(path) = &arguments.save_proof {
        outputs::write_proof(
            path,
            &question.prove(answer.record.tolerance.unwrap_or_default())?.to_json(),
        )?;
    }
    match &arguments.picture {
        Some(path) => outputs::write(path, draw_solids(question, &answer).as_bytes()),
        None => Ok(()),
    }
}

/// One line for each direction, also for those without an answer.
fn scan<'a>(
    as_json: bool,
    questions: impl ExactSizeIterator<Item = PartsQuery<'a>>,
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
pub(crate) fn load(
    files: [&[PathBuf]; 2],
    options: &[BodyOptions; 2],
) -> Result<[Body; 2], Failure> {
    let bar = progress::steps(files.iter().map(|side| side.len()).sum(), "reading");
    let load = |k: usize| Body::load(files[k], &options[k], || bar.inc(1));
    let bodies = load(0).and_then(|moving| Ok([moving, load(1)?]));
    bar.finish_and_clear();
    bodies.map_err(|message| Failure::new(Code::Input, message))
}
