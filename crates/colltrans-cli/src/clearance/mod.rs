//! `colltrans clearance`: how far a body can move before another blocks it. Two convex meshes are asked as
//! `cast` asks them; this is the way of all others, the parts.

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
    let sides = arguments.sides()?;
    let request = Request::of(&arguments.pair, sides.files)?;
    match load::convex_bodies(&sides, &arguments.pair.body_options())? {
        Some([moving, fixed]) => request.convex(Question::Clearance, [&moving[0], &fixed[0]]),
        None => parts(arguments, request, sides.files),
    }
}

/// Asked of parts that need not be convex.
fn parts(
    arguments: &ClearanceArguments,
    request: Request<'_>,
    files: [&[PathBuf]; 2],
) -> Result<(), Failure> {
    let Request { targets, poses, directions, .. } = request;
    let bodies = load::parts(files, &arguments.part_options())?;
    load::report_notes(&arguments.pair.places, bodies.iter().flat_map(|body| &body.notes));
    let (bodies, keep) = (bodies.each_ref(), arguments.pair.keep);
    let ClearanceArguments { tolerance, ignore_start_overlaps, .. } = *arguments;
    let question =
        |direction| PartsQuery { bodies, poses, direction, tolerance, ignore_start_overlaps, keep };
    let all = match directions {
        Directions::Many(all) => all,
        Directions::One(direction) => {
            let question = question(direction);
            let bar = progress::steps(question.pairs(), "looking");
            let answer = question.ask(|| bar.inc(1));
            bar.finish_and_clear();
            let answer = answer.map_err(|error| solid::refused(error, bodies, tolerance))?;
            answer.notes.iter().for_each(|text| note(text));
            let told = Line { notes: answer.notes.clone(), ..Line::of(answer.record.clone()) };
            let prove = || question.prove(answer.record.tolerance.unwrap_or_default());
            return targets.write_answer(AnswerOutputs {
                record: &told,
                words: || text::answer(&answer, direction, tolerance.is_none()),
                proof: || Ok(Some(prove()?.to_json())),
                picture: || Ok(draw_solids(&question, &answer)),
            });
        }
    };
    if !targets.json {
        print(&text::scan_head())?;
    }
    let mut noted = false;
    let ask = |direction| {
        let answer = question(direction).ask(|| ())?;
        // The same bodies and tolerance for all directions.
        if !noted {
            answer.notes.iter().for_each(|text| note(text));
            noted = true;
        }
        Ok(Line::of(answer.record.into()))
    };
    answer_directions(targets.json, all, ask, text::scan_line)
}
