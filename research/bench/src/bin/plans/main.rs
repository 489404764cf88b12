//! `plans`: judges plans for generated machines with a known order, and for real assemblies if they are present.
//!
//! The figures are the number of steps, the reasons of an incomplete plan, the travel relative to the
//! shortest free travel, the result of rays ([`judge`]) and the time.

mod judge;

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

use clap::Args;
use colltrans_assembly::{
    Analysis, AnalysisRequest, Assembly, Bodies, Fit, Part, Piece, Stage, Watch, suggest,
};
use colltrans_assembly_io::read::{ReadOptions, read};
use colltrans_bench::harness::{self, Failure};
use colltrans_mesh::Mesh;
use colltrans_testkit::machines::{
    NamedPart, flange, radial_engine, screwed_table, threaded_block,
};
use colltrans_testkit::random::Random;
use glam::DAffine3;
use serde_json::{Value, json};

use judge::PlanJudgement;

#[derive(Debug, Args)]
struct OwnArguments {
    /// Folder of real assemblies
    #[arg(long, default_value = "../shared/data")]
    data: PathBuf,
    /// Measure only assemblies whose names begin with this text
    #[arg(long, default_value = "")]
    only: String,
    /// Measure the additional time for a rotated machine, in which touching facets are not exactly coplanar
    #[arg(long)]
    turned: bool,
    /// Measure machines with three million facets
    #[arg(long)]
    fine: bool,
    /// Also write the parts of the generated machines into this folder
    #[arg(long)]
    parts: Option<PathBuf>,
}

fn main() -> ExitCode {
    let about = "Plans the disassembly of machines, and judges the plans";
    harness::run("plans", about, |run, own: &OwnArguments| {
        let made = if own.fine && !own.turned { fine_machines() } else { generated_machines() };
        for (name, parts) in made.into_iter().filter(|(name, _)| name.starts_with(&own.only)) {
            if own.turned {
                run.add(compare_with_rotated(&name, &parts)?);
                continue;
            }
            if let Some(folder) = &own.parts {
                write_parts(&folder.join(&name), &parts)?;
            }
            run.add(plan_row(&name, &build_assembly(&parts, DAffine3::IDENTITY)?, !own.fine)?);
        }
        let real = if own.turned || own.fine { Vec::new() } else { real_assemblies(&own.data) };
        for (name, path) in real.into_iter().filter(|(name, _)| name.starts_with(&own.only)) {
            if !path.exists() {
                println!("{name:>16}: not there");
                continue;
            }
            run.add(plan_row(&name, &read(path, &ReadOptions::default())?, true)?);
        }
        Ok(())
    })
}

/// Returns the generated machines.
fn generated_machines() -> Vec<(String, Vec<NamedPart>)> {
    let mut all: Vec<_> =
        [8, 16, 32, 64, 256].map(|bolts| (format!("flange_{bolts}"), flange(bolts, 32))).into();
    all.extend(
        [5, 7, 9].map(|cylinders| (format!("engine_{cylinders}"), radial_engine(cylinders))),
    );
    all.push(("threaded_block".into(), threaded_block()));
    all.push(("screwed_table".into(), screwed_table()));
    all
}

/// Returns machines with about three million facets: long thin ones, as CAD programs make them for large
/// cylinders, and many small ones.
fn fine_machines() -> Vec<(String, Vec<NamedPart>)> {
    let quartered = |sides: usize, times: usize| {
        let mut parts = flange(8, sides);
        for mesh in parts.iter_mut().flat_map(|part| &mut part.1) {
            for _ in 0..times {
                *mesh = mesh.quartered();
            }
        }
        parts
    };
    vec![("fine_sides".into(), quartered(880, 2)), ("fine_facets".into(), quartered(56, 4))]
}

/// Returns the names and folders of the real assemblies.
fn real_assemblies(data: &Path) -> Vec<(String, PathBuf)> {
    let mut all = vec![("gearbox".to_owned(), data.join("gearbox"))];
    let folder = data.join("assemblies");
    for name in ["flange8", "pillow_block", "valve_oring"] {
        all.push((name.into(), folder.join(name)));
    }
    all.push(("square_table".into(), folder.join("square_table/assembly.toml")));
    for pair in ["00004", "00007", "00014", "00117", "00638", "01132"] {
        all.push((format!("pair_{pair}"), folder.join("pairs").join(pair)));
    }
    all.push(("saw".into(), folder.join("ReciprocatingSaw.glb")));
    all
}

/// Builds an assembly at a pose.
fn build_assembly(parts: &[NamedPart], placed: DAffine3) -> Result<Assembly, Failure> {
    let part = |(name, bodies): &NamedPart| -> Result<Part, Failure> {
        let piece = |mesh: &colltrans_testkit::shapes::Mesh| Piece {
            mesh: Mesh::new(mesh.vertices.clone(), mesh.faces.clone()),
            world_from_piece: placed,
        };
        Ok(Part::new(name, &bodies.iter().map(piece).collect::<Vec<_>>())?)
    };
    let parts = parts.iter().map(part).collect::<Result<Vec<_>, _>>()?;
    Ok(Assembly::new(parts)?.with_unit("mm"))
}

/// Writes each body as a file, and a manifest of all parts.
fn write_parts(folder: &Path, parts: &[NamedPart]) -> Result<(), Failure> {
    std::fs::create_dir_all(folder)?;
    let mut entries = Vec::new();
    for (name, bodies) in parts {
        let mut files = Vec::new();
        for (k, mesh) in bodies.iter().enumerate() {
            let file = format!("{name}.{k}.off");
            let mesh = Mesh::new(mesh.vertices.clone(), mesh.faces.clone());
            colltrans_mesh::write(&mesh, folder.join(&file))?;
            files.push(file);
        }
        entries.push(json!({ "name": name, "file": files }));
    }
    let manifest = json!({ "unit": "mm", "parts": entries });
    Ok(std::fs::write(folder.join("assembly.json"), manifest.to_string())?)
}

/// Plans without options; if that plan is incomplete, plans again with the suggested options.
fn plan_row(name: &str, assembly: &Assembly, judged: bool) -> Result<Value, Failure> {
    let question = AnalysisRequest::default();
    let fit = Fit::default_for(assembly);
    let clock = Clock::start();
    let bodies = Bodies::new(assembly, fit)?;
    let (found, stages) = find_plan(&question, &bodies, &clock)?;
    let mut told = vec![judgement_row(name, "", &found, clock.seconds(), judged)];
    println!("{:>20}{stages}", "");
    if !found.plan.interlocked.is_empty() && !found.suggestions.is_empty() {
        let clock = Clock::start();
        let suggested = suggest::apply_suggestions(assembly.clone(), &found.suggestions)?;
        let bodies = Bodies::new(&suggested, fit)?;
        let found = question.analyse(&bodies, Watch::default())?;
        told.push(judgement_row(name, "--auto", &found, clock.seconds(), judged));
    }
    Ok(json!({ "name": name, "plans": told }))
}

/// Plans, and measures the time of the phases.
fn find_plan<'a>(
    question: &AnalysisRequest,
    bodies: &'a Bodies<'a>,
    clock: &Clock,
) -> Result<(Analysis<'a>, String), Failure> {
    let stages = Mutex::new(vec![("bodies", 0.0), ("", clock.seconds())]);
    let known = || stages.lock().unwrap_or_else(PoisonError::into_inner);
    let reached = |stage: Stage, _: usize, _: usize| {
        let mut stages = known();
        if stages.last().is_none_or(|(name, _)| *name != stage.name()) {
            stages.push((stage.name(), clock.seconds()));
        }
    };
    let found = question.analyse(bodies, Watch::default().with_progress(&reached))?;
    let stages = known();
    let ends = stages.iter().skip(1).map(|stage| stage.1).chain([clock.seconds()]);
    let each = stages.iter().zip(ends).filter(|((name, _), _)| !name.is_empty());
    let each: Vec<String> =
        each.map(|((name, from), to)| format!("{name} {:.2}", to - from)).collect();
    let directions = found.matrix.directions().len();
    Ok((found, format!("of it {} s; {directions} directions", each.join(", "))))
}

/// Returns the row of a plan.
fn judgement_row(name: &str, options: &str, found: &Analysis, seconds: f64, judged: bool) -> Value {
    let (plan, assembly) = (&found.plan, found.bodies.assembly());
    let facets: usize = assembly.parts().iter().map(Part::facet_count).sum();
    let stages = plan.stages().len();
    println!(
        "{name:>16} {options}: {} parts, {facets} facets, {seconds:.2} s: {} steps in {stages} stages",
        assembly.parts().len(),
        plan.steps.len(),
    );
    let whole = plan.remaining.is_empty() && plan.interlocked.is_empty();
    let reasons: Vec<String> =
        plan.interlocked.iter().map(|s| s.reason_sentence(found.bodies)).collect();
    for reason in &reasons {
        println!("{:>20}{reason}", "");
    }
    let PlanJudgement { travel, least, worst, rays, crossing } =
        if judged { PlanJudgement::of(found) } else { PlanJudgement::default() };
    let ratio = if least > 0.0 { travel / least } else { 1.0 };
    if judged {
        let crossings: Vec<String> =
            crossing.iter().map(|(step, count)| format!("{count} in step {}", step + 1)).collect();
        println!(
            "{:>20}travel {travel:.4}, {ratio:.3} times the least; longest step {worst:.3}; of {rays} rays that cross: {}",
            "",
            if crossings.is_empty() { "none".into() } else { crossings.join(", ") },
        );
    }
    json!({
        "options": options, "parts": assembly.parts().len(), "facets": facets, "seconds": seconds,
        "steps": plan.steps.len(), "stages": stages, "whole": whole, "reasons": reasons,
        "travel": travel, "ratio": ratio, "longest": worst, "rays": rays,
        "crossing": crossing.iter().map(|(_, count)| count).sum::<usize>(),
    })
}

/// Measures the same machine in its original pose and rotated, in turns.
fn compare_with_rotated(name: &str, parts: &[NamedPart]) -> Result<Value, Failure> {
    let mut random = Random::new(31);
    let mut ratios = Vec::new();
    let mut seconds = [0.0; 2];
    for _ in 0..3 {
        let places = [DAffine3::IDENTITY, DAffine3::from_quat(random.rotation())];
        let mut steps = [0; 2];
        for (k, place) in places.into_iter().enumerate() {
            let assembly = build_assembly(parts, place)?;
            let up = place.transform_vector3(glam::DVec3::Z);
            let question = AnalysisRequest::default().with_gravity(-up);
            let clock = Clock::start();
            let bodies = Bodies::new(&assembly, Fit::default_for(&assembly))?;
            let (found, stages) = find_plan(&question, &bodies, &clock)?;
            seconds[k] = clock.seconds();
            println!("{:>20}{stages}", "");
            steps[k] = found.plan.steps.len();
        }
        println!(
            "{name:>16}: {:.3} s, turned {:.3} s: {:.2} times; {} and {} steps",
            seconds[0],
            seconds[1],
            seconds[1] / seconds[0],
            steps[0],
            steps[1],
        );
        ratios.push(seconds[1] / seconds[0]);
    }
    Ok(json!({ "name": name, "ratios": ratios }))
}

/// Processor time of this process where the system reports it; else wall-clock time.
struct Clock {
    wall: Instant,
    spent: Option<f64>,
}

impl Clock {
    fn start() -> Self {
        Self { wall: Instant::now(), spent: processor_time() }
    }

    fn seconds(&self) -> f64 {
        match (self.spent, processor_time()) {
            (Some(before), Some(now)) => now - before,
            _ => self.wall.elapsed().as_secs_f64(),
        }
    }
}

/// Returns the processor time. Linux reports it in hundredths of a second.
fn processor_time() -> Option<f64> {
    let stat = std::fs::read_to_string("/proc/self/stat").ok()?;
    let fields: Vec<&str> = stat.rsplit_once(')')?.1.split_whitespace().collect();
    let ticks = |k: usize| fields.get(k)?.parse::<f64>().ok();
    Some((ticks(11)? + ticks(12)?) / 100.0)
}
