//! `colltrans assembly`: the small gearbox of `data/`, and small generated files.

use std::path::{Path, PathBuf};
use std::process::Output;

use colltrans_testkit::TemporaryFolder;
use serde_json::Value;

use crate::support::{self, colltrans, data, folder, json, stderr, stdout};

/// Returns a folder with a unit cube on another one, as a manifest and as URDF files.
fn stacked() -> TemporaryFolder {
    let folder = folder();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write(
        "two.toml",
        "unit = 'mm'\n[[part]]\nfile = 'cube.off'\nname = 'low'\n[[part]]\nfile = 'cube.off'\n\
         name = 'high'\ntranslation = [0, 0, 1]\n",
    );
    let link = |name: &str, file: &str, z: i32| {
        format!(
            "<link name='{name}'><collision><origin xyz='0 0 {z}' rpy='0 0 0'/><geometry>\
             <mesh filename='package://kit/{file}'/></geometry></collision></link>"
        )
    };
    let links = link("low", "cube.off", 0) + &link("high", "cube.off", 1);
    let lost = link("lost", "gone.stl", 5);
    write("two.urdf", &format!("<robot name='r'>{links}</robot>"));
    write("lost.urdf", &format!("<robot name='r'>{links}{lost}</robot>"));
    folder
}

fn of_assembly<'a>(arguments: &[&'a str]) -> Vec<&'a str> {
    [&["assembly"][..], arguments].concat()
}

fn run(folder: &Path, arguments: &[&str]) -> Output {
    support::run(folder, &of_assembly(arguments))
}

fn answered(folder: &Path, arguments: &[&str]) -> String {
    support::answered(folder, &of_assembly(arguments))
}

fn refused(folder: &Path, arguments: &[&str], code: i32, words: &[&str]) {
    support::refused(folder, &of_assembly(arguments), code, words);
}

fn facts(folder: &Path, arguments: &[&str]) -> Value {
    let arguments: Vec<&str> = arguments.iter().copied().chain(["--json"]).collect();
    json(&answered(folder, &arguments))
}

fn names(value: &Value) -> Vec<&str> {
    value.as_array().unwrap().iter().map(|name| name.as_str().unwrap()).collect()
}

#[test]
fn gearbox_plan_removes_bolts_before_the_cover() {
    let found = facts(&data(), &["gearbox_small"]);
    assert_eq!(found["parts"].as_array().unwrap().len(), 16);
    let steps = found["plan"].as_array().unwrap();
    let outer: Vec<&Value> = steps.iter().filter(|s| s["within"].is_null()).collect();
    let at = |part: &str| outer.iter().position(|s| names(&s["parts"]).contains(&part)).unwrap();
    let bolts = ["bolt_0", "bolt_1", "bolt_2", "bolt_3"];
    assert!(bolts.iter().all(|bolt| at(bolt) < at("cover")), "{steps:?}");
    assert!(at("cover") < at("gear"));
    let bearing = names(&outer[at("bearing_inner")]["parts"]);
    assert_eq!(bearing.len(), 6, "the rings and the balls move as one");
    let sizes: usize = outer.iter().map(|s| names(&s["parts"]).len()).sum();
    assert_eq!((sizes, names(&found["last"])), (15, vec!["housing"]));
    let bolts =
        serde_json::json!({ "takes": "4 x bolt", "steps": [0, 3], "travel": steps[0]["travel"] });
    assert_eq!(found["stages"][0], bolts);
    assert_eq!(found["plan"][4]["after"], serde_json::json!([0, 1, 2, 3]), "bolts hold the cover");
    assert!(names(&found["left"]).is_empty());
    let stuck = found["stuck"].as_array().unwrap();
    assert_eq!(stuck.len(), 1);
    assert_eq!(names(&stuck[0]["parts"]), bearing);
    assert!(
        stuck[0]["because"]
            .as_str()
            .unwrap()
            .starts_with("No group of these 6 parts leaves the others as one")
    );
}

#[test]
fn free_travels_have_bounds_and_blockers() {
    let folder = stacked();
    let arguments = ["two.toml", "--direction", "0,0,-2", "--direction", "z", "--only"];
    let found = facts(folder.path(), &arguments);
    assert_eq!(found["unit"], "mm");
    let room = |part: &str, z: f64| {
        let wanted = |r: &&Value| r["part"] == part && r["direction"][2] == z;
        found["rooms"].as_array().unwrap().iter().find(wanted).unwrap().clone()
    };
    let down = room("high", -1.0);
    assert_eq!((&down["outcome"], &down["by"]), (&"blocked".into(), &"low".into()));
    assert_eq!(down["distance"], 0.0);
    let bounds: Vec<f64> = serde_json::from_value(down["offset_distance_bounds"].clone()).unwrap();
    let shrunk = down["offset_distance"].as_f64().unwrap();
    assert!(bounds[0] <= shrunk && shrunk <= bounds[1] && bounds[1] < 1e-4, "{down}");
    let encloses = |of: &serde_json::Value, name: &str, slack: f64| {
        let bounds: Vec<f64> =
            serde_json::from_value(of[format!("{name}_bounds")].clone()).unwrap();
        let value = of[name].as_f64().unwrap();
        assert!(bounds[0] <= value && value <= bounds[1] && bounds[1] - bounds[0] < slack, "{of}");
        bounds[0]
    };
    assert!(encloses(&down, "translation", 1e-4) <= 0.0);
    encloses(&found["parts"][0], "volume", 1e-12);
    encloses(&found["liaisons"][0], "area", 1e-10);
    encloses(&found["plan"][0], "travel", 1e-12);
    assert_eq!(room("high", 1.0)["outcome"], "free");
    assert_eq!(room("low", 1.0)["by"], "high");
    // With a minimum gap they overlap.
    let tight = facts(folder.path(), &["two.toml", "--keep-apart", "0.1", "--direction", "z"]);
    assert_eq!(tight["rooms"][0]["outcome"], "overlapping");
    assert_eq!((&tight["keep_apart"], tight.get("tolerance")), (&0.1.into(), None));
    let listed = ["two.toml", "--keep-apart", "0.1", "--ignore", "low,high"];
    assert_eq!(facts(folder.path(), &listed)["rooms"][0]["outcome"], "free");
    let fixed = facts(folder.path(), &["two.toml", "--fixed", "low"]);
    assert_eq!(names(&fixed["left"]), ["low"]);
}

#[test]
fn directions_are_read_from_a_file_or_sampled() {
    let folder = stacked();
    let file = folder.path().join("ways.txt");
    std::fs::write(&file, "# up\nz\n\n0.6, 0, 0.8 # aside\n").unwrap();
    let count =
        |arguments: &[&str]| facts(folder.path(), arguments)["rooms"].as_array().unwrap().len();
    assert_eq!(count(&["two.toml", "--only", "--directions", "ways.txt"]), 4);
    assert_eq!(count(&["two.toml", "--only", "--samples", "30"]), 2 * 42);
    std::fs::write(&file, "z\n0,0,0\n").unwrap();
    refused(folder.path(), &["two.toml", "--directions", "ways.txt"], 3, &["ways.txt: line 2"]);
    std::fs::write(&file, "1,2\n").unwrap();
    refused(folder.path(), &["two.toml", "--directions", "ways.txt"], 3, &["ways.txt: line 1"]);
    refused(folder.path(), &["two.toml", "--directions", "none.txt"], 3, &["none.txt"]);
}

#[test]
#[ignore = "long: plans of a whole machine"]
fn answer_is_equal_for_all_thread_counts() {
    let (small, out) = (stacked(), TemporaryFolder::new());
    let ask = |source: &Path, arguments: &[&str], threads: &str| {
        let folder = out.path().join(threads);
        let place = ["--json", "--threads", threads, "-o", folder.to_str().unwrap()];
        let text = answered(source, &[arguments, &place].concat());
        let mut files: Vec<_> =
            std::fs::read_dir(&folder).unwrap().map(|e| e.unwrap().path()).collect();
        files.sort();
        let name = |f: &PathBuf| f.file_name().unwrap().to_string_lossy().into_owned();
        let names: Vec<String> = files.iter().map(name).collect();
        let bytes: Vec<Vec<u8>> = files.iter().map(|f| std::fs::read(f).unwrap()).collect();
        (text, names, bytes)
    };
    let once = ask(&data(), &["gearbox_small"], "1");
    let names = ["assembly.json", "bill.csv", "disassembly.glb", "instructions.html"];
    let more = ["matrix.csv", "precedence.csv", "precedence.json", "report.html"];
    assert_eq!(once.1, [names, more].concat());
    assert!(once == ask(&data(), &["gearbox_small"], "3"), "three threads");
    let mapped = ["two.toml", "--map", "low", "--samples", "100"];
    let once = ask(small.path(), &mapped, "1");
    assert_eq!(once.1[4..7], ["map-low.json", "map-low.png", "map-low.svg"]);
    assert!(once == ask(small.path(), &mapped, "3"), "three threads, with a map");
}

#[test]
fn output_files_are_self_contained() {
    let folder = stacked();
    answered(folder.path(), &["two.toml", "-o", "out", "--map", "low"]);
    let out = folder.path().join("out");
    let page = std::fs::read_to_string(out.join("report.html")).unwrap();
    assert!(page.starts_with("<!doctype html>") || page.starts_with("<!DOCTYPE html>"));
    // The page references no other file; the viewer is part of it.
    for word in ["<script src", "src=\"http", "href=\"http", "@import", "url("] {
        assert!(!page.contains(word), "{word}");
    }
    assert!(page.contains("<svg") && page.contains("high"));
    // The animation can be read as an assembly: its nodes are the parts.
    let back = facts(&out, &["disassembly.glb"]);
    let found: Vec<&str> =
        back["parts"].as_array().unwrap().iter().map(|p| p["name"].as_str().unwrap()).collect();
    assert_eq!(found, ["low", "high"]);
    let table = std::fs::read_to_string(out.join("matrix.csv")).unwrap();
    assert!(
        table.starts_with("direction_x,direction_y,direction_z,moving,fixed,outcome,distance\n")
    );
    assert!(table.lines().any(|l| l.starts_with("0,0,1,low,high,blocked,")), "{table}");
    let written = json(&std::fs::read_to_string(out.join("assembly.json")).unwrap());
    assert_eq!(
        (names(&written["plan"][0]["parts"]), names(&written["last"])),
        (vec!["high"], vec!["low"])
    );
}

#[test]
fn bill_counts_like_parts_and_has_masses_where_density_is_known() {
    let folder = stacked();
    let place = folder.path();
    let part = |name: &str, z: f64, material: &str| {
        format!(
            "[[part]]\nfile = 'cube.off'\nname = '{name}'\ntranslation = [0, 0, {z}]\n{material}\n"
        )
    };
    let manifest = "unit = 'cm'\ndensities = { steel = 7850 }\n".to_owned()
        + &part("block_1", 0.0, "material = 'steel'")
        + &part("block_2", 1.0, "material = 'steel'")
        + &part("pad", 2.0, "material = '=rubber'")
        + &part("cap", 3.0, "material = 'steel'\ndensity = 8000");
    std::fs::write(place.join("bill.toml"), manifest).unwrap();
    let bill = |arguments: &[&str]| {
        answered(place, &[&["bill.toml", "-o", "out"], arguments].concat());
        let table = std::fs::read_to_string(place.join("out/bill.csv")).unwrap();
        // All but the number and the steps, which depend on the plan.
        let rows = table.lines().map(|line| {
            let cells: Vec<&str> = line.split(',').collect();
            cells[1..cells.len() - 1].join(",")
        });
        let mut rows: Vec<String> = rows.collect();
        rows[1..].sort();
        rows
    };
    let head =
        "name,quantity,fastener,form,material,volume,unit,density_kg_per_m3,mass_kg,total_mass_kg";
    let known = [
        head,
        "block,2,,,steel,1,cm^3,7850,0.00785,0.0157",
        "cap,1,,,steel,1,cm^3,8000,0.008,0.008",
        "pad,1,,,'=rubber,1,cm^3,,,",
    ];
    assert_eq!(bill(&[]), known);
    let page = std::fs::read_to_string(place.join("out/report.html")).unwrap();
    assert!(page.contains("4 parts in 3 lines, 23.7 g without the 1 of unknown mass."));
    // A material, then a part, then all parts.
    let of_rubber = bill(&["--density", "=rubber=1200", "--density", "block_*=1000"]);
    assert_eq!(of_rubber[1], "block,2,,,steel,1,cm^3,1000,0.001,0.002");
    assert_eq!(of_rubber[3], "pad,1,,,'=rubber,1,cm^3,1200,0.0012,0.0012");
    assert!(bill(&["--density", "900"])[1..].iter().all(|row| row.contains(",900,0.0009,")));
    let wrong = [
        ("tin=7000", "unknown part tin"),
        ("steel=", "expected RHO or NAME=RHO"),
        ("steel=-1", "invalid density -1"),
    ];
    for (given, message) in wrong {
        refused(place, &["bill.toml", "--density", given], 2, &[message]);
    }
    std::fs::write(place.join("bad.toml"), part("a", 0.0, "density = -3")).unwrap();
    refused(place, &["bad.toml"], 3, &["invalid density -3.0 of a"]);
    // Without a unit of length there is no mass.
    std::fs::write(place.join("bill.toml"), part("a", 0.0, "density = 3")).unwrap();
    assert_eq!(bill(&[])[1], "a,1,,,,1,,3,,");
}

#[test]
fn instructions_have_steps_of_assembly_in_reverse_order() {
    let folder = stacked();
    answered(&data(), &["gearbox_small", "-o", folder.path().join("out").to_str().unwrap()]);
    let page = std::fs::read_to_string(folder.path().join("out/instructions.html")).unwrap();
    let headings = page.split("<h2>").skip(1).map(|rest| rest.split("</h2>").next().unwrap());
    let steps: Vec<&str> = headings.filter(|text| text.starts_with("Step")).collect();
    assert_eq!(steps[0], "Step 1: put in rear_bush");
    assert_eq!(steps.last(), Some(&"Steps 7–10: screw in 4 x M4 x 16 (bolt)"));
    assert!(page.contains("Begin with housing"));
    assert!(page.contains("down (−z)") && !page.contains("up (+z)<"));
    assert!(page.contains("Screwed in by 12, 17.1 turns of 0.7"));
    // A subassembly is put together on the bench before it is put in.
    let parts = ["gearbox_small", "--subassembly", "drive=shaft,gear,spacer", "--no-proofs"];
    let out = folder.path().join("drive");
    answered(&data(), &[&parts[..], &["-o", out.to_str().unwrap()]].concat());
    let drive = std::fs::read_to_string(out.join("instructions.html")).unwrap();
    let bench = "On the bench, for what step 4 puts in: drive.";
    assert_eq!(drive.matches(bench).count(), 2);
    assert!(drive.contains(&format!("{bench} It begins with shaft.</p>")));
    assert!(drive.contains(">Step 4: put in drive</h2>"));
    // Each step shows where its parts are in the whole.
    assert_eq!(page.matches("class=\"where\"").count(), steps.len());
    // The options to try are in the text and in the report, with the same words.
    let text = answered(&data(), &["gearbox_small"]);
    let report = std::fs::read_to_string(folder.path().join("out/report.html")).unwrap();
    let tried: Vec<&str> =
        text.lines().skip_while(|line| *line != "to try").skip(1).map(str::trim).collect();
    assert!(!tried.is_empty());
    for line in tried {
        let (option, reason) = line.split_once(": ").unwrap();
        let sentence = format!("<p>To try: <code>{option}</code>, because {reason}.</p>");
        assert!(report.contains(&sentence), "{sentence}");
    }
}

#[test]
fn outputs_that_would_overwrite_inputs_are_rejected() {
    let folder = stacked();
    let place = folder.path();
    let text = r#"{"parts": [{"file": "report.html.off", "name": "a"}]}"#;
    std::fs::copy(place.join("cube.off"), place.join("report.html.off")).unwrap();
    std::fs::write(place.join("assembly.json"), text).unwrap();
    let words = ["assembly.json: is the same file as the input assembly.json", "another folder"];
    refused(place, &["assembly.json", "-o", "."], 3, &words);
    assert_eq!(std::fs::read_to_string(place.join("assembly.json")).unwrap(), text);
    assert!(!place.join("report.html").exists(), "nothing is written before");
    std::fs::write(place.join("matrix.csv"), "z\n").unwrap();
    let arguments = ["two.toml", "--directions", "matrix.csv", "-o", "."];
    refused(place, &arguments, 3, &["matrix.csv: is the same file as the input matrix.csv"]);
    // An input may have another name by a hard link.
    #[cfg(unix)]
    {
        std::fs::create_dir(place.join("out")).unwrap();
        std::fs::hard_link(place.join("cube.off"), place.join("out/report.html")).unwrap();
        refused(place, &["two.toml", "-o", "out"], 3, &["is the same file as the input cube.off"]);
    }
    // A folder cannot replace a file.
    refused(place, &["two.toml", "-o", "open.off"], 5, &["open.off"]);
}

#[test]
fn invalid_sources_are_rejected_with_their_place() {
    let folder = stacked();
    let place = folder.path();
    let write = |name: &str, text: &str| std::fs::write(place.join(name), text).unwrap();
    refused(place, &["nowhere"], 3, &["nowhere: cannot be read"]);
    write("notes.txt", "no parts");
    refused(
        place,
        &["notes.txt"],
        3,
        &["notes.txt: unknown kind of source; accepted: a folder of meshes", ".urdf", ".step"],
    );
    refused(place, &["."], 3, &["broken.off"]);
    refused(place, &["broken.off"], 3, &["broken.off", "line"]);
    write("bad.toml", "[[part]]\nfile = 'cube.off'\nscale = 'big'\n");
    refused(place, &["bad.toml"], 3, &["bad.toml: line 3"]);
    write("bad.toml", "[[part]]\nfile = 'cube.off'\nrotation = [0, 0, 0, 2]\n");
    refused(place, &["bad.toml"], 3, &["bad.toml: part 1 (cube)", "length 2, expected 1"]);
    write("bad.toml", "[[part]]\nfile = 'cube.off'\nrotation = { rpy_degrees = [nan, 0, 0] }\n");
    refused(place, &["bad.toml"], 3, &["bad.toml: part 1 (cube)", "rpy_degrees [NaN"]);
    write("bad.toml", "[[part]]\nfile = 'cube.off'\nrotation = { matrix = [[1, 0], [0, 1]] }\n");
    refused(place, &["bad.toml"], 3, &["bad.toml: line 3", "three rows of three numbers"]);
    write("bad.toml", "[[part]]\nfile = 'cube.off'\nname = ' '\n");
    refused(place, &["bad.toml"], 3, &["bad.toml: a part or subassembly has an empty name"]);
    write("bad.toml", "ignore = [['a', 'a']]\n[[part]]\nfile = 'cube.off'\nname = 'a'\n");
    refused(place, &["bad.toml"], 3, &["bad.toml: pair a,a names the same part twice"]);
    write("bad.json", "{\"parts\": [\n{\"file\": \"cube.off\", \"turned\": 3}]}");
    refused(place, &["bad.json"], 3, &["bad.json: line 2", "turned"]);
    write("bad.json", "{\"parts\": [{\"file\": \"gone.off\"}, {\"file\": \"cube.off\"}]}");
    refused(place, &["bad.json"], 3, &["bad.json", "gone.off"]);
    write("bad.glb", "glTF but not really");
    refused(place, &["bad.glb"], 3, &["bad.glb: glTF"]);
    write("bad.3mf", "no package");
    refused(place, &["bad.3mf"], 3, &["bad.3mf"]);
    write("bad.urdf", "<robot name='r'><link></robot>");
    refused(place, &["bad.urdf"], 3, &["bad.urdf: URDF"]);
    let shaped = |shape: &str| {
        let geometry = format!("<collision><geometry>{shape}</geometry></collision>");
        write("bad.urdf", &format!("<robot name='r'><link name='arm'>{geometry}</link></robot>"));
    };
    for shape in ["<box size='0 1 1'/>", "<box size='1 nan 1'/>", "<sphere radius='-1'/>"] {
        shaped(shape);
        refused(place, &["bad.urdf"], 3, &["bad.urdf: link arm", "finite and positive"]);
    }
    std::fs::create_dir(place.join("empty")).unwrap();
    refused(
        place,
        &["empty"],
        3,
        &["the folder has no STL, OBJ, PLY, OFF or DAE file; the folder is empty"],
    );
    std::fs::create_dir(place.join("steps")).unwrap();
    write("steps/a.step", "ISO-10303-21;");
    write("steps/b.STP", "ISO-10303-21;");
    let words = ["but 1 .step file, 1 .stp file;", "give the path of the STEP file"];
    refused(place, &["steps"], 3, &words);
    std::fs::create_dir_all(place.join("outer/inner")).unwrap();
    refused(place, &["outer"], 3, &["but 1 folder; give the folder that contains the meshes"]);
}

#[test]
fn missing_urdf_meshes_are_named_or_skipped() {
    let folder = stacked();
    let place = folder.path();
    let root = ["--package", "."];
    let found = facts(place, &[&["two.urdf"], &root[..]].concat());
    assert_eq!(found["unit"], "m");
    assert_eq!(found["plan"].as_array().unwrap().len(), 1);
    let words = ["lost.urdf: 1 referenced mesh not found: ", "package://kit/gone.stl", "skip"];
    refused(place, &[&["lost.urdf"], &root[..]].concat(), 3, &words);
    refused(place, &["lost.urdf"], 3, &["3 referenced meshes not found", "package://kit/cube.off"]);
    let output = run(place, &[&["lost.urdf", "--skip-missing", "--json"], &root[..]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(stderr(&output).contains("package://kit/gone.stl not found; left out"));
    assert_eq!(json(&stdout(&output))["parts"].as_array().unwrap().len(), 2);
    let joint = [&["two.urdf", "--joint", "elbow=1"], &root[..]].concat();
    refused(place, &joint, 3, &["unknown joint elbow"]);
}

#[test]
fn invalid_flags_are_rejected() {
    let folder = stacked();
    let cases: [(&[&str], &[&str]); 14] = [
        (&["--tolerance", "-1"], &["--tolerance", "-1"]),
        (&["--tolerance", "wide"], &["--tolerance", "wide"]),
        (&["--tolerance", "1", "--keep-apart", "1"], &["--tolerance", "--keep-apart"]),
        (&["--direction", "0,0"], &["--direction"]),
        (&["--map", "hig"], &["unknown part hig; did you mean high?"]),
        (&["--map", "q*"], &["unknown part q*"]),
        (&["--fixed", "lo"], &["unknown part lo; did you mean low?"]),
        (&["--ignore", "low"], &["--ignore low: expected two names"]),
        (&["--ignore", "low,low"], &["pair low,low names the same part twice"]),
        (&["--joint", "elbow"], &["--joint elbow: expected NAME=VALUE"]),
        (&["--joint", "elbow=nan"], &["--joint elbow=nan: expected NAME=VALUE"]),
        (&["--samples", "-3"], &["--samples", "from 0 to 655362"]),
        (&["--samples", "99999999999"], &["--samples", "from 0 to 655362"]),
        (&["--threads", "0"], &["--threads"]),
    ];
    for (flags, words) in cases {
        refused(folder.path(), &[&["two.toml"], flags].concat(), 2, words);
    }
    refused(folder.path(), &["two.toml", "--direction", "0,0,0"], 2, &["0"]);
}

#[test]
fn overlaps_suggest_a_tolerance() {
    let folder = stacked();
    let text = "[[part]]\nfile = 'cube.off'\nname = 'low'\n[[part]]\nfile = 'cube.off'\n\
                name = 'high'\ntranslation = [0, 0, 0.98]\n";
    std::fs::write(folder.path().join("deep.toml"), text).unwrap();
    let told = answered(folder.path(), &["deep.toml"]);
    assert!(told.contains("low, high by 0.02") && told.contains("try --tolerance 0.02"), "{told}");
    let found = facts(folder.path(), &["deep.toml"]);
    let tolerance = found["suggested_tolerance"].as_f64().unwrap().to_string();
    let depth = found["overlaps"][0]["least_tolerance"].as_f64().unwrap();
    assert!((depth - 0.02).abs() < 1e-9, "{depth}");
    assert_eq!(names(&found["left"]), ["low", "high"]);
    let tried = facts(folder.path(), &["deep.toml", "--tolerance", &tolerance]);
    assert!(names(&tried["left"]).is_empty());
    let ignoring = facts(folder.path(), &["deep.toml", "--ignore-overlaps"]);
    assert!(names(&ignoring["left"]).is_empty());
}

#[test]
fn parts_thinner_than_the_tolerance_are_reported() {
    let folder = stacked();
    let told = answered(folder.path(), &["two.toml", "--tolerance", "3"]);
    assert!(told.contains("low: shrunk by half the tolerance; nothing of it is left"), "{told}");
    let found = facts(folder.path(), &["two.toml", "--tolerance", "3"]);
    assert!(found["parts"][0]["remark"].as_str().unwrap().contains("nothing of it is left"));
    assert!(facts(folder.path(), &["two.toml"])["parts"][0]["remark"].is_null());
}

#[test]
fn files_outside_of_the_source_need_a_flag() {
    let folder = stacked();
    let place = folder.path();
    std::fs::create_dir(place.join("in")).unwrap();
    let manifest = "[[part]]\nfile = '../cube.off'\n";
    std::fs::write(place.join("in/m.toml"), manifest).unwrap();
    refused(place, &["in/m.toml"], 3, &["../cube.off", "outside", "--allow-outside"]);
    answered(place, &["in/m.toml", "--allow-outside"]);
    answered(place, &["in/m.toml", "--package", "."]);
    refused(place, &["lost.urdf"], 3, &["--package DIR", "--skip-missing"]);
}

#[cfg(unix)]
#[test]
fn pipes_and_devices_are_rejected() {
    let folder = stacked();
    let place = folder.path();
    let made = std::process::Command::new("mkfifo").arg(place.join("p.stl")).status().unwrap();
    assert!(made.success());
    for arguments in [
        &["assembly", "p.stl"][..],
        &["info", "p.stl"],
        &["cast", "p.stl", "cube.off", "--direction", "x"],
        &["clear", "cube.off", "--from", "p.stl", "--direction", "x"],
        &["cast", "cube.off", "cube.off", "--directions", "/dev/zero"],
        &["assembly", "two.toml", "--directions", "/dev/zero"],
        &["replay", "/dev/zero"],
    ] {
        let output = colltrans(place).args(arguments).output().unwrap();
        assert_eq!(output.status.code(), Some(3), "{arguments:?}");
        assert!(stderr(&output).contains("not a regular file"), "{}", stderr(&output));
    }
}

/// Control characters in names are escaped on the terminal; formulas and markup are escaped in files.
#[test]
fn control_characters_in_names_are_escaped() {
    let folder = stacked();
    let place = folder.path();
    let name = "=low\u{1b}[2J\u{9b}31m\nstep\u{202e}\u{200b}\u{e0041}<script>";
    let manifest = serde_json::json!({"unit": "<script>alert(1)</script>", "parts": [
        {"file": "cube.off", "name": name},
        {"file": "cube.off", "name": "high", "translation": [0, 0, 0.5]},
    ]});
    std::fs::write(place.join("m.json"), manifest.to_string()).unwrap();
    let clean = |text: &str| {
        assert!(
            !text
                .contains(|c: char| c.is_control() && c != '\n'
                    || "\u{202e}\u{200b}\u{e0041}".contains(c)),
            "{text:?}"
        );
    };
    for arguments in [&["m.json", "--map", name, "-o", "out"][..], &["m.json", "--json"]] {
        let output = run(place, arguments);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        clean(&stdout(&output));
        clean(&stderr(&output));
    }
    let told = answered(place, &["m.json"]);
    assert!(
        told.contains(r"=low\u{1b}[2J\u{9b}31m\nstep\u{202e}\u{200b}\u{e0041}<script>"),
        "{told}"
    );
    assert_eq!(facts(place, &["m.json"])["parts"][0]["name"], name);
    let page = std::fs::read_to_string(place.join("out/report.html")).unwrap();
    assert!(!page.contains("<script>alert"));
    let table = std::fs::read_to_string(place.join("out/matrix.csv")).unwrap();
    assert!(table.contains(",'=low") && !table.contains(",=low"), "{table}");
    clean(&table);
    let written = std::fs::read_to_string(place.join("out/assembly.json")).unwrap();
    clean(&written);
    let written: serde_json::Value = serde_json::from_str(&written).unwrap();
    assert_eq!(written["parts"][0]["name"], name);
    let output = run(place, &["m.json", "--map", "\u{1b}[31m"]);
    assert_eq!(output.status.code(), Some(2));
    clean(&stderr(&output));
    // The same for names of files.
    let file = "c\u{1b}[31m\n.off";
    std::fs::copy(place.join("cube.off"), place.join(file)).unwrap();
    std::fs::copy(place.join("broken.off"), place.join("b\u{7}.off")).unwrap();
    for arguments in [
        &["info", file][..],
        &["info", "b\u{7}.off"],
        &["assembly", "b\u{7}.off"],
        &["clear", file, "--from", "cube.off", "--direction", "x", "--moving-pose=-3,0,0"],
        &["clear", file, "--from", "cube.off", "--direction", "x", "--json"],
    ] {
        let output = colltrans(place).args(arguments).output().unwrap();
        clean(&stdout(&output));
        clean(&stderr(&output));
        assert!((stdout(&output) + &stderr(&output)).contains("\\u"), "{arguments:?}");
    }
}

#[test]
fn maps_with_equal_file_names_get_two_files() {
    let folder = stacked();
    let text = "[[part]]\nfile = 'cube.off'\nname = 'a/b'\n[[part]]\nfile = 'cube.off'\n\
                name = 'A_B'\ntranslation = [0, 0, 3]\n";
    std::fs::write(folder.path().join("m.toml"), text).unwrap();
    let arguments = ["m.toml", "--map", "a/b", "--map", "A_B", "-o", "out", "--samples", "12"];
    answered(folder.path(), &arguments);
    let names = std::fs::read_dir(folder.path().join("out")).unwrap();
    let mut names: Vec<String> =
        names.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.retain(|name| name.starts_with("map-"));
    names.sort();
    let wanted = ["map-A_B_2.json", "map-A_B_2.png", "map-A_B_2.svg"];
    assert_eq!(names, [wanted, ["map-a_b.json", "map-a_b.png", "map-a_b.svg"]].concat());
}

#[cfg(target_os = "linux")]
#[test]
fn full_disk_returns_exit_code_5_and_leaves_no_file() {
    let folder = stacked();
    let place = folder.path();
    let full = || std::process::Stdio::from(std::fs::File::create("/dev/full").unwrap());
    let program = assert_cmd::cargo::cargo_bin("colltrans");
    for arguments in [
        &["assembly", "two.toml"][..],
        &["assembly", "two.toml", "--json"],
        &["info", "cube.off"],
        &["cast", "cube.off", "cube.off", "--direction", "x", "--json"],
    ] {
        let mut command = std::process::Command::new(&program);
        let output = command.current_dir(place).args(arguments).stdout(full()).output().unwrap();
        assert_eq!(output.status.code(), Some(5), "{arguments:?}");
        assert!(
            String::from_utf8_lossy(&output.stderr).contains("standard output: cannot be written")
        );
    }
    // A limit of the file size simulates a full disk.
    std::fs::write(place.join("old.svg"), "old").unwrap();
    let script = format!(
        "trap '' XFSZ; ulimit -f 1; {0} cast cube.off cube.off --direction x --picture new.svg; echo $?; \
         {0} cast cube.off cube.off --direction x --picture old.svg; echo $?; \
         {0} assembly two.toml -o out; echo $?",
        program.display()
    );
    let output = std::process::Command::new("bash")
        .current_dir(place)
        .args(["-c", &script])
        .output()
        .unwrap();
    let codes: Vec<&str> = std::str::from_utf8(&output.stdout)
        .unwrap()
        .lines()
        .filter(|line| line.parse::<i32>().is_ok())
        .collect();
    assert_eq!(codes, ["5", "5", "5"], "{}", String::from_utf8_lossy(&output.stderr));
    assert!(!place.join("new.svg").exists());
    assert_eq!(std::fs::read_to_string(place.join("old.svg")).unwrap(), "old");
    assert_eq!(std::fs::read_dir(place.join("out")).unwrap().count(), 0);
    let partial =
        |name: &std::fs::DirEntry| name.file_name().to_string_lossy().ends_with("partial");
    assert!(!std::fs::read_dir(place).unwrap().any(|entry| partial(&entry.unwrap())));
}

#[test]
#[ignore = "long: plans of a whole machine"]
fn plan_satisfies_its_constraints() {
    let text = answered(&data(), &["gearbox_small", "--fixed", "housing", "--remove", "cover"]);
    let words = "cover: 4 other parts go (bolt_0, bolt_1, bolt_2, bolt_3), screwed out first; \
                 no fewer are enough";
    assert!(text.contains(words), "{text}");
    let asked = ["gearbox_small", "--subassembly", "drive=gear,shaft", "--before", "bolt_3,bolt_0"];
    let found = facts(&data(), &asked);
    let steps = found["plan"].as_array().unwrap();
    let drive = steps.iter().find(|step| step["subassembly"] == "drive").unwrap();
    assert_eq!(names(&drive["parts"]), ["gear", "shaft"]);
    let first = |part: &str| steps.iter().position(|s| names(&s["parts"]) == [part]).unwrap();
    assert!(first("bolt_3") < first("bolt_0"));
    let upright = ["gearbox_small", "--never", "bolt*=z@80", "--fixed", "housing"];
    assert!(facts(&data(), &upright)["stuck"][0]["constrained"] == true);
    let wrong: [(&[&str], &[&str]); 5] = [
        (&["--before", "bolt_0,cover", "--after", "bolt_0,cover"], &["bolt_0, cover"]),
        (&["--together", "cover"], &["needs at least two parts; 1 given"]),
        (&["--never", "cover"], &["expected PART=X,Y,Z"]),
        (&["--never", "cover=z@200"], &["200 degrees"]),
        (&["--remove", "*"], &["16 of 16 parts"]),
    ];
    for (words, said) in wrong {
        let all = [&["gearbox_small"][..], words].concat();
        refused(&data(), &all, 2, said);
    }
}

#[test]
fn manifest_constraints_change_the_plan() {
    let folder = stacked();
    let text = std::fs::read_to_string(folder.path().join("two.toml")).unwrap();
    let ask = |more: &str| {
        std::fs::write(folder.path().join("asked.toml"), format!("{more}\n{text}")).unwrap();
        facts(folder.path(), &["asked.toml"])
    };
    assert_eq!(names(&ask("before = [['low', 'high']]")["plan"][0]["parts"]), ["low"]);
    assert_eq!(names(&ask("after = [['low', 'high']]")["plan"][0]["parts"]), ["high"]);
    assert!(ask("together = [['low', 'high']]")["plan"].as_array().unwrap().is_empty());
    let kept = ask("never = [{ parts = ['h*'], along = [0, 0, 1] }]");
    assert!(kept["plan"][0]["direction"][2].as_f64().unwrap() < 0.8);
}

/// Returns a folder with a block and a ring that overlaps it by 0.05, on a floor.
fn pressed() -> TemporaryFolder {
    let folder = folder();
    let mut parts = String::from("unit = 'mm'\n");
    let mut place = |name: &str, files: &str, at: [f64; 3], scale: [f64; 3]| {
        let place = format!("translation = {at:?}\nscale = {scale:?}\n");
        parts.push_str("[[part]]\n");
        parts.push_str(&[&format!("file = {files}\nname = '{name}'\n"), &place[..]].concat());
    };
    place("floor", "'cube.off'", [0.0, 0.0, -1.0], [4.0, 4.0, 1.0]);
    place("block", "'cube.off'", [0.0; 3], [1.0; 3]);
    place("o-ring", "'cube.off'", [0.95, 0.0, 0.0], [1.0; 3]);
    std::fs::write(folder.path().join("press.toml"), &parts).unwrap();
    let pair = "pair = [{ parts = ['o-*', 'block'], role = 'soft', tolerance = 0.2 }]\n";
    std::fs::write(folder.path().join("said.toml"), pair.to_owned() + &parts).unwrap();
    folder
}

#[test]
fn roles_of_pairs_and_suggestions_free_a_press_fit() {
    let folder = pressed();
    let ask = |words: &[&str]| facts(folder.path(), &[words, &["--fixed", "block"]].concat());
    let plain = ask(&["press.toml"]);
    let said = &plain["suggestions"][0];
    assert_eq!((&said["role"], said["tolerance"].as_f64().unwrap() > 0.05), (&"soft".into(), true));
    assert_eq!(plain["left"].as_array().unwrap().len(), 2);
    let text = answered(folder.path(), &["press.toml", "--fixed", "block"]);
    assert!(text.contains("perhaps intended, which --auto assumes: soft="), "{text}");
    let ways: [(&[&str], &str); 6] = [
        (&["press.toml", "--auto"], "soft"),
        (&["said.toml"], "soft"),
        (&["press.toml", "--soft", "o-ring,block"], "soft"),
        (&["press.toml", "--press", "block,o-*=0.3"], "press"),
        (&["press.toml", "--snap", "o-ring,block=0.5"], "snap"),
        (&["press.toml", "--thread", "o-ring,block"], "thread"),
    ];
    for (words, role) in ways {
        let found = ask(words);
        let mut steps = found["plan"].as_array().unwrap().iter();
        let step = steps.find(|step| names(&step["parts"]) == ["o-ring"]).unwrap();
        assert_eq!(step["passed"][0]["role"], role);
        assert_eq!(names(&found["left"]), ["block"], "{words:?}");
        assert_eq!(found["pairs"][0]["role"], role);
    }
    let auto = ask(&["press.toml", "--auto"]);
    assert!(auto["notes"][0].as_str().unwrap().contains("taken as suggested: soft="), "{auto}");
    let glued = ask(&["said.toml", "--glued", "o-ring,floor"]);
    assert!(glued["plan"].as_array().unwrap().iter().any(|s| names(&s["parts"]).len() == 2));
    let wrong: [(&[&str], &[&str]); 4] = [
        (
            &["--pair", "block,o-ring"],
            &["--pair block,o-ring: expected two names and a tolerance, A,B=L"],
        ),
        (&["--snap", "block,o-ring=x"], &["and a tolerance, A,B=L"]),
        (&["--press", "block"], &["expected two names"]),
        (&["--press", "block,o-ring=-1"], &["-1"]),
    ];
    for (words, said) in wrong {
        refused(folder.path(), &[&["press.toml"][..], words].concat(), 2, said);
    }
}
