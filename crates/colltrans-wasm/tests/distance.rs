//! Questions about distances, and invalid questions.

use colltrans_wasm::Answers as _;
use colltrans_wasm::distance::State;
use serde_json::{Value, json};

const CUBE: &str = "OFF\n8 6 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n1 0 1\n1 1 1\n0 1 1\n\
    4 3 2 1 0\n4 4 5 6 7\n4 0 1 5 4\n4 1 2 6 5\n4 2 3 7 6\n4 3 0 4 7\n";

fn ask(state: &mut State, question: &Value, file: &str) -> Value {
    let answer = state.ask(question.to_string().as_bytes(), file.as_bytes().to_vec());
    serde_json::from_slice(&answer.text).expect("JSON")
}

fn loaded(takes: [&str; 2]) -> State {
    let mut state = State::default();
    for (slot, take) in ["moving", "fixed"].into_iter().zip(takes) {
        let load = json!({ "do": "place", "slot": slot, "name": "cube.off", "take": take });
        assert_eq!(ask(&mut state, &load, CUBE), json!({ "placed": true }));
    }
    state
}

fn distance(state: &mut State, x: f64) -> Value {
    let pose = |x: f64| json!([x, 0.25, 0.125, 0, 0, 0, 1]);
    ask(state, &json!({ "do": "distance", "moving_pose": pose(x), "fixed_pose": pose(0.0) }), "")
}

#[test]
fn all_kinds_of_bodies_have_distance_and_depth() {
    for takes in [["convex", "hull"], ["solid", "open"], ["convex", "solid"]] {
        let mut state = loaded(takes);
        let apart = distance(&mut state, 3.0);
        let [lower, upper] = ["lower", "upper"].map(|name| apart["distance"][name].as_f64());
        assert!(lower.is_some_and(|x| x <= 2.0) && upper.is_some_and(|x| x >= 2.0), "{apart}");
        assert_eq!((&apart["distance"]["outcome"], apart.get("depth")), (&json!("apart"), None));
        let deep = distance(&mut state, 0.75);
        assert_eq!(deep["distance"]["outcome"], "meeting");
        let depth = &deep["depth"];
        assert_eq!(depth["outcome"], "overlapping");
        if takes == ["convex", "hull"] {
            assert_eq!(depth["direction"], json!([1.0, 0.0, 0.0]));
            assert!((depth["upper"].as_f64().expect("a number") - 0.25).abs() < 1e-12);
        }
    }
}

#[test]
fn invalid_questions_return_errors() {
    let mut state = State::default();
    let error = |told: Value| told["error"].as_str().expect("an error").to_owned();
    assert_eq!(error(distance(&mut state, 0.0)), "two bodies are needed");
    let load = json!({ "do": "place", "slot": "moving", "name": "cube.off", "take": "convex" });
    assert!(error(ask(&mut state, &load, "OFF\n1 0")).starts_with("cube.off: "));
    let other = json!({ "do": "place", "slot": "third", "name": "cube.off", "take": "convex" });
    assert!(error(ask(&mut state, &other, CUBE)).contains("third"));
    assert!(error(ask(&mut state, &json!({ "do": "dance" }), "")).contains("dance"));
    assert!(error(ask(&mut state, &json!(17), "")).starts_with("the question cannot be read"));
    let glued = json!({ "do": "place", "slot": "moving", "name": "cube.off", "take": "glued" });
    assert!(error(ask(&mut state, &glued, CUBE)).contains("glued"));
    let mut state = loaded(["convex", "convex"]);
    let nan = json!({ "do": "distance", "moving_pose": [0, 0, 0, 0, 0, 0, 0],
        "fixed_pose": [0, 0, 0, 0, 0, 0, 1] });
    assert!(error(ask(&mut state, &nan, "")).starts_with("pose of the moving body"));
}
