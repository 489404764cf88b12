//! `assembly`: measures growing assemblies by parts, facets and directions, and optionally a folder of meshes.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Args;
use colltrans::solid::StartOverlap;
use colltrans_assembly::candidates::{CandidateOptions, find_candidates};
use colltrans_assembly::liaisons::find_liaisons;
use colltrans_assembly::matrix::ContactMatrix;
use colltrans_assembly::plan::{PlanOptions, disassemble};
use colltrans_assembly::sphere::Sphere;
use colltrans_assembly::travel::travels_of_parts;
use colltrans_assembly::{Assembly, Bodies, Fit, Part, Piece, Watch};
use colltrans_assembly_io::read::{ReadOptions, read};
use colltrans_bench::harness::{self, Failure};
use colltrans_bench::times::Clock;
use colltrans_testkit::shapes::{Mesh, ring_sphere};
use glam::{DAffine3, DVec3};
use serde_json::{Value, json};

#[derive(Debug, Args)]
struct OwnArguments {
    /// Folder of meshes
    folder: Option<PathBuf>,
    /// Tolerance for the folder
    #[arg(default_value_t = 0.0)]
    tolerance: f64,
}

fn main() -> ExitCode {
    let about = "Measures growing assemblies by parts, facets and directions; prints a table";
    harness::run("assembly", about, |run, own: &OwnArguments| {
        let columns = "series:>10; parts:>5; facets:>7; directions:>10; ready, s:>9.3=ready_s; rooms, s:>9.3=rooms_s;
            contacts to plan, s:>19.3=plan_s; steps:>5";
        run.table("", columns);
        for side in [3, 5, 8] {
            run.add(measure_assembly("parts", &sphere_grid(side, 12, 5)?, 1e-6, 42)?);
        }
        for rings in [5, 11, 23, 47] {
            run.add(measure_assembly("facets", &sphere_grid(3, 2 * rings + 2, rings)?, 1e-6, 42)?);
        }
        for directions in [12, 42, 162, 642] {
            run.add(measure_assembly("directions", &sphere_grid(3, 12, 5)?, 1e-6, directions)?);
        }
        if let Some(folder) = &own.folder {
            let assembly = read(folder, &ReadOptions::default())?;
            run.add(measure_assembly("folder", &assembly, own.tolerance, 500)?);
        }
        Ok(())
    })
}

/// Builds unit spheres in a cubic grid, slightly apart.
fn sphere_grid(side: u32, around: u32, rings: u32) -> Result<Assembly, Failure> {
    let Mesh { vertices, faces, .. } = ring_sphere(around, rings);
    let mut parts = Vec::new();
    for k in 0..side * side * side {
        let cell = [k % side, k / side % side, k / (side * side)].map(f64::from);
        let at = DVec3::from_array(cell) * 2.05;
        let piece = Piece {
            mesh: colltrans_mesh::Mesh::new(vertices.clone(), faces.clone()),
            world_from_piece: DAffine3::from_translation(at),
        };
        parts.push(Part::new(format!("sphere_{k}"), &[piece])?);
    }
    Ok(Assembly::new(parts)?)
}

/// Measures an assembly.
fn measure_assembly(
    series: &str,
    assembly: &Assembly,
    tolerance: f64,
    directions: usize,
) -> Result<Value, Failure> {
    let watch = Watch::default();
    let clock = Clock::new(1);
    let (bodies, ready) = clock.time(|| Bodies::new(assembly, Fit::Tolerance(tolerance)));
    let bodies = bodies?;
    let sphere = Sphere::with_directions(directions).directions;
    let (found, rooms_ns) =
        clock.time(|| travels_of_parts(&bodies, &sphere, StartOverlap::Ignore, watch));
    found?;
    let plan = || -> Result<_, Failure> {
        let touching = find_liaisons(&bodies, watch)?;
        let found = find_candidates(&bodies, &touching, &CandidateOptions::default())?;
        let all = vec![true; bodies.len()];
        let start = StartOverlap::Refuse;
        let matrix = ContactMatrix::new(&bodies, &found.directions(), &all, start, watch)?;
        Ok(disassemble(&bodies, &matrix, &found.finer, PlanOptions::default(), watch)?)
    };
    let (plan, plan_ns) = clock.time(plan);
    let facets: usize = assembly.parts().iter().map(Part::facet_count).sum();
    Ok(json!({
        "series": series, "parts": bodies.len(), "facets": facets, "directions": sphere.len(),
        "ready_s": ready / 1e9, "rooms_s": rooms_ns / 1e9, "plan_s": plan_ns / 1e9,
        "steps": plan?.steps.len(),
    }))
}
