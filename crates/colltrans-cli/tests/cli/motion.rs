//! `colltrans motion`: answers, pictures, proofs and errors.

use std::fs;

use colltrans::glam::DVec3;
use colltrans::motion::{Motion, MotionCase, MotionCast, MotionOutcome};
use colltrans::{ConvexPolyhedron, Pose};
use serde_json::{Value, json};

use crate::support::{answered, data, folder, json as read, refused, run, stderr};

/// Returns the answer in JSON for two unit cubes with these arguments.
fn told(arguments: &[&str]) -> Value {
    let folder = folder();
    let all = [&["motion", "cube.off", "cube.off", "--json"], arguments].concat();
    read(&answered(folder.path(), &all))
}

#[test]
fn slide_has_the_contact_time_of_the_cast() {
    let found = told(&["--moving-pose=-4,0.2,0.1", "--slide", "8,0,0"]);
    let (lower, upper) = (found["time"]["lower"].as_f64(), found["time"]["upper"].as_f64());
    let (lower, upper) = (lower.unwrap(), upper.unwrap());
    assert_eq!(found["outcome"], "contact");
    assert!(lower <= 0.375 && 0.375 <= upper && upper - lower < 1e-13, "{found}");
    assert_eq!(found["normal"], json!([1.0, 0.0, 0.0]));
}

#[test]
fn angles_are_in_degrees() {
    let swing = |angle: &str| {
        told(&["--moving-pose=2,0,0", "--fixed-pose=-2,0.1,0", "--turn", "0,0,0", "z", angle])
    };
    assert_eq!(swing("90")["outcome"], "free");
    assert_eq!(swing("180")["outcome"], "contact");
    let rest = &["--fixed-pose=0,0,-1", "--turn", "0.5,0.5,0", "z", "360"];
    assert_eq!(told(rest)["outcome"], "grazing");
    assert_eq!(told(&[&rest[..], &["--tolerance", "1e-9"]].concat())["outcome"], "free");
    let screw = ["--fixed-pose=0,0,-1.5", "--screw", "0,0,0", "-z", "90", "1", "--min-gap", "0.25"];
    let lower = told(&screw)["time"]["lower"].as_f64().unwrap();
    assert!((lower - 0.25).abs() < 1e-12, "{lower}");
    let thrown = ["--moving-pose=-4,0,0", "--thrown", "-3.5,0.5,0.5", "8,0,0", "360,0,0"];
    assert_eq!(told(&thrown)["outcome"], "contact");
    assert_eq!(told(&["--slide", "1,0,0"])["outcome"], "overlapping");
}

/// A cube on another one turns freely about the vertical, and cannot be tipped into it; as convex bodies and as parts.
#[test]
fn clearance_permits_sliding_and_stops_at_penetration() {
    let folder = folder();
    let words = ["motion", "cube.off", "cube.off", "--fixed-pose=0,0,-1", "--clearance", "--json"];
    for more in [&[][..], &["--ignore-start-overlaps"]] {
        let asked =
            |motion: &[&str]| read(&answered(folder.path(), &[&words[..], motion, more].concat()));
        assert_eq!(asked(&["--turn", "0.5,0.5,0", "z", "360"])["outcome"], "free");
        let tipped = asked(&["--turn", "0.5,0.5,0", "x", "30"]);
        let [outcome, time] = ["outcome", "time"].map(|name| tipped[name].clone());
        assert_eq!((outcome, &time["lower"]), (json!("blocked"), &json!(0.0)), "{tipped}");
        let raised = asked(&["--thrown", "0.5,0.5,0.5", "0,0,1", "0,0,90"]);
        assert_eq!(raised["outcome"], "free", "{raised}");
    }
    let stopped = ["--moving-pose=0,0,1", "--fixed-pose=3,0,1", "--slide", "4,0,0"];
    let cubes = ["motion", "cube.off", "cube.off", "--clearance"];
    let text = answered(folder.path(), &[&cubes[..], &stopped].concat());
    assert!(
        text.starts_with("blocked: the body can move until the time below\n")
            && text.contains("0.5 of"),
        "{text}"
    );
    let inside = ["--moving-pose=0.25,0,0", "--slide", "4,0,0"];
    let text = answered(folder.path(), &[&cubes[..], &inside].concat());
    assert!(text.contains("cube.off in cube.off: a tolerance of 0.75"), "{text}");
    let refusal = ["--save-proof", "proof.json"];
    let words = [&cubes[..], &stopped, &refusal].concat();
    refused(folder.path(), &words, 2, &["cannot be used with"]);
}

#[test]
fn repeated_or_missing_motions_are_rejected() {
    let folder = folder();
    let turn = ["--turn", "0,0,0", "z", "90"];
    let fixed = ["--fixed-turn", "0,0,0", "z", "90"];
    let cubes = ["motion", "cube.off", "cube.off", "--moving-pose=4,0,0"];
    let twice = [&cubes[..], &turn, &turn].concat();
    refused(folder.path(), &twice, 2, &["--turn", "multiple times"]);
    let twice = [&cubes[..], &turn, &fixed, &fixed].concat();
    refused(folder.path(), &twice, 2, &["--fixed-turn", "multiple times"]);
    refused(folder.path(), &cubes, 2, &["nothing moves; give one of --turn"]);
    assert!(answered(folder.path(), &[&cubes[..], &fixed].concat()).starts_with("free"));
}

#[test]
fn free_answer_states_gap_or_tolerance() {
    let folder = folder();
    let free = |more: &[&str]| {
        let words = ["motion", "cube.off", "cube.off", "--slide", "0,0,1"];
        let text = answered(folder.path(), &[&words[..], more].concat());
        text.lines().next().unwrap().to_owned()
    };
    let never = |what: &str| format!("free: the bodies never {what} throughout the motion");
    assert_eq!(free(&["--fixed-pose=4,0,0"]), never("meet"));
    assert_eq!(free(&["--fixed-pose=4,0,0", "--min-gap", "0.5"]), never("come as near as 0.5"));
    let deep = free(&["--fixed-pose=0.75,0,0", "--tolerance", "0.9"]);
    assert_eq!(deep, never("overlap by more than 0.9"));
}

#[test]
fn through_follows_poses_of_a_file() {
    let folder = folder();
    let poses = folder.path().join("poses.json");
    fs::write(&poses, "[[-4,0,0], [-4,3,0], [4,3,0]]").unwrap();
    let ask = ["motion", "cube.off", "cube.off", "--through", "poses.json"];
    assert!(answered(folder.path(), &ask).starts_with("free: the bodies never meet"));
    for (wrong, why) in [
        ("[]", "a motion needs at least one pose"),
        ("[[1,2]]", "poses.json: pose 0: 2 numbers given, expected 3"),
        ("{", "poses.json: expected poses [[x,y,z,qx,qy,qz,qw], ...]"),
    ] {
        fs::write(&poses, wrong).unwrap();
        let output = run(folder.path(), &ask);
        assert!(stderr(&output).contains(why), "{}", stderr(&output));
    }
}

#[test]
fn quaternions_of_motions_are_normalised_with_a_note() {
    let folder = folder();
    fs::write(folder.path().join("poses.json"), "[[-4,0,0], [-4,3,0,0,0,0.707,0.707]]").unwrap();
    for (motion, place) in [
        (["--to", "4,0,0,0,0,0.707,0.707"], "--to"),
        (["--fixed-to", "4,0,0,0,0,0.707,0.707"], "--fixed-to"),
        (["--through", "poses.json"], "poses.json: pose 1"),
    ] {
        let output =
            run(folder.path(), &[&["motion", "cube.off", "cube.off"], &motion[..]].concat());
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        let note =
            format!("note: {place}: the quaternion has length 0.999849, not 1; it was normalised");
        assert!(stderr(&output).starts_with(&note), "{}", stderr(&output));
    }
}

#[test]
fn fixed_mesh_may_move() {
    let apart = ["--fixed-pose=4,0.2,0.1", "--slide", "2,0,0"];
    assert_eq!(told(&apart)["outcome"], "free");
    let met = told(&[&apart[..], &["--fixed-slide=-2,0,0"]].concat());
    let [lower, upper] = ["lower", "upper"].map(|end| met["time"][end].as_f64().unwrap());
    assert!(lower <= 0.75 && 0.75 <= upper && upper - lower < 1e-13, "{met}");
    // Both bodies turn together about the same axis.
    let carried = ["--fixed-pose=2,0,0", "--turn", "1.5,0.5,0", "z", "200"];
    assert_eq!(told(&carried)["outcome"], "contact");
    let both = [&carried[..], &["--fixed-turn", "1.5,0.5,0", "z", "200"]].concat();
    assert_eq!(told(&both)["outcome"], "free");
    let to = ["--moving-pose=-4,0,0", "--to", "4,0,0", "--fixed-to", "0,1,0"];
    assert_eq!(told(&to)["outcome"], "contact");
    let folder = folder();
    let words = ["motion", "cube.off", "cube.off"];
    let text = answered(folder.path(), &[&words[..], &to[..]].concat());
    assert!(text.contains("\n  fixed pose   0,"), "{text}");
}

#[test]
fn first_contact_of_several_meshes_is_reported() {
    let folder = folder();
    let cube = fs::read_to_string(folder.path().join("cube.off")).unwrap();
    let lines: Vec<&str> = cube.lines().collect();
    // Returns the cube translated along x.
    let moved = |by: f64| {
        let mut out = vec![lines[0].to_owned(), lines[1].to_owned()];
        let count: usize = lines[1].split_whitespace().next().unwrap().parse().unwrap();
        for line in &lines[2..2 + count] {
            let x: Vec<f64> = line.split_whitespace().map(|x| x.parse().unwrap()).collect();
            out.push(format!("{} {} {}", x[0] + by, x[1], x[2]));
        }
        out.extend(lines[2 + count..].iter().map(ToString::to_string));
        out.join("\n")
    };
    for (name, by) in [("near.off", 4.0), ("far.off", 6.0), ("aside.off", -9.0)] {
        fs::write(folder.path().join(name), moved(by)).unwrap();
    }
    let ask = |more: &[&str]| {
        let words = ["motion", "cube.off", "--slide", "8,0.1,0.1", "--json", "--from"];
        read(&answered(folder.path(), &[&words[..], more].concat()))
    };
    let found = ask(&["far.off", "near.off", "aside.off"]);
    assert_eq!((&found["outcome"], &found["fixed"]), (&json!("contact"), &json!("near.off")));
    assert_eq!(found["time"], ask(&["near.off"])["time"]);
    assert!(ask(&["near.off"]).get("fixed").is_none());
    assert_eq!(ask(&["aside.off", "aside.off"])["outcome"], "free");
}

#[test]
fn picture_shows_start_contact_and_end() {
    let folder = folder();
    let draw = |more: &[&str]| {
        let words = ["motion", "cube.off", "cube.off", "--picture", "motion.svg"];
        answered(folder.path(), &[&words[..], more].concat());
        let svg = fs::read_to_string(folder.path().join("motion.svg")).unwrap();
        is_whole(&svg);
        svg
    };
    let met =
        draw(&["--moving-pose=2,0,0", "--fixed-pose=-2,0.1,0", "--turn", "0,0,0", "z", "180"]);
    // The corner (2, 1), at an angle of atan 1/2, touches the top at a height of 1.1.
    assert!(
        met.contains("Contact at 0.688706")
            && ["at the start", "at contact", "at the end"].iter().all(|place| met.contains(place)),
        "{met}"
    );
    // Each ghost is a group: the contact and the end, or only one of them.
    let ghosts = |svg: &str| svg.matches(r#"<g opacity="0.75">"#).count();
    assert_eq!(ghosts(&met), 2);
    // The path is one dashed polyline.
    let way = met.lines().find(|line| line.contains(r#"stroke-dasharray="5 4""#)).unwrap();
    assert!(way.matches('M').count() == 1 && way.matches('L').count() > 100, "{way}");
    let free = draw(&["--moving-pose=2,0,0", "--turn", "5,0,0", "z", "90"]);
    assert!(free.contains("Free: the bodies never meet") && ghosts(&free) == 1);
    assert!(free.contains("moving, at the start<"), "{free}");
    let over = draw(&["--slide", "3,0,0"]);
    assert!(over.contains("Overlapping") && ghosts(&over) == 1);
    assert!(over.contains("moving, at the end<"), "{over}");
    let words = ["motion", "cube.off", "cube.off", "--slide", "1,0,0", "--picture", "cube.off"];
    refused(folder.path(), &words, 2, &["pictures are SVG files"]);
}

/// Asserts that the SVG is complete and its groups are closed.
fn is_whole(svg: &str) {
    assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"));
    assert_eq!(svg.matches("<g").count(), svg.matches("</g>").count());
}

#[test]
fn screw_of_a_bolt_stops_as_its_slide() {
    let folder = folder();
    let [bolt, plate] = ["bolt.stl", "plate.off"].map(|name| data().join(name));
    let [bolt, plate] = [bolt.to_str().unwrap(), plate.to_str().unwrap()];
    let ask = |more: &[&str]| {
        let words = ["motion", bolt, plate, "--moving-pose=0,0,9", "--json"];
        read(&answered(folder.path(), &[&words[..], more].concat()))
    };
    // The bolt turns down its hole by the same distance as without a turn.
    let down = ask(&["--screw", "0,0,0", "z", "90", "-20"]);
    assert_eq!(down["fixed"], json!(plate));
    let straight = ask(&["--slide", "0,0,-20"]);
    let [a, b] = [&down, &straight].map(|found| found["time"]["lower"].as_f64().unwrap());
    assert!((a - 0.45).abs() < 1e-6 && (b - 0.45).abs() < 1e-6, "{down} {straight}");
    assert_eq!(ask(&["--screw", "0,0,0", "z", "-90", "20"])["outcome"], "free");
    assert!(ask(&["--slide", "0,0,1"])["tolerance"].as_f64().unwrap() > 1e-7);
    let text = answered(
        folder.path(),
        &["motion", bolt, plate, "--moving-pose=0,0,9", "--screw", "0,0,0", "z", "90", "-20"],
    );
    assert!(text.contains("\n  moving mesh  ") && text.contains("\n  tolerance    "), "{text}");
    let save = ["--save-proof", "proof.json"];
    let saved = ask(&[&["--screw", "0,0,0", "z", "30", "-20"][..], &save].concat());
    let proven = read(&answered(folder.path(), &["verify", "proof.json", "--json"]));
    let upper = |told: &Value| told["time"]["upper"].as_f64().unwrap();
    assert!((upper(&proven) - upper(&saved)).abs() < 1e-12, "{saved} {proven}");
    let text = answered(folder.path(), &["verify", "proof.json"]);
    assert!(text.starts_with("holds: the solids, shrunk by "), "{text}");
}

#[test]
#[ignore = "long: solids that overlap as they turn"]
fn ignored_start_overlap_allows_motion() {
    let folder = folder();
    // A unit cube that overlaps the other by 0.25 turns out of it about an edge.
    let ask = |more: &[&str]| {
        let words = ["motion", "cube.off", "cube.off", "--moving-pose=0,0,0.75"];
        answered(folder.path(), &[&words[..], &["--turn", "0,0,1", "-y", "90"], more].concat())
    };
    assert!(ask(&["--tolerance", "0.01"]).starts_with("overlapping"));
    let ignored = ask(&["--ignore-start-overlaps"]);
    assert!(ignored.starts_with("free") && ignored.contains("\n  ignored      "), "{ignored}");
    let told = read(&ask(&["--ignore-start-overlaps", "--json"]));
    let least = told["start_overlaps"][0]["least_tolerance"].as_f64().unwrap();
    assert!((least - 0.25).abs() < 1e-6, "{told}");
    let proof = ["--ignore-start-overlaps", "--save-proof", "proof.json"];
    let words = [&["motion", "cube.off", "cube.off", "--slide", "1,0,0"][..], &proof].concat();
    refused(folder.path(), &words, 2, &["cannot prove an answer with --ignore-start-overlaps"]);
}

#[test]
fn proof_of_several_meshes_covers_each_pair() {
    let folder = folder();
    let [a, b] = ["bracket.obj", "dodecahedron.off"].map(|name| data().join(name));
    let [a, b] = [a.to_str().unwrap(), b.to_str().unwrap()];
    let turn = ["--fixed-pose=-1,4,1", "--turn", "0,0,0", "z", "150", "--save-proof", "proof.json"];
    let found = answered(
        folder.path(),
        &[&["motion", a, "--from", "cube.off", b, "--json"], &turn[..]].concat(),
    );
    let proven = read(&answered(folder.path(), &["verify", "proof.json", "--json"]));
    assert_eq!(read(&found)["time"], proven["time"]);
    let text = answered(folder.path(), &["verify", "proof.json"]);
    assert!(text.starts_with("holds: of 2 pairs of bodies the first meet at a time"), "{text}");
    let file = folder.path().join("proof.json");
    let mut proof: Value = serde_json::from_str(&fs::read_to_string(&file).unwrap()).unwrap();
    proof["placement"]["motions"][1][0]["motion"][0]["rate"] = json!(2.7);
    fs::write(&file, proof.to_string()).unwrap();
    let output = run(folder.path(), &["verify", "proof.json"]);
    assert_eq!(output.status.code(), Some(6), "{}", stderr(&output));
}

#[test]
fn replayed_motion_has_the_same_bounds() {
    let folder = folder();
    let cube = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE).unwrap();
    let start = Pose::from_translation(DVec3::new(-4.0, 0.5, 0.0)).unwrap();
    let screw = Motion::screw(start, DVec3::Z, DVec3::X, 0.5, 8.0).unwrap();
    let cast = MotionCast::new(cube.with_motion(&screw), cube.at(Pose::IDENTITY)).unwrap();
    let cast = cast.with_min_gap(0.125).unwrap();
    fs::write(folder.path().join("case.json"), MotionCase::from_cast(&cast).to_json()).unwrap();
    let found = read(&answered(folder.path(), &["replay", "case.json", "--json"]));
    let MotionOutcome::Contact(contact) = cast.first_contact().unwrap() else { panic!("{found}") };
    assert_eq!(found["time"], json!({ "lower": contact.lower, "upper": contact.upper }));
    assert_eq!(found["min_gap"], 0.125);
    assert!(answered(folder.path(), &["replay", "case.json"]).starts_with("contact\n  time"));
    let broken = MotionCase::from_cast(&cast).to_json().replace("\"rate\":0.5", "\"rate\":1e9");
    fs::write(folder.path().join("case.json"), broken).unwrap();
    refused(folder.path(), &["replay", "case.json"], 3, &["is not a number from -1e5 to 1e5"]);
}

#[test]
fn motion_proof_holds_and_changed_one_does_not() {
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
    proof["placement"]["motions"][0][0]["motion"][0]["rate"] = json!(2.7);
    fs::write(&file, proof.to_string()).unwrap();
    let output = run(folder.path(), &["verify", "proof.json"]);
    assert_eq!(output.status.code(), Some(6), "{}", stderr(&output));
    assert!(stderr(&output).contains("the proof does not hold"), "{}", stderr(&output));
}

#[test]
fn invalid_motion_arguments_are_rejected() {
    let folder = folder();
    let ask = |more: &[&str]| {
        let output = run(folder.path(), &[&["motion", "cube.off", "cube.off"], more].concat());
        assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
        stderr(&output)
    };
    assert!(ask(&[]).contains("--turn"));
    assert!(
        ask(&["--turn", "0,0", "z", "3"]).contains("--turn: 2 numbers given, expected 3 (x,y,z)")
    );
    assert!(ask(&["--turn", "0,0,0", "z", "x"]).contains("--turn: `x` is not a number of degrees"));
    assert!(ask(&["--turn", "0,0,0", "z", "1e9"]).contains("is not a number from -1e5 to 1e5"));
    assert!(ask(&["--slide", "1,0,0", "--turn", "0,0,0", "z", "1"]).contains("cannot be used"));
    let keeps = ["--slide", "1,0,0", "--min-gap", "1", "--tolerance", "1"];
    assert!(ask(&keeps).contains("either --min-gap or --tolerance"));
    assert!(
        ask(&["--slide", "1,0,0", "--open", "--hull"])
            .contains("--ignore-start-overlaps require parts")
    );
}

#[test]
fn help_lists_motions_before_outputs_and_poses() {
    let help = answered(folder().path(), &["motion", "--help"]);
    let at = |words: &str| help.find(words).unwrap_or_else(|| panic!("no {words} in {help}"));
    assert!(at("--turn") < at("--min-gap") && at("--min-gap") < at("Poses and scales"));
    assert!(at("--fixed-turn") < at("Poses and scales"));
}

#[test]
fn grazing_pair_does_not_hide_a_later_contact() {
    let folder = folder();
    let cuboid = |name: &str, low: [f64; 3], high: [f64; 3]| {
        let corner = |k: usize, j: usize| if k >> j & 1 == 0 { low[j] } else { high[j] };
        let lines =
            (0..8).map(|k| format!("v {} {} {}\n", corner(k, 0), corner(k, 1), corner(k, 2)));
        let faces = "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
        fs::write(folder.path().join(name), lines.collect::<String>() + faces).unwrap();
    };
    cuboid("cube.obj", [-1.0, -1.0, 0.0], [1.0, 1.0, 2.0]);
    cuboid("floor.obj", [-9.0, -9.0, -1.0], [9.0, 9.0, 0.0]);
    cuboid("wall.obj", [1.25, -9.0, 0.5], [2.0, 9.0, 3.0]);
    let ask = |more: &[&'static str]| {
        let turn = ["motion", "cube.obj", "--turn", "0,0,0", "z", "90", "--from"];
        run(folder.path(), &[&turn[..], more].concat())
    };
    let told = |more: &[&'static str]| -> Value {
        serde_json::from_slice(&ask(more).stdout).expect("an answer")
    };
    let wall = told(&["wall.obj", "--json"]);
    let both = told(&["floor.obj", "wall.obj", "--json"]);
    assert_eq!((&wall["outcome"], &both["outcome"]), (&json!("contact"), &json!("grazing")));
    assert_eq!((&both["fixed"], &both["time"]["lower"]), (&json!("floor.obj"), &json!(0.0)));
    assert_eq!(both["time"]["upper"], wall["time"]["upper"]);
    let output = ask(&["floor.obj", "wall.obj"]);
    assert!(stderr(&output).contains("cube.obj and wall.obj are proven to meet by time"));
    let told = String::from_utf8(output.stdout).unwrap();
    assert!(told.contains("\n  no earlier   0\n  no later     "), "{told}");
}
