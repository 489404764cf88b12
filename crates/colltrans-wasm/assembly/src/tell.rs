//! Answers about assemblies, as a page reads them.
//!
//! Numbers in binary are single precision and little-endian, about the assembly's middle.

use colltrans::Aabb;
use colltrans_assembly::blocking::Blocking;
use colltrans_assembly::liaisons::Liaison;
use colltrans_assembly::map::RemovalMap;
use colltrans_assembly::matrix::Matrix;
use colltrans_assembly::plan::Plan;
use colltrans_assembly::rooms::PartRoom;
use colltrans_assembly::start::Start;
use colltrans_assembly::{Assembly, Bodies};
use glam::DVec3;
use serde_json::{Value, json};

use crate::answer::Answer;

fn middle(assembly: &Assembly) -> DVec3 {
    let Aabb { low, high } = assembly.bounds();
    (low + high) / 2.0
}

/// Numbers: for each part its vertices (three `f32` each), then its triangles (three `u32` each).
pub(crate) fn parts(assembly: &Assembly) -> Answer {
    let (Aabb { low, high }, middle) = (assembly.bounds(), middle(assembly));
    let facts: Vec<Value> = assembly
        .parts()
        .iter()
        .map(|part| {
            json!({
                "name": part.name(),
                "vertices": part.solid().vertices().len(),
                "triangles": part.solid().triangles().len(),
                "closed": part.solid().is_closed(),
                "defects": part.defects(),
            })
        })
        .collect();
    let mut answer = Answer::of(&json!({
        "parts": facts,
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
    let overlaps = start.overlaps.iter().map(|overlap| {
        json!({ "parts": overlap.parts, "depth": overlap.depth, "remains": overlap.remains })
    });
    let touches = touching.iter().map(|t| json!({ "parts": t.parts, "area": t.area() }));
    Answer::of(&json!({
        "tolerance": bodies.fit().tolerance(),
        "default": default,
        "suggested": start.suggested,
        "overlaps": overlaps.collect::<Vec<_>>(),
        "touches": touches.collect::<Vec<_>>(),
    }))
}

/// Of a matrix of one direction.
pub(crate) fn along(matrix: &Matrix, bodies: &Bodies) -> Answer {
    let middle = middle(bodies.assembly());
    let meetings = matrix.meetings(0).iter().map(|meeting| {
        json!({
            "moving": meeting.moving,
            "fixed": meeting.fixed,
            // None where they overlap.
            "distance": meeting.stop.map(|stop| stop.distance()),
            "point": meeting.stop.map(|stop| (stop.point - middle).to_array()),
        })
    });
    let first = |part: usize| match matrix.room(0, part) {
        PartRoom::Free => json!({ "outcome": "free" }),
        PartRoom::Overlapping { by, .. } => json!({ "outcome": "overlapping", "by": by }),
        PartRoom::Blocked { by, stop, .. } => {
            json!({ "outcome": "blocked", "by": by, "distance": stop.distance() })
        }
    };
    let graph = Blocking::new(matrix, 0, &vec![true; bodies.len()]);
    Answer::of(&json!({
        "direction": matrix.directions()[0].to_array(),
        "meetings": meetings.collect::<Vec<_>>(),
        "first": (0..bodies.len()).map(first).collect::<Vec<_>>(),
        "removable": graph.removable(),
        // What comes along with a part that is moved.
        "closures": (0..bodies.len()).map(|part| graph.closure(part)).collect::<Vec<_>>(),
    }))
}

/// Numbers: directions (three `f32` each), how far (`f32`, infinite if free), then triangles of them
/// (three `u32` each).
pub(crate) fn map(map: &RemovalMap) -> Answer {
    let leaves: Vec<[u32; 3]> =
        map.sphere.leaves().map(|t| map.sphere.triangles[t].corners).collect();
    let regions = map.regions.iter().map(
        |region| json!({ "solid_angle": region.solid_angle, "center": region.center.to_array() }),
    );
    let mut answer = Answer::of(&json!({
        "group": map.group,
        "directions": map.rooms.len(),
        "triangles": leaves.len(),
        "free_share": map.free_share(),
        "size": map.size,
        "regions": regions.collect::<Vec<_>>(),
        "isolated": map.isolated.iter().map(DVec3::to_array).collect::<Vec<_>>(),
        // Which part is in the way, by direction.
        "by": map.rooms.iter().map(PartRoom::by).collect::<Vec<_>>(),
    }));
    let numbers = &mut answer.numbers;
    let directions = map.sphere.directions.iter().flat_map(|d| d.as_vec3().to_array());
    let distances = map.rooms.iter().map(|room| room.distance() as f32);
    directions.chain(distances).for_each(|x| numbers.extend(x.to_le_bytes()));
    leaves.iter().flatten().for_each(|v| numbers.extend(v.to_le_bytes()));
    answer
}

pub(crate) fn plan(plan: &Plan, directions: usize) -> Answer {
    let steps = plan.steps.iter().map(|step| {
        json!({
            "parts": step.parts,
            "direction": step.direction.to_array(),
            "travel": step.travel.value,
            "within": step.within,
            "surfaces": step.surfaces,
        })
    });
    let stuck = plan.stuck.iter().map(|stuck| {
        let holds = stuck.holds.iter().map(|hold| {
            let by: Vec<&[usize]> = hold.by.iter().map(|(parts, _)| &parts[..]).collect();
            json!({ "part": hold.part, "by": by })
        });
        json!({
            "parts": stuck.parts,
            "directions": stuck.directions,
            "overlapping": stuck.overlapping,
            "holds": holds.collect::<Vec<_>>(),
        })
    });
    Answer::of(&json!({
        "directions": directions,
        "steps": steps.collect::<Vec<_>>(),
        "left": plan.left,
        "stuck": stuck.collect::<Vec<_>>(),
    }))
}
