//! The program: what can be asked for, and where the results go.

use std::path::Path;
use std::process::Output;

use assert_cmd::Command;

fn lab(folder: &Path) -> Command {
    let mut command = Command::cargo_bin("colltrans-lab").unwrap();
    command.current_dir(folder);
    command
}

fn stdout(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).unwrap()
}

fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

#[test]
fn help_says_what_there_is() {
    let folder = tempfile::tempdir().unwrap();
    let help = |arguments: &[&str]| {
        let output = lab(folder.path()).args(arguments).output().unwrap();
        assert_eq!(output.status.code(), Some(0), "{arguments:?}: {}", stderr(&output));
        stdout(&output)
    };
    for word in ["figure", "table", "beyond", "all", "report.html", "Exit codes"] {
        assert!(help(&["--help"]).contains(word), "{word}");
    }
    for what in ["figure", "table", "beyond", "all"] {
        let text = help(&[what, "--help"]);
        for word in ["--quick", "--full", "--seed", "--parts", "--output", "[default: lab-results]"]
        {
            assert!(text.contains(word), "{what}: {word}");
        }
        assert!(!text.contains("--tiny"), "{what}: for tests only");
    }
    for experiment in colltrans_lab::experiments() {
        let Some((kind, number)) = experiment.id.split_once('-') else { continue };
        let text = help(&[kind, "--help"]);
        assert!(text.contains(number) && text.contains(experiment.title), "{}", experiment.id);
    }
}

#[test]
fn what_there_is_not() {
    let folder = tempfile::tempdir().unwrap();
    for arguments in [
        &["figure", "10"][..],
        &["figure", "twelve"],
        &["figure"],
        &["table", "2"],
        &["table"],
        &[],
        &["all", "12"],
        &["all", "--quick", "--full"],
        &["all", "--seed", "-1"],
        &["beyond", "--parts", "nowhere"],
    ] {
        let output = lab(folder.path()).args(arguments).output().unwrap();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {}", stderr(&output));
        assert!(!folder.path().join("lab-results").exists(), "{arguments:?}");
        if arguments == ["figure", "10"] {
            for experiment in colltrans_lab::experiments() {
                let number = experiment.id.strip_prefix("figure-").unwrap_or("");
                assert!(stderr(&output).contains(number), "{}", stderr(&output));
            }
        }
    }
}

#[test]
fn folders_that_cannot_be_written_to() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("file"), "").unwrap();
    let output = lab(folder.path()).args(["all", "--tiny", "-o", "file/results"]).output().unwrap();
    assert_eq!(output.status.code(), Some(5), "{}", stderr(&output));
    assert!(stderr(&output).starts_with("error: file/results: the folder cannot be made: "));
    assert_eq!(stdout(&output), "");
}
