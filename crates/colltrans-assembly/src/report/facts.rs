//! All findings as one JSON value.

use glam::DVec3;
use serde_json::{Value, json};

use crate::bodies::Fit;
use crate::findings::Findings;
use crate::hints::hints;
use crate::record;
use crate::rooms::PartRoom;

/// Returns all findings as JSON. `docs/guide/assemblies.md` describes the fields.
pub fn json(f: &Findings) -> Value {
    let assembly = f.bodies.assembly();
    let parts = assembly.parts().iter().enumerate().map(|(k, part)| {
        let mut object = record::part(part);
        if let Some(remark) = f.bodies.remark(k) {
            object["remark"] = json!(remark);
        }
        object
    });
    let (fit, length) = match f.bodies.fit() {
        Fit::Tolerance(length) | Fit::Chords { largest: length, .. } => ("tolerance", length),
        Fit::Apart(length) => ("keep_apart", length),
    };
    let mut object = record::plan(f.bodies, &f.plan);
    let more = json!({
        "parts": parts.collect::<Vec<_>>(),
        "unit": assembly.unit(),
        fit: length,
        "overlaps": record::overlaps(assembly, &f.start),
        "suggested_tolerance": f.start.suggested,
        "suggestions": record::suggestions(assembly, &f.suggestions),
        "hints": record::hints(assembly, &hints(f.bodies, &f.start)),
        "pairs": record::pairs(f.bodies),
        "liaisons": record::liaisons(assembly, &f.liaisons),
        "seconds": f.times.of(&f.plan),
        "rooms": free_travels(f),
        "notes": assembly.notes(),
    });
    if let (Value::Object(object), Value::Object(mut more)) = (&mut object, more) {
        object.append(&mut more);
    }
    if !f.maps.is_empty() {
        object["maps"] = f.maps.iter().map(|(_, map)| record::map(f.bodies, map)).collect();
    }
    object
}

/// Returns the free travel of each part along all directions.
fn free_travels(f: &Findings) -> Value {
    let travels = |part: usize| {
        let matrix = f.matrix.directions().iter().enumerate();
        let matrix = matrix.map(move |(k, d)| (part, *d, f.matrix.room(k, part)));
        matrix.chain(f.more.iter().map(move |(d, all)| (part, *d, all[part])))
    };
    let to_json =
        |(part, d, room): (usize, DVec3, PartRoom)| record::room(f.bodies, part, d, &room);
    (0..f.bodies.len()).flat_map(travels).map(to_json).collect()
}
