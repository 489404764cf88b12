//! An audit as JSON and as a table (CSV).
//!
//! - [`QUANTITIES`] lists the numbers of a pair. JSON, CSV and the columns in Python follow from it.
//! - `colltrans help json` lists the fields, and `docs/answers.schema.json` defines them.

use colltrans::solid::SolidDepth;
use serde::{Serialize, Serializer};
use serde_json::{Map, Value, json};

use super::{Audit, AuditOptions, AuditedPair, Interference, PairProof};
use crate::bodies::Bodies;
use crate::csv::{Cell, Table};
use crate::part::{Assembly, Part};
use crate::record::part_json;

/// A number, bounds or a vector of a pair.
#[derive(Debug, Clone, Copy)]
pub struct Quantity {
    /// Name in JSON and in Python.
    pub name: &'static str,
    /// Columns in a table, one for each number.
    pub columns: &'static [&'static str],
    values: fn(&AuditedPair) -> Option<Vec<f64>>,
}

impl Quantity {
    /// Returns the numbers of a pair, as many as columns; `None` if the pair has none.
    pub fn values(&self, pair: &AuditedPair) -> Option<Vec<f64>> {
        (self.values)(pair)
    }
}

/// All numbers of a pair, in the order of the columns. In JSON `point` and `other_point` are `points` of parts that touch
/// or are apart, and `wall_point` and `other_wall_point` are `wall_points`.
pub static QUANTITIES: [Quantity; 12] = [
    Quantity {
        name: "clearance",
        columns: &["clearance"],
        values: |pair| Some(vec![pair.clearance]),
    },
    Quantity {
        name: "distance",
        columns: &["distance_lower", "distance_upper"],
        values: |pair| Some(pair.finding.nearest()?.distance.to_vec()),
    },
    Quantity {
        name: "depth",
        columns: &["depth_lower", "depth_upper"],
        values: |pair| Some(known_depth(pair)?.bounds().to_vec()),
    },
    Quantity {
        name: "translation",
        columns: &["out_x", "out_y", "out_z"],
        values: |pair| Some(known_depth(pair)?.translation.to_array().to_vec()),
    },
    Quantity {
        name: "least_tolerance",
        columns: &["least_tolerance"],
        values: |pair| Some(vec![pair.finding.interference()?.least_tolerance?]),
    },
    Quantity {
        name: "volume",
        columns: &["volume_lower", "volume_upper"],
        values: |pair| Some(pair.finding.interference()?.known_volume()?.to_vec()),
    },
    Quantity {
        name: "point",
        columns: &["x", "y", "z"],
        values: |pair| Some(pair.finding.place().to_array().to_vec()),
    },
    Quantity {
        name: "tolerance",
        columns: &["tolerance"],
        values: |pair| Some(vec![pair.tolerance]),
    },
    Quantity {
        name: "other_point",
        columns: &["other_x", "other_y", "other_z"],
        values: |pair| Some(pair.finding.nearest()?.points[1].to_array().to_vec()),
    },
    Quantity {
        name: "wall",
        columns: &["wall_lower", "wall_upper"],
        values: |pair| Some(pair.finding.wall()?.distance.to_vec()),
    },
    Quantity {
        name: "wall_point",
        columns: &["wall_x", "wall_y", "wall_z"],
        values: |pair| Some(pair.finding.wall()?.points[0].to_array().to_vec()),
    },
    Quantity {
        name: "other_wall_point",
        columns: &["other_wall_x", "other_wall_y", "other_wall_z"],
        values: |pair| Some(pair.finding.wall()?.points[1].to_array().to_vec()),
    },
];

/// Returns the depth of a pair; `None` if it has none.
fn known_depth(pair: &AuditedPair) -> Option<&SolidDepth> {
    pair.finding.interference().and_then(Interference::known_depth)
}

/// Returns an audit as JSON, to be written pair by pair. As one value, many pairs take twenty times the memory of the
/// text.
pub fn audit_json<'a>(
    bodies: &'a Bodies<'_>,
    options: &'a AuditOptions,
    audit: &'a Audit,
) -> impl Serialize + use<'a> {
    let assembly = bodies.assembly();
    let counts = audit.counts;
    let levels = options.levels().iter();
    let levels = levels.map(|level| json!({ "groups": level.names, "length": level.length }));
    AuditRecord {
        allow_contact: options.allow_contact,
        counts: json!({
            "examined": counts.examined,
            "ignored": counts.ignored,
            "interfering": counts.interfering,
            "contained": counts.contained,
            "touching": counts.touching,
            "near": counts.near,
            "violations": counts.violations,
        }),
        levels: levels.collect(),
        notes: assembly.notes(),
        pairs: PairRecords { assembly, audit },
        parts: assembly.parts().iter().map(part_json).collect(),
        tolerance: bodies.fit().tolerance(),
        unit: assembly.unit(),
        within: options.within,
    }
}

/// An audit in JSON, with its fields in the order of their names.
#[derive(Serialize)]
struct AuditRecord<'a> {
    allow_contact: bool,
    counts: Value,
    levels: Vec<Value>,
    notes: &'a [String],
    pairs: PairRecords<'a>,
    parts: Vec<Value>,
    tolerance: f64,
    unit: Option<&'a str>,
    within: f64,
}

/// The pairs of an audit, each of which becomes JSON when it is written.
struct PairRecords<'a> {
    assembly: &'a Assembly,
    audit: &'a Audit,
}

impl Serialize for PairRecords<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(self.audit.pairs.iter().map(|pair| pair_json(self.assembly, pair)))
    }
}

/// Returns a pair as JSON.
fn pair_json(assembly: &Assembly, pair: &AuditedPair) -> Value {
    let mut object = json!({
        "parts": assembly.part_names(&pair.parts),
        "finding": pair.finding.name(),
        "violation": pair.is_violation,
    });
    for quantity in QUANTITIES.iter().filter(|quantity| !quantity.name.ends_with("point")) {
        if let Some(values) = quantity.values(pair) {
            let is_number = quantity.columns.len() == 1;
            object[quantity.name] = if is_number { json!(values[0]) } else { json!(values) };
        }
    }
    if let Some(role) = pair_role(assembly, pair) {
        object["role"] = json!(role);
    }
    if let Some(inner) = inner_part(assembly, pair) {
        object["inner"] = json!(inner);
    }
    if let Some(found) = pair.finding.interference() {
        let bounds = found.common.bounds.map(|b| [b.low.to_array(), b.high.to_array()]);
        // Also if no tolerance suffices.
        object["least_tolerance"] = json!(found.least_tolerance);
        object["box"] = json!(bounds);
        object["point"] = json!(found.place.to_array());
    }
    let open = open_parts(assembly, pair);
    if !open.is_empty() {
        object["open"] = json!(open);
    }
    if !pair.proofs.is_empty() {
        let of = |is_proven: bool| {
            let some = pair.proofs.iter().filter(|proof| proof.file.is_ok() == is_proven);
            let entry = |proof: &PairProof| {
                let (Ok(text) | Err(text)) = &proof.file;
                (proof.claim.name().to_owned(), json!(text))
            };
            some.map(entry).collect::<Map<_, _>>()
        };
        object["proofs"] = of(true).into();
        let unproven = of(false);
        if !unproven.is_empty() {
            object["unproven"] = unproven.into();
        }
    }
    if let Some(found) = pair.finding.nearest() {
        object["points"] = json!(found.points.map(|point| point.to_array()));
    }
    if let Some(found) = pair.finding.wall() {
        object["wall_points"] = json!(found.points.map(|point| point.to_array()));
    }
    object
}

/// Returns the name of the role of a pair.
fn pair_role(assembly: &Assembly, pair: &AuditedPair) -> Option<&'static str> {
    let [a, b] = pair.parts;
    Some(assembly.pair_fit(a, b)?.role?.name())
}

/// Returns the name of the part inside the other one.
fn inner_part<'a>(assembly: &'a Assembly, pair: &AuditedPair) -> Option<&'a str> {
    pair.finding.inner().map(|inner| assembly.parts()[inner].name())
}

/// Returns the names of the parts of a pair with open shells.
fn open_parts<'a>(assembly: &'a Assembly, pair: &AuditedPair) -> Vec<&'a str> {
    assembly.part_names(&pair.open_parts().collect::<Vec<_>>())
}

/// Returns the pairs of an audit as a table. Cells without a value are empty. `x`, `y`, `z` are the
/// [place](super::PairFinding::place) of the pair. `open` is `first`, `second` or `both`, the parts with
/// open shells, and `proofs` the proof files, separated by spaces.
pub fn audit_csv(assembly: &Assembly, audit: &Audit) -> String {
    let numbers = QUANTITIES.iter().flat_map(|quantity| quantity.columns);
    let heads = ["first", "second", "finding", "violation"].iter().chain(numbers);
    let heads: Vec<&str> = heads.chain(&["inner", "role", "open", "proofs"]).copied().collect();
    let mut table = Table::new(&heads);
    let parts: Vec<&str> = assembly.parts().iter().map(Part::name).collect();
    for pair in &audit.pairs {
        let [first, second] = pair.parts.map(|part| parts[part]);
        let violation = if pair.is_violation { "yes" } else { "no" };
        let mut row = [first, second, pair.finding.name(), violation].map(Cell::Text).to_vec();
        for quantity in &QUANTITIES {
            match quantity.values(pair) {
                Some(values) => row.extend(values.into_iter().map(Cell::Number)),
                None => row.extend(quantity.columns.iter().map(|_| Cell::Text(""))),
            }
        }
        let texts = [inner_part(assembly, pair), pair_role(assembly, pair)];
        row.extend(texts.map(|text| Cell::Text(text.unwrap_or_default())));
        row.push(Cell::Text(match pair.has_open_shells {
            [true, true] => "both",
            [true, false] => "first",
            [false, true] => "second",
            [false, false] => "",
        }));
        let files: Vec<&str> = pair.proof_files().collect();
        let files = files.join(" ");
        row.push(Cell::Text(&files));
        table.push_row(&row);
    }
    table.into_text()
}
