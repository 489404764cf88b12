//! Unscrewing: bolts in nuts with known threads. Each move is compared with poses of the bodies themselves.

use std::f64::consts::TAU;

use colltrans_assembly::candidates::{CandidateOptions, find_candidates};
use colltrans_assembly::liaisons::find_liaisons;
use colltrans_assembly::matrix::ContactMatrix;
use colltrans_assembly::plan::{Leg, Plan, PlanOptions, Turn, disassemble};
use colltrans_assembly::roles::{PairFit, Role};
use colltrans_assembly::{Assembly, Bodies, Fit, Part, Piece, Watch, record};
use colltrans_mesh::Mesh;
use colltrans_testkit::shapes::{self, helical};
use glam::{DAffine3, DQuat, DVec3};

use crate::common::{cuboid, part};

const THREAD: PairFit = PairFit { role: Some(Role::Thread), tolerance: None };
const FIT: Fit = Fit::Tolerance(1e-6);

/// Returns a triangle wave, from 0 to 1 and back.
fn wave(phase: f64) -> f64 {
    1.0 - (2.0 * phase - 1.0).abs()
}

fn piece(mesh: shapes::Mesh, world_from_piece: DAffine3) -> Piece {
    Piece { mesh: Mesh::new(mesh.vertices, mesh.faces), world_from_piece }
}

/// Returns a screw of four turns from `z = 0` on, with radii from 5 to 5.6.
fn screw(pitch: f64) -> shapes::Mesh {
    helical(None, |phase| 5.0 + 0.6 * wave(phase), pitch, 4)
}

/// Returns a nut of two turns with the given radial play.
fn nut(pitch: f64, play: f64) -> shapes::Mesh {
    helical(Some(9.0), |phase| 5.0 + play + 0.6 * wave(phase), pitch, 2)
}

/// Returns the pose of a nut through which the screw reaches on both sides.
fn through(pitch: f64) -> DAffine3 {
    DAffine3::from_translation(DVec3::Z * pitch.abs())
}

fn turned(by: f64, aside: DVec3) -> DAffine3 {
    DAffine3::from_translation(aside) * DAffine3::from_rotation_z(TAU * by)
}

fn bolted(screw: &[Piece], nut: &[Piece]) -> Assembly {
    let parts = vec![part("screw", screw), part("nut", nut)];
    Assembly::new(parts).unwrap().with_pair([&["screw"], &["nut"]], THREAD).unwrap()
}

fn planned(bodies: &Bodies) -> Plan {
    let watch = Watch::default();
    let touching = find_liaisons(bodies, watch).unwrap();
    let choice =
        CandidateOptions::default().with_given(vec![DVec3::Z, DVec3::NEG_Z]).with_search(false);
    let found = find_candidates(bodies, &touching, &choice).unwrap();
    let (all, options) = (vec![true; bodies.len()], PlanOptions::default().with_samples(0));
    let matrix =
        ContactMatrix::new(bodies, &found.directions(), &all, options.start, watch).unwrap();
    disassemble(bodies, &matrix, &found.finer, options.with_proofs(false), watch).unwrap()
}

/// Returns the turn of the only step of a complete plan.
fn turn(plan: &Plan) -> (&Leg, &Turn) {
    assert!(plan.interlocked.is_empty() && plan.steps.len() == 1, "{plan:?}");
    let leg = &plan.steps[0].path[0];
    (leg, leg.turn.as_ref().unwrap())
}

fn check_turn_is_free(assembly: &Assembly, plan: &Plan) {
    let others: Vec<usize> =
        (0..assembly.parts().len()).filter(|k| !plan.steps[0].parts.contains(k)).collect();
    crate::common::turns_freely(assembly, &plan.steps[0], &others);
}

#[test]
#[ignore = "long: many facets that turn"]
fn screw_with_play_is_unscrewed_without_extra_tolerance() {
    for (pitch, fixed) in [(1.0, "screw"), (-1.25, "nut")] {
        // The nut is in the middle, equally far from both ends.
        let nut = vec![piece(nut(pitch, 0.2), through(pitch))];
        let assembly = bolted(&[piece(screw(pitch), DAffine3::IDENTITY)], &nut);
        let assembly = assembly.with_fixed(&[fixed]).unwrap();
        let plan = planned(&Bodies::new(&assembly, FIT).unwrap());
        let (leg, turn) = turn(&plan);
        assert!(turn.proof.as_ref().is_ok_and(|proof| proof.tolerance == 1e-6), "{turn:?}");
        assert_eq!((turn.initial_turns, turn.offset), (0.0, DVec3::ZERO));
        // From one end of the screw to the other end of the nut, and hardly farther: the axis is computed from
        // facets.
        let way = 3.0 * pitch.abs();
        assert!((way..1.01 * way).contains(&leg.travel), "{leg:?}");
        assert!((turn.turns - leg.travel / pitch).abs() < 0.03, "{turn:?}");
        check_turn_is_free(&assembly, &plan);
    }
}

#[test]
#[ignore = "long: many facets that turn"]
fn thread_without_play_needs_the_chord_tolerance() {
    let nut = vec![piece(nut(1.0, 0.0), through(1.0))];
    let assembly = bolted(&[piece(screw(1.0), DAffine3::IDENTITY)], &nut);
    let plan = planned(&Bodies::new(&assembly, FIT).unwrap());
    let (_, turn) = turn(&plan);
    let tolerance = turn.proof.as_ref().unwrap().tolerance;
    // The chord error of 24 sides is 0.048; the thread is 0.6 deep.
    assert!((1e-6..0.15).contains(&tolerance), "{tolerance}");
    check_turn_is_free(&assembly, &plan);
    // With a smaller tolerance it is not proven.
    let said = PairFit { tolerance: Some(1e-4), ..THREAD };
    let tight = assembly.with_pair([&["screw"], &["nut"]], said).unwrap();
    let plan = planned(&Bodies::new(&tight, FIT).unwrap());
    let why = plan.steps[0].first_turn().unwrap().proof.clone().unwrap_err();
    assert!(why.contains("the maximum tolerance is 1.00e-4"), "{why}");
}

#[test]
#[ignore = "long: many facets that turn"]
fn misaligned_screw_starts_from_its_best_pose() {
    for (by, aside) in [(0.3, DVec3::ZERO), (-0.2, DVec3::new(0.1, -0.15, 0.0))] {
        let nut = vec![piece(nut(1.0, 0.2), through(1.0))];
        let assembly = bolted(&[piece(screw(1.0), turned(by, aside))], &nut);
        let bodies = Bodies::new(&assembly, FIT).unwrap();
        let plan = planned(&bodies);
        let (leg, turn) = turn(&plan);
        let sense = leg.direction.z * if plan.steps[0].parts == [0] { 1.0 } else { -1.0 };
        assert!((turn.initial_turns * sense + by).abs() < 0.1, "{turn:?}");
        assert!((turn.offset.length() - aside.length()).abs() < 0.05, "{turn:?}");
        check_turn_is_free(&assembly, &plan);
        let told = record::plan_json(&bodies, &plan);
        let leg = &told["plan"][0]["path"][0]["turn"];
        assert_eq!(leg["proof"]["tolerance"], 1e-6);
        assert!((leg["pitch"].as_f64().unwrap() - 1.0).abs() < 0.01);
        assert!(leg["turns"].as_f64().unwrap() > 2.9);
    }
}

#[test]
#[ignore = "long: many facets that turn"]
fn unproven_turn_reports_the_reason() {
    let own = || vec![piece(screw(1.0), DAffine3::IDENTITY)];
    let plain = piece(helical(Some(9.0), |_| 5.2, 1.0, 2), through(1.0));
    let plan = planned(&Bodies::new(&bolted(&own(), &[plain]), FIT).unwrap());
    let why = turn(&plan).1.proof.clone().unwrap_err();
    assert_eq!(why, "the hole of nut has no thread and is narrower than the thread of screw");
    // A wing that can be pulled past a wall, but not turned past it.
    let wing = [own(), vec![cuboid([0.0, -1.0, 4.0], [12.0, 1.0, 6.0])]].concat();
    let assembly = bolted(&wing, &[piece(nut(1.0, 0.2), through(1.0))]);
    let mut parts: Vec<Part> = assembly.parts().to_vec();
    parts.push(part("wall", &[cuboid([8.0, 2.0, 3.5], [14.0, 4.0, 20.0])]));
    let assembly = Assembly::new(parts).unwrap().with_fixed(&["nut", "wall"]).unwrap();
    let assembly = assembly.with_pair([&["screw"], &["nut"]], THREAD).unwrap();
    let plan = planned(&Bodies::new(&assembly, FIT).unwrap());
    let why = turn(&plan).1.proof.clone().unwrap_err();
    assert!(why.starts_with("after 0.") && why.ends_with("of screw and wall collide"), "{why}");
}

#[test]
#[ignore = "long: many facets that turn"]
fn identical_screws_form_one_stage() {
    let plate = [10.0, 30.0].map(|x| {
        let place = DAffine3::from_translation(DVec3::X * x);
        [piece(nut(1.0, 0.2), place * through(1.0)), piece(screw(1.0), place)]
    });
    let [[a, first], [b, second]] = plate;
    let parts = vec![part("plate", &[a, b]), part("screw_1", &[first]), part("screw_2", &[second])];
    let assembly = Assembly::new(parts).unwrap().with_fixed(&["plate"]).unwrap();
    let assembly = assembly.with_pair([&["screw_*"], &["plate"]], THREAD).unwrap();
    let bodies = Bodies::new(&assembly, FIT).unwrap();
    let plan = planned(&bodies);
    let stages = plan.stages();
    assert_eq!((stages.len(), plan.steps.len()), (1, 2));
    assert_eq!(plan.describe_stage(&assembly, &stages[0]), "2 x screw");
    assert!(plan.steps.iter().all(|step| step.first_turn().unwrap().proof.is_ok()));
}

#[test]
#[ignore = "long: many facets that turn"]
fn moved_point_follows_the_screw_motion() {
    let nut = vec![piece(nut(1.0, 0.2), through(1.0))];
    let plan = planned(
        &Bodies::new(&bolted(&[piece(screw(1.0), turned(0.3, DVec3::ZERO))], &nut), FIT).unwrap(),
    );
    let (leg, turn) = turn(&plan);
    let p = DVec3::new(5.0, 1.0, 2.0);
    let angle = TAU * (turn.initial_turns + turn.turns * 0.5);
    let wanted =
        DQuat::from_axis_angle(leg.direction, angle) * p + leg.direction * (leg.travel / 2.0);
    assert!(leg.move_point(p, 0.5).distance(wanted) < 0.01, "{leg:?}");
}

/// Returns a socket whose ring blocks two lugs except at a slot at an angle `at`, slightly wider than the lugs.
fn socket(at: f64) -> Vec<Piece> {
    let slot = DAffine3::from_rotation_z(at);
    let mut pieces = vec![cuboid([-12.0, -12.0, -2.0], [12.0, 12.0, -1.0])];
    // The ring next to the slot, in two halves of one block each, without the hole for the shaft.
    for side in [-1.0, 1.0] {
        let [low, high] = if side < 0.0 { [-9.0, -1.1] } else { [1.1, 9.0] };
        let half = cuboid([-9.0, low, 1.5], [9.0, high, 2.5]);
        pieces.push(Piece { world_from_piece: slot, ..half });
    }
    // Walls that support the ring.
    for k in 0..4 {
        let turned = DAffine3::from_rotation_z(TAU / 4.0 * f64::from(k));
        let wall = cuboid([9.5, -12.0, -1.0], [12.0, 12.0, 3.0]);
        pieces.push(Piece { world_from_piece: turned, ..wall });
    }
    // Lids over all but the middle, so that the ring is not a part of its own.
    pieces.push(cuboid([-12.0, 8.0, 2.0], [12.0, 12.0, 3.0]));
    pieces.push(cuboid([-12.0, -12.0, 2.0], [12.0, -8.0, 3.0]));
    pieces
}

/// Returns a plug with two lugs on its shaft, which lie under the ring.
fn plug() -> Vec<Piece> {
    vec![cuboid([-0.7, -0.7, -0.9], [0.7, 0.7, 6.0]), cuboid([-6.0, -1.0, 0.0], [6.0, 1.0, 1.4])]
}

#[test]
fn bayonet_is_turned_and_then_pulled() {
    let parts = vec![part("socket", &socket(0.7)), part("plug", &plug())];
    let assembly = Assembly::new(parts).unwrap().with_fixed(&["socket"]).unwrap();
    let bodies = Bodies::new(&assembly, FIT).unwrap();
    let plan = planned(&bodies);
    let (leg, turn) = turn(&plan);
    assert_eq!((leg.travel, plan.steps[0].parts[0]), (0.0, 1));
    assert!(plan.steps[0].direction.z > 0.999);
    // The slot is 0.1 wider on each side, at a radius of 6.
    let angle = TAU * turn.turns * leg.direction.z;
    assert!(
        (angle - 0.7).abs() < 0.02 || (angle + std::f64::consts::PI - 0.7).abs() < 0.02,
        "{turn:?}"
    );
    check_turn_is_free(&assembly, &plan);
    // Without the slot there is no removal path.
    let closed = [
        socket(0.7),
        vec![
            cuboid([-9.0, -9.0, 1.5], [-1.6, 9.0, 2.5]),
            cuboid([1.6, -9.0, 1.5], [9.0, 9.0, 2.5]),
        ],
    ]
    .concat();
    let assembly = Assembly::new(vec![part("socket", &closed), part("plug", &plug())]).unwrap();
    let assembly = assembly.with_fixed(&["socket"]).unwrap();
    let plan = planned(&Bodies::new(&assembly, FIT).unwrap());
    assert!(plan.steps.is_empty(), "{plan:?}");
}

/// A pair that looks like a thread and a snap fit: the name decides, and it gets one role.
#[test]
fn name_of_a_ring_decides_snap_over_thread() {
    let roles = |name: &str| {
        let nut = part("nut", &[piece(nut(2.0, 0.05), DAffine3::IDENTITY)]);
        let ring = part(name, &[piece(screw(2.0), through(2.0))]);
        let assembly = Assembly::new(vec![nut, ring]).unwrap();
        let found = crate::common::suggested(&Bodies::new(&assembly, FIT).unwrap());
        found.into_iter().map(|s| (s.parts, s.fit.role)).collect::<Vec<_>>()
    };
    assert_eq!(roles("screw"), [([0, 1], Some(Role::Thread))]);
    assert_eq!(roles("Circlip DIN 472"), [([0, 1], Some(Role::Snap))]);
}
