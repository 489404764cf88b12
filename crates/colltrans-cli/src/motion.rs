//! `colltrans motion`: when meshes that turn first meet others. Convex ones are asked as convex bodies, all
//! others as parts.

use std::path::PathBuf;

use colltrans::glam::DVec3;
use colltrans::motion::{Motion, MotionCast, MotionOutcome};
use colltrans::record::{Ending, MotionRecord, TimeRecord};
use colltrans::{Pose, ProofFile, QueryError, Stalled};

use crate::args::MotionArguments;
use crate::body::Part;
use crate::case;
use crate::driver::{AnswerOutputs, OutputTargets};
use crate::failure::{Code, Failure, note};
use crate::load;
use crate::numbers::{counted, known, known_vector, number, unit_vector};
use crate::picture::{Moved, Surface, draw_motion};
use crate::record::Line;
use crate::report::{features, hulls, kept, line, never, overlaps};
use crate::solid::{self, PartsMotion, surface_of};

pub(crate) fn run(arguments: &MotionArguments) -> Result<(), Failure> {
    let sides = arguments.sides()?;
    let MotionArguments { json, save_proof, picture, .. } = arguments;
    let inputs = load::input_files(sides.files);
    let targets = OutputTargets::new(*json, save_proof.as_ref(), picture.as_ref(), &inputs)?;
    let (motions, rounded) = arguments.motions()?;
    for text in &rounded {
        note(text);
    }
    match load::convex_bodies(&sides, &arguments.body_options())? {
        Some(bodies) => convex(arguments, targets, sides.files, &bodies, &motions),
        None => parts(arguments, targets, sides.files, &motions),
    }
}

/// Asked of convex meshes.
fn convex(
    arguments: &MotionArguments,
    targets: OutputTargets<'_>,
    files: [&[PathBuf]; 2],
    bodies: &[Vec<Part>; 2],
    motions: &[Motion; 2],
) -> Result<(), Failure> {
    if arguments.tolerance.is_some() && arguments.keep > 0.0 {
        let why = "convex meshes have either --keep or --tolerance";
        return Err(Failure::new(Code::Usage, why));
    }
    load::report_notes(&arguments.places, bodies.iter().flatten().flat_map(|part| &part.notes));
    let (found, proofs) = first_of_all(arguments, files, [&bodies[0], &bodies[1]], motions)?;
    let Found { mut told, pair, undecided } = found;
    let name =
        |k: usize| Some(files[k][pair[k]].display().to_string()).filter(|_| files[k].len() > 1);
    (told.record.moving, told.record.fixed) = (name(0), name(1));
    let proof = || {
        let proof = ProofFile::of_motions(proofs);
        Ok(Some(proof.map_err(|error| Failure::new(Code::Query, error.to_string()))?.to_json()))
    };
    let surface = |k: usize, pose: &Pose, from| surface_of(&bodies[k][pair[k]].body, pose, from);
    write_answer(targets, &told, motions, proof, &surface)?;
    undecided.map_or(Ok(()), Err)
}

/// Asked of parts that need not be convex.
fn parts(
    arguments: &MotionArguments,
    targets: OutputTargets<'_>,
    files: [&[PathBuf]; 2],
    motions: &[Motion; 2],
) -> Result<(), Failure> {
    let MotionArguments { tolerance, keep, ignore_start_overlaps, .. } = *arguments;
    if targets.save_proof.is_some() && ignore_start_overlaps {
        let why = "--save-proof has no proof of what --ignore-start-overlaps leaves out";
        return Err(Failure::new(Code::Usage, why));
    }
    let loaded = load::parts(files, &arguments.part_options())?;
    load::report_notes(&arguments.places, loaded.iter().flat_map(|body| &body.notes));
    let (bodies, clears) = (loaded.each_ref(), arguments.clearance);
    let asked = PartsMotion { bodies, motions, tolerance, clears, ignore_start_overlaps, keep };
    let told = Line::of(asked.ask().map_err(|error| solid::refused(error, bodies, tolerance))?);
    let proof = || {
        let proof = ProofFile::with_solid_motion(&asked.cast()?);
        let (_, proof) = proof.map_err(|error| Failure::new(Code::Query, error.to_string()))?;
        Ok(Some(proof.to_json()))
    };
    write_answer(targets, &told, motions, proof, &|k, pose, origin| {
        bodies[k].surface(pose, origin)
    })?;
    match (told.record.outcome, told.record.time) {
        (Ending::Undecided, Some(TimeRecord { lower, .. })) => Err(stalled(lower).into()),
        _ => Ok(()),
    }
}

/// Writes the answer of either kind of bodies.
fn write_answer(
    targets: OutputTargets<'_>,
    told: &Line<MotionRecord>,
    motions: &[Motion; 2],
    proof: impl FnOnce() -> Result<Option<String>, Failure>,
    surface: &dyn Fn(usize, &Pose, DVec3) -> Surface,
) -> Result<(), Failure> {
    let (record, motions) = (&told.record, motions.each_ref());
    targets.write_answer(AnswerOutputs {
        record: told,
        words: || words(told, motions),
        proof,
        picture: || Ok(draw_motion(Moved { record, motions, surface })),
    })
}

/// The error of a search that took its maximum number of steps.
pub(crate) fn stalled(free_until: f64) -> QueryError {
    QueryError::NotConverged { reason: Stalled::Motion { free_until } }
}

/// The answer of two of the meshes.
struct Found {
    told: Line<MotionRecord>,
    /// Which ones.
    pair: [usize; 2],
    /// Why the answer proves less than was asked.
    undecided: Option<Failure>,
}

/// What comes first of all pairs: an overlap when the motion begins, else the least time, else nothing; and the proofs of
/// all, where they are to be kept.
fn first_of_all(
    arguments: &MotionArguments,
    files: [&[PathBuf]; 2],
    parts: [&[Part]; 2],
    motions: &[Motion; 2],
) -> Result<(Found, Vec<ProofFile>), Failure> {
    let (mut first, mut proofs): (Option<Found>, _) = (None, Vec::new());
    // When two are first proven to meet.
    let mut meets: Option<(f64, [usize; 2])> = None;
    for (i, moving) in parts[0].iter().enumerate() {
        for (j, fixed) in parts[1].iter().enumerate() {
            let cast =
                MotionCast::new(moving.body.along(&motions[0]), fixed.body.along(&motions[1]))?;
            let cast = match arguments.tolerance {
                Some(depth) => cast.tolerating(depth)?,
                None => cast.keeping(arguments.keep)?,
            };
            let failed = |error| case::motion_failure(error, &cast);
            let mut undecided = None;
            let record = if arguments.clearance {
                let mut record =
                    MotionRecord::of_clearance(&cast.clearance().map_err(failed)?, &cast);
                for overlap in &mut record.start_overlaps {
                    overlap.moving = Some(files[0][i].display().to_string());
                    overlap.fixed = Some(files[1][j].display().to_string());
                }
                record
            } else {
                let outcome = cast.first_contact().map_err(failed)?;
                if let MotionOutcome::Undecided(open) = &outcome {
                    undecided = Some(failed(stalled(open.lower)));
                }
                if arguments.save_proof.is_some() {
                    proofs.push(ProofFile::of_motion(&cast, &outcome));
                }
                MotionRecord::of(&outcome, &cast)
            };
            let told = Line::of(record).with_parts([moving, fixed]);
            let found = Found { told, pair: [i, j], undecided };
            let upper = found.told.record.time.and_then(|time| time.upper);
            if let Some(upper) = upper.filter(|upper| meets.is_none_or(|least| *upper < least.0)) {
                meets = Some((upper, [i, j]));
            }
            if first.as_ref().is_none_or(|first| found.begins() < first.begins()) {
                first = Some(found);
            }
        }
    }
    // The command line has asked for at least one on each side.
    let mut first = first.ok_or_else(|| Failure::new(Code::Usage, "no meshes"))?;
    let is_open = matches!(first.told.record.outcome, Ending::Grazing | Ending::Undecided);
    if let (true, Some((upper, [i, j]))) = (is_open, meets) {
        // Two that come near each other hide none that meet later.
        let [moving, fixed] = [&files[0][i], &files[1][j]].map(|file| file.display());
        note(&format!("{moving} and {fixed} are proven to meet by {}", number(upper)));
        if let Some(time) = &mut first.told.record.time {
            time.upper = Some(upper);
        }
    }
    Ok((first, proofs))
}

impl Found {
    /// From when on the bodies may meet.
    fn begins(&self) -> f64 {
        match (self.told.record.outcome, self.told.record.time) {
            (Ending::Overlapping, _) => f64::NEG_INFINITY,
            (_, time) => time.map_or(f64::INFINITY, |time| time.lower),
        }
    }
}

/// The readable answer; `motions` are those of both bodies.
pub(crate) fn words(told: &Line<MotionRecord>, motions: [&Motion; 2]) -> String {
    let record = &told.record;
    let mut text = match record.outcome {
        Ending::Contact => "contact\n".into(),
        Ending::Blocked => "blocked: it can go so far\n".into(),
        Ending::Grazing => "grazing: the bodies come nearer than rounding can tell\n".into(),
        Ending::Overlapping => "overlapping: the bodies overlap when the motion begins\n".into(),
        Ending::Undecided => "undecided: the search took its maximum number of steps\n".into(),
        _ => format!("free: {} throughout the motion\n", never(record)),
    };
    for (name, file) in [("moving mesh", &record.moving), ("fixed mesh", &record.fixed)] {
        if let Some(file) = file {
            line(&mut text, name, file);
        }
    }
    if let Some(time) = record.time {
        match time {
            TimeRecord { lower, upper: None } if record.outcome == Ending::Undecided => {
                line(&mut text, "free until", &number(lower));
            }
            TimeRecord { lower, upper: Some(upper) }
                if matches!(record.outcome, Ending::Grazing | Ending::Undecided) =>
            {
                line(&mut text, "no earlier", &number(lower));
                line(&mut text, "no later", &format!("{}, when others meet", number(upper)));
            }
            _ => times(&mut text, time),
        }
        if let Some(TimeRecord { lower, upper }) = record.shrunk_time {
            let upper = upper.map_or("not proven".into(), number);
            line(
                &mut text,
                "shrunk",
                &format!("{} to {upper}, for the shrunk bodies", number(lower)),
            );
        }
        pose(&mut text, "pose", motions[0], time.lower);
        if *motions[1] != Motion::still(motions[1].start()) {
            pose(&mut text, "fixed pose", motions[1], time.lower);
        }
    }
    if let Some(point) = record.point {
        line(&mut text, "point", &known_vector(point.into(), 1e-12));
    }
    if let Some(normal) = record.normal {
        line(&mut text, "normal", &unit_vector(DVec3::from_array(normal)));
    }
    features(&mut text, record.features.as_ref(), [None; 2]);
    if let Some(planes) = record.planes {
        let [planes, looks] =
            [counted(planes, "plane", "planes"), counted(record.looks as usize, "look", "looks")];
        line(&mut text, "proof", &format!("{planes}, found in {looks}"));
    }
    if let Some(tolerance) = record.tolerance {
        line(&mut text, "tolerance", &number(tolerance));
    }
    let is_overlap = record.outcome == Ending::Overlapping;
    overlaps(&mut text, &record.start_overlaps, if is_overlap { "overlap" } else { "ignored" });
    kept(&mut text, record.keep);
    hulls(&mut text, told.hull, record.outcome, false);
    text
}

fn times(text: &mut String, TimeRecord { lower, upper }: TimeRecord) {
    if let Some(upper) = upper {
        let value = lower + 0.5 * (upper - lower);
        // Of bounds that are far apart the middle says nothing.
        if upper - lower < 1e-3 {
            line(text, "time", &format!("{} of the motion", known(value, upper - lower)));
        }
        line(text, "bounds", &format!("{} to {}", number(lower), number(upper)));
    } else {
        line(text, "no earlier", &number(lower));
    }
}

/// Where a body is at a time.
fn pose(text: &mut String, name: &str, motion: &Motion, time: f64) {
    let Ok(pose) = motion.at(time) else { return };
    let q = pose.rotation();
    let rotation = [q.x, q.y, q.z, q.w].map(|x| known(x, 1e-14)).join(",");
    line(text, name, &format!("{},{rotation}", known_vector(pose.translation(), 1e-14)));
}
