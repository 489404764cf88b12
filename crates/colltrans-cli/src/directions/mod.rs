//! `colltrans directions`: all directions along which a body leaves another one, proven.

mod text;

use crate::args::DirectionsArguments;
use crate::driver::{AnswerOutputs, OutputTargets, no_picture};
use crate::failure::{Failure, note};
use crate::load;
use crate::solid::{FreeAnswer, PartsFree};
pub(crate) use text::{told, verified};

pub(crate) fn run(arguments: &DirectionsArguments) -> Result<(), Failure> {
    let files = arguments.sides()?.files;
    let DirectionsArguments { json, save_proof, places, .. } = arguments;
    let targets = OutputTargets::new(*json, save_proof.as_ref(), None, &load::input_files(files))?;
    let poses = places.poses()?;
    let bodies = load::parts(files, &arguments.part_options())?;
    load::report_notes(places, bodies.iter().flat_map(|body| &body.notes));
    let asked = PartsFree {
        bodies: bodies.each_ref(),
        poses,
        tolerance: arguments.tolerance,
        ignore_start_overlaps: arguments.ignore_start_overlaps,
        options: arguments.work.options(),
    };
    let FreeAnswer { record, notes, proof } = asked.ask(save_proof.is_some())?;
    for text in &notes {
        note(text);
    }
    targets.write_answer(AnswerOutputs {
        record: &record,
        words: || text::answer(&record),
        proof: || {
            if proof.is_none() {
                note("no proof is written: nothing is told of bodies that overlap");
            }
            Ok(proof.map(|proof| proof.to_json()))
        },
        picture: no_picture,
    })
}
