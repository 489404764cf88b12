//! STEP files and their converter, and files with several bodies.

use std::fmt::Write as _;
use std::path::Path;

use crate::support::{answered, colltrans, folder, json, refused, stderr};

/// Writes a converter that runs a line of shell: `$1` is the file, `$3` the output, `$5` the chord. Returns its path.
#[cfg(unix)]
fn converter(folder: &Path, line: &str) -> String {
    use std::os::unix::fs::PermissionsExt;
    let path = folder.join("converter");
    std::fs::write(&path, format!("#!/bin/sh\n{line}\n")).unwrap();
    std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o755)).unwrap();
    path.display().to_string()
}

#[cfg(unix)]
#[test]
fn step_file_is_converted_to_glb() {
    let folder = folder();
    let at = folder.path();
    std::fs::write(at.join("a.step"), "ISO-10303-21;").unwrap();
    answered(at, &["assembly", "cube.off", "-o", "out"]);
    let run = |converter: &str, more: &[&str]| {
        let mut command = colltrans(at);
        command.env("COLLTRANS_STEP", converter).args(["assembly", "a.step"]).args(more);
        command.output().unwrap()
    };
    let good = converter(
        at,
        "echo working on $1 >&2; test \"$2 $3 $4 $5\" = '-o - --chord 0.2' && cat out/disassembly.glb",
    );
    let output = run(&good, &["--chord", "0.2", "--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let found = json(&String::from_utf8(output.stdout).unwrap());
    assert_eq!(
        (&found["parts"][0]["name"], &found["parts"][0]["facets"]),
        (&"cube".into(), &12.into())
    );
    // The output must not overwrite the STEP file.
    std::fs::create_dir(at.join("o")).unwrap();
    std::os::unix::fs::symlink(at.join("a.step"), at.join("o/report.html")).unwrap();
    let output = run(&good, &["--chord", "0.2", "-o", "o"]);
    assert_eq!(output.status.code(), Some(3), "{}", stderr(&output));

    for (converter, words) in [
        (
            "/nowhere/converter".to_owned(),
            &["a.step", "pip install 'colltrans[step]'", "./python[step]", "COLLTRANS_STEP"][..],
        ),
        (
            converter(at, "echo 'No module named colltrans' >&2; exit 1"),
            &["pip install 'colltrans[step]'"],
        ),
        (
            converter(at, "echo 'STEP files need cadquery-ocp-novtk: pip install it' >&2; exit 1"),
            &["pip install 'colltrans[step]'"],
        ),
    ] {
        let output = run(&converter, &[]);
        assert_eq!(output.status.code(), Some(3), "{}", stderr(&output));
        assert!(words.iter().all(|word| stderr(&output).contains(word)), "{}", stderr(&output));
    }
    // The name of an interpreter alone would run the STEP file as its program.
    for interpreter in ["python3", "/opt/bin/python3.12", "pypy3"] {
        let output = run(interpreter, &[]);
        assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
        let words = format!("'{interpreter} -m colltrans.step'");
        assert!(stderr(&output).contains(&words), "{}", stderr(&output));
    }
    let output =
        run(&converter(at, "echo one >&2; echo 'a.step: no shape in it' >&2; exit 3"), &[]);
    assert!(stderr(&output).contains("no shape in it"), "{}", stderr(&output));
    assert_eq!(output.status.code(), Some(3));
    let output = run(&converter(at, "echo no GLB"), &[]);
    assert!(stderr(&output).contains("a.step: glTF"), "{}", stderr(&output));
    refused(at, &["assembly", "gone.stp"], 3, &["gone.stp", "cannot be read"]);
    refused(at, &["assembly", "a.step", "--chord", "0"], 2, &["--chord", "positive"]);
}

#[test]
fn bodies_of_a_file_are_split_or_joined() {
    let folder = folder();
    let at = folder.path();
    let cube = std::fs::read_to_string(at.join("cube.off")).unwrap();
    let mut text = String::new();
    for (name, z) in [("low", 0.0), ("high", 1.0)] {
        writeln!(text, "o {name}").unwrap();
        for line in cube.lines().skip(2).take(8) {
            let [x, y, own] =
                [0, 1, 2].map(|k| line.split(' ').nth(k).unwrap().parse::<f64>().unwrap());
            writeln!(text, "v {x} {y} {}", own + z).unwrap();
        }
        for line in cube.lines().skip(10) {
            // Counted from the end.
            let corner = |word: &str| (word.parse::<i64>().unwrap() - 8).to_string();
            let corners: Vec<String> = line.split(' ').skip(1).map(corner).collect();
            writeln!(text, "f {}", corners.join(" ")).unwrap();
        }
    }
    std::fs::write(at.join("two.obj"), text).unwrap();
    let parts = |more: &[&str]| {
        let found = json(&answered(at, &[&["assembly", "two.obj", "--json"], more].concat()));
        let names = found["parts"]
            .as_array()
            .unwrap()
            .iter()
            .map(|part| part["name"].as_str().unwrap().to_owned());
        names.collect::<Vec<String>>()
    };
    assert_eq!(parts(&[]), ["low", "high"]);
    assert_eq!(parts(&["--split", "never"]), ["two"]);
    assert_eq!(parts(&["--split", "bodies"]), ["low", "high"]);
    refused(
        at,
        &["assembly", "two.obj", "--split", "all"],
        2,
        &["accepted: auto, never, names, bodies"],
    );
    let told = answered(at, &["info", "two.obj"]);
    assert!(told.contains("2: low, high") && told.contains("2, split with"), "{told}");
    assert!(!answered(at, &["info", "cube.off"]).contains("split with"));
}
