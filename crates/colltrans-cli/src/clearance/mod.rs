//! `colltrans clearance`: how far a body can move before another blocks it.
//!
//! [`cast`](crate::cast) answers for two convex meshes, this module for parts.

mod text;

use std::path::PathBuf;

use colltrans::record::Question;

use crate::args::ClearanceArguments;
use crate::cast::{Directions, Request};
use crate::driver::{AnswerOutputs, answer_directions};
use crate::failure::{Failure, note, print};
use crate::load;
use crate::picture::draw_solids;
use crate::progress;
use crate::record::Line;
use crate::solid::{self, PartsQuery};

pub(crate) fn run(arguments: &ClearanceArguments) -> Result<(), Failure> {
    let inputs = arguments.input_pair()?;
    let request = Request::from_arguments(&arguments.pair, inputs.files)?;
    match load::read_if_convex(&inputs, &arguments.pair.body_options())? {
        Some([moving, fixed]) => {
            request.answer_convex(Question::Clearance, [&moving[0], &fixed[0]])
        }
        None => answer_parts(arguments, request, inputs.files),
    }
}

/// Answers the request for parts that need not be convex, and writes the answer.
fn answer_parts(
    arguments: &ClearanceArguments,
    request: Request<'_>,
    files: [&[PathBuf]; 2],
) -> Result<(), Failure> {
    let Request { targets, poses, directions, .. } = request;
    let bodies = load::read_parts(files, &arguments.part_options())?;
    load::print_notes(&arguments.pair.places, bodies.iter().flat_map(|body| &body.notes));
    let (bodies, min_gap) = (bodies.each_ref(), arguments.pair.min_gap);
    let ClearanceArguments { tolerance, ignore_start_overlaps, .. } = *arguments;
    let query = |direction| PartsQuery {
        bodies,
        poses,
        direction,
        tolerance,
        ignore_start_overlaps,
        min_gap,
    };
    let all = match directions {
        Directions::Many(all) => all,
        Directions::One(direction) => {
            let query = query(direction);
            let bar = progress::step_bar(query.pair_count(), "searching");
            let answer = query.answer(|| bar.inc(1));
            bar.finish_and_clear();
            let answer = answer.map_err(|error| solid::query_failure(error, bodies, tolerance))?;
            answer.notes.iter().for_each(|text| note(text));
            let line =
                Line { notes: answer.notes.clone(), ..Line::from_record(answer.record.clone()) };
            let prove = || query.prove(answer.record.tolerance.unwrap_or_default());
            return targets.write_answer(AnswerOutputs {
                record: &line,
                text: || text::answer_text(&answer, direction, tolerance.is_none()),
                proof: || Ok(Some(prove()?.to_json())),
                picture: || Ok(draw_solids(&query, &answer)),
            });
        }
    };
    if !targets.json {
        print(&text::scan_header())?;
    }
    let mut noted = false;
    let line_of = |direction| {
        let answer = query(direction).answer(|| ())?;
        // All directions have the same bodies, and therefore the same notes.
        if !noted {
            answer.notes.iter().for_each(|text| note(text));
            noted = true;
        }
        Ok(Line::from_record(answer.record.into()))
    };
    answer_directions(targets.json, all, line_of, text::scan_line)
}
