//! The findings as JSON.

use colltrans::solid::ShellKind;
use glam::DVec3;
use serde_json::{Value, json};

use super::Findings;
use crate::bodies::Fit;
use crate::rooms::PartRoom;

/// All findings; `docs/assemblies.md` describes the fields.
pub fn json(f: &Findings) -> Value {
    let assembly = f.bodies.assembly();
    let name = |k: usize| assembly.parts()[k].name();
    let parts: Vec<Value> = assembly
        .parts()
        .iter()
        .enumerate()
        .map(|(k, p)| {
            let bounds = p.solid().volume_bounds();
            // What is open has none.
            let volume = bounds.map(|_| p.solid().volume());
            let mut part = json!({
                "name": p.name(), "facets": p.facets(), "volume": volume, "volume_bounds": bounds
            });
            if p.is_surface() {
                let count =
                    |kind: ShellKind| (kind.name().to_owned(), p.solid().report().count(kind));
                part["shells"] = ShellKind::ALL.into_iter().map(count).collect();
            }
            if !p.defects().is_empty() {
                part["defects"] = json!(p.defects());
            }
            if let Some(remark) = f.bodies.remark(k) {
                part["remark"] = json!(remark);
            }
            part
        })
        .collect();
    let overlaps: Vec<Value> = f
        .start
        .overlaps
        .iter()
        .map(|o| json!({ "parts": o.parts.map(name), "depth": o.depth }))
        .collect();
    let touching: Vec<Value> = f
        .liaisons
        .iter()
        .map(|l| {
            let center = l.center().to_array();
            let (area, bounds) = (l.area(), l.area_bounds());
            json!({ "parts": l.parts.map(name), "area": area, "area_bounds": bounds, "center": center })
        })
        .collect();
    let (fit, length) = match f.bodies.fit() {
        Fit::Tolerance(length) => ("tolerance", length),
        Fit::Apart(length) => ("keep_apart", length),
    };
    json!({
        "parts": parts,
        "unit": assembly.unit(),
        fit: length,
        "overlaps": overlaps,
        "suggested_tolerance": f.start.suggested,
        "liaisons": touching,
        "rooms": rooms(f),
        "plan": steps(f),
        "left": assembly.names(&f.plan.left),
        "stuck": stuck(f),
        "notes": assembly.notes(),
    })
}

fn rooms(f: &Findings) -> Vec<Value> {
    let mut rooms = Vec::new();
    for part in 0..f.bodies.len() {
        for (k, &d) in f.matrix.directions().iter().enumerate() {
            rooms.push(room(f, part, d, &f.matrix.room(k, part)));
        }
        for (d, all) in f.more {
            rooms.push(room(f, part, *d, &all[part]));
        }
    }
    rooms
}

fn room(f: &Findings, part: usize, d: DVec3, room: &PartRoom) -> Value {
    let name = |k: usize| f.bodies.assembly().parts()[k].name();
    let distance = room.distance();
    let mut entry = json!({
        "part": name(part),
        "direction": d.to_array(),
        "outcome": room.outcome(),
        "distance": distance.is_finite().then_some(distance),
        "by": room.by().map(name),
    });
    if let PartRoom::Blocked { stop, .. } = room {
        let name = match f.bodies.fit() {
            Fit::Tolerance(_) => {
                entry["translation"] = json!(stop.translation.value);
                entry["translation_bounds"] = json!(stop.translation.bounds());
                "shrunk_distance"
            }
            Fit::Apart(_) => "kept_distance",
        };
        entry[name] = json!(stop.displaced.value);
        entry[format!("{name}_bounds")] = json!(stop.displaced.bounds());
        entry["point"] = json!(stop.point.to_array());
        entry["normal"] = json!(stop.normal.to_array());
    }
    entry
}

fn steps(f: &Findings) -> Vec<Value> {
    let step = |s: &crate::plan::Step| {
        let mut step = json!({
            "parts": f.bodies.assembly().names(&s.parts),
            "direction": s.direction.to_array(),
            "travel": s.travel.value,
            "travel_bounds": s.travel.bounds(),
        });
        if !s.ignored.is_empty() {
            let pairs: Vec<_> = s.ignored.iter().map(|p| f.bodies.assembly().names(p)).collect();
            step["ignored"] = json!(pairs);
        }
        if let Some(within) = s.within {
            step["within"] = json!(within);
        }
        if !s.surfaces.is_empty() {
            step["surfaces"] = json!(f.bodies.assembly().names(&s.surfaces));
        }
        step
    };
    f.plan.steps.iter().map(step).collect()
}

fn stuck(f: &Findings) -> Vec<Value> {
    let assembly = f.bodies.assembly();
    let set = |(parts, d): &(Vec<usize>, DVec3)| json!({ "parts": assembly.names(parts), "direction": d.to_array() });
    let stuck = |s: &crate::plan::Stuck| {
        let holds: Vec<Value> = s
            .holds
            .iter()
            .map(|h| {
                let by: Vec<Value> = h.by.iter().map(set).collect();
                json!({ "part": assembly.parts()[h.part].name(), "least": by })
            })
            .collect();
        json!({
            "parts": assembly.names(&s.parts),
            "because": s.because(f.bodies),
            "directions": s.directions,
            "holds": holds,
        })
    };
    f.plan.stuck.iter().map(stuck).collect()
}
