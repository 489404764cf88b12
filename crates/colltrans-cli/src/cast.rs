//! `colltrans cast`: one query on two mesh files.

use std::io::{self, Write};

use colltrans::{Options, contact_range};

use crate::args::CastArguments;
use crate::body;
use crate::failure::{Code, Failure};
use crate::picture::{Scene, draw};
use crate::record::Record;
use crate::report;

pub(crate) fn run(arguments: &CastArguments) -> Result<(), Failure> {
    let moving = body::load_or_fail(&arguments.moving, arguments.body)?;
    let fixed = body::load_or_fail(&arguments.fixed, arguments.body)?;
    let options = Options {
        solver: arguments.solver.into(),
        graze_tolerance: arguments.graze_tolerance,
        ..Options::default()
    };
    let answer = contact_range(
        &moving,
        &arguments.moving_pose,
        &fixed,
        &arguments.fixed_pose,
        arguments.direction,
        &options,
    )?;
    let record = Record::of_answer(&answer, &moving, &fixed);
    let text = if arguments.json {
        let json = serde_json::to_string(&record)
            .map_err(|e| Failure::new(Code::Output, e.to_string()))?;
        json + "\n"
    } else {
        report::text(&answer, &record, arguments.direction)
    };
    io::stdout()
        .write_all(text.as_bytes())
        .map_err(|error| Failure::output("standard output", &error))?;
    if let Some(path) = &arguments.picture {
        let scene = Scene {
            moving: &moving,
            moving_pose: arguments.moving_pose,
            fixed: &fixed,
            fixed_pose: arguments.fixed_pose,
            direction: arguments.direction,
            answer: &answer,
        };
        std::fs::write(path, draw(&scene))
            .map_err(|error| Failure::output(path.display(), &error))?;
    }
    Ok(())
}
