//! `colltrans clearance`, and solids in `batch` and `info`, with small generated parts.

use std::path::Path;
use std::process::Output;

use colltrans_testkit::TemporaryFolder;
use colltrans_testkit::shapes::{Mesh, block, extruded, ring};
use glam::DVec3;
use serde_json::Value;

use crate::support::{colltrans, data, fields, fields_without, json, stderr, stdout};

fn pin(radius: f64, sides: usize, z: [f64; 2]) -> Mesh {
    extruded(&ring(sides, radius, 0.0).collect::<Vec<_>>(), z)
}

/// Returns a plate from -4 to 4 with a round hole; its number of sides is a multiple of four.
fn plate(radius: f64, sides: u32, z: [f64; 2]) -> Mesh {
    let corners = [[4.0, 4.0], [-4.0, 4.0], [-4.0, -4.0], [4.0, -4.0]];
    let corners = corners.map(|[x, y]| DVec3::new(x, y, 0.0)).into_iter();
    let outline: Vec<DVec3> = corners.chain(ring(sides as usize, radius, 0.0)).collect();
    let n = outline.len() as u32;
    let Mesh { vertices, .. } = extruded(&outline, z);
    let mut faces = Vec::new();
    let rim = |i: u32| 4 + i % sides;
    for i in 0..4 {
        faces.push(vec![i, (i + 1) % 4, n + (i + 1) % 4, n + i]);
        let after = rim((i + 1) * sides / 4);
        faces.push(vec![n + i, n + (i + 1) % 4, n + after]);
        faces.push(vec![i, after, (i + 1) % 4]);
    }
    for i in 0..sides {
        let (corner, a, b) = (i * 4 / sides, rim(i), rim(i + 1));
        faces.push(vec![b, a, n + a, n + b]);
        faces.push(vec![n + corner, n + b, n + a]);
        faces.push(vec![corner, a, b]);
    }
    Mesh { vertices, faces }
}

fn write(mesh: &Mesh, folder: &Path, name: &str) {
    let mesh = colltrans_mesh::Mesh::new(mesh.vertices.clone(), mesh.faces.clone());
    std::fs::write(folder.join(name), colltrans_mesh::to_off(&mesh)).unwrap();
}

/// Writes binary STL. Some corners of triangles are displaced by one unit in the last place of single precision.
fn write_with_twins(mesh: &Mesh, folder: &Path, name: &str) {
    let triangles: Vec<[u32; 3]> = mesh.triangles().collect();
    let mut bytes = vec![0; 80];
    bytes.extend((triangles.len() as u32).to_le_bytes());
    for (index, triangle) in triangles.iter().enumerate() {
        bytes.extend([0; 12]);
        for &corner in triangle {
            for c in mesh.vertices[corner as usize].to_array() {
                let c = c as f32;
                let twin = if index % 3 == 0 && c != 0.0 { c.next_up() } else { c };
                bytes.extend(twin.to_le_bytes());
            }
        }
        bytes.extend([0; 2]);
    }
    std::fs::write(folder.join(name), bytes).unwrap();
}

/// Returns a folder with a pin of radius 1, a plate with a hole of the same radius and another number of sides, a block, a
/// table, an open block, and a broken file.
fn folder() -> TemporaryFolder {
    let folder = TemporaryFolder::new();
    write(&pin(1.0, 32, [0.0, 6.0]), folder.path(), "pin.off");
    write(&plate(1.0, 48, [-2.0, 0.0]), folder.path(), "plate.off");
    write(&block([-1.0; 3], [1.0; 3]), folder.path(), "block.off");
    write(&block([-9.0, -9.0, -2.0], [9.0, 9.0, -1.0]), folder.path(), "table.off");
    let mut open = block([-1.0; 3], [1.0; 3]);
    open.faces.pop();
    write(&open, folder.path(), "open.off");
    std::fs::write(folder.path().join("broken.off"), "OFF\n3 1 0\n0 0 zero\n").unwrap();
    folder
}

fn run(folder: &Path, words: &str, more: &[&str]) -> Output {
    colltrans(folder).arg("clear").args(words.split_whitespace()).args(more).output().unwrap()
}

/// Returns the answer as JSON, and the notes on standard error.
fn ask(folder: &Path, words: &str) -> (Value, String) {
    let output = run(folder, words, &["--json"]);
    assert_eq!(output.status.code(), Some(0), "{words}: {}", stderr(&output));
    (json(&stdout(&output)), stderr(&output))
}

fn refused(folder: &Path, words: &str, code: i32, parts: &[&str]) {
    let output = run(folder, words, &[]);
    let message = stderr(&output);
    assert_eq!(output.status.code(), Some(code), "{words}: {message}");
    assert_eq!(stdout(&output), "");
    for part in parts {
        assert!(message.contains(part), "{part:?} is not in {message}");
    }
}

fn number(value: &Value, field: &str) -> f64 {
    value[field].as_f64().unwrap_or_else(|| panic!("{field} in {value}"))
}

fn bounds(value: &Value, name: &str) -> [f64; 2] {
    let bounds = &value[&format!("{name}_bounds")];
    [0, 1].map(|k| bounds[k].as_f64().unwrap_or_else(|| panic!("{name}: {value}")))
}

/// The fields of the answer for blocked parts.
const BLOCKED_FIELDS: [&str; 12] = [
    "distance",
    "exit",
    "exit_bounds",
    "features",
    "normal",
    "offset_distance",
    "offset_distance_bounds",
    "outcome",
    "point",
    "tolerance",
    "translation",
    "translation_bounds",
];

#[test]
fn bolt_is_blocked_by_its_head() {
    let words = "bolt.stl --from plate.off --direction -z --moving-pose 0,0,7";
    let (answer, notes) = ask(&data(), words);
    assert_eq!(notes, "");
    assert_eq!(fields_without(&answer, &["fixed", "moving"]), BLOCKED_FIELDS);
    assert_eq!(answer["outcome"], "blocked");
    let distance = number(&answer, "distance");
    assert!(distance <= 7.0 && distance > 7.0 - 1e-12, "safe to move by: {answer}");
    let tolerance = number(&answer, "tolerance");
    assert!(tolerance > 1e-7 && tolerance < 1e-5, "single precision: {answer}");
    assert!((number(&answer, "offset_distance") - 7.0 - tolerance).abs() < 1e-9, "{answer}");
    // The top of the head leaves the underside of the plate after 12.
    for (name, right) in [("translation", 7.0), ("exit", 12.0)] {
        let [lower, upper] = bounds(&answer, name);
        assert!(lower <= right && right <= upper && upper - lower < 1e-11, "{name}: {answer}");
        assert!((number(&answer, name) - right).abs() < 1e-12, "{name}: {answer}");
    }
    let [lower, upper] = bounds(&answer, "offset_distance");
    assert!(lower <= 7.0 + tolerance && 7.0 + tolerance <= upper + 1e-12, "{answer}");
    assert_eq!(bounds(&answer, "translation")[0], distance);
    let features = &answer["features"];
    let feature = |side: &str| (features[side]["kind"].as_str(), &features[side]["vertices"]);
    let corners = |side: &str| feature(side).1.as_array().unwrap().len();
    assert_eq!([feature("moving").0, feature("fixed").0], [Some("face"); 2], "{answer}");
    assert!(corners("moving") > 8 && corners("fixed") > 8, "rims and holes: {answer}");
    assert_eq!((&answer["moving"], &answer["fixed"]), (&"bolt.stl".into(), &"plate.off".into()));
    assert_eq!(answer["normal"], serde_json::json!([0.0, 0.0, -1.0]));
    let up = words.replace("-z", "z");
    assert_eq!(ask(&data(), &up).0["outcome"], "free");
    let text = stdout(&run(&data(), words, &[]));
    assert!(text.starts_with("blocked\n  distance     7 times the direction, a length of 7\n"));
    for part in ["offset       7.0000", "of bolt.stl", "of plate.off", "from the files' precision"]
    {
        assert!(text.contains(part), "{part:?} is not in {text}");
    }
}

#[test]
fn guide_shows_the_printed_answer_and_picture() {
    let root = data().join("..");
    let page = std::fs::read_to_string(root.join("docs/guide/clearance.md")).unwrap();
    let (_, rest) = page.split_once("```sh\ncolltrans clearance ").unwrap();
    let (command, rest) = rest.split_once(" --picture bolt.svg\n```\n\n```text\n").unwrap();
    let (shown, _) = rest.split_once("```").unwrap();
    let folder = TemporaryFolder::new();
    let picture = folder.path().join("bolt.svg");
    let drawn = ["--picture", picture.to_str().unwrap()];
    assert_eq!(stdout(&run(&root, command, &drawn)), shown);
    let [drawn, kept] = [picture, root.join("docs/solid-bolt-and-plate.svg")]
        .map(|path| std::fs::read_to_string(path).unwrap());
    assert!(drawn == kept, "the page shows another picture than the one that is drawn");
}

#[test]
fn pin_passes_a_hole_of_its_radius_with_chord_tolerance() {
    let folder = folder();
    let words = "pin.off --from plate.off --direction -z --moving-pose 0,0,3";
    let (stopped, _) = ask(folder.path(), words);
    assert_eq!(stopped["outcome"], "blocked", "by slivers of the sides");
    assert!((number(&stopped, "translation") - 3.0).abs() < 1e-9, "{stopped}");
    let text = stdout(&run(folder.path(), &words.replace(",3", ",0"), &[]));
    assert!(text.contains("(the parts touch)") && text.contains("chord errors"), "{text}");
    let (free, _) = ask(folder.path(), &format!("{words} --tolerance 0.01"));
    assert_eq!(fields(&free), ["exit", "exit_bounds", "outcome", "tolerance"], "{free}");
    assert_eq!((&free["outcome"], number(&free, "tolerance")), (&"free".into(), 0.01));
    // Next to the hole it is blocked with any tolerance.
    let beside = format!("{words} --tolerance 0.01").replace("0,0,3", "0.5,0,3");
    assert_eq!(ask(folder.path(), &beside).0["outcome"], "blocked");
}

#[test]
fn block_on_a_table_is_blocked_only_downwards() {
    let folder = folder();
    let (down, _) = ask(folder.path(), "block.off --from table.off --direction 0,0,-2");
    assert_eq!(down["outcome"], "blocked");
    assert!(number(&down, "translation").abs() < 1e-12, "{down}");
    for aside in ["z", "x", "1,1,0", "-y"] {
        let words = format!("block.off --from table.off --direction {aside}");
        assert_eq!(ask(folder.path(), &words).0["outcome"], "free", "{aside}");
    }
    let turned = "--moving-rpy 0,0,30 --fixed-rpy 90,0,0 --fixed-pose 0,0.0,0 --fixed-scale 2";
    let (turned, _) =
        ask(folder.path(), &format!("block.off --from table.off --direction y {turned}"));
    // The table occupies y from 2 to 4; the corner of the block is at cos 30 + sin 30.
    let expected = 2.0 - (30.0_f64.to_radians().cos() + 0.5);
    assert!((number(&turned, "translation") - expected).abs() < 1e-9, "{turned}");
}

#[test]
fn start_overlaps_are_listed_by_file() {
    let folder = folder();
    write(&block([-1.0, -1.0, 2.0], [1.0, 1.0, 3.0]), folder.path(), "lid.off");
    let words =
        "block.off lid.off --from plate.off table.off --direction z --moving-pose 0,0,-0.25";
    let (answer, _) = ask(folder.path(), words);
    assert_eq!(answer["outcome"], "overlapping");
    let overlaps = answer["start_overlaps"].as_array().unwrap();
    let pairs: Vec<_> = overlaps.iter().map(|o| (&o["moving"], &o["fixed"])).collect();
    assert_eq!(pairs.len(), 2, "{answer}");
    assert!(pairs.contains(&(&"block.off".into(), &"table.off".into())), "{answer}");
    assert!(pairs.contains(&(&"block.off".into(), &"plate.off".into())), "{answer}");
    assert_eq!(answer["moving"], "block.off");
    let table = overlaps.iter().find(|o| o["fixed"] == "table.off").unwrap();
    assert!((number(table, "least_tolerance") - 0.25).abs() < 1e-9, "{answer}");
    assert!(answer.get("distance").is_none() && answer.get("point").is_none(), "{answer}");
    let alone = "block.off --from table.off --direction z --moving-pose 0,0,-0.25";
    // That tolerance separates them; then the block rests on the table.
    let (up, _) = ask(folder.path(), &format!("{alone} --tolerance 0.2501"));
    assert_eq!(up["outcome"], "free");
    let down = format!("{alone} --tolerance 0.2501").replace("direction z", "direction -z");
    assert!(number(&ask(folder.path(), &down).0, "offset_distance") < 1e-3);
    let (ignored, _) = ask(folder.path(), &format!("{alone} --ignore-start-overlaps"));
    assert_eq!(ignored["outcome"], "free");
    assert_eq!(ignored["start_overlaps"][0]["fixed"], "table.off", "said all the same");
    let text = stdout(&run(folder.path(), alone, &[]));
    for part in ["overlapping: ", "block.off in table.off", "0.25", "--ignore-start-overlaps"] {
        assert!(text.contains(part), "{part:?} is not in {text}");
    }
    assert!(text.contains("--tolerance permits it"), "{text}");
    // No tolerance separates a body from itself, so none is suggested.
    let itself = stdout(&run(folder.path(), "block.off --from block.off --direction z", &[]));
    assert!(itself.contains("no tolerance would separate them"), "{itself}");
    assert!(!itself.contains("--tolerance permits it"), "{itself}");
}

#[test]
fn files_and_vertices_in_contact_are_named() {
    let folder = folder();
    write(&block([5.0, 5.0, 3.0], [6.0, 6.0, 4.0]), folder.path(), "near.off");
    write(&block([-6.0, -6.0, 5.0], [-5.0, -5.0, 6.0]), folder.path(), "high.off");
    let words = "block.off high.off near.off --from table.off plate.off --direction -z \
                 --moving-pose 0,0,9";
    let (answer, _) = ask(folder.path(), words);
    // The block is 8 above the plate, the near block 13 above the table.
    assert!((number(&answer, "translation") - 8.0).abs() < 1e-9, "{answer}");
    assert_eq!((&answer["moving"], &answer["fixed"]), (&"block.off".into(), &"plate.off".into()));
    let aside = words.replace("0,0,9", "-10.5,-10.5,9").replace("-z --", "-z --tolerance 0 --");
    let (answer, _) = ask(folder.path(), &aside);
    assert!((number(&answer, "translation") - 13.0).abs() < 1e-9, "{answer}");
    assert_eq!((&answer["moving"], &answer["fixed"]), (&"near.off".into(), &"table.off".into()));
    // Vertices of features are numbered as in their file.
    let text = stdout(&run(folder.path(), &aside, &[]));
    let line = text.lines().find(|line| line.contains("of near.off")).unwrap();
    let last = line.split_whitespace().filter_map(|word| word.parse::<usize>().ok()).max().unwrap();
    assert!(last < 8, "{line}");
}

#[test]
fn near_stl_vertices_are_merged_with_a_note() {
    let folder = folder();
    write_with_twins(&plate(1.5, 24, [-2.0, 0.0]), folder.path(), "plate.stl");
    let words = "pin.off --from plate.stl --direction -z --moving-pose 0,0,3";
    let (answer, notes) = ask(folder.path(), words);
    assert_eq!(answer["outcome"], "free", "{answer}");
    assert!(notes.contains("note: plate.stl: ") && notes.contains("merged"), "{notes}");
    let tolerance = number(&answer, "tolerance");
    assert!(tolerance > 1e-7 && tolerance < 1e-5, "of single precision: {answer}");
    refused(
        folder.path(),
        &format!("{words} --merge-tolerance 0"),
        3,
        &["plate.stl", "not closed"],
    );
    let (exact, _) = ask(folder.path(), &words.replace("plate.stl", "plate.off"));
    assert!(number(&exact, "tolerance") < 1e-12, "of double precision: {exact}");
}

#[test]
fn open_surface_requires_open_flag() {
    let folder = folder();
    let words = "open.off --from table.off --direction -z --moving-pose 0,0,4";
    let parts = ["open.off", "not closed: 4 edges", "--merge-tolerance", "--open"];
    refused(folder.path(), words, 3, &parts);
    let (answer, notes) = ask(folder.path(), &format!("{words} --open"));
    assert!((number(&answer, "translation") - 4.0).abs() < 1e-9, "{answer}");
    let surface = "open.off: an open surface (4 open edges, the first from vertex 3 to vertex 1 of";
    assert!(notes.contains(surface), "{notes}");
    assert_eq!(answer["surfaces"], serde_json::json!(["moving"]));
    // It has no interior, but its walls block from both sides.
    let inside = "block.off --from open.off --direction -z --moving-scale 0.5 --open";
    let (within, _) = ask(folder.path(), inside);
    assert_eq!(within["surfaces"], serde_json::json!(["fixed"]));
    assert!((number(&within, "translation") - 0.5).abs() < 1e-9, "{within}");
    let below = format!("{inside} --moving-pose 0,0,-4").replace("-z", "z");
    assert!((number(&ask(folder.path(), &below).0, "translation") - 2.5).abs() < 1e-9);
}

#[test]
fn convex_meshes_become_convex_bodies_and_others_parts() {
    let folder = folder();
    let ask = |words: &str| ask(folder.path(), &format!("{words} --direction -z")).0;
    let convex = ask("block.off table.off --moving-pose 0,0,5");
    assert_eq!(convex["solver"], "portal", "{convex}");
    assert_eq!(ask("block.off table.off --moving-pose 9,9,-20")["outcome"], "behind");
    let placed = |words: &str| ask(&format!("{words} --moving-pose 0,0,5"));
    assert_eq!(placed("pin.off plate.off"), placed("pin.off --from plate.off"));
    assert_eq!(placed("pin.off plate.off")["outcome"], "blocked");
    let parts = placed("block.off table.off --tolerance 0.1");
    assert_eq!(parts["tolerance"], 0.1, "{parts}");
    assert_eq!(placed("pin.off plate.off --hull")["solver"], "portal");
    // The offset removes the table, but not the union of both.
    let thin = placed("table.off block.off --from plate.off --tolerance 1.5");
    assert!(thin["notes"][0].as_str().unwrap().contains("inside out"), "{thin}");
}

#[test]
fn tolerance_beyond_the_thickness_is_rejected() {
    let folder = folder();
    let folder = folder.path();
    let words = "block.off --from table.off --direction -z --moving-pose 0,0,5 --tolerance";
    ask(folder, &format!("{words} 0.999"));
    for tolerance in ["1", "1.5"] {
        let said = ["leaves nothing of the fixed body, which is 1 thick", tolerance];
        refused(folder, &format!("{words} {tolerance}"), 2, &said);
    }
    // The offset removes one of several files, which is noted. The overlap of its nominal surface is reported.
    let words = "table.off block.off --from plate.off --direction z --tolerance 1.5";
    let (within, notes) = ask(folder, words);
    assert_eq!(within["outcome"], "overlapping", "{within}");
    assert_eq!(within["start_overlaps"].as_array().unwrap().len(), 1, "{within}");
    assert!(notes.contains("table.off") && notes.contains("inside out"), "{notes}");
    let solid = |name: &str| serde_json::json!({ "solid": name });
    let batch = serde_json::json!({
        "moving": solid("block.off"), "fixed": solid("table.off"), "direction": [0, 0, -1],
        "moving_pose": { "translation": [0, 0, 5] }, "tolerance": 1
    });
    std::fs::write(folder.join("thin.jsonl"), batch.to_string()).unwrap();
    let told = stdout(&colltrans(folder).args(["batch", "thin.jsonl"]).output().unwrap());
    assert!(told.contains("which is 1 thick"), "{told}");
}

#[test]
fn invalid_clearance_arguments_are_rejected() {
    let folder = folder();
    let folder = folder.path();
    refused(folder, "none.off --from table.off --direction z", 3, &["none.off", "cannot be read"]);
    refused(folder, "block.off --from broken.off --direction z", 3, &["broken.off", "`zero`"]);
    refused(folder, "block.off --from table.off", 2, &["--direction"]);
    refused(folder, "block.off --direction z", 2, &["--from"]);
    refused(folder, "block.off table.off pin.off --direction z", 2, &["--from"]);
    refused(folder, "pin.off plate.off --direction z --hull --open", 2, &["--hull", "--open"]);
    refused(folder, "pin.off --from plate.off --direction z --solver cta", 2, &["--solver"]);
    refused(folder, "open.off table.off --direction z", 3, &["open.off", "--open"]);
    refused(folder, "--from table.off --direction z", 2, &["MESH"]);
    let words = "block.off --from table.off --direction z";
    refused(folder, &format!("{words} --tolerance -1"), 2, &["negative"]);
    refused(folder, &format!("{words} --graze-tolerance 1"), 2, &["--graze-tolerance"]);
    refused(folder, &format!("{words} --moving-scale 0"), 2, &["positive"]);
    refused(folder, &words.replace(" z", " 0,0,0"), 2, &["direction"]);
    refused(folder, &format!("{words} --picture a.png"), 2, &["a.svg"]);
    let help = stdout(&run(folder, "--help", &[]));
    for part in ["Examples:", "in the unit", "offset_distance", "--open", "colltrans help json"] {
        assert!(help.contains(part), "{part:?} is not in {help}");
    }
}

#[test]
fn cast_error_suggests_clearance_for_nonconvex_parts() {
    let folder = folder();
    let words = ["cast", "block.off", "plate.off", "--direction", "z"];
    let output = colltrans(folder.path()).args(words).output().unwrap();
    assert_eq!(output.status.code(), Some(3));
    let message = stderr(&output);
    assert!(
        message.contains("a hole through it") && message.contains("`colltrans clearance`"),
        "{message}"
    );
}

#[cfg(unix)]
#[test]
fn picture_that_would_overwrite_a_part_is_rejected() {
    let folder = folder();
    std::fs::hard_link(folder.path().join("plate.off"), folder.path().join("hard.svg")).unwrap();
    let before = std::fs::read(folder.path().join("plate.off")).unwrap();
    let words = "block.off --from table.off plate.off --direction z --picture hard.svg";
    refused(folder.path(), words, 3, &["hard.svg", "is the same file as the input plate.off"]);
    assert!(std::fs::read(folder.path().join("plate.off")).unwrap() == before);
}

#[test]
fn batch_answers_solids_or_rejects_their_fields() {
    let folder = folder();
    let solid = |name: &str| format!(r#"{{"solid":"{name}"}}"#);
    let line = |id: u32, moving: &str, fixed: &str, more: &str| {
        format!(
            r#"{{"id":{id},"moving":{moving},"fixed":{fixed},"direction":[0,0,-1],
            "moving_pose":{{"translation":[0,0,3]}}{more}}}"#
        )
        .replace('\n', " ")
    };
    let (pin, plate, mesh) = (solid("pin.off"), solid("plate.off"), r#"{"mesh":"block.off"}"#);
    let clearance = r#","query":"clearance""#;
    let lines = [
        line(0, &pin, &plate, clearance),
        line(1, &pin, &plate, r#","query":"clearance","tolerance":0.01"#),
        line(2, mesh, &plate, ""),
        line(3, mesh, mesh, clearance),
        line(4, &pin, &plate, r#","query":"contact""#),
        line(5, &pin, &plate, r#","graze_tolerance":0.1"#),
        line(6, mesh, mesh, r#","tolerance":0.1"#),
        line(7, r#"{"solid":"open.off"}"#, &plate, ""),
        line(8, r#"{"solid":"pin.off","hull":true}"#, &plate, ""),
        line(9, &plate, &plate, "").replace("[0,0,3]", "[1,0,2.5]"),
        line(10, &pin, &plate, r#","solver":"cta""#),
        line(11, &pin, r#"{"points":[[0,0,0],[1,0,0]]}"#, ""),
    ];
    std::fs::write(folder.path().join("queries.jsonl"), lines.join("\n")).unwrap();
    let output = colltrans(folder.path()).args(["batch", "queries.jsonl"]).output().unwrap();
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    let results: Vec<Value> = stdout(&output).lines().map(json).collect();
    let outcomes: Vec<&str> = results.iter().map(|r| r["outcome"].as_str().unwrap()).collect();
    assert_eq!(outcomes[..4], ["blocked", "free", "blocked", "blocked"], "{results:?}");
    assert_eq!(outcomes[4..9], ["error"; 5], "{results:?}");
    assert_eq!(fields_without(&results[0], &["id"]), BLOCKED_FIELDS);
    assert!((number(&results[0], "translation") - 3.0).abs() < 1e-9);
    assert!((number(&results[2], "translation") - 2.0).abs() < 1e-9, "block on plate");
    assert!((number(&results[3], "distance") - 1.0).abs() < 1e-9, "as convex bodies");
    for (result, word) in results[4..9].iter().chain(&results[10..11]).zip([
        "solids have no \"contact\"",
        "solids accept `tolerance`",
        "require solids",
        "not closed",
        "`hull` requires a `mesh`",
        "`solver`, `start`, `until`, `cuts`, `across_cells` and `cold` require convex bodies",
    ]) {
        assert_eq!(result["outcome"], "error");
        assert!(result["message"].as_str().unwrap().contains(word), "{result}");
    }
    assert_eq!([outcomes[9], outcomes[11]], ["blocked"; 2], "the last one by a segment");
    let overlapping = lines[9].replace("2.5]", "0.5]");
    std::fs::write(folder.path().join("queries.jsonl"), overlapping).unwrap();
    let output = colltrans(folder.path()).args(["batch", "queries.jsonl"]).output().unwrap();
    let result = json(&stdout(&output));
    assert_eq!(result["outcome"], "overlapping");
    assert_eq!(fields(&result["start_overlaps"][0]), ["least_tolerance"], "{result}");
}

#[test]
fn info_reports_holes_and_defects() {
    let folder = folder();
    let twice = plate(1.0, 12, [0.0, 1.0]).joined(&block([20.0; 3], [21.0; 3]).reversed());
    write(&twice, folder.path(), "two.off");
    let info =
        |name: &str| stdout(&colltrans(folder.path()).args(["info", name]).output().unwrap());
    for (name, part) in [
        ("plate.off", "solid        yes: 1 shell, 1 hole through"),
        ("two.off", "solid        yes: 2 shells, 1 hole through"),
        ("two.off", "repaired     1 shell turned, inside out in the file"),
        ("open.off", "solid        no: the surface is not closed: 4 edges"),
        ("open.off", "with --open  1 sheet, blocking from both sides, rims included"),
    ] {
        let text = info(name);
        assert!(text.contains(part), "{part:?} is not in {text}");
    }
}

#[test]
fn clearance_along_many_directions_prints_one_line_each() {
    let folder = folder();
    let path = folder.path();
    std::fs::write(path.join("d.txt"), "-z # down\nz\n0 0 -2\n0,0,0\n").unwrap();
    let ask = |more: &[&str]| {
        let first = ["clear", "block.off", "--from", "table.off", "--directions", "d.txt"];
        let all = [&first[..], &["--moving-pose", "0,0,1"], more].concat();
        colltrans(path).args(all).output().unwrap()
    };
    let output = ask(&[]);
    assert_eq!(output.status.code(), Some(1));
    assert_eq!(stderr(&output), "error: 1 of 4 directions have no answer\n");
    let text = stdout(&output);
    let lines: Vec<Vec<&str>> = text.lines().map(|l| l.split_whitespace().collect()).collect();
    assert_eq!(lines[0], ["direction", "outcome", "distance", "offset", "exit"]);
    assert_eq!(lines[1][..2], ["0,0,-1", "blocked"]);
    assert_eq!(lines[2][..4], ["0,0,1", "free", "-", "-"]);
    assert_eq!(lines[3][..2], ["0,0,-2", "blocked"]);
    assert_eq!(lines[4][..2], ["0,0,0", "error"]);
    assert_eq!(lines.len(), 5);

    let records: Vec<Value> = stdout(&ask(&["--json"])).lines().map(json).collect();
    assert_eq!(records.len(), 4);
    assert!((number(&records[0], "translation") - 1.0).abs() < 1e-9, "{}", records[0]);
    assert!((number(&records[2], "translation") - 0.5).abs() < 1e-9, "{}", records[2]);
    assert_eq!(records[2]["direction"], serde_json::json!([0.0, 0.0, -2.0]));
    assert_eq!(records[3]["outcome"], "error");
    let both = ask(&["--direction", "x"]);
    assert_eq!(both.status.code(), Some(2));
}
