//! Rotating bodies with little play: every query is decided, and its proof holds.

use std::f64::consts::TAU;

use colltrans_convex::{ConvexPolyhedron, Pose};
use colltrans_motion::path::PathOutcome;
use colltrans_motion::{Motion, MotionCast, MotionOutcome};
use colltrans_testkit::oracle::play::{KINDS, Screw, chain, slider};
use glam::DVec3;

#[test]
fn screws_with_little_play_are_decided() {
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
fn arms_near_contact_are_decided() {
    for seed in 0..100 {
        for arm in [chain(seed), slider(seed)] {
            let outcome = arm.judge(20).unwrap_or_else(|wrong| panic!("{seed} {}", wrong.0));
            assert!(!matches!(outcome, PathOutcome::Undecided(_)), "{seed}");
            assert!(outcome.steps().looks < 2_000, "{seed} {:?}", outcome.steps());
        }
    }
}

/// Two cubes make 100 common turns, and one slides along the axis past the other with a play of 1e-9. One carried plane
/// proves the whole motion.
#[test]
fn one_carried_plane_proves_sliding_along_common_axis() {
    let cube = ConvexPolyhedron::cuboid(DVec3::splat(-0.5), DVec3::splat(0.5)).unwrap();
    let beside = Pose::from_translation(DVec3::new(1.0 + 1e-9, 0.2, 0.1)).unwrap();
    let screw = |pose, rise| Motion::screw(pose, DVec3::ZERO, DVec3::Z, 100.0 * TAU, rise).unwrap();
    let (moving, fixed) = (screw(Pose::IDENTITY, 0.7), screw(beside, 0.1));
    let cast = MotionCast::new(cube.with_motion(&moving), cube.with_motion(&fixed)).unwrap();
    let outcome = cast.first_contact().unwrap();
    assert!(matches!(outcome, MotionOutcome::Free(_)), "{outcome:?}");
    assert_eq!(cast.verify(outcome.proof()).unwrap(), [1.0, f64::INFINITY]);
    assert!(outcome.steps().looks <= 3, "{:?}", outcome.steps());
    // The search between solids has the same outcome.
    let solids =
        MotionCast::between_any(cube.with_motion(&moving), cube.with_motion(&fixed)).unwrap();
    let outcome = solids.with_tolerance(0.0).unwrap().first_contact().unwrap();
    assert!(matches!(outcome, MotionOutcome::Free(_)), "{outcome:?}");
}

/// A proof about the bodies as solids holds for the same query only: not with a gap, a depth or additional planes.
#[test]
fn proof_of_solids_is_rejected_for_other_queries() {
    let cube = ConvexPolyhedron::cuboid(DVec3::splat(-0.5), DVec3::splat(0.5)).unwrap();
    let there = Pose::from_translation(DVec3::X * 1.5).unwrap();
    let turn = Motion::rotation_about(Pose::IDENTITY, DVec3::ZERO, DVec3::Z, 0.5).unwrap();
    let rest = Motion::at_rest(there);
    let cast = MotionCast::new(cube.with_motion(&turn), cube.with_motion(&rest)).unwrap();
    let solids = MotionCast::between_any(cube.with_motion(&turn), cube.with_motion(&rest)).unwrap();
    let solids = solids.with_tolerance(0.0).unwrap().certified_first_contact().unwrap();
    let mut proof = cast.first_contact().unwrap().proof().clone();
    proof.spans.clear();
    proof.solids = Some(Box::new(solids.proof().clone()));
    assert_eq!(cast.verify(&proof).unwrap(), [1.0, f64::INFINITY]);
    let kept = cast.clone().with_min_gap(0.6).unwrap();
    assert!(kept.verify(&proof).is_err(), "a cover without a gap does not prove one");
    let deep = cast.clone().with_tolerance(0.1).unwrap();
    assert!(deep.verify(&proof).is_err(), "covers of solids do not prove depths");
    let mut changed = proof.clone();
    changed.spans = vec![Vec::new()];
    assert!(cast.verify(&changed).is_err());
}
