//! Pairs with a fit of their own, compared with bodies that all have this fit, and small machines.

use colltrans::solid::{StartOverlap, Workspace};
use colltrans_assembly::matrix::ContactMatrix;
use colltrans_assembly::plan::{Plan, PlanOptions};
use colltrans_assembly::roles::{PairFit, PairTolerance, Role};
use colltrans_assembly::start::Start;
use colltrans_assembly::suggest::{apply_suggestions, describe_suggestions, suggest_fits};
use colltrans_assembly::{Assembly, AssemblyError, Bodies, Fit, FreeTravel, Part, Piece, Watch};
use colltrans_mesh::Mesh;
use colltrans_testkit::random::Random;
use colltrans_testkit::shapes::{self as testkit, helical, prism};
use glam::{DAffine3, DVec3};

use crate::common::{cuboid, part, scattered, well};

const PRESS: PairFit = PairFit { role: Some(Role::Press), tolerance: None };

fn own(tolerance: f64) -> PairFit {
    PairFit { role: None, tolerance: Some(tolerance) }
}

fn planned(bodies: &Bodies) -> Plan {
    crate::common::planned(bodies, PlanOptions::default().with_samples(0))
}

#[test]
fn pair_tolerance_affects_only_its_pair() {
    let mut random = Random::new(12);
    let (mut asked, mut changed) = (0, 0);
    for round in 0..20 {
        let assembly = scattered(&mut random, 8, round % 2 == 0);
        let general = [1e-6, 0.125][round % 2];
        let plain = Bodies::new(&assembly, Fit::Tolerance(general)).unwrap();
        let mut with = assembly.clone();
        let mut said = Vec::new();
        for _ in 0..6 {
            let (a, b) = (random.index(8), random.index(8));
            let length = [0.0, 0.0625, 0.5, 1.25][random.index(4)];
            let names = [a, b].map(|k| format!("p{k}"));
            if let Ok(next) = with.clone().with_pair([&names[..1], &names[1..]], own(length)) {
                with = next;
                said.retain(|(pair, _)| *pair != [a.min(b), a.max(b)]);
                said.push(([a.min(b), a.max(b)], length));
            }
        }
        let bodies = Bodies::new(&with, Fit::Tolerance(general)).unwrap();
        let mut workspace = Workspace::default();
        let directions = [DVec3::X, DVec3::NEG_Z, random.direction(), random.direction()];
        for (a, b) in (0..8).flat_map(|a| (0..8).map(move |b| (a, b))).filter(|(a, b)| a != b) {
            let length = said.iter().find(|x| x.0 == [a.min(b), a.max(b)]).map(|x| x.1);
            let alike =
                length.map(|length| Bodies::new(&assembly, Fit::Tolerance(length)).unwrap());
            let alike = alike.as_ref().unwrap_or(&plain);
            assert_eq!(bodies.overlaps(a, b), alike.overlaps(a, b));
            for d in directions {
                for start in [StartOverlap::Refuse, StartOverlap::Ignore] {
                    let room = bodies.free_travel([a, b], d, None, start, &mut workspace);
                    assert_eq!(room, alike.free_travel([a, b], d, None, start, &mut workspace));
                    let other = plain.free_travel([a, b], d, None, start, &mut workspace);
                    changed += usize::from(room != other);
                    asked += 1;
                }
            }
        }
        // Only one direction is computed, the other is its mirror image.
        let all = vec![true; 8];
        let watch = Watch::default();
        let both = [DVec3::X, DVec3::NEG_X];
        let matrix = ContactMatrix::new(&bodies, &both, &all, StartOverlap::Refuse, watch).unwrap();
        for met in matrix.contacts_along(1) {
            let pair = [met.moving, met.fixed];
            let room =
                bodies.free_travel(pair, DVec3::NEG_X, None, StartOverlap::Refuse, &mut workspace);
            assert!(room != FreeTravel::Free);
        }
    }
    assert!(asked > 8_000 && changed > 60, "{asked} {changed}");
}

/// With tolerances from chord errors, a pair with its own tolerance gives the results of that tolerance for all
/// parts. All other pairs are unaffected.
#[test]
fn pair_tolerance_overrides_chord_errors_of_its_pair_only() {
    let mut random = Random::new(31);
    let (mut asked, mut changed) = (0, 0);
    for _ in 0..12 {
        let parts = scattered(&mut random, 6, true).parts().to_vec();
        let errors = [0.0, 0.03125, 0.125];
        let mut known = |part: Part| part.with_chord_error(Some(errors[random.index(3)]));
        let assembly = Assembly::new(parts.into_iter().map(&mut known).collect()).unwrap();
        let fit = Fit::default_for(&assembly);
        assert!(matches!(fit, Fit::Chords { .. }), "{fit:?}");
        let names = [["p0"], ["p1"]];
        let with = assembly.clone().with_pair([&names[0], &names[1]], own(0.5)).unwrap();
        let of = |assembly, fit| Bodies::new(assembly, fit).unwrap();
        let (bodies, plain, alike) =
            (of(&with, fit), of(&assembly, fit), of(&assembly, Fit::Tolerance(0.5)));
        let mut workspace = Workspace::default();
        for (a, b) in (0..6).flat_map(|a| (0..6).map(move |b| (a, b))).filter(|(a, b)| a != b) {
            let other = if a + b == 1 { &alike } else { &plain };
            assert_eq!(bodies.overlaps(a, b), other.overlaps(a, b));
            for d in [DVec3::X, DVec3::NEG_Z, random.direction()] {
                let start = StartOverlap::Refuse;
                let room = bodies.free_travel([a, b], d, None, start, &mut workspace);
                assert_eq!(room, other.free_travel([a, b], d, None, start, &mut workspace));
                changed +=
                    usize::from(room != alike.free_travel([a, b], d, None, start, &mut workspace));
                asked += 1;
            }
        }
    }
    assert!(asked > 1_000 && changed > 20, "{asked} {changed}");
}

/// Returns a plate, a pin with a collar pressed into it from below by 0.05, and a cap that overlaps the pin by less.
fn pressed() -> Assembly {
    let plate = well([0.0, 0.0, 0.0], [2.0, 2.0, 2.0], 1.0);
    let pin = [
        cuboid([-0.025, -0.025, -3.0], [2.025, 2.025, 2.0]),
        cuboid([-0.5, -0.5, -3.0], [2.5, 2.5, -2.0]),
    ];
    let cap = [cuboid([-1.0, -1.0, 1.999], [3.0, 3.0, 3.0])];
    let parts =
        vec![part("plate", &plate[1..]).with_fixed(true), part("pin", &pin), part("cap", &cap)];
    Assembly::new(parts).unwrap()
}

#[test]
fn press_fit_is_removable_and_later_contacts_block() {
    let plain = pressed();
    let bodies = Bodies::new(&plain, Fit::Tolerance(0.002)).unwrap();
    assert!(bodies.overlaps(0, 1), "too tight");
    assert!(planned(&bodies).steps.iter().all(|step| step.parts == [2]));
    for (fit, length) in [(PRESS, 0.027), (PairFit { tolerance: Some(0.2), ..PRESS }, 0.2)] {
        let with = plain.clone().with_pair([&["pin"], &["pl*"]], fit).unwrap();
        let bodies = Bodies::new(&with, Fit::Tolerance(0.002)).unwrap();
        assert_eq!(bodies.tolerated_contacts([1, 0]), Some(PairTolerance::Within(length)));
        let plan = planned(&bodies);
        let step = plan.steps.iter().find(|step| step.parts == [1]).unwrap();
        // The collar is at the bottom.
        assert_eq!(step.direction, DVec3::NEG_Z);
        assert_eq!(step.tolerated.len(), 1);
        assert_eq!(
            step.tolerated[0].describe(&with),
            format!("pin and plate: press fit, tolerance {length}")
        );
        assert!(step.ignored.is_empty() && plan.remaining == [0], "{:?}", plan.remaining);
        let (mut workspace, start) = (Workspace::default(), StartOverlap::Refuse);
        let up = bodies.free_travel([1, 0], DVec3::Z, None, start, &mut workspace);
        let FreeTravel::Blocked(stop) = up else { panic!("the collar stops it") };
        assert!((stop.translation.value - 1.0).abs() < 1e-9 && stop.distance() <= 1.0, "{stop:?}");
    }
    // A general tolerance would let the cap sink into the plate by the same amount.
    let wide = Bodies::new(&plain, Fit::Tolerance(0.2)).unwrap();
    assert!(!wide.overlaps(0, 1) && planned(&wide).remaining == [0]);
}

#[test]
fn snap_fit_tolerates_only_early_contacts() {
    let mut random = Random::new(3);
    let mut seen = [0; 3];
    for _ in 0..300 {
        let gap = random.unit();
        let bend = [0.25, 0.5][random.index(2)];
        let wall = cuboid([1.0 + gap, -2.0, -2.0], [2.0 + gap, 3.0, 3.0]);
        let far = cuboid([6.0, -2.0, -2.0], [7.0, 3.0, 3.0]);
        let both = random.unit() < 0.5;
        let frame = if both { vec![wall, far] } else { vec![wall] };
        let parts = vec![part("clip", &[cuboid([0.0; 3], [1.0; 3])]), part("frame", &frame)];
        let snap = PairFit { role: Some(Role::Snap), tolerance: Some(bend) };
        let assembly = Assembly::new(parts).unwrap().with_pair([&["clip"], &["frame"]], snap);
        let assembly = assembly.unwrap();
        let bodies = Bodies::new(&assembly, Fit::Tolerance(0.0)).unwrap();
        let mut workspace = Workspace::default();
        let room = bodies.free_travel([0, 1], DVec3::X, None, StartOverlap::Refuse, &mut workspace);
        let expected = if gap >= bend {
            Some(gap)
        } else if both {
            Some(5.0)
        } else {
            None
        };
        seen[usize::from(gap < bend) + usize::from(gap < bend && both)] += 1;
        match (room, expected) {
            (FreeTravel::Free, None) => (),
            (FreeTravel::Blocked(stop), Some(at)) => {
                assert!((stop.translation.value - at).abs() < 1e-9, "{stop:?}, {at}");
                assert!(stop.distance() <= at);
            }
            other => panic!("{other:?}"),
        }
    }
    assert!(seen.iter().all(|n| *n > 40), "{seen:?}");
    let parts =
        vec![part("a", &[cuboid([0.0; 3], [1.0; 3])]), part("b", &[cuboid([2.0; 3], [3.0; 3])])];
    let snap = PairFit { role: Some(Role::Snap), tolerance: None };
    let none = Assembly::new(parts).unwrap().with_pair([&["a"], &["b"]], snap);
    assert!(matches!(none, Err(AssemblyError::NoTolerance { .. })));
    let parts =
        vec![part("a", &[cuboid([0.0; 3], [1.0; 3])]), part("b", &[cuboid([2.0; 3], [3.0; 3])])];
    let none = Assembly::new(parts).unwrap().with_pair([&["a"], &["b"]], PairFit::default());
    assert!(matches!(none, Err(AssemblyError::NoFit { .. })));
}

#[test]
fn glued_parts_leave_as_one_and_endless_overlap_is_tolerated() {
    let glued = PairFit { role: Some(Role::Glued), tolerance: None };
    let parts = vec![
        part("floor", &[cuboid([0.0, 0.0, -1.0], [9.0, 9.0, 0.0])]),
        part("foot", &[cuboid([1.0, 1.0, 0.0], [3.0, 3.0, 1.0])]),
        part("post", &[cuboid([1.5, 1.5, 0.5], [2.5, 2.5, 4.0])]),
    ];
    let assembly = Assembly::new(parts).unwrap().with_pair([&["foot"], &["post"]], glued).unwrap();
    let bodies = Bodies::new(&assembly, Fit::Tolerance(1e-6)).unwrap();
    let plan = planned(&bodies);
    assert_eq!((plan.steps.len(), plan.steps[0].parts.clone()), (1, vec![1, 2]));
    assert!(plan.interlocked.is_empty() && plan.steps[0].tolerated.is_empty());
    // A sheet through a block: no tolerance ends their overlap.
    let sheet = Mesh::new(
        vec![DVec3::new(1.2, 1.2, -1.0), DVec3::new(1.8, 1.2, -1.0), DVec3::new(1.5, 1.8, 3.0)],
        vec![vec![0, 1, 2]],
    );
    let sheet = Piece { mesh: sheet, world_from_piece: DAffine3::IDENTITY };
    let block = cuboid([1.0, 1.0, 0.0], [3.0, 3.0, 1.0]);
    let soft = PairFit { role: Some(Role::Soft), tolerance: None };
    let parts = vec![part("block", &[block]), Part::new("sheet", &[sheet]).unwrap()];
    let assembly = Assembly::new(parts).unwrap().with_pair([&["block"], &["sheet"]], soft).unwrap();
    let bodies = Bodies::new(&assembly, Fit::Tolerance(1e-6)).unwrap();
    assert_eq!(bodies.tolerated_contacts([0, 1]), Some(PairTolerance::Crossing));
    let plan = planned(&bodies);
    assert!(
        plan.steps[0].tolerated[0].describe(&assembly).contains("crossings at the start tolerated")
    );
}

#[test]
#[ignore = "long: threads of many facets"]
fn thread_is_suggested_only_if_the_nut_surrounds_the_screw() {
    let wave = |phase: f64| 5.0 + 0.6 * (1.0 - (2.0 * phase - 1.0).abs());
    let screw = helical(None, wave, 1.25, 8);
    let nut = helical(Some(9.0), |phase| wave(phase) - 0.1, 1.25, 4);
    let part_of = |name: &str, mesh: &testkit::Mesh| {
        let mesh = Mesh::new(mesh.vertices.clone(), mesh.faces.clone());
        Part::new(name, &[Piece { mesh, world_from_piece: DAffine3::IDENTITY }]).unwrap()
    };
    let beside = cuboid([4.9, -4.0, 0.0], [9.0, 4.0, 5.0]);
    for (other, threaded) in [(part_of("nut", &nut), true), (part("beside", &[beside]), false)] {
        let assembly = Assembly::new(vec![part_of("screw", &screw), other]).unwrap();
        let bodies = Bodies::new(&assembly, Fit::default_for(&assembly)).unwrap();
        let start = Start::new(&bodies, Watch::default()).unwrap();
        assert_eq!(start.overlaps.len(), 1);
        let found = suggest_fits(&bodies, &start);
        let threads = found.iter().filter(|said| said.fit.role == Some(Role::Thread));
        assert_eq!(threads.count(), usize::from(threaded), "{found:?}");
    }
}

fn round(name: &str, sides: usize, radius: f64, low: f64, high: f64) -> Part {
    let shape = prism(sides, (high - low) / 2.0);
    let place = DAffine3::from_translation(DVec3::Z * low.midpoint(high))
        * DAffine3::from_scale(DVec3::new(radius, radius, 1.0));
    let mesh = Mesh::new(shape.vertices, shape.faces);
    Part::new(name, &[Piece { mesh, world_from_piece: place }]).unwrap()
}

/// Returns a ring with a hole of `sides` sides, as one surface.
fn ring(name: &str, sides: usize, [inner, outer]: [f64; 2], height: f64) -> Part {
    let mut vertices = Vec::new();
    for (r, z) in [(inner, 0.0), (outer, 0.0), (outer, height), (inner, height)] {
        vertices.extend((0..sides).map(|k| {
            let angle = std::f64::consts::TAU * (k as f64 + 0.5) / sides as f64;
            DVec3::new(r * angle.cos(), r * angle.sin(), z)
        }));
    }
    let at = |row: usize, k: usize| ((row % 4) * sides + k % sides) as u32;
    let faces = (0..4).flat_map(|row| {
        (0..sides)
            .map(move |k| vec![at(row, k), at(row + 1, k), at(row + 1, k + 1), at(row, k + 1)])
    });
    let mesh = Mesh::new(vertices, faces.collect());
    Part::new(name, &[Piece { mesh, world_from_piece: DAffine3::IDENTITY }]).unwrap()
}

#[test]
fn suggestions_classify_overlaps_and_make_them_removable() {
    let cases: [(&str, f64, Option<Role>, &str); 3] = [
        ("pin", 5.01, Some(Role::Press), "too large"),
        ("pin", 4.995, None, "chord errors"),
        ("o-ring", 5.3, Some(Role::Soft), "says so"),
    ];
    for (name, radius, role, why) in cases {
        let parts = vec![ring("ring", 32, [5.0, 8.0], 4.0), round(name, 48, radius, 1.0, 7.0)];
        let assembly = Assembly::new(parts).unwrap();
        let fit = Fit::default_for(&assembly);
        let bodies = Bodies::new(&assembly, fit).unwrap();
        let start = Start::new(&bodies, Watch::default()).unwrap();
        let found = suggest_fits(&bodies, &start);
        assert_eq!(found.len(), 1, "{name} {radius}");
        assert_eq!(found[0].fit.role, role, "{name} {radius}: {}", found[0].reason);
        assert!(found[0].reason.contains(why), "{}", found[0].reason);
        assert!(planned(&bodies).steps.is_empty());
        let next = apply_suggestions(assembly.clone(), &found).unwrap();
        assert!(next.notes().iter().any(|note| note.contains("taken as suggested")));
        assert_eq!(describe_suggestions(&assembly, &found).len(), 1);
        let bodies = Bodies::new(&next, fit).unwrap();
        let plan = planned(&bodies);
        assert_eq!(plan.steps.len(), 1, "{name} {radius}");
        assert_eq!(plan.steps[0].tolerated[0].role, role);
    }
}
