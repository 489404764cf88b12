//! `colltrans directions`: all directions along which a body can leave another, with a proof.

mod text;

use crate::args::DirectionsArguments;
use crate::driver::{AnswerOutputs, OutputTargets, no_picture};
use crate::failure::{Failure, note};
use crate::load;
use crate::solid::{DirectionsAnswer, PartsDirections};
pub(crate) use text::{push_directions, verified_text};

pub(crate) fn run(arguments: &DirectionsArguments) -> Result<(), Failure> {
    let files = arguments.input_pair()?.files;
    let DirectionsArguments { json, save_proof, places, .. } = arguments;
    let targets = OutputTargets::new(*json, save_proof.as_ref(), None, &load::input_paths(files))?;
    let poses = places.poses()?;
    let bodies = load::read_parts(files, &arguments.part_options())?;
    load::print_notes(places, bodies.iter().flat_map(|body| &body.notes));
    let query = PartsDirections {
        bodies: bodies.each_ref(),
        poses,
        tolerance: arguments.tolerance,
        ignore_start_overlaps: arguments.ignore_start_overlaps,
        options: arguments.work.options(),
    };
    let DirectionsAnswer { record, notes, proof } = query.answer(save_proof.is_some())?;
    for text in &notes {
        note(text);
    }
    targets.write_answer(AnswerOutputs {
        record: &record,
        text: || text::answer_text(&record),
        proof: || {
            if proof.is_none() {
                note(
                    "no proof file written: there is no proof for bodies that overlap at the start",
                );
            }
            Ok(proof.map(|proof| proof.to_json()))
        },
        picture: no_picture,
    })
}
