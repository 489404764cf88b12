//! `colltrans distance`, `depth` and `within`: two bodies where they are. Two convex meshes are asked as
//! convex bodies, all others as parts.

mod text;

use std::path::PathBuf;

use colltrans::Pair;
use colltrans::record::PairQuestion;

use crate::args::PlacedArguments;
use crate::body::Part;
use crate::driver::{AnswerOutputs, OutputTargets};
use crate::failure::{Code, Failure};
use crate::load;
use crate::picture::draw_pair;
use crate::record::Line;
use crate::solid::{PartsPair, surface_of};
pub(crate) use text::distance;

pub(crate) fn run(arguments: &PlacedArguments, question: PairQuestion) -> Result<(), Failure> {
    let sides = arguments.sides(question)?;
    let PlacedArguments { json, save_proof, picture, .. } = arguments;
    let inputs = load::input_files(sides.files);
    let targets = OutputTargets::new(*json, save_proof.as_ref(), picture.as_ref(), &inputs)?;
    match load::convex_bodies(&sides, &arguments.body_options())? {
        Some([moving, fixed]) => convex(arguments, targets, question, [&moving[0], &fixed[0]]),
        None => parts(arguments, targets, question, sides.files),
    }
}

fn convex(
    arguments: &PlacedArguments,
    targets: OutputTargets<'_>,
    question: PairQuestion,
    bodies: [&Part; 2],
) -> Result<(), Failure> {
    let poses = arguments.places.poses()?;
    load::report_notes(&arguments.places, bodies.iter().flat_map(|part| &part.notes));
    let [moving, fixed] = [0, 1].map(|k| bodies[k].body.at(poses[k]));
    let pair = Pair::new(moving, fixed)?;
    let answer = question.ask(&pair)?;
    let told = Line::of(answer.record(&pair)).with_parts(bodies);
    let surface = |k: usize, origin| surface_of(&bodies[k].body, &poses[k], origin);
    targets.write_answer(AnswerOutputs {
        record: &told,
        words: || text::answer(question, &told, 0.0),
        proof: || Ok(answer.proof(&pair).map(|proof| proof.to_json())),
        picture: || Ok(draw_pair(&told.record, &surface)),
    })
}

fn parts(
    arguments: &PlacedArguments,
    targets: OutputTargets<'_>,
    question: PairQuestion,
    files: [&[PathBuf]; 2],
) -> Result<(), Failure> {
    let proves = targets.save_proof.is_some();
    if question == PairQuestion::Depth && proves {
        let why = "the depth of parts has no proof; `colltrans clearance` has one of their overlap";
        return Err(Failure::new(Code::Usage, why));
    }
    let poses = arguments.places.poses()?;
    let bodies = load::parts(files, &arguments.part_options())?;
    load::report_notes(&arguments.places, bodies.iter().flat_map(|body| &body.notes));
    let asked = PartsPair { bodies: bodies.each_ref(), poses };
    let (record, proof) =
        if proves { asked.prove(question)? } else { (asked.ask(question)?, Ok(None)) };
    let told = Line::of(record);
    let surface = |k: usize, origin| bodies[k].surface(&poses[k], origin);
    targets.write_answer(AnswerOutputs {
        record: &told,
        words: || text::answer(question, &told, asked.error()),
        proof: || Ok(proof?.map(|proof| proof.to_json())),
        picture: || Ok(draw_pair(&told.record, &surface)),
    })
}
