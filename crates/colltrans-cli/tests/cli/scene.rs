//! Queries with a scene (`--scene`), their proofs, and invalid scenes.

use serde_json::{Value, json};

use crate::proof::{checked_in_fractions, saved};
use crate::support::{answered, folder, json as read, refused, run, stderr, stdout};

/// Writes a scene: a row of cubes at distances of 2, a body that is not convex, and points without a name.
fn scene(folder: &std::path::Path) {
    let cube = |k: usize| {
        format!(
            r#"{{"body":{{"mesh":"cube.off"}},"pose":{{"translation":[{},0,0]}},"name":"cube {k}"}}"#,
            2 * k
        )
    };
    let mut lines: Vec<String> = (0..20).map(cube).collect();
    lines.push(r#"{"body":{"solid":"dent.off"},"pose":{"translation":[0,40,0]}}"#.to_owned());
    lines.push(String::new());
    lines.push(r#"{"body":{"points":[[0,90,0],[1,90,0],[0,91,0],[0,90,1]]}}"#.to_owned());
    std::fs::write(folder.join("scene.jsonl"), lines.join("\n")).unwrap();
}

const ABOVE: [&str; 5] = ["cube.off", "--scene", "scene.jsonl", "--moving-pose", "24.25,0,4"];

fn number(value: &Value, name: &str) -> f64 {
    value[name].as_f64().unwrap_or_else(|| panic!("{name}: {value}"))
}

#[test]
fn scene_queries_find_nearest_near_and_first_obstacles() {
    let folder = folder();
    let folder = folder.path();
    scene(folder);
    let ask = |command: &str, more: &[&str]| {
        read(&answered(folder, &[&[command], &ABOVE[..], more, &["--json"]].concat()))
    };
    let told = ask("distance", &[]);
    assert_eq!((&told["obstacle"], &told["fixed"]), (&json!(12), &json!("cube 12")));
    assert_eq!((&told["obstacles"], &told["outcome"]), (&json!(22), &json!("apart")));
    assert!(number(&told, "lower") <= 3.0 && number(&told, "upper") >= 3.0, "{told}");
    let told = ask("within", &["--length", "3.2"]);
    let names = |list: &Value| -> Vec<Value> {
        list.as_array().unwrap().iter().map(|one| one["fixed"].clone()).collect()
    };
    assert_eq!(names(&told["closer"]), ["cube 12", "cube 13"]);
    assert_eq!(ask("within", &["--length", "3"])["undecided"][0]["obstacle"], 12);
    assert_eq!(ask("within", &["--length", "1"])["outcome"], "farther");
    let down = ask("clearance", &["--direction", "-z"]);
    assert_eq!((&down["outcome"], &down["fixed"]), (&json!("blocked"), &json!("cube 12")));
    assert!(number(&down, "distance") <= 3.0 && number(&down, "distance") > 2.999, "{down}");
    let kept = ask("clearance", &["--direction", "-z", "--min-gap", "0.5"]);
    assert!((number(&kept, "distance") - 2.5).abs() < 1e-9 && kept["min_gap"] == 0.5, "{kept}");
    assert_eq!(ask("clearance", &["--direction", "z"])["outcome"], "free");
    // The body that is not convex is named by its file, the points by their line.
    let place = |pose: &str| {
        let asked = ["distance", "cube.off", "--scene", "scene.jsonl", "--json", "--moving-pose"];
        read(&answered(folder, &[&asked[..], &[pose]].concat()))
    };
    assert_eq!(place("0,40,5")["fixed"], "dent.off");
    assert_eq!(place("0,95,0")["fixed"], "line 23");
    // Meshes in place, and a file of obstacles.
    let meshes =
        ["distance", "cube.off", "--scene", "cube.off", "dent.off", "scene.jsonl", "--json"];
    let told = read(&answered(folder, &[&meshes[..], &["--moving-pose", "2.2,0,3"]].concat()));
    assert_eq!((&told["fixed"], &told["obstacle"]), (&json!("cube 1"), &json!(3)));
    assert_eq!(told["obstacles"], 24);
}

#[test]
fn scene_answers_are_printed_as_text() {
    let folder = folder();
    let folder = folder.path();
    scene(folder);
    for (command, more, said) in [
        ("distance", &[][..], "apart\n  nearest      cube 12, number 12 of 22, counted from 0\n"),
        ("within", &["--length", "3.2"], "closer: 2 of 22 are no farther away than 3.2\n"),
        ("within", &["--length", "1"], "farther: all of 22 are farther away than 1\n"),
        ("clearance", &["--direction", "-z"], "blocked\n  by           cube 12, number 12 of 22"),
        ("clearance", &["--direction", "z"], "free: none of 22 stops the body"),
        ("clearance", &["--direction", "-z", "--tolerance", "0.01"], "0.01 (as given"),
    ] {
        let text = answered(folder, &[&[command], &ABOVE[..], more].concat());
        assert!(text.contains(said), "{said:?} is not in {text}");
    }
    let inside = ["clearance", "cube.off", "--scene", "scene.jsonl", "--direction", "x"];
    let text = answered(folder, &[&inside[..], &["--moving-pose", "4.5,0,0"]].concat());
    assert!(text.starts_with("overlapping") && text.contains("cube 2, number 2"), "{text}");
}

#[test]
fn scene_proofs_hold_in_both_checkers() {
    let folder = folder();
    let folder = folder.path();
    scene(folder);
    let near_dent = ["cube.off", "--scene", "scene.jsonl", "--moving-pose", "0.1,40,5"];
    for (command, bodies, more, said, code) in [
        ("distance", &ABOVE, &[][..], "of 22 obstacles, obstacle 12 is at most 3.0", 0),
        ("within", &ABOVE, &["--length", "3.2"], "2 (12, 13) are at most 3.2 away", 0),
        ("within", &ABOVE, &["--length", "1"], "none is at most 1.0 away, all others", 0),
        ("clearance", &ABOVE, &["--direction", "-z"], "obstacle 12 does by 3.0", 0),
        ("clearance", &ABOVE, &["--direction", "z"], "none ever stops the moving body", 0),
        ("clearance", &ABOVE, &["--direction", "x"], "none ever stops the moving body", 0),
        ("distance", &near_dent, &[], "obstacle 20 is at most 4.0", 7),
        ("clearance", &near_dent, &["--direction", "-z"], "obstacle 20 does by ", 7),
    ] {
        let file = saved(folder, &[&[command], &bodies[..], more].concat());
        assert_eq!(file["placement"]["poses"].as_array().unwrap().len(), 23);
        assert_eq!(file["bodies"].as_array().unwrap().len(), 4, "a body is written once");
        let text = answered(folder, &["verify", "proof.json"]);
        assert!(text.starts_with("holds: ") && text.contains(said), "{said:?} is not in {text}");
        let told = read(&answered(folder, &["verify", "proof.json", "--json"]));
        assert_eq!((&told["holds"], &told["obstacles"]), (&json!(true), &json!(22)));
        checked_in_fractions(folder, code);
        // An obstacle is moved to the place of the moving body.
        let mut changed = file;
        let places = &mut changed["placement"]["poses"];
        places[2]["pose"] = places[0]["pose"].clone();
        std::fs::write(folder.join("proof.json"), changed.to_string()).unwrap();
        let output = run(folder, &["verify", "proof.json"]);
        assert_eq!(output.status.code(), Some(6), "{}", stdout(&output));
    }
}

#[test]
fn invalid_scene_arguments_are_rejected() {
    let folder = folder();
    let folder = folder.path();
    scene(folder);
    let among = |command: &'static str, more: &[&'static str]| {
        [&[command, "cube.off", "--scene", "scene.jsonl"], more].concat()
    };
    refused(folder, &among("depth", &[]), 2, &["a depth needs two bodies"]);
    refused(folder, &among("distance", &["--from", "cube.off"]), 2, &["--from"]);
    refused(folder, &among("distance", &["--picture", "a.svg"]), 2, &["--picture"]);
    refused(folder, &among("distance", &["--fixed-pose", "1,0,0"]), 2, &["--fixed-pose"]);
    refused(folder, &among("clearance", &["--directions", "-"]), 2, &["one --direction"]);
    let three = ["distance", "cube.off", "dent.off", "open.off"];
    refused(folder, &three, 2, &["3 meshes given", "cube.off --scene dent.off open.off", "--from"]);
    let two = ["distance", "cube.off", "dent.off", "--scene", "scene.jsonl"];
    refused(folder, &two, 2, &["one mesh before --scene"]);
    refused(
        folder,
        &["distance", "cube.off", "scene.jsonl"],
        2,
        &["give files of obstacles to --scene"],
    );
    // Commands without scenes do not mention them.
    for command in ["directions", "depth"] {
        for bodies in
            [&["cube.off"][..], &["a.off", "b.off", "c.off"], &["cube.off", "scene.jsonl"]]
        {
            let output = run(folder, &[&[command], bodies].concat());
            assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
            let said = stderr(&output);
            assert!(
                !said.contains("--scene") && said.contains("colltrans ") | said.contains("--from"),
                "{said}"
            );
        }
    }
    let over = among("distance", &["--save-proof", "scene.jsonl"]);
    refused(folder, &over, 3, &["is the same file"]);
    for (line, said) in [
        ("", "contains no obstacles"),
        ("{", "line 1, column"),
        (r#"{"mesh":"cube.off"}"#, "unknown field `mesh`"),
        (r#"{"body":{"mesh":"dent.off"}}"#, r#""solid" instead of "mesh""#),
        (r#"{"body":{"mesh":"none.off"}}"#, "none.off: cannot be read"),
        (r#"{"body":{"mesh":"cube.off"},"pose":{"rotation":[1,1,1,1]}}"#, "line 1: pose: "),
    ] {
        std::fs::write(folder.join("bad.jsonl"), line).unwrap();
        refused(folder, &["distance", "cube.off", "--scene", "bad.jsonl"], 3, &["bad.jsonl", said]);
    }
}

#[test]
fn scene_pose_with_few_digits_is_normalised_with_a_note() {
    let folder = folder();
    let folder = folder.path();
    let line = r#"{"body":{"mesh":"cube.off"},"pose":{"translation":[4,0,0],"rotation":[0,0,0.707,0.707]}}"#;
    std::fs::write(folder.join("scene.jsonl"), format!("\n{line}\n")).unwrap();
    let output = run(folder, &["distance", "cube.off", "--scene", "scene.jsonl"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let note = "note: scene.jsonl: line 2: pose: the quaternion has length 0.999849, not 1; it was normalised";
    assert!(stderr(&output).starts_with(note), "{}", stderr(&output));
}

#[test]
fn unknown_options_suggest_their_command() {
    let folder = folder();
    let folder = folder.path();
    let two = |command, more: &[&'static str]| [&[command, "cube.off", "cube.off"], more].concat();
    let min_gap = ["--min-gap belongs to `colltrans clearance`, `colltrans cast`"];
    refused(folder, &two("distance", &["--min-gap", "0.5"]), 2, &min_gap);
    refused(folder, &two("cast", &["--length=3"]), 2, &["--length belongs to `colltrans within`"]);
    let third = two("cast", &["dent.off", "--direction", "x"]);
    refused(folder, &third, 2, &["colltrans clearance MOVING --scene"]);
    let unknown = stderr(&run(folder, &two("distance", &["--frm", "a"])));
    assert!(unknown.contains("similar argument exists: '--from'"), "{unknown}");
    refused(
        folder,
        &two("cast", &["--direction", "x", "--min-gap", "1e70"]),
        2,
        &["the minimum gap 1000"],
    );
}

/// Returns the exit code of the independent checker; `None` without a Python.
fn checked(folder: &std::path::Path, proof: &Value) -> Option<i32> {
    std::fs::write(folder.join("proof.json"), proof.to_string()).unwrap();
    let checker = crate::support::data().join("../python/src/colltrans/check.py");
    let mut python = std::process::Command::new("python3");
    python.args(["-I", "-S"]).arg(checker).arg("proof.json").current_dir(folder);
    python.output().ok().and_then(|output| output.status.code())
}

#[test]
fn forged_rounding_in_a_scene_proof_is_rejected() {
    let folder = folder();
    let folder = folder.path();
    let behind = r#"{"body":{"mesh":"cube.off"},"pose":{"translation":[-1,0,0]}}"#;
    std::fs::write(folder.join("behind.jsonl"), behind).unwrap();
    let ask = ["clearance", "cube.off", "--scene", "behind.jsonl", "--direction", "1,0,0"];
    let mut proof = saved(folder, &ask);
    assert!(checked(folder, &proof).is_none_or(|code| code == 0));
    // The obstacle is moved ahead, and forged bounds claim that it is behind to within rounding.
    proof["placement"]["poses"][1]["pose"]["translation"] = json!([3.0, 0.0, 0.0]);
    let free = &mut proof["statement"]["scene_clearance"]["passed"][0][1]["convex"]["free"];
    let certificate = &mut free["behind"]["certificate"];
    certificate["lower"] = json!(-1e3);
    certificate["rounding"] = json!(1e4);
    certificate["upper"] = Value::Null;
    assert!(checked(folder, &proof).is_none_or(|code| code == 6));
    assert_eq!(run(folder, &["verify", "proof.json"]).status.code(), Some(6));
}

#[test]
fn convex_proof_of_a_nonconvex_body_is_rejected() {
    let folder = folder();
    let folder = folder.path();
    scene(folder);
    let asked = ["distance", "cube.off", "--scene", "scene.jsonl", "--moving-pose", "0,40,5"];
    let mut proof = saved(folder, &asked);
    // Convex combinations of vertices may lie outside of a body that is not convex.
    let pairs: Vec<Value> = (0..4).map(|k| json!({ "moving": k, "fixed": k })).collect();
    let near = json!({ "convex": {
        "pairs": pairs, "weights": [0.25, 0.25, 0.25, 0.25], "distance": 100.0,
    }});
    proof["statement"] = json!({ "nearest": {
        "lower": 0.0, "obstacle": proof["statement"]["nearest"]["obstacle"], "near": near, "apart": [],
    }});
    assert!(checked(folder, &proof).is_none_or(|code| code == 6));
    assert_eq!(run(folder, &["verify", "proof.json"]).status.code(), Some(6));
    let segment = r#"{"body":{"points":[[0,0,9],[1,0,9]]}}"#;
    std::fs::write(folder.join("segment.jsonl"), segment).unwrap();
    let ask = ["distance", "dent.off", "--scene", "segment.jsonl", "--save-proof", "proof.json"];
    answered(folder, &ask);
    answered(folder, &["verify", "proof.json"]);
    answered(folder, &["within", "dent.off", "--scene", "segment.jsonl", "--length", "20"]);
    let ask = ["clearance", "dent.off", "--scene", "segment.jsonl", "--direction", "0,0,1"];
    answered(folder, &[&ask[..], &["--save-proof", "proof.json"]].concat());
    answered(folder, &["verify", "proof.json"]);
}

#[test]
fn graze_tolerance_is_reported() {
    let folder = folder();
    let folder = folder.path();
    let aside = r#"{"body":{"mesh":"cube.off"},"pose":{"translation":[3,0.75,0]}}"#;
    std::fs::write(folder.join("aside.jsonl"), aside).unwrap();
    let ask = ["clearance", "cube.off", "--scene", "aside.jsonl", "--direction", "1,0,0"];
    let graze = ["--graze-tolerance", "0.5", "--save-proof", "proof.json"];
    let text = answered(folder, &[&ask[..], &graze].concat());
    assert!(
        text.contains("obstacles that overlap sideways by no more than 0.5 do not block"),
        "{text}"
    );
    let text = answered(folder, &["verify", "proof.json"]);
    assert!(text.contains("passed where they overlap sideways by no more than 0.5"), "{text}");
}
