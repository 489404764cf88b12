//! `memory`: measures the sections of a body, in bytes and in building time.
//!
//! A body makes its sections when the paper's algorithm first needs them. It is built with and without them, in
//! turns, from the same corners. The result is the ratio of the times within a turn.

use std::hint::black_box;
use std::process::ExitCode;

use colltrans::{BuildError, ConvexPolyhedron};
use colltrans_bench::harness::{self, Run, with_name};
use colltrans_bench::shapes::Shape;
use colltrans_bench::times::{Clock, Comparison};
use glam::DVec3;
use serde_json::{Value, json};

const SIZES: [usize; 4] = [8, 32, 1_000, 100_000];

fn main() -> ExitCode {
    let about =
        "Measures bodies with and without the sections of `cta`: bytes a vertex, time of building";
    harness::run("memory", about, |run, (): &()| {
        let columns = ":<12=shape; :>7=vertices; :>5.0=bytes_per_vertex; :>5.0=bytes_per_vertex_with_sections;
            :>9.1=build_us; :>5.2=ratio_with_sections";
        let legend = "shape, vertices, bytes a vertex without and with sections, us without, time with / without";
        run.table(legend, columns);
        for n in run.sizes(&SIZES) {
            for shape in [Shape::RandomHull, Shape::Ellipsoid] {
                let failed = with_name(format!("{} with {n} vertices", shape.name()));
                run.add(measure_sections(shape, n, run).map_err(failed)?);
            }
        }
        Ok(())
    })
}

/// Measures the row of a shape and a size.
fn measure_sections(shape: Shape, n: usize, run: &Run) -> Result<Value, BuildError> {
    let corners = shape.draw(n, &mut run.random(&[n as u64]))?.vertices().to_vec();
    let body = ConvexPolyhedron::from_points(&corners)?;
    let per_vertex = || body.memory_bytes() as f64 / body.vertices().len() as f64;
    let without = per_vertex();
    body.prepare_sections();
    let with = per_vertex();
    let mut times = Comparison::default();
    for _ in 0..run.choose(5, 15) {
        let [plain, sections] = [false, true].map(|sections| build(&corners, sections));
        times.add(plain, sections);
    }
    Ok(json!({
        "shape": shape.name(), "vertices": body.vertices().len(), "bytes_per_vertex": without,
        "bytes_per_vertex_with_sections": with, "build_us": times.ours.median() / 1e3,
        "ratio_with_sections": times.ratios.median(),
    }))
}

/// Returns the nanoseconds of one build, without or with sections. Small bodies are built several times.
fn build(corners: &[DVec3], sections: bool) -> f64 {
    let build = || {
        let body = ConvexPolyhedron::from_points(black_box(corners));
        if let (true, Ok(body)) = (sections, &body) {
            body.prepare_sections();
        }
        drop(black_box(body));
    };
    Clock::new((20_000 / corners.len()) as u32).time(build).1
}
