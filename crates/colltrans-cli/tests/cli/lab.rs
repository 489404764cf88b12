//! `lab`: what can be asked for, and where the results go.

use crate::support::{colltrans, folder, stderr, stdout};

#[test]
fn help_says_what_there_is() {
    let folder = folder();
    let help = |arguments: &[&str]| {
        let output = colltrans(folder.path()).arg("lab").args(arguments).output().unwrap();
        assert_eq!(output.status.code(), Some(0), "{arguments:?}: {}", stderr(&output));
        stdout(&output)
    };
    for word in ["figure", "table", "all", "report.html", "Exit codes"] {
        assert!(help(&["--help"]).contains(word), "{word}");
    }
    for what in ["figure", "table", "all"] {
        let text = help(&[what, "--help"]);
        for word in ["--quick", "--full", "--seed", "--output", "[default: lab-results]"] {
            assert!(text.contains(word), "{what}: {word}");
        }
        assert!(!text.contains("--tiny"), "{what}: for tests only");
    }
    for experiment in colltrans_lab::experiments() {
        let (kind, number) = experiment.id.split_once('-').unwrap();
        let text = help(&[kind, "--help"]);
        assert!(text.contains(number) && text.contains(experiment.title), "{}", experiment.id);
    }
}

#[test]
fn what_there_is_not() {
    let folder = folder();
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
    ] {
        let output = colltrans(folder.path()).arg("lab").args(arguments).output().unwrap();
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
    let folder = folder();
    let output = colltrans(folder.path())
        .args(["lab", "all", "--tiny", "-o", "cube.off/results"])
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(5), "{}", stderr(&output));
    assert!(stderr(&output).starts_with("error: cube.off/results: the folder cannot be made: "));
    assert_eq!(stdout(&output), "");
}
