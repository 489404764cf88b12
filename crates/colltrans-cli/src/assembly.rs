//! `assembly`: which parts come out.
//!
//! Data flow: source -> parts -> overlaps, contacts, directions, matrix, plan, maps (all of them
//! `colltrans_assembly`'s), all directions ([`free`]) -> text, JSON or files ([`output`]).

mod asked;
mod free;
mod output;
mod step;

use std::path::Path;

use colltrans::glam::DVec3;
use colltrans::solid::StartOverlap;
use colltrans_assembly::candidates::{Candidates, Choice};
use colltrans_assembly::map::{MapOptions, RemovalMap};
use colltrans_assembly::plan::PlanOptions;
use colltrans_assembly::rooms::{PartRoom, rooms};
use colltrans_assembly::sphere::{Sphere, unit};
use colltrans_assembly::suggest;
use colltrans_assembly::{Assembly, AssemblyError, Bodies, Fit, Ignored, Question, Stage, Watch};
use colltrans_assembly_io::ReadError;
use colltrans_assembly_io::read::{self, Geometry, ReadOptions};
use colltrans_mesh::body::Refused;
use indicatif::{ProgressBar, ProgressStyle};

use crate::args::{AssemblyArguments, direction};
use crate::failure::{Code, Failure};

pub(crate) fn run(arguments: &AssemblyArguments) -> Result<(), Failure> {
    let Some(threads) = arguments.threads else { return inside(arguments) };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.get()).build();
    let pool = pool.map_err(|e| Failure::new(Code::Usage, format!("--threads: {e}")))?;
    pool.install(|| inside(arguments))
}

fn inside(arguments: &AssemblyArguments) -> Result<(), Failure> {
    let given = given_directions(arguments)?;
    if arguments.only && given.is_empty() && arguments.direction.is_empty() {
        let why = "--only asks the directions that are given, and there are none: give --direction, --directions or --samples";
        return Err(Failure::new(Code::Usage, why));
    }
    let assembly = assembly(arguments)?;
    let groups = groups(&arguments.map, &assembly)?;
    let leaving = self::groups(&arguments.free, &assembly)?;
    let wanted = assembly.group(&arguments.asked.remove)?;
    let times = asked::times(arguments.times.as_deref())?;
    output::refuse_inputs(arguments, &assembly)?;
    let fit = match (arguments.tolerance, arguments.keep_apart) {
        (Some(tolerance), _) => Fit::Tolerance(tolerance),
        (None, Some(length)) => Fit::Apart(length),
        (None, None) => Fit::default_for(&assembly),
    };
    let bar = ProgressBar::new(0);
    if let Ok(style) = ProgressStyle::with_template("{msg:>9} {wide_bar} {pos}/{len}") {
        bar.set_style(style);
    }
    let progress = |stage: Stage, done: usize, total: usize| {
        if done.is_multiple_of(16) || done == total {
            bar.set_message(stage.name());
            bar.set_length(total as u64);
            bar.set_position(done as u64);
        }
    };
    let watch = Watch::default().with_progress(&progress);
    let question = question(arguments, &given, wanted);
    let once = Bodies::new(&assembly, fit)?;
    let mut found = question.ask(&once, watch)?;
    let suggested;
    let again;
    if arguments.roles.auto && !found.suggestions.is_empty() && !found.plan.stuck.is_empty() {
        suggested = suggest::applied(assembly.clone(), &found.suggestions)?;
        again = Bodies::new(&suggested, fit)?;
        found = question.ask(&again, watch)?;
    }
    let bodies = found.bodies;
    found.more = more_rooms(bodies, &given, overlap(arguments), watch)?;
    found.maps = maps(bodies, &groups, &found.candidates, overlap(arguments), watch)?;
    if arguments.output.is_some() {
        // The table of all pairs is one of the files.
        found.matrix.complete(watch)?;
    }
    found.times = times;
    let with_proofs = arguments.output.is_some();
    let free = free::all(bodies, leaving, arguments.work.options(), with_proofs)?;
    bar.finish_and_clear();
    output::write(&found, &free, arguments)
}

/// What is asked of the parts, with whatever fit.
fn question(arguments: &AssemblyArguments, given: &[DVec3], wanted: Vec<usize>) -> Question {
    let choice =
        Choice::default().with_given(arguments.direction.clone()).with_search(!arguments.only);
    let samples = if arguments.only { 0 } else { PlanOptions::default().samples };
    let options = PlanOptions::default()
        .with_start(overlap(arguments))
        .with_samples(samples)
        .with_legs(arguments.legs)
        .with_proofs(!arguments.no_proofs && !arguments.only)
        .with_looks(arguments.work.looks());
    let question = Question::default()
        .with_choice(choice)
        .with_finer(given.to_vec())
        .with_options(options)
        .with_wanted(wanted);
    match arguments.gravity {
        Some(gravity) => question.with_gravity(gravity),
        None => question,
    }
}

fn overlap(arguments: &AssemblyArguments) -> StartOverlap {
    if arguments.ignore_overlaps { StartOverlap::Ignore } else { StartOverlap::Refuse }
}

fn assembly(arguments: &AssemblyArguments) -> Result<Assembly, Failure> {
    let usage = |text: String| Failure::new(Code::Usage, text);
    let geometry = if arguments.visual { Geometry::Visual } else { Geometry::Collision };
    let mut options = ReadOptions::default()
        .with_packages(arguments.package.clone())
        .with_skip_missing(arguments.skip_missing)
        .with_as_is(arguments.as_is)
        .with_split(arguments.split)
        .with_allow_outside(arguments.allow_outside)
        .with_geometry(geometry);
    for joint in &arguments.joint {
        let parts = joint.split_once('=').and_then(|(n, v)| Some((n, v.trim().parse().ok()?)));
        let (name, value): (&str, f64) = parts
            .filter(|p: &(&str, f64)| p.1.is_finite())
            .ok_or_else(|| usage(format!("--joint {joint}: not NAME=VALUE")))?;
        options.joints.insert(name.trim().to_owned(), value);
    }
    for scale in &arguments.scale {
        let (name, factor) = asked::halves("--scale", scale, "PART=FACTOR")?;
        let factor: Option<f64> = factor.parse().ok().filter(|x: &f64| x.is_finite() && *x > 0.0);
        let factor = factor.ok_or_else(|| usage(format!("--scale {scale}: not PART=FACTOR")))?;
        options.scales.insert(name.to_owned(), factor);
    }
    let refused = |e: ReadError| Failure::new(Code::Input, format!("{e}{}", advice(&e)));
    let source = &arguments.source;
    let assembly = if step::is_step(source) {
        let glb = step::converted(source, arguments.chord)?;
        let read = read::glb_with(source, &glb, &options).map_err(refused)?;
        read.with_files(vec![source.clone()])
    } else {
        read::read(source, &options).map_err(refused)?
    };
    let ignore = asked::pairs("--ignore", &arguments.ignore)?;
    let always = asked::pairs("--ignore-always", &arguments.ignore_always)?;
    let assembly = assembly.with_ignored(&ignore, Ignored::Overlap)?;
    let assembly = assembly.with_ignored(&always, Ignored::Always)?;
    let assembly = asked::with_roles(assembly, &arguments.roles)?;
    asked::constrained(assembly, &arguments.asked)
}

/// Returns which flag of `assembly` and `path` helps.
pub(crate) fn advice(error: &ReadError) -> &'static str {
    match error {
        ReadError::Outside { .. } => " (--allow-outside reads it)",
        ReadError::Missing { .. } => {
            " (--package DIR says where packages are, --skip-missing leaves out what is not there)"
        }
        ReadError::Assembly {
            source: AssemblyError::Part { source: Refused::Mended(_), .. },
            ..
        } => " (without --as-is it is mended)",
        _ => "",
    }
}

/// The directions of the file and the samples, of length 1.
fn given_directions(arguments: &AssemblyArguments) -> Result<Vec<DVec3>, Failure> {
    let mut all = Vec::new();
    if let Some(path) = &arguments.directions {
        let text = if path == Path::new("-") {
            std::io::read_to_string(std::io::stdin())
        } else {
            colltrans_mesh::file::text(path)
        };
        let text = text.map_err(|e| {
            Failure::new(Code::Input, format!("{}: cannot be read: {e}", path.display()))
        })?;
        for (k, line) in text.lines().enumerate() {
            let line = line.split('#').next().unwrap_or_default().trim();
            if line.is_empty() {
                continue;
            }
            let refused = |reason: String| {
                Failure::new(Code::Input, format!("{}: line {}: {reason}", path.display(), k + 1))
            };
            let given = direction(line).map_err(refused)?;
            all.push(unit(given).map_err(|e| refused(e.to_string()))?);
        }
    }
    if let Some(samples) = arguments.samples.filter(|n| *n > 0) {
        all.extend(Sphere::with_directions(samples).directions);
    }
    Ok(all)
}

/// The groups that are asked about, with their names.
fn groups(asked: &[String], assembly: &Assembly) -> Result<Vec<(String, Vec<usize>)>, Failure> {
    let group = |names: &String| {
        let parts: Vec<&str> = names.split(',').collect();
        Ok((names.clone(), assembly.group(&parts)?))
    };
    asked.iter().map(group).collect()
}

fn more_rooms(
    bodies: &Bodies,
    directions: &[DVec3],
    start: StartOverlap,
    watch: Watch,
) -> Result<Vec<(DVec3, Vec<PartRoom>)>, Failure> {
    if directions.is_empty() {
        return Ok(Vec::new());
    }
    let by_part = rooms(bodies, directions, start, watch)?;
    let column = |k: usize| by_part.iter().map(|row| row[k]).collect();
    Ok(directions.iter().enumerate().map(|(k, d)| (*d, column(k))).collect())
}

fn maps(
    bodies: &Bodies,
    groups: &[(String, Vec<usize>)],
    found: &Candidates,
    start: StartOverlap,
    watch: Watch,
) -> Result<Vec<(String, RemovalMap)>, Failure> {
    let options = MapOptions::default().with_start(start);
    let mut maps = Vec::new();
    for (name, group) in groups {
        let mut mask = vec![false; bodies.len()];
        for &k in group {
            mask[k] = true;
        }
        let own = found.finer.iter().filter(|f| f.concerns(&mask)).map(|f| f.direction);
        let directions: Vec<DVec3> = found.directions().into_iter().chain(own).collect();
        maps.push((name.clone(), RemovalMap::new(bodies, group, &directions, options, watch)?));
    }
    Ok(maps)
}

impl From<AssemblyError> for Failure {
    fn from(error: AssemblyError) -> Self {
        let code = match error {
            AssemblyError::Length { .. }
            | AssemblyError::Direction { .. }
            | AssemblyError::UnknownPart { .. }
            | AssemblyError::SamePart { .. }
            | AssemblyError::Order { .. }
            | AssemblyError::Subassemblies { .. }
            | AssemblyError::TooFew { .. }
            | AssemblyError::NoTolerance { .. }
            | AssemblyError::NoFit { .. }
            | AssemblyError::Fixed { .. }
            | AssemblyError::Removal { .. }
            | AssemblyError::Angle { .. } => Code::Usage,
            AssemblyError::Replay { .. } | AssemblyError::Cancelled => Code::Query,
            _ => Code::Input,
        };
        Self::new(code, error.to_string())
    }
}
