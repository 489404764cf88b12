//! `colltrans path`.

use std::fs;

use serde_json::{Value, json};

use crate::support::{answered, data, folder, json as read, refused, run, stderr};

/// Returns the files of the arm, its path and a wire in its way.
fn files() -> [String; 3] {
    ["arm.urdf", "arm.csv", "wire.obj"].map(|name| data().join(name).to_str().unwrap().to_owned())
}

#[test]
fn arm_touches_a_wire_on_its_path() {
    let (folder, [arm, rows, wire]) = (folder(), files());
    let text = answered(folder.path(), &["path", &arm, &rows, &wire]);
    assert!(
        text.starts_with("contact\n  bodies       tool, wire\n  time         0.603560308\n"),
        "{text}"
    );
    let told = read(&answered(folder.path(), &["path", &arm, &rows, &wire, "--json"]));
    assert_eq!((&told["pair"], &told["pairs"]), (&json!(["tool", "wire"]), &json!(6)));
    assert_eq!(told["place"]["row"], 0);
    assert!(told.get("min_gap").is_none());
    // Links with a joint between them touch, so they are skipped and reported.
    let touching = json!([["base", "upper"], ["upper", "fore"], ["fore", "tool"]]);
    assert_eq!(told["left_out"], touching);
    let free = ["path", &arm, &rows, &wire, "--ignore", "wire, tool", "--json"];
    let free = read(&answered(folder.path(), &free));
    assert_eq!(
        (&free["outcome"], &free["left_out"][3]),
        (&json!("free"), &json!(["tool", "wire"]))
    );
    let alone = answered(folder.path(), &["path", &arm, &rows]);
    assert!(alone.starts_with("free: no two bodies of the checked pairs meet on"), "{alone}");
    assert!(alone.contains("  left out     base, upper; upper, fore; fore, tool\n"), "{alone}");
    let kept = ["path", &arm, &rows, &wire, "--min-gap", "0.2"];
    let text = answered(folder.path(), &kept);
    assert!(text.contains("  minimum gap  0.2, at which"), "{text}");
    let kept = read(&answered(folder.path(), &[&kept[..], &["--json"]].concat()));
    assert_eq!((&kept["outcome"], &kept["min_gap"]), (&json!("contact"), &json!(0.2)));
    let small = ["path", &arm, &rows, &wire, "--scene-scale", "0.001", "--json"];
    assert_eq!(read(&answered(folder.path(), &small))["outcome"], "free");
}

#[test]
fn skipped_pairs_and_limits_are_noted() {
    let (folder, [arm, rows, wire]) = (folder(), files());
    let said = stderr(&run(folder.path(), &["path", &arm, &rows, &wire]));
    assert!(
        said.contains("3 pairs of links with one joint between them are not checked"),
        "{said}"
    );
    assert!(said.contains("links that no joint moves are not checked against the scene"), "{said}");
    assert!(
        said.contains("a cylinder of radius 0.002 is replaced by a circumscribed polyhedron"),
        "{said}"
    );
    let srdf = folder.path().join("arm.srdf");
    let pair = |a: &str, b: &str| format!("<disable_collisions link1=\"{a}\" link2=\"{b}\"/>");
    let pairs = [("base", "upper"), ("upper", "fore"), ("fore", "tool")].map(|(a, b)| pair(a, b));
    fs::write(&srdf, format!("<robot>{}</robot>", pairs.concat())).unwrap();
    let with = ["path", &arm, &rows, "--srdf", "arm.srdf", "--json"];
    assert_eq!(read(&answered(folder.path(), &with))["pairs"], 3);
    let said = stderr(&run(folder.path(), &["path", &arm, &rows, "--srdf", &arm]));
    assert!(said.contains("the SRDF file has no disable_collisions"), "{said}");
    fs::write(folder.path().join("far.csv"), "shoulder,elbow,reach\n0,0,0\n3.5,0,0\n").unwrap();
    let said = stderr(&run(folder.path(), &["path", &arm, "far.csv"]));
    assert!(
        said.contains("joint shoulder exceeds its limits, -3 to 3 rad, in 1 of 2 rows"),
        "{said}"
    );
}

#[test]
fn invalid_inputs_are_rejected_with_their_place() {
    let (folder, [arm, rows, wire]) = (folder(), files());
    fs::write(folder.path().join("short.csv"), "0,0\n").unwrap();
    fs::write(folder.path().join("text.csv"), "0,0,x\n").unwrap();
    fs::write(folder.path().join("foo.json"), "{\"foo\": 1}").unwrap();
    for (arguments, code, why) in [
        (
            vec!["path", &arm, "short.csv"],
            3,
            "short.csv: rows have 2 values, expected 3, one for each joint",
        ),
        (
            vec!["path", &arm, "text.csv"],
            3,
            "text.csv: line 1: `0,0,x` has a value that is not a finite number",
        ),
        (vec!["path", &arm, "none.csv"], 3, "none.csv: cannot be read"),
        (vec!["path", &wire, &rows], 3, "URDF"),
        (vec!["path", &arm, "foo.json"], 3, "foo.json: JSON: neither a list of rows nor"),
        (vec!["path", &arm, &rows, "--ignore", "tool"], 2, "--ignore tool: expected two names A,B"),
        (vec!["path", &arm, &rows, "--joint", "reach=1mm"], 2, "NAME=VALUE, in radians or metres"),
        (
            vec!["path", &arm, &rows, "--ignore", "tool,hand"],
            2,
            "--ignore: unknown name hand; known names: base, upper",
        ),
        (vec!["path", &arm, &rows, "--joint", "reach"], 2, "--joint reach: expected NAME=VALUE"),
        (
            vec!["path", &arm, &rows, "--joint", "reach=0"],
            3,
            "column reach does not name an independent joint",
        ),
        (vec!["path", &arm, &rows, &rows], 3, "arm.csv"),
    ] {
        let output = run(folder.path(), &arguments);
        assert_eq!(output.status.code(), Some(code), "{arguments:?}: {}", stderr(&output));
        assert!(stderr(&output).contains(why), "{arguments:?}: {}", stderr(&output));
    }
}

#[test]
fn path_proof_holds_and_changed_ones_do_not() {
    let (folder, [arm, rows, wire]) = (folder(), files());
    let file = folder.path().join("proof.json");
    answered(folder.path(), &["path", &arm, &rows, &wire, "--save-proof", "proof.json"]);
    let text = answered(folder.path(), &["verify", "proof.json"]);
    let said = "holds: of 6 pairs (base and fore, base and tool, upper and tool, upper and wire, fore and wire, \
                tool and wire) none meet before the time 0.60356030";
    assert!(text.starts_with(said), "{text}");
    assert!(text.contains(", and tool and wire meet by the time 0.60356030"), "{text}");
    let told = read(&answered(folder.path(), &["verify", "proof.json", "--json"]));
    assert!(told["time"]["upper"].as_f64().unwrap() < 0.6036, "{told}");
    assert_eq!(told["pairs"].as_array().unwrap().len(), 6, "{told}");
    let proof: Value = serde_json::from_str(&fs::read_to_string(&file).unwrap()).unwrap();
    let changed = |change: &dyn Fn(&mut Value)| {
        let mut proof = proof.clone();
        change(&mut proof);
        fs::write(&file, proof.to_string()).unwrap();
        let output = run(folder.path(), &["verify", "proof.json"]);
        assert_eq!(output.status.code(), Some(6), "{}", stderr(&output));
    };
    changed(&|proof| proof["query"]["path"]["path"]["rows"][1][0] = json!(0.95));
    changed(&|proof| proof["statement"]["path"]["pairs"] = json!([["upper", "tool"]]));
    changed(&|proof| proof["statement"]["path"]["lower"] = json!(0.7));
    changed(&|proof| {
        let frame = &mut proof["placement"]["robot"]["frames"][1];
        frame["origin"]["translation"] = json!([0.6, 0.0, 0.0]);
    });
    answered(folder.path(), &["path", &arm, &rows, "--save-proof", "proof.json"]);
    let text = answered(folder.path(), &["verify", "proof.json"]);
    assert!(
        text.starts_with(
            "holds: of 3 pairs (base and fore, base and tool, upper and tool) none meet on the"
        ),
        "{text}"
    );
}

#[test]
fn repeated_columns_and_joints_are_rejected() {
    let (folder, [arm, rows, _]) = (folder(), files());
    fs::write(folder.path().join("twice.csv"), "shoulder,elbow,elbow\n0,0,0\n").unwrap();
    let said = stderr(&run(folder.path(), &["path", &arm, "twice.csv"]));
    assert!(said.contains("twice.csv: names of columns: duplicate name `elbow`"), "{said}");
    let joints = ["path", &arm, &rows, "--joint", "reach=0.1", "--joint", "reach=0.2"];
    let said = stderr(&run(folder.path(), &joints));
    assert!(said.contains("--joint reach=0.2: this joint already has a value"), "{said}");
    let said = stderr(&run(folder.path(), &["path", &arm, &rows, "--joint", "reach=nan"]));
    assert!(said.contains("--joint reach=nan: expected NAME=VALUE"), "{said}");
}

#[test]
fn bodies_with_the_same_file_name_are_named_by_path() {
    let (folder, [arm, rows, wire]) = (folder(), files());
    fs::create_dir(folder.path().join("far")).unwrap();
    let far = fs::read_to_string(&wire).unwrap().replace("v ", "v 9");
    fs::write(folder.path().join("far/wire.obj"), far).unwrap();
    fs::copy(&wire, folder.path().join("tool.obj")).unwrap();
    let two = ["path", &arm, &rows, "far/wire.obj", &wire, "--json"];
    let told = read(&answered(folder.path(), &two));
    assert_eq!(told["pair"], json!(["tool", wire]));
    let link = read(&answered(folder.path(), &["path", &arm, &rows, "tool.obj", "--json"]));
    assert_eq!(link["pair"], json!(["tool", "tool.obj"]));
    let ignored = ["path", &arm, &rows, "tool.obj", "--ignore", "tool,tool.obj", "--json"];
    assert_eq!(read(&answered(folder.path(), &ignored))["outcome"], "free");
    let same = stderr(&run(folder.path(), &["path", &arm, &rows, "tool.obj", "tool.obj"]));
    assert!(same.contains("duplicate name tool.obj of a link or scene body"), "{same}");
}

/// Writes a robot of boxes with these links and joints.
fn boxes(folder: &std::path::Path, links: &[&str], joints: &str) {
    let link = |name: &&str| {
        format!(
            "<link name=\"{name}\"><collision><geometry><box size=\"1 1 1\"/></geometry></collision></link>"
        )
    };
    let links: String = links.iter().map(link).collect();
    fs::write(folder.join("boxes.urdf"), format!("<robot name=\"r\">{links}{joints}</robot>"))
        .unwrap();
}

fn slide(name: &str, parent: &str, child: &str, x: f64) -> String {
    format!(
        "<joint name=\"{name}\" type=\"prismatic\"><parent link=\"{parent}\"/><child link=\"{child}\"/>\
         <origin xyz=\"{x} 0 0\"/><axis xyz=\"1 0 0\"/></joint>"
    )
}

#[test]
fn overlapping_pairs_are_listed_as_options_and_srdf() {
    let folder = folder();
    // Four boxes of size 1 at distances of 0.4: all pairs except for the first and the last overlap.
    let joints =
        slide("p", "a", "b", 0.4) + &slide("q", "b", "c", 0.4) + &slide("r", "c", "d", 0.4);
    boxes(folder.path(), &["a", "b", "c", "d"], &joints);
    fs::write(folder.path().join("rows.csv"), "p,q,r\n0,0,0\n0.1,0.1,0.1\n").unwrap();
    let text = answered(folder.path(), &["path", "boxes.urdf", "rows.csv"]);
    assert!(text.starts_with("overlapping: 2 pairs overlap where the path begins\n"), "{text}");
    assert!(text.contains("--ignore a,c --ignore b,d"), "{text}");
    let element = "<disable_collisions link1=\"b\" link2=\"d\" reason=\"Default\"/>";
    assert!(text.contains(element), "{text}");
    let told = read(&answered(folder.path(), &["path", "boxes.urdf", "rows.csv", "--json"]));
    assert_eq!(told["overlaps"], json!([["a", "c"], ["b", "d"]]));
    // With the printed options no pair overlaps.
    let rest = ["path", "boxes.urdf", "rows.csv", "--ignore", "a,c", "--ignore", "b,d", "--json"];
    assert_eq!(read(&answered(folder.path(), &rest))["outcome"], "free");
    let srdf = "<robot name=\"r\"><disable_collisions link1=\"a\" link2=\"c\" reason=\"Default\"/></robot>";
    fs::write(folder.path().join("some.srdf"), srdf).unwrap();
    let some = ["path", "boxes.urdf", "rows.csv", "--srdf", "some.srdf", "--json"];
    let told = read(&answered(folder.path(), &some));
    assert_eq!(told["overlaps"], json!([["a", "b"], ["b", "c"], ["b", "d"], ["c", "d"]]));
}

#[test]
fn unused_velocities_are_noted_and_fail_with_strict() {
    let folder = folder();
    boxes(folder.path(), &["a", "b"], &slide("s", "a", "b", 3.0));
    fs::write(folder.path().join("none.srdf"), "<robot name=\"r\"/>").unwrap();
    // Velocities that would lead beyond the rows, in the format of MoveIt.
    let rows = r#"{"joint_trajectory": {"joint_names": ["s"], "points": [
        {"positions": [0], "velocities": [3], "time_from_start": {"sec": 0, "nanosec": 0}},
        {"positions": [0.3], "velocities": [-3], "time_from_start": {"sec": 1, "nanosec": 0}}]}}"#;
    fs::write(folder.path().join("rows.json"), rows).unwrap();
    let asked = ["path", "boxes.urdf", "rows.json", "--srdf", "none.srdf"];
    let said = "rows are joined by straight segments; the velocities in the file were not used";
    let text = answered(folder.path(), &asked);
    assert!(text.starts_with("free: ") && text.contains(said), "{text}");
    let told = read(&answered(folder.path(), &[&asked[..], &["--json"]].concat()));
    assert_eq!((&told["outcome"], &told["notes"]), (&json!("free"), &json!([said])));
    let strict = run(folder.path(), &[&asked[..], &["--strict"]].concat());
    assert_eq!(strict.status.code(), Some(7));
    assert!(stderr(&strict).contains(said));
    // Rows without velocities have no limitation.
    fs::write(folder.path().join("rows.csv"), "s\n0\n0.3\n").unwrap();
    let plain = ["path", "boxes.urdf", "rows.csv", "--srdf", "none.srdf", "--strict", "--json"];
    assert!(read(&answered(folder.path(), &plain)).get("notes").is_none());
}

#[test]
fn path_without_a_pair_is_rejected() {
    let folder = folder();
    boxes(folder.path(), &["a", "b"], &slide("s", "a", "b", 3.0));
    fs::write(folder.path().join("rows.csv"), "s\n0\n0.3\n").unwrap();
    let asked = ["path", "boxes.urdf", "rows.csv"];
    refused(folder.path(), &asked, 3, &["no pair of bodies", "to check", "SRDF"]);
}

#[test]
fn names_of_overlapping_pairs_are_quoted_for_shell_and_xml() {
    let (folder, [arm, rows, _]) = (folder(), files());
    let wall = folder.path().join("a <b> & c.off");
    fs::copy(data().join("cube.off"), &wall).unwrap();
    let text = answered(folder.path(), &["path", &arm, &rows, wall.to_str().unwrap()]);
    assert!(text.contains(",a <b> & c'"), "{text}");
    boxes(folder.path(), &["a&amp;b", "c"], &slide("s", "a&amp;b", "c", 0.3));
    fs::write(folder.path().join("rows.csv"), "s\n0\n0.1\n").unwrap();
    fs::write(folder.path().join("none.srdf"), "<robot name=\"r\"/>").unwrap();
    let asked = ["path", "boxes.urdf", "rows.csv", "--srdf", "none.srdf"];
    let text = answered(folder.path(), &asked);
    assert!(text.contains("link1=\"a&amp;b\" link2=\"c\""), "{text}");
}

#[test]
fn pairs_within_the_gap_at_the_start_are_too_near() {
    let folder = folder();
    boxes(folder.path(), &["a", "b"], &slide("s", "a", "b", 3.0));
    fs::write(folder.path().join("rows.csv"), "s\n0\n0.3\n").unwrap();
    fs::write(folder.path().join("none.srdf"), "<robot name=\"r\"/>").unwrap();
    let asked = ["path", "boxes.urdf", "rows.csv", "--srdf", "none.srdf", "--min-gap", "2.5"];
    let text = answered(folder.path(), &asked);
    assert!(text.starts_with("overlapping: 1 pair overlaps or is as near as 2.5 where"), "{text}");
    assert!(text.contains("too near"), "{text}");
}

#[test]
fn dents_are_reported_by_name() {
    let folder = folder();
    let dent = fs::read_to_string(folder.path().join("dent.off")).unwrap();
    let flat = |depth: f64| dent.replace("0.5 0.5 0.75", &format!("0.5 0.5 {}", 1.0 - depth));
    for (name, depth) in [("flat", 5e-6), ("flatter", 2e-6)] {
        fs::write(folder.path().join(name).with_extension("off"), flat(depth)).unwrap();
    }
    let box_ =
        "<link name=\"a\"><collision><geometry><box size=\"1 1 1\"/></geometry></collision></link>";
    let mesh = |name: &str| {
        format!("<collision><geometry><mesh filename=\"{name}.off\"/></geometry></collision>")
    };
    let both = format!("<link name=\"b\">{}{}</link>", mesh("flat"), mesh("flatter"));
    let robot = format!("<robot name=\"r\">{box_}{both}{}</robot>", slide("s", "a", "b", 3.0));
    fs::write(folder.path().join("flat.urdf"), robot).unwrap();
    fs::write(folder.path().join("rows.csv"), "s\n0\n0.3\n").unwrap();
    let asked = ["path", "flat.urdf", "rows.csv", "flatter.off", "cube.off", "--json"];
    let told = read(&answered(folder.path(), &asked));
    let dents = told["dents"].as_object().unwrap_or_else(|| panic!("{told}"));
    // The deeper dent of the two meshes of a link is reported; the cube has no dent.
    assert_eq!(dents.keys().collect::<Vec<_>>(), ["b", "flatter"], "{told}");
    let depths = dents.values().map(|depth| depth.as_f64().unwrap());
    let is_near = |(depth, wanted): (f64, f64)| (depth - wanted).abs() < 1e-12;
    assert!(depths.zip([5e-6, 2e-6]).all(is_near), "{told}");
    let [arm, rows, _] = files();
    let exact = read(&answered(folder.path(), &["path", &arm, &rows, "--json"]));
    assert!(exact.get("dents").is_none(), "{exact}");
}

#[test]
fn invalid_mesh_needs_the_hull_option() {
    let folder = folder();
    // The first face intersects itself.
    let fan = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nv 0.5 0.5 1\nf 1 4 2 3\nf 1 2 5\nf 2 3 5\n";
    fs::create_dir(folder.path().join("meshes")).unwrap();
    fs::write(folder.path().join("meshes/fan.obj"), fan).unwrap();
    let mesh = "<link name=\"b\"><collision><geometry><mesh filename=\"package:///meshes/fan.obj\"/></geometry>\
                </collision></link>";
    let box_ =
        "<link name=\"a\"><collision><geometry><box size=\"1 1 1\"/></geometry></collision></link>";
    let robot = format!("<robot name=\"r\">{box_}{mesh}{}</robot>", slide("s", "a", "b", 3.0));
    fs::write(folder.path().join("fan.urdf"), robot).unwrap();
    fs::write(folder.path().join("rows.csv"), "s\n0\n0.3\n").unwrap();
    fs::write(folder.path().join("none.srdf"), "<robot name=\"r\"/>").unwrap();
    refused(folder.path(), &["path", "fan.urdf", "rows.csv"], 3, &["fan.obj", "--package DIR"]);
    // A joint whose parent has no geometry skips no pair, so there is no note about it.
    let alone = box_.replace("\"a\"", "\"c\"") + "<link name=\"w\"/>" + &slide("s", "w", "c", 0.0);
    fs::write(folder.path().join("one.urdf"), format!("<robot name=\"r\">{alone}</robot>"))
        .unwrap();
    let said = stderr(&run(folder.path(), &["path", "one.urdf", "rows.csv", "cube.off"]));
    assert!(!said.contains("0 pairs of links"), "{said}");
    let asked = ["path", "fan.urdf", "rows.csv", "--package", ".", "--srdf", "none.srdf"];
    let refused = run(folder.path(), &asked);
    assert_eq!(refused.status.code(), Some(3));
    assert!(stderr(&refused).contains("--hull b takes the convex hull"), "{}", stderr(&refused));
    for hull in ["b", "*"] {
        let told = answered(folder.path(), &[&asked[..], &["--hull", hull, "--json"]].concat());
        let told = read(&told);
        assert_eq!((&told["outcome"], &told["hulls"]), (&json!("free"), &json!(["b"])));
    }
    let text = answered(folder.path(), &[&asked[..], &["--hull", "b"]].concat());
    assert!(text.contains("  hulls        b: a contact is that"), "{text}");
    let unknown = run(folder.path(), &[&asked[..], &["--hull", "c"]].concat());
    assert!(stderr(&unknown).contains("unknown link c"), "{}", stderr(&unknown));
    let srdf = "<robot><disable_collisions link1=\"a\" link2=\"hand\" reason=\"Never\"/></robot>";
    fs::write(folder.path().join("other.srdf"), srdf).unwrap();
    let other =
        ["path", "fan.urdf", "rows.csv", "--package", ".", "--hull", "b", "--srdf", "other.srdf"];
    let said = stderr(&run(folder.path(), &other));
    assert!(said.contains("other.srdf: ") && said.contains("hand"), "{said}");
    fs::write(folder.path().join("rows.csv"), "q\n0\n").unwrap();
    let said = stderr(&run(folder.path(), &[&asked[..], &["--hull", "b"]].concat()));
    assert!(said.contains("rows.csv: column q"), "{said}");
}
