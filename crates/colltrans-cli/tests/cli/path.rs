//! `colltrans path`.

use std::fs;

use serde_json::{Value, json};

use crate::support::{answered, data, folder, json as read, run, stderr};

/// The files of the arm, its path and a wire in its way.
fn files() -> [String; 3] {
    ["arm.urdf", "arm.csv", "wire.obj"].map(|name| data().join(name).to_str().unwrap().to_owned())
}

#[test]
fn a_wire_in_the_way_is_met() {
    let (folder, [arm, rows, wire]) = (folder(), files());
    let text = answered(folder.path(), &["path", &arm, &rows, &wire]);
    assert!(
        text.starts_with("contact\n  bodies       tool, wire\n  time         0.60356030803"),
        "{text}"
    );
    let told = read(&answered(folder.path(), &["path", &arm, &rows, &wire, "--json"]));
    assert_eq!((&told["pair"], &told["pairs"]), (&json!(["tool", "wire"]), &json!(6)));
    assert_eq!(told["place"]["row"], 0);
    assert!(told.get("keep").is_none());
    // Links with a joint between them touch: they are not asked about, and that is said.
    let touching = json!([["base", "upper"], ["upper", "fore"], ["fore", "tool"]]);
    assert_eq!(told["left_out"], touching);
    let free = ["path", &arm, &rows, &wire, "--ignore", "wire, tool", "--json"];
    let free = read(&answered(folder.path(), &free));
    assert_eq!(
        (&free["outcome"], &free["left_out"][3]),
        (&json!("free"), &json!(["tool", "wire"]))
    );
    let alone = answered(folder.path(), &["path", &arm, &rows]);
    assert!(alone.starts_with("free: no two bodies of those asked about meet on"), "{alone}");
    assert!(alone.contains("  left out     base, upper; upper, fore; fore, tool\n"), "{alone}");
    let kept = ["path", &arm, &rows, &wire, "--keep", "0.2"];
    let text = answered(folder.path(), &kept);
    assert!(text.contains("  kept         0.2, a gap"), "{text}");
    let kept = read(&answered(folder.path(), &[&kept[..], &["--json"]].concat()));
    assert_eq!((&kept["outcome"], &kept["keep"]), (&json!("contact"), &json!(0.2)));
    let small = ["path", &arm, &rows, &wire, "--scene-scale", "0.001", "--json"];
    assert_eq!(read(&answered(folder.path(), &small))["outcome"], "free");
}

#[test]
fn what_is_not_asked_is_said() {
    let (folder, [arm, rows, wire]) = (folder(), files());
    let said = stderr(&run(folder.path(), &["path", &arm, &rows, &wire]));
    assert!(said.contains("3 pairs of links with one joint between them are not held"), "{said}");
    assert!(said.contains("links that no joint moves are not held against the scene"), "{said}");
    assert!(said.contains("a cylinder of radius 0.002 is taken as a polyhedron"), "{said}");
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
        said.contains("joint shoulder is beyond its limits, -3 to 3 rad, in 1 of 2 rows"),
        "{said}"
    );
}

#[test]
fn what_is_wrong_is_told() {
    let (folder, [arm, rows, wire]) = (folder(), files());
    fs::write(folder.path().join("short.csv"), "0,0\n").unwrap();
    fs::write(folder.path().join("text.csv"), "0,0,x\n").unwrap();
    fs::write(folder.path().join("foo.json"), "{\"foo\": 1}").unwrap();
    for (arguments, code, why) in [
        (
            vec!["path", &arm, "short.csv"],
            3,
            "short.csv: rows have 2 values, and 3 joints have one each",
        ),
        (vec!["path", &arm, "text.csv"], 3, "text.csv: line 1: `0,0,x` are not numbers"),
        (vec!["path", &arm, "none.csv"], 3, "none.csv: cannot be read"),
        (vec!["path", &wire, &rows], 3, "URDF"),
        (vec!["path", &arm, "foo.json"], 3, "foo.json: JSON: it is neither a list of rows nor"),
        (vec!["path", &arm, &rows, "--ignore", "tool"], 2, "--ignore tool: not A,B"),
        (vec!["path", &arm, &rows, "--joint", "reach=1mm"], 2, "NAME=VALUE, in radians or metres"),
        (
            vec!["path", &arm, &rows, "--ignore", "tool,hand"],
            2,
            "--ignore: there is no hand among base, upper",
        ),
        (vec!["path", &arm, &rows, "--joint", "reach"], 2, "--joint reach: not NAME=VALUE"),
        (
            vec!["path", &arm, &rows, "--joint", "reach=0"],
            3,
            "column reach is of no joint that moves",
        ),
        (vec!["path", &arm, &rows, &rows], 3, "arm.csv"),
    ] {
        let output = run(folder.path(), &arguments);
        assert_eq!(output.status.code(), Some(code), "{arguments:?}: {}", stderr(&output));
        assert!(stderr(&output).contains(why), "{arguments:?}: {}", stderr(&output));
    }
}

#[test]
fn a_proof_is_checked_elsewhere() {
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
    changed(&|proof| proof["path"]["rows"][1][0] = json!(0.95));
    changed(&|proof| proof["statement"]["pairs"] = json!([["upper", "tool"]]));
    changed(&|proof| proof["statement"]["lower"] = json!(0.7));
    changed(&|proof| proof["frames"][1]["origin"]["translation"] = json!([0.6, 0.0, 0.0]));
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
fn what_is_given_twice_is_refused() {
    let (folder, [arm, rows, _]) = (folder(), files());
    fs::write(folder.path().join("twice.csv"), "shoulder,elbow,elbow\n0,0,0\n").unwrap();
    let said = stderr(&run(folder.path(), &["path", &arm, "twice.csv"]));
    assert!(said.contains("twice.csv: names of columns: `elbow` is there twice"), "{said}");
    let joints = ["path", &arm, &rows, "--joint", "reach=0.1", "--joint", "reach=0.2"];
    let said = stderr(&run(folder.path(), &joints));
    assert!(said.contains("--joint reach=0.2: this joint is there twice"), "{said}");
    let said = stderr(&run(folder.path(), &["path", &arm, &rows, "--joint", "reach=nan"]));
    assert!(said.contains("--joint reach=nan: not NAME=VALUE"), "{said}");
}

#[test]
fn bodies_of_one_name_are_told_apart() {
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
    assert!(same.contains("two links or bodies around are called tool.obj"), "{same}");
}
