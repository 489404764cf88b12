//! Tests real assemblies, if the collection of meshes is next to the checkout.

use colltrans_testkit::TemporaryFolder;
use std::path::{Path, PathBuf};

use colltrans::solid::{StartOverlap, Workspace};
use colltrans_assembly::map::{MapOptions, RemovalMap};
use colltrans_assembly::plan::{Plan, PlanOptions};
use colltrans_assembly::roles::{PairFit, Role};
use colltrans_assembly::sphere::Sphere;
use colltrans_assembly::start::Start;
use colltrans_assembly::travel::travels_of_parts;
use colltrans_assembly::{Assembly, Bodies, Fit, FreeTravel, Watch};
use colltrans_assembly_io::read::{ReadOptions, read};

/// Returns the folder of the collection; `None` if it is missing.
fn collection_folder() -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    folder.is_dir().then(|| folder.canonicalize().unwrap())
}

/// Returns options for manifests that name files by absolute paths.
fn outside_allowed() -> ReadOptions {
    ReadOptions::default().with_allow_outside(true)
}

/// Computes the plan with default options.
fn planned(bodies: &Bodies) -> Plan {
    crate::common::planned(bodies, PlanOptions::default())
}

#[test]
fn gearbox_plan_removes_bearings_as_groups() {
    let Some(folder) = collection_folder() else { return };
    let assembly = read(folder.join("gearbox"), &ReadOptions::default()).unwrap();
    let bodies = Bodies::new(&assembly, Fit::Tolerance(0.06)).unwrap();
    let plan = planned(&bodies);
    assert!(plan.remaining.is_empty());
    let steps: Vec<Vec<&str>> = plan.steps.iter().map(|s| assembly.part_names(&s.parts)).collect();
    let at = |name: &str| steps.iter().position(|s| s.contains(&name)).unwrap();
    for side in ["front", "rear"] {
        let bearing = &steps[at(&format!("{side}_inner"))];
        assert_eq!(bearing.len(), 9);
        assert!(bearing.iter().all(|name| name.starts_with(side)), "{bearing:?}");
    }
    // The shaft leaves with its key.
    assert!(
        steps.iter().all(|s| s.len() == 1 || s.len() == 9 || s == &["key", "shaft"]),
        "{steps:?}"
    );
    assert_eq!(assembly.part_names(&plan.base), ["housing"]);
    assert!((0..4).all(|k| at(&format!("bolt_{k}")) < at("cover")));
    assert!(at("cover") < at("front_inner") && at("front_inner") < at("spacer"));
    assert!(at("spacer") < at("gear") && at("gear") < at("key"));
    let out = steps.iter().position(|s| s == &["key"]).unwrap();
    assert_eq!(plan.steps[out].group_step, Some(at("key")));
    let key = plan.steps[out].direction;
    assert!(key.z > 0.999, "{key}");
    assert_eq!(plan.interlocked.len(), 2, "translations cannot take the bearings apart");
}

#[test]
fn suggested_tolerance_of_gearbox_permits_full_plan() {
    let Some(folder) = collection_folder() else { return };
    let assembly = read(folder.join("gearbox"), &ReadOptions::default()).unwrap();
    let bodies = Bodies::new(&assembly, Fit::default_for(&assembly)).unwrap();
    let start = Start::new(&bodies, Watch::default()).unwrap();
    assert_eq!(start.remaining().count(), 3);
    let tolerance = start.suggested_tolerance.unwrap();
    assert!((0.004..0.006).contains(&tolerance), "{tolerance}");
    let bodies = Bodies::new(&assembly, Fit::Tolerance(tolerance)).unwrap();
    assert!(bodies.overlapping_pairs().is_empty());
    let plan = planned(&bodies);
    let mut sizes: Vec<usize> = plan.steps.iter().map(|s| s.parts.len()).collect();
    sizes.sort_unstable();
    assert_eq!(sizes, [&[1; 8][..], &[2, 9, 9]].concat());
}

/// Four legs overlap the ends of their threads at arbitrary phases.
#[test]
fn legs_of_table_are_unscrewed() {
    let Some(folder) = collection_folder() else { return };
    let file = folder.join("assemblies/square_table/assembly.toml");
    let assembly = read(file, &ReadOptions::default()).unwrap();
    let thread = PairFit { role: Some(Role::Thread), tolerance: None };
    let assembly = assembly.with_pair([&["top"], &["leg*"]], thread).unwrap();
    let bodies = Bodies::new(&assembly, Fit::default_for(&assembly)).unwrap();
    let plan = planned(&bodies);
    assert!(plan.interlocked.is_empty() && plan.steps.len() == 4, "{:?}", plan.interlocked);
    assert_eq!(assembly.part_names(&plan.base), ["top"]);
    // Overlap of each leg with the top.
    let drawn: [f64; 4] = [0.0, 2.7e-4, 0.0, 0.0];
    for step in &plan.steps {
        let turn = step.first_turn().unwrap();
        let most = drawn[step.parts[0] - 1].max(bodies.fit().tolerance());
        assert!(turn.proof.as_ref().is_ok_and(|proof| proof.tolerance <= most), "{turn:?}");
        let pitch = step.path[0].travel / turn.turns.abs();
        assert!((pitch / 0.009_375 - 1.0).abs() < 0.015, "two turns of the drawn helix: {pitch}");
    }
}

/// 24 overlapping pieces of a car as parts: free travels with ignored overlaps.
#[test]
fn free_travel_of_overlapping_pieces_is_minimum_over_pairs() {
    let Some(folder) = collection_folder() else { return };
    let piece = |k: usize| folder.join(format!("car_seat/car_{k}.stl"));
    let parts: Vec<PathBuf> = (1..=24).map(piece).collect();
    let list: Vec<_> = parts.iter().map(|p| serde_json::json!({ "file": p })).collect();
    let place = TemporaryFolder::new();
    let file = place.path().join("car.json");
    std::fs::write(&file, serde_json::json!({ "parts": list }).to_string()).unwrap();
    let assembly = read(&file, &outside_allowed()).unwrap();
    let bodies = Bodies::new(&assembly, Fit::default_for(&assembly)).unwrap();
    assert!(bodies.overlapping_pairs().len() > 50);
    let start = StartOverlap::Ignore;
    let directions = Sphere::new(1).directions;
    let table = travels_of_parts(&bodies, &directions, start, Watch::default()).unwrap();
    let at_once = 4.0 * bodies.fit().tolerance();
    let mut workspace = Workspace::default();
    for (k, &d) in directions.iter().enumerate().step_by(5) {
        for (a, row) in table.iter().enumerate() {
            let others = (0..bodies.len()).filter(|&b| b != a);
            let rooms = others.map(|b| bodies.free_travel([a, b], d, None, start, &mut workspace));
            let distance = |room: FreeTravel| match room {
                FreeTravel::Blocked(stop) => stop.shrunk_translation.value,
                _ => f64::INFINITY,
            };
            let least = rooms.map(distance).fold(f64::INFINITY, f64::min);
            let found = row[k].displaced_distance();
            let same = found == least || (found - least).abs() < 1e-9;
            assert!(same || (least..=at_once).contains(&found), "{a} {d}: {found} {least}");
        }
    }
}

/// Returns a seat in a car, displaced by 0.3, facing the rear.
fn seat_in_car(folder: &Path) -> Assembly {
    let files = |name: &str, count: usize| -> Vec<PathBuf> {
        (1..=count).map(|k| folder.join(format!("car_seat/{name}_{k}.stl"))).collect()
    };
    let manifest = serde_json::json!({"unit": "m", "parts": [
        {"name": "car", "file": files("car", 24)},
        {"name": "seat", "file": files("seat", 10), "scale": 0.9, "translation": [-1.0, 0.3, 0.42],
         "rotation": {"rpy_degrees": [0, 0, 180]}},
    ]});
    let place = TemporaryFolder::new();
    let file = place.path().join("seat.json");
    std::fs::write(&file, manifest.to_string()).unwrap();
    read(&file, &outside_allowed()).unwrap()
}

#[test]
fn seat_leaves_car_along_narrow_region() {
    let Some(folder) = collection_folder() else { return };
    let assembly = seat_in_car(&folder);
    let bodies = Bodies::new(&assembly, Fit::default_for(&assembly)).unwrap();
    assert!(!bodies.overlaps(0, 1));
    let plan = planned(&bodies);
    assert_eq!(plan.steps.iter().map(|s| &s.parts[..]).collect::<Vec<_>>(), [[1]]);
    let options = MapOptions::default().with_samples(642).with_border(0.02);
    let map = RemovalMap::new(&bodies, &[1], &[], options, Watch::default()).unwrap();
    assert!((0.002..0.008).contains(&map.free_share()), "{}", map.free_share());
    assert_eq!(map.regions.len(), 1);
    // The region is elongated: its extent exceeds that of a disc of the same area.
    let region = &map.regions[0];
    let far = |d: &glam::DVec3| d.angle_between(region.center);
    let reach = region.border.iter().map(far).fold(0.0, f64::max);
    let disc = (region.solid_angle / std::f64::consts::PI).sqrt();
    assert!(reach > 2.0 * disc, "{reach} against {disc}");
}

#[test]
fn urdf_package_in_folder_of_file_is_read() {
    let Some(folder) = collection_folder() else { return };
    let panda = folder.join("panda");
    let options = ReadOptions::default().with_packages(vec![panda.clone()]);
    assert_eq!(read(panda.join("panda.urdf"), &options).unwrap().parts().len(), 11);
}

#[test]
fn external_3mf_and_glb_files_are_read() {
    let Some(folder) = collection_folder() else { return };
    let open = |name: &str| read(folder.join("assemblies").join(name), &ReadOptions::default());
    assert_eq!(open("heartgears.3mf").unwrap().parts().len(), 1);
    assert!(open("ReciprocatingSaw.glb").unwrap().parts().len() > 10);
    let message = open("pillow_block.step").unwrap_err().to_string();
    assert!(message.contains("STEP is not read directly; convert the file to GLB"), "{message}");
}
