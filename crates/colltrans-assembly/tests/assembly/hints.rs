//! Hints about parts: identical parts, parts in their own frames, and other units. Sound assemblies get no such hint.

use colltrans_assembly::hints::{Hint, HintKind, find_hints};
use colltrans_assembly::start::Start;
use colltrans_assembly::{Assembly, Bodies, Fit, Part, Watch};
use glam::{DAffine3, DVec3};

use crate::common::{cuboid, part, turned};

fn found(parts: Vec<Part>) -> Vec<Hint> {
    let assembly = Assembly::new(parts).unwrap();
    let bodies = Bodies::new(&assembly, Fit::default_for(&assembly)).unwrap();
    find_hints(&bodies, &Start::new(&bodies, Watch::default()).unwrap())
}

fn of_kind(hints: &[Hint], kind: HintKind) -> Vec<&Hint> {
    hints.iter().filter(|hint| hint.kind == kind).collect()
}

/// Returns a plate with a row of bolts of `size` on it.
fn machine(size: f64) -> Vec<Part> {
    let bolt = |k: usize| {
        let x = 3.0 * k as f64;
        part(&format!("bolt_{k}"), &[cuboid([x, 0.0, 1.0], [x + size, size, 1.0 + 2.0 * size])])
    };
    let plate = part("plate", &[cuboid([-1.0, -1.0, 0.0], [12.0, 4.0, 1.0])]);
    (0..4).map(bolt).chain([plate]).collect()
}

#[test]
fn sound_machine_gets_only_the_identical_hint() {
    let hints = found(machine(1.0));
    assert_eq!(hints.len(), 1, "{hints:?}");
    assert_eq!((hints[0].kind, &hints[0].parts[..]), (HintKind::Identical, &[0, 1, 2, 3][..]));
    assert_eq!(hints[0].description, "4 x bolt are identical");
    assert!(found(vec![machine(1.0).remove(4)]).is_empty());
}

#[test]
fn parts_around_a_common_origin_get_the_frames_hint() {
    // Bolts from one file each, none of them placed.
    let bolt = |k: usize| part(&format!("bolt_{k}"), &[cuboid([0.0; 3], [1.0, 1.0, 2.0])]);
    let hints = found((0..3).map(bolt).collect());
    let [frames] = of_kind(&hints, HintKind::Frames)[..] else { panic!("{hints:?}") };
    assert_eq!(frames.parts, [0, 1, 2]);
    assert!(frames.description.contains("one body in one place"), "{}", frames.description);
    // Different parts, all around the origin.
    let long = |k: usize, x: f64, y: f64| {
        part(&format!("p{k}"), &[cuboid([-x, -y, -1.0], [x, y, 1.0 + 0.25 * k as f64])])
    };
    let hints = found(vec![long(0, 3.0, 1.0), long(1, 1.0, 3.0), long(2, 2.0, 2.5)]);
    let [frames] = of_kind(&hints, HintKind::Frames)[..] else { panic!("{hints:?}") };
    assert!(
        frames.description.starts_with("3 of 3 pairs of parts overlap deeply"),
        "{}",
        frames.description
    );
}

#[test]
fn scaled_parts_get_the_units_hint_with_the_factor() {
    let hints = found(machine(0.001));
    let [units] = of_kind(&hints, HintKind::Units)[..] else { panic!("{hints:?}") };
    assert_eq!(units.parts, [0, 1, 2, 3]);
    assert!(units.description.contains("1000 times too small"), "{}", units.description);
    // One shape in inches and in millimetres.
    let nut = cuboid([20.0; 3], [21.0, 21.5, 22.0]);
    let inches = DAffine3::from_scale(DVec3::splat(1.0 / 25.4));
    let parts = vec![part("nut_1", std::slice::from_ref(&nut)), turned("nut_2", &[nut], inches)];
    let hints = found(parts);
    let [units] = of_kind(&hints, HintKind::Units)[..] else { panic!("{hints:?}") };
    assert_eq!(units.parts, [1]);
    assert!(units.description.ends_with("nut_1 has its shape; --scale nut_2=25.4 corrects it"));
}

#[test]
fn millimetre_meshes_in_a_metre_source_get_the_units_hint() {
    // A robot in metres whose base and upper arm have meshes in millimetres.
    let link = |name: &str, at: f64, size: f64| {
        part(name, &[cuboid([-size, -size, at - size], [size, size, at + size])])
    };
    let robot = || {
        vec![
            link("base", 0.0, 120.0),
            link("upper", 0.2, 90.0),
            link("fore", 0.4, 1.0),
            link("hand", 0.3, 0.8),
        ]
    };
    let found = |parts: Vec<Part>, unit: Option<&str>| {
        let assembly = Assembly::new(parts).unwrap();
        let assembly = unit.into_iter().fold(assembly, Assembly::with_unit);
        let bodies = Bodies::new(&assembly, Fit::default_for(&assembly)).unwrap();
        find_hints(&bodies, &Start::new(&bodies, Watch::default()).unwrap())
    };
    let hints = found(robot(), Some("m"));
    assert!(of_kind(&hints, HintKind::Frames).is_empty(), "{hints:?}");
    let [units] = of_kind(&hints, HintKind::Units)[..] else { panic!("{hints:?}") };
    assert_eq!(units.parts, [0, 1]);
    assert_eq!(
        units.description,
        "base, upper may be in millimetres beside parts in metres, 1000 times too large: \
         --scale base=0.001 --scale upper=0.001 corrects it"
    );
    // A source without a unit.
    let hints = found(robot(), None);
    assert!(of_kind(&hints, HintKind::Frames).is_empty(), "{hints:?}");
    assert_eq!(of_kind(&hints, HintKind::Units)[0].parts, [2, 3]);
    // Two links of one shape: the one in metres is right.
    let twins = || vec![link("a", 0.0, 1.0), link("b", 0.0, 1000.0)];
    let hints = found(twins(), Some("m"));
    let units = of_kind(&hints, HintKind::Units)[0];
    assert_eq!(units.parts, [1]);
    assert!(
        units.description.ends_with("1000 times too large: --scale b=0.001 corrects it"),
        "{units:?}"
    );
    assert_eq!(of_kind(&found(twins(), None), HintKind::Units)[0].parts, [0]);
}
