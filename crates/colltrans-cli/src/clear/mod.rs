//! `colltrans clear`: how far a part that need not be convex can move before other parts block it.

mod words;

use std::fs;
use std::path::Path;

use crate::args::ClearArguments;
use crate::failure::{Code, Failure, note, print};
use crate::inputs::refuse_picture;
use crate::picture::draw_solids;
use crate::progress;
use crate::record::Record;
use crate::solid::{Answer, Body, Question};

pub(crate) fn run(arguments: &ClearArguments) -> Result<(), Failure> {
    let files = arguments.moving.iter().chain(&arguments.from);
    let inputs: Vec<&Path> = files.map(AsRef::as_ref).collect();
    refuse_picture(arguments.picture.as_deref(), &inputs)?;
    let places = &arguments.places;
    let usage = |message| Failure::new(Code::Usage, message);
    let moving_pose = places.moving_pose.pose(places.moving_rpy, "--moving").map_err(usage)?;
    let fixed_pose = places.fixed_pose.pose(places.fixed_rpy, "--fixed").map_err(usage)?;
    let [moving, fixed] = load(arguments, inputs.len())?;
    let question = Question {
        moving: &moving,
        moving_pose,
        fixed: &fixed,
        fixed_pose,
        direction: arguments.direction,
        tolerance: arguments.tolerance,
        ignore_start_overlaps: arguments.ignore_start_overlaps,
    };
    let bar = progress::steps(question.pairs(), "looking");
    let answer = question.ask(|| bar.inc(1));
    bar.finish_and_clear();
    let answer = answer?;
    let placed = [places.moving_pose.note("--moving"), places.fixed_pose.note("--fixed")];
    let told = moving.notes.iter().chain(&fixed.notes).chain(&answer.notes);
    placed.iter().flatten().chain(told).for_each(|text| note(text));
    tell(arguments, &answer)?;
    match &arguments.picture {
        Some(path) => fs::write(path, draw_solids(&question, &answer))
            .map_err(|error| Failure::output(path.display(), &error)),
        None => Ok(()),
    }
}

/// Both bodies.
fn load(arguments: &ClearArguments, files: usize) -> Result<[Body; 2], Failure> {
    let bar = progress::steps(files, "reading");
    let [moving, fixed] = arguments.recipes();
    let load = |files, recipe| Body::load(files, recipe, || bar.inc(1));
    let moving = load(&arguments.moving, moving);
    let bodies = moving.and_then(|moving| Ok([moving, load(&arguments.from, fixed)?]));
    bar.finish_and_clear();
    bodies.map_err(|message| Failure::new(Code::Input, message))
}

fn tell(arguments: &ClearArguments, answer: &Answer<'_>) -> Result<(), Failure> {
    let text = if arguments.json {
        Record::of_solids(answer).json()?
    } else {
        words::answer(answer, arguments.direction, arguments.tolerance.is_none())
    };
    print(&text)
}
