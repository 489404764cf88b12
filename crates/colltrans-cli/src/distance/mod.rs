//! `colltrans distance`, `depth` and `within`: two bodies where they are. Two convex meshes are asked as
//! convex bodies, all others as parts.

mod words;

use std::path::{Path, PathBuf};

use colltrans::Pair;
use colltrans::record::PairQuestion;
use colltrans_mesh::body::BodyOptions;

use crate::among;
use crate::args::{PlacedArguments, Sides, Taken};
use crate::body::{Part, is_part, refusal};
use crate::cast;
use crate::clearance;
use crate::failure::{Code, Failure, note, print};
use crate::inputs::{refuse_picture, refuse_proof};
use crate::outputs;
use crate::picture::{Shown, draw_pair};
use crate::record::Line;
use crate::solid::{PartsPair, surface_of};
pub(crate) use words::answer;

pub(crate) fn run(arguments: &PlacedArguments, question: PairQuestion) -> Result<(), Failure> {
    if !arguments.among.is_empty() {
        return among::placed(arguments, question);
    }
    let Sides { files, taken } = arguments.sides(question)?;
    let inputs: Vec<&Path> = files.into_iter().flatten().map(AsRef::as_ref).collect();
    let picture = arguments.picture.as_deref();
    refuse_picture(picture, &inputs)?;
    refuse_proof(arguments.save_proof.as_deref(), picture, &inputs)?;
    if let ([moving, fixed], true) = (inputs.as_slice(), taken != Taken::Parts) {
        match cast::load([moving, fixed], &arguments.body_options()) {
            Ok(parts) => return convex(arguments, question, &parts),
            Err(error) if taken == Taken::AsTheyAre && is_part(&error) => {}
            Err(error) => return Err(Failure::new(Code::Input, refusal(&error))),
        }
    }
    solids(arguments, question, files, &arguments.part_options())
}

fn convex(
    arguments: &PlacedArguments,
    question: PairQuestion,
    parts: &[Part; 2],
) -> Result<(), Failure> {
    let poses = arguments.places.poses()?;
    tell(arguments, parts.iter().flat_map(|part| &part.notes));
    let [moving, fixed] = [0, 1].map(|k| parts[k].body.at(poses[k]));
    let pair = Pair::new(moving, fixed)?;
    let answer = question.ask(&pair)?;
    let told = Line::of_parts(answer.record(&pair), parts.each_ref());
    say(arguments, question, &told, 0.0)?;
    if let (Some(path), Some(proof)) = (&arguments.save_proof, answer.proof(&pair)) {
        outputs::write_proof(path, &proof.to_json())?;
    }
    let surface = |k: usize, origin| surface_of(&parts[k].body, &poses[k], origin);
    draw(arguments, Shown { question, record: &told.record, surface: &surface })
}

fn solids(
    arguments: &PlacedArguments,
    question: PairQuestion,
    files: [&[PathBuf]; 2],
    options: &[BodyOptions; 2],
) -> Result<(), Failure> {
    if question == PairQuestion::Depth && arguments.save_proof.is_some() {
        let why = "the depth of parts has no proof; `colltrans clearance` has one of their overlap";
        return Err(Failure::new(Code::Usage, why));
    }
    let poses = arguments.places.poses()?;
    let bodies = clearance::load(files, options)?;
    tell(arguments, bodies.iter().flat_map(|body| &body.notes));
    let asked = PartsPair { bodies: [&bodies[0], &bodies[1]], poses };
    let (record, proof) = match &arguments.save_proof {
        Some(_) => asked.prove(question)?,
        None => (asked.ask(question)?, Ok(None)),
    };
    say(arguments, question, &record.clone().into(), asked.error())?;
    if let (Some(path), Some(proof)) = (&arguments.save_proof, proof?) {
        outputs::write_proof(path, &proof.to_json())?;
    }
    let surface = |k: usize, origin| bodies[k].surface(&poses[k], origin);
    draw(arguments, Shown { question, record: &record, surface: &surface })
}

/// What was changed about the poses and mended in the files.
fn tell<'a>(arguments: &PlacedArguments, mended: impl Iterator<Item = &'a String>) {
    arguments.places.notes().iter().flatten().for_each(|text| note(text));
    mended.for_each(|text| note(text));
}

/// The answer; lengths may be off by an error that the files have.
fn say(
    arguments: &PlacedArguments,
    question: PairQuestion,
    told: &Line,
    error: f64,
) -> Result<(), Failure> {
    print(&if arguments.json { told.json() } else { words::answer(question, told, error) })
}

fn draw(arguments: &PlacedArguments, shown: Shown<'_>) -> Result<(), Failure> {
    match &arguments.picture {
        Some(path) => outputs::write(path, draw_pair(shown).as_bytes()),
        None => Ok(()),
    }
}
