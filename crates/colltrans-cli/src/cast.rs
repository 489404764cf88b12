//! Casts of two convex meshes: `colltrans cast`, and `colltrans clearance` if both meshes are convex.

use std::path::{Path, PathBuf};
use std::slice;

use colltrans::glam::DVec3;
use colltrans::record::{Answer, Question};
use colltrans::{Cast, Options, Pose};

use crate::args::{self, CastArguments, DirectionArguments, PairArguments};
use crate::body::{Part, load_error_message};
use crate::case;
use crate::driver::{AnswerOutputs, OutputTargets, answer_directions};
use crate::failure::{Code, Failure, note, print};
use crate::inputs::read_text_or_stdin;
use crate::load;
use crate::numbers::smaller_extent;
use crate::picture::{CastPicture, draw_cast};
use crate::record::{Hulls, Line};
use crate::report;

pub(crate) fn run(arguments: &CastArguments) -> Result<(), Failure> {
    let files = [&arguments.moving, &arguments.fixed].map(slice::from_ref);
    let request = Request::from_arguments(&arguments.pair, files)?;
    let bodies = load::read_convex(files, &arguments.pair.body_options());
    let [moving, fixed] =
        bodies.map_err(|error| Failure::new(Code::Input, load_error_message(&error)))?;
    request.answer_convex(Question::Contact, [&moving[0], &fixed[0]])
}

/// A query along one or many directions. Its outputs and poses are checked before the meshes are read.
pub(crate) struct Request<'a> {
    arguments: &'a PairArguments,
    pub(crate) targets: OutputTargets<'a>,
    pub(crate) poses: [Pose; 2],
    pub(crate) directions: Directions,
}

impl<'a> Request<'a> {
    /// Returns the request of a command line.
    ///
    /// # Errors
    /// An output would overwrite an input, or a pose or the file of directions is invalid.
    pub(crate) fn from_arguments(
        arguments: &'a PairArguments,
        files: [&[PathBuf]; 2],
    ) -> Result<Self, Failure> {
        let PairArguments { json, save_proof, picture, places, directions, .. } = arguments;
        let inputs = load::input_paths(files);
        let targets = OutputTargets::new(*json, save_proof.as_ref(), picture.as_ref(), &inputs)?;
        let poses = places.poses()?;
        Ok(Self { arguments, targets, poses, directions: Directions::from_arguments(directions)? })
    }

    /// Answers the request for convex bodies, and writes the answer.
    pub(crate) fn answer_convex(
        self,
        question: Question,
        parts: [&Part; 2],
    ) -> Result<(), Failure> {
        let Self { arguments, targets, poses, directions } = self;
        load::print_notes(&arguments.places, parts.iter().flat_map(|part| &part.notes));
        let options = Options::default()
            .with_solver(arguments.solver)
            .with_narrowing(arguments.narrowing()?)
            .with_graze_tolerance(arguments.graze_tolerance)
            .with_min_gap(arguments.min_gap);
        let [moving, fixed] = [0, 1].map(|k| parts[k].body.at(poses[k]));
        let cast = |direction| Cast::new(moving, fixed, direction)?.with_options(options);
        let answer_cast = |cast: &Cast<'_>| -> Result<(Answer, Line), Failure> {
            let answer = question.answer(cast).map_err(|error| case::cast_failure(error, cast))?;
            Ok((answer, Line::from(answer.record(cast)).with_parts(parts)))
        };
        let all = match directions {
            Directions::Many(all) => all,
            Directions::One(direction) => {
                let cast = cast(direction)?;
                let (answer, line) = answer_cast(&cast)?;
                return targets.write_answer(AnswerOutputs {
                    record: &line,
                    text: || {
                        report::cast_answer_text(
                            &answer,
                            &line,
                            cast.direction(),
                            smaller_extent(parts.map(Part::bounds)),
                        )
                    },
                    proof: || Ok(Some(answer.proof(&cast).to_json())),
                    picture: || {
                        let range = match answer {
                            Answer::Contact(range) => range,
                            Answer::Clearance(_) => cast.contact_range()?,
                        };
                        Ok(draw_cast(&CastPicture { cast: &cast, answer: &range }))
                    },
                });
            }
        };
        if !targets.json {
            print(&report::scan_header(question))?;
            for (name, excess) in Hulls::from_parts(parts).iter().flat_map(Hulls::named_excesses) {
                note(&format!("{name}: {excess}"));
            }
        }
        let line_of = |direction| Ok(answer_cast(&cast(direction)?)?.1);
        answer_directions(targets.json, all, line_of, report::scan_line)
    }
}

/// One direction, whose answer is printed in full, or many with one line each.
pub(crate) enum Directions {
    One(DVec3),
    Many(Vec<DVec3>),
}

impl Directions {
    /// Returns the directions of `--direction` or `--directions`.
    fn from_arguments(arguments: &DirectionArguments) -> Result<Self, Failure> {
        match (arguments.direction, arguments.directions.as_deref()) {
            (_, Some(file)) => read_directions(file).map(Self::Many),
            (Some(direction), None) => Ok(Self::One(direction)),
            (None, None) => Err(Failure::new(Code::Usage, "give --direction or --directions")),
        }
    }
}

/// Reads a file with one direction per line. Empty lines and comments after `#` are skipped.
///
/// # Errors
/// The file cannot be read, a line is not a direction, or the file has none.
fn read_directions(file: &Path) -> Result<Vec<DVec3>, Failure> {
    let input = |what: String| Failure::new(Code::Input, format!("{}: {what}", file.display()));
    let text = read_text_or_stdin(file)?;
    let text = text.strip_prefix('\u{feff}').unwrap_or(&text).replace("\r\n", "\n");
    let mut found = Vec::new();
    for (number, line) in text.split(['\n', '\r']).enumerate() {
        let content = line.split('#').next().unwrap_or_default().trim();
        if content.is_empty() {
            continue;
        }
        // Numbers are separated by commas or blanks.
        let with_commas = if content.contains(',') {
            content.to_owned()
        } else {
            content.split_whitespace().collect::<Vec<_>>().join(",")
        };
        let direction = args::direction(&with_commas)
            .map_err(|what| input(format!("line {}: {what}", number + 1)))?;
        found.push(direction);
    }
    if found.is_empty() {
        return Err(input(
            "contains no directions; expected one per line, x,y,z or an axis".into(),
        ));
    }
    Ok(found)
}
