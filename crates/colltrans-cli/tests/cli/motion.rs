//! `colltrans motion`.

use std::fs;

use serde_json::{Value, json};

use crate::support::{answered, data, folder, json as read, refused, run, stderr};

/// A door's answer in JSON: `cube.off` of side 1, turned about z through the origin.
fn told(arguments: &[&str]) -> Value {
    let folder = folder();
    let all = [&["motion", "cube.off", "cube.off", "--json"], arguments].concat();
    read(&answered(folder.path(), &all))
}

#[test]
fn a_slide_is_the_cast() {
    let found = told(&["--moving-pose=-4,0.2,0.1", "--slide", "8,0,0"]);
    let (lower, upper) = (found["time"]["lower"].as_f64(), found["time"]["upper"].as_f64());
    let (lower, upper) = (lower.unwrap(), upper.unwrap());
    assert_eq!(found["outcome"], "contact");
    assert!(lower <= 0.375 && 0.375 <= upper && upper - lower < 1e-13, "{found}");
    assert_eq!(found["normal"], json!([1.0, 0.0, 0.0]));
}

#[test]
fn angles_are_degrees() {
    let swing = |angle: &str| {
        told(&["--moving-pose=2,0,0", "--fixed-pose=-2,0.1,0", "--turn", "0,0,0", "z", angle])
    };
    assert_eq!(swing("90")["outcome"], "free");
    assert_eq!(swing("180")["outcome"], "contact");
    let rest = &["--fixed-pose=0,0,-1", "--turn", "0.5,0.5,0", "z", "360"];
    assert_eq!(told(rest)["outcome"], "grazing");
    assert_eq!(told(&[&rest[..], &["--tolerance", "1e-9"]].concat())["outcome"], "free");
    let screw = ["--fixed-pose=0,0,-1.5", "--screw", "0,0,0", "-z", "90", "1", "--keep", "0.25"];
    let lower = told(&screw)["time"]["lower"].as_f64().unwrap();
    assert!((lower - 0.25).abs() < 1e-12, "{lower}");
    let thrown = ["--moving-pose=-4,0,0", "--thrown", "-3.5,0.5,0.5", "8,0,0", "360,0,0"];
    assert_eq!(told(&thrown)["outcome"], "contact");
    assert_eq!(told(&["--slide", "1,0,0"])["outcome"], "overlapping");
}

#[test]
fn poses_are_gone_through() {
    let folder = folder();
    let poses = folder.path().join("poses.json");
    fs::write(&poses, "[[-4,0,0], [-4,3,0], [4,3,0]]").unwrap();
    let ask = ["motion", "cube.off", "cube.off", "--through", "poses.json"];
    assert!(answered(folder.path(), &ask).starts_with("free: the bodies never meet"));
    for (wrong, why) in [
        ("[]", "a motion needs at least one pose"),
        ("[[1,2]]", "poses.json: pose 0: 2 numbers, not 3"),
        ("{", "poses.json: no poses [[x,y,z,qx,qy,qz,qw], ...]"),
    ] {
        fs::write(&poses, wrong).unwrap();
        let output = run(folder.path(), &ask);
        assert!(stderr(&output).contains(why), "{}", stderr(&output));
    }
}

#[test]
fn a_proof_is_checked_elsewhere() {
    let folder = folder();
    let [a, b] = ["bracket.obj", "dodecahedron.off"].map(|name| data().join(name));
    let [a, b] = [a.to_str().unwrap(), b.to_str().unwrap()];
    let turn = ["--fixed-pose=-1,4,1", "--turn", "0,0,0", "z", "150", "--save-proof", "proof.json"];
    answered(folder.path(), &[&["motion", a, b], &turn[..]].concat());
    let text = answered(folder.path(), &["verify", "proof.json"]);
    assert!(text.starts_with("holds: the bodies first meet at a time between 0.28739"), "{text}");
    let told = read(&answered(folder.path(), &["verify", "proof.json", "--json"]));
    assert_eq!(told["holds"], true);
    let file = folder.path().join("proof.json");
    let mut proof: Value = serde_json::from_str(&fs::read_to_string(&file).unwrap()).unwrap();
    proof["moving_motion"][0]["rate"] = json!(2.7);
    fs::write(&file, proof.to_string()).unwrap();
    let output = run(folder.path(), &["verify", "proof.json"]);
    assert_eq!(output.status.code(), Some(6), "{}", stderr(&output));
    assert!(stderr(&output).contains("the proof does not hold"), "{}", stderr(&output));
}

#[test]
fn what_is_wrong_is_said() {
    let folder = folder();
    let ask = |more: &[&str]| {
        let output = run(folder.path(), &[&["motion", "cube.off", "cube.off"], more].concat());
        assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
        stderr(&output)
    };
    assert!(ask(&[]).contains("--turn"));
    assert!(ask(&["--turn", "0,0", "z", "3"]).contains("--turn: 2 numbers, not 3 (x,y,z)"));
    assert!(ask(&["--turn", "0,0,0", "z", "x"]).contains("--turn: `x` is not a number"));
    assert!(ask(&["--turn", "0,0,0", "z", "1e9"]).contains("is not a number from -1e5 to 1e5"));
    assert!(ask(&["--slide", "1,0,0", "--turn", "0,0,0", "z", "1"]).contains("cannot be used"));
    let bolt = data().join("bolt.stl");
    let bolt = bolt.to_str().unwrap();
    refused(
        folder.path(),
        &["motion", bolt, "cube.off", "--slide", "1,0,0"],
        3,
        &["is not convex"],
    );
}
