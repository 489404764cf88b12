//! The program: its options and its output.

use colltrans_testkit::TemporaryFolder;
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
fn help_lists_figures_and_tables() {
    let folder = TemporaryFolder::new();
    let help = |arguments: &[&str]| {
        let output = lab(folder.path()).args(arguments).output().unwrap();
        assert_eq!(output.status.code(), Some(0), "{arguments:?}: {}", stderr(&output));
        stdout(&output)
    };
    for word in ["section", "figure", "table", "beyond", "all", "report.html", "Exit codes"] {
        assert!(help(&["--help"]).contains(word), "{word}");
    }
    for what in ["section", "figure", "table", "beyond", "casts", "all"] {
        let text = help(&[what, "--help"]);
        for word in ["--quick", "--full", "--seed", "--parts", "--output", "[default: lab-results]"]
        {
            assert!(text.contains(word), "{what}: {word}");
        }
        assert!(!text.contains("--tiny"), "{what}: for tests only");
    }
    for experiment in colltrans_lab::experiments() {
        let Some((kind, number)) = experiment.id.split_once('-') else { continue };
        if kind == "casts" {
            continue;
        }
        let text = help(&[kind, "--help"]);
        assert!(text.contains(number) && text.contains(experiment.title), "{}", experiment.id);
    }
}

#[test]
fn invalid_arguments_are_rejected() {
    let folder = TemporaryFolder::new();
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
        &["all", "--passes", "0"],
        &["section", "5"],
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

/// The announcement and the progress are on standard error, the results on standard output.
#[test]
fn announcement_and_results_are_printed() {
    let folder = TemporaryFolder::new();
    let arguments = ["section", "3", "--tiny", "--passes", "2"];
    let output = lab(folder.path()).args(arguments).output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let said = stderr(&output);
    let mut lines = said.lines();
    let first = "Measuring Section III (tiny), which takes about 1.0 s. Results go to lab-results.";
    assert_eq!(lines.next(), Some(first));
    assert_eq!(lines.next(), Some("  0 %, Section III, 50 vertices"));
    assert!(stdout(&output).starts_with("Section III: cuts"), "{}", stdout(&output));
}

#[test]
fn unwritable_folder_is_an_error() {
    let folder = TemporaryFolder::new();
    std::fs::write(folder.path().join("file"), "").unwrap();
    let output = lab(folder.path()).args(["all", "--tiny", "-o", "file/results"]).output().unwrap();
    assert_eq!(output.status.code(), Some(5), "{}", stderr(&output));
    let said = stderr(&output);
    let last = said.lines().last().unwrap_or_default();
    assert!(last.starts_with("error: file/results: cannot create the folder: "), "{said}");
    assert_eq!(stdout(&output), "");
}
