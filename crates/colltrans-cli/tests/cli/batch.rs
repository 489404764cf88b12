//! `colltrans batch`: order, threads, invalid lines, streams.

use colltrans_testkit::TemporaryFolder;
use std::fmt::Write as _;
use std::io::{BufRead, BufReader, Write as _};
use std::process::{Command, Stdio};

use crate::support::{CONTACT_FIELDS, colltrans, fields_without, folder, json, stderr, stdout};
use serde_json::Value;

const BOX: &str =
    r#"{"points":[[0,0,0],[1,0,0],[1,1,0],[0,1,0],[0,0,1],[1,0,1],[1,1,1],[0,1,1],[0.5,0.5,0.5]]}"#;

/// Returns queries with increasing distances; every seventh is separated.
fn queries(count: usize) -> String {
    let mut text = String::new();
    for i in 0..count {
        let aside = if i % 7 == 0 { 3.0 } else { 0.125 };
        let body = if i % 3 == 0 { r#"{"mesh":"cube.off"}"# } else { BOX };
        let pose = format!(r#"{{"translation":[{},{aside},0.25]}}"#, -2.0 - i as f64);
        let _ = writeln!(
            text,
            r#"{{"id":{i},"moving":{body},"fixed":{BOX},"moving_pose":{pose},"direction":[1,0,0]}}"#
        );
    }
    text
}

fn run(text: &str, arguments: &[&str]) -> (std::process::Output, Vec<Value>) {
    let folder = folder();
    std::fs::write(folder.path().join("queries.jsonl"), text).unwrap();
    let output =
        colltrans(folder.path()).args(["batch", "queries.jsonl"]).args(arguments).output().unwrap();
    let results = stdout(&output).lines().map(json).collect();
    (output, results)
}

#[test]
fn results_are_ordered_and_equal_for_all_thread_counts() {
    let text = queries(3000);
    let (one, results) = run(&text, &["--threads", "1"]);
    assert_eq!(one.status.code(), Some(0), "{}", stderr(&one));
    assert_eq!(stderr(&one), "", "no progress bar where nobody looks");
    assert_eq!(results.len(), 3000);
    for (i, result) in results.iter().enumerate() {
        assert_eq!(result["id"], i);
        if i % 7 == 0 {
            assert_eq!(result["outcome"], "separated");
            let margin = result["margin"].as_f64().unwrap();
            assert!(margin > 0.0 && margin < 2.0 + 1e-12, "{result}");
        } else {
            assert_eq!(result["outcome"], "contact");
            assert_eq!(result["translation"], 1.0 + i as f64);
            assert_eq!(result["exit"], 3.0 + i as f64);
        }
    }
    for threads in ["2", "3", "16"] {
        let (many, _) = run(&text, &["--threads", threads]);
        assert!(many.stdout == one.stdout, "{threads} threads");
    }
}

#[test]
fn invalid_line_returns_one_error() {
    let good = format!(r#"{{"id":"good","moving":{BOX},"fixed":{BOX},"direction":[1,0,0]}}"#);
    let with = |from: &str, to: &str| good.replace(from, to).replace("good", "bad");
    let bad = [
        ("not json".to_string(), Value::Null, "column"),
        (with("\"direction\"", "\"directoin\""), "bad".into(), "unknown field `directoin`"),
        (with("[1,0,0]}", "[0,0,0]}"), "bad".into(), "direction"),
        (with("[1,0,0]}", "[1,0]}"), "bad".into(), "found a list of 2, expected a list of 3"),
        (with(BOX, r#"{"mesh":"none.off"}"#), "bad".into(), "none.off"),
        (with(BOX, r#"{"mesh":"dent.off"}"#), "bad".into(), r#""hull": true"#),
        (with(BOX, r#"{"points":[]}"#), "bad".into(), "no points"),
        (with(BOX, r#"{"points":[[1,2,1e999]]}"#), "bad".into(), "out of range"),
        (with(BOX, "{}"), "bad".into(), "exactly one of `points`, `sphere`"),
        (
            with("\"id\"", "\"moving_pose\":{\"rotation\":[0,0,0,2]},\"id\""),
            "bad".into(),
            "moving_pose",
        ),
        (with("\"id\"", "\"solver\":\"best\",\"id\""), "bad".into(), "unknown word `best`"),
        (with("\"id\"", "\"graze_tolerance\":-1,\"id\""), "bad".into(), "graze tolerance"),
    ];
    let mut text = String::new();
    for (line, _, _) in &bad {
        let _ = writeln!(text, "{line}\n{good}\n");
    }
    let (output, results) = run(&text, &[]);
    assert_eq!(results.len(), 2 * bad.len(), "blank lines have no result");
    for (pair, (line, id, word)) in results.chunks(2).zip(&bad) {
        assert_eq!(pair[1]["outcome"], "contact", "after {line}");
        assert_eq!(&pair[0]["id"], id, "{line}");
        assert_eq!(pair[0]["outcome"], "error", "{line}");
        let message = pair[0]["message"].as_str().unwrap();
        assert!(
            message.starts_with("line ") && message.contains(word),
            "{word:?} not in {message}"
        );
        assert_eq!(pair[0].as_object().unwrap().len(), 3);
    }
    assert_eq!(output.status.code(), Some(1));
    let (failed, all) = (bad.len(), 2 * bad.len());
    let expected = format!("error: {failed} of {all} queries have no answer\n");
    assert_eq!(stderr(&output), expected);
}

#[test]
fn many_blank_lines_are_skipped() {
    // More lines than one read returns.
    let text = format!("{}{}", " \n".repeat(2 << 20), queries(2));
    let (output, results) = run(&text, &["--threads", "2"]);
    assert!(output.status.success(), "{}", stderr(&output));
    assert_eq!(results.len(), 2);
}

#[test]
fn ids_are_repeated_verbatim() {
    let ids = [r#""a \u0062""#, "12345678901234567890123", "1.50", "null", "[1, {\"x\": 2}]"];
    let mut text = String::from("\u{feff}");
    for id in ids {
        let _ = write!(text, r#"{{"id":{id},"moving":{BOX},"fixed":{BOX},"direction":[1,0,0]}}"#);
        text.push_str("\r\n");
    }
    let (output, _) = run(&text, &[]);
    for (line, id) in stdout(&output).lines().zip(ids) {
        assert!(line.starts_with(&format!(r#"{{"id":{id},"outcome":"contact","#)), "{line}");
    }
}

#[test]
fn contact_result_has_the_documented_fields() {
    let query = format!(
        r#"{{"moving":{BOX},"fixed":{{"mesh":"cube.off"}},"direction":[1,0,0],
        "moving_pose":{{"translation":[-3,0.25,0.5],"rotation":[0,0,0,1]}},"fixed_pose":{{}},
        "graze_tolerance":1e-9,"solver":"portal"}}"#
    )
    .replace('\n', " ");
    let (_, results) = run(&query, &[]);
    let result = &results[0];
    assert_eq!(fields_without(result, &["id"]), CONTACT_FIELDS);
    assert_eq!(result["id"], Value::Null);
    assert_eq!(result["solver"], "portal");
    assert_eq!(result["point"][0], 0.0);
    let vertices = &result["features"]["moving"]["vertices"];
    let mut vertices: Vec<u64> =
        vertices.as_array().unwrap().iter().map(|v| v.as_u64().unwrap()).collect();
    vertices.sort_unstable();
    assert_eq!(vertices, [1, 2, 5, 6], "point 8 lies inside and is no vertex");
}

#[test]
fn queries_and_results_use_files_or_standard_streams() {
    let folder = folder();
    let nested = folder.path().join("sub");
    std::fs::create_dir(&nested).unwrap();
    let query =
        r#"{"moving":{"mesh":"../cube.off"},"fixed":{"mesh":"../cube.off"},"direction":[1,0,0]}"#;
    std::fs::write(nested.join("q.jsonl"), query).unwrap();
    let run = |arguments: &[&str]| colltrans(folder.path()).args(arguments).output().unwrap();
    let to_stdout = run(&["batch", "sub/q.jsonl"]);
    assert_eq!(json(&stdout(&to_stdout))["outcome"], "contact", "relative to the query file");
    let to_dash = run(&["batch", "sub/q.jsonl", "-o", "-"]);
    assert_eq!(to_dash.stdout, to_stdout.stdout);
    let to_file = run(&["batch", "sub/q.jsonl", "-o", "results.jsonl"]);
    assert_eq!((to_file.status.code(), stdout(&to_file)), (Some(0), String::new()));
    assert_eq!(std::fs::read(folder.path().join("results.jsonl")).unwrap(), to_stdout.stdout);
    let from_stdin = colltrans(folder.path())
        .args(["batch", "-"])
        .write_stdin(query.replace("../", ""))
        .output();
    assert_eq!(from_stdin.unwrap().stdout, to_stdout.stdout, "relative to the current folder");
    let hulls = colltrans(folder.path())
        .args(["batch", "-", "--hull"])
        .write_stdin(query.replace("../cube", "dent"))
        .output()
        .unwrap();
    assert_eq!(hulls.status.code(), Some(0), "{}", stdout(&hulls));

    for (arguments, code, word) in [
        (vec!["batch", "none.jsonl"], 3, "none.jsonl: cannot be read"),
        (vec!["batch", "sub"], 3, "sub"),
        (
            vec!["batch", "sub/q.jsonl", "-o", "no/such/folder"],
            5,
            "no/such/folder: cannot be written",
        ),
        (vec!["batch", "sub/q.jsonl", "--threads", "0"], 2, "--threads"),
    ] {
        let output = run(&arguments);
        assert_eq!(output.status.code(), Some(code), "{arguments:?}");
        assert!(stderr(&output).contains(word), "{}", stderr(&output));
    }
}

/// Each result is written before the next query is read.
#[test]
fn each_query_is_answered_before_the_next_arrives() {
    let folder = folder();
    let mut child = Command::new(assert_cmd::cargo::cargo_bin("colltrans"))
        .args(["batch", "-"])
        .current_dir(folder.path())
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut input = child.stdin.take().unwrap();
    let mut results = BufReader::new(child.stdout.take().unwrap()).lines();
    for line in queries(3).lines() {
        writeln!(input, "{line}").unwrap();
        let result = json(&results.next().unwrap().unwrap());
        assert_eq!(result["id"], json(line)["id"]);
    }
    drop(input);
    assert!(results.next().is_none());
    assert!(child.wait().unwrap().success());
}

#[cfg(unix)]
#[test]
fn closed_pipe_ends_the_batch_without_error() {
    let folder = folder();
    std::fs::write(folder.path().join("queries.jsonl"), queries(20_000)).unwrap();
    let binary = assert_cmd::cargo::cargo_bin("colltrans");
    let script =
        format!("{} batch queries.jsonl | head -n 1; echo ${{PIPESTATUS[0]}}", binary.display());
    let output = assert_cmd::Command::new("bash")
        .current_dir(folder.path())
        .args(["-c", &script])
        .output()
        .unwrap();
    assert!(stdout(&output).ends_with("}\n0\n"), "{}", stdout(&output));
    assert_eq!(stderr(&output), "");
}

#[test]
fn results_that_would_overwrite_the_queries_are_rejected() {
    let folder = TemporaryFolder::new();
    let path = folder.path().join("queries.jsonl");
    let text = "{\"moving\":{\"points\":[[0,0,0]]},\"fixed\":{\"points\":[[1,0,0]]},\"direction\":[1,0,0]}\n";
    std::fs::write(&path, text).unwrap();
    let output = assert_cmd::Command::cargo_bin("colltrans")
        .unwrap()
        .arg("batch")
        .arg(&path)
        .arg("-o")
        .arg(&path)
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(3));
    assert_eq!(std::fs::read_to_string(&path).unwrap(), text);
    let many = assert_cmd::Command::cargo_bin("colltrans")
        .unwrap()
        .args(["batch", "-", "--threads", "999999999"])
        .output()
        .unwrap();
    assert_eq!(many.status.code(), Some(2));
}

#[test]
fn type_errors_use_terms_of_json() {
    let text = r#"{"moving": 3}
{"moving": {"points": "all"}}
{"moving": {"points": [[1, 2, "z"]]}}
{"direction": "x"}
{"direction": [1, "a", 2]}
{"moving_pose": 4}
{"graze_tolerance": "a"}
{"ignore_start_overlaps": 1}
{"moving": {"mesh": 3}}
[]"#;
    let (_, results) = run(text, &[]);
    assert_eq!(results.len(), 10);
    for (result, word) in results.iter().zip([
        "expected an object with a body",
        "expected a list",
        "expected a number",
        "expected a list of 3",
        "expected a number",
        "expected an object with a pose",
        "expected a number",
        "expected a boolean",
        "expected a path",
        "expected an object with a query",
    ]) {
        let message = result["message"].as_str().unwrap();
        assert!(message.contains(word), "{message}");
        for name in ["f64", "struct", "Query", "Source", "tuple", "PathBuf"] {
            assert!(!message.contains(name), "{message}");
        }
    }
}

#[test]
fn merged_vertices_are_noted_in_the_result() {
    let folder = folder();
    // One face of the tetrahedron has a nearby copy of the first corner.
    let text = "OFF\n5 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1e-17 0 0\n\
        3 0 2 1\n3 0 1 3\n3 4 3 2\n3 1 2 3\n";
    std::fs::write(folder.path().join("twins.off"), text).unwrap();
    let query = |of: &str| {
        format!(
            r#"{{"moving": {{"{of}": "twins.off"}}, "fixed": {{"{of}": "cube.off"}}, "direction": [1,0,0]}}"#
        )
    };
    let queries = format!("{}\n{}\n", query("mesh"), query("solid"));
    std::fs::write(folder.path().join("q.jsonl"), queries).unwrap();
    let output = colltrans(folder.path()).args(["batch", "q.jsonl"]).output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", stdout(&output));
    for line in stdout(&output).lines() {
        let notes = json(line)["notes"].clone();
        assert_eq!(notes.as_array().map(Vec::len), Some(1), "{line}");
        let note = notes[0].as_str().unwrap();
        assert!(note.contains("twins.off: 1 vertex on open edges merged"), "{note}");
    }
}

/// A killed run leaves the old file, and only a partial file with another name.
#[cfg(unix)]
#[test]
fn killed_batch_leaves_the_old_results() {
    let folder = folder();
    for name in ["new.jsonl", "old.jsonl"] {
        let path = folder.path().join(name);
        if name.starts_with("old") {
            std::fs::write(&path, "old\n").unwrap();
        }
        let mut child = Command::new(assert_cmd::cargo::cargo_bin("colltrans"))
            .args(["batch", "-", "-o", name])
            .current_dir(folder.path())
            .stdin(Stdio::piped())
            .spawn()
            .unwrap();
        let mut input = child.stdin.take().unwrap();
        input.write_all(queries(600).as_bytes()).unwrap();
        // Waits until some results are written.
        let partial = || {
            let entries = std::fs::read_dir(folder.path()).unwrap();
            let mut paths = entries.map(|entry| entry.unwrap().path());
            paths.find(|p| {
                p.to_string_lossy().ends_with(".partial") && p.metadata().unwrap().len() > 0
            })
        };
        let written = loop {
            if let Some(path) = partial() {
                break path;
            }
            std::thread::sleep(std::time::Duration::from_millis(5));
        };
        child.kill().unwrap();
        child.wait().unwrap();
        let left = std::fs::read_to_string(&path).ok();
        assert_eq!(left.as_deref(), name.starts_with("old").then_some("old\n"));
        std::fs::remove_file(written).unwrap();
    }
}

/// Bodies in contact may separate, and are blocked if they are pushed into each other.
#[test]
fn motion_clearance_queries_are_answered() {
    let line = |body: &str, more: &str| {
        format!(r#"{{"moving":{body},"fixed":{BOX},"query":"motion_clearance",{more}}}"#)
    };
    let touching =
        r#""moving_motion":{"slide":{"by":[-4,0,0]}},"fixed_pose":{"translation":[1,0,0]}"#;
    let pushed = touching.replace("-4", "4");
    let solid = r#"{"solid":"cube.off"}"#;
    let lines = [
        line(
            BOX,
            r#""moving_motion":{"slide":{"by":[4,0,0]}},"fixed_pose":{"translation":[3,0.1,0.1]}"#,
        ),
        line(BOX, touching),
        line(BOX, &pushed),
        line(solid, touching),
        line(solid, &pushed),
        line(solid, r#""moving_motion":{"slide":{"by":[4,0,0]}}"#),
    ];
    let (_, results) = run(&lines.join("\n"), &[]);
    let outcomes: Vec<&str> = results.iter().map(|r| r["outcome"].as_str().unwrap()).collect();
    assert_eq!(outcomes, ["blocked", "free", "blocked", "free", "blocked", "overlapping"]);
    assert!((results[0]["time"]["lower"].as_f64().unwrap() - 0.5).abs() < 1e-9, "{}", results[0]);
    assert!(results[0]["shrunk_time"]["upper"].is_number(), "{}", results[0]);
    assert_eq!(results[2]["time"]["lower"], 0.0);
    assert!(results[5]["start_overlaps"][0].is_object(), "{}", results[5]);
}

#[test]
fn motion_queries_are_answered_or_rejected() {
    let line = |body: &str, more: &str| {
        format!(r#"{{"id":1,"moving":{body},"fixed":{BOX},"query":"motion",{more}}}"#)
    };
    let asked = |more: &str| line(BOX, more);
    let there = r#""fixed_pose":{"translation":[3,0.1,0.1]}"#;
    let turn = r#"{"turn":{"point":[0,0,0],"axis":[0,0,1],"radians":6}}"#;
    let good = [
        (r#"{"slide":{"by":[4,0,0]}}"#, "contact"),
        (r#"{"screw":{"point":[1.5,0,0],"axis":[0,0,1],"radians":3.5,"rise":0.5}}"#, "contact"),
        (turn, "free"),
        (
            r#"{"thrown":{"center":[0,0,0],"velocity":[4,0,0],"angular_velocity":[1,2,3]}}"#,
            "contact",
        ),
        (r#"{"between":{"from":{},"to":{"translation":[8,0,0],"rotation":[0,0,1,0]}}}"#, "free"),
        (r#"{"between":{"from":{},"to":{"translation":[8,0,0],"rotation":[1,0,0,0]}}}"#, "contact"),
        (r#"{"through":{"poses":[{},{"translation":[0,5,0]},{"translation":[8,5,0]}]}}"#, "free"),
        (r#"{"still":{}}"#, "free"),
    ];
    let text: Vec<String> = good
        .iter()
        .map(|(motion, _)| asked(&format!(r#""moving_motion":{motion},{there}"#)))
        .chain([
            asked(&format!(r#""fixed_motion":{{"slide":{{"by":[-4,0,0]}}}},{there}"#)),
            asked(&format!(
                r#""moving_motion":{turn},"fixed_motion":{turn},{there},"min_gap":0.5"#
            )),
            asked(&format!(r#""moving_motion":{turn}"#)),
            line(r#"{"solid":"cube.off"}"#, &format!(r#""moving_motion":{},{there}"#, good[1].0)),
        ])
        .collect();
    let (output, results) = run(&text.join("\n"), &[]);
    assert_eq!(output.status.code(), Some(0), "{}", stdout(&output));
    let outcomes: Vec<&str> = results.iter().map(|r| r["outcome"].as_str().unwrap()).collect();
    let known: Vec<&str> = good.iter().map(|(_, outcome)| *outcome).collect();
    assert_eq!(outcomes, [&known[..], &["contact", "free", "overlapping", "contact"]].concat());
    let [convex, solid] = [&results[1], &results[results.len() - 1]];
    let apart =
        convex["time"]["lower"].as_f64().unwrap() - solid["time"]["lower"].as_f64().unwrap();
    assert!(apart.abs() < 1e-11 && solid["tolerance"].as_f64().unwrap() < 1e-11, "{solid}");
    let [lower, upper] = ["lower", "upper"].map(|end| results[0]["time"][end].as_f64().unwrap());
    assert!(lower <= 0.5 && 0.5 <= upper && upper - lower < 1e-13, "{}", results[0]);
    assert_eq!(results[0]["normal"], serde_json::json!([1.0, 0.0, 0.0]));
    assert_eq!(results[0]["features"]["fixed"]["kind"], "face");
    assert_eq!(results[9]["min_gap"], 0.5);

    let moved = format!(r#""moving_motion":{turn}"#);
    let bad = [
        (asked(there), "\"motion\" needs a `moving_motion` or a `fixed_motion`"),
        (
            asked(&format!(r#"{moved},"direction":[1,0,0]"#)),
            "`direction` does not belong to this query",
        ),
        (
            asked(&format!(r#"{moved},"min_gap":1,"tolerance":1"#)),
            "either `min_gap` or `tolerance`",
        ),
        (asked(&format!(r#"{moved},"min_gap":-1"#)), "-1"),
        (asked(&moved.replace("axis\":[0,0,1]", "axis\":[0,0,0]")), "moving_motion: the axis"),
        (asked(&moved.replace('6', "1e9")), "moving_motion: the angle"),
        (
            asked(r#""moving_motion":{"slide":{"by":[1,0,0]},"still":{},"spin":7}"#),
            "moving_motion: a motion has one kind; remove `still`",
        ),
        (asked(r#""moving_motion":{}"#), "the field that gives the kind is missing"),
        (asked(r#""moving_motion":{"still":null}"#), "found null, expected an object"),
        (asked(r#""moving_motion":{"slide":[1,0,0]}"#), "found a list, expected an object"),
        (asked(&moved.replace("\"axis\":[0,0,1],", "")), "missing field `axis`"),
        (asked(&moved.replace("turn", "twist")), "unknown word `twist`"),
        (asked(r#""moving_motion":{"through":{"poses":[]}}"#), "at least one pose"),
        (
            asked(r#""moving_motion":{"through":{"poses":[{},{"rotation":[0,0,0,3]}]}}"#),
            "moving_motion: pose 1: ",
        ),
        (
            asked(r#""moving_motion":{"through":{"poses":[{}]}},"moving_pose":{}"#),
            "`between` and `through` have their own poses",
        ),
        (
            asked(&moved).replace("\"motion\"", "\"distance\""),
            "`moving_motion` requires \"query\": \"motion\"",
        ),
        (
            asked(&format!(r#"{moved},"direction":[1,0,0]"#)).replace(r#""query":"motion","#, ""),
            "`moving_motion` requires \"query\": \"motion\"",
        ),
    ];
    let text: Vec<&str> = bad.iter().map(|(line, _)| line.as_str()).collect();
    let (output, results) = run(&text.join("\n"), &[]);
    assert_eq!(output.status.code(), Some(1));
    for (k, ((line, why), result)) in bad.iter().zip(&results).enumerate() {
        let message = result["message"].as_str().unwrap();
        assert_eq!((&result["outcome"], &result["id"]), (&"error".into(), &1.into()), "{line}");
        assert!(message.contains(why), "{message}, not {why}: {line}");
        assert!(message.starts_with(&format!("line {}", k + 1)), "{message}");
    }
}

/// The rule for quaternions with few digits is that of `--moving-pose`, with one note for each field.
#[test]
fn quaternions_with_few_digits_are_normalised_with_a_note() {
    let line = |body: &str, fields: &str| format!(r#"{{"moving":{body},"fixed":{BOX},{fields}}}"#);
    let rounded = r#""moving_pose":{"translation":[-3,0.25,0.5],"rotation":[0,0,0.707,0.707]}"#;
    let exact = rounded.replace("0.707", "0.7071067811865476");
    let poses = r#""moving_motion":{"through":{"poses":[{"rotation":[0,0,0.7071,0.7071]},
        {"translation":[0,5,0]},{"translation":[8,5,0],"rotation":[0,0.71,0,0.71]}]}}"#;
    let solid = r#"{"solid":"cube.off"}"#;
    let text = [
        line(BOX, &format!(r#"{rounded},"direction":[1,0,0]"#)),
        line(BOX, &format!(r#"{exact},"direction":[1,0,0]"#)),
        line(solid, &format!(r#"{rounded},"direction":[1,0,0]"#)),
        line(BOX, &format!(r#"{},"query":"distance""#, rounded.replace("moving_", "fixed_"))),
        line(
            BOX,
            &format!(r#"{rounded},"query":"motion","moving_motion":{{"slide":{{"by":[1,0,0]}}}}"#),
        ),
        line(BOX, &format!(r#""query":"motion",{}"#, poses.replace('\n', ""))),
        line(BOX, &format!(r#"{},"direction":[1,0,0]"#, rounded.replace("0.707", "0.68"))),
    ];
    let (output, results) = run(&text.join("\n"), &[]);
    assert_eq!(output.status.code(), Some(1), "{}", stdout(&output));
    let note = |k: usize| match results[k]["notes"].as_array() {
        Some(notes) => notes.iter().map(|note| note.as_str().unwrap()).collect::<Vec<_>>(),
        None => Vec::new(),
    };
    let said = "the quaternion has length 0.999849, not 1; it was normalised, and a direction may be off by 2e-4";
    let of_moving = [format!("moving_pose: {said}")];
    assert_eq!(note(0), of_moving);
    assert_eq!(results[0]["translation"], results[1]["translation"]);
    assert_eq!(note(1), [""; 0]);
    assert_eq!(note(2), of_moving);
    assert_eq!(note(3), [format!("fixed_pose: {said}")]);
    assert_eq!(note(4), of_moving);
    let [through] = note(5)[..] else { panic!("{}", results[5]) };
    assert!(
        through.starts_with("moving_motion: pose 2: the quaternion has length 1.004092"),
        "{through}"
    );
    assert!(through.ends_with("; 2 poses were normalised"), "{through}");
    assert_eq!(results[6]["outcome"], "error");
    assert!(results[6]["message"].as_str().unwrap().contains("moving_pose: "), "{}", results[6]);
}

/// Returns the result of each query with only these fields.
fn with_only(results: &[Value], fields: &[&str]) -> Vec<Value> {
    let only = |result: &Value| {
        let kept = result.as_object().unwrap().iter();
        kept.filter(|(name, _)| fields.contains(&&***name))
            .map(|(n, v)| (n.clone(), v.clone()))
            .collect()
    };
    results.iter().map(only).collect()
}

#[test]
fn requested_fields_have_the_values_of_complete_answers() {
    let pair = |question: &str| {
        format!(
            r#"{{"moving":{BOX},"fixed":{BOX},"moving_pose":{{"translation":[-3,0.25,0.5]}},{question}}}"#
        )
    };
    let motion = r#""query":"motion","moving_motion":{"slide":{"by":[4,0,0]}}"#;
    let text = [
        queries(20),
        pair(r#""direction":[1,0,0],"query":"clearance""#),
        pair(r#""direction":[-1,0,0],"query":"clearance""#),
        pair(r#""query":"distance""#),
        pair(motion),
        pair(r#""direction":[0,0,0]"#),
        pair(r#""direction":[1,0,0]"#).replace("0.25,0.5", "1,0.5"),
        "no query".into(),
    ];
    let text = text.map(|lines| lines.trim_end().to_owned()).join("\n");
    let (_, complete) = run(&text, &[]);
    let always = ["id", "outcome", "looks"];
    for fields in [
        &["translation", "features"][..],
        &["translation_bounds", "normal"],
        &["exit", "point"],
        &["lower", "upper", "time", "distance", "exit_bounds"],
        &["outcome"],
        &["message", "margin"],
    ] {
        let (_, some) = run(&text, &["--fields", &fields.join(",")]);
        let kept = [fields, &always].concat();
        let expected: Vec<_> = complete
            .iter()
            .map(|result| {
                let is_error = result["outcome"] == "error";
                let kept = if is_error { vec!["id", "outcome", "message"] } else { kept.clone() };
                with_only(std::slice::from_ref(result), &kept).remove(0)
            })
            .collect();
        assert_eq!(some, expected, "{fields:?}");
    }
}

#[test]
fn unknown_fields_are_rejected() {
    let (output, results) = run(&queries(1), &["--fields", "translation,margn"]);
    assert!(!output.status.success() && results.is_empty());
    let message = stderr(&output);
    assert!(message.contains("margn") && message.contains("margin"), "{message}");
}
