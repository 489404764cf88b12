//! Bodies that turn with little play between them: all have an answer, whose proof holds.

use std::f64::consts::TAU;

use colltrans_convex::{ConvexPolyhedron, Pose};
use colltrans_motion::path::PathOutcome;
use colltrans_motion::{Motion, MotionCast, MotionOutcome};
use colltrans_testkit::oracle::play::{KINDS, Screw, chain, slider};
use glam::DVec3;

#[test]
fn screws_with_little_play_have_an_answer() {
    for (kind, name) in KINDS.into_iter().enumerate() {
        for seed in 0..40 {
            let screw = Screw::random(kind, seed);
            let outcome = screw.judge().unwrap_or_else(|wrong| panic!("{name}:{seed} {}", wrong.0));
            assert!(!matches!(outcome, MotionOutcome::Undecided(_)), "{name}:{seed}");
            assert!(outcome.steps().looks < 4_000, "{name}:{seed} {:?}", outcome.steps());
        }
    }
}

#[test]
fn arms_near_a_touch_have_an_answer() {
    for seed in 0..100 {
        for arm in [chain(seed), slider(seed)] {
            let outcome = arm.judge(20).unwrap_or_else(|wrong| panic!("{seed} {}", wrong.0));
            assert!(!matches!(outcome, PathOutcome::Undecided(_)), "{seed}");
            assert!(outcome.steps().looks < 2_000, "{seed} {:?}", outcome.steps());
        }
    }
}

/// Two cubes that spin as one by 100 turns, one of which slides along the axis past the other with a play of 1e-9: one
/// plane that both carry along proves all of it.
#[test]
fn a_plane_is_carried_along_while_one_body_slides_along_the_axis() {
    let cube = ConvexPolyhedron::cuboid(DVec3::splat(-0.5), DVec3::splat(0.5)).unwrap();
    let beside = Pose::from_translation(DVec3::new(1.0 + 1e-9, 0.2, 0.1)).unwrap();
    let screw = |pose, rise| Motion::screw(pose, DVec3::ZERO, DVec3::Z, 100.0 * TAU, rise).unwrap();
    let (moving, fixed) = (screw(Pose::IDENTITY, 0.7), screw(beside, 0.1));
    let cast = MotionCast::new(cube.along(&moving), cube.along(&fixed)).unwrap();
    let outcome = cast.first_contact().unwrap();
    assert!(matches!(outcome, MotionOutcome::Free(_)), "{outcome:?}");
    assert_eq!(cast.verify(outcome.proof()).unwrap(), [1.0, f64::INFINITY]);
    assert!(outcome.steps().looks <= 3, "{:?}", outcome.steps());
    // Solids answer the same.
    let solids = MotionCast::between(cube.along(&moving), cube.along(&fixed)).unwrap();
    let outcome = solids.tolerating(0.0).unwrap().first_contact().unwrap();
    assert!(matches!(outcome, MotionOutcome::Free(_)), "{outcome:?}");
}

/// A proof about the bodies as solids counts for the same question alone: not with a gap, a depth, or planes beside it.
#[test]
fn a_changed_proof_of_solids_is_refused() {
    let cube = ConvexPolyhedron::cuboid(DVec3::splat(-0.5), DVec3::splat(0.5)).unwrap();
    let there = Pose::from_translation(DVec3::X * 1.5).unwrap();
    let turn = Motion::turn(Pose::IDENTITY, DVec3::ZERO, DVec3::Z, 0.5).unwrap();
    let rest = Motion::still(there);
    let cast = MotionCast::new(cube.along(&turn), cube.along(&rest)).unwrap();
    let solids = MotionCast::between(cube.along(&turn), cube.along(&rest)).unwrap();
    let solids = solids.tolerating(0.0).unwrap().certified_first_contact().unwrap();
    let mut proof = cast.first_contact().unwrap().proof().clone();
    proof.spans.clear();
    proof.solids = Some(Box::new(solids.proof().clone()));
    assert_eq!(cast.verify(&proof).unwrap(), [1.0, f64::INFINITY]);
    let kept = cast.clone().keeping(0.6).unwrap();
    assert!(kept.verify(&proof).is_err(), "a cover without a gap proves none");
    let deep = cast.clone().tolerating(0.1).unwrap();
    assert!(deep.verify(&proof).is_err(), "solids say nothing of depths");
    let mut changed = proof.clone();
    changed.spans = vec![Vec::new()];
    assert!(cast.verify(&changed).is_err());
}
