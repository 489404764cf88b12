//! Drawings of small scenes, and invalid questions.

use colltrans_wasm::picture::State;
use colltrans_wasm::{Answer, Answers as _};
use serde_json::{Value, json};

/// Corners, style, number.
type Triangle = ([[f64; 3]; 3], u32, u32);
/// Ends, style, numbers of adjacent triangles.
type Segment<'a> = ([[f64; 3]; 2], u32, &'a [u32]);

fn file(triangles: &[Triangle], segments: &[Segment]) -> Vec<u8> {
    let corners = triangles.iter().flat_map(|(corners, ..)| corners.as_flattened());
    let ends = segments.iter().flat_map(|(ends, ..)| ends.as_flattened());
    let mut file: Vec<u8> = corners.chain(ends).flat_map(|x| x.to_le_bytes()).collect();
    let mut add = |x: u32| file.extend(x.to_le_bytes());
    triangles.iter().flat_map(|&(_, style, number)| [style, number]).for_each(&mut add);
    segments.iter().flat_map(|&(_, style, beside)| [style, beside.len() as u32]).for_each(&mut add);
    segments.iter().flat_map(|(_, _, beside)| beside.iter().copied()).for_each(&mut add);
    file
}

fn question(triangles: usize, segments: usize) -> Value {
    json!({
        "do": "draw", "size": [60, 40], "slack": 1e-6, "ground": "white", "text": "black",
        "triangles": triangles, "segments": segments,
        "areas": [
            { "fill": "red", "opacity": 1, "above": false },
            { "fill": "lime", "opacity": 0.5, "above": false },
            { "fill": "blue", "opacity": 1, "above": true },
        ],
        "lines": [
            { "colour": "gray", "opacity": 1, "below": true },
            { "colour": "navy", "opacity": 0.5, "dash": 2.345, "below": false },
            { "colour": "teal", "opacity": 1, "below": false },
        ],
        "words": [{ "at": [10, 20], "text": "a < b" }],
    })
}

fn ask(question: &Value, file: Vec<u8>) -> Result<String, String> {
    let Answer { text, numbers } = State.ask(question.to_string().as_bytes(), file);
    let told: Value = serde_json::from_slice(&text).unwrap();
    match told["error"].as_str() {
        Some(error) => Err(error.to_owned()),
        None => Ok(String::from_utf8(numbers).unwrap()),
    }
}

const fn over(q: f64) -> [[f64; 3]; 3] {
    [[20.0, -10.0, q], [40.0, -10.0, q], [40.0, 60.0, q]]
}

const fn across(q: f64) -> [[f64; 3]; 2] {
    [[0.0, 10.0, q], [60.0, 10.0, q]]
}

/// The drawing order: lines on the ground, areas by depth, lines, areas above, words.
#[test]
fn layers_are_drawn_in_order() {
    let triangles = [(over(0.5), 2, 0), (over(2.0), 1, 1), (over(1.0), 0, 2)];
    let segments: [Segment; 3] =
        [(across(3.0), 2, &[]), (across(0.1), 0, &[]), (across(3.0), 1, &[])];
    let svg = ask(&question(3, 3), file(&triangles, &segments)).unwrap();
    let places: Vec<usize> = [
        r#"<rect width="100%" height="100%" fill="white"/>"#,
        r#"stroke="gray" stroke-opacity="1" stroke-linecap="round""#,
        r#"fill="red" stroke="red" stroke-width="0.7""#,
        r#"fill="lime" fill-opacity="0.5""#,
        r#"stroke="teal""#,
        r#"stroke="navy" stroke-opacity="0.5" stroke-linecap="butt" stroke-dasharray="2.3"#,
        r#"fill="blue""#,
        "a &lt; b</text>",
    ]
    .iter()
    .map(|part| svg.find(part).unwrap_or_else(|| panic!("{part}: {svg}")))
    .collect();
    assert!(places.is_sorted(), "{svg}");
}

/// A line behind a triangle has two visible parts; its own edge is visible; an edge of undrawn triangles is
/// not.
#[test]
fn hidden_parts_of_lines_are_cut() {
    let pieces = |beside: &[u32]| {
        let triangles = [(over(1.0), 0, 7)];
        let svg = ask(&question(1, 1), file(&triangles, &[(across(0.5), 2, beside)])).unwrap();
        let line = svg.lines().find(|line| line.contains("teal")).map(str::to_owned);
        line.map_or(0, |line| line.matches('M').count())
    };
    assert_eq!([pieces(&[]), pieces(&[7]), pieces(&[7, 9]), pieces(&[9])], [2, 1, 1, 0]);
}

#[test]
fn inconsistent_scenes_are_rejected() {
    let good = file(&[(over(1.0), 0, 0)], &[(across(0.5), 0, &[0, 1])]);
    assert!(ask(&question(1, 1), good.clone()).is_ok());
    for (triangles, segments) in [(0, 1), (2, 1), (1, 2), (usize::MAX, 0), (1, usize::MAX)] {
        let error = ask(&question(triangles, segments), good.clone()).unwrap_err();
        assert!(error.contains("does not match the stated numbers"), "{error}");
    }
    for length in [0, 1, good.len() - 4, good.len() - 1] {
        ask(&question(1, 1), good[..length].to_vec()).unwrap_err();
    }
    ask(&question(1, 1), [&good[..], &[0; 4]].concat()).unwrap_err();
    // Styles that do not exist, and more neighbours than possible.
    ask(&question(1, 0), file(&[(over(1.0), 3, 0)], &[])).unwrap_err();
    ask(&question(0, 1), file(&[], &[(across(1.0), 3, &[])])).unwrap_err();
    let mut endless = file(&[], &[(across(1.0), 0, &[])]);
    let last = endless.len() - 4;
    endless[last..].fill(255);
    ask(&question(0, 1), endless).unwrap_err();
    for size in [json!([0, 40]), json!([1e9, 40]), json!([null, 40])] {
        let mut asked = question(1, 1);
        asked["size"] = size;
        ask(&asked, good.clone()).unwrap_err();
    }
    assert!(ask(&json!({ "do": "dance" }), Vec::new()).unwrap_err().contains("dance"));
    assert!(ask(&json!([]), Vec::new()).is_err());
}

#[test]
fn triangles_and_segments_with_nan_are_omitted() {
    let odd = [[f64::NAN, 0.0, 1.0], [60.0, 0.0, 1.0], [0.0, 40.0, f64::INFINITY]];
    let triangles = [(odd, 0, 0), (over(1.0), 0, 1)];
    let segments: [Segment; 1] = [([[f64::NAN, 1.0, 1.0], [1.0, f64::NAN, 1.0]], 2, &[])];
    let svg = ask(&question(2, 1), file(&triangles, &segments)).unwrap();
    assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
}
