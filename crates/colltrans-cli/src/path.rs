//! `colltrans path`: the first contact of a robot's links with each other or with a scene on a path.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use colltrans::motion::path::{JointPath, PathCast, PathError, PathOutcome, PathPlace};
use colltrans::record::{Ending, PathRecord, TimeRecord};
use colltrans::{AnyPlaced, ProofFile, ProofFileError};
use colltrans_assembly::AssemblyError;
use colltrans_assembly_io::ReadError;
use colltrans_assembly_io::read::{self, ReadOptions};
use colltrans_assembly_io::robot::{Cell, Robot, RobotError, Table, body_from_mesh};
use colltrans_mesh::body::BodyOptions;

use crate::args::PathArguments;
use crate::assembly::read_error_hint;
use crate::body::{self, convex_bounds};
use crate::driver::{AnswerOutputs, OutputTargets, no_picture};
use crate::failure::{Code, Failure, note};
use crate::inputs::read_text_or_stdin;
use crate::numbers::{
    at_least, at_most, count_text, estimate, interval, length_down, point, smaller_extent,
    unit_vector,
};
use crate::outputs;
use crate::report::{meet_verb, push_line, push_min_gap};
use crate::solid::solid_bounds;

pub(crate) fn run(arguments: &PathArguments) -> Result<(), Failure> {
    let PathArguments { robot, rows, scene, srdf, save_proof, .. } = arguments;
    let inputs: Vec<&Path> =
        [robot, rows].into_iter().chain(scene).chain(srdf).map(PathBuf::as_path).collect();
    let targets = OutputTargets::new(arguments.json, save_proof.as_ref(), None, &inputs)?;
    let PathQuery { cell, path, limitations } = PathQuery::read(arguments)?;
    let query_failure = |e: PathError| Failure::new(Code::Query, cell.error_message(&e));
    let cast = cell.path_cast(&path, arguments.min_gap).map_err(|e| match e {
        PathError::Query { .. } => query_failure(e),
        other => Failure::new(Code::Input, cell.error_message(&other)),
    })?;
    let outcome = match targets.save_proof {
        None => cast.first_contact().map_err(query_failure)?,
        Some(file) => {
            let proven = ProofFile::with_path(&cast, cell.names());
            let (outcome, proof) = proven.map_err(|e| match e {
                ProofFileError::Path(e) => query_failure(e),
                other => Failure::new(Code::Query, other.to_string()),
            })?;
            // Written before the answer is printed, so that a failure to write it leaves no answer.
            outputs::write_proof(file, &proof.to_json())?;
            outcome
        }
    };
    let mut record = PathRecord::from_outcome(&outcome, &cast, cell.names());
    record.hulls = cell.hull_links();
    record.dents.clone_from(cell.dents());
    record.notes.clone_from(&limitations);
    targets.write_answer(AnswerOutputs {
        record: &record,
        text: || answer_text(&record, &outcome, cell.robot(), smallest_extent(&cast)),
        proof: || Ok(None),
        picture: no_picture,
    })?;
    if let Some(failure) = undecided_failure(&record) {
        return Err(failure);
    }
    match &limitations[..] {
        [] => Ok(()),
        _ if !arguments.strict => Ok(()),
        _ => Err(Failure::with_messages(Code::Partial, limitations)),
    }
}

/// Returns the failure of an undecided search; `None` for other answers.
fn undecided_failure(record: &PathRecord) -> Option<Failure> {
    let (Ending::Undecided, Some([a, b]), Some(time)) = (record.outcome, &record.pair, record.time)
    else {
        return None;
    };
    let message = format!(
        "the search between {a} and {b} took its maximum number of steps: no two bodies meet before {}; later contacts of \
         these two are undecided; leave the pair out with --ignore {a},{b}, or give a minimum gap with --min-gap",
        at_least(time.lower)
    );
    Some(Failure::new(Code::Query, message))
}

/// A robot in its scene, and its path.
struct PathQuery {
    cell: Cell,
    path: JointPath,
    /// How the answer covers less than the input.
    limitations: Vec<String>,
}

impl PathQuery {
    /// Reads the robot, its path and the scene.
    ///
    /// # Errors
    /// A file cannot be read, a name is unknown, or no pair of bodies is left.
    fn read(arguments: &PathArguments) -> Result<Self, Failure> {
        let input = |e: &dyn std::fmt::Display| Failure::new(Code::Input, e.to_string());
        let fixed_joints = fixed_joints(&arguments.joint)?;
        let ignored_pairs = ignored_pairs(&arguments.ignore)?;
        let options = ReadOptions::default()
            .with_packages(arguments.package.clone())
            .with_skip_missing(arguments.skip_missing)
            .with_hulls(arguments.hull.clone())
            .with_allow_outside(arguments.allow_outside);
        let robot = read::read_robot(&arguments.robot, &options).map_err(|e| robot_failure(&e))?;
        robot.notes().iter().for_each(|text| note(text));
        let place = arguments.rows.display();
        let table = Table::parse(&read_text_or_stdin(&arguments.rows)?)
            .map_err(|e| input(&format!("{place}: {e}")))?;
        let (path, notes) =
            robot.joint_path(&table, &fixed_joints).map_err(|e| input(&format!("{place}: {e}")))?;
        for text in &notes {
            note(text);
        }
        let (mut scene, mut dents) = (Vec::new(), Vec::new());
        for file in &arguments.scene {
            let options = BodyOptions::default().with_scale(arguments.scene_scale);
            let loaded = colltrans_mesh::body::load(file, &options, |mesh, options| {
                body_from_mesh(&mesh, options)
            });
            let loaded =
                loaded.map_err(|e| Failure::new(Code::Input, body::load_error_message(&e)))?;
            for text in &loaded.notes {
                note(&format!("{}: {text}", file.display()));
            }
            let stem =
                |file: &Path| file.file_stem().map(|stem| stem.to_string_lossy().into_owned());
            let name = stem(file).filter(|name| {
                let same_name =
                    arguments.scene.iter().filter(|other| stem(other).as_ref() == Some(name));
                same_name.count() == 1 && robot.link_index(name).is_err()
            });
            // If the name is ambiguous, the path of the file is the name.
            let name = name.unwrap_or_else(|| file.display().to_string());
            dents.extend(loaded.dent().map(|depth| (name.clone(), depth)));
            scene.push((name, loaded.body));
        }
        let listed = arguments.srdf.as_deref().map(read::read_disabled_pairs).transpose();
        let listed = listed.map_err(|e| input(&e))?;
        let cell =
            Cell::new(robot, scene, listed.as_deref()).map_err(|e| match &arguments.srdf {
                Some(file) if matches!(e, RobotError::Unknown { .. }) => {
                    input(&format!("{}: {e}", file.display()))
                }
                _ => input(&e),
            })?;
        let cell = cell.with_dents(dents).without_pairs(&ignored_pairs);
        let cell = cell.map_err(|e| Failure::new(Code::Usage, format!("--ignore: {e}")))?;
        cell.notes().iter().for_each(|text| note(text));
        let cell = cell.require_pair().map_err(|e| input(&e))?;
        Ok(Self { cell, path, limitations: table.unused_note().into_iter().collect() })
    }
}

/// Returns the failure of a robot that cannot be read, with an option that avoids it.
fn robot_failure(error: &ReadError) -> Failure {
    let hint = match error {
        ReadError::Assembly { source: AssemblyError::Part { part, .. }, .. } => {
            format!("; --hull {part} takes the convex hull of its meshes")
        }
        ReadError::MissingMeshes { .. } | ReadError::OutsideFolder { .. } => {
            read_error_hint(error).to_owned()
        }
        _ => String::new(),
    };
    Failure::new(Code::Input, format!("{error}{hint}"))
}

/// Parses the pairs of `--ignore`.
fn ignored_pairs(given: &[String]) -> Result<Vec<[String; 2]>, Failure> {
    let parse = |text: &String| {
        let pair = text.split_once(',').map(|(a, b)| [a, b].map(|name| name.trim().to_owned()));
        pair.ok_or_else(|| {
            Failure::new(Code::Usage, format!("--ignore {text}: expected two names A,B"))
        })
    };
    given.iter().map(parse).collect()
}

/// Parses the values of `--joint`.
fn fixed_joints(given: &[String]) -> Result<BTreeMap<String, f64>, Failure> {
    let mut joints = BTreeMap::new();
    for text in given {
        let invalid = |why: &str| Failure::new(Code::Usage, format!("--joint {text}: {why}"));
        let parts = text.split_once('=').and_then(|(n, v)| Some((n, v.trim().parse().ok()?)));
        let Some((name, value)) = parts.filter(|(_, value): &(&str, f64)| value.is_finite()) else {
            return Err(invalid("expected NAME=VALUE, in radians or metres"));
        };
        if joints.insert(name.trim().to_owned(), value).is_some() {
            return Err(invalid("this joint already has a value; give one --joint for each"));
        }
    }
    Ok(joints)
}

/// Appends all pairs that overlap at the start, and the options and elements of SRDF that leave them out.
fn push_overlaps(text: &mut String, record: &PathRecord, robot: &Robot) {
    let pairs = &record.overlaps;
    for [a, b] in pairs {
        let head = if record.min_gap.is_none() { "overlap" } else { "too near" };
        push_line(text, head, &format!("{a}, {b}"));
    }
    if pairs.is_empty() {
        return;
    }
    let ignore: Vec<String> = pairs
        .iter()
        .map(|[a, b]| format!("--ignore {}", shell_quoted(&format!("{a},{b}"))))
        .collect();
    push_line(text, "leave out", &ignore.join(" "));
    let are_links = |pair: &&[String; 2]| pair.iter().all(|name| robot.link_index(name).is_ok());
    for [a, b] in pairs.iter().filter(are_links) {
        let element = format!(
            "<disable_collisions link1=\"{}\" link2=\"{}\" reason=\"Default\"/>",
            xml_escaped(a),
            xml_escaped(b)
        );
        push_line(text, "in SRDF", &element);
    }
}

/// Quotes a word for a shell if necessary.
fn shell_quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "_-.,/:+".contains(c);
    if word.chars().all(is_plain) {
        word.into()
    } else {
        format!("'{}'", word.replace('\'', r"'\''"))
    }
}

/// Escapes a value of an XML attribute.
fn xml_escaped(value: &str) -> String {
    value.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;")
}

/// Returns the extent of the smallest body.
fn smallest_extent(cast: &PathCast<'_>) -> f64 {
    smaller_extent(cast.bodies().map(|placed| match placed {
        AnyPlaced::Convex(placed) => convex_bounds(placed.body),
        AnyPlaced::Solid(placed) => solid_bounds(placed.body),
    }))
}

/// Returns the answer as text. `extent` is that of the smallest body.
fn answer_text(record: &PathRecord, outcome: &PathOutcome, robot: &Robot, extent: f64) -> String {
    let restriction = if record.left_out.is_empty() { "" } else { " of the checked pairs" };
    let mut text = match record.outcome {
        Ending::Contact => "contact\n".into(),
        Ending::Undecided => "undecided: the search took its maximum number of steps\n".into(),
        Ending::Grazing => "grazing: two bodies come nearer than rounding resolves\n".into(),
        Ending::Overlapping => {
            let count = record.overlaps.len();
            let pairs = match record.min_gap {
                None => count_text(count, "pair overlaps", "pairs overlap"),
                Some(gap) => {
                    let pairs = count_text(count, "pair overlaps or is", "pairs overlap or are");
                    format!("{pairs} as near as {}", length_down(gap))
                }
            };
            format!("overlapping: {pairs} where the path begins\n")
        }
        _ => format!(
            "free: no two bodies{restriction} {} on the whole path\n",
            meet_verb(record.min_gap)
        ),
    };
    if let Some([a, b]) = record.pair.as_ref().filter(|_| record.overlaps.is_empty()) {
        push_line(&mut text, "bodies", &format!("{a}, {b}"));
    }
    push_overlaps(&mut text, record, robot);
    if let Some(TimeRecord { lower, upper }) = record.time
        && record.outcome != Ending::Overlapping
    {
        if record.outcome == Ending::Undecided {
            push_line(&mut text, "free until", &at_least(lower));
            if let Some(upper) = upper {
                let end = format!("{}, when another pair meets", at_most(upper));
                push_line(&mut text, "no later", &end);
            }
        } else if let Some(upper) = upper {
            let middle = lower + 0.5 * (upper - lower);
            push_line(&mut text, "time", &estimate(middle, upper - lower));
            push_line(&mut text, "bounds", &interval([lower, upper]));
        } else {
            push_line(&mut text, "no earlier", &at_least(lower));
        }
        if let Some(PathPlace { row, share }) = record.place {
            let percent = estimate(100.0 * share, 0.1);
            push_line(
                &mut text,
                "place",
                &format!("{percent} % of the way from row {row} to the next one"),
            );
        }
    }
    if let Some(place) = record.point {
        push_line(&mut text, "point", &point(place.into(), 0.0, extent));
    }
    if let Some(normal) = record.normal {
        push_line(&mut text, "normal", &unit_vector(normal.into()));
    }
    push_line(&mut text, "checked", &count_text(record.pairs, "pair of bodies", "pairs of bodies"));
    if !record.left_out.is_empty() {
        let pairs: Vec<String> = record.left_out.iter().map(|[a, b]| format!("{a}, {b}")).collect();
        push_line(&mut text, "left out", &pairs.join("; "));
    }
    push_min_gap(&mut text, record.min_gap);
    if !record.hulls.is_empty() {
        let names = record.hulls.join(", ");
        push_line(&mut text, "hulls", &format!("{names}: a contact is that of the convex hull"));
    }
    for note in &record.notes {
        push_line(&mut text, "only", note);
    }
    let samples = count_text(outcome.steps().looks as usize, "distance sample", "distance samples");
    let planes = count_text(record.planes, "plane", "planes");
    push_line(&mut text, "proof", &format!("{planes}, found with {samples}"));
    text
}
