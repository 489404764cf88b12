//! Answers to the page's questions about the small gearbox, compared with the library.

use std::path::PathBuf;

use colltrans_assembly::audit::{AuditOptions, audit, audit_json};
use colltrans_assembly::map::{MapOptions, RemovalMap};
use colltrans_assembly::{Assembly, Bodies, Fit, Part, Piece, Watch};
use colltrans_wasm::assembly::State;
use colltrans_wasm::{Answer, Answers as _};
use glam::DAffine3;
use serde_json::{Value, json};

fn ask(state: &mut State, question: &Value, file: Vec<u8>) -> (Value, Vec<u8>) {
    let Answer { text, numbers } = state.ask(question.to_string().as_bytes(), file);
    (serde_json::from_slice(&text).unwrap(), numbers)
}

fn files() -> Vec<PathBuf> {
    let folder = format!("{}/../../data/gearbox_small", env!("CARGO_MANIFEST_DIR"));
    let mut files: Vec<PathBuf> =
        std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.retain(|file| file.extension().is_some_and(|e| e == "off"));
    files.sort();
    files
}

fn stem(file: &std::path::Path) -> String {
    file.file_stem().unwrap().to_string_lossy().into_owned()
}

fn gearbox() -> State {
    let mut state = State::default();
    for file in files() {
        let name = file.file_name().unwrap().to_string_lossy();
        let question = json!({ "do": "add", "name": name });
        let (answer, _) = ask(&mut state, &question, std::fs::read(&file).unwrap());
        assert!(answer["parts"].is_u64(), "{answer}");
    }
    state
}

#[test]
fn plan_moves_every_part_of_the_gearbox() {
    let mut state = gearbox();
    let (parts, numbers) = ask(&mut state, &json!({ "do": "parts" }), Vec::new());
    let all = parts["parts"].as_array().unwrap();
    assert_eq!(all.len(), files().len());
    let count = |key: &str| all.iter().map(|p| p[key].as_u64().unwrap()).sum::<u64>();
    assert_eq!(numbers.len() as u64, 12 * (count("vertices") + count("triangles")));
    let (fit, _) = ask(&mut state, &json!({ "do": "fit", "tolerance": 0.1 }), Vec::new());
    assert_eq!(fit["tolerance"], 0.1);
    assert!(!fit["liaisons"].as_array().unwrap().is_empty());
    let (plan, _) = ask(&mut state, &json!({ "do": "plan" }), Vec::new());
    let names: Vec<&str> = all.iter().map(|part| part["name"].as_str().unwrap()).collect();
    let mut moved: Vec<&str> = Vec::new();
    for step in plan["plan"].as_array().unwrap().iter().filter(|s| s["within"].is_null()) {
        moved.extend(step["parts"].as_array().unwrap().iter().map(|p| p.as_str().unwrap()));
    }
    // Every part except those that remain.
    moved.extend(plan["last"].as_array().unwrap().iter().map(|p| p.as_str().unwrap()));
    moved.sort_unstable();
    assert_eq!(moved, names, "{plan}");
    let (_, page) = ask(&mut state, &json!({ "do": "report", "title": "Gears" }), Vec::new());
    let page = String::from_utf8(page).unwrap();
    let sheets = plan["stages"].as_array().unwrap().len();
    assert_eq!(page.matches("class=\"sheet step\"").count(), sheets);
    assert!(page.contains("<h1>Gears</h1>"));
    let (along, _) = ask(&mut state, &json!({ "do": "along", "direction": [0, 0, 2] }), Vec::new());
    // A part is free along the direction exactly if it can be removed alone.
    for (k, room) in along["rooms"].as_array().unwrap().iter().enumerate() {
        let alone = along["removable"].as_array().unwrap().contains(&json!([names[k]]));
        assert_eq!(room["part"], names[k]);
        assert_eq!(room["outcome"] == "free", alone, "{k} {room}");
        assert_eq!(room["outcome"] == "free", along["closures"][k] == json!([names[k]]));
    }
}

#[test]
fn map_equals_library_map() {
    let mut state = gearbox();
    ask(&mut state, &json!({ "do": "parts" }), Vec::new());
    ask(&mut state, &json!({ "do": "fit", "tolerance": 0.1 }), Vec::new());
    let bolt = files().iter().position(|file| stem(file) == "bolt_0").unwrap();
    let (told, numbers) = ask(&mut state, &json!({ "do": "map", "group": [bolt] }), Vec::new());
    let numbers: Vec<f32> =
        numbers.chunks_exact(4).map(|b| f32::from_le_bytes(b.try_into().unwrap())).collect();
    let parts = files().into_iter().map(|file| {
        let mesh = colltrans_mesh::read(&file).unwrap();
        let piece = Piece { mesh, world_from_piece: DAffine3::IDENTITY };
        Part::new(stem(&file), &[piece]).unwrap()
    });
    let assembly = Assembly::new(parts.collect()).unwrap();
    let bodies = Bodies::new(&assembly, Fit::Tolerance(0.1)).unwrap();
    let options = MapOptions::default().with_samples(642).with_border(0.04);
    let map = RemovalMap::new(&bodies, &[bolt], &[], options, Watch::default()).unwrap();
    let count = told["directions"].as_u64().unwrap() as usize;
    assert!(count >= 642);
    for k in 0..642 {
        let d: Vec<f32> = map.sphere.directions[k].as_vec3().to_array().to_vec();
        assert_eq!(numbers[3 * k..3 * k + 3], d);
        assert_eq!(numbers[3 * count + k], map.travels[k].safe_distance() as f32);
    }
    let ways = ["regions", "isolated"].map(|key| told[key].as_array().unwrap().len());
    assert!(told["free_share"].as_f64().unwrap() < 0.5 && ways[0] + ways[1] > 0, "{ways:?}");
}

#[test]
fn audit_equals_library_audit_and_has_a_report() {
    let mut state = gearbox();
    ask(&mut state, &json!({ "do": "parts" }), Vec::new());
    // The precision of the files: press fits and rolling contacts overlap as drawn.
    ask(&mut state, &json!({ "do": "fit" }), Vec::new());
    let (told, _) = ask(&mut state, &json!({ "do": "audit", "within": 0.5 }), Vec::new());
    let parts = files().into_iter().map(|file| {
        let mesh = colltrans_mesh::read(&file).unwrap();
        let piece = Piece { mesh, world_from_piece: DAffine3::IDENTITY };
        Part::new(stem(&file), &[piece]).unwrap()
    });
    let assembly = Assembly::new(parts.collect()).unwrap();
    let bodies = Bodies::new(&assembly, Fit::default_for(&assembly)).unwrap();
    let options = AuditOptions::default().with_within(0.5).unwrap();
    let found = audit(&bodies, &options, Watch::default()).unwrap();
    let record = serde_json::to_value(audit_json(&bodies, &options, &found)).unwrap();
    assert_eq!(told["audit"], record);
    assert!(found.pairs.len() > 20, "{:?}", found.counts);
    let views = told["views"].as_array().unwrap();
    assert_eq!(views.len(), found.pairs.len());
    for (view, pair) in views.iter().zip(&found.pairs) {
        assert_eq!(view["parts"], json!(pair.parts));
        assert_eq!(view["parts_by_moving"], pair.finding.interference().is_some());
        assert!(view["radius"].as_f64().unwrap() > 0.0);
    }
    let (_, page) = ask(&mut state, &json!({ "do": "clashes", "title": "Gears" }), Vec::new());
    let page = String::from_utf8(page).unwrap();
    assert_eq!(page.matches("<details class=\"clash\"").count(), found.pairs.len());
    assert!(page.contains("<h1>Gears</h1>"));
}

#[test]
fn invalid_questions_return_errors() {
    let mut state = State::default();
    let mut refused = |question: Value, file: &[u8], part: &str| {
        let (answer, _) = ask(&mut state, &question, file.to_vec());
        let error = answer["error"].as_str().unwrap().to_owned();
        assert!(error.contains(part), "{error}");
    };
    refused(json!([1]), b"", "not an object");
    refused(json!({ "do": "dance" }), b"", "dance");
    refused(json!({ "do": "parts" }), b"", "no parts");
    refused(json!({ "do": "fit" }), b"", "no parts");
    refused(json!({ "do": "along", "direction": [0, 0, 1] }), b"", "no fit");
    refused(json!({ "do": "add", "name": "a.txt" }), b"x", "a.txt");
    refused(json!({ "do": "add", "name": "a.glb" }), b"glTF", "a.glb: glTF: ");
    refused(json!({ "do": "add", "name": "a.off" }), b"OFF\n1 0 0\n0 0", "a.off");
    let mut state = gearbox();
    ask(&mut state, &json!({ "do": "parts" }), Vec::new());
    ask(&mut state, &json!({ "do": "fit" }), Vec::new());
    let mut refused = |question: Value, part: &str| {
        let (answer, _) = ask(&mut state, &question, Vec::new());
        let error = answer["error"].as_str().unwrap().to_owned();
        assert!(error.contains(part), "{error}");
    };
    refused(json!({ "do": "along", "direction": [0, 0, 0] }), "direction");
    refused(json!({ "do": "map", "group": [99] }), "99");
    refused(json!({ "do": "clashes", "title": "" }), "no audit");
    refused(json!({ "do": "audit", "within": -1 }), "clearance");
    refused(json!({ "do": "fit", "tolerance": -1 }), "invalid tolerance");
}

/// A GLB file adds several parts and sets the unit.
#[test]
fn glb_file_adds_parts_and_unit() {
    let positions: [f32; 12] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
    let corners: [u16; 12] = [0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2];
    let mut binary: Vec<u8> = positions.iter().flat_map(|x| x.to_le_bytes()).collect();
    binary.extend(corners.iter().flat_map(|x| x.to_le_bytes()));
    let json = json!({
        "asset": { "version": "2.0" },
        "scenes": [{ "nodes": [0, 1] }],
        "nodes": [{ "mesh": 0, "name": "left" }, { "mesh": 0, "name": "right", "translation": [3, 0, 0] }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1 }] }],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3",
              "min": [0, 0, 0], "max": [1, 1, 1] },
            { "bufferView": 1, "componentType": 5123, "count": 12, "type": "SCALAR" }
        ],
        "bufferViews": [
            { "buffer": 0, "byteOffset": 0, "byteLength": 48 },
            { "buffer": 0, "byteOffset": 48, "byteLength": 24 }
        ],
        "buffers": [{ "byteLength": 72 }]
    });
    let mut text = json.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut glb = b"glTF".to_vec();
    let whole = 12 + 8 + text.len() + 8 + binary.len();
    for x in [2, whole as u32, text.len() as u32, 0x4E4F_534A] {
        glb.extend(x.to_le_bytes());
    }
    glb.extend(&text);
    for x in [binary.len() as u32, 0x004E_4942] {
        glb.extend(x.to_le_bytes());
    }
    glb.extend(&binary);
    let mut state = State::default();
    let (added, _) = ask(&mut state, &json!({ "do": "add", "name": "two.glb" }), glb);
    assert_eq!(added["parts"], 2, "{added}");
    let (parts, _) = ask(&mut state, &json!({ "do": "parts" }), Vec::new());
    assert_eq!(parts["unit"], "m");
    ask(&mut state, &json!({ "do": "fit" }), Vec::new());
    let (along, _) = ask(&mut state, &json!({ "do": "along", "direction": [1, 0, 0] }), Vec::new());
    assert_eq!(along["rooms"][0]["outcome"], "blocked");
    assert_eq!(along["rooms"][1]["outcome"], "free");
}
