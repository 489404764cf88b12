//! The minimum gap: `--min-gap`, and `"min_gap"` in batches.

use serde_json::Value;

use crate::proof::checked_in_fractions;
use crate::support::{CAST, answered, folder, json, refused, run, stdout};

fn number(record: &Value, field: &str) -> f64 {
    record[field].as_f64().unwrap_or_else(|| panic!("no {field} in {record}"))
}

#[test]
fn casts_and_clearances_use_the_minimum_gap() {
    let folder = folder();
    let with = |extra: &[&str]| json(&answered(folder.path(), &[&CAST, extra].concat()));
    let record = with(&["--min-gap", "0.25", "--json"]);
    assert!((number(&record, "translation") - 1.75).abs() < 1e-12);
    assert_eq!(number(&record, "min_gap"), 0.25);
    assert!(with(&["--json"])["min_gap"].is_null());
    let text = answered(folder.path(), &[&CAST[..], &["--min-gap", "0.25"]].concat());
    assert!(text.contains("minimum gap  0.25, at which"), "{text}");
    // For convex meshes, and for parts.
    for parts in [&[][..], &["--tolerance", "0"]] {
        let clearance = |gap: &str| {
            let asked = ["clearance", "cube.off", "cube.off", "--direction", "x", "--json"];
            let place = ["--moving-pose", "-3,0.25,-0.5", "--min-gap", gap];
            json(&answered(folder.path(), &[&asked[..], &place, parts].concat()))
        };
        assert!((number(&clearance("0.25"), "distance") - 1.75).abs() < 1e-12);
        assert_eq!(number(&clearance("0.25"), "min_gap"), 0.25);
        assert_eq!(clearance("2.5")["outcome"], "overlapping");
    }
    let dent = ["clearance", "cube.off", "dent.off", "--direction", "-z", "--moving-pose"];
    let text = answered(folder.path(), &[&dent[..], &["0,0,5", "--min-gap", "0.5"]].concat());
    assert!(text.starts_with("blocked") && text.contains("minimum gap  0.5, at which"), "{text}");
}

#[test]
fn invalid_minimum_gaps_are_rejected() {
    let folder = folder();
    for gap in ["-1", "nan", "inf", "a"] {
        refused(folder.path(), &[&CAST[..], &["--min-gap", gap]].concat(), 2, &["--min-gap"]);
    }
    let output = run(folder.path(), &[&CAST[..], &["--min-gap", "1e70"]].concat());
    assert_ne!(output.status.code(), Some(0));
}

#[test]
fn saved_proofs_include_the_minimum_gap() {
    let folder = folder();
    for (fixed, name) in [("cube.off", "convex.json"), ("dent.off", "parts.json")] {
        let asked = ["clearance", "cube.off", fixed, "--direction", "-z", "--moving-pose", "0,0,5"];
        let save = ["--min-gap", "0.5", "--save-proof", name];
        answered(folder.path(), &[&asked[..], &save].concat());
        let said = answered(folder.path(), &["verify", name]);
        assert!(said.starts_with("holds") && said.contains("0.5 apart or nearer"), "{said}");
        // The checker in fractions checks only planes of parts, and this proof has no plane.
        if name == "convex.json" {
            std::fs::copy(folder.path().join(name), folder.path().join("proof.json")).unwrap();
            checked_in_fractions(folder.path(), 0);
        }
        let place = folder.path().join(name);
        let more =
            std::fs::read_to_string(&place).unwrap().replace("\"min_gap\":0.5", "\"min_gap\":0.6");
        std::fs::write(&place, more).unwrap();
        let changed = run(folder.path(), &["verify", name]);
        assert_eq!(changed.status.code(), Some(6), "{}", stdout(&changed));
    }
}

#[test]
fn batch_queries_use_the_minimum_gap() {
    let folder = folder();
    let line = |body: &str, more: &str| {
        let fixed = format!("{{\"{body}\":\"cube.off\"}}");
        format!(
            "{{\"moving\":{{\"mesh\":\"cube.off\"}},\"fixed\":{fixed},\"moving_pose\":\
             {{\"translation\":[-3,0.25,-0.5]}},\"direction\":[1,0,0],\"query\":\"clearance\"{more}}}\n"
        )
    };
    let lines = [
        line("mesh", ",\"min_gap\":0.25"),
        line("solid", ",\"min_gap\":2.5e-1"),
        line("mesh", ""),
        line("solid", ",\"min_gap\":-1"),
        line("mesh", ",\"min_gap\":-1"),
    ];
    std::fs::write(folder.path().join("lines.jsonl"), lines.concat()).unwrap();
    let output = run(folder.path(), &["batch", "lines.jsonl"]);
    let records: Vec<Value> = stdout(&output).lines().map(json).collect();
    for (record, right) in records.iter().zip([1.75, 1.75, 2.0]) {
        assert!((number(record, "distance") - right).abs() < 1e-12, "{record}");
    }
    assert_eq!(number(&records[1], "min_gap"), 0.25);
    for wrong in &records[3..] {
        assert_eq!(wrong["outcome"], "error");
        assert!(wrong["message"].as_str().unwrap().contains("gap"), "{wrong}");
    }
}
