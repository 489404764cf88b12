//! Answers to the page's questions, compared with the library.

use std::fmt::Write as _;

use colltrans_mesh::Format;
use colltrans_wasm::page::State;
use colltrans_wasm::{Answer, Answers as _};
use serde_json::{Value, json};

const TILTED: [f64; 7] = [6.0, 1.0, 9.0, 0.2, 0.3, 0.1, 0.927_361_849_549_570_4];
const HOME: [f64; 7] = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0];

fn ask(state: &mut State, question: &Value, file: Vec<u8>) -> (Value, Vec<f64>) {
    let Answer { text, numbers } = state.ask(question.to_string().as_bytes(), file);
    let numbers = numbers.chunks_exact(8).map(|b| f64::from_le_bytes(b.try_into().unwrap()));
    (serde_json::from_slice(&text).unwrap(), numbers.collect())
}

fn data(name: &str) -> Vec<u8> {
    std::fs::read(format!("{}/../../data/{name}", env!("CARGO_MANIFEST_DIR"))).unwrap()
}

fn loaded(moving: &str, fixed: &str, take: &str) -> State {
    let mut state = State::default();
    for (slot, name) in [("moving", moving), ("fixed", fixed)] {
        let question = json!({ "do": "load", "slot": slot, "name": name, "take": take });
        let (answer, _) = ask(&mut state, &question, data(name));
        assert!(answer["body"]["vertices"].as_u64().unwrap() > 0, "{answer}");
    }
    state
}

fn pair(what: &str, direction: [f64; 3]) -> Value {
    json!({ "do": what, "moving_pose": TILTED, "fixed_pose": HOME, "direction": direction })
}

#[test]
fn cast_equals_library_cast() {
    use colltrans::glam::{DQuat, DVec3};
    use colltrans::{Cast, ConvexPolyhedron, Outcome, Pose};

    let mut state = loaded("dodecahedron.off", "bracket.obj", "convex");
    let (answer, _) = ask(&mut state, &pair("cast", [-0.3, 0.1, -1.0]), Vec::new());
    let body = |name: &str| {
        let path = format!("{}/../../data/{name}", env!("CARGO_MANIFEST_DIR"));
        let mesh = colltrans_mesh::read(path).unwrap();
        ConvexPolyhedron::from_mesh(&mesh.vertices, &mesh.faces, 1e-5 * mesh.extent()).unwrap()
    };
    let (moving, fixed) = (body("dodecahedron.off"), body("bracket.obj"));
    let [x, y, z, a, b, c, w] = TILTED;
    let start = Pose::new(DQuat::from_xyzw(a, b, c, w), DVec3::new(x, y, z)).unwrap();
    let cast = Cast::new(moving.at(start), fixed.at(Pose::IDENTITY), DVec3::new(-0.3, 0.1, -1.0));
    let Outcome::Contact(contact) = cast.unwrap().first_contact().unwrap() else { panic!() };
    let record = &answer["record"];
    let t = record["translation"].as_f64().unwrap();
    assert_eq!(t.to_bits(), contact.translation.to_bits());
    assert_eq!(answer["proof"]["contact"]["lower"], json!(contact.certificate.lower));
    assert_eq!(record["normal"], json!(contact.normal.to_array()));
    assert_eq!(answer["clearance"]["outcome"], "blocked");
}

/// Features have vertex numbers of the file, and highlights the indices of the answer, even if a vertex is
/// unused. A face is a polygon, and each number has its bounds.
#[test]
fn solid_contact_reports_features_and_bounds() {
    let file = "OFF\n5 4 0\n50 50 50\n-1 -1 1\n1 -1 1\n0 1 1\n0.25 0 0\n\
                3 1 2 3\n3 2 1 4\n3 3 2 4\n3 1 3 4\n";
    let mut state = loaded("dodecahedron.off", "plate.off", "solid");
    let load = json!({ "do": "load", "slot": "moving", "name": "tip.off", "take": "solid" });
    let (body, numbers) = ask(&mut state, &load, file.into());
    assert_eq!(body["body"]["vertices"], 4, "{body}");
    let mut question = pair("cast", [0.0, 0.0, -1.0]);
    question["moving_pose"] = json!([6.0, 5.0, 4.0, 0.0, 0.0, 0.0, 1.0]);
    let (answer, _) = ask(&mut state, &question, Vec::new());
    let (record, lit) = (&answer["record"], &answer["lit"]);
    let features = &record["features"];
    assert_eq!(features["moving"], json!({ "kind": "vertex", "vertices": [4] }));
    assert_eq!(lit["moving"], json!({ "vertices": [3] }));
    assert_eq!(numbers[9..12], [0.25, 0.0, 0.0], "the vertex that is lit");
    assert_eq!(features["fixed"]["kind"], "face", "{answer}");
    assert!(lit["fixed"]["face"].is_u64(), "{answer}");
    let corners = features["fixed"]["vertices"].as_array().unwrap();
    assert!(corners.len() > 4, "with its hole: {answer}");
    let number = |value: &Value| value.as_f64().unwrap();
    let (t, distance) = (number(&record["translation"]), number(&record["distance"]));
    assert!(distance <= t && t - distance < 1e-11, "{answer}");
    for name in ["translation", "offset_distance", "exit"] {
        let [lower, upper] = [0, 1].map(|k| number(&record[format!("{name}_bounds")][k]));
        let value = number(&record[name]);
        assert!(lower <= value && value <= upper, "{name}: {answer}");
    }
}

#[test]
fn invalid_questions_return_errors() {
    let mut state = State::default();
    let mut refused = |question: Value, file: Vec<u8>, part: &str| {
        let (answer, _) = ask(&mut state, &question, file);
        let error = answer["error"].as_str().unwrap().to_owned();
        assert!(error.contains(part), "{error}");
        answer["instead"].clone()
    };
    let load =
        |name: &str| json!({ "do": "load", "slot": "moving", "name": name, "take": "convex" });
    refused(json!([1]), Vec::new(), "not an object");
    refused(json!({ "do": "dance" }), Vec::new(), "dance");
    refused(json!({ "do": "cast" }), Vec::new(), "moving_pose is missing");
    refused(pair("cast", [0.0, 0.0, 1.0]), Vec::new(), "two bodies are needed");
    refused(load("a.txt"), b"x".to_vec(), "a.txt");
    refused(load("a.off"), b"OFF\n1 0 0\n0 0".to_vec(), "a.off");
    let instead = refused(load("plate.off"), data("plate.off"), "plate.off");
    assert!(instead.as_array().unwrap().contains(&json!("solid")));
    // The file is kept, so that it can be used in another way.
    let again = json!({ "do": "load", "slot": "moving", "name": "plate.off", "take": "solid" });
    let (answer, _) = ask(&mut state, &again, Vec::new());
    assert_eq!(answer["body"]["kind"], "solid");

    let mut state = loaded("dodecahedron.off", "bracket.obj", "convex");
    let (before, _) = ask(&mut state, &pair("cast", [-0.3, 0.1, -1.0]), Vec::new());
    assert_eq!(before["record"]["outcome"], "contact");
    // The old body still answers questions after a file is rejected, because of its text or its shape.
    for (name, file) in [("a.off", b"OFF\n1 0 0\n0 0".to_vec()), ("plate.off", data("plate.off"))] {
        let (refused, _) = ask(&mut state, &load(name), file);
        assert!(refused["error"].is_string() && refused["gone"] == false, "{refused}");
        let (after, _) = ask(&mut state, &pair("cast", [-0.3, 0.1, -1.0]), Vec::new());
        assert_eq!(after, before);
    }
    let (answer, _) = ask(&mut state, &again, Vec::new());
    assert_eq!(answer["body"]["kind"], "solid");
    let (answer, _) = ask(&mut state, &load("dodecahedron.off"), data("dodecahedron.off"));
    assert_eq!(answer["body"]["kind"], "convex");
    let (answer, _) = ask(&mut state, &pair("cast", [0.0, 0.0, 0.0]), Vec::new());
    assert!(answer["error"].as_str().unwrap().contains("direction"), "{answer}");
}

#[test]
fn modified_proof_is_rejected() {
    let mut state = loaded("dodecahedron.off", "bracket.obj", "convex");
    let (answer, _) = ask(&mut state, &pair("cast", [-0.3, 0.1, -1.0]), Vec::new());
    let mut question = pair("verify", [-0.3, 0.1, -1.0]);
    question["proof"] = answer["proof"].clone();
    let (checked, _) = ask(&mut state, &question, Vec::new());
    assert_eq!(checked["holds"], true, "{checked}");
    let lower = &mut question["proof"]["contact"]["lower"];
    *lower = json!(lower.as_f64().unwrap() + 1e-6);
    let (checked, _) = ask(&mut state, &question, Vec::new());
    assert_eq!(checked["holds"], false, "{checked}");
}

/// A proof is read as the page hands it back. It does not hold after a change of any of its parts.
#[test]
fn modified_solid_proofs_are_rejected() {
    let solids = |moving: &str, fixed: &str| loaded(moving, fixed, "solid");
    let cases = [
        (solids("bolt.stl", "plate.off"), [0.3, 0.2, 7.0], [0.0, 0.0, -1.0], "stop"),
        (solids("bolt.stl", "plate.off"), [0.3, 0.2, 7.0], [0.0, 0.0, 1.0], "free"),
        (solids("dodecahedron.off", "plate.off"), [0.0, 0.0, 0.0], [0.0, 0.0, 1.0], "overlap"),
    ];
    for (mut state, [x, y, z], direction, kind) in cases {
        let mut question = pair("certify", direction);
        question["moving_pose"] = json!([x, y, z, 0.0, 0.0, 0.0, 1.0]);
        let (told, _) = ask(&mut state, &question, Vec::new());
        let told = &told["proof"]["clearance"];
        assert_eq!(told["stop"].is_object(), kind == "stop", "{told}");
        assert_eq!(told["start"]["facets"].is_array(), kind == "overlap", "{told}");
        let mut check = |proof: &Value| {
            question["do"] = json!("verify");
            question["proof"] = json!({ "clearance": proof });
            ask(&mut state, &question, Vec::new()).0
        };
        assert_eq!(check(told)["holds"], true, "{told}");
        let mut lie = told.clone();
        lie["tolerance"] = json!(lie["tolerance"].as_f64().unwrap() + 1.0);
        assert_eq!(check(&lie)["holds"], false);
        if kind == "stop" {
            let mut lie = told.clone();
            lie["lower"] = json!(lie["lower"].as_f64().unwrap() + 0.1);
            assert_eq!(check(&lie)["holds"], false);
            lie = told.clone();
            lie["stop"] = Value::Null;
            assert_eq!(check(&lie)["holds"], false);
            let mut lie = told.clone();
            let cover = lie["cover"].as_str().unwrap();
            lie["cover"] = json!(cover[..cover.len() - 1]);
            assert_eq!(check(&lie)["holds"], false);
        }
        let mut lie = told.clone();
        lie["cover"] = json!("?");
        assert!(check(&lie)["error"].is_string());
        assert!(check(&json!({}))["error"].is_string());
    }
}

/// A dense body has only its sharp edges drawn, another body all edges.
#[test]
fn dense_bodies_draw_only_sharp_edges() {
    for (sides, drawn) in [(100, 300), (4000, 8000)] {
        let mut file = format!("OFF\n{} {} 0\n", 2 * sides, sides + 2);
        for z in [-1.0, 1.0] {
            for k in 0..sides {
                let (sin, cos) =
                    (std::f64::consts::TAU * f64::from(k) / f64::from(sides)).sin_cos();
                writeln!(file, "{cos} {sin} {z}").unwrap();
            }
        }
        for k in 0..sides {
            let next = (k + 1) % sides;
            writeln!(file, "4 {k} {next} {} {}", sides + next, sides + k).unwrap();
        }
        let list = |corners: Vec<i32>| {
            corners.iter().map(ToString::to_string).collect::<Vec<_>>().join(" ")
        };
        writeln!(file, "{sides} {}", list((0..sides).rev().collect())).unwrap();
        writeln!(file, "{sides} {}", list((sides..2 * sides).collect())).unwrap();
        let load = json!({ "do": "load", "slot": "moving", "name": "drum.off", "take": "convex" });
        let (answer, _) = ask(&mut State::default(), &load, file.into());
        assert_eq!(
            (&answer["body"]["edges"], &answer["edges"]),
            (&json!(3 * sides), &json!(drawn))
        );
    }
}

/// The page offers files of exactly the formats that the library reads.
#[test]
fn page_lists_all_library_formats() {
    let list = format!("{}/../../web/src/formats.ts", env!("CARGO_MANIFEST_DIR"));
    let expected = Format::ALL.iter().map(|format| format!("{:?}", format.extension()));
    let expected = expected.collect::<Vec<_>>().join(", ");
    assert!(
        std::fs::read_to_string(list).unwrap().contains(&format!("EXTENSIONS = [{expected}];"))
    );
}
