//! Queries on two convex meshes: `colltrans cast`, and `colltrans clearance` where they are convex.

use std::io::{self, Read as _};
use std::path::Path;

use colltrans::glam::DVec3;
use colltrans::record::{Answer, Question};
use colltrans::{Cast, Options, Pose, QueryError};
use colltrans_mesh::body::{BodyOptions, LoadError};

use crate::args::{self, CastArguments, DirectionArguments, PairArguments};
use crate::body::{self, Part};
use crate::case;
use crate::failure::{Code, Failure, note, print};
use crate::inputs::{refuse_picture, refuse_proof};
use crate::outputs;
use crate::picture::{Scene, draw};
use crate::record::{Hulls, Line};
use crate::report;

pub(crate) fn run(arguments: &CastArguments, question: Question) -> Result<(), Failure> {
    let files = [&*arguments.moving, &*arguments.fixed];
    let request = Request::of(&arguments.pair, &files)?;
    let parts = load(files, &arguments.pair.body_options());
    let [moving, fixed] =
        parts.map_err(|error| Failure::new(Code::Input, body::refusal(&error)))?;
    request.convex(question, [&moving, &fixed])
}

/// Both files as convex bodies.
pub(crate) fn load(files: [&Path; 2], options: &[BodyOptions; 2]) -> Result<[Part; 2], LoadError> {
    Ok([body::load(files[0], &options[0])?, body::load(files[1], &options[1])?])
}

/// What is asked of two bodies, checked before they are read.
pub(crate) struct Request<'a> {
    pub(crate) arguments: &'a PairArguments,
    pub(crate) poses: [Pose; 2],
    pub(crate) directions: Directions,
}

impl<'a> Request<'a> {
    pub(crate) fn of(arguments: &'a PairArguments, inputs: &[&Path]) -> Result<Self, Failure> {
        let picture = arguments.picture.as_deref();
        refuse_picture(picture, inputs)?;
        refuse_proof(arguments.save_proof.as_deref(), picture, inputs)?;
        let poses = arguments.places.poses()?;
        Ok(Self { arguments, poses, directions: directions(&arguments.directions)? })
    }

    /// Says what was changed about the poses and mended in the files.
    pub(crate) fn tell(&self, mended: [&[String]; 2]) {
        let placed = self.arguments.places.notes();
        placed.iter().flatten().chain(mended.into_iter().flatten()).for_each(|text| note(text));
    }

    /// Asked of convex bodies.
    pub(crate) fn convex(self, question: Question, parts: [&Part; 2]) -> Result<(), Failure> {
        self.tell(parts.map(|part| part.notes.as_slice()));
        let Self { arguments, poses, directions } = self;
        let options = Options::default()
            .with_solver(arguments.solver)
            .with_narrowing(arguments.narrowing()?)
            .with_graze_tolerance(arguments.graze_tolerance)
            .with_keep(arguments.keep);
        let [moving, fixed] = [0, 1].map(|k| parts[k].body.at(poses[k]));
        let cast = |direction| Cast::new(moving, fixed, direction)?.with_options(options);
        match directions {
            Directions::One(direction) => answer_one(arguments, question, &cast(direction)?, parts),
            Directions::Many(all) => {
                let casts = all.into_iter().map(|direction| (direction, cast(direction)));
                scan(arguments.json, question, casts, parts)
            }
        }
    }
}

/// One answer in full, or one a line.
pub(crate) enum Directions {
    One(DVec3),
    Many(Vec<DVec3>),
}

/// What `--direction` and `--directions` say.
fn directions(asked: &DirectionArguments) -> Result<Directions, Failure> {
    match (asked.direction, asked.directions.as_deref()) {
        (_, Some(file)) => read_directions(file).map(Directions::Many),
        (Some(direction), None) => Ok(Directions::One(direction)),
        (None, None) => Err(Failure::new(Code::Usage, "give --direction or --directions")),
    }
}

/// One direction a line; the first line that is none ends the command.
fn read_directions(file: &Path) -> Result<Vec<DVec3>, Failure> {
    let input = |what: String| Failure::new(Code::Input, format!("{}: {what}", file.display()));
    let mut text = String::new();
    let read = if file == Path::new("-") {
        io::stdin().read_to_string(&mut text).map(|_| ())
    } else {
        colltrans_mesh::file::text(file).map(|read| text = read)
    };
    read.map_err(|error| input(format!("cannot be read: {error}")))?;
    let text = text.strip_prefix('\u{feff}').unwrap_or(&text).replace("\r\n", "\n");
    let mut found = Vec::new();
    for (number, line) in text.split(['\n', '\r']).enumerate() {
        let content = line.split('#').next().unwrap_or_default().trim();
        if content.is_empty() {
            continue;
        }
        // Commas or blanks between the numbers.
        let commas = if content.contains(',') {
            content.to_owned()
        } else {
            content.split_whitespace().collect::<Vec<_>>().join(",")
        };
        let direction = args::direction(&commas)
            .map_err(|what| input(format!("line {}: {what}", number + 1)))?;
        found.push(direction);
    }
    if found.is_empty() {
        return Err(input("holds no directions".into()));
    }
    Ok(found)
}

/// An answer, and what is said about it.
fn ask(
    question: Question,
    cast: &Cast<'_>,
    parts: [&Part; 2],
) -> Result<(Answer, Line), QueryError> {
    let answer = question.ask(cast)?;
    Ok((answer, Line::of_parts(answer.record(cast), parts)))
}

fn answer_one(
    arguments: &PairArguments,
    question: Question,
    cast: &Cast<'_>,
    parts: [&Part; 2],
) -> Result<(), Failure> {
    let answered = ask(question, cast, parts);
    let (answer, told) = answered.map_err(|error| case::failure(error, cast))?;
    let in_words = || report::answer(&answer, &told, cast.direction());
    print(&if arguments.json { told.json() } else { in_words() })?;
    if let Some(path) = &arguments.save_proof {
        outputs::write_proof(path, &answer.proof(cast).to_json())?;
    }
    let Some(path) = &arguments.picture else { return Ok(()) };
    let range = match answer {
        Answer::Contact(range) => range,
        Answer::Clearance(_) => cast.contact_range()?,
    };
    outputs::write(path, draw(&Scene { cast, answer: &range }).as_bytes())
}

/// One line for each direction, also for those without an answer.
fn scan<'a>(
    as_json: bool,
    question: Question,
    casts: impl ExactSizeIterator<Item = (DVec3, Result<Cast<'a>, QueryError>)>,
    parts: [&Part; 2],
) -> Result<(), Failure> {
    let (count, mut failed) = (casts.len(), 0);
    if !as_json {
        print(&report::scan_head(question))?;
        for (name, excess) in Hulls::of(parts).iter().flat_map(Hulls::named) {
            note(&format!("{name}: {excess}"));
        }
    }
    for (direction, cast) in casts {
        let answered = cast.map_err(Failure::from).and_then(|cast| {
            let answered = ask(question, &cast, parts);
            answered.map_err(|error| case::failure(error, &cast))
        });
        let mut line = match answered {
            Ok((_, line)) => line,
            Err(failure) => Line::error(failure.into_message()),
        };
        failed += usize::from(line.is_error());
        line.record.direction = Some(direction.to_array());
        let text = if as_json {
            line.json()
        } else {
            report::scan_line(&line.record, question, direction)
        };
        print(&text)?;
    }
    all_answered(count, failed)
}

/// A failure if some directions have no answer.
pub(crate) fn all_answered(count: usize, failed: usize) -> Result<(), Failure> {
    if failed > 0 {
        let message = format!("{failed} of {count} directions have no answer");
        return Err(Failure::new(Code::Lines, message));
    }
    Ok(())
}
