//! How assemblies grow: parts, facets, directions; and a folder of meshes, if one is given.
//!
//! `cargo run --release -p colltrans-bench --bin assembly -- [FOLDER TOLERANCE] [--json FILE]`

use std::error::Error;
use std::path::PathBuf;
use std::time::Instant;

use clap::Parser;
use colltrans::solid::StartOverlap;
use colltrans_assembly::candidates::{Choice, candidates};
use colltrans_assembly::liaisons::liaisons;
use colltrans_assembly::matrix::Matrix;
use colltrans_assembly::plan::{PlanOptions, disassemble};
use colltrans_assembly::rooms::rooms;
use colltrans_assembly::sphere::Sphere;
use colltrans_assembly::{Assembly, Bodies, Fit, Part, Piece, Watch};
use colltrans_assembly_io::read::{ReadOptions, read};
use colltrans_testkit::shapes::{Mesh, ring_sphere};
use glam::{DAffine3, DVec3};
use serde_json::{Value, json};

#[derive(Parser)]
struct Arguments {
    /// A folder of meshes
    folder: Option<PathBuf>,
    /// Its tolerance
    #[arg(default_value_t = 0.0)]
    tolerance: f64,
    /// Also write the figures to this file
    #[arg(long)]
    json: Option<PathBuf>,
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments = Arguments::parse();
    let mut rows = Vec::new();
    for side in [3, 5, 8] {
        rows.push(measured("parts", &spheres(side, 12, 5)?, 1e-6, 42)?);
    }
    for rings in [5, 11, 23, 47] {
        rows.push(measured("facets", &spheres(3, 2 * rings + 2, rings)?, 1e-6, 42)?);
    }
    for directions in [12, 42, 162, 642] {
        rows.push(measured("directions", &spheres(3, 12, 5)?, 1e-6, directions)?);
    }
    if let Some(folder) = &arguments.folder {
        let assembly = read(folder, &ReadOptions::default())?;
        rows.push(measured("folder", &assembly, arguments.tolerance, 500)?);
    }
    if let Some(path) = &arguments.json {
        std::fs::write(path, serde_json::to_string_pretty(&rows)?)?;
    }
    Ok(())
}

/// Unit spheres in a cube of rows, a little apart.
fn spheres(side: u32, around: u32, rings: u32) -> Result<Assembly, Box<dyn Error>> {
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

fn measured(
    series: &str,
    assembly: &Assembly,
    tolerance: f64,
    directions: usize,
) -> Result<Value, Box<dyn Error>> {
    let watch = Watch::default();
    let clock = Instant::now();
    let bodies = Bodies::new(assembly, Fit::Tolerance(tolerance))?;
    let ready = clock.elapsed().as_secs_f64();
    let sphere = Sphere::with_directions(directions).directions;
    let clock = Instant::now();
    rooms(&bodies, &sphere, StartOverlap::Ignore, watch)?;
    let rooms_s = clock.elapsed().as_secs_f64();
    let clock = Instant::now();
    let touching = liaisons(&bodies, watch)?;
    let found = candidates(&bodies, &touching, &Choice::default())?;
    let all = vec![true; bodies.len()];
    let start = StartOverlap::Refuse;
    let matrix = Matrix::new(&bodies, &found.directions(), &all, start, watch)?;
    let plan = disassemble(&bodies, &matrix, &found.finer, PlanOptions::default(), watch)?;
    let plan_s = clock.elapsed().as_secs_f64();
    let facets: usize = assembly.parts().iter().map(Part::facets).sum();
    println!(
        "{series:>10}: {:5} parts {facets:7} facets {:4} directions: ready {ready:.3} s, rooms \
         {rooms_s:.3} s, contacts to plan {plan_s:.3} s ({} steps)",
        bodies.len(),
        sphere.len(),
        plan.steps.len()
    );
    Ok(json!({
        "series": series, "parts": bodies.len(), "facets": facets, "directions": sphere.len(),
        "ready_s": ready, "rooms_s": rooms_s, "plan_s": plan_s, "steps": plan.steps.len(),
    }))
}
