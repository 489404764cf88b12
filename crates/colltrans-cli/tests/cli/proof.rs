//! `--save-proof` and `colltrans verify`.

use colltrans_testkit::TemporaryFolder;
use std::fs;
use std::path::Path;
use std::process::Command;

use serde_json::{Value, json};

use crate::support::{CAST, answered, data, folder, json as read, refused, run, stderr, stdout};

/// Asserts that the checker in fractions accepts `proof.json`, if there is a Python. Code 7 means a partial check.
pub(crate) fn checked_in_fractions(folder: &Path, code: i32) {
    let checker = data().join("../python/src/colltrans/check.py");
    let mut python = Command::new("python3");
    python.args(["-I", "-S"]).arg(checker).arg("proof.json").current_dir(folder);
    let Ok(output) = python.output() else { return };
    assert_eq!(output.status.code(), Some(code), "{}", stderr(&output));
    assert!(stdout(&output).starts_with("holds: "), "{}", stdout(&output));
}

/// Runs a command with `--save-proof`. Returns the proof.
pub(crate) fn saved(folder: &Path, arguments: &[&str]) -> Value {
    let mut all = arguments.to_vec();
    all.extend(["--save-proof", "proof.json"]);
    answered(folder, &all);
    read(&fs::read_to_string(folder.join("proof.json")).unwrap())
}

/// The proofs that the tests of `check.py` use.
#[test]
fn proofs_of_the_python_tests_hold() {
    let saved = fs::read_dir(data().join("../python/tests/proofs")).unwrap();
    for file in saved.map(|file| file.unwrap().path()) {
        let output = run(Path::new("."), &["verify", file.to_str().unwrap()]);
        assert_eq!(output.status.code(), Some(0), "{}: {}", file.display(), stderr(&output));
    }
}

#[test]
fn saved_proof_holds_and_prints_one_line() {
    let folder = folder();
    let folder = folder.path();
    let pair = |command, y| {
        let pose = format!("-3,{y},-0.5");
        [command, "cube.off", "cube.off", "--direction", "x", "--moving-pose"]
            .map(str::to_owned)
            .into_iter()
            .chain([pose])
            .collect::<Vec<_>>()
    };
    for (command, y, said, field) in [
        ("cast", "0.25", "the bodies meet from a translation between 1.9", "exit_bounds"),
        ("cast", "3", "the bodies never meet along the direction", "margin"),
        (
            "clearance",
            "0.25",
            "the bodies first meet at a translation between 1.9",
            "translation_bounds",
        ),
        ("clearance", "1", "the bodies slide along each other, their shadows overlap", "overlap"),
    ] {
        let arguments = pair(command, y);
        let plain = answered(folder, &arguments.iter().map(String::as_str).collect::<Vec<_>>());
        let mut all: Vec<&str> = arguments.iter().map(String::as_str).collect();
        all.extend(["--save-proof", "proof.json"]);
        assert_eq!(answered(folder, &all), plain, "the answer is the same");
        let text = answered(folder, &["verify", "proof.json"]);
        assert!(text.starts_with(&format!("holds: {said}")), "{text}");
        assert_eq!(text.lines().count(), 1);
        let told = read(&answered(folder, &["verify", "proof.json", "--json"]));
        assert!(told["holds"] == true && told.get(field).is_some(), "{told}");
        checked_in_fractions(folder, 0);
    }
}

#[test]
fn proof_of_a_solid_clearance_holds() {
    let folder = folder();
    let folder = folder.path();
    let clear = ["clear", "dent.off", "--from", "cube.off", "dent.off", "--direction", "-z"];
    for (pose, said) in [
        ("0,0,5", "stops the moving one before a translation of 3.99999"),
        ("5,0,5", "nothing ever stops the moving one"),
        ("0.2,0.1,0.3", "the bodies overlap where they are"),
    ] {
        let mut all = clear.to_vec();
        all.extend(["--moving-pose", pose]);
        saved(folder, &all);
        let text = answered(folder, &["verify", "proof.json"]);
        assert!(text.contains(said), "{text}");
    }
}

#[test]
fn inverted_facets_of_offset_bodies_are_reported() {
    let folder = folder();
    let folder = folder.path();
    // The wall between the tip of the dent and the bottom is 0.75 thick.
    let clear = ["clear", "dent.off", "--from", "cube.off", "--direction", "-z", "--moving-pose"];
    for (tolerance, inside_out) in [("0.5", false), ("0.9", true)] {
        let mut all = clear.to_vec();
        all.extend(["0,0,3000", "--tolerance", tolerance]);
        saved(folder, &all);
        let text = answered(folder, &["verify", "proof.json"]);
        assert_eq!(text.contains("are inside out"), inside_out, "{text}");
        let told = read(&answered(folder, &["verify", "proof.json", "--json"]));
        assert_eq!(told.get("inverted").is_some(), inside_out, "{told}");
    }
}

#[test]
fn changed_proof_returns_exit_code_6() {
    let folder = folder();
    let folder = folder.path();
    let file = saved(folder, &CAST);
    let mut wrong = file.clone();
    let lower = wrong.pointer_mut("/statement/contacts/first/lower").unwrap();
    *lower = json!(lower.as_f64().unwrap() + 1e-6);
    fs::write(folder.join("wrong.json"), wrong.to_string()).unwrap();
    refused(folder, &["verify", "wrong.json"], 6, &["wrong.json: the proof does not hold"]);
    let output = run(folder, &["verify", "wrong.json", "--json"]);
    assert_eq!(output.status.code(), Some(6), "{}", stderr(&output));
    assert_eq!(read(&stdout(&output))["holds"], false);
}

#[test]
fn files_without_a_proof_are_rejected() {
    let folder = folder();
    let folder = folder.path();
    let text = saved(folder, &CAST).to_string();
    fs::write(folder.join("half.json"), &text[..text.len() / 2]).unwrap();
    refused(
        folder,
        &["verify", "half.json"],
        3,
        &["half.json: not a saved proof", "ends too early"],
    );
    refused(folder, &["verify", "cube.off"], 3, &["cube.off: not a saved proof", "it is not JSON"]);
    refused(folder, &["verify", "none.json"], 3, &["none.json: cannot be read"]);
    refused(folder, &["verify"], 2, &["PROOF.json"]);
    refused(folder, &["verify", "half.json", "--search"], 2, &["--search"]);
    let with = |more: &[&'static str]| [&CAST[..], more].concat();
    refused(folder, &with(&["--save-proof", "cube.off"]), 3, &["is the same file", "another name"]);
    let one = with(&["--save-proof", "a.svg", "--picture", "a.svg"]);
    refused(folder, &one, 2, &["--save-proof and --picture name the same file"]);
    let many = ["cast", "cube.off", "cube.off", "--directions", "-", "--save-proof", "a.json"];
    refused(folder, &many, 2, &["--directions"]);
}

#[test]
fn clearance_of_example_parts_has_a_proof() {
    let folder = TemporaryFolder::new();
    let part = |name: &str| data().join("gearbox_small").join(name).display().to_string();
    let (cover, housing, gear) = (part("cover.off"), part("housing.off"), part("gear.off"));
    saved(folder.path(), &["clear", &cover, "--from", &housing, &gear, "--direction", "1,0.1,0"]);
    answered(folder.path(), &["verify", "proof.json"]);
}
