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
fn malformed_shapes_and_free_directions_of_round_ones_are_refused() {
    let folder = folder();
    let malformed = ["cast", "sphere:x", "cube.off", "--direction=-z"];
    refused(folder.path(), &malformed, 3, &["sphere:RADIUS"]);
    let asked = ["free", "sphere:0.25", "dent.off", "--moving-pose=0,0,5"];
    refused(folder.path(), &asked, 3, &["rounded by a radius of 0.25"]);
}

/// A ball above a mesh that is not convex: distances and contacts with it are those of a point, less the radius.
#[test]
fn round_shapes_meet_meshes_that_are_not_convex() {
    let folder = folder();
    let number =
        |record: &serde_json::Value, field: &str| record[field].as_f64().expect("a number");
    let ask = |what: &str, shape: &str, more: &[&str]| {
        let words = [what, shape, "dent.off", "--moving-pose=0.25,0.25,5", "--json"];
        json(&answered(folder.path(), &[&words[..], more].concat()))
    };
    let point = number(&ask("distance", "sphere:0.001", &[]), "lower") + 0.001;
    for (shape, radius) in
        [("sphere:0.25", 0.25), ("capsule:0,0,0,0,0,1,0.5", 0.5), ("box:0,0,0,0.125", 0.125)]
    {
        let found = number(&ask("distance", shape, &[]), "lower");
        assert!((found - (point - radius)).abs() < 1e-9, "{shape}: {found} {point}");
        let more = ["--direction=-z", "--tolerance=0", "--save-proof", "proof.json"];
        let record = ask("clearance", shape, &more);
        assert_eq!(record["outcome"], "blocked", "{record}");
        answered(folder.path(), &["verify", "proof.json"]);
        let found = number(&record, "distance");
        let sphere = ask("clearance", &format!("sphere:{radius}"), &more[..2]);
        assert!((found - number(&sphere, "distance")).abs() < 1e-9, "{shape}: {found} {sphere}");
    }
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
        line(r#"{"solid":"cube.off","radius":0.25}"#),
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
    for answer in &answers[3..5] {
        let found = answer["translation"].as_f64().or(answer["distance"].as_f64());
        assert!((found.expect("a length") - 2.75).abs() < 1e-9, "{answer}");
    }
    for answer in &answers[5..] {
        assert_eq!(answer["outcome"], "error", "{answer}");
    }
}
