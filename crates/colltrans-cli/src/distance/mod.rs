//! `colltrans distance`, `depth` and `within`: queries of two placed bodies without a direction.
//!
//! If both meshes are convex and no option requires parts, they become convex bodies, otherwise parts.

mod text;

use std::path::PathBuf;

use colltrans::Pair;
use colltrans::record::PairQuestion;

use crate::args::PlacedArguments;
use crate::body::Part;
use crate::driver::{AnswerOutputs, OutputTargets};
use crate::failure::Failure;
use crate::load;
use crate::numbers::smaller_extent;
use crate::picture::draw_pair;
use crate::record::Line;
use crate::solid::{PartsPair, placed_surface};
pub(crate) use text::{Accuracy, distance_text};

pub(crate) fn run(arguments: &PlacedArguments, question: PairQuestion) -> Result<(), Failure> {
    let inputs = arguments.input_pair(question)?;
    let PlacedArguments { json, save_proof, picture, .. } = arguments;
    let paths = load::input_paths(inputs.files);
    let targets = OutputTargets::new(*json, save_proof.as_ref(), picture.as_ref(), &paths)?;
    match load::read_if_convex(&inputs, &arguments.body_options())? {
        Some([moving, fixed]) => {
            answer_convex(arguments, targets, question, [&moving[0], &fixed[0]])
        }
        None => answer_parts(arguments, targets, question, inputs.files),
    }
}

/// Answers the question for convex bodies, and writes the answer.
fn answer_convex(
    arguments: &PlacedArguments,
    targets: OutputTargets<'_>,
    question: PairQuestion,
    bodies: [&Part; 2],
) -> Result<(), Failure> {
    let poses = arguments.places.poses()?;
    load::print_notes(&arguments.places, bodies.iter().flat_map(|part| &part.notes));
    let [moving, fixed] = [0, 1].map(|k| bodies[k].body.at(poses[k]));
    let pair = Pair::new(moving, fixed)?;
    let answer = question.answer(&pair)?;
    let line = Line::from_record(answer.record(&pair)).with_parts(bodies);
    let surface = |k: usize, origin| placed_surface(&bodies[k].body, &poses[k], origin);
    let accuracy = || Accuracy { error: 0.0, extent: smaller_extent(bodies.map(Part::bounds)) };
    targets.write_answer(AnswerOutputs {
        record: &line,
        text: || text::answer_text(question, &line, accuracy()),
        proof: || Ok(answer.proof(&pair).map(|proof| proof.to_json())),
        picture: || Ok(draw_pair(&line.record, &surface)),
    })
}

/// Answers the question for parts that need not be convex, and writes the answer.
fn answer_parts(
    arguments: &PlacedArguments,
    targets: OutputTargets<'_>,
    question: PairQuestion,
    files: [&[PathBuf]; 2],
) -> Result<(), Failure> {
    let proves = targets.save_proof.is_some();
    let poses = arguments.places.poses()?;
    let bodies = load::read_parts(files, &arguments.part_options())?;
    load::print_notes(&arguments.places, bodies.iter().flat_map(|body| &body.notes));
    let query = PartsPair { bodies: bodies.each_ref(), poses };
    let (record, proof) = if proves {
        let (record, proof) = if arguments.common_part {
            query.prove_common_part(question)?
        } else {
            query.prove(question)?
        };
        (record, Some(proof))
    } else {
        (query.answer(question)?, None)
    };
    let line = Line::from_record(record);
    let surface = |k: usize, origin| bodies[k].surface(&poses[k], origin);
    targets.write_answer(AnswerOutputs {
        record: &line,
        text: || text::answer_text(question, &line, query.accuracy()),
        proof: || proof.transpose().map(|proof| proof.map(|proof| proof.to_json())),
        picture: || Ok(draw_pair(&line.record, &surface)),
    })
}
