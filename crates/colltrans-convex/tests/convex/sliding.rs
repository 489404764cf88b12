//! Unit cubes that slide past each other with a small lateral gap never count as contact.

use colltrans_convex::{Cast, Clearance, ConvexPolyhedron, FreeReason, Outcome, Pose, Solver};
use colltrans_testkit::oracle::check::Judge;
use colltrans_testkit::random::Random;
use colltrans_testkit::shapes::cuboid;
use glam::{DQuat, DVec3};

/// Cubes one above the other along x with a gap beside them, turned as a whole by `rotation`.
fn slide(gap: f64, rotation: DQuat, start: DVec3, origin: DVec3) {
    let cube = ConvexPolyhedron::from_points(&cuboid(DVec3::splat(0.5)).vertices).expect("a body");
    let pose = |v: DVec3| Pose::new(rotation, origin + rotation * v).expect("a pose");
    let (fixed_pose, moving_pose) = (pose(DVec3::ZERO), pose(start + DVec3::Y * (1.0 + gap)));
    let direction = rotation * DVec3::X;
    let cast = Cast::new(cube.at(moving_pose), cube.at(fixed_pose), direction).expect("a query");
    let judge = Judge::new(cast);
    for solver in [Solver::Cta, Solver::Portal] {
        let cast = cast.with_solver(solver);
        let outcome =
            cast.first_contact().unwrap_or_else(|e| panic!("gap {gap:e}, {solver:?}: {e}"));
        judge.check(&outcome).unwrap_or_else(|e| panic!("gap {gap:e}, {solver:?}: {e}"));
        assert!(
            matches!(outcome, Outcome::Separated(_)),
            "gap {gap:e}, rotation {rotation}, start {start}, {solver:?}: {outcome:?}"
        );
        let clearance = cast.clearance();
        assert!(
            matches!(clearance, Ok(Clearance::Free(FreeReason::Separated(_)))),
            "{clearance:?}"
        );
    }
}

const GAPS: [f64; 6] = [1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12];

#[test]
fn aligned_cubes() {
    for gap in GAPS {
        for x in [-20.0, -3.0, -1.0, -0.5, 0.0, 0.3, 1.0, 8.0] {
            for z in [0.0, 0.25, -0.99, 1.0 - 1e-9] {
                slide(gap, DQuat::IDENTITY, DVec3::new(x, 0.0, z), DVec3::ZERO);
            }
        }
    }
}

#[test]
fn turned_cubes() {
    let mut rng = Random::new(2);
    for gap in GAPS {
        for _ in 0..300 {
            let start = DVec3::new(rng.range(-20.0, 20.0), 0.0, rng.range(-1.0, 1.0));
            slide(gap, rng.rotation(), start, DVec3::ZERO);
        }
    }
}

/// Away from the origin of the world a gap must be larger than what its coordinates can express.
#[test]
fn turned_cubes_far_from_the_origin() {
    let mut rng = Random::new(3);
    for gap in &GAPS[..5] {
        for _ in 0..100 {
            let start = DVec3::new(rng.range(-20.0, 20.0), 0.0, rng.range(-1.0, 1.0));
            slide(*gap, rng.rotation(), start, rng.vector() * 1e4);
        }
    }
}

/// No gap at all: the cubes touch all the way, and still nothing blocks.
#[test]
fn cubes_without_a_gap_graze() {
    let cube = ConvexPolyhedron::from_points(&cuboid(DVec3::splat(0.5)).vertices).expect("a body");
    let pose = Pose::from_translation(DVec3::new(-3.0, 1.0, 0.25)).expect("a pose");
    let world = Pose::IDENTITY;
    let outcome = colltrans_convex::cast(&cube, &pose, &cube, &world, DVec3::X).expect("an answer");
    let Outcome::Grazing(grazing) = outcome else { panic!("{outcome:?}") };
    assert!((grazing.contact.translation - 2.0).abs() <= grazing.contact.certificate.rounding);
    assert!(grazing.separating_direction.distance(DVec3::NEG_Y) < 1e-12);
    let cast = Cast::new(cube.at(pose), cube.at(world), DVec3::X).expect("a query");
    assert_eq!(cast.clearance(), Ok(Clearance::Free(FreeReason::Slides(grazing))));
}
