//! `colltrans motion`: when meshes that turn first meet others. Convex ones are asked as convex bodies, all
//! others as parts.

use std::path::PathBuf;

use colltrans::glam::DVec3;
use colltrans::motion::{
    Motion, MotionCast, MotionOutcome, MotionProofFile, MotionProofFiles, SolidMotionProofFile,
};
use colltrans::record::{Ending, FeaturesRecord, Record, TimeRecord};
use colltrans::{Pose, QueryError, Stalled};
use colltrans_mesh::body::LoadError;

use crate::args::{MotionArguments, Sides, Taken};
use crate::body::{self, Part, is_part};
use crate::case;
use crate::clearance::{self, overlaps};
use crate::failure::{Code, Failure, note, print};
use crate::inputs::{refuse_picture, refuse_proof};
use crate::numbers::{counted, known, known_vector, number, unit_vector};
use crate::outputs;
use crate::picture::{Moved, draw_motion};
use crate::record::Line;
use crate::report::{feature, hulls, kept, line, never};
use crate::solid::{self, PartsMotion, surface_of};

pub(crate) fn run(arguments: &MotionArguments) -> Result<(), Failure> {
    let Sides { files, taken } = arguments.sides()?;
    let inputs: Vec<&_> = files.into_iter().flatten().map(AsRef::as_ref).collect();
    let picture = arguments.picture.as_deref();
    refuse_picture(picture, &inputs)?;
    refuse_proof(arguments.save_proof.as_deref(), picture, &inputs)?;
    let (motions, rounded) = arguments.motions()?;
    for text in &rounded {
        note(text);
    }
    if taken != Taken::Parts {
        let options = arguments.body_options();
        let load = |k: usize| -> Result<Vec<Part>, LoadError> {
            files[k].iter().map(|file| body::load(file, &options[k])).collect()
        };
        match load(0).and_then(|moving| Ok([moving, load(1)?])) {
            Ok(parts) => return convex(arguments, files, &parts, &motions),
            Err(error) if taken == Taken::AsTheyAre && is_part(&error) => {}
            Err(error) => return Err(Failure::new(Code::Input, body::refusal(&error))),
        }
    }
    parts(arguments, files, &motions)
}

/// Asked of convex meshes.
fn convex(
    arguments: &MotionArguments,
    files: [&[PathBuf]; 2],
    parts: &[Vec<Part>; 2],
    motions: &[Motion; 2],
) -> Result<(), Failure> {
    if arguments.tolerance.is_some() && arguments.keep > 0.0 {
        let why = "convex meshes have either --keep or --tolerance";
        return Err(Failure::new(Code::Usage, why));
    }
    tell(arguments, parts.iter().flatten().flat_map(|part| &part.notes));
    let (found, proofs) = first_of_all(arguments, files, [&parts[0], &parts[1]], motions)?;
    let Found { mut told, pair, undecided } = found;
    let name =
        |k: usize| Some(files[k][pair[k]].display().to_string()).filter(|_| files[k].len() > 1);
    (told.record.moving, told.record.fixed) = (name(0), name(1));
    print(&if arguments.json { told.json() } else { words(&told, motions.each_ref()) })?;
    if let Some(path) = &arguments.save_proof {
        let text = match &proofs[..] {
            [proof] => proof.to_json(),
            _ => MotionProofFiles::of(proofs).to_json(),
        };
        outputs::write_proof(path, &text)?;
    }
    let surface = |k: usize, pose: &Pose, origin| surface_of(&parts[k][pair[k]].body, pose, origin);
    let (record, motions) = (&told.record, motions.each_ref());
    draw(arguments, Moved { record, motions, surface: &surface })?;
    undecided.map_or(Ok(()), Err)
}

/// Asked of parts that need not be convex.
fn parts(
    arguments: &MotionArguments,
    files: [&[PathBuf]; 2],
    motions: &[Motion; 2],
) -> Result<(), Failure> {
    if arguments.save_proof.is_some() && arguments.ignore_start_overlaps {
        let why = "--save-proof has no proof of what --ignore-start-overlaps leaves out";
        return Err(Failure::new(Code::Usage, why));
    }
    let bodies = clearance::load(files, &arguments.part_options())?;
    tell(arguments, bodies.iter().flat_map(|body| &body.notes));
    let MotionArguments { tolerance, keep, ignore_start_overlaps, .. } = *arguments;
    let bodies_asked = [&bodies[0], &bodies[1]];
    let asked = PartsMotion {
        bodies: bodies_asked,
        motions,
        tolerance,
        clears: arguments.clearance,
        ignore_start_overlaps,
        keep,
    };
    let told = asked.ask().map_err(|error| solid::refused(error, bodies_asked, tolerance))?;
    let told = Line::from(told);
    print(&if arguments.json { told.json() } else { words(&told, motions.each_ref()) })?;
    if let Some(path) = &arguments.save_proof {
        let proof = SolidMotionProofFile::answer(&asked.cast()?);
        let (_, proof) = proof.map_err(|error| Failure::new(Code::Query, error.to_string()))?;
        outputs::write_proof(path, &proof.to_json())?;
    }
    let surface = |k: usize, pose: &Pose, origin| bodies[k].surface(pose, origin);
    let (record, motions) = (&told.record, motions.each_ref());
    draw(arguments, Moved { record, motions, surface: &surface })?;
    match (record.outcome, record.time) {
        (Ending::Undecided, Some(TimeRecord { lower, .. })) => Err(stalled(lower).into()),
        _ => Ok(()),
    }
}

/// The error of a search that took its maximum number of steps.
pub(crate) fn stalled(free_until: f64) -> QueryError {
    QueryError::NotConverged { reason: Stalled::Motion { free_until } }
}

fn draw(arguments: &MotionArguments, moved: Moved<'_>) -> Result<(), Failure> {
    match &arguments.picture {
        Some(path) => outputs::write(path, draw_motion(moved).as_bytes()),
        None => Ok(()),
    }
}

/// What was changed about the poses and mended in the files.
fn tell<'a>(arguments: &MotionArguments, mended: impl Iterator<Item = &'a String>) {
    arguments.places.notes().iter().flatten().for_each(|text| note(text));
    mended.for_each(|text| note(text));
}

/// The answer of two of the meshes.
struct Found {
    told: Line,
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
) -> Result<(Found, Vec<MotionProofFile>), Failure> {
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
                    Record::of_motion_clearance(&cast.clearance().map_err(failed)?, &cast);
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
                    proofs.push(MotionProofFile::of(&cast, &outcome));
                }
                Record::of_motion(&outcome, &cast)
            };
            let told = Line::of_parts(record, [moving, fixed]);
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
pub(crate) fn words(told: &Line, motions: [&Motion; 2]) -> String {
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
    if let Some(FeaturesRecord { moving, fixed }) = &record.features {
        line(&mut text, "moving", &feature(moving));
        line(&mut text, "fixed", &feature(fixed));
    }
    if let (Some(planes), Some(looks)) = (record.planes, record.looks) {
        let [planes, looks] =
            [counted(planes, "plane", "planes"), counted(looks as usize, "look", "looks")];
        line(&mut text, "proof", &format!("{planes}, found in {looks}"));
    }
    if let Some(tolerance) = record.tolerance {
        line(&mut text, "tolerance", &number(tolerance));
    }
    let is_overlap = record.outcome == Ending::Overlapping;
    overlaps(&mut text, record, if is_overlap { "overlap" } else { "ignored" });
    kept(&mut text, record.keep);
    hulls(&mut text, told);
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
