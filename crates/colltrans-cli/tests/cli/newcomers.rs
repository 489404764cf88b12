//! Typical mistakes and first steps: outputs over inputs, parts that are not convex, poses, files of directions, help.

use std::fmt::Write as _;
use std::path::Path;

use crate::support::{CAST, answered, colltrans, data, folder, json, refused, run, stderr, stdout};

fn contents(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let mut files: Vec<_> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .map(|path| (path.display().to_string(), std::fs::read(&path).unwrap()))
        .collect();
    files.sort();
    files
}

/// Returns names of a file: the same, a relative one, a symbolic link, a hard link.
#[cfg(unix)]
fn names_of(folder: &Path, file: &str, extension: &str) -> Vec<String> {
    let (symbolic, hard) = (format!("symbolic.{extension}"), format!("hard.{extension}"));
    let _ = std::fs::remove_file(folder.join(&symbolic));
    let _ = std::fs::remove_file(folder.join(&hard));
    std::os::unix::fs::symlink(file, folder.join(&symbolic)).unwrap();
    std::fs::hard_link(folder.join(file), folder.join(&hard)).unwrap();
    vec![file.into(), format!("./{file}"), symbolic, hard]
}

#[cfg(unix)]
#[test]
fn picture_that_would_overwrite_a_mesh_is_rejected() {
    let folder = folder();
    // Links have the extension of a picture, which the mesh itself does not have.
    for picture in &names_of(folder.path(), "cube.off", "svg")[2..] {
        let before = contents(folder.path());
        for (moving, fixed) in [("cube.off", "dent.off"), ("dent.off", "cube.off")] {
            let arguments =
                ["cast", moving, fixed, "--hull", "--direction", "x", "--picture", picture];
            refused(
                folder.path(),
                &arguments,
                3,
                &[picture, "is the same file as the input cube.off"],
            );
        }
        assert!(contents(folder.path()) == before);
    }
    refused(folder.path(), &[&CAST[..], &["--picture", "cube.off"]].concat(), 2, &["cube.svg"]);
}

#[test]
fn picture_path_requires_svg_extension() {
    let folder = folder();
    for name in ["out.png", "out", "cube.off"] {
        let before = contents(folder.path());
        let arguments = [&CAST[..], &["--picture", name]].concat();
        refused(folder.path(), &arguments, 2, &["pictures are SVG files", ".svg"]);
        assert!(contents(folder.path()) == before);
    }
}

const QUERY: &str =
    r#"{"moving":{"mesh":"cube.off"},"fixed":{"points":[[5,0.5,0.5]]},"direction":[1,0,0]}"#;

#[cfg(unix)]
#[test]
fn results_that_would_overwrite_an_input_are_kept_elsewhere() {
    let folder = folder();
    let path = folder.path();
    std::fs::write(path.join("q.jsonl"), QUERY).unwrap();
    for output in names_of(path, "q.jsonl", "jsonl") {
        let before = contents(path);
        refused(path, &["batch", "q.jsonl", "-o", &output], 3, &["contains the queries"]);
        let input = std::fs::File::open(path.join("q.jsonl")).unwrap();
        let result = std::process::Command::new(assert_cmd::cargo::cargo_bin("colltrans"))
            .args(["batch", "-", "-o", &output])
            .current_dir(path)
            .stdin(input)
            .output()
            .unwrap();
        assert_eq!(result.status.code(), Some(3), "{}", stderr(&result));
        assert!(contents(path) == before, "{output}");
    }
    for output in names_of(path, "cube.off", "off") {
        let before = contents(path);
        let arguments = ["batch", "q.jsonl", "-o", &output];
        let result = run(path, &arguments);
        let message = stderr(&result);
        assert_eq!(result.status.code(), Some(3), "{message}");
        let left = message.split("the results are in ").nth(1).expect(&message).trim();
        let results = std::fs::read_to_string(path.join(left)).unwrap();
        assert_eq!(json(&results)["translation"], 4.0, "nothing is lost");
        std::fs::remove_file(path.join(left)).unwrap();
        assert!(contents(path) == before, "{output}");
    }
}

#[cfg(unix)]
#[test]
fn results_replace_an_existing_file() {
    let folder = folder();
    let path = folder.path();
    std::fs::write(path.join("q.jsonl"), QUERY).unwrap();
    std::fs::write(path.join("old.jsonl"), "old\n").unwrap();
    std::os::unix::fs::symlink("old.jsonl", path.join("link.jsonl")).unwrap();
    let files = contents(path).len();
    assert_eq!(answered(path, &["batch", "q.jsonl", "-o", "link.jsonl"]), "");
    assert!(path.join("link.jsonl").is_symlink());
    let results = std::fs::read_to_string(path.join("old.jsonl")).unwrap();
    assert_eq!(json(&results)["outcome"], "contact");
    assert_eq!(contents(path).len(), files, "nothing is left beside it");
    assert_eq!(answered(path, &["batch", "q.jsonl", "-o", "/dev/null"]), "");
    refused(path, &["batch", "q.jsonl", "-o", "."], 5, &["cannot be written"]);
}

#[test]
fn hull_excess_and_its_meaning_are_reported() {
    let folder = folder();
    let path = folder.path();
    let cast = |more: &[&str]| {
        let first = ["cast", "dent.off", "cube.off", "--direction", "x", "--moving-pose"];
        answered(path, &[&first[..], more].concat())
    };
    let ahead = cast(&["-3,0,0", "--hull"]);
    for part in [
        "moving hull  0.0833333 of its volume 1 is not the part (8.333 %)",
        "lies up to 0.25 below it",
        "a bound for the moving part itself: no contact before this one, perhaps later or none",
    ] {
        assert!(ahead.contains(part), "{part:?} is not in {ahead}");
    }
    assert!(!ahead.contains("fixed hull"), "the cube is its own hull: {ahead}");
    let beside = cast(&["-3,2,0", "--hull-moving"]);
    assert!(beside.starts_with("separated"));
    assert!(beside.contains("so this is   proven for the moving part itself too"), "{beside}");

    let arguments = ["cast", "dent.off", "cube.off", "--direction", "x", "--hull-fixed"];
    refused(path, &arguments, 3, &["dent.off", "not convex"]);
    let record = json(&cast(&["-3,0,0", "--hull-moving", "--json"]));
    assert_eq!(record["hull"]["moving"]["depth"], 0.25, "{record}");
    assert_eq!(record["hull"]["moving"]["hull_volume"], 1.0);
    assert!(record["hull"].get("fixed").is_none());
    // A face is missing, so the volume is unknown.
    let open = ["cast", "open.off", "cube.off", "--direction", "x", "--hull", "--json"];
    let record = json(&answered(path, &open));
    assert!(record["hull"]["moving"].get("part_volume").is_none(), "{record}");

    let line = |body: &str| {
        format!(r#"{{"moving":{body},"fixed":{{"points":[[9,0,0]]}},"direction":[1,0,0]}}"#)
    };
    let text = [
        line(r#"{"mesh":"dent.off","hull":true,"scale":2}"#),
        line(r#"{"mesh":"dent.off","hull":false}"#),
        line(r#"{"mesh":"cube.off","scale":0}"#),
        line(r#"{"points":[[0,0,0]],"scale":2}"#),
    ];
    let output =
        colltrans(path).args(["batch", "-"]).write_stdin(text.join("\n")).output().unwrap();
    let records: Vec<_> = stdout(&output).lines().map(json).collect();
    assert_eq!(records[0]["translation"], 7.0);
    assert_eq!(records[0]["hull"]["moving"]["depth"], 0.5);
    for (record, word) in records[1..].iter().zip(["not convex", "scale 0", "require a `mesh`"]) {
        assert!(record["message"].as_str().unwrap().contains(word), "{record}");
    }
}

#[test]
fn scales_angles_and_axis_names_are_applied() {
    let folder = folder();
    let path = folder.path();
    let cast = |more: &[&str]| {
        let all = [&["cast", "cube.off", "cube.off", "--json"], more].concat();
        json(&answered(path, &all))["translation"].as_f64().unwrap()
    };
    assert_eq!(cast(&["--direction", "x", "--moving-pose", "-3,0,0"]), 2.0);
    assert_eq!(cast(&["--direction", "-z", "--moving-pose", "0,0,5"]), 4.0);
    assert_eq!(cast(&["--direction", "+y", "--moving-pose", "0,-5,0"]), 4.0);
    let right = ["--direction", "x", "--moving-pose", "-4,0,0"];
    assert_eq!(cast(&[&right[..], &["--moving-scale", "2"]].concat()), 2.0);
    assert_eq!(
        cast(&[&right[..], &["--fixed-scale", "0.5", "--fixed-pose", "1,0,0"]].concat()),
        4.0
    );
    // A quarter turn about z moves the cube to x from -1 to 0.
    let turned = cast(&[&right[..], &["--moving-rpy", "0,0,90"]].concat());
    assert!((turned - 4.0).abs() < 1e-12, "{turned}");
    let both = ["--moving-pose", "0,0,0,0,0,0,1", "--moving-rpy", "0,0,90"];
    let arguments = [&["cast", "cube.off", "cube.off", "--direction", "x"], &both[..]].concat();
    refused(path, &arguments, 2, &["--moving-rpy have a rotation; give one of them"]);
    for (option, value, word) in [
        ("--moving-scale", "0", "positive"),
        ("--moving-scale", "-1", "positive"),
        ("--fixed-rpy", "1,2", "roll,pitch,yaw"),
        ("--direction", "w", "expected three numbers (x,y,z) or an axis (x, -x,"),
    ] {
        let mut arguments = vec!["cast", "cube.off", "cube.off", option, value];
        if option != "--direction" {
            arguments.extend(["--direction", "x"]);
        }
        refused(path, &arguments, 2, &[word]);
    }
}

#[test]
fn quaternion_with_few_digits_is_normalised_with_a_note() {
    let folder = folder();
    let pose = "--moving-pose";
    let arguments = ["cast", "cube.off", "cube.off", "--direction", "x", pose];
    let output = run(folder.path(), &[&arguments[..], &["-4,0.25,0,0,0,0.707,0.707"]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(stdout(&output).starts_with("contact\n  translation  4 times"), "{}", stdout(&output));
    let note = stderr(&output);
    assert!(note.starts_with("note: --moving-pose: the quaternion has length 0.999849"), "{note}");
    let wrong = [&arguments[..], &["0,0,0,0,0,1,1"]].concat();
    refused(folder.path(), &wrong, 2, &["not 1"]);
}

#[test]
fn cast_along_many_directions_prints_one_line_each() {
    let folder = folder();
    let path = folder.path();
    std::fs::write(path.join("d.txt"), "\u{feff}x # ahead\r\n\r\n-x\n0 0 -2\n0,0,0\n").unwrap();
    let scan = |more: &[&str]| {
        let first = ["cast", "cube.off", "cube.off", "--moving-pose", "-3,0,0", "--directions"];
        run(path, &[&first[..], more].concat())
    };
    let output = scan(&["d.txt"]);
    assert_eq!(output.status.code(), Some(1));
    assert_eq!(stderr(&output), "error: 1 of 4 directions have no answer\n");
    let text = stdout(&output);
    let lines: Vec<Vec<&str>> = text.lines().map(|l| l.split_whitespace().collect()).collect();
    assert_eq!(lines[0], ["direction", "outcome", "translation", "length", "normal"]);
    assert_eq!(lines[1], ["1,0,0", "contact", "2", "2", "1,0,0"]);
    assert_eq!(lines[2], ["-1,0,0", "contact", "-4", "-4", "-1,0,0"]);
    assert_eq!(lines[3][..4], ["0,0,-2", "separated", "-", "-"]);
    assert_eq!(lines[4][..2], ["0,0,0", "error"]);
    assert_eq!(lines.len(), 5);

    let records: Vec<_> = stdout(&scan(&["d.txt", "--json"])).lines().map(json).collect();
    assert_eq!(records.len(), 4);
    assert_eq!(records[1]["direction"], serde_json::json!([-1.0, 0.0, 0.0]));
    assert_eq!(records[1]["translation"], -4.0);
    assert_eq!(records[3]["outcome"], "error");

    std::fs::write(path.join("bad.txt"), "x\nsideways\n").unwrap();
    std::fs::write(path.join("none.txt"), "# nothing\n").unwrap();
    for (file, word) in [
        ("bad.txt", "bad.txt: line 2: expected three numbers"),
        ("none.txt", "none.txt: contains no directions"),
        ("missing.txt", "missing.txt: cannot be read"),
    ] {
        let output = scan(&[file]);
        assert_eq!((output.status.code(), stdout(&output)), (Some(3), String::new()));
        assert!(stderr(&output).contains(word), "{}", stderr(&output));
    }
    let both = scan(&["d.txt", "--direction", "x"]);
    assert_eq!(both.status.code(), Some(2));
}

#[test]
fn each_clearance_outcome_is_printed() {
    let folder = folder();
    let clearance = |pose: &str, more: &[&str]| {
        let first = ["clearance", "cube.off", "cube.off", "--direction", "2,0,0", "--moving-pose"];
        answered(folder.path(), &[&first[..], &[pose], more].concat())
    };
    let cases = [
        ("-3,0.5,0", "blocked", "translation  1 times the direction, a length of 2"),
        (
            "-1,0.5,0",
            "blocked",
            "distance     0 times the direction, a length of 0 (the bodies touch)",
        ),
        ("-3,1,0", "slides", "free, the bodies slide along each other"),
        ("3,0.5,0", "behind", "last contact -1 times the direction, a length of -2"),
        ("-3,2,0", "separated", "never meet"),
        ("0.5,0.5,0", "overlapping", "best estimate 0.75 times the direction, a length of 1.5"),
    ];
    for (pose, outcome, part) in cases {
        let text = clearance(pose, &[]);
        assert!(text.starts_with(outcome) && text.contains(part), "{text}");
        assert!(!text.contains("-0 ") && !text.contains("e0"), "{text}");
        let line = clearance(pose, &["--json"]);
        assert!(!line.contains("-0.0,") && !line.contains("-0.0]"), "{line}");
        let record = json(&line);
        assert_eq!(record["outcome"], outcome, "{record}");
        assert_eq!(record.get("distance").is_some(), outcome == "blocked", "{record}");
    }
    // The printed distance is rounded to the safe side.
    let after = |text: &str, name: &str| -> f64 {
        let line = text.lines().find_map(|line| line.trim().strip_prefix(name)).unwrap();
        line.split_whitespace().next().unwrap().parse().unwrap()
    };
    let text = clearance("-3,0.5,0", &[]);
    assert!(text.starts_with("blocked\n  distance "), "{text}");
    let ahead = after(&text, "distance");
    assert!(ahead <= 1.0 && ahead > 1.0 - 1e-8, "{text}");
    let text = clearance("0.5,0.5,0", &[]);
    let ways = ["free after", "or after"].map(|name| after(&text, name));
    assert!(ways[0] >= 0.75 && ways[1] >= 0.25, "{text}");
    let record = json(&clearance("0.5,0.5,0", &["--json"]));
    for (shown, exact) in ways.into_iter().zip(["back", "on"]) {
        let exact = record[exact].as_f64().unwrap();
        assert!(shown >= exact && shown < exact * (1.0 + 1e-8), "{text}: {record}");
    }
    let record = json(&clearance("-3,0.5,0", &["--json"]));
    let (distance, lower) = (&record["distance"], &record["translation_bounds"][0]);
    assert!(distance.as_f64() <= lower.as_f64() && lower.as_f64().is_some(), "{record}");
    assert!(record["rounding"].as_f64().unwrap() > 0.0);
    assert!(clearance("-3,0.5,0", &["--picture", "free.svg"]).starts_with("blocked"));
    assert!(folder.path().join("free.svg").is_file());
}

/// Near-zero coordinates from rounding, as in computed corners.
#[test]
fn merged_vertices_are_reported() {
    let folder = folder();
    let path = folder.path();
    let cube = std::fs::read_to_string(path.join("cube.off")).unwrap();
    // The last side has a copy of the first corner.
    let twins = cube
        .replace("8 6 12\n", "9 6 12\n")
        .replace("0 1 1\n", "0 1 1\n5e-17 0 0\n")
        .replace("4 3 0 4 7", "4 3 8 4 7");
    std::fs::write(path.join("twins.off"), twins).unwrap();
    let output = run(path, &["cast", "twins.off", "cube.off", "--direction", "x"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let note = "twins.off: 1 vertex on open edges merged with another, at most 5e-17 away";
    assert!(stderr(&output).contains(note), "{}", stderr(&output));
    assert!(answered(path, &["info", "twins.off"]).contains("merged       1 vertex on open edges"));
    let equal = ["cast", "twins.off", "cube.off", "--direction", "x", "--merge-tolerance", "0"];
    refused(path, &equal, 3, &["the surface is open", "--merge-tolerance"]);
}

#[test]
fn file_with_a_wrong_extension_is_rejected() {
    let folder = folder();
    let path = folder.path();
    std::fs::copy(path.join("cube.off"), path.join("cube.stl")).unwrap();
    let arguments = ["cast", "cube.stl", "cube.off", "--direction", "x"];
    refused(
        path,
        &arguments,
        3,
        &["cube.stl: contains an OFF file, but its extension stands for STL"],
    );
    refused(path, &["info", "cube.stl"], 3, &["contains an OFF file"]);
}

/// Results are equal with a large cache and with the minimum of two bodies.
#[test]
fn results_do_not_depend_on_the_cache_size() {
    let folder = folder();
    let queries = vec![QUERY; 50].join("\n");
    let batch = |size: &str| {
        let arguments = ["batch", "-", "--cache-bytes", size];
        colltrans(folder.path()).args(arguments).write_stdin(queries.as_str()).output().unwrap()
    };
    let expected = stdout(&batch("1GiB"));
    assert_eq!(expected.lines().count(), 50);
    assert_eq!(stdout(&batch("0")), expected);
    assert_eq!(batch("much").status.code(), Some(2));
}

#[test]
fn clearances_along_many_directions_are_rounded_down() {
    let folder = folder();
    let path = folder.path();
    std::fs::write(path.join("d.txt"), "x\n0.7,0.01,0.02\n-x\nz\n").unwrap();
    let arguments = [
        "clearance",
        "cube.off",
        "cube.off",
        "--moving-pose=-3.1,0.3,0.1",
        "--directions",
        "d.txt",
    ];
    let text = stdout(&run(path, &arguments));
    let lines: Vec<Vec<&str>> = text.lines().map(|l| l.split_whitespace().collect()).collect();
    assert_eq!(lines[0], ["direction", "outcome", "distance", "length", "normal"]);
    let records = stdout(&run(path, &[&arguments[..], &["--json"]].concat()));
    let records: Vec<_> = records.lines().map(json).collect();
    let longer = 0.7_f64.hypot(0.01).hypot(0.02);
    for (line, record, length) in [(&lines[1], &records[0], 1.0), (&lines[2], &records[1], longer)]
    {
        assert_eq!(line[1], "blocked");
        let [distance, far] = [line[2], line[3]].map(|word| word.parse::<f64>().unwrap());
        let safe = record["distance"].as_f64().unwrap();
        assert!(distance <= safe && distance > safe * (1.0 - 1e-8), "{line:?}: {record}");
        assert!(far <= safe * length && far > safe * length * (1.0 - 1e-8), "{line:?}: {record}");
    }
    assert!(lines[1][2].parse::<f64>().unwrap() <= 2.1, "the cubes are 2.1 apart");
    assert_eq!(lines[3][1..4], ["behind", "-", "-"]);
    assert_eq!(lines[4][1..4], ["separated", "-", "-"]);
}

#[test]
fn slide_reports_its_translation() {
    let folder = folder();
    let beside = ["clearance", "cube.off", "cube.off", "--moving-pose=-3,1,0", "--direction", "x"];
    let text = stdout(&run(folder.path(), &beside));
    assert!(text.starts_with("slides: free"), "{text}");
    let translation = text.lines().find(|line| line.starts_with("  translation"));
    assert_eq!(translation, Some("  translation  2 times the direction, a length of 2"), "{text}");
}

#[test]
fn info_of_a_nan_vertex_has_no_volume() {
    let folder = folder();
    let text = "OFF\n4 4 0\n0 0 0\n1 0 0\n0 nan 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";
    std::fs::write(folder.path().join("nan.off"), text).unwrap();
    let text = stdout(&run(folder.path(), &["info", "nan.off"]));
    assert!(text.contains("volume       none: vertex 2 is not finite"), "{text}");
    assert!(text.contains("extent       none: vertex 2 is not finite"), "{text}");
}

/// Lines of help are no longer than the terminal, and name the program.
#[test]
fn help_lines_fit_the_terminal() {
    let folder = folder();
    let version = colltrans(folder.path()).arg("--version").output().unwrap();
    assert_eq!(stdout(&version), concat!("colltrans ", env!("CARGO_PKG_VERSION"), "\n"));
    for command in
        ["", "cast", "clearance", "clear", "batch", "assembly", "info", "replay", "files"]
    {
        for columns in [80, 120] {
            for flag in ["--help", "-h"] {
                let mut program = colltrans(folder.path());
                program.env("COLUMNS", columns.to_string());
                let arguments = [command, flag];
                let output =
                    program.args(arguments.iter().filter(|a| !a.is_empty())).output().unwrap();
                let text = stdout(&output);
                let longest = text.lines().map(|line| line.chars().count()).max().unwrap();
                assert!(longest <= columns, "{command} at {columns}: {longest}\n{text}");
                assert!(text.contains("colltrans"));
            }
        }
    }
}

/// All lines about a closed surface call it closed.
#[test]
fn info_reports_inward_faces_as_closed() {
    let folder = folder();
    let turned = "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 1 2\n3 0 3 1\n3 0 2 3\n3 1 3 2\n";
    std::fs::write(folder.path().join("turned.off"), turned).unwrap();
    let output = colltrans(folder.path()).args(["info", "turned.off"]).output().unwrap();
    let text = stdout(&output);
    assert!(text.contains("surface      closed"), "{text}");
    assert!(!text.contains("not closed"), "{text}");
    assert!(text.contains("the part's is unknown (its faces are oriented inwards)"), "{text}");
}

/// Returns an L of size 40 at UTM coordinates as OBJ, after the text `before`.
fn angle(before: &str) -> String {
    let outline = [[0, 0], [40, 0], [40, 10], [10, 10], [10, 40], [0, 40]];
    let mut text = before.to_owned();
    for z in [0, 10] {
        for [x, y] in outline {
            writeln!(text, "v {} {} {z}", 500_000 + x, 4_649_776 + y).unwrap();
        }
    }
    text += "f -7 -8 -9 -10 -11 -12\nf -6 -5 -4 -3 -2 -1\n";
    for i in 0..6 {
        let [a, b] = [i, (i + 1) % 6].map(|k| k - 12);
        writeln!(text, "f {a} {b} {} {}", b + 6, a + 6).unwrap();
    }
    text
}

#[test]
fn unused_vertex_does_not_affect_convexity() {
    let folder = folder();
    let write = |name: &str, text: String| std::fs::write(folder.path().join(name), text).unwrap();
    write("angle.obj", angle(""));
    write("stray.obj", angle("v 0 0 0\n"));
    for angle in ["angle.obj", "stray.obj"] {
        // The cube moves down through the notch, which the hull of the L fills.
        let pose = ["--moving-pose", "500012,4649788,20", "--direction", "-z"];
        let asked =
            |query, json: &'static [&str]| [&[query, "cube.off", angle], &pose[..], json].concat();
        refused(folder.path(), &asked("cast", &[]), 3, &[angle, "not convex"]);
        let answer = json(&answered(folder.path(), &asked("clearance", &["--json"])));
        assert_eq!(answer["outcome"], "free", "{angle}: {answer}");
        let told = stdout(&run(folder.path(), &["info", angle]));
        assert!(
            told.contains("40 x 40 x 10") && told.contains("no; `clearance` accepts"),
            "{told}"
        );
    }
}

#[test]
fn dent_within_the_convex_tolerance_is_reported() {
    let folder = folder();
    let cube = std::fs::read_to_string(folder.path().join("dent.off")).unwrap();
    let flat = cube.replace("0.5 0.5 0.75", "0.5 0.5 0.999995");
    std::fs::write(folder.path().join("flat.off"), flat).unwrap();
    let words = ["cast", "cube.off", "flat.off", "--direction", "z", "--moving-pose", "0,0,-3"];
    let output = run(folder.path(), &words);
    assert!(stderr(&output).contains("note: flat.off: convex only to within the tolerance"));
    let answer = json(&answered(folder.path(), &[&words[..], &["--json"]].concat()));
    let depth = answer["dents"]["fixed"].as_f64().unwrap();
    assert!((depth - 5e-6).abs() < 1e-12 && answer["dents"]["moving"].is_null(), "{answer}");
    let exact = json(&answered(folder.path(), &[&CAST[..], &["--json"]].concat()));
    assert!(exact["dents"].is_null(), "{exact}");
    // In a scene: for the named body, and for each body of a list.
    let line = r#"{"body":{"mesh":"flat.off"},"pose":{"translation":[3,0,0]}}"#;
    std::fs::write(folder.path().join("scene.jsonl"), line).unwrap();
    let is_depth = |depth: &serde_json::Value| (depth.as_f64().unwrap() - 5e-6).abs() < 1e-12;
    let among = |command: &[&'static str], scene: &'static str| {
        let words = [command, &["--moving-pose", "0,0,-3", "--json", "--scene", scene]].concat();
        let output = run(folder.path(), &words);
        let note = "flat.off: convex only to within the tolerance";
        assert_eq!(stderr(&output).matches(note).count(), 1, "{}", stderr(&output));
        json(&stdout(&output))
    };
    for scene in ["flat.off", "scene.jsonl"] {
        let nearest = among(&["distance", "cube.off"], scene);
        assert!(is_depth(&nearest["dents"]["fixed"]), "{nearest}");
        assert!(nearest["dents"]["moving"].is_null(), "{nearest}");
        let within = among(&["within", "cube.off", "--length", "9"], scene);
        assert!(is_depth(&within["closer"][0]["dent"]), "{within}");
        assert!(within["dents"].is_null(), "{within}");
    }
    let first = among(&["clearance", "cube.off", "--direction", "z"], "flat.off");
    assert!(is_depth(&first["dents"]["fixed"]), "{first}");
    let moving = among(&["clearance", "flat.off", "--direction", "z"], "cube.off");
    assert!(is_depth(&moving["dents"]["moving"]) && moving["dents"]["fixed"].is_null(), "{moving}");
}

/// The runtime replaces a closed stream by `/dev/null`. A user who opens `/dev/null` wants no output.
#[cfg(unix)]
#[test]
fn closed_standard_output_returns_exit_code_5() {
    let folder = folder();
    let program = assert_cmd::cargo::cargo_bin("colltrans");
    let cube = data().join("cube.off");
    let ask = |command: &str, to: &str| {
        let line = format!("exec \"$0\" {command} {to}");
        let mut shell = std::process::Command::new("sh");
        shell.args(["-c", &line]).args([&program, &cube]).current_dir(folder.path());
        shell.output().unwrap()
    };
    let cast = "cast \"$1\" \"$1\" --direction x --moving-pose=-3,0,0 --json";
    let query = "{\"moving\": \"cube.off\", \"fixed\": \"cube.off\", \"direction\": [1, 0, 0]}\n";
    std::fs::write(folder.path().join("queries.jsonl"), query).unwrap();
    for command in [cast, "info \"$1\"", "batch queries.jsonl"] {
        let closed = ask(command, ">&-");
        assert_eq!(closed.status.code(), Some(5), "{command}: {}", stderr(&closed));
        assert!(stderr(&closed).contains("standard output: cannot be written: it is closed"));
    }
    for to in [">/dev/null", "1<>/dev/null"] {
        assert_eq!(ask(cast, to).status.code(), Some(0), "{to}");
    }
}
