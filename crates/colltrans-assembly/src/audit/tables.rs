//! An audit as JSON and as a table (CSV).
//!
//! `colltrans help json` lists the fields, and `docs/answers.schema.json` defines them.

use colltrans::solid::SolidDepth;
use serde_json::{Value, json};

use super::{Audit, AuditOptions, AuditedPair, Interference, PairFinding};
use crate::bodies::Bodies;
use crate::csv::{Cell, Table};
use crate::part::{Assembly, Part};
use crate::record::part_json;

/// Returns an audit as JSON.
pub fn audit_json(bodies: &Bodies, options: &AuditOptions, audit: &Audit) -> Value {
    let assembly = bodies.assembly();
    let counts = audit.counts;
    json!({
        "parts": assembly.parts().iter().map(part_json).collect::<Vec<_>>(),
        "unit": assembly.unit(),
        "tolerance": bodies.fit().tolerance(),
        "within": options.within,
        "counts": {
            "examined": counts.examined,
            "ignored": counts.ignored,
            "interfering": counts.interfering,
            "contained": counts.contained,
            "touching": counts.touching,
            "near": counts.near,
            "violations": counts.violations,
        },
        "pairs": audit.pairs.iter().map(|pair| pair_json(assembly, pair)).collect::<Vec<_>>(),
        "notes": assembly.notes(),
    })
}

/// Returns a pair as JSON.
fn pair_json(assembly: &Assembly, pair: &AuditedPair) -> Value {
    let mut object = json!({
        "parts": assembly.part_names(&pair.parts),
        "finding": pair.finding.name(),
        "violation": pair.is_violation,
        "clearance": pair.clearance,
        "tolerance": pair.tolerance,
    });
    if let Some(role) = assembly.pair_fit(pair.parts[0], pair.parts[1]).and_then(|fit| fit.role) {
        object["role"] = json!(role.name());
    }
    if let PairFinding::Contained { inner, .. } = &pair.finding {
        object["inner"] = json!(assembly.parts()[*inner].name());
    }
    if let Some(found) = pair.finding.interference() {
        let bounds = found.common.bounds.map(|b| [b.low.to_array(), b.high.to_array()]);
        if let Some(depth) = found.known_depth() {
            object["depth"] = json!(depth.bounds());
            object["translation"] = json!(depth.translation.to_array());
            object["volume"] = json!(found.common.volume);
        }
        object["least_tolerance"] = json!(found.least_tolerance);
        object["box"] = json!(bounds);
        object["point"] = json!(found.place.to_array());
    }
    if let Some(found) = pair.finding.nearest() {
        object["distance"] = json!(found.distance);
        object["points"] = json!(found.points.map(|point| point.to_array()));
    }
    object
}

/// Returns the pairs of an audit as a table. Cells without a value are empty. `x`, `y`, `z` are the
/// [place](PairFinding::place) of the pair.
pub fn audit_csv(assembly: &Assembly, audit: &Audit) -> String {
    let mut table = Table::new(&[
        "first",
        "second",
        "finding",
        "violation",
        "clearance",
        "distance_lower",
        "distance_upper",
        "depth_lower",
        "depth_upper",
        "out_x",
        "out_y",
        "out_z",
        "least_tolerance",
        "volume_lower",
        "volume_upper",
        "x",
        "y",
        "z",
    ]);
    let parts: Vec<&str> = assembly.parts().iter().map(Part::name).collect();
    for pair in &audit.pairs {
        let (interference, nearest) = (pair.finding.interference(), pair.finding.nearest());
        let mut row = vec![
            Cell::Text(parts[pair.parts[0]]),
            Cell::Text(parts[pair.parts[1]]),
            Cell::Text(pair.finding.name()),
            Cell::Text(if pair.is_violation { "yes" } else { "no" }),
            Cell::Number(pair.clearance),
        ];
        push_numbers(&mut row, nearest.map(|found| found.distance));
        let depth = interference.and_then(Interference::known_depth);
        push_numbers(&mut row, depth.map(SolidDepth::bounds));
        push_numbers(&mut row, depth.map(|depth| depth.translation.to_array()));
        push_numbers(&mut row, interference.and_then(|found| Some([found.least_tolerance?])));
        push_numbers(&mut row, interference.and_then(Interference::known_volume));
        push_numbers(&mut row, Some(pair.finding.place().to_array()));
        table.push_row(&row);
    }
    table.into_text()
}

/// Appends numbers, or empty cells.
fn push_numbers<const N: usize>(row: &mut Vec<Cell>, numbers: Option<[f64; N]>) {
    match numbers {
        Some(numbers) => row.extend(numbers.map(Cell::Number)),
        None => row.extend([Cell::Text(""); N]),
    }
}
