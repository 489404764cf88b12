//! Rounded bodies: shapes in place of files, `"sphere"`, `"capsule"` and `"radius"` in batches, proofs, pictures.

use crate::proof::checked_in_fractions;
use crate::support::{answered, folder, json, refused, run, stdout};

#[test]
fn shapes_are_cast_and_their_proofs_hold() {
    let folder = folder();
    let ask = |words: &[&str]| json(&answered(folder.path(), words));
    let number =
        |record: &serde_json::Value, field: &str| record[field].as_f64().expect("a number");
    let ball = ["cast", "sphere:0.25", "cube.off", "--direction=-z", "--moving-pose=0.5,0.5,4"];
    let record = ask(&[&ball[..], &["--json", "--save-proof", "proof.json"]].concat());
    assert!((number(&record, "translation") - 2.75).abs() < 1e-12, "{record}");
    checked_in_fractions(folder.path(), 0);
    let capsule = "capsule:-1,0,0,1,0,0,0.5";
    let asked = ["distance", capsule, "box:1,1,1,0.25", "--moving-pose=0,0,3", "--json"];
    assert!((number(&ask(&asked), "lower") - 1.75).abs() < 1e-12);
    let scaled =
        ["distance", "sphere:1", "sphere:1", "--moving-scale=2", "--moving-pose=9,0,0", "--json"];
    assert!((number(&ask(&scaled), "lower") - 6.0).abs() < 1e-12);
    let drawn = [&ball[..], &["--picture", "ball.svg"]].concat();
    answered(folder.path(), &drawn);
    let picture = std::fs::read_to_string(folder.path().join("ball.svg")).expect("a picture");
    assert!(picture.contains("<svg"));
}

#[test]
fn malformed_shapes_and_shapes_as_solids_are_refused() {
    let folder = folder();
    let malformed = ["cast", "sphere:x", "cube.off", "--direction=-z"];
    refused(folder.path(), &malformed, 3, &["sphere:RADIUS"]);
    let asked = ["clearance", "sphere:0.25", "dent.off", "--direction=-z", "--moving-pose=0,0,5"];
    refused(folder.path(), &asked, 3, &["rounded by a radius of 0.25"]);
}

#[test]
fn batches_accept_round_bodies() {
    let folder = folder();
    let line = |moving: &str| {
        format!(
            r#"{{"moving":{moving},"fixed":{{"mesh":"cube.off"}},"direction":[0,0,-1],"moving_pose":{{"translation":[0.5,0.5,4]}}}}"#
        )
    };
    let lines = [
        line(r#"{"sphere":0.25}"#),
        line(r#"{"capsule":[[0,0,0],[0,0,1]],"radius":0.25}"#),
        line(r#"{"points":[[0,0,0]],"radius":0.25}"#),
        line(r#"{"mesh":"cube.off","radius":0.25}"#),
        line(r#"{"capsule":[[0,0,0],[0,0,1]]}"#),
        line(r#"{"sphere":0.25,"radius":1}"#),
        line(r#"{"sphere":-1}"#),
    ];
    std::fs::write(folder.path().join("round.jsonl"), lines.join("\n")).expect("a file");
    let output = run(folder.path(), &["batch", "round.jsonl"]);
    let answers: Vec<serde_json::Value> =
        stdout(&output).lines().map(|line| serde_json::from_str(line).expect("JSON")).collect();
    for answer in &answers[..3] {
        let found = answer["translation"].as_f64().expect("a translation");
        assert!((found - 2.75).abs() < 1e-12, "{answer}");
    }
    assert!(answers[3]["translation"].is_number(), "{}", answers[3]);
    for answer in &answers[4..] {
        assert_eq!(answer["outcome"], "error", "{answer}");
    }
}
