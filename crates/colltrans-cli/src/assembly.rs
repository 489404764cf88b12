//! `colltrans assembly`: plans which parts of an assembly come out.
//!
//! Data flow:
//! - The source file becomes parts ([`step`] converts STEP files), with the options of [`constraints`].
//! - `colltrans_assembly` computes overlaps, contacts, directions, the blocking matrix, the plan and maps.
//! - [`free`] computes all removal directions of the requested groups.
//! - [`output`] writes text, JSON or files.
//!
//! [`audit`](crate::audit) reads its sources by [`read_assembly`].

mod constraints;
mod free;
pub(crate) mod output;
mod step;

use std::num::NonZeroUsize;
use std::path::Path;

use colltrans::glam::DVec3;
use colltrans::solid::StartOverlap;
use colltrans_assembly::candidates::{CandidateOptions, Candidates};
use colltrans_assembly::map::{MapOptions, RemovalMap};
use colltrans_assembly::plan::PlanOptions;
use colltrans_assembly::sphere::{Sphere, normalized_direction};
use colltrans_assembly::suggest;
use colltrans_assembly::travel::{PartTravel, travels_of_parts};
use colltrans_assembly::{
    AnalysisRequest, Assembly, AssemblyError, Bodies, Fit, Ignored, Stage, Watch,
};
use colltrans_assembly_io::ReadError;
use colltrans_assembly_io::read::{self, Geometry, ReadOptions};
use colltrans_mesh::body::BodyError;
use indicatif::{ProgressBar, ProgressStyle};

use crate::args::{AssemblyArguments, InputArguments, RoleArguments, direction};
use crate::failure::{Code, Failure, note};
use crate::inputs::has_extension;

/// Requested distance of the facets of a STEP file from its surfaces, in millimetres.
const DEFAULT_CHORD: f64 = 0.05;

pub(crate) fn run(arguments: &AssemblyArguments) -> Result<(), Failure> {
    in_thread_pool(arguments.threads, || plan_in_pool(arguments))
}

/// Runs work on a number of threads.
///
/// # Errors
/// The threads cannot be started, or the work fails.
pub(crate) fn in_thread_pool(
    threads: Option<NonZeroUsize>,
    work: impl FnOnce() -> Result<(), Failure> + Send,
) -> Result<(), Failure> {
    let Some(threads) = threads else { return work() };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.get()).build();
    let pool = pool.map_err(|e| Failure::new(Code::Usage, format!("--threads: {e}")))?;
    pool.install(work)
}

/// Returns a bar for [`show_stages`].
pub(crate) fn stage_bar() -> ProgressBar {
    let bar = ProgressBar::new(0);
    if let Ok(style) = ProgressStyle::with_template("{msg:>9} {wide_bar} {pos}/{len}") {
        bar.set_style(style);
    }
    bar
}

/// Returns the observer that shows the progress of each stage by a bar.
pub(crate) fn show_stages(bar: &ProgressBar) -> impl Fn(Stage, usize, usize) + Sync {
    |stage: Stage, done: usize, total: usize| {
        if done.is_multiple_of(16) || done == total {
            bar.set_message(stage.name());
            bar.set_length(total as u64);
            bar.set_position(done as u64);
        }
    }
}

/// Plans the assembly in the current thread pool, and writes the answer.
fn plan_in_pool(arguments: &AssemblyArguments) -> Result<(), Failure> {
    let sampled = sampled_directions(arguments)?;
    if arguments.only && sampled.is_empty() && arguments.direction.is_empty() {
        let why = "--only needs directions; give --direction, --directions or --samples";
        return Err(Failure::new(Code::Usage, why));
    }
    let assembly = read_assembly(&arguments.source, &arguments.input, &arguments.roles)?;
    let assembly = constraints::with_constraints(assembly, &arguments.asked)?;
    let assembly = constraints::with_densities(assembly, &arguments.density)?;
    let mapped_groups = named_groups(&arguments.map, &assembly)?;
    let removed_groups = named_groups(&arguments.free, &assembly)?;
    let wanted = assembly.parts_named(&arguments.asked.remove)?;
    let times = constraints::handling_times(arguments.times.as_deref())?;
    output::check_output_paths(arguments, &assembly)?;
    let fit = match (arguments.tolerance, arguments.keep_apart) {
        (Some(tolerance), _) => Fit::Tolerance(tolerance),
        (None, Some(length)) => Fit::MinGap(length),
        (None, None) => Fit::default_for(&assembly),
    };
    let bar = stage_bar();
    let progress = show_stages(&bar);
    let watch = Watch::default().with_progress(&progress);
    let question = plan_question(arguments, &sampled, wanted);
    let given_bodies = Bodies::new(&assembly, fit)?;
    let mut found = question.analyse(&given_bodies, watch)?;
    let suggested;
    let suggested_bodies;
    if arguments.auto && !found.suggestions.is_empty() && !found.plan.interlocked.is_empty() {
        suggested = suggest::apply_suggestions(assembly.clone(), &found.suggestions)?;
        suggested_bodies = Bodies::new(&suggested, fit)?;
        found = question.analyse(&suggested_bodies, watch)?;
    }
    let bodies = found.bodies;
    found.further_travels = free_travels(bodies, &sampled, start_overlap(arguments), watch)?;
    found.maps =
        removal_maps(bodies, &mapped_groups, &found.candidates, start_overlap(arguments), watch)?;
    if arguments.output.is_some() {
        // matrix.csv has all pairs.
        found.matrix.compute_all(watch)?;
    }
    found.times = times;
    let with_proofs = arguments.output.is_some();
    let removals =
        free::group_removals(bodies, removed_groups, arguments.work.options(), with_proofs)?;
    bar.finish_and_clear();
    output::write(&found, &removals, arguments)
}

/// Returns the request of the analysis: candidate directions, options of the plan and gravity. `sampled` are the
/// directions of the file and the samples, `wanted` the parts to remove.
fn plan_question(
    arguments: &AssemblyArguments,
    sampled: &[DVec3],
    wanted: Vec<usize>,
) -> AnalysisRequest {
    let choice = CandidateOptions::default()
        .with_given(arguments.direction.clone())
        .with_search(!arguments.only);
    let samples = if arguments.only { 0 } else { PlanOptions::default().samples };
    let options = PlanOptions::default()
        .with_start(start_overlap(arguments))
        .with_samples(samples)
        .with_effort(arguments.effort)
        .with_proofs(!arguments.no_proofs && !arguments.only);
    let question = AnalysisRequest::default()
        .with_choice(choice)
        .with_finer(sampled.to_vec())
        .with_options(options)
        .with_selected(wanted);
    match arguments.gravity {
        Some(gravity) => question.with_gravity(gravity),
        None => question,
    }
}

/// Returns how parts that overlap at the start are treated.
fn start_overlap(arguments: &AssemblyArguments) -> StartOverlap {
    if arguments.ignore_overlaps { StartOverlap::Ignore } else { StartOverlap::Refuse }
}

/// Reads a source, and applies the roles of the command line.
///
/// # Errors
/// The source cannot be read, or an option has an unknown part or a wrong form.
pub(crate) fn read_assembly(
    source: &Path,
    arguments: &InputArguments,
    roles: &RoleArguments,
) -> Result<Assembly, Failure> {
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
            .ok_or_else(|| usage(format!("--joint {joint}: expected NAME=VALUE")))?;
        options.joints.insert(name.trim().to_owned(), value);
    }
    for scale in &arguments.scale {
        let (name, factor) = constraints::split_at_equals("--scale", scale, "PART=FACTOR")?;
        let factor: Option<f64> = factor.parse().ok().filter(|x: &f64| x.is_finite() && *x > 0.0);
        let factor = factor.ok_or_else(|| {
            usage(format!("--scale {scale}: expected PART=FACTOR with a positive factor"))
        })?;
        options.scales.insert(name.to_owned(), factor);
    }
    note_unused_options(source, arguments);
    let refused = |e: ReadError| Failure::new(Code::Input, format!("{e}{}", read_error_hint(&e)));
    let assembly = if step::is_step(source) {
        let glb = step::convert_to_glb(source, arguments.chord.unwrap_or(DEFAULT_CHORD))?;
        let read = read::glb_with(source, &glb, &options).map_err(refused)?;
        read.with_files(vec![source.to_owned()])
    } else {
        read::read(source, &options).map_err(refused)?
    };
    let ignore = constraints::name_pairs("--ignore", &roles.ignore)?;
    let always = constraints::name_pairs("--ignore-always", &roles.ignore_always)?;
    let assembly = assembly.with_ignored(&ignore, Ignored::Overlap)?;
    let assembly = assembly.with_ignored(&always, Ignored::Always)?;
    constraints::with_roles(assembly, roles)
}

/// Prints a note for each option that has no effect on this kind of source.
fn note_unused_options(source: &Path, arguments: &InputArguments) {
    let (is_urdf, is_step) = (has_extension(source, &["urdf"]), step::is_step(source));
    let unused = [
        ("--joint", "URDF", !arguments.joint.is_empty() && !is_urdf),
        ("--visual", "URDF", arguments.visual && !is_urdf),
        ("--chord", "STEP", arguments.chord.is_some() && !is_step),
    ];
    for (option, kind, _) in unused.iter().filter(|(.., is_unused)| *is_unused) {
        note(&format!("{option} has no effect: {} is not a {kind} file", source.display()));
    }
}

/// Returns the end of the message of an error: the option of `assembly` and `path` that avoids it, or the kind of
/// source that only the command line reads. The end is empty if there is neither.
pub(crate) fn read_error_hint(error: &ReadError) -> &'static str {
    match error {
        ReadError::OutsideFolder { .. } => " (--allow-outside reads it)",
        ReadError::UnknownSource { .. } => ", or a STEP file (.step, .stp)",
        ReadError::MissingMeshes { path, .. } if has_extension(path, &["toml", "json"]) => {
            " (--skip-missing skips missing meshes)"
        }
        ReadError::MissingMeshes { .. } => {
            " (--package DIR names the folder of packages, --skip-missing skips missing meshes)"
        }
        ReadError::Assembly {
            source: AssemblyError::Part { source: BodyError::NeedsRepair(_), .. },
            ..
        } => " (without --as-is it is repaired)",
        _ => "",
    }
}

/// Returns the directions of the file `--directions` and of `--samples`, normalised.
fn sampled_directions(arguments: &AssemblyArguments) -> Result<Vec<DVec3>, Failure> {
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
            let direction = direction(line).map_err(refused)?;
            all.push(normalized_direction(direction).map_err(|e| refused(e.to_string()))?);
        }
    }
    if let Some(samples) = arguments.samples.filter(|n| *n > 0) {
        all.extend(Sphere::with_directions(samples).directions);
    }
    Ok(all)
}

/// Returns the groups of parts that options name, with these names.
fn named_groups(
    given: &[String],
    assembly: &Assembly,
) -> Result<Vec<(String, Vec<usize>)>, Failure> {
    let group = |names: &String| {
        let parts: Vec<&str> = names.split(',').collect();
        Ok((names.clone(), assembly.parts_named(&parts)?))
    };
    given.iter().map(group).collect()
}

/// Returns the free travel of each part in each direction.
fn free_travels(
    bodies: &Bodies,
    directions: &[DVec3],
    start: StartOverlap,
    watch: Watch,
) -> Result<Vec<(DVec3, Vec<PartTravel>)>, Failure> {
    if directions.is_empty() {
        return Ok(Vec::new());
    }
    let by_part = travels_of_parts(bodies, directions, start, watch)?;
    let column = |k: usize| by_part.iter().map(|row| row[k]).collect();
    Ok(directions.iter().enumerate().map(|(k, d)| (*d, column(k))).collect())
}

/// Returns a map of the free travel of each group, over the candidate directions.
fn removal_maps(
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
        let own = found.finer.iter().filter(|f| f.concerns_any_of(&mask)).map(|f| f.direction);
        let directions: Vec<DVec3> = found.directions().into_iter().chain(own).collect();
        maps.push((name.clone(), RemovalMap::new(bodies, group, &directions, options, watch)?));
    }
    Ok(maps)
}

impl From<AssemblyError> for Failure {
    fn from(error: AssemblyError) -> Self {
        let code = match error {
            AssemblyError::InvalidValue { .. }
            | AssemblyError::InvalidDirection { .. }
            | AssemblyError::UnknownPart { .. }
            | AssemblyError::SamePart { .. }
            | AssemblyError::CyclicOrder { .. }
            | AssemblyError::OverlappingSubassemblies { .. }
            | AssemblyError::TooFew { .. }
            | AssemblyError::NoTolerance { .. }
            | AssemblyError::NoFit { .. }
            | AssemblyError::ContradictingRoles { .. }
            | AssemblyError::FixedAndRemoved { .. }
            | AssemblyError::InvalidRemoval { .. }
            | AssemblyError::InvalidAngle { .. } => Code::Usage,
            AssemblyError::Replay { .. }
            | AssemblyError::Query { .. }
            | AssemblyError::Cancelled => Code::Query,
            _ => Code::Input,
        };
        Self::new(code, format!("{error}{}", group_hint(&error)))
    }
}

/// Returns how a group is written, after an error about a name that begins like a part; empty for other errors.
fn group_hint(error: &AssemblyError) -> String {
    let AssemblyError::UnknownPart { name, near: Some(near) } = error else {
        return String::new();
    };
    let pairs = near.chars().zip(name.chars()).take_while(|(a, b)| a.eq_ignore_ascii_case(b));
    let prefix: String = pairs.map(|(own, _)| own).collect();
    format!(" `{prefix}*` stands for all names that begin with {prefix}")
}
