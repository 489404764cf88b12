//! `colltrans audit`: exit codes, text, JSON, tables and wrong arguments.

use std::path::Path;
use std::process::Output;

use colltrans_testkit::TemporaryFolder;
use serde_json::Value;

use crate::support::{self, data, folder, json, stderr, stdout};

/// Returns a folder with cubes: `high` runs 0.25 into `low`, `grain` lies inside `low`, `near` is 0.5 from `low`, and
/// `on` stands on `near`.
fn cubes() -> TemporaryFolder {
    let folder = folder();
    let mut text = String::from("unit = 'mm'\n");
    for (name, at, scale) in [
        ("low", [0.0, 0.0, 0.0], 1.0),
        ("high", [0.0, 0.0, 0.75], 1.0),
        ("grain", [0.25, 0.25, 0.25], 0.25),
        ("near", [1.5, 0.0, 0.0], 1.0),
        ("on", [1.5, 0.0, 1.0], 1.0),
    ] {
        let place = format!("translation = {at:?}\nscale = {scale}\n");
        text += &["[[part]]\nfile = 'cube.off'\nname = '", name, "'\n", &place].concat();
    }
    std::fs::write(folder.path().join("cubes.toml"), text).unwrap();
    folder
}

fn of_audit<'a>(arguments: &[&'a str]) -> Vec<&'a str> {
    [&["audit"][..], arguments].concat()
}

fn run(folder: &Path, arguments: &[&str]) -> Output {
    support::run(folder, &of_audit(arguments))
}

fn refused(folder: &Path, arguments: &[&str], code: i32, words: &[&str]) {
    support::refused(folder, &of_audit(arguments), code, words);
}

/// Runs an audit, asserts its exit code, and returns its text and its messages.
fn text(folder: &Path, arguments: &[&str], code: i32) -> [String; 2] {
    let output = run(folder, arguments);
    assert_eq!(output.status.code(), Some(code), "{arguments:?}: {}", stderr(&output));
    [stdout(&output), stderr(&output)]
}

#[test]
fn violations_are_listed_worst_first_with_exit_code_1() {
    let folder = cubes();
    let [found, message] = text(folder.path(), &["cubes.toml", "--within", "0.6"], 1);
    let lines: Vec<&str> = found.lines().filter(|line| line.starts_with("  ")).collect();
    let expected = [
        "  low, high by 0.250001: interfering, depth 0.25",
        "  low, grain: grain contained, depth 0.5",
        "  near, on: touching, at ",
        "  high, grain: 0.25",
        "  low, near: 0.5",
        "  low, on: 0.5",
        "  high, near: 0.5",
        "  high, on: 0.5",
    ];
    assert_eq!(lines.len(), expected.len(), "{found}");
    for expected in expected {
        assert!(lines.iter().any(|line| line.starts_with(expected)), "{expected}: {found}");
    }
    assert!(lines[0].starts_with(expected[0]) && lines[1].starts_with(expected[1]), "{found}");
    assert!(lines[0].contains(", volume 0.25") && lines[0].contains(", at "), "{found}");
    assert!(lines[1].contains(", wall 0.25") && !lines[0].contains("wall"), "{found}");
    assert!(found.contains("clearance: 0.6\n"), "{found}");
    let counts = "1 interfering, 1 contained, 1 touching, 5 nearer than the clearance";
    assert!(found.contains(counts), "{found}");
    assert_eq!(message, "error: 8 pairs interfere or are nearer than the clearance\n");
    let [found, _] = text(folder.path(), &["cubes.toml", "--within", "0.6", "--limit", "2"], 1);
    assert!(found.contains("  and 6 more\n") && !found.contains("touching, at"), "{found}");
}

#[test]
fn assemblies_without_violations_have_exit_code_0() {
    let folder = cubes();
    let place = folder.path();
    let only = ["cubes.toml", "--ignore", "low,high", "--ignore-always", "low,grain"];
    let [found, message] = text(place, &only, 0);
    assert!(
        found.ends_with("1 touching, 0 nearer than the clearance\n2 pairs ignored or glued\n"),
        "{found}"
    );
    assert!(message.is_empty());
    let near = [&only[..], &["--within", "0.5", "--within", "high,grain=0.1"]].concat();
    assert!(text(place, &near, 1)[0].contains("near, on: touching"), "a contact is no clearance");
    text(place, &[&near[..], &["--allow-contact"]].concat(), 0);
    let fitted = ["--fit", "low,high=0.3", "--pair", "near,on=0.1", "--ignore", "low,grain"];
    text(place, &[&["cubes.toml"][..], &fitted].concat(), 0);
    text(place, &["cubes.toml", "--tolerance", "0.3", "--ignore", "low,grain"], 0);
    text(place, &["cube.off", "--within", "5"], 0);
    assert_eq!(text(&data(), &["gearbox_small"], 0)[1], "");
}

#[test]
fn json_and_table_have_all_pairs() {
    let folder = cubes();
    let arguments = ["cubes.toml", "--json", "--csv", "pairs.csv"];
    let [found, _] = text(folder.path(), &arguments, 1);
    let found: Value = json(&found);
    let pairs = found["pairs"].as_array().unwrap();
    let findings: Vec<&str> = pairs.iter().map(|pair| pair["finding"].as_str().unwrap()).collect();
    assert_eq!(findings, ["interfering", "contained", "touching"]);
    assert_eq!((&found["unit"], &found["within"]), (&"mm".into(), &0.0.into()));
    assert_eq!(
        (&found["levels"], &found["allow_contact"]),
        (&serde_json::json!([]), &false.into())
    );
    assert_eq!(pairs[1]["inner"], "grain");
    let wall: [f64; 2] = serde_json::from_value(pairs[1]["wall"].clone()).unwrap();
    assert!(wall[0] <= 0.25 && 0.25 <= wall[1] && wall[1] - wall[0] < 1e-9, "{wall:?}");
    let [outer, inner]: [[f64; 3]; 2] =
        serde_json::from_value(pairs[1]["wall_points"].clone()).unwrap();
    // The faces at 0 and at 0.25 of one axis.
    assert!((0..3).any(|axis| [outer[axis], inner[axis]] == [0.0, 0.25]), "{outer:?} {inner:?}");
    assert_eq!(found["counts"]["violations"], 2);
    let bounds: [f64; 2] = serde_json::from_value(pairs[0]["depth"].clone()).unwrap();
    assert!(bounds[0] <= 0.25 && 0.25 <= bounds[1] && bounds[1] - bounds[0] < 1e-9, "{bounds:?}");
    let table = std::fs::read_to_string(folder.path().join("pairs.csv")).unwrap();
    let lines: Vec<&str> = table.lines().collect();
    assert_eq!(lines.len(), 4, "{table}");
    assert!(lines[0].starts_with("first,second,finding,violation,clearance,distance_lower"));
    assert!(lines[1].starts_with("low,high,interfering,yes,0,,,0.2"), "{table}");
    assert!(lines[3].starts_with("near,on,touching,no,0,0,0,,,"), "{table}");
    let ending = ",tolerance,other_x,other_y,other_z,wall_lower,wall_upper,wall_x,wall_y,wall_z,\
                  other_wall_x,other_wall_y,other_wall_z,inner,role,open,proofs";
    assert!(lines[0].ends_with(ending), "{table}");
    assert!(lines[2].contains(",,,,0.2") && lines[2].ends_with(",grain,,,"), "{table}");
    let columns = lines[0].split(',').count();
    assert!(lines.iter().all(|line| line.split(',').count() == columns), "{table}");
    let one = text(folder.path(), &["cubes.toml", "--json", "--threads", "1"], 1);
    assert_eq!(json(&one[0]), found);
}

#[test]
fn hostile_names_are_escaped() {
    let folder = folder();
    let place = folder.path();
    let names = ["=1+1", "a,\"b\"\u{1b}[2J\n<script>\u{202e}"];
    let manifest = serde_json::json!({"parts": [
        {"file": "cube.off", "name": names[0]},
        {"file": "cube.off", "name": names[1], "translation": [0, 0, 0.5]},
    ]});
    std::fs::write(place.join("m.json"), manifest.to_string()).unwrap();
    let [found, _] = text(place, &["m.json", "--csv", "pairs.csv"], 1);
    assert!(found.contains(r#"  =1+1, a,"b"\u{1b}[2J\n<script>\u{202e} by 0.5"#), "{found}");
    let table = std::fs::read_to_string(place.join("pairs.csv")).unwrap();
    let row = r#"'=1+1,"a,""b""\u{1b}[2J\n<script>\u{202e}",interfering,yes,"#;
    assert!(table.lines().nth(1).unwrap().starts_with(row), "{table}");
    let [found, _] = text(place, &["m.json", "--json"], 1);
    assert!(!found.contains(['\u{1b}', '\u{202e}']));
    assert_eq!(json(&found)["pairs"][0]["parts"], serde_json::json!(names));
    let output = run(place, &["m.json", "--within", "\u{1b}[31m,x=1"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(!stderr(&output).contains('\u{1b}'));
}

#[test]
fn wrong_arguments_and_sources_are_rejected() {
    let folder = cubes();
    let place = folder.path();
    let given = |words: &[&'static str]| [&["cubes.toml"][..], words].concat();
    for (words, said) in [
        (["--within", "-1"], "must be finite and not negative"),
        (["--within", "wide"], "is not a number"),
        (["--within", "low=1"], "two names and a length, A,B=L"),
        (
            ["--within", "low,lo=1"],
            "did you mean low? `lo*` stands for all names that begin with lo",
        ),
        (["--within", "1e70"], "invalid clearance 1e70"),
        (["--tolerance", "nan"], "--tolerance"),
        (["--ignore", "low,none"], "unknown part none"),
        (["--fit", "low,high"], "expected two names and a tolerance"),
        (["--limit", "few"], "--limit"),
        (["--csv", "-"], "standard output has the answer"),
        (["--report", "-"], "give the name of a file"),
        (["--bcf", "-"], "give the name of a file"),
        (["--joint", "elbow"], "expected NAME=VALUE"),
    ] {
        refused(place, &given(&words), 2, &[said]);
    }
    refused(place, &["nowhere"], 3, &["nowhere: cannot be read"]);
    std::fs::write(place.join("model.py"), "").unwrap();
    refused(
        place,
        &["model.py"],
        3,
        &["unknown kind of source", ".urdf", "STEP file (.step, .stp)"],
    );
    std::fs::write(place.join("lost.toml"), "[[part]]\nfile = 'gone.off'\n").unwrap();
    let lost = "1 referenced mesh not found: gone.off; correct the paths, or skip missing meshes (--skip-missing";
    refused(place, &["lost.toml"], 3, &[lost]);
    refused(place, &["broken.off"], 3, &["broken.off", "line"]);
    std::fs::create_dir(place.join("empty")).unwrap();
    refused(place, &["empty"], 3, &["the folder has no STL"]);
    let over = ["--csv", "cube.off"];
    refused(place, &given(&over), 3, &["is the same file as the input", "another name"]);
    refused(place, &given(&["--csv", "empty"]), 5, &["empty"]);
    assert!(run(place, &[]).status.code() == Some(2));
}

#[test]
fn assembly_names_the_interference_of_overlapping_pairs() {
    let folder = cubes();
    let found = support::answered(folder.path(), &["assembly", "cubes.toml"]);
    assert!(found.contains("  low, high by 0.250001: interfering, depth 0.25"), "{found}");
    assert!(found.contains(": grain contained, depth 0.5"), "{found}");
}

#[test]
fn ignored_and_glued_pairs_take_groups() {
    let folder = cubes();
    let place = folder.path();
    for option in ["--ignore", "--ignore-always", "--glued"] {
        let [found, _] = text(place, &["cubes.toml", option, "low,*"], 0);
        assert!(found.contains("\n2 pairs ignored or glued\n"), "{option}: {found}");
        let [found, _] = text(place, &["cubes.toml", option, "l*,h*"], 1);
        assert!(found.contains("0 interfering, 1 contained"), "{option}: {found}");
        refused(place, &["cubes.toml", option, "l*,low"], 2, &["names the same part twice"]);
        refused(place, &["cubes.toml", option, "low,z*"], 2, &["unknown part z*"]);
    }
    let manifest = std::fs::read_to_string(place.join("cubes.toml")).unwrap();
    let manifest = ["ignore = [['low', '*']]\n", &manifest].concat();
    std::fs::write(place.join("ignored.toml"), manifest).unwrap();
    text(place, &["ignored.toml"], 0);
}

#[test]
fn options_without_effect_and_single_parts_have_notes() {
    let folder = cubes();
    let place = folder.path();
    let options = ["--joint", "a=1", "--chord", "0.1", "--visual"];
    let [_, notes] = text(place, &[&["cubes.toml"][..], &options].concat(), 1);
    for (option, kind) in [("--joint", "URDF"), ("--visual", "URDF"), ("--chord", "STEP")] {
        let note = format!("note: {option} has no effect: cubes.toml is not a {kind} file\n");
        assert!(notes.contains(&note), "{notes}");
    }
    let [found, notes] = text(place, &["cube.off"], 0);
    assert!(found.contains("0 pairs examined"), "{found}");
    assert_eq!(notes, "note: cube.off has one part, so that there are no pairs\n");
    let files = ["--csv", "a.html", "--report", "b.HTM", "--bcf", "c.csv"];
    let [_, notes] = text(place, &[&["cubes.toml"][..], &files].concat(), 1);
    assert!(notes.contains("note: a.html: --csv writes a table (.csv)\n"), "{notes}");
    assert!(notes.contains("note: c.csv: --bcf writes a BCF file (.bcf)\n"), "{notes}");
    assert!(!notes.contains("b.HTM"), "{notes}");
}

#[test]
fn settings_are_in_the_text() {
    let folder = cubes();
    let words = ["--within", "2", "--within", "0.25", "--within", "n*,low=0.4", "--allow-contact"];
    let [found, _] = text(folder.path(), &[&["cubes.toml"][..], &words].concat(), 1);
    assert!(
        found.contains("\nclearance: 0.25, contacts permitted\nclearance of n* and low: 0.4\n"),
        "{found}"
    );
}

#[test]
fn outputs_are_checked_before_the_work() {
    let folder = cubes();
    let place = folder.path();
    // The source does not exist; the outputs are examined first.
    let same = ["nowhere", "--csv", "same", "--bcf", "./same"];
    refused(place, &same, 2, &["same and ./same are one output file; give them two names"]);
    let names = || std::fs::read_dir(place).unwrap().count();
    let before = names();
    let files = ["cubes.toml", "--csv", "pairs.csv", "--bcf", "none/clashes.bcf"];
    refused(place, &files, 5, &["none/clashes.bcf: cannot be written"]);
    assert_eq!(names(), before, "no file is written");
    std::fs::write(place.join("yard.toml"), "unit = 'yd'\n[[part]]\nfile = 'cube.off'\n").unwrap();
    let yard = ["yard.toml", "--bcf", "clashes.bcf"];
    refused(place, &yard, 3, &["clashes.bcf: unknown unit yd; BCF needs one of m, mm, cm"]);
    let [_, message] = text(place, &["cube.off", "--bcf", "clashes.bcf"], 0);
    assert!(message.contains(
        "note: clashes.bcf: the source has no unit; its coordinates are taken to be in metres"
    ));
}

#[test]
fn report_and_bcf_file_have_the_violations_and_a_fixed_date() {
    let folder = cubes();
    let run_at = |seconds: &str| {
        let files = ["--report", "clashes.html", "--bcf", "clashes.bcf"];
        let arguments = [&["audit", "cubes.toml", "--within", "0.6"][..], &files].concat();
        let mut command = std::process::Command::new(assert_cmd::cargo::cargo_bin("colltrans"));
        command.current_dir(folder.path()).env("SOURCE_DATE_EPOCH", seconds).args(arguments);
        command.output().unwrap()
    };
    assert_eq!(run_at("951782400").status.code(), Some(1));
    let read = |name: &str| std::fs::read(folder.path().join(name)).unwrap();
    let page = String::from_utf8(read("clashes.html")).unwrap();
    assert!(page.contains("<h1>cubes</h1>") && page.contains("low · high"));
    let first = read("clashes.bcf");
    assert!(first.starts_with(b"PK"));
    // The same second gives the same bytes, another one does not.
    run_at("951782400");
    assert_eq!(first, read("clashes.bcf"));
    run_at("951782401");
    assert_ne!(first, read("clashes.bcf"));
    let wrong = run_at("yesterday");
    assert_eq!(wrong.status.code(), Some(2));
    assert!(stderr(&wrong).contains("SOURCE_DATE_EPOCH=yesterday: expected seconds since 1970"));
    for flag in ["--report", "--bcf"] {
        refused(
            folder.path(),
            &["cubes.toml", flag, "cube.off"],
            3,
            &["is the same file as the input"],
        );
    }
}

/// Returns the names of the files of a folder, sorted.
fn file_names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap();
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

/// Returns the statement of each file of a folder, by `colltrans verify`.
fn verified(folder: &Path, proofs: &str) -> Vec<Value> {
    let names = file_names(&folder.join(proofs));
    let paths: Vec<String> = names.iter().map(|name| format!("{proofs}/{name}")).collect();
    let mut arguments = vec!["verify", "--json"];
    arguments.extend(paths.iter().map(String::as_str));
    let output = support::run(folder, &arguments);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let lines: Vec<Value> = stdout(&output).lines().map(json).collect();
    assert!(lines.iter().zip(&paths).all(|(line, path)| line["file"] == path.as_str()));
    lines
}

#[test]
fn proofs_of_all_pairs_are_verified() {
    let folder = cubes();
    let place = folder.path();
    let arguments =
        ["cubes.toml", "--within", "0.6", "--proofs", "new/proofs", "--json", "--csv", "pairs.csv"];
    let report = ["--report", "report.html"];
    let [found, _] = text(place, &[&arguments[..], &report].concat(), 1);
    let found: Value = json(&found);
    let names = file_names(&place.join("new/proofs"));
    let table = std::fs::read_to_string(place.join("pairs.csv")).unwrap();
    let page = std::fs::read_to_string(place.join("report.html")).unwrap();
    let mut listed = Vec::new();
    for (pair, row) in found["pairs"].as_array().unwrap().iter().zip(table.lines().skip(1)) {
        let claims: Vec<&str> =
            pair["proofs"].as_object().unwrap().keys().map(String::as_str).collect();
        let expected: &[&str] = match pair["finding"].as_str().unwrap() {
            "apart" => &["distance"],
            "touching" => &["depth", "distance"],
            _ => &["common_part", "depth"],
        };
        assert_eq!((claims.as_slice(), &pair["unproven"]), (expected, &Value::Null), "{pair}");
        let proofs = pair["proofs"].as_object().unwrap();
        for name in proofs.values().map(|name| name.as_str().unwrap()) {
            assert!(row.contains(name) && page.contains(name), "{name}: {row}");
            listed.push(name.to_owned());
        }
    }
    listed.sort();
    assert_eq!(listed, names);
    assert_eq!(names[0], "001-low--high-common_part.json");
    let statements = verified(place, "new/proofs");
    assert_eq!(statements.len(), 11);
    let of = |name: &str| {
        let at = names.iter().position(|known| known == name).unwrap_or_else(|| panic!("{name}"));
        &statements[at]
    };
    let bounds =
        |value: &Value| [value["lower"].as_f64().unwrap(), value["upper"].as_f64().unwrap()];
    let [lower, upper] = bounds(of("001-low--high-depth.json"));
    assert!(lower <= 0.25 && 0.25 <= upper && upper - lower < 1e-9, "{lower} {upper}");
    assert_eq!(of("002-low--grain-common_part.json")["relation"], "fixed_contained");
    let [lower, upper] = bounds(of("003-near--on-depth.json"));
    assert!(lower == 0.0 && upper > 0.0 && upper < 1e-9, "{lower} {upper}");
    assert_eq!(bounds(of("003-near--on-distance.json")), [0.0; 2]);
    let [lower, upper] = bounds(of("004-high--grain-distance.json"));
    assert!(lower <= 0.25 && 0.25 <= upper && upper - lower < 1e-9, "{lower} {upper}");
    // The proofs of an earlier audit would be taken for those of this one.
    refused(place, &["cubes.toml", "--proofs", "new/proofs"], 2, &["new/proofs", "not empty"]);
    let one = ["cubes.toml", "--within", "0.6", "--proofs", "one", "--threads", "1"];
    let [found, _] = text(place, &one, 1);
    assert!(found.ends_with("11 proofs in one\n"), "{found}");
    for name in names {
        let read = |folder: &str| std::fs::read(place.join(folder).join(&name)).unwrap();
        assert!(read("new/proofs") == read("one"), "{name}");
    }
}

#[test]
fn hostile_names_become_safe_names_of_proofs() {
    let folder = folder();
    let place = folder.path();
    let long = "x".repeat(300);
    let names = [
        "../../up",
        "a/b",
        "a_b",
        "a\\b",
        "CON",
        "nul.txt",
        "-rf",
        "\u{0}",
        " ",
        "größe",
        "測試",
        &long,
        ".",
        "..",
        "\u{1b}[2J\u{202e}",
        "a*?\"<>|b:c",
        "A_B",
    ];
    let names: Vec<&str> = names.into_iter().filter(|name| !name.trim().is_empty()).collect();
    let part = |(k, name): (usize, &&str)| serde_json::json!({"file": "cube.off", "name": name, "translation": [0.75 * k as f64, 0, 0]});
    let parts: Vec<Value> = names.iter().enumerate().map(part).collect();
    let manifest = serde_json::json!({ "parts": parts });
    std::fs::write(place.join("m.json"), manifest.to_string()).unwrap();
    let before = file_names(place);
    text(place, &["m.json", "--proofs", "proofs"], 1);
    let made = file_names(&place.join("proofs"));
    assert_eq!(made.len(), 2 * (names.len() - 1));
    for name in &made {
        let is_safe = |c: char| c.is_alphanumeric() || "-_.".contains(c);
        assert!(name.chars().all(is_safe) && name.len() <= 150, "{name}");
        assert!(name.starts_with(|c: char| c.is_ascii_digit()));
        assert!(Path::new(name).extension().is_some_and(|end| end == "json"));
    }
    assert_eq!(verified(place, "proofs").len(), made.len());
    let after: Vec<String> =
        file_names(place).into_iter().filter(|name| name != "proofs").collect();
    assert_eq!(after, before);
}

#[test]
fn parts_with_open_shells_are_named_with_each_pair() {
    let folder = folder();
    let place = folder.path();
    // A sheet that passes through the cube, and a box without a lid beside it.
    let sheet = "OFF\n4 2 0\n-1 -1 0.5\n2 -1 0.5\n2 2 0.5\n-1 2 0.5\n3 0 1 2\n3 0 2 3\n";
    std::fs::write(place.join("sheet.off"), sheet).unwrap();
    let manifest = serde_json::json!({"parts": [
        {"file": "cube.off", "name": "cube"},
        {"file": "sheet.off", "name": "wall"},
        {"file": "cube.off", "name": "far", "translation": [0, 0, 1.5]},
    ]});
    std::fs::write(place.join("m.json"), manifest.to_string()).unwrap();
    let files = ["--csv", "pairs.csv", "--report", "report.html", "--proofs", "proofs"];
    let arguments = [&["m.json", "--within", "1.5"][..], &files].concat();
    let [found, _] = text(place, &arguments, 1);
    assert!(found.contains("cube, wall: interfering, at "), "{found}");
    assert_eq!(found.matches(", wall has open shells\n").count(), 2, "{found}");
    let [found, _] = text(place, &["m.json", "--within", "1.5", "--json"], 1);
    let found: Value = json(&found);
    for pair in found["pairs"].as_array().unwrap() {
        let has_wall = pair["parts"].as_array().unwrap().contains(&"wall".into());
        let expected = if has_wall { serde_json::json!(["wall"]) } else { Value::Null };
        assert_eq!(pair["open"], expected, "{pair}");
    }
    let table = std::fs::read_to_string(place.join("pairs.csv")).unwrap();
    assert!(
        table.lines().nth(1).unwrap().ends_with(",second,001-cube--wall-distance.json"),
        "{table}"
    );
    let page = std::fs::read_to_string(place.join("report.html")).unwrap();
    assert!(page.contains("open shells, without an inside"));
    // The surfaces have a common point.
    let statements = verified(place, "proofs");
    assert_eq!(statements[0]["upper"], 0.0);
}
