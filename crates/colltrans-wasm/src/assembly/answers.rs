//! Answers about assemblies as the page reads them: records of the library, and data to draw.
//!
//! Binary numbers are little-endian: single precision, and `u32` for indices. Vertices are relative to the middle of
//! the assembly.

use colltrans::Aabb;
use colltrans_assembly::audit::{Audit, AuditOptions, audit_json};
use colltrans_assembly::blocking::BlockingGraph;
use colltrans_assembly::liaisons::Liaison;
use colltrans_assembly::map::RemovalMap;
use colltrans_assembly::matrix::ContactMatrix;
use colltrans_assembly::plan::Plan;
use colltrans_assembly::report::clashes::clash_views;
use colltrans_assembly::start::Start;
use colltrans_assembly::{Assembly, Bodies, record as library_record};
use serde_json::json;

use crate::answer::Answer;

/// Returns all parts. Numbers: for each part its vertices (three `f32` each), then its triangles (three `u32`
/// each).
pub(crate) fn parts_answer(assembly: &Assembly) -> Answer {
    let Aabb { low, high } = assembly.bounds();
    let middle = (low + high) / 2.0;
    let record = assembly.parts().iter().map(|part| {
        let mut record = library_record::part_json(part);
        // The counts of the numbers that follow.
        record["vertices"] = json!(part.solid().vertices().len());
        record["triangles"] = json!(part.solid().triangles().len());
        record
    });
    let mut answer = Answer::from_facts(&json!({
        "parts": record.collect::<Vec<_>>(),
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

/// Returns the tolerance, the overlaps and the liaisons of a fit.
pub(crate) fn fit_answer(
    bodies: &Bodies,
    default: f64,
    start: &Start,
    touching: &[Liaison],
) -> Answer {
    let assembly = bodies.assembly();
    Answer::from_facts(&json!({
        "tolerance": bodies.fit().tolerance(),
        "default": default,
        "suggested_tolerance": start.suggested_tolerance,
        "overlaps": library_record::overlaps_json(assembly, start),
        "liaisons": library_record::liaisons_json(assembly, touching),
    }))
}

/// Returns the blocking graph of a matrix with one direction.
pub(crate) fn blocking_answer(matrix: &ContactMatrix, bodies: &Bodies) -> Answer {
    let assembly = bodies.assembly();
    let (d, all) = (matrix.directions()[0], 0..bodies.len());
    let rooms = all.clone().map(|part| {
        library_record::part_travel_json(bodies, part, d, &matrix.travel_of_part(0, part))
    });
    let graph = BlockingGraph::new(matrix, 0, &vec![true; bodies.len()]);
    let removable = graph.removable_groups();
    Answer::from_facts(&json!({
        "direction": d.to_array(),
        "meetings": library_record::contacts_json(assembly, matrix, 0),
        "rooms": rooms.collect::<Vec<_>>(),
        "removable": removable.iter().map(|group| assembly.part_names(group)).collect::<Vec<_>>(),
        // The parts that move along with each part.
        "closures": all.map(|part| assembly.part_names(&graph.reachable_parts(part))).collect::<Vec<_>>(),
    }))
}

/// Returns a removal map. Numbers: directions (three `f32` each), free travel (`f32`, infinite if free), then
/// triangles of directions (three `u32` each).
pub(crate) fn map_answer(map: &RemovalMap, assembly: &Assembly) -> Answer {
    let leaves: Vec<[u32; 3]> =
        map.sphere.leaf_triangles().map(|t| map.sphere.triangles[t].corners).collect();
    let mut record = library_record::regions_json(assembly, map);
    record["directions"] = json!(map.travels.len());
    record["triangles"] = json!(leaves.len());
    record["size"] = json!(map.size);
    let mut answer = Answer::from_facts(&record);
    let numbers = &mut answer.numbers;
    let directions = map.sphere.directions.iter().flat_map(|d| d.as_vec3().to_array());
    let distances = map.travels.iter().map(|room| room.safe_distance() as f32);
    directions.chain(distances).for_each(|x| numbers.extend(x.to_le_bytes()));
    leaves.iter().flatten().for_each(|v| numbers.extend(v.to_le_bytes()));
    answer
}

/// Returns the record of a plan, and its number of directions.
pub(crate) fn plan_answer(bodies: &Bodies, plan: &Plan, directions: usize) -> Answer {
    let mut record = library_record::plan_json(bodies, plan);
    record["directions"] = json!(directions);
    Answer::from_facts(&record)
}

/// Returns the record of an audit, and for each of its pairs what the view shows.
pub(crate) fn audit_answer(bodies: &Bodies, options: &AuditOptions, found: &Audit) -> Answer {
    let views = clash_views(bodies.assembly(), &found.pairs);
    Answer::from_facts(&json!({
        "audit": audit_json(bodies, options, found),
        "views": views.collect::<Vec<_>>(),
    }))
}
