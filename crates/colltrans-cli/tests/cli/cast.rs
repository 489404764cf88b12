//! `colltrans cast` and `colltrans info`.

use std::process::Output;

use crate::support::{CAST, CONTACT_FIELDS, colltrans, fields, folder, json, stderr, stdout};

/// Asserts an exit code, an error message with all `words`, and an empty standard output.
fn assert_error(output: &Output, code: i32, words: &[&str]) {
    let message = stderr(output);
    assert_eq!(output.status.code(), Some(code), "{message}");
    assert_eq!(stdout(output), "");
    assert!(message.starts_with("error: "), "{message}");
    assert!(!message.contains("panicked") && !message.contains("RUST_BACKTRACE"), "{message}");
    for word in words {
        assert!(message.contains(word), "{word:?} is not in {message}");
    }
}

#[test]
fn start_and_until_control_the_papers_algorithm() {
    let folder = folder();
    let asked = |more: &[&str]| {
        colltrans(folder.path()).args(CAST).args(["--json"]).args(more).output().unwrap()
    };
    let problems = |more: &[&str]| {
        let output = asked(more);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        json(&stdout(&output))["steps"]["planar_problems"].as_u64().unwrap()
    };
    assert!(problems(&["--solver", "cta"]) >= 1);
    assert!(problems(&["--solver", "cta", "--start", "center", "--until", "0.5"]) >= 1);
    assert_eq!(problems(&["--solver", "cta", "--start", "ellipsoids"]), 0);
    assert!(problems(&["--solver", "cta", "--start", "guess", "--across-cells"]) >= 1);
    assert!(problems(&["--solver", "cta", "--cold", "--cuts", "centroid"]) >= 1);
    for flags in
        [&["--until", "exit"][..], &["--cuts", "shifted"], &["--cold"], &["--across-cells"]]
    {
        assert_error(&asked(flags), 2, &["--across-cells and --cold require --solver cta"]);
    }
    let wrong = asked(&["--solver", "cta", "--until", "soon"]);
    assert_error(&wrong, 2, &["accepted: `exit`, or a number"]);
    let lines = r#"{"id":1,"moving":M,"fixed":M,"moving_pose":{"translation":[0.2,0.1,5]},"direction":[0,0,-1],"solver":"cta"}
{"id":2,"moving":M,"fixed":M,"moving_pose":{"translation":[0.2,0.1,5]},"direction":[0,0,-1],"solver":"cta","start":"ellipsoids","until":0.2}
{"id":3,"moving":M,"fixed":M,"direction":[0,0,-1],"until":0.2}
{"id":4,"moving":M,"fixed":M,"direction":[0,0,-1],"solver":"cta","until":-1}
{"id":5,"moving":M,"fixed":M,"direction":[0,0,-1],"cold":true}
{"id":6,"moving":M,"fixed":M,"moving_pose":{"translation":[0.2,0.1,5]},"direction":[0,0,-1],"solver":"cta","start":"guess","cuts":"centroid","across_cells":true,"cold":true}
"#;
    let tetrahedron = r#"{"points":[[0,0,0],[1,0,0],[0,1,0],[0,0,1]]}"#;
    std::fs::write(folder.path().join("cta.jsonl"), lines.replace('M', tetrahedron)).unwrap();
    let output = colltrans(folder.path()).args(["batch", "cta.jsonl"]).output().unwrap();
    let results: Vec<_> = stdout(&output).lines().map(json).collect();
    let problems = |k: usize| results[k]["steps"]["planar_problems"].as_u64();
    assert!(problems(0).unwrap() >= 1 && problems(1) == Some(0), "{results:?}");
    assert!(problems(5).unwrap() >= 1, "{results:?}");
    let refused = [
        (2, "`cuts`, `across_cells` and `cold` require \"solver\": \"cta\""),
        (3, "gap -1 at which narrowing ends"),
        (4, "`cold` require"),
    ];
    for (k, words) in refused {
        assert!(results[k]["message"].as_str().unwrap().contains(words), "{}", results[k]);
    }
}

#[test]
fn contact_is_printed_as_text() {
    let folder = folder();
    let output = colltrans(folder.path()).args(CAST).output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let text = stdout(&output);
    assert!(
        text.starts_with("contact\n  translation  2 times the direction, a length of 2\n"),
        "{text}"
    );
    for part in [
        "exit         4 times",
        "normal       1,0,0",
        "face of vertices",
        "(rounding alone: up to ",
    ] {
        assert!(text.contains(part), "{part:?} is not in {text}");
    }
    assert_eq!(stderr(&output), "");
}

#[test]
fn contact_in_json_has_all_fields() {
    let folder = folder();
    for solver in ["auto", "cta", "portal"] {
        let output = colltrans(folder.path())
            .args(CAST)
            .args(["--json", "--solver", solver])
            .output()
            .unwrap();
        assert_eq!(output.status.code(), Some(0), "{solver}: {}", stderr(&output));
        let answer = json(&stdout(&output));
        assert_eq!(fields(&answer), CONTACT_FIELDS);
        assert_eq!(answer["outcome"], "contact");
        let field = |name: &str| answer[name].as_f64().unwrap();
        assert!((field("translation") - 2.0).abs() < 1e-14, "{answer}");
        assert!((field("exit") - 4.0).abs() < 1e-14, "{answer}");
        for (name, right) in [("translation_bounds", 2.0), ("exit_bounds", 4.0)] {
            let [lower, upper] = [0, 1].map(|k| answer[name][k].as_f64().unwrap());
            assert!(lower <= right && right <= upper, "{name}: {answer}");
            assert!(upper - lower <= field("rounding"), "{name}: {answer}");
        }
        assert_eq!(answer["features"]["moving"]["kind"], "face");
        let mut corners: Vec<u64> = answer["features"]["moving"]["vertices"]
            .as_array()
            .unwrap()
            .iter()
            .map(|v| v.as_u64().unwrap())
            .collect();
        corners.sort_unstable();
        assert_eq!(corners, [1, 2, 5, 6], "the vertices at x = 1, as the file numbers them");
        assert!(answer["steps"]["supports"].is_u64());
    }
}

#[test]
fn separated_and_grazing_casts_in_json() {
    let folder = folder();
    let outcome = |pose: &str, more: &[&str]| {
        let output = colltrans(folder.path())
            .args(["cast", "cube.off", "cube.off", "--direction", "0,0,-2", "--json"])
            .args(["--moving-pose", pose])
            .args(more)
            .output()
            .unwrap();
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        json(&stdout(&output))
    };
    let separated = outcome("1.5,0,9", &[]);
    assert_eq!(separated["outcome"], "separated");
    let margin = separated["margin"].as_f64().unwrap();
    assert!(margin > 0.0 && margin < 0.5 + 1e-12, "{separated}");
    assert!(separated.get("translation").is_none());
    let grazing = outcome("1,0,9", &[]);
    assert_eq!(grazing["outcome"], "grazing");
    assert_eq!(grazing["translation"], 4.0);
    assert!(grazing["message"].as_str().unwrap().contains("overlap"));
    assert_eq!(outcome("0.75,0,9", &[])["outcome"], "contact");
    let tolerant = outcome("0.75,0,9", &["--graze-tolerance", "0.25"]);
    assert_eq!(tolerant["outcome"], "grazing");
    assert_eq!((&tolerant["overlap"], tolerant.get("margin")), (&0.25.into(), None));
    let opposite = outcome("0.75,0,9", &["--fixed-pose", "-1,-2,-3"]);
    assert_eq!(opposite["outcome"], "separated", "poses may begin with a minus sign");
    // A quarter turn about z moves the cube to x from -1 to 0.
    let turned = outcome("0.25,0,9,0,0,0.7071067811865476,0.7071067811865476", &[]);
    assert_eq!(turned["outcome"], "contact");
    let turned_away = outcome("-0.25,0,9,0,0,0.7071067811865476,0.7071067811865476", &[]);
    assert_eq!(turned_away["outcome"], "separated");
}

#[test]
fn invalid_cast_arguments_are_rejected() {
    let folder = folder();
    let run = |arguments: &[&str]| colltrans(folder.path()).args(arguments).output().unwrap();
    let cast = |more: &[&str]| run(&[&["cast", "cube.off", "cube.off"], more].concat());
    assert_error(&cast(&[]), 2, &["--direction"]);
    assert_error(&cast(&["--direction", "1,2"]), 2, &["2 numbers given, expected 3"]);
    assert_error(&cast(&["--direction", "1,2,x"]), 2, &["`x` is not a number"]);
    assert_error(&cast(&["--direction", "0,0,0"]), 2, &["direction"]);
    assert_error(&cast(&["--direction", "nan,0,0"]), 2, &["direction"]);
    assert_error(
        &cast(&["--direction", "1,0,0", "--fixed-pose", "0,0,0,1,1,1,1"]),
        2,
        &["length 2"],
    );
    assert_error(&cast(&["--direction", "1,0,0", "--solver", "best"]), 2, &["auto, cta, portal"]);
    assert_error(&cast(&["--direction", "1,0,0", "--graze-tolerance", "-1"]), 2, &["negative"]);
    assert_error(&cast(&["--direction", "1,0,0", "--bogus"]), 2, &["--bogus"]);
}

#[test]
fn invalid_files_are_named_with_helpful_options() {
    let folder = folder();
    let cast = |moving: &str, more: &[&str]| {
        colltrans(folder.path())
            .args(["cast", moving, "cube.off", "--direction", "1,0,0"])
            .args(more)
            .output()
            .unwrap()
    };
    assert_error(&cast("none.off", &[]), 3, &["none.off", "cannot be read"]);
    assert_error(&cast("cube.step", &[]), 3, &["cube.step", "stl, obj, ply, off"]);
    assert_error(&cast("broken.off", &[]), 3, &["broken.off", "line 12", "`zero`"]);
    assert_error(&cast("open.off", &[]), 3, &["open.off", "open", "--hull"]);
    assert_error(
        &cast("dent.off", &[]),
        3,
        &["dent.off", "not convex", "0.25 below", "--hull", "`colltrans clearance`"],
    );
    assert_error(&cast("points.ply", &[]), 3, &["points.ply", "no faces", "--hull"]);
    for good in [
        cast("dent.off", &["--hull"]),
        cast("open.off", &["--hull"]),
        cast("points.ply", &["--hull"]),
        cast("dent.off", &["--convex-tolerance", "0.3"]),
    ] {
        assert_eq!(good.status.code(), Some(0), "{}", stderr(&good));
        assert!(stdout(&good).starts_with("contact\n"));
    }
    let unwritable = cast("cube.off", &["--picture", "no/such/folder.svg"]);
    assert_eq!(unwritable.status.code(), Some(5));
    assert!(stderr(&unwritable).contains("no/such/folder.svg: cannot be written"));
}

#[test]
fn help_topics_document_exit_codes_poses_and_fields() {
    let folder = folder();
    let help = |words: &[&str]| stdout(&colltrans(folder.path()).args(words).output().unwrap());
    for (words, parts) in [
        (&["help", "files"][..], &["Exit codes:", "qx,qy,qz,qw", "single precision", "STL"][..]),
        (&["files", "--help"], &["Exit codes:", "Manifest of an assembly", "--merge-tolerance"]),
        (&["help", "json"], &["start_overlaps", "offset_distance", "EXCESS =", "liaisons"]),
        (&["cast", "--help"], &["Examples:", "x,y,z,qx,qy,qz,qw", "1e-5", "colltrans help files"]),
    ] {
        let text = help(words);
        for part in parts {
            assert!(text.contains(part), "{part:?} is not in {text}");
        }
    }
    assert!(help(&["files"]).contains("Exit codes:"));
    let batch = colltrans(folder.path()).args(["batch", "--help"]).output().unwrap();
    assert!(stdout(&batch).contains(r#"BODY = {"points""#));
}

#[test]
fn info_describes_meshes_and_defects() {
    let folder = folder();
    let info = |name: &str| {
        let output = colltrans(folder.path()).args(["info", name]).output().unwrap();
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        stdout(&output)
    };
    let contains = |name: &str, parts: &[&str]| {
        let text = info(name);
        for part in parts {
            assert!(text.contains(part), "{part:?} is not in {text}");
        }
    };
    contains(
        "cube.off",
        &[
            "vertices     8",
            "faces        6",
            "1 x 1 x 1",
            "volume       1\n",
            "convex       yes",
            "8 vertices, 12 edges, 6 faces",
            "hull error",
        ],
    );
    contains(
        "dent.off",
        &[
            "vertices     9",
            "surface      closed",
            "solid        yes: 1 shell, 0 holes through",
            "no; `clearance` accepts it, --hull takes its hull: face 1 lies 0.25 below",
            "volume       0.9166",
            "hull volume  1\n",
            "hull exceeds 0.0833333 of its volume 1 is not the part (8.333 %); the part's surface \
             lies up to 0.25 below it",
        ],
    );
    contains(
        "open.off",
        &[
            "surface      not closed: 4 edges",
            "solid        no: the surface is not closed: 4 edges",
            "convex       no: the surface is open",
            "hull volume  1\n",
        ],
    );
    contains("points.ply", &["faces        0 (a point cloud)", "no faces", "hull volume  1\n"]);
    // A vertex in no face does not belong to the part.
    let cube = std::fs::read_to_string(folder.path().join("cube.off")).unwrap();
    for place in ["5 5 5", "1e9 0 0", "nan 0 0"] {
        let more =
            cube.replace("8 6 12", "9 6 12").replace("0 1 1\n", &format!("0 1 1\n{place}\n"));
        std::fs::write(folder.path().join("more.off"), more).unwrap();
        contains(
            "more.off",
            &[
                "vertices     9, 1 of them in no face\n",
                "surface      closed\n",
                "volume       1\n",
            ],
        );
    }
    std::fs::write(
        folder.path().join("more.off"),
        cube.replace("8 6 12", "9 6 12").replace("0 1 1\n", "0 1 1\n5 5 5\n"),
    )
    .unwrap();
    let told = "hull         8 vertices, 12 edges, 6 faces\n";
    contains("more.off", &["convex       yes, to rounding error\n", told]);
    let both = colltrans(folder.path()).args(["info", "none.stl", "cube.off"]).output().unwrap();
    assert_eq!(both.status.code(), Some(3));
    assert!(stderr(&both).contains("none.stl") && stdout(&both).contains("cube.off"));
}

/// A vertex outside of all faces must not enlarge the hull.
#[test]
fn hull_ignores_an_unused_vertex() {
    let folder = folder();
    let cube = std::fs::read_to_string(folder.path().join("cube.off")).unwrap();
    let stray = cube.replace("8 6 12", "9 6 12").replace("0 1 1\n", "0 1 1\n0.5 0.5 500\n");
    std::fs::write(folder.path().join("stray.off"), stray).unwrap();
    let far = ["cast", "cube.off", "stray.off", "--moving-pose", "0,0,400", "--direction", "x"];
    let run = |more: &[&str]| colltrans(folder.path()).args(far).args(more).output().unwrap();
    let answer = run(&["--hull"]);
    assert!(stdout(&answer).starts_with("separated"), "{}", stdout(&answer));
    let note = "stray.off: 1 vertex that no face uses is not in the hull";
    assert!(stderr(&answer).contains(note), "{}", stderr(&answer));
    assert_eq!(json(&stdout(&run(&["--hull", "--json"])))["outcome"], "separated");
    let query = r#"{"moving":{"mesh":"cube.off"},"moving_pose":{"translation":[0,0,400]},
        "fixed":{"mesh":"stray.off","hull":true},"direction":[1,0,0]}"#;
    let batch = colltrans(folder.path())
        .args(["batch", "-"])
        .write_stdin(query.replace('\n', ""))
        .output()
        .unwrap();
    let answer = json(&stdout(&batch));
    assert_eq!(answer["outcome"], "separated", "{answer}");
    assert!(answer["notes"].to_string().contains(note), "{answer}");
}

#[cfg(unix)]
#[test]
fn closed_pipe_does_not_panic() {
    let folder = folder();
    // `true` does not read the pipe. A panic would print a message.
    let binary = assert_cmd::cargo::cargo_bin("colltrans");
    let script =
        format!("{} info cube.off cube.off | true; echo ${{PIPESTATUS[0]}}", binary.display());
    let output = assert_cmd::Command::new("bash")
        .current_dir(folder.path())
        .args(["-c", &script])
        .output()
        .unwrap();
    assert_eq!(stdout(&output), "0\n");
    assert_eq!(stderr(&output), "");
}
