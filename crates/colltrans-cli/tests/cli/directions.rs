//! `colltrans directions` and `colltrans assembly --free`, with proofs.

use std::fs;
use std::path::Path;

use serde_json::{Value, json};

use crate::proof::{checked_in_fractions, saved};
use crate::support::{answered, data, folder, json as read, refused, run, stderr};

const LID: [&str; 5] = ["directions", "cube.off", "cube.off", "--moving-pose", "0,0,1"];

fn facts(folder: &Path, arguments: &[&str]) -> Value {
    read(&answered(folder, &[arguments, &["--json"]].concat()))
}

#[test]
fn lid_has_a_free_hemisphere() {
    let folder = folder();
    let told = facts(folder.path(), &[&LID[..], &["--tolerance", "0"]].concat());
    let share = |k: usize| told["free_share"][k].as_f64().unwrap();
    assert!(share(0) <= 0.5 && 0.5 <= share(1) && share(1) - share(0) < 1e-13, "{told}");
    assert_eq!((&told["outcome"], &told["undecided_cells"]), (&json!("free"), &json!(0)));
    let regions = told["regions"].as_array().unwrap();
    assert_eq!(regions.len(), 1);
    assert_eq!(regions[0]["corners"], json!([]));
    let center = regions[0]["center"][2].as_f64().unwrap();
    assert!((center - 1.0).abs() < 1e-12, "{told}");
    let text = answered(folder.path(), &[&LID[..], &["--tolerance", "0"]].concat());
    assert!(text.starts_with("free along some directions\n  free         (50 ± "), "{text}");
    assert!(text.contains("undecided    nothing\n"), "{text}");
}

#[test]
fn bolt_directions_have_a_proof_that_both_checkers_accept() {
    let folder = folder();
    let [bolt, plate] = ["bolt.stl", "plate.off"].map(|name| data().join(name));
    let [bolt, plate] = [&bolt, &plate].map(|path| path.to_str().unwrap());
    let mut proof = saved(folder.path(), &["directions", bolt, plate]);
    let text = answered(folder.path(), &["verify", "proof.json"]);
    assert!(text.starts_with("holds: shrunk by 1.19209"), "{text}");
    assert!(text.contains("can leave along (0.00996897475 ± "), "{text}");
    let told = read(&answered(folder.path(), &["verify", "proof.json", "--json"]));
    assert_eq!(told["outcome"], "free");
    checked_in_fractions(folder.path(), 7);
    // A changed facet does not block this cell.
    let cells = proof["statement"]["free_directions"]["cells"].as_array_mut().unwrap();
    let cell = cells.iter_mut().find(|cell| cell.get("blocked").is_some()).unwrap();
    let facet = cell["blocked"][0].as_u64().unwrap();
    cell["blocked"][0] = json!(if facet > 0 { facet - 1 } else { 1 });
    fs::write(folder.path().join("proof.json"), proof.to_string()).unwrap();
    let output = run(folder.path(), &["verify", "proof.json"]);
    assert_eq!(output.status.code(), Some(6), "{}", stderr(&output));
}

#[test]
fn overlaps_are_reported_and_invalid_inputs_rejected() {
    let folder = folder();
    let folder = folder.path();
    let told = facts(folder, &["directions", "cube.off", "cube.off", "--moving-pose", "0.5,0,0"]);
    assert_eq!(told["outcome"], "overlapping");
    assert_eq!(told["start_overlaps"].as_array().unwrap().len(), 1);
    let text =
        answered(folder, &["directions", "cube.off", "cube.off", "--moving-pose", "0.5,0,0"]);
    assert!(text.contains("--tolerance permits it"), "{text}");
    // No tolerance separates a body from itself.
    let text = answered(folder, &["directions", "cube.off", "cube.off"]);
    assert!(text.contains("no tolerance would separate them"), "{text}");
    assert!(!text.contains("--tolerance permits it") && text.contains("ignores it"), "{text}");
    fs::write(folder.join("points.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n").unwrap();
    refused(
        folder,
        &["directions", "points.obj", "cube.off"],
        3,
        &["points.obj", "--hull", "points"],
    );
    refused(folder, &["directions", "cube.off"], 2, &["--from"]);
    refused(folder, &["directions", "cube.off", "open.off"], 3, &["open.off"]);
    refused(folder, &[&LID[..], &["--tolerance", "-1"]].concat(), 2, &["negative"]);
    refused(folder, &[&LID[..], &["--depth", "51"]].concat(), 2, &["51"]);
    refused(folder, &[&LID[..], &["--save-proof", "cube.off"]].concat(), 3, &["cube.off"]);
}

#[test]
fn small_work_limit_leaves_directions_undecided() {
    let folder = folder();
    let told = facts(folder.path(), &[&LID[..], &["--looks", "0"]].concat());
    assert_eq!(told["outcome"], "free", "along directions that casts find");
    assert!(told["undecided_share"].as_f64().unwrap() > 0.999, "{told}");
    assert!(!told["also_free"].as_array().unwrap().is_empty());
}

#[test]
#[ignore = "long: all directions of a whole machine"]
fn free_directions_of_assembly_parts_list_blockers() {
    let output = folder();
    let output = output.path().to_str().unwrap();
    let asked = ["--free", "bolt_0", "--free", "cover", "-o", output];
    let told = facts(&data(), &[&["assembly", "gearbox_small"][..], &asked].concat());
    let [bolt, cover] = [&told["free"][0], &told["free"][1]];
    assert_eq!((&bolt["outcome"], &cover["outcome"]), (&json!("free"), &json!("blocked")));
    assert_eq!(cover["cells"], 6, "six pairs of facets");
    assert_eq!(cover["blocked_by"][0]["fixed"], "shaft");
    assert_eq!(bolt["parts"], json!(["bolt_0"]));
    // With the precision of doubles the bolt fills its hole. With a tolerance it can leave along a narrow cone.
    assert_eq!(bolt["also_free"], json!([[0.0, 0.0, 1.0]]));
    let asked = ["assembly", "gearbox_small", "--free", "bolt_0", "--tolerance", "2e-5"];
    let narrow = &facts(&data(), &asked)["free"][0];
    assert!(narrow["free_share"][0].as_f64() > Some(3.9e-13), "{narrow}");
    let proof = Path::new(output).join("free-cover.json");
    let text = answered(&data(), &["verify", proof.to_str().unwrap()]);
    assert!(text.contains("the moving body cannot leave along any direction"), "{text}");
    refused(&data(), &["assembly", "gearbox_small", "--free", "x"], 2, &["unknown part x"]);
}

#[test]
#[ignore = "long: all directions of a whole machine"]
fn interlocked_group_is_proven_unless_disabled() {
    let asked = facts(&data(), &["assembly", "gearbox_small", "--no-proofs"]);
    let proven = facts(&data(), &["assembly", "gearbox_small"]);
    let proof = |told: &Value| told["stuck"][0]["proof"].clone();
    assert_eq!(proof(&asked), json!({ "asked": asked["stuck"][0]["directions"] }));
    let cells = proof(&proven)["proven"].as_u64().unwrap();
    assert!(cells < 400, "{cells}");
    assert_eq!(asked["plan"], proven["plan"]);
    let text = answered(&data(), &["assembly", "gearbox_small"]);
    assert!(
        text.contains("stuck: proven for each single translation of a group as one\n"),
        "{text}"
    );
    let text = answered(&data(), &["assembly", "gearbox_small", "--no-proofs"]);
    assert!(text.contains("stuck: no single translation found, not proven\n"), "{text}");
}

#[test]
fn oversized_coordinates_are_an_input_error() {
    let folder = folder();
    let folder = folder.path();
    for (size, words) in [("1e300", "outside the exact range"), ("1e50", "coordinates up to 1e50")]
    {
        let vertices = format!("0 0 0\n{size} 0 0\n0 {size} 0\n0 0 {size}\n");
        let wild = format!("OFF\n4 4 0\n{vertices}3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n");
        fs::write(folder.join("wild.off"), wild).unwrap();
        refused(folder, &["directions", "wild.off", "cube.off"], 3, &["wild.off", words]);
    }
    // A given tolerance that is too large is an error of the command line.
    let chosen = ["directions", "cube.off", "cube.off", "--tolerance", "1e40"];
    refused(folder, &chosen, 2, &["leaves nothing"]);
}
