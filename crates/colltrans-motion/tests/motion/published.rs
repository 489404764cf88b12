//! Motions that other libraries answer incorrectly, as reported by their users. The settings are reconstructed, and
//! compared with closed forms or samples of the motion.

use std::f64::consts::{FRAC_PI_2, PI};

use colltrans_convex::{ConvexPolyhedron, Pair, Pose};
use colltrans_motion::{Motion, MotionCast, MotionContact, MotionOutcome};
use colltrans_solid::Solid;
use colltrans_testkit::bodies::{at_xyz as at, centered as cuboid, turned};
use glam::{DQuat, DVec3};

type MovingBody<'a> = (&'a ConvexPolyhedron, &'a Motion);

/// Computes the first contact and verifies its proof.
fn verified_outcome([(p, a), (q, b)]: [MovingBody; 2]) -> MotionOutcome {
    let cast = MotionCast::new(p.with_motion(a), q.with_motion(b)).expect("a cast");
    let outcome = cast.first_contact().expect("an answer");
    cast.verify(outcome.proof()).unwrap_or_else(|error| panic!("{error}: {outcome:?}"));
    outcome
}

/// Returns a lower bound of the depth of the bodies at a time.
fn depth([(p, a), (q, b)]: [MovingBody; 2], time: f64) -> f64 {
    let [at, to] = [a, b].map(|motion| motion.pose_at(time).expect("a pose"));
    Pair::new(p.at(at), q.at(to)).expect("a pair").depth().expect("a depth").lower
}

/// Returns the first sampled time at which the bodies overlap; `None` if there is none.
fn first_sample(bodies: [MovingBody; 2], samples: u32) -> Option<f64> {
    let times = (0..=samples).map(|k| f64::from(k) / f64::from(samples));
    times.into_iter().find(|time| depth(bodies, *time) > 1e-9)
}

fn expect_contact(outcome: MotionOutcome) -> MotionContact {
    match outcome {
        MotionOutcome::Contact(contact) => contact,
        other => panic!("no contact: {other:?}"),
    }
}

fn is_free(outcome: &MotionOutcome) -> bool {
    matches!(outcome, MotionOutcome::Free(_))
}

/// parry #317: `cast_shapes_nonlinear` misses the contact of a cuboid that clearly rotates into another. The contact is
/// found at the origin and far from it.
#[test]
fn parry_317_rotating_cuboid_meets_another() {
    let (bar, block) = (cuboid([0.9, 0.12, 0.2]), cuboid([0.3, 0.3, 0.3]));
    let found = [DVec3::ZERO, DVec3::new(512.0, -4096.0, 64.0)].map(|far| {
        let start = Pose::new(DQuat::from_rotation_x(0.2), far).expect("a pose");
        let hinge = far - DVec3::X * 0.9;
        let swing = Motion::rotation_about(start, hinge, DVec3::Z, 1.25).expect("a motion");
        let still = Motion::at_rest(
            Pose::from_translation(far + DVec3::new(0.35, 0.9, 0.05)).expect("a pose"),
        );
        let bodies = [(&bar, &swing), (&block, &still)];
        let found = expect_contact(verified_outcome(bodies));
        let sample = first_sample(bodies, 1_000).expect("they meet");
        assert!(found.lower <= sample && sample <= found.upper + 1e-3, "{sample} {found:?}");
        assert!(found.upper - found.lower < 1e-10);
        [found.lower, found.upper]
    });
    assert!(found[0][0] <= found[1][1] && found[1][0] <= found[0][1], "{found:?}");
}

/// parry #176: continuous collision detection reaches code marked as unreachable. Bodies that touch or overlap slightly
/// at the start, with slow and fast rotation: all queries end, and all proofs hold.
#[test]
fn parry_176_contact_at_start_has_verified_answer() {
    let (p, q) = (cuboid([0.5, 0.5, 0.5]), cuboid([2.0, 0.5, 2.0]));
    for gap in [0.0, 1e-16, -1e-16, 1e-12, -1e-12, 1e-7, -1e-7] {
        for spin in [0.0, 1e-9, 0.3, 6.0, 500.0] {
            for axis in [DVec3::X, DVec3::Y, DVec3::Z, DVec3::new(1.0, 2.0, 3.0)] {
                let start = at(0.0, 1.0 + gap, 0.0);
                let way = DVec3::new(0.1, 0.2, -0.3);
                let thrown = Motion::free_flight(start, start.translation(), way, axis * spin);
                let thrown = thrown.expect("a motion");
                let still = Motion::at_rest(Pose::IDENTITY);
                let outcome = verified_outcome([(&p, &thrown), (&q, &still)]);
                let overlaps = matches!(outcome, MotionOutcome::Overlapping(_));
                assert_eq!(overlaps, gap < -1e-14, "{gap} {spin} {outcome:?}");
            }
        }
    }
}

/// ncollide #369: an endless loop for two cuboids with equal velocities, which never meet.
#[test]
fn ncollide_369_equal_velocities_terminate_as_free() {
    let cube = cuboid([0.5; 3]);
    for gap in [1.0, 1e-3, 1e-9, 1e-12] {
        let [a, b] = [at(0.0, 0.0, 0.0), at(1.0 + gap, 0.0, 0.0)]
            .map(|pose| Motion::translation(pose, DVec3::new(3.0, 4.0, 5.0)).expect("a motion"));
        let outcome = verified_outcome([(&cube, &a), (&cube, &b)]);
        assert!(is_free(&outcome), "{gap}: {outcome:?}");
        assert!(outcome.steps().looks <= 3, "{gap}: {:?}", outcome.steps());
        if gap < 1e-6 {
            continue;
        }
        // With a common rotation, the number of samples grows at most with the inverse square root of the gap.
        let [a, b] = [at(0.0, 0.0, 0.0), at(1.0 + gap, 0.0, 0.0)]
            .map(|pose| Motion::screw(pose, DVec3::Y, DVec3::Z, 3.0, 2.0).expect("a motion"));
        let outcome = verified_outcome([(&cube, &a), (&cube, &b)]);
        assert!(is_free(&outcome), "{gap}: {outcome:?}");
        assert!(f64::from(outcome.steps().looks) <= 6.0 + 2.6 / gap.sqrt(), "{gap}: {outcome:?}");
    }
}

/// `Box2D` #115: a small box passes the corner of a long one and is reported to touch it. With the original angle, 81
/// turns larger, the loop does not end. The numbers are those of the report.
#[test]
fn box2d_115_small_box_passes_corner() {
    let (long, small) = (cuboid([25.0, 5.0, 1.0]), cuboid([2.5, 2.5, 1.0]));
    let still = Motion::at_rest(turned(24.0, -60.0, 2.95));
    let from = DVec3::new(53.474_274, -50.252_514, 0.0);
    let to = DVec3::new(54.595_478, -51.083_473, 0.0);
    let spin = DVec3::Z * (513.627_81 - 513.366_76);
    for whole in [0.0, 162.0 * PI] {
        let start = turned(from.x, from.y, 513.366_76 - 162.0 * PI + whole);
        let thrown = Motion::free_flight(start, from, to - from, spin).expect("a motion");
        let bodies = [(&small, &thrown), (&long, &still)];
        let outcome = verified_outcome(bodies);
        match first_sample(bodies, 2_000) {
            None => assert!(is_free(&outcome), "{outcome:?}"),
            Some(sample) => {
                let found = expect_contact(outcome);
                assert!(found.lower <= sample && sample <= found.upper + 5e-4, "{sample}");
            }
        }
    }
    // With 81 turns during the motion, which are not part of the report.
    let start = turned(from.x, from.y, 513.366_76 - 162.0 * PI);
    let turns =
        Motion::free_flight(start, from, to - from, DVec3::Z * 162.0 * PI).expect("a motion");
    let bodies = [(&small, &turns), (&long, &still)];
    let outcome = verified_outcome(bodies);
    let sample = first_sample(bodies, 20_000);
    assert_eq!(is_free(&outcome), sample.is_none(), "{outcome:?}, but {sample:?}");
    if let Some(sample) = sample {
        let found = expect_contact(outcome);
        assert!(found.lower <= sample && sample <= found.upper + 1e-4, "{sample} {found:?}");
    }
}

/// FCL #555: `continuousCollide` misses the contact of two meshes of boxes that approach each other. As convex bodies
/// and as solids they meet when their gap of 6 is closed at a speed of 8.
#[test]
fn fcl_555_approaching_boxes_meet() {
    let above = ConvexPolyhedron::cuboid(DVec3::new(-1.0, -1.0, 3.0), DVec3::new(1.0, 1.0, 5.0));
    let below = ConvexPolyhedron::cuboid(DVec3::new(-1.0, -1.0, -5.0), DVec3::new(1.0, 1.0, -3.0));
    let [above, below] = [above, below].map(|body| body.expect("a box"));
    let [down, up] = [-4.0, 4.0]
        .map(|way| Motion::translation(Pose::IDENTITY, DVec3::Z * way).expect("a motion"));
    let found = expect_contact(verified_outcome([(&above, &down), (&below, &up)]));
    assert!(found.lower <= 0.75 && 0.75 <= found.upper && found.upper - found.lower < 1e-13);
    assert_eq!(found.normal, Some(DVec3::NEG_Z));
    let solids = [&above, &below].map(|body| Solid::from_convex(body).expect("a solid"));
    let cast =
        MotionCast::new(solids[0].with_motion(&down), solids[1].with_motion(&up)).expect("a cast");
    let outcome = cast.certified_first_contact().expect("an answer");
    // Face to face and edge on edge, no two facets cross, so an upper bound is not required.
    let (MotionOutcome::Contact(solid) | MotionOutcome::Grazing(solid)) = &outcome else {
        panic!("{outcome:?}")
    };
    assert!((solid.lower - 0.75).abs() < 1e-11, "{solid:?}");
    let [lower, _] = cast.verify(outcome.proof()).expect("a proof");
    assert_eq!(lower, solid.lower);
}

/// FCL #120: conservative advancement of translated boxes fails in most modes. Closed forms: contacts of a corner, an
/// edge and a face, and boxes that miss.
#[test]
fn fcl_120_translated_boxes_match_closed_forms() {
    let cube = cuboid([0.5; 3]);
    let still = Motion::at_rest(Pose::IDENTITY);
    let query = |start: Pose, way: DVec3| {
        verified_outcome([
            (&cube, &Motion::translation(start, way).expect("a motion")),
            (&cube, &still),
        ])
    };
    let diagonal = 0.5_f64.sqrt();
    for (start, way, expected) in [
        (at(-5.0, 0.25, 0.125), DVec3::X * 10.0, 0.4),
        (at(-5.0, 0.25, -0.125), DVec3::X * 4.5, 4.0 / 4.5),
        (turned(-5.0, 0.0, FRAC_PI_2 / 2.0), DVec3::X * 10.0, (4.5 - diagonal) / 10.0),
        (at(-3.0, -3.0, -3.0), DVec3::splat(8.0), 0.25),
    ] {
        let found = expect_contact(query(start, way));
        assert!(found.lower <= expected + 1e-15 && expected <= found.upper + 1e-15, "{found:?}");
        assert!(found.upper - found.lower < 1e-13, "{found:?}");
    }
    for (start, way) in [
        (at(-5.0, 1.0 + 1e-9, 0.0), DVec3::X * 10.0),
        (at(-5.0, 0.0, 0.0), DVec3::X * (4.0 - 1e-9)),
        (at(-5.0, 0.0, 0.0), DVec3::NEG_X * 10.0),
    ] {
        let outcome = query(start, way);
        assert!(is_free(&outcome), "{outcome:?}");
    }
}

/// godot-jolt #389: a rotating bat passes through a ball, because nothing is cast without a translation. The contact is
/// found, although both ends of the motion are free.
#[test]
fn godot_jolt_389_rotating_bat_hits_ball() {
    let bat = ConvexPolyhedron::cuboid(DVec3::new(0.1, -0.04, -0.04), DVec3::new(1.1, 0.04, 0.04));
    let bat = bat.expect("a bat");
    let golden = PI * (5.0_f64.sqrt() - 1.0);
    let ball: Vec<DVec3> = (0..200)
        .map(|k| {
            let z = 1.0 - (f64::from(k) + 0.5) / 100.0;
            let r = (1.0 - z * z).sqrt();
            let angle = golden * f64::from(k);
            DVec3::new(r * angle.cos(), r * angle.sin(), z) * 0.1
        })
        .collect();
    let ball = ConvexPolyhedron::from_points(&ball).expect("a ball");
    for (place, angle) in [(DVec3::Y * 0.9, PI), (DVec3::Y * 0.9, -PI), (DVec3::Y * 1.15, PI)] {
        let swing =
            Motion::rotation_about(Pose::IDENTITY, DVec3::ZERO, DVec3::Z, angle).expect("a motion");
        let still = Motion::at_rest(Pose::from_translation(place).expect("a pose"));
        let bodies = [(&bat, &swing), (&ball, &still)];
        assert!(depth(bodies, 0.0) == 0.0 && depth(bodies, 1.0) == 0.0);
        let outcome = verified_outcome(bodies);
        if angle < 0.0 {
            assert!(is_free(&outcome), "{outcome:?}");
            continue;
        }
        let found = expect_contact(outcome);
        let sample = first_sample(bodies, 2_000).expect("they meet");
        assert!(found.lower <= sample && sample <= found.upper + 5e-4, "{sample} {found:?}");
        // The ball lies inside a sphere, which the bat meets first.
        let sphere = FRAC_PI_2 - ((0.04_f64 + 0.1) / place.y).asin();
        assert!(found.lower > sphere / PI - 1e-9 || place.y > 1.0, "{found:?}");
    }
}
