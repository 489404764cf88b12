//! `colltrans directions`: all directions along which a body leaves another one, proven.

mod words;

use std::path::Path;

use colltrans::record::FreeRecord;

use crate::args::DirectionsArguments;
use crate::clearance;
use crate::failure::{Failure, note, print, print_json};
use crate::inputs::refuse_proof;
use crate::outputs;
use crate::solid::{FreeAnswer, PartsFree};
pub(crate) use words::{told, verified};

pub(crate) fn run(arguments: &DirectionsArguments) -> Result<(), Failure> {
    let files = arguments.sides()?.files;
    let inputs: Vec<&Path> = files.into_iter().flatten().map(AsRef::as_ref).collect();
    refuse_proof(arguments.save_proof.as_deref(), None, &inputs)?;
    let poses = arguments.places.poses()?;
    let bodies = clearance::load(files, &arguments.part_options())?;
    arguments.places.notes().iter().flatten().for_each(|text| note(text));
    bodies.iter().flat_map(|body| &body.notes).for_each(|text| note(text));
    let asked = PartsFree {
        bodies: [&bodies[0], &bodies[1]],
        poses,
        tolerance: arguments.tolerance,
        ignore_start_overlaps: arguments.ignore_start_overlaps,
        options: arguments.work.options(),
    };
    let FreeAnswer { record, notes, proof } = asked.ask(arguments.save_proof.is_some())?;
    for text in &notes {
        note(text);
    }
    let text = if arguments.json { json(&record)? } else { words::answer(&record) };
    if arguments.json {
        print_json(&text)?;
    } else {
        print(&text)?;
    }
    match (&arguments.save_proof, proof) {
        (Some(path), Some(proof)) => outputs::write_proof(path, &proof.to_json()),
        (Some(_), None) => {
            note("no proof is written: nothing is told of bodies that overlap");
            Ok(())
        }
        (None, _) => Ok(()),
    }
}

fn json(record: &FreeRecord) -> Result<String, Failure> {
    let written = serde_json::to_string(record);
    let text = written.map_err(|e| Failure::output("standard output", &e.into()))?;
    Ok(format!("{text}\n"))
}
