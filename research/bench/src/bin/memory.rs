//! `memory`: what sections add to a body, in bytes and in the time of building it.
//!
//! A body makes its sections when the paper's algorithm first asks for them. Built with and without, in
//! turns, from the same corners; times are judged by their ratio within a turn.

use std::hint::black_box;
use std::process::ExitCode;

use clap::Parser;
use colltrans::{BuildError, ConvexPolyhedron};
use colltrans_bench::arguments::Arguments;
use colltrans_bench::report;
use colltrans_bench::shapes::Shape;
use colltrans_testkit::random::Random;
use colltrans_testkit::timing::{Stopwatch, median};
use glam::DVec3;
use serde_json::{Value, json};

/// Measures bodies with and without the sections of `cta`: bytes a vertex, time of building
#[derive(Debug, Parser)]
struct Command {
    #[command(flatten)]
    arguments: Arguments,
}

const SIZES: [usize; 4] = [8, 32, 1_000, 100_000];

fn main() -> ExitCode {
    let Command { arguments } = Command::parse();
    let mut rows = Vec::new();
    println!(
        "shape, vertices, bytes a vertex without and with sections, us without, time with / without"
    );
    for &n in arguments.sizes.as_deref().unwrap_or(&SIZES) {
        for shape in [Shape::RandomHull, Shape::Ellipsoid] {
            match measure(shape, n, &arguments) {
                Ok(row) => rows.push(row),
                Err(error) => {
                    eprintln!("error: {} with {n} vertices: {error}", shape.name());
                    return ExitCode::FAILURE;
                }
            }
        }
    }
    report::write("memory", &arguments, &rows)
}

/// The row of a shape and a size.
fn measure(shape: Shape, n: usize, arguments: &Arguments) -> Result<Value, BuildError> {
    let corners =
        shape.draw(n, &mut Random::stream(arguments.seed, &[n as u64]))?.vertices().to_vec();
    let body = ConvexPolyhedron::from_points(&corners)?;
    let per_vertex = || body.memory_bytes() as f64 / body.vertices().len() as f64;
    let without = per_vertex();
    body.prepare_sections();
    let with = per_vertex();
    let turns = if arguments.quick { 5 } else { 15 };
    let times: Vec<_> = (0..turns).map(|_| turn(&corners)).collect();
    let micros = median(&times.iter().map(|t| t[0] / 1e3).collect::<Vec<_>>());
    let ratio = median(&times.iter().map(|t| t[1] / t[0]).collect::<Vec<_>>());
    let (shape, vertices) = (shape.name(), body.vertices().len());
    println!("{shape:<12} {vertices:>7} {without:>5.0} {with:>5.0} {micros:>9.1} {ratio:>5.2}");
    Ok(json!({
        "shape": shape, "vertices": vertices, "bytes_per_vertex": without,
        "bytes_per_vertex_with_sections": with, "build_us": micros, "ratio_with_sections": ratio,
    }))
}

/// Nanoseconds of building once, without and with sections; small bodies several times over.
fn turn(corners: &[DVec3]) -> [f64; 2] {
    let repeats = (20_000 / corners.len()).max(1);
    [false, true].map(|sections| {
        let build = || {
            for _ in 0..repeats {
                let body = ConvexPolyhedron::from_points(black_box(corners));
                if let (true, Ok(body)) = (sections, &body) {
                    body.prepare_sections();
                }
                drop(black_box(body));
            }
        };
        Stopwatch::new().time(build).1 / repeats as f64
    })
}
