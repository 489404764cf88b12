//! `colltrans path`: which links of a robot first meet on a path, each other or the scene.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use colltrans::motion::path::{JointPath, PathError, PathOutcome, Place};
use colltrans::record::{Ending, PathRecord, TimeRecord};
use colltrans::{ProofFile, ProofFileError};
use colltrans_assembly::AssemblyError;
use colltrans_assembly_io::ReadError;
use colltrans_assembly_io::read::{self, ReadOptions};
use colltrans_assembly_io::robot::{Cell, Robot, RobotError, Table, body_of};
use colltrans_mesh::body::BodyOptions;

use crate::args::PathArguments;
use crate::assembly::advice;
use crate::body;
use crate::driver::{AnswerOutputs, OutputTargets, no_picture};
use crate::failure::{Code, Failure, note};
use crate::inputs::read_text_or_stdin;
use crate::numbers::{counted, known, known_vector, number, unit_vector};
use crate::outputs;
use crate::report::{kept, line, meet};

pub(crate) fn run(arguments: &PathArguments) -> Result<(), Failure> {
    let PathArguments { robot, rows, scene, srdf, save_proof, .. } = arguments;
    let inputs: Vec<&Path> =
        [robot, rows].into_iter().chain(scene).chain(srdf).map(PathBuf::as_path).collect();
    let targets = OutputTargets::new(arguments.json, save_proof.as_ref(), None, &inputs)?;
    let Asked { cell, path, partial } = Asked::read(arguments)?;
    let query = |e: PathError| Failure::new(Code::Query, cell.words(&e));
    let cast = cell.along(&path, arguments.keep).map_err(|e| match e {
        PathError::Query { .. } => query(e),
        wrong => Failure::new(Code::Input, cell.words(&wrong)),
    })?;
    let outcome = match targets.save_proof {
        None => cast.first_contact().map_err(query)?,
        Some(file) => {
            let answered = ProofFile::with_path(&cast, cell.names());
            let (outcome, saved) = answered.map_err(|e| match e {
                ProofFileError::Path(e) => query(e),
                other => Failure::new(Code::Query, other.to_string()),
            })?;
            // Before the answer: a proof that cannot be written leaves none.
            outputs::write_proof(file, &saved.to_json())?;
            outcome
        }
    };
    let mut record = PathRecord::of(&outcome, &cast, cell.names());
    record.hulls = cell.hulls();
    record.dents.clone_from(cell.dents());
    record.notes.clone_from(&partial);
    targets.write_answer(AnswerOutputs {
        record: &record,
        words: || words(&record, &outcome, cell.robot()),
        proof: || Ok(None),
        picture: no_picture,
    })?;
    if let Some(why) = undecided(&record) {
        return Err(why);
    }
    match &partial[..] {
        [] => Ok(()),
        _ if !arguments.strict => Ok(()),
        _ => Err(Failure::several(Code::Partial, partial)),
    }
}

/// Why an answer proves less than was asked.
fn undecided(record: &PathRecord) -> Option<Failure> {
    let (Ending::Undecided, Some([a, b]), Some(time)) = (record.outcome, &record.pair, record.time)
    else {
        return None;
    };
    let why = format!(
        "the search between {a} and {b} took its maximum number of steps: no two bodies meet before {}, whether these \
         two do later is open; leave the pair out with --ignore {a},{b}, or ask with --keep",
        number(time.lower)
    );
    Some(Failure::new(Code::Query, why))
}

/// A robot among its scene, and its path.
struct Asked {
    cell: Cell,
    path: JointPath,
    /// In what the answer is about less than the input.
    partial: Vec<String>,
}

impl Asked {
    fn read(arguments: &PathArguments) -> Result<Self, Failure> {
        let input = |e: &dyn std::fmt::Display| Failure::new(Code::Input, e.to_string());
        let rest = resting(&arguments.joint)?;
        let ignored = ignored(&arguments.ignore)?;
        let options = ReadOptions::default()
            .with_packages(arguments.package.clone())
            .with_skip_missing(arguments.skip_missing)
            .with_hulls(arguments.hull.clone())
            .with_allow_outside(arguments.allow_outside);
        let robot = read::robot(&arguments.robot, &options).map_err(|e| unread(&e))?;
        robot.notes().iter().for_each(|text| note(text));
        let place = arguments.rows.display();
        let table = Table::parse(&read_text_or_stdin(&arguments.rows)?)
            .map_err(|e| input(&format!("{place}: {e}")))?;
        let (path, notes) =
            robot.path(&table, &rest).map_err(|e| input(&format!("{place}: {e}")))?;
        for text in &notes {
            note(text);
        }
        let (mut scene, mut dents) = (Vec::new(), Vec::new());
        for file in &arguments.scene {
            let options = BodyOptions::default().with_scale(arguments.scene_scale);
            let taken =
                colltrans_mesh::body::load(file, &options, |mesh, options| body_of(&mesh, options));
            let loaded = taken.map_err(|e| Failure::new(Code::Input, body::refusal(&e)))?;
            for text in &loaded.notes {
                note(&format!("{}: {text}", file.display()));
            }
            let stem =
                |file: &Path| file.file_stem().map(|stem| stem.to_string_lossy().into_owned());
            let name = stem(file).filter(|name| {
                let alike =
                    arguments.scene.iter().filter(|other| stem(other).as_ref() == Some(name));
                alike.count() == 1 && robot.link(name).is_err()
            });
            // Where that names something else, too, a body is called as it was given.
            let name = name.unwrap_or_else(|| file.display().to_string());
            dents.extend(loaded.dent().map(|depth| (name.clone(), depth)));
            scene.push((name, loaded.body));
        }
        let listed = arguments.srdf.as_deref().map(read::disabled).transpose();
        let listed = listed.map_err(|e| input(&e))?;
        let cell =
            Cell::new(robot, scene, listed.as_deref()).map_err(|e| match &arguments.srdf {
                Some(file) if matches!(e, RobotError::Unknown { .. }) => {
                    input(&format!("{}: {e}", file.display()))
                }
                _ => input(&e),
            })?;
        let cell = cell.with_dents(dents).ignoring(&ignored);
        let cell = cell.map_err(|e| Failure::new(Code::Usage, format!("--ignore: {e}")))?;
        cell.notes().iter().for_each(|text| note(text));
        let cell = cell.with_a_pair().map_err(|e| input(&e))?;
        Ok(Self { cell, path, partial: table.straight().into_iter().collect() })
    }
}

/// A robot that cannot be read, and what to do about a mesh that is no surface of a body.
fn unread(error: &ReadError) -> Failure {
    let hint = match error {
        ReadError::Assembly { source: AssemblyError::Part { part, .. }, .. } => {
            format!("; --hull {part} takes the convex hull of its meshes")
        }
        ReadError::Missing { .. } | ReadError::Outside { .. } => advice(error).to_owned(),
        _ => String::new(),
    };
    Failure::new(Code::Input, format!("{error}{hint}"))
}

/// The pairs of --ignore.
fn ignored(given: &[String]) -> Result<Vec<[String; 2]>, Failure> {
    let one = |text: &String| {
        let pair = text.split_once(',').map(|(a, b)| [a, b].map(|name| name.trim().to_owned()));
        pair.ok_or_else(|| Failure::new(Code::Usage, format!("--ignore {text}: not A,B")))
    };
    given.iter().map(one).collect()
}

/// The joints that rest.
fn resting(given: &[String]) -> Result<BTreeMap<String, f64>, Failure> {
    let mut joints = BTreeMap::new();
    for text in given {
        let wrong = |why: &str| Failure::new(Code::Usage, format!("--joint {text}: {why}"));
        let parts = text.split_once('=').and_then(|(n, v)| Some((n, v.trim().parse().ok()?)));
        let Some((name, value)) = parts.filter(|(_, value): &(&str, f64)| value.is_finite()) else {
            return Err(wrong("not NAME=VALUE, in radians or metres"));
        };
        if joints.insert(name.trim().to_owned(), value).is_some() {
            return Err(wrong("this joint is there twice"));
        }
    }
    Ok(joints)
}

/// All pairs that meet at the start, and how they are left out: those of two links as SRDF has them.
fn overlapping(text: &mut String, record: &PathRecord, robot: &Robot) {
    let pairs = &record.overlaps;
    for [a, b] in pairs {
        let head = if record.keep.is_none() { "overlap" } else { "too near" };
        line(text, head, &format!("{a}, {b}"));
    }
    if pairs.is_empty() {
        return;
    }
    let ignore: Vec<String> =
        pairs.iter().map(|[a, b]| format!("--ignore {}", quoted(&format!("{a},{b}")))).collect();
    line(text, "leave out", &ignore.join(" "));
    let are_links = |pair: &&[String; 2]| pair.iter().all(|name| robot.link(name).is_ok());
    for [a, b] in pairs.iter().filter(are_links) {
        let element = format!(
            "<disable_collisions link1=\"{}\" link2=\"{}\" reason=\"Default\"/>",
            escaped(a),
            escaped(b)
        );
        line(text, "in SRDF", &element);
    }
}

/// Returns a word as a shell takes it.
fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "_-.,/:+".contains(c);
    if word.chars().all(is_plain) {
        word.into()
    } else {
        format!("'{}'", word.replace('\'', r"'\''"))
    }
}

/// Returns a value of an attribute of XML.
fn escaped(value: &str) -> String {
    value.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;")
}

/// The readable answer.
fn words(record: &PathRecord, outcome: &PathOutcome, robot: &Robot) -> String {
    let asked = if record.left_out.is_empty() { "" } else { " of those asked about" };
    let mut text = match record.outcome {
        Ending::Contact => "contact\n".into(),
        Ending::Undecided => "undecided: the search took its maximum number of steps\n".into(),
        Ending::Grazing => "grazing: two bodies come nearer than rounding can tell\n".into(),
        Ending::Overlapping => {
            let count = record.overlaps.len();
            let pairs = match record.keep {
                None => counted(count, "pair overlaps", "pairs overlap"),
                Some(gap) => {
                    let pairs = counted(count, "pair overlaps or is", "pairs overlap or are");
                    format!("{pairs} as near as {}", number(gap))
                }
            };
            format!("overlapping: {pairs} where the path begins\n")
        }
        _ => format!("free: no two bodies{asked} {} on the whole path\n", meet(record.keep)),
    };
    if let Some([a, b]) = record.pair.as_ref().filter(|_| record.overlaps.is_empty()) {
        line(&mut text, "bodies", &format!("{a}, {b}"));
    }
    overlapping(&mut text, record, robot);
    if let Some(TimeRecord { lower, upper }) = record.time
        && record.outcome != Ending::Overlapping
    {
        if record.outcome == Ending::Undecided {
            line(&mut text, "free until", &number(lower));
            if let Some(upper) = upper {
                line(&mut text, "no later", &format!("{}, when others meet", number(upper)));
            }
        } else if let Some(upper) = upper {
            line(&mut text, "time", &known(lower + 0.5 * (upper - lower), upper - lower));
            line(&mut text, "bounds", &format!("{} to {}", number(lower), number(upper)));
        } else {
            line(&mut text, "no earlier", &number(lower));
        }
        if let Some(Place { row, share }) = record.place {
            let percent = known(100.0 * share, 0.1);
            line(
                &mut text,
                "place",
                &format!("{percent} % of the way from row {row} to the next one"),
            );
        }
    }
    if let Some(point) = record.point {
        line(&mut text, "point", &known_vector(point.into(), 1e-12));
    }
    if let Some(normal) = record.normal {
        line(&mut text, "normal", &unit_vector(normal.into()));
    }
    line(&mut text, "asked", &counted(record.pairs, "pair of bodies", "pairs of bodies"));
    if !record.left_out.is_empty() {
        let pairs: Vec<String> = record.left_out.iter().map(|[a, b]| format!("{a}, {b}")).collect();
        line(&mut text, "left out", &pairs.join("; "));
    }
    kept(&mut text, record.keep);
    if !record.hulls.is_empty() {
        let names = record.hulls.join(", ");
        line(&mut text, "hulls", &format!("{names}: a contact of one is that of its convex hull"));
    }
    for text_of in &record.notes {
        line(&mut text, "only", text_of);
    }
    let looks = counted(outcome.steps().looks as usize, "look", "looks");
    let planes = counted(record.planes, "plane", "planes");
    line(&mut text, "proof", &format!("{planes}, found in {looks}"));
    text
}
