//! `colltrans distance`, `depth` and `within`, their proofs and pictures, and the lines of a batch.

use std::path::Path;

use serde_json::{Value, json};

use crate::proof::{checked_in_fractions, saved};
use crate::support::{answered, colltrans, folder, json as read, refused, run, stderr, stdout};

/// A unit cube at a distance of 3 along x from another, offset along y and z.
const APART: [&str; 4] = ["cube.off", "cube.off", "--moving-pose", "-3,0.25,-0.5"];
/// Two cubes that overlap by 0.25 along x.
const DEEP: [&str; 4] = ["cube.off", "cube.off", "--moving-pose", "-0.75,0.25,-0.5"];
/// A cube that overlaps such a body by 0.1 along x.
const DENTED: [&str; 4] = ["cube.off", "dent.off", "--moving-pose", "0.9,0,0"];
/// A cube above the tip of the dent of a body that is not convex.
const PARTS: [&str; 4] = ["cube.off", "dent.off", "--moving-pose", "0,0,3"];

fn ask(command: &str, bodies: &[&str], more: &[&str]) -> Value {
    ask_in(folder().path(), command, bodies, more)
}

fn ask_in(folder: &Path, command: &str, bodies: &[&str], more: &[&str]) -> Value {
    read(&answered(folder, &[&[command], bodies, more, &["--json"]].concat()))
}

fn number(value: &Value, name: &str) -> f64 {
    value[name].as_f64().unwrap_or_else(|| panic!("{name}: {value}"))
}

#[test]
fn distance_has_bounds_points_and_features() {
    let told = ask("distance", &APART, &[]);
    assert_eq!(told["outcome"], "apart");
    assert!(number(&told, "lower") <= 2.0 && number(&told, "upper") >= 2.0, "{told}");
    assert!(number(&told, "upper") - number(&told, "lower") < 1e-13);
    assert_eq!(told["normal"], json!([1.0, 0.0, 0.0]));
    assert_eq!((&told["points"][0][0], &told["points"][1][0]), (&json!(-2.0), &json!(0.0)));
    assert_eq!(told["features"]["moving"]["kind"], "face");
    assert!(number(&told["steps"], "supports") > 0.0, "{told}");
    let told = ask("distance", &PARTS, &[]);
    assert!(number(&told, "lower") <= 2.0 && number(&told, "upper") >= 2.0, "{told}");
    // Answers for parts have no steps.
    assert!(told.get("steps").is_none(), "{told}");
    assert_eq!((&told["moving"], &told["fixed"]), (&json!("cube.off"), &json!("dent.off")));
    let told = ask("distance", &DEEP, &[]);
    assert!(told["outcome"] == "meeting" && number(&told, "upper") < 1e-13, "{told}");
    let askew =
        ["cube.off", "cube.off", "--moving-pose", "-0.6,0.3,0.2", "--moving-rpy", "20,30,40"];
    let told = ask("distance", &askew, &[]);
    assert_eq!((&told["outcome"], number(&told, "upper")), (&json!("meeting"), 0.0));
}

#[test]
fn depth_has_bounds_and_direction() {
    let told = ask("depth", &DEEP, &[]);
    assert_eq!(told["outcome"], "overlapping");
    assert!(number(&told, "lower") <= 0.25 && number(&told, "upper") >= 0.25, "{told}");
    assert_eq!(told["direction"], json!([-1.0, 0.0, 0.0]));
    let mut apart = ask("depth", &APART, &[]);
    assert!(number(&apart["steps"].take(), "supports") > 0.0, "{apart}");
    assert_eq!(apart, json!({"outcome": "apart", "lower": 0.0, "upper": 0.0, "steps": null}));
    // For parts also the least tolerance, as for a clearance, and the translation.
    let told = ask("depth", &DENTED, &[]);
    let tolerance = number(&told["start_overlaps"][0], "least_tolerance");
    assert!((tolerance - 0.1).abs() < 1e-6, "{told}");
    let [lower, upper] = ["lower", "upper"].map(|bound| number(&told, bound));
    assert!(lower <= 0.1 && 0.1 <= upper && upper - lower < 1e-9, "{told}");
    let way: [f64; 3] = serde_json::from_value(told["separating_translation"].clone()).unwrap();
    assert!((way[0] - 0.1).abs() < 1e-9 && way[1..] == [0.0; 2], "{told}");
    // A part inside another one has a depth, but no tolerance.
    let folder = folder();
    let grain =
        "OFF\n4 4 0\n0 0 0\n0.1 0 0\n0 0.1 0\n0 0 0.1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n";
    std::fs::write(folder.path().join("grain.off"), grain).unwrap();
    let inside = ["grain.off", "dent.off", "--moving-pose", "0.5,0.5,0.25"];
    let told = ask_in(folder.path(), "depth", &inside, &[]);
    assert_eq!(told["start_overlaps"][0]["least_tolerance"], json!(null), "{told}");
    assert!(number(&told, "lower") > 0.0 && number(&told, "upper") < 1.0, "{told}");
    // An open surface has none.
    let told = ask("depth", &["open.off", "cube.off", "--moving-pose", "0,0,0.5"], &["--open"]);
    assert!(told["outcome"] == "overlapping" && told.get("upper").is_none(), "{told}");
    assert_eq!(ask("depth", &PARTS, &[])["outcome"], "apart");
    let touching = ["cube.off", "dent.off", "--moving-pose", "1,0,0"];
    assert_eq!(ask("depth", &touching, &[])["outcome"], "touching");
}

#[test]
fn within_compares_the_distance_with_a_length() {
    for bodies in [APART, PARTS] {
        let told = ask("within", &bodies, &["--length", "2.5"]);
        assert!(told["outcome"] == "closer" && number(&told, "upper") <= 2.5, "{told}");
        assert_eq!(told.get("steps").is_some(), bodies == APART, "{told}");
        let told = ask("within", &bodies, &["--length", "1.5"]);
        assert!(told["outcome"] == "farther" && number(&told, "lower") > 1.5, "{told}");
        let told = ask("within", &bodies, &["--length", "2"]);
        assert!(told["outcome"] == "undecided" && number(&told, "lower") <= 2.0, "{told}");
    }
}

#[test]
fn answers_are_printed_as_text() {
    let folder = folder();
    for (words, said) in [
        (&[&["distance"], &APART[..]].concat(), "distance     2\n"),
        (&[&["distance"], &DEEP[..]].concat(), "meeting: the bodies touch or overlap"),
        (&[&["depth"], &DEEP[..]].concat(), "direction    -1,0,0, for the moving body"),
        (&[&["depth"], &APART[..]].concat(), "apart: the bodies have no common point"),
        (&[&["depth"], &DENTED[..]].concat(), "0,0 of the moving body separates them"),
        (
            &[&["within"], &APART[..], &["--length", "3"]].concat(),
            "closer: the bodies are no farther apart than 3",
        ),
        (&[&["distance"], &PARTS[..]].concat(), "face of vertices 3 2 1 0 of cube.off"),
    ] {
        let text = answered(folder.path(), words);
        assert!(text.contains(said), "{said:?} is not in {text}");
    }
    let hulls = ["distance", "cube.off", "dent.off", "--hull", "--moving-pose", "0,0,3"];
    let text = answered(folder.path(), &hulls);
    assert!(text.contains("no nearer to each other, perhaps farther"), "{text}");
}

#[test]
fn saved_proofs_hold_in_both_checkers() {
    let folder = folder();
    let folder = folder.path();
    let within = |length| ["--length", length];
    for (command, bodies, more, said) in [
        ("distance", &APART, &[][..], "the bodies are between 1.99"),
        ("distance", &DEEP, &[], "the bodies have a point in common"),
        ("distance", &PARTS, &[], "the bodies are between 1.99"),
        ("depth", &DEEP, &[], "a translation of the moving body by 0.25"),
        ("depth", &APART, &[], "the bodies do not overlap"),
        ("depth", &DENTED, &[], "the bodies are apart after a translation of at most 0.1"),
        ("depth", &DENTED, &["--common-part"], "no body contains the other, the common part"),
        ("depth", &DEEP, &["--common-part"], "no body contains the other, the common part"),
        ("depth", &APART, &["--common-part"], "the interiors have no common point"),
        ("within", &APART, &within("9"), "the bodies are at most "),
        ("within", &APART, &within("1"), "the bodies are at least "),
        ("within", &PARTS, &within("9"), "the bodies are at most "),
        ("within", &PARTS, &within("1"), "the bodies are between 1.99"),
    ] {
        saved(folder, &[&[command], &bodies[..], more].concat());
        let text = answered(folder, &["verify", "proof.json"]);
        assert!(text.starts_with(&format!("holds: {said}")), "{text}");
        // The checker in fractions does not use the covers of parts.
        let has_cover = bodies == &DENTED && more.is_empty();
        let is_part = has_cover || bodies == &PARTS && said.contains("between");
        checked_in_fractions(folder, if is_part { 7 } else { 0 });
    }
    // The answer with a proof has the same bits.
    for (bodies, more) in [(&PARTS, &[][..]), (&PARTS, &within("1")), (&DEEP, &[])] {
        let command = if more.is_empty() { "distance" } else { "within" };
        let with =
            ask_in(folder, command, bodies, &[more, &["--save-proof", "proof.json"]].concat());
        assert_eq!(ask(command, bodies, more), with);
    }
}

#[test]
fn pictures_show_the_shortest_way() {
    let folder = folder();
    let folder = folder.path();
    for (command, bodies, said) in [
        ("distance", &APART, "distance 2"),
        ("distance", &PARTS, "distance 2"),
        ("depth", &DEEP, "depth 0.25"),
    ] {
        answered(folder, &[&[command], &bodies[..], &["--picture", "a.svg"]].concat());
        let picture = std::fs::read_to_string(folder.join("a.svg")).unwrap();
        assert!(picture.contains(said) && !picture.contains("NaN"), "{picture}");
    }
    // A point at a large distance from a segment.
    std::fs::write(folder.join("point.off"), "OFF\n1 0 0\n0 0 0\n").unwrap();
    std::fs::write(folder.join("segment.off"), "OFF\n2 0 0\n0 0 0\n1 1 1\n").unwrap();
    let bodies = ["point.off", "segment.off", "--hull", "--moving-pose", "0,0,1e6"];
    answered(folder, &[&["distance"], &bodies[..], &["--picture", "a.svg"]].concat());
    let picture = std::fs::read_to_string(folder.join("a.svg")).unwrap();
    assert!(picture.contains("distance 999999") && !picture.contains("NaN"), "{picture}");
}

#[test]
fn invalid_distance_arguments_are_rejected() {
    let folder = folder();
    let folder = folder.path();
    let within = |length| ["within", "cube.off", "cube.off", "--length", length];
    refused(folder, &within("-1"), 2, &["--length", "not negative"]);
    refused(folder, &within("nan"), 2, &["--length", "finite"]);
    refused(folder, &within("inf"), 2, &["--length", "finite"]);
    refused(folder, &within("two"), 2, &["--length"]);
    refused(folder, &["within", "cube.off", "cube.off"], 2, &["--length <L>"]);
    refused(folder, &["distance", "cube.off"], 2, &["fixed meshes with --from"]);
    refused(
        folder,
        &["distance", "cube.off", "cube.off", "cube.off"],
        2,
        &["3 meshes given, expected two"],
    );
    refused(folder, &["distance", "cube.off", "none.off"], 3, &["none.off: cannot be read"]);
    refused(folder, &["distance", "cube.off", "broken.off"], 3, &["broken.off"]);
    refused(folder, &["distance", "cube.off", "open.off"], 3, &["open.off", "--open"]);
    refused(folder, &["distance", "cube.off", "cube.off", "--direction", "x"], 2, &["--direction"]);
    refused(
        folder,
        &["depth", "cube.off", "dent.off", "--hull", "--open"],
        2,
        &["--hull", "--open"],
    );
    let without = ["depth", "cube.off", "dent.off", "--common-part"];
    refused(folder, &without, 2, &["--save-proof"]);
    let hull =
        ["depth", "cube.off", "cube.off", "--common-part", "--save-proof", "p.json", "--hull"];
    refused(folder, &hull, 2, &["--hull", "--common-part"]);
    let over = ["distance", "cube.off", "cube.off", "--save-proof", "cube.off"];
    refused(folder, &over, 3, &["is the same file"]);
    let nan = ["distance", "cube.off", "cube.off", "--moving-pose", "nan,0,0"];
    refused(folder, &nan, 2, &["--moving-pose"]);
}

#[test]
fn batch_answers_equal_those_of_the_commands() {
    let folder = folder();
    let cube = r#"{"mesh":"cube.off"}"#;
    let line = |query: &str, fixed: &str, pose: &str| {
        format!(
            r#"{{"moving":{cube},"fixed":{fixed},"moving_pose":{{"translation":{pose}}},"query":{query}}}"#
        )
    };
    let dent = r#"{"solid":"dent.off"}"#;
    let asked = [
        (line(r#""distance""#, cube, "[-3,0.25,-0.5]"), ask("distance", &APART, &[])),
        (line(r#""depth""#, cube, "[-0.75,0.25,-0.5]"), ask("depth", &DEEP, &[])),
        (line(r#""distance""#, dent, "[0,0,3]"), ask("distance", &PARTS, &[])),
        (
            line(r#""within","length":1.5"#, dent, "[0,0,3]"),
            ask("within", &PARTS, &["--length", "1.5"]),
        ),
        (
            line(r#""depth""#, dent, "[0.9,0,0]"),
            ask("depth", &["cube.off", "dent.off", "--moving-pose", "0.9,0,0"], &[]),
        ),
    ];
    let lines: Vec<&str> = asked.iter().map(|(line, _)| line.as_str()).collect();
    std::fs::write(folder.path().join("q.jsonl"), lines.join("\n")).unwrap();
    let told = answered(folder.path(), &["batch", "q.jsonl"]);
    for (line, (_, alone)) in told.lines().zip(&asked) {
        let (mut told, mut alone) = (read(line), alone.clone());
        for answer in [&mut told, &mut alone] {
            // Only the commands report names of files.
            let fields = answer.as_object_mut().unwrap();
            fields.retain(|name, _| !["id", "moving", "fixed"].contains(&name.as_str()));
            if let Some(overlap) = fields.get_mut("start_overlaps") {
                overlap[0].as_object_mut().unwrap().retain(|name, _| name == "least_tolerance");
            }
        }
        assert_eq!(told, alone);
    }
}

#[test]
fn fields_of_other_queries_are_rejected() {
    let folder = folder();
    let bodies = r#""moving":{"mesh":"cube.off"},"fixed":{"mesh":"cube.off"}"#;
    let wrong = [
        (r#""query":"within""#, "needs a `length`"),
        (r#""query":"within","length":-1"#, "the length -1 is negative"),
        (r#""query":"distance","length":1"#, r#"`length` requires "query": "within""#),
        (r#""query":"distance","direction":[1,0,0]"#, "`direction` does not belong to this query"),
        (r#""query":"depth","tolerance":0"#, "`tolerance` does not belong to this query"),
        (r#""direction":[1,0,0],"length":1"#, r#"`length` requires "query": "within""#),
        (r#""query":"contact""#, "missing field `direction`"),
        (r#""query":"far""#, "within"),
    ];
    let lines: Vec<String> = wrong.iter().map(|(more, _)| format!("{{{bodies},{more}}}")).collect();
    std::fs::write(folder.path().join("q.jsonl"), lines.join("\n")).unwrap();
    let output = run(folder.path(), &["batch", "q.jsonl"]);
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    for (line, (more, said)) in stdout(&output).lines().zip(wrong) {
        let told = read(line);
        let message = told["message"].as_str().unwrap();
        assert!(told["outcome"] == "error" && message.contains(said), "{more}: {message}");
    }
    colltrans(folder.path()).args(["distance", "--help"]).assert().success();
}

#[test]
fn points_dropped_by_a_hull_are_reported() {
    let folder = folder();
    let folder = folder.path();
    let near = "OFF\n5 3 0\n0 0 0\n1 0 0\n0.5 1e-16 0\n0 1 0\n1 1 1\n3 0 1 3\n3 1 4 3\n3 0 2 4\n";
    std::fs::write(folder.join("near.off"), near).unwrap();
    let ask =
        ["within", "near.off", "cube.off", "--hull", "--moving-pose", "9,0,0", "--length", "3"];
    let text = answered(folder, &ask);
    let told = "except for   points of the moving part itself";
    assert_eq!(text.contains(told), text.contains("proven for"), "{text}");
}
