//! `colltrans motion`: the first contact of meshes that move along given motions.
//!
//! If all meshes are convex and no option requires parts, they become convex bodies, otherwise parts.

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
use crate::numbers::{
    at_least, at_most, count_text, estimate, interval, length_up, point, smaller_extent,
    unit_quaternion, unit_vector,
};
use crate::picture::{MotionPicture, Surface, draw_motion};
use crate::record::Line;
use crate::report::{
    never_statement, push_features, push_hulls, push_line, push_min_gap, push_start_overlaps,
};
use crate::solid::{self, PartsMotion, placed_surface};

pub(crate) fn run(arguments: &MotionArguments) -> Result<(), Failure> {
    let inputs = arguments.input_pair()?;
    let MotionArguments { json, save_proof, picture, .. } = arguments;
    let paths = load::input_paths(inputs.files);
    let targets = OutputTargets::new(*json, save_proof.as_ref(), picture.as_ref(), &paths)?;
    let (motions, notes) = arguments.motions()?;
    for text in &notes {
        note(text);
    }
    match load::read_if_convex(&inputs, &arguments.body_options())? {
        Some(bodies) => answer_convex(arguments, targets, inputs.files, &bodies, &motions),
        None => answer_parts(arguments, targets, inputs.files, &motions),
    }
}

/// Answers the question for convex bodies, and writes the answer.
fn answer_convex(
    arguments: &MotionArguments,
    targets: OutputTargets<'_>,
    files: [&[PathBuf]; 2],
    bodies: &[Vec<Part>; 2],
    motions: &[Motion; 2],
) -> Result<(), Failure> {
    if arguments.tolerance.is_some() && arguments.min_gap > 0.0 {
        let why = "convex meshes accept either --min-gap or --tolerance; drop one of them";
        return Err(Failure::new(Code::Usage, why));
    }
    load::print_notes(&arguments.places, bodies.iter().flatten().flat_map(|part| &part.notes));
    let (found, proofs) = first_of_pairs(arguments, files, [&bodies[0], &bodies[1]], motions)?;
    let PairAnswer { mut line, pair, undecided } = found;
    let name =
        |k: usize| Some(files[k][pair[k]].display().to_string()).filter(|_| files[k].len() > 1);
    (line.record.moving, line.record.fixed) = (name(0), name(1));
    let proof = || {
        let proof = ProofFile::of_motions(proofs);
        Ok(Some(proof.map_err(|error| Failure::new(Code::Query, error.to_string()))?.to_json()))
    };
    let surface =
        |k: usize, pose: &Pose, from| placed_surface(&bodies[k][pair[k]].body, pose, from);
    let extent = smaller_extent([0, 1].map(|k| bodies[k][pair[k]].bounds()));
    write_answer(targets, &line, Placed { motions, extent, surface: &surface }, proof)?;
    undecided.map_or(Ok(()), Err)
}

/// Answers the question for parts that need not be convex, and writes the answer.
fn answer_parts(
    arguments: &MotionArguments,
    targets: OutputTargets<'_>,
    files: [&[PathBuf]; 2],
    motions: &[Motion; 2],
) -> Result<(), Failure> {
    let MotionArguments { tolerance, min_gap, ignore_start_overlaps, .. } = *arguments;
    if targets.save_proof.is_some() && ignore_start_overlaps {
        let why =
            "--save-proof cannot prove an answer with --ignore-start-overlaps; drop one of them";
        return Err(Failure::new(Code::Usage, why));
    }
    let loaded = load::read_parts(files, &arguments.part_options())?;
    load::print_notes(&arguments.places, loaded.iter().flat_map(|body| &body.notes));
    let (bodies, clears) = (loaded.each_ref(), arguments.clearance);
    let query = PartsMotion { bodies, motions, tolerance, clears, ignore_start_overlaps, min_gap };
    let answered = query.answer();
    let line = Line::from_record(
        answered.map_err(|error| solid::query_failure(error, bodies, tolerance))?,
    );
    let proof = || {
        let proof = ProofFile::with_solid_motion(&query.cast()?);
        let (_, proof) = proof.map_err(|error| Failure::new(Code::Query, error.to_string()))?;
        Ok(Some(proof.to_json()))
    };
    let surface = |k: usize, pose: &Pose, origin| bodies[k].surface(pose, origin);
    let placed = Placed { motions, extent: solid::extent(bodies), surface: &surface };
    write_answer(targets, &line, placed, proof)?;
    match (line.record.outcome, line.record.time) {
        (Ending::Undecided, Some(TimeRecord { lower, .. })) => Err(step_limit_error(lower).into()),
        _ => Ok(()),
    }
}

/// The moving and the fixed body of an answer.
#[derive(Clone, Copy)]
struct Placed<'a> {
    motions: &'a [Motion; 2],
    /// Extent of the smaller body.
    extent: f64,
    surface: &'a dyn Fn(usize, &Pose, DVec3) -> Surface,
}

/// Writes the answer for both kinds of bodies.
fn write_answer(
    targets: OutputTargets<'_>,
    line: &Line<MotionRecord>,
    placed: Placed<'_>,
    proof: impl FnOnce() -> Result<Option<String>, Failure>,
) -> Result<(), Failure> {
    let Placed { motions, extent, surface } = placed;
    let (record, motions) = (&line.record, motions.each_ref());
    targets.write_answer(AnswerOutputs {
        record: line,
        text: || answer_text(line, motions, extent),
        proof,
        picture: || Ok(draw_motion(MotionPicture { record, motions, surface })),
    })
}

/// Returns the error of a search that took its maximum number of steps and proved freedom until a time.
pub(crate) fn step_limit_error(free_until: f64) -> QueryError {
    QueryError::NotConverged { reason: Stalled::Motion { free_until } }
}

/// The answer for one pair of meshes.
struct PairAnswer {
    line: Line<MotionRecord>,
    /// The numbers of the moving and of the fixed mesh.
    pair: [usize; 2],
    /// The failure of a search that took its maximum number of steps.
    undecided: Option<Failure>,
}

/// Returns the first event of all pairs, and the proofs of all pairs if `--save-proof` is given. The first event is an
/// overlap at the start, otherwise the one with the least lower bound of its time. If it is grazing or undecided, and
/// other pairs are proven to meet, it gets the least upper bound of their times, with a note.
///
/// # Errors
/// A query fails.
fn first_of_pairs(
    arguments: &MotionArguments,
    files: [&[PathBuf]; 2],
    parts: [&[Part]; 2],
    motions: &[Motion; 2],
) -> Result<(PairAnswer, Vec<ProofFile>), Failure> {
    let (mut first, mut proofs): (Option<PairAnswer>, _) = (None, Vec::new());
    // The least proven upper bound of a contact time, and its pair.
    let mut least_upper: Option<(f64, [usize; 2])> = None;
    for (i, moving) in parts[0].iter().enumerate() {
        for (j, fixed) in parts[1].iter().enumerate() {
            let cast = MotionCast::new(
                moving.body.with_motion(&motions[0]),
                fixed.body.with_motion(&motions[1]),
            )?;
            let cast = match arguments.tolerance {
                Some(depth) => cast.with_tolerance(depth)?,
                None => cast.with_min_gap(arguments.min_gap)?,
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
                    undecided = Some(failed(step_limit_error(open.lower)));
                }
                if arguments.save_proof.is_some() {
                    proofs.push(ProofFile::of_motion(&cast, &outcome));
                }
                MotionRecord::from_outcome(&outcome, &cast)
            };
            let line = Line::from_record(record).with_parts([moving, fixed]);
            let found = PairAnswer { line, pair: [i, j], undecided };
            let upper = found.line.record.time.and_then(|time| time.upper);
            if let Some(upper) =
                upper.filter(|upper| least_upper.is_none_or(|least| *upper < least.0))
            {
                least_upper = Some((upper, [i, j]));
            }
            if first.as_ref().is_none_or(|first| found.start_bound() < first.start_bound()) {
                first = Some(found);
            }
        }
    }
    // The command line has at least one mesh on each side.
    let mut first =
        first.ok_or_else(|| Failure::new(Code::Usage, "give a moving and a fixed mesh"))?;
    let is_open = matches!(first.line.record.outcome, Ending::Grazing | Ending::Undecided);
    if let (true, Some((upper, [i, j]))) = (is_open, least_upper) {
        // A pair without a proven contact may come first although another pair is proven to meet later.
        let [moving, fixed] = [&files[0][i], &files[1][j]].map(|file| file.display());
        note(&format!("{moving} and {fixed} are proven to meet by time {}", at_most(upper)));
        if let Some(time) = &mut first.line.record.time {
            time.upper = Some(upper);
        }
    }
    Ok((first, proofs))
}

impl PairAnswer {
    /// Returns a lower bound of the time from which the bodies may meet; infinite if they never do.
    fn start_bound(&self) -> f64 {
        match (self.line.record.outcome, self.line.record.time) {
            (Ending::Overlapping, _) => f64::NEG_INFINITY,
            (_, time) => time.map_or(f64::INFINITY, |time| time.lower),
        }
    }
}

/// Returns the answer as text. `motions` are those of the moving and of the fixed body, `extent` is that of the smaller
/// one.
pub(crate) fn answer_text(line: &Line<MotionRecord>, motions: [&Motion; 2], extent: f64) -> String {
    let record = &line.record;
    let mut text = match record.outcome {
        Ending::Contact => "contact\n".into(),
        Ending::Blocked => "blocked: the body can move until the time below\n".into(),
        Ending::Grazing => "grazing: the bodies come nearer than rounding resolves\n".into(),
        Ending::Overlapping => "overlapping: the bodies overlap when the motion begins\n".into(),
        Ending::Undecided => "undecided: the search took its maximum number of steps\n".into(),
        _ => format!("free: {} throughout the motion\n", never_statement(record)),
    };
    for (name, file) in [("moving mesh", &record.moving), ("fixed mesh", &record.fixed)] {
        if let Some(file) = file {
            push_line(&mut text, name, file);
        }
    }
    if let Some(time) = record.time {
        match time {
            TimeRecord { lower, upper: None } if record.outcome == Ending::Undecided => {
                push_line(&mut text, "free until", &at_least(lower));
            }
            TimeRecord { lower, upper: Some(upper) }
                if matches!(record.outcome, Ending::Grazing | Ending::Undecided) =>
            {
                push_line(&mut text, "no earlier", &at_least(lower));
                let end = format!("{}, when another pair meets", at_most(upper));
                push_line(&mut text, "no later", &end);
            }
            _ => push_times(&mut text, time),
        }
        if let Some(TimeRecord { lower, upper }) = record.shrunk_time {
            let bounds = interval([lower, upper.unwrap_or(f64::INFINITY)]);
            push_line(&mut text, "offset", &format!("{bounds}, for the offset bodies"));
        }
        push_pose(&mut text, "pose", motions[0], time.lower, extent);
        if *motions[1] != Motion::at_rest(motions[1].start_pose()) {
            push_pose(&mut text, "fixed pose", motions[1], time.lower, extent);
        }
    }
    if let Some(place) = record.point {
        push_line(&mut text, "point", &point(place.into(), 0.0, extent));
    }
    if let Some(normal) = record.normal {
        push_line(&mut text, "normal", &unit_vector(DVec3::from_array(normal)));
    }
    push_features(&mut text, record.features.as_ref(), [None; 2]);
    if let Some(planes) = record.planes {
        let planes = count_text(planes, "plane", "planes");
        let samples = count_text(record.looks as usize, "distance sample", "distance samples");
        push_line(&mut text, "proof", &format!("{planes}, found with {samples}"));
    }
    if let Some(tolerance) = record.tolerance {
        push_line(&mut text, "tolerance", &length_up(tolerance));
    }
    let is_overlap = record.outcome == Ending::Overlapping;
    push_start_overlaps(
        &mut text,
        &record.start_overlaps,
        if is_overlap { "overlap" } else { "ignored" },
    );
    push_min_gap(&mut text, record.min_gap);
    push_hulls(&mut text, line.hull, record.outcome, false);
    text
}

/// Appends the time and its bounds.
fn push_times(text: &mut String, TimeRecord { lower, upper }: TimeRecord) {
    if let Some(upper) = upper {
        let value = lower + 0.5 * (upper - lower);
        // The middle of distant bounds is not an estimate.
        if upper - lower < 1e-3 {
            push_line(text, "time", &format!("{} of the motion", estimate(value, upper - lower)));
        }
        push_line(text, "bounds", &interval([lower, upper]));
    } else {
        push_line(text, "no earlier", &at_least(lower));
    }
}

/// Appends the pose of a body at a time. `extent` is that of the smaller body.
fn push_pose(text: &mut String, name: &str, motion: &Motion, time: f64, extent: f64) {
    let Ok(pose) = motion.pose_at(time) else { return };
    let q = pose.rotation();
    let place = point(pose.translation(), 0.0, extent);
    push_line(text, name, &format!("{place},{}", unit_quaternion([q.x, q.y, q.z, q.w])));
}
