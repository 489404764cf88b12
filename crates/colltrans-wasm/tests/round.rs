//! Spheres, capsules and boxes, which a name describes in place of a file, in all modules of the page.

use colltrans_wasm::{Answer, Answers, found, motion, page};
use serde_json::{Value, json};

const HOME: [f64; 7] = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0];
/// A cube with edges of length 2 about the origin.
const CUBE: &str = "OFF\n8 6 0\n-1 -1 -1\n1 -1 -1\n1 1 -1\n-1 1 -1\n-1 -1 1\n1 -1 1\n1 1 1\n-1 1 1\n\
    4 3 2 1 0\n4 4 5 6 7\n4 0 1 5 4\n4 1 2 6 5\n4 2 3 7 6\n4 3 0 4 7\n";

fn ask(state: &mut impl Answers, question: &Value, file: &str) -> (Value, Vec<u8>) {
    let Answer { text, numbers } = state.ask(question.to_string().as_bytes(), file.into());
    (serde_json::from_slice(&text).expect("JSON"), numbers)
}

/// Returns a state with two bodies: names of shapes, or `cube.off` with the way to use it.
fn loaded<S: Answers>(what: &str, bodies: [(&str, &str); 2]) -> S {
    let mut state = S::default();
    for (slot, (name, take)) in ["moving", "fixed"].into_iter().zip(bodies) {
        let file = if name == "cube.off" { CUBE } else { "" };
        let question = json!({ "do": what, "slot": slot, "name": name, "take": take });
        let (answer, _) = ask(&mut state, &question, file);
        assert_eq!(answer.get("error"), None, "{answer}");
    }
    state
}

fn pair(what: &str, at: [f64; 3], direction: [f64; 3]) -> Value {
    let [x, y, z] = at;
    json!({ "do": what, "moving_pose": [x, y, z, 0.0, 0.0, 0.0, 1.0], "fixed_pose": HOME,
        "direction": direction })
}

fn number(value: &Value) -> f64 {
    value.as_f64().expect("a number")
}

fn vector(value: &Value) -> [f64; 3] {
    [0, 1, 2].map(|k| number(&value[k]))
}

#[test]
fn casts_of_shapes_have_closed_forms_and_proofs() {
    let down = [0.0, 0.0, -1.0];
    let cases = [
        // Onto the middle of a face.
        ("sphere:0.5", "box:2,2,2", [0.4, 0.2, 9.0], 7.5, [0.4, 0.2, 1.0], "face"),
        // Onto an edge: 0.3 next to it and 0.4 above it.
        ("sphere:0.5", "box:2,2,2", [1.3, 0.25, 5.0], 3.6, [1.0, 0.25, 1.0], "edge"),
        // Onto the rounded face, and onto the mesh.
        ("sphere:0.5", "box:2,2,2,0.25", [0.4, 0.2, 9.0], 7.25, [0.4, 0.2, 1.25], "face"),
        ("capsule:-1,0,0,1,0,0,0.5", "cube.off", [1.5, 0.3, 9.0], 7.5, [0.75, 0.3, 1.0], "face"),
        ("sphere:1", "sphere:2", [0.0, 1.8, 9.0], 6.6, [0.0, 1.2, 1.6], "vertex"),
    ];
    for (moving, fixed, at, expected, point, feature) in cases {
        let mut state: page::State = loaded("load", [(moving, "convex"), (fixed, "convex")]);
        let (answer, _) = ask(&mut state, &pair("cast", at, down), "");
        let record = &answer["record"];
        assert!((number(&record["translation"]) - expected).abs() < 1e-12, "{answer}");
        let found = vector(&record["point"]);
        // A capsule may touch a face anywhere along its axis.
        let along = usize::from(moving.starts_with("capsule"));
        for k in along..3 {
            assert!((found[k] - point[k]).abs() < 1e-12, "{found:?} {point:?}");
        }
        assert_eq!(record["features"]["fixed"]["kind"], feature, "{answer}");
        assert!(answer["lit"]["moving"]["vertices"].as_array().is_some_and(|all| all.len() < 3));
        let mut check = pair("verify", at, down);
        check["proof"] = answer["proof"].clone();
        assert_eq!(ask(&mut state, &check, "").0["holds"], true, "{answer}");
        let lower = &mut check["proof"]["contact"]["lower"];
        *lower = json!(number(lower) + 1e-6);
        assert_eq!(ask(&mut state, &check, "").0["holds"], false, "{answer}");
    }
}

#[test]
fn casts_between_shapes_and_solids_have_closed_forms_and_proofs() {
    for (name, at, expected) in [
        ("sphere:0.5", [0.4, 0.2, 9.0], 7.5),
        ("capsule:0,-1,0,0,1,0,0.5", [1.3, 0.0, 5.0], 3.6),
        ("box:1,1,1,0.25", [0.0, 0.0, 5.0], 3.25),
    ] {
        let mut state: page::State = loaded("load", [(name, "convex"), ("cube.off", "solid")]);
        let (answer, _) = ask(&mut state, &pair("cast", at, [0.0, 0.0, -1.0]), "");
        assert_eq!(answer["kind"], "solid");
        let distance = number(&answer["record"]["distance"]);
        assert!(distance <= expected && expected - distance < 1e-6, "{name}: {distance}");
        assert!(answer["lit"]["moving"]["vertices"].is_array(), "{answer}");
        let (told, _) = ask(&mut state, &pair("certify", at, [0.0, 0.0, -1.0]), "");
        let mut check = pair("verify", at, [0.0, 0.0, -1.0]);
        check["proof"] = told["proof"].clone();
        assert_eq!(ask(&mut state, &check, "").0["holds"], true, "{name}: {told}");
    }
}

/// The vertices of the core come first, because features and proofs name them, and the drawing refers to the
/// points on the surface only.
#[test]
fn drawings_are_on_round_surfaces_behind_the_vertices_of_the_core() {
    for (name, ends, vertices) in [
        ("sphere:0.5", [[0.0; 3], [0.0; 3]], 1),
        ("capsule:0,0,-1,0,0,1,0.5", [[0.0, 0.0, -1.0], [0.0, 0.0, 1.0]], 2),
    ] {
        let load = json!({ "do": "load", "slot": "moving", "name": name, "take": "convex" });
        let (answer, numbers) = ask(&mut page::State::default(), &load, "");
        let body = &answer["body"];
        assert_eq!((number(&body["radius"]), &body["vertices"]), (0.5, &json!(vertices)));
        assert_eq!(vector(&body["high"]), [0.5, 0.5, 0.5 + ends[1][2]]);
        let [points, triangles] =
            ["points", "triangles"].map(|name| number(&answer[name]) as usize);
        let coordinates: Vec<f64> = numbers[..24 * points]
            .chunks_exact(8)
            .map(|bytes| f64::from_le_bytes(bytes.try_into().expect("eight bytes")))
            .collect();
        for point in coordinates.chunks_exact(3).skip(vertices) {
            let beyond = point[2] - point[2].clamp(ends[0][2], ends[1][2]);
            let apart = (point[0] * point[0] + point[1] * point[1] + beyond * beyond).sqrt();
            assert!((apart - 0.5).abs() < 1e-12, "{point:?}");
        }
        let corners = numbers[24 * points..24 * points + 12 * triangles]
            .chunks_exact(4)
            .map(|bytes| u32::from_le_bytes(bytes.try_into().expect("four bytes")) as usize);
        assert!(triangles > 100 && corners.clone().all(|k| (vertices..points).contains(&k)));
    }
    let load = json!({ "do": "load", "slot": "moving", "name": "box:1,2,3", "take": "convex" });
    let (answer, _) = ask(&mut page::State::default(), &load, "");
    assert_eq!((&answer["points"], &answer["triangles"]), (&json!(8), &json!(12)));
}

#[test]
fn names_without_a_body_are_errors_that_keep_the_old_body() {
    let mut state: page::State = loaded("load", [("sphere:1", "convex"), ("cube.off", "convex")]);
    let cast = pair("cast", [0.0, 0.0, 5.0], [0.0, 0.0, -1.0]);
    let (before, _) = ask(&mut state, &cast, "");
    assert_eq!(before["record"]["outcome"], "contact");
    let load = |name: &str, take: &str| json!({ "do": "load", "slot": "moving", "name": name, "take": take });
    for (name, take, file, part) in [
        ("sphere:-1", "convex", "", "radius"),
        ("sphere:x", "convex", "", "describes no shape"),
        ("box:1,2", "convex", "", "describes no shape"),
        ("sphere:1", "solid", "", "need a mesh"),
        // With bytes the name is that of a file.
        ("sphere:1", "convex", CUBE, "sphere:1"),
    ] {
        let (answer, _) = ask(&mut state, &load(name, take), file);
        let error = answer["error"].as_str().expect("an error");
        assert!(error.contains(part) && answer["gone"] == false, "{name}: {error}");
        assert_eq!(answer["instead"] == json!(["convex"]), take == "solid", "{answer}");
        assert_eq!(ask(&mut state, &cast, "").0, before);
    }
}

#[test]
fn motions_accept_shapes() {
    // At an angle of 30 degrees the sphere touches the plane y = 1.5.
    for fixed in ["box:8,2,2", "cube.off"] {
        let take = if fixed == "cube.off" { "solid" } else { "convex" };
        let mut state: motion::State = loaded("place", [("sphere:0.5", "convex"), (fixed, take)]);
        let x = if fixed == "cube.off" { 1.75 } else { 0.0 };
        let turn = |what: &str| {
            json!({ "do": what, "moving_pose": [2, 0, 0, 0, 0, 0, 1], "fixed_pose": [x, 2.5, 0, 0, 0, 0, 1],
                "moving_motion": { "turn": { "point": [0, 0, 0], "axis": [0, 0, 1], "angle": std::f64::consts::FRAC_PI_2 } } })
        };
        let (told, _) = ask(&mut state, &turn("motion"), "");
        let time = &told["record"]["time"];
        let [lower, upper] = ["lower", "upper"].map(|name| number(&time[name]));
        assert!(lower <= 1.0 / 3.0 + 1e-6 && 1.0 / 3.0 - 1e-6 <= upper, "{told}");
        assert!((number(&told["record"]["point"][1]) - 1.5).abs() < 1e-6, "{told}");
        assert_eq!(ask(&mut state, &turn("prove"), "").0["holds"], true, "{told}");
    }
}

#[test]
fn searches_refuse_rounded_bodies_and_accept_boxes() {
    let mut state: found::State =
        loaded("place", [("box:1,2,3", "convex"), ("cube.off", "convex")]);
    let search = pair("search", [0.2, 0.1, 9.0], [0.1, 0.0, -1.0]);
    assert!(ask(&mut state, &search, "").0["events"].as_array().is_some_and(|all| all.len() > 3));
    let place = json!({ "do": "place", "slot": "moving", "name": "sphere:1", "take": "convex" });
    let (refused, _) = ask(&mut state, &place, "");
    assert!(refused["error"].as_str().is_some_and(|text| text.contains("rounded")), "{refused}");
}
