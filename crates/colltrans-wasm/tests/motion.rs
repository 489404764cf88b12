//! Questions about motions, and invalid questions.

use colltrans_wasm::Answers as _;
use colltrans_wasm::motion::State;
use serde_json::{Value, json};

const CUBE: &str = "OFF\n8 6 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n1 0 1\n1 1 1\n0 1 1\n\
    4 3 2 1 0\n4 4 5 6 7\n4 0 1 5 4\n4 1 2 6 5\n4 2 3 7 6\n4 3 0 4 7\n";
const KINDS: [[&str; 2]; 3] = [["convex", "hull"], ["solid", "open"], ["convex", "solid"]];

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

/// The moving cube turns about the z axis, which contains its edge `x = y = 0`.
fn asked(question: &str, motion: &Value, x: f64, y: f64) -> Value {
    json!({ "do": question, "moving_motion": motion, "moving_pose": [0, 0, 0, 0, 0, 0, 1],
        "fixed_pose": [x, y, 0.25, 0, 0, 0, 1] })
}

fn turn(angle: f64) -> Value {
    json!({ "turn": { "point": [0, 0, 0], "axis": [0, 0, 1], "angle": angle } })
}

#[test]
fn all_kinds_of_bodies_turn_until_contact() {
    // The corner (1, 0) never reaches the plane y = 1.2. The corner (1, 1) reaches it when its angle of 45
    // degrees has become asin(1.2 / sqrt 2), at x = 0.748.
    let half = std::f64::consts::FRAC_PI_2;
    let met = ((1.2 / 2.0_f64.sqrt()).asin() - half / 2.0) / half;
    for takes in KINDS {
        let mut state = loaded(takes);
        let told = ask(&mut state, &asked("motion", &turn(half), 0.0, 1.2), "");
        let record = &told["record"];
        assert_eq!(record["outcome"], "contact", "{told}");
        let [lower, upper] = ["lower", "upper"].map(|name| record["time"][name].as_f64());
        let (lower, upper) = (lower.expect("a bound"), upper.expect("a bound"));
        assert!(lower <= met + 1e-6 && met - 1e-6 <= upper && upper - lower < 1e-9, "{told}");
        assert_eq!(told["kind"], if takes == KINDS[0] { "convex" } else { "solid" });
        assert!((record["point"][1].as_f64().expect("a point") - 1.2).abs() < 1e-6, "{told}");
        // The pose is that of the motion at the lower bound.
        let angle = lower * half / 2.0;
        assert!((told["pose"][5].as_f64().expect("z") - angle.sin()).abs() < 1e-12, "{told}");
        assert!(told["lit"]["moving"]["vertices"].as_array().is_some_and(|all| !all.is_empty()));
        let proven = ask(&mut state, &asked("prove", &turn(half), 0.0, 1.2), "");
        assert_eq!(proven["holds"], true, "{proven}");
        assert_eq!(proven["proven"], json!([lower, upper]), "{proven}");
    }
}

#[test]
fn motions_are_free_overlapping_or_grazing() {
    for takes in KINDS {
        let mut state = loaded(takes);
        let free = ask(&mut state, &asked("motion", &turn(9.0), 1.5, 0.0), "");
        assert_eq!((&free["record"]["outcome"], free.get("pose")), (&json!("free"), None));
        let proven = ask(&mut state, &asked("prove", &turn(9.0), 1.5, 0.0), "");
        assert_eq!(proven["proven"], json!([1.0, null]), "{proven}");
        assert!(proven["entries"].as_u64().is_some_and(|entries| entries > 0));
        let deep = ask(&mut state, &asked("motion", &turn(1.0), 0.5, 0.5), "");
        assert_eq!(deep["record"]["outcome"], "overlapping");
    }
    // The convex bodies touch face on face at the start, which rounding cannot decide.
    let told = ask(&mut loaded(KINDS[0]), &asked("motion", &turn(-1.0), 0.0, 1.0), "");
    assert_eq!(told["record"]["outcome"], "grazing", "{told}");
    assert!(told["record"]["time"].get("upper").is_none());
}

#[test]
fn screws_respect_rise_and_minimum_gap() {
    let mut state = loaded(KINDS[0]);
    let rise = |rise: f64| json!({ "screw": { "point": [0, 0, 0], "axis": [0, 0, 2], "angle": 7.0, "rise": rise } });
    // The corner (1, 1) passes the other body at a distance of 0.0858, slightly above its start, or far above
    // it.
    let outcome = |told: Value| told["record"]["outcome"].as_str().map(str::to_owned);
    let mut question = asked("motion", &rise(0.5), 1.5, 0.0);
    assert_eq!(outcome(ask(&mut state, &question, "")).as_deref(), Some("free"));
    question["min_gap"] = json!(0.2);
    assert_eq!(outcome(ask(&mut state, &question, "")).as_deref(), Some("contact"));
    question["moving_motion"] = rise(50.0);
    assert_eq!(outcome(ask(&mut state, &question, "")).as_deref(), Some("free"));
    question["tolerance"] = json!(0.1);
    let error = ask(&mut state, &question, "");
    assert_eq!(
        error["error"],
        "a gap and a tolerance are both given; convex bodies accept only one of them"
    );
}

#[test]
fn moving_either_body_gives_equal_times() {
    for takes in KINDS {
        let mut state = loaded(takes);
        // A slide is a screw without rotation: it starts 3 below and comes within 0.25 of the other body.
        let up = json!({ "screw": { "point": [0, 0, 0], "axis": [0, 0, 1], "angle": 0.0, "rise": 4.0 } });
        let mut question = asked("motion", &up, 0.0, 0.0);
        question["moving_pose"] = json!([0.5, 0.5, -3, 0, 0, 0, 1]);
        let time = |told: &Value| told["record"]["time"]["lower"].as_f64().expect("a contact");
        let slid = ask(&mut state, &question, "");
        assert!((time(&slid) - 2.25 / 4.0).abs() < 1e-5, "{slid}");
        // The other body moves down by the same distance.
        let down = json!({ "screw": { "point": [0, 0, 0], "axis": [0, 0, -1], "angle": 0.0, "rise": 4.0 } });
        question["moving_motion"] = Value::Null;
        question["fixed_motion"] = down.clone();
        let other = ask(&mut state, &question, "");
        assert!((time(&other) - time(&slid)).abs() < 1e-9, "{other}");
        let rests = other["pose"].as_array().expect("a pose").iter().map(Value::as_f64);
        let rests: Vec<f64> = rests.map(|x| x.expect("a number")).collect();
        assert_eq!(rests, [0.5, 0.5, -3.0, 0.0, 0.0, 0.0, 1.0]);
        // Both bodies meet in the middle.
        question["moving_motion"] = up;
        let both = ask(&mut state, &question, "");
        assert!((2.0 * time(&both) - time(&slid)).abs() < 1e-5, "{both}");
        question["do"] = json!("prove");
        assert_eq!(ask(&mut state, &question, "")["holds"], true);
    }
}

#[test]
fn invalid_questions_return_errors() {
    let mut state = State::default();
    let error = |told: Value| told["error"].as_str().expect("an error").to_owned();
    let question = asked("motion", &turn(1.0), 3.0, 0.0);
    assert_eq!(error(ask(&mut state, &question, "")), "two bodies are needed");
    let mut state = loaded(KINDS[0]);
    let with = |motion: Value| asked("motion", &motion, 3.0, 0.0);
    assert!(error(ask(&mut state, &with(json!({ "hop": {} })), "")).contains("hop"));
    let axis = json!({ "turn": { "point": [0, 0, 0], "axis": [0, 0, 0], "angle": 1 } });
    assert!(error(ask(&mut state, &with(axis), "")).contains("axis"));
    assert!(error(ask(&mut state, &with(turn(1e9)), "")).contains("1e5"));
    assert!(error(ask(&mut state, &json!({ "do": "dance" }), "")).contains("dance"));
    let nan = json!({ "do": "motion", "moving_motion": turn(1.0), "moving_pose": [0, 0, 0, 0, 0, 0, 0],
        "fixed_pose": [0, 0, 0, 0, 0, 0, 1] });
    assert!(error(ask(&mut state, &nan, "")).starts_with("pose of the moving body"));
}
