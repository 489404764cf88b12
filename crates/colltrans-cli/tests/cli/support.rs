//! Runs the program in folders with small mesh files.

use std::path::{Path, PathBuf};
use std::process::Output;

use assert_cmd::Command;
use colltrans_testkit::TemporaryFolder;
use serde_json::Value;

/// Returns the program with a current folder.
pub(crate) fn colltrans(folder: &Path) -> Command {
    let mut command = Command::cargo_bin("colltrans").unwrap();
    command.current_dir(folder);
    command
}

/// Runs the program.
pub(crate) fn run(folder: &Path, arguments: &[&str]) -> Output {
    colltrans(folder).args(arguments).output().unwrap()
}

/// Runs the program, asserts success, and returns its output.
pub(crate) fn answered(folder: &Path, arguments: &[&str]) -> String {
    let output = run(folder, arguments);
    assert_eq!(output.status.code(), Some(0), "{arguments:?}: {}", stderr(&output));
    stdout(&output)
}

/// Runs the program, and asserts its exit code, an empty output and words of its message.
pub(crate) fn refused(folder: &Path, arguments: &[&str], code: i32, words: &[&str]) {
    let output = run(folder, arguments);
    let message = stderr(&output);
    assert_eq!(output.status.code(), Some(code), "{arguments:?}: {message}");
    assert!(stdout(&output).is_empty());
    for word in words {
        assert!(message.contains(word), "{word:?} is not in {message}");
    }
}

/// Returns a folder with a unit cube (`cube.off`), a body that is not convex (`dent.off`), an open one
/// (`open.off`), a broken file (`broken.off`) and a point cloud (`points.ply`).
pub(crate) fn folder() -> TemporaryFolder {
    let folder = TemporaryFolder::new();
    let cube = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n1 0 1\n1 1 1\n0 1 1\n";
    let sides = "4 0 1 5 4\n4 1 2 6 5\n4 2 3 7 6\n4 3 0 4 7\n";
    let write = |name: &str, text: String| std::fs::write(folder.path().join(name), text).unwrap();
    write("cube.off", format!("OFF\n8 6 12\n{cube}4 3 2 1 0\n4 4 5 6 7\n{sides}"));
    write("open.off", format!("OFF\n8 5 12\n{cube}4 3 2 1 0\n{sides}"));
    let lid = "3 4 5 8\n3 5 6 8\n3 6 7 8\n3 7 4 8\n";
    write("dent.off", format!("OFF\n9 9 0\n{cube}0.5 0.5 0.75\n4 3 2 1 0\n{lid}{sides}"));
    write("broken.off", format!("OFF\n8 6 12\n{cube}4 3 2 1 0\n4 4 5 6 zero\n{sides}"));
    let header = "ply\nformat ascii 1.0\nelement vertex 8\nproperty double x\nproperty double y\n\
        property double z\nend_header\n";
    write("points.ply", format!("{header}{cube}"));
    folder
}

/// Two unit cubes with centers at a distance of 3 along x, offset along y and z: contact after 2.
pub(crate) const CAST: [&str; 7] =
    ["cast", "cube.off", "cube.off", "--direction", "1,0,0", "--moving-pose", "-3,0.25,-0.5"];

/// The fields of a contact as JSON, in order.
pub(crate) const CONTACT_FIELDS: [&str; 11] = [
    "exit",
    "exit_bounds",
    "features",
    "normal",
    "outcome",
    "point",
    "rounding",
    "solver",
    "steps",
    "translation",
    "translation_bounds",
];

/// Returns the names of an object's fields, sorted.
pub(crate) fn fields(value: &Value) -> Vec<&str> {
    let mut names: Vec<&str> = value.as_object().unwrap().keys().map(String::as_str).collect();
    names.sort_unstable();
    names
}

/// Returns the names of an object's fields without some that must be present.
pub(crate) fn fields_without<'a>(value: &'a Value, others: &[&str]) -> Vec<&'a str> {
    let names = fields(value);
    assert!(others.iter().all(|name| names.contains(name)), "{value}");
    names.into_iter().filter(|name| !others.contains(name)).collect()
}

pub(crate) fn stdout(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).unwrap()
}

pub(crate) fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

pub(crate) fn json(text: &str) -> Value {
    serde_json::from_str(text).unwrap_or_else(|e| panic!("{e}: {text}"))
}

/// Returns the folder of the example parts.
pub(crate) fn data() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data")
}
