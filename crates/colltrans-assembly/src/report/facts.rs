//! All findings as one JSON value.

use glam::DVec3;
use serde_json::{Value, json};

use crate::attempts::{Attempt, next_attempts};
use crate::bodies::Fit;
use crate::findings::Analysis;
use crate::hints::find_hints;
use crate::record;
use crate::travel::PartTravel;

/// Returns all findings as JSON. `colltrans help json` lists the fields.
pub fn findings_json(f: &Analysis) -> Value {
    let assembly = f.bodies.assembly();
    let parts = assembly.parts().iter().enumerate().map(|(k, part)| {
        let mut object = record::part_json(part);
        if let Some(remark) = f.bodies.shrink_defects(k) {
            object["remark"] = json!(remark);
        }
        if let Some(fastener) = f.plan.fasteners.get(k) {
            object["fastener"] = record::fastener_json(fastener);
        }
        object
    });
    let (fit, length) = match f.bodies.fit() {
        Fit::Tolerance(length) | Fit::Chords { largest: length, .. } => ("tolerance", length),
        Fit::MinGap(length) => ("keep_apart", length),
    };
    let mut object = record::plan_json(f.bodies, &f.plan);
    let more = json!({
        "parts": parts.collect::<Vec<_>>(),
        "unit": assembly.unit(),
        fit: length,
        "overlaps": record::overlaps_json(assembly, &f.start),
        "suggested_tolerance": f.start.suggested_tolerance,
        "suggestions": record::suggestions_json(assembly, &f.suggestions),
        "hints": record::hints_json(assembly, &find_hints(f.bodies, &f.start)),
        "pairs": record::pairs_json(f.bodies),
        "liaisons": record::liaisons_json(assembly, &f.liaisons),
        "seconds": f.times.step_seconds(&f.plan),
        "rooms": free_travels(f),
        "notes": assembly.notes(),
    });
    if let (Value::Object(object), Value::Object(mut more)) = (&mut object, more) {
        object.append(&mut more);
    }
    let attempts = next_attempts(f);
    if !attempts.is_empty() {
        let to_json =
            |attempt: &Attempt| json!({ "option": attempt.option, "why": attempt.reason });
        object["try"] = attempts.iter().map(to_json).collect();
    }
    if !f.maps.is_empty() {
        object["maps"] = f.maps.iter().map(|(_, map)| record::map_json(f.bodies, map)).collect();
    }
    object
}

/// Returns the free travel of each part along all directions.
fn free_travels(f: &Analysis) -> Value {
    let travels = |part: usize| {
        let matrix = f.matrix.directions().iter().enumerate();
        let matrix = matrix.map(move |(k, d)| (part, *d, f.matrix.travel_of_part(k, part)));
        matrix.chain(f.further_travels.iter().map(move |(d, all)| (part, *d, all[part])))
    };
    let to_json = |(part, d, room): (usize, DVec3, PartTravel)| {
        record::part_travel_json(f.bodies, part, d, &room)
    };
    (0..f.bodies.len()).flat_map(travels).map(to_json).collect()
}
