//! Answers about assemblies, as a page reads them: the library's records, and what is drawn.
//!
//! Numbers in binary are single precision and little-endian, about the assembly's middle.

use colltrans::Aabb;
use colltrans_assembly::blocking::Blocking;
use colltrans_assembly::liaisons::Liaison;
use colltrans_assembly::map::RemovalMap;
use colltrans_assembly::matrix::Matrix;
use colltrans_assembly::plan::Plan;
use colltrans_assembly::start::Start;
use colltrans_assembly::{Assembly, Bodies, record};
use serde_json::json;

use crate::answer::Answer;

/// Numbers: for each part its vertices (three `f32` each), then its triangles (three `u32` each).
pub(crate) fn parts(assembly: &Assembly) -> Answer {
    let Aabb { low, high } = assembly.bounds();
    let middle = (low + high) / 2.0;
    let told = assembly.parts().iter().map(|part| {
        let mut told = record::part(part);
        // As many as numbers follow.
        told["vertices"] = json!(part.solid().vertices().len());
        told["triangles"] = json!(part.solid().triangles().len());
        told
    });
    let mut answer = Answer::of(&json!({
        "parts": told.collect::<Vec<_>>(),
        "unit": assembly.unit(),
        "size": (high - low).length(),
        "middle": middle.to_array(),
    }));
    for part in assembly.parts() {
        let places =
            part.solid().vertices().iter().flat_map(|v| (*v - middle).as_vec3().to_array());
        places.for_each(|x| answer.numbers.extend(x.to_le_bytes()));
        let corners = part.solid().triangles().iter().flatten();
        corners.for_each(|v| answer.numbers.extend(v.to_le_bytes()));
    }
    answer
}

pub(crate) fn fit(bodies: &Bodies, default: f64, start: &Start, touching: &[Liaison]) -> Answer {
    let assembly = bodies.assembly();
    Answer::of(&json!({
        "tolerance": bodies.fit().tolerance(),
        "default": default,
        "suggested_tolerance": start.suggested,
        "overlaps": record::overlaps(assembly, start),
        "liaisons": record::liaisons(assembly, touching),
    }))
}

/// Of a matrix of one direction.
pub(crate) fn along(matrix: &Matrix, bodies: &Bodies) -> Answer {
    let assembly = bodies.assembly();
    let (d, all) = (matrix.directions()[0], 0..bodies.len());
    let rooms = all.clone().map(|part| record::room(bodies, part, d, &matrix.room(0, part)));
    let graph = Blocking::new(matrix, 0, &vec![true; bodies.len()]);
    let removable = graph.removable();
    Answer::of(&json!({
        "direction": d.to_array(),
        "meetings": record::meetings(assembly, matrix, 0),
        "rooms": rooms.collect::<Vec<_>>(),
        "removable": removable.iter().map(|group| assembly.names(group)).collect::<Vec<_>>(),
        // What comes along with a part that is moved.
        "closures": all.map(|part| assembly.names(&graph.closure(part))).collect::<Vec<_>>(),
    }))
}

/// Numbers: directions (three `f32` each), how far (`f32`, infinite if free), then triangles of them
/// (three `u32` each).
pub(crate) fn map(map: &RemovalMap, assembly: &Assembly) -> Answer {
    let leaves: Vec<[u32; 3]> =
        map.sphere.leaves().map(|t| map.sphere.triangles[t].corners).collect();
    let mut told = record::regions(assembly, map);
    told["directions"] = json!(map.rooms.len());
    told["triangles"] = json!(leaves.len());
    told["size"] = json!(map.size);
    let mut answer = Answer::of(&told);
    let numbers = &mut answer.numbers;
    let directions = map.sphere.directions.iter().flat_map(|d| d.as_vec3().to_array());
    let distances = map.rooms.iter().map(|room| room.distance() as f32);
    directions.chain(distances).for_each(|x| numbers.extend(x.to_le_bytes()));
    leaves.iter().flatten().for_each(|v| numbers.extend(v.to_le_bytes()));
    answer
}

pub(crate) fn plan(bodies: &Bodies, plan: &Plan, directions: usize) -> Answer {
    let mut told = record::plan(bodies, plan);
    told["directions"] = json!(directions);
    Answer::of(&told)
}
