//! Solids that turn: closed forms, convex bodies as solids against the convex search, exact solids at times on the
//! way, threads; proofs and changed ones; work.

use std::f64::consts::{FRAC_PI_2, TAU};

use colltrans::glam::DVec3;
use colltrans::motion::{Motion, MotionCast, MotionContact, MotionOutcome, SolidMotionProof};
use colltrans::{Cast, ConvexPolyhedron, Pose, Solid};
use colltrans_testkit::random::Random;
use colltrans_testkit::shapes::{Mesh, block, random_hull};
use colltrans_testkit::solids::thread;

fn solid(mesh: &Mesh) -> Solid {
    Solid::from_mesh(&mesh.vertices, &mesh.faces).expect("a solid")
}

fn hull(n: usize, random: &mut Random) -> ConvexPolyhedron {
    ConvexPolyhedron::from_points(&random_hull(n, random).vertices).expect("a body")
}

fn still() -> Motion {
    Motion::still(Pose::IDENTITY)
}

/// The answer with its proof, after all checks that can be made of it.
fn judged(cast: &MotionCast<Solid>, motions: [&Motion; 2]) -> MotionOutcome<SolidMotionProof> {
    let plain = cast.first_contact().expect("an answer");
    let outcome = cast.certified_first_contact().expect("an answer");
    let [lower, upper] = cast.verify(outcome.proof()).unwrap_or_else(|error| panic!("{error}"));
    match (&outcome, &plain) {
        (MotionOutcome::Contact(of), MotionOutcome::Contact(found)) => {
            assert_eq!([of.lower, of.upper], [lower, upper]);
            assert!(of.lower <= found.upper && found.lower <= of.upper, "{of:?} {found:?}");
        }
        (MotionOutcome::Grazing(of), MotionOutcome::Grazing(_)) => assert_eq!(of.lower, lower),
        (MotionOutcome::Overlapping(_), MotionOutcome::Overlapping(_)) => {
            assert_eq!([lower, upper], [0.0; 2]);
        }
        (MotionOutcome::Free(_), MotionOutcome::Free(_)) => {
            assert_eq!([lower, upper], [1.0, f64::INFINITY]);
        }
        _ => panic!("{plain:?} is not {outcome:?}"),
    }
    // The library's own exact decision on the way.
    let bodies = cast.bodies();
    let overlaps = |time: f64| {
        let [a, b] = motions.map(|motion| motion.at(time).expect("a pose"));
        let cast = Cast::new(bodies[0].at(a), bodies[1].at(b), DVec3::Z).expect("a cast");
        cast.with_tolerance(cast_tolerance(&outcome)).expect("a tolerance").overlaps()
    };
    for k in 0..if upper == 0.0 { 0 } else { 50 } {
        let time = lower * f64::from(k) / 50.0;
        assert!(!overlaps(time), "overlap at {time} of {lower}");
    }
    if upper <= 1.0 {
        assert!(overlaps(upper), "no overlap at {upper}");
    }
    outcome
}

fn cast_tolerance(outcome: &MotionOutcome<SolidMotionProof>) -> f64 {
    outcome.proof().tolerance
}

fn contact(outcome: MotionOutcome<SolidMotionProof>) -> MotionContact<SolidMotionProof> {
    match outcome {
        MotionOutcome::Contact(contact) => contact,
        other => panic!("no contact: {other:?}"),
    }
}

#[test]
fn convex_bodies_as_solids_agree_with_the_convex_search() {
    let (mut contacts, mut free, mut most) = (0, 0, 0.0_f64);
    for seed in 0..200 {
        let mut random = Random::new(seed);
        let [p, q] = [hull(12, &mut random), hull(12, &mut random)];
        let from = random.direction() * random.range(2.5, 5.0);
        let pose = Pose::new(random.rotation(), from).expect("a pose");
        let way = (random.vector() * 1.5 - from) * random.range(0.5, 2.0);
        let spin = random.direction() * random.range(0.1, 6.0);
        let along = Motion::thrown(pose, from, way, spin).expect("a motion");
        let other = if random.one_in(3) {
            let pose = Pose::new(random.rotation(), random.vector()).expect("a pose");
            Motion::turn(pose, random.vector(), random.direction(), 3.0).expect("a motion")
        } else {
            Motion::still(Pose::new(random.rotation(), DVec3::ZERO).expect("a pose"))
        };
        let convex = MotionCast::new(p.along(&along), q.along(&other)).expect("a cast");
        let solids = MotionCast::between(p.along(&along), q.along(&other)).expect("a cast");
        match (convex.first_contact().expect("an answer"), judged(&solids, [&along, &other])) {
            (MotionOutcome::Contact(one), MotionOutcome::Contact(two)) => {
                contacts += 1;
                most = most.max((one.lower - two.lower).abs());
                assert!((one.lower - two.lower).abs() < 1e-9, "{seed}: {one:?} {two:?}");
            }
            (MotionOutcome::Free(_), MotionOutcome::Free(_)) => free += 1,
            (MotionOutcome::Overlapping(_), MotionOutcome::Overlapping(_)) => {}
            (one, two) => panic!("{seed}: {one:?} {two:?}"),
        }
    }
    assert!(contacts > 60 && free > 30 && most < 1e-11, "{contacts} {free} {most:e}");
}

#[test]
fn threads() {
    let bolt = solid(&thread([1.0, 0.1, 0.5], [0.0, 2.0], [24, 24], None));
    let nut = solid(&thread([1.04, 0.1, 0.5], [0.6, 1.4], [24, 9], Some(1.5)));
    assert_eq!([&bolt, &nut].map(|solid| solid.triangles().len()), [1_200, 576]);
    let turned = |factor: f64| {
        let turn = Motion::screw(Pose::IDENTITY, DVec3::ZERO, DVec3::Z, TAU, 0.5 * factor);
        let (turn, rest) = (turn.expect("a motion"), still());
        let cast = MotionCast::new(bolt.along(&turn), nut.along(&rest)).expect("a cast");
        judged(&cast, [&turn, &rest])
    };
    assert!(matches!(turned(1.0), MotionOutcome::Free(_)));
    let pitch = contact(turned(0.95));
    assert!(pitch.lower > 0.9 && pitch.upper - pitch.lower < 1e-11, "{pitch:?}");
    let level = contact(turned(0.0));
    assert!(level.lower > 0.05 && level.upper - level.lower < 1e-11, "{level:?}");
}

#[test]
fn a_door_in_its_frame() {
    // The door, hung at the origin, swings shut against a stop that is a part of its frame: the corner (1, 1/8) of
    // its far face meets the stop's face y = 1/2 at sin a + cos a / 8 = 1/2.
    let door = solid(&block([0.0, -0.125, 0.0], [1.0, 0.125, 2.0]));
    let frame = solid(
        &block([0.5, 0.5, -0.5], [1.5, 1.0, 2.5])
            .joined(&block([-0.5, -0.5, -1.5], [1.5, 0.5, -0.5])),
    );
    let swing = Motion::turn(Pose::IDENTITY, DVec3::ZERO, DVec3::Z, FRAC_PI_2).expect("a motion");
    let rest = still();
    let cast = MotionCast::new(door.along(&swing), frame.along(&rest)).expect("a cast");
    let found = contact(judged(&cast, [&swing, &rest]));
    let (r, phase) = ((1.0_f64 + 1.0 / 64.0).sqrt(), 0.125_f64.atan());
    let expected = ((0.5 / r).asin() - phase) / FRAC_PI_2;
    assert!((found.lower - expected).abs() < 1e-11, "{} {expected}", found.lower);
    assert!(found.upper - found.lower < 1e-11, "{:e}", found.upper - found.lower);
}
