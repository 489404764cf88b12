//! `colltrans cast` and `colltrans clearance`: queries on two mesh files.

use std::io::{self, Read as _};
use std::path::Path;

use colltrans::glam::DVec3;
use colltrans::{Cast, Clearance, ContactRange, Options, ProofFile, QueryError};

use crate::args::{self, DirectionArguments, PairArguments};
use crate::body::{self, Part};
use crate::failure::{Code, Failure, note, print};
use crate::inputs::refuse_picture;
use crate::outputs;
use crate::picture::{Scene, draw};
use crate::proof::{self, refuse_proof};
use crate::record::{Hulls, Name, Record};
use crate::replay;
use crate::report::{self, Asked};

/// One answer, to either question.
enum Answer {
    Contact(ContactRange),
    Clearance(Clearance),
}

pub(crate) fn run(arguments: &PairArguments, asked: Asked) -> Result<(), Failure> {
    let (picture, inputs) = (arguments.picture.as_deref(), [&*arguments.moving, &*arguments.fixed]);
    refuse_picture(picture, &inputs)?;
    refuse_proof(arguments.save_proof.as_deref(), picture, &inputs)?;
    let places = &arguments.places;
    let [moving_pose, fixed_pose] = places.poses()?;
    let directions = directions(&arguments.directions)?;
    let [moving_options, fixed_options] = arguments.body_options();
    let moving = body::load_or_fail(&arguments.moving, &moving_options)?;
    let fixed = body::load_or_fail(&arguments.fixed, &fixed_options)?;
    let (placed, mended) = (places.notes(), moving.notes.iter().chain(&fixed.notes));
    placed.iter().flatten().chain(mended).for_each(|text| note(text));
    let options = Options::default()
        .with_solver(arguments.solver)
        .with_graze_tolerance(arguments.graze_tolerance);
    let [moving_at, fixed_at] = [moving.body.at(moving_pose), fixed.body.at(fixed_pose)];
    let cast = |direction| Cast::new(moving_at, fixed_at, direction)?.with_options(options);
    let parts = [&moving, &fixed];
    match directions {
        Directions::One(direction) => answer_one(arguments, asked, &cast(direction)?, parts),
        Directions::Many(all) => {
            let casts = all.into_iter().map(|direction| (direction, cast(direction)));
            scan(arguments.json, asked, casts, parts)
        }
    }
}

/// One answer in full, or one a line.
pub(crate) enum Directions {
    One(DVec3),
    Many(Vec<DVec3>),
}

/// What `--direction` and `--directions` say.
pub(crate) fn directions(asked: &DirectionArguments) -> Result<Directions, Failure> {
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
    asked: Asked,
    cast: &Cast<'_>,
    [moving, fixed]: [&Part; 2],
) -> Result<(Answer, Record), QueryError> {
    let (answer, record) = match asked {
        Asked::Contact => {
            let answer = cast.contact_range()?;
            let record = Record::of_answer(&answer, cast);
            (Answer::Contact(answer), record)
        }
        Asked::Clearance => {
            let answer = cast.clearance()?;
            let record = Record::of_clearance(&answer, cast);
            (Answer::Clearance(answer), record)
        }
    };
    Ok((answer, Record { hull: Hulls::of(moving.excess, fixed.excess), ..record }))
}

fn answer_one(
    arguments: &PairArguments,
    asked: Asked,
    cast: &Cast<'_>,
    parts: [&Part; 2],
) -> Result<(), Failure> {
    let answered = ask(asked, cast, parts);
    let (answer, record) = answered.map_err(|error| replay::failure(error, cast))?;
    let text = if arguments.json {
        record.json()
    } else {
        match &answer {
            Answer::Contact(answer) => report::cast(answer, &record, cast.direction()),
            Answer::Clearance(answer) => report::clearance(answer, &record, cast.direction()),
        }
    };
    print(&text)?;
    if let Some(path) = &arguments.save_proof {
        let proof = match &answer {
            Answer::Contact(range) => ProofFile::of_range(cast, range),
            Answer::Clearance(clearance) => ProofFile::of_clearance(cast, clearance),
        };
        proof::save(path, &proof)?;
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
    asked: Asked,
    casts: impl ExactSizeIterator<Item = (DVec3, Result<Cast<'a>, QueryError>)>,
    parts: [&Part; 2],
) -> Result<(), Failure> {
    let (count, mut failed) = (casts.len(), 0);
    if !as_json {
        print(&report::scan_head(asked))?;
        for (name, excess) in
            Hulls::of(parts[0].excess, parts[1].excess).iter().flat_map(Hulls::named)
        {
            note(&format!("{name}: {excess}"));
        }
    }
    for (direction, cast) in casts {
        let answered = cast.map_err(Failure::from).and_then(|cast| {
            let answered = ask(asked, &cast, parts);
            answered.map_err(|error| replay::failure(error, &cast))
        });
        let record = match answered {
            Ok((_, record)) => record,
            Err(failure) => Record::of_error(failure.into_message()),
        };
        failed += usize::from(record.outcome == Name::Error);
        let record = Record { direction: Some(direction.to_array()), ..record };
        let text =
            if as_json { record.json() } else { report::scan_line(&record, asked, direction) };
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
