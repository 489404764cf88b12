//! Recordings of searches, compared with the library, and the grid of `phi`, compared with the minimisation.

use colltrans_wasm::found::State;
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

fn loaded(moving: &str, fixed: &str) -> State {
    let mut state = State::default();
    for (slot, name) in [("moving", moving), ("fixed", fixed)] {
        let question = json!({ "do": "place", "slot": slot, "name": name, "take": "convex" });
        let (answer, _) = ask(&mut state, &question, data(name));
        assert_eq!(answer, json!({ "placed": true }));
    }
    state
}

fn pair(what: &str, direction: [f64; 3]) -> Value {
    json!({ "do": what, "moving_pose": TILTED, "fixed_pose": HOME, "direction": direction })
}

/// The value of the minimisation at a pair of levels is the collision translation of the two sections, cut
/// out and cast as bodies of their own.
#[test]
fn section_casts_equal_minimisation_values() {
    let settings = [
        ("dodecahedron.off", "bracket.obj", [-0.3, 0.1, -1.0]),
        ("ellipsoid_a.obj", "ellipsoid_b.off", [-0.6, -0.1, -0.9]),
    ];
    for (moving, fixed, direction) in settings {
        let mut state = loaded(moving, fixed);
        let length = direction.iter().map(|x: &f64| x * x).sum::<f64>().sqrt();
        let mut question = pair("search", direction);
        question["solver"] = json!("cta");
        let (answer, _) = ask(&mut state, &question, Vec::new());
        let events = answer["events"].as_array().unwrap();
        let sections = events.iter().find(|e| e.get("sections").is_some()).unwrap();
        let mut problems = 0;
        for problem in events.iter().filter(|e| e["touch"] == "edges" || e["touch"] == "vertex") {
            let mut grid = pair("levels", direction);
            grid["moving_axis"] = sections["sections"][0].clone();
            grid["fixed_axis"] = sections["sections"][1].clone();
            grid["moving_levels"] = json!([problem["planar"][0]]);
            grid["fixed_levels"] = json!([problem["planar"][1]]);
            let (_, numbers) = ask(&mut state, &grid, Vec::new());
            let value = problem["value"].as_f64().unwrap();
            let phi = numbers[0] * length;
            assert!((phi - value).abs() < 1e-12 * (1.0 + value.abs()), "{phi} {value}");
            problems += 1;
        }
        assert!(problems > 1, "{problems}");
    }
}

#[test]
fn search_after_a_query_starts_from_features() {
    let mut state = loaded("dodecahedron.off", "bracket.obj");
    let mut question = pair("search", [-0.3, 0.1, -1.0]);
    question["after"] = pair("cast", [-0.3, 0.101, -1.0]);
    let (answer, _) = ask(&mut state, &question, Vec::new());
    assert_eq!(answer["tracked"]["started_from"], "features");
}

/// The square is centred at the last solution, and fewer planar problems are solved in it.
#[test]
fn neighbourhood_search_solves_fewer_planar_problems() {
    let mut state = loaded("ellipsoid_a.obj", "ellipsoid_b.off");
    let direction = [-0.6, -0.1, -0.9];
    let mut question = pair("search", direction);
    question["solver"] = json!("cta");
    question["after"] = pair("cast", [-0.6, -0.101, -0.9]);
    let (answer, _) = ask(&mut state, &question, Vec::new());
    let region = &answer["region"];
    let problems = |steps: &Value| steps["planar_problems"].as_u64().unwrap();
    let (scratch, near) = (problems(&answer["steps"]), problems(&region["steps"]));
    assert!(near >= 1 && near < scratch, "{near} {scratch}");
    let first = region["events"].as_array().unwrap().iter().find(|e| e.get("planar").is_some());
    let first = &first.unwrap()["planar"];
    for k in 0..2 {
        let apart = first[k].as_f64().unwrap() - region["center"][k].as_f64().unwrap();
        assert!(apart.abs() < 1e-9, "{region}");
    }
    let delta = region["delta"].as_f64().unwrap();
    assert!(delta > 0.0 && delta < 0.05, "{delta}");
    let times = region["half"].as_f64().unwrap() / delta;
    assert!((times - 3.0_f64.sqrt()).abs() < 1e-9, "{times}");
}

/// In a reported cell, including its corners, `phi` follows the gradient; the shift goes to its minimum.
#[test]
fn phi_is_linear_in_reported_cells() {
    let direction = [-0.6, -0.1, -0.9];
    let length = direction.iter().map(|x: &f64| x * x).sum::<f64>().sqrt();
    let mut state = loaded("ellipsoid_a.obj", "ellipsoid_b.off");
    let mut question = pair("search", direction);
    question["solver"] = json!("cta");
    let (answer, _) = ask(&mut state, &question, Vec::new());
    let events = answer["events"].as_array().unwrap();
    let sections = events.iter().find(|e| e.get("sections").is_some()).unwrap();
    let number = |value: &Value| value.as_f64().unwrap();
    let mut corners = 0;
    for two in events.windows(2) {
        let [problem, told] = two else { continue };
        let Some(cell) = told.get("cell") else { continue };
        let mut check = |at: [&Value; 2]| {
            let mut grid = pair("levels", direction);
            grid["moving_axis"] = sections["sections"][0].clone();
            grid["fixed_axis"] = sections["sections"][1].clone();
            // Sections may only just touch at a corner itself.
            let near = |k: usize| {
                let from = number(&problem["planar"][k]);
                from + (number(at[k]) - from) * (1.0 - 1e-6)
            };
            (grid["moving_levels"], grid["fixed_levels"]) = (json!([near(0)]), json!([near(1)]));
            let (_, numbers) = ask(&mut state, &grid, Vec::new());
            let rise = |k: usize| {
                number(&problem["gradient"][k]) * (near(k) - number(&problem["planar"][k]))
            };
            let linear = number(&problem["value"]) + rise(0) + rise(1);
            assert!((numbers[0] * length - linear).abs() < 1e-9, "{} {linear}", numbers[0]);
            corners += 1;
            linear
        };
        let mut least = f64::INFINITY;
        for corner in cell.as_array().unwrap() {
            least = least.min(check([&corner[0], &corner[1]]));
        }
        let best = check([&problem["best"][0], &problem["best"][1]]);
        let shifted = number(&problem["shifted"]);
        assert!((least - shifted).abs() < 1e-4 && (best - shifted).abs() < 1e-4, "{problem}");
    }
    assert!(corners > 8, "{corners}");
}

#[test]
fn invalid_questions_return_errors() {
    let mut state = State::default();
    let error = |told: Value| told["error"].as_str().expect("an error").to_owned();
    let search = pair("search", [0.0, 0.0, -1.0]);
    assert_eq!(error(ask(&mut state, &search, Vec::new()).0), "two bodies are needed");
    let mut place =
        json!({ "do": "place", "slot": "moving", "name": "plate.off", "take": "solid" });
    assert!(error(ask(&mut state, &place, data("plate.off")).0).contains("no sections"));
    place["take"] = json!("convex");
    assert!(!error(ask(&mut state, &place, data("plate.off")).0).is_empty());
    assert!(error(ask(&mut state, &json!({ "do": "dance" }), Vec::new()).0).contains("dance"));
    let mut state = loaded("dodecahedron.off", "bracket.obj");
    let mut many = pair("levels", [0.0, 0.0, -1.0]);
    (many["moving_axis"], many["fixed_axis"]) = (json!([0, 0, 1]), json!([0, 0, 1]));
    let levels = vec![0.0; 200];
    (many["moving_levels"], many["fixed_levels"]) = (json!(levels), json!(levels));
    assert!(error(ask(&mut state, &many, Vec::new()).0).contains("16384"));
}
