//! Solids in motion: closed forms, convex bodies as solids against the convex search, exact overlaps at sampled times,
//! screw threads, proofs and modified proofs, counts of work.

use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::mem;

use colltrans_convex::{Cast, ConvexPolyhedron, Outcome, Pose};
use colltrans_motion::{
    FacetContact, FacetContactProof, Motion, MotionCast, MotionContact, MotionCover, MotionOutcome,
    SolidMotionProof,
};
use colltrans_solid::{Solid, SolidCast};
use colltrans_testkit::bodies::{hull, solid};
use colltrans_testkit::cases;
use colltrans_testkit::oracle::solids::turning;
use colltrans_testkit::random::Random;
use colltrans_testkit::shapes::{Mesh, block};
use colltrans_testkit::solids::{pin, thread, washer};
use glam::{DQuat, DVec3};

fn rest_motion() -> Motion {
    Motion::at_rest(Pose::IDENTITY)
}

/// Computes the certified first contact and checks it: its proof, and exact overlaps at sampled times.
fn checked_outcome(
    cast: &MotionCast<Solid>,
    motions: [&Motion; 2],
) -> MotionOutcome<SolidMotionProof> {
    checked_outcome_with_gap(cast, motions, 0.0)
}

/// Computes and checks the first contact of a cast with a minimum gap.
fn checked_outcome_with_gap(
    cast: &MotionCast<Solid>,
    motions: [&Motion; 2],
    gap: f64,
) -> MotionOutcome<SolidMotionProof> {
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
    // Exact decisions of the library at sampled times.
    let bodies = cast.bodies();
    let overlaps = |time: f64| {
        let [a, b] = motions.map(|motion| motion.pose_at(time).expect("a pose"));
        let cast = Cast::new(bodies[0].at(a), bodies[1].at(b), DVec3::Z).expect("a cast");
        let cast = cast.with_tolerance(tolerance_of(&outcome)).expect("a tolerance");
        cast.with_min_gap(gap).expect("a gap").overlaps()
    };
    for k in 0..if upper == 0.0 { 0 } else { 50 } {
        let time = lower * f64::from(k) / 50.0;
        assert!(!overlaps(time), "overlap at {time} of {lower}");
    }
    // With a gap, a proven contact need not be an overlap.
    if upper <= 1.0 && gap == 0.0 {
        assert!(overlaps(upper), "no overlap at {upper}");
    }
    outcome
}

fn tolerance_of(outcome: &MotionOutcome<SolidMotionProof>) -> f64 {
    outcome.proof().tolerance
}

fn expect_contact(outcome: MotionOutcome<SolidMotionProof>) -> MotionContact<SolidMotionProof> {
    match outcome {
        MotionOutcome::Contact(contact) => contact,
        other => panic!("no contact: {other:?}"),
    }
}

#[test]
fn convex_bodies_as_solids_match_convex_search() {
    let (mut contacts, mut free, mut most) = (0, 0, 0.0_f64);
    for seed in 0..200 {
        let mut random = Random::new(seed);
        let [p, q] = [hull(12, &mut random), hull(12, &mut random)];
        let from = random.direction() * random.range(2.5, 5.0);
        let pose = Pose::new(random.rotation(), from).expect("a pose");
        let way = (random.vector() * 1.5 - from) * random.range(0.5, 2.0);
        let spin = random.direction() * random.range(0.1, 6.0);
        let along = Motion::free_flight(pose, from, way, spin).expect("a motion");
        let other = if random.one_in(3) {
            let pose = Pose::new(random.rotation(), random.vector()).expect("a pose");
            Motion::rotation_about(pose, random.vector(), random.direction(), 3.0)
                .expect("a motion")
        } else {
            Motion::at_rest(Pose::new(random.rotation(), DVec3::ZERO).expect("a pose"))
        };
        let convex = MotionCast::new(p.with_motion(&along), q.with_motion(&other)).expect("a cast");
        let solids =
            MotionCast::between_any(p.with_motion(&along), q.with_motion(&other)).expect("a cast");
        match (
            convex.first_contact().expect("an answer"),
            checked_outcome(&solids, [&along, &other]),
        ) {
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

/// Convex solids are searched by their hulls, and the same bodies as two shells in one place by their trees.
#[test]
fn convex_solids_match_the_search_of_trees() {
    let (mut contacts, mut free, mut lists) = (0, 0, 0);
    for seed in 0..cases(160) {
        let random = &mut Random::new(seed);
        let body = |random: &mut Random| {
            let convex = match random.index(3) {
                0 => ConvexPolyhedron::cuboid(DVec3::splat(-0.5), random.vector().abs() + 0.1),
                1 => Ok(hull(60, random)),
                _ => Ok(hull(8, random)),
            };
            Solid::from_convex(&convex.expect("a body")).expect("a solid")
        };
        let once = [body(random), body(random)];
        let twice = once.each_ref().map(|b| Solid::from_pieces([b, b]).expect("two shells"));
        let turn = |random: &mut Random| {
            if random.one_in(3) { DQuat::IDENTITY } else { random.rotation() }
        };
        let from = random.direction() * random.range(2.0, 4.0);
        let pose = Pose::new(turn(random), from).expect("a pose");
        let way = (random.vector() * random.range(1.0, 4.0) - from) * random.range(0.5, 2.0);
        let spin = random.direction() * if random.one_in(3) { 0.0 } else { random.range(0.1, 5.0) };
        let along = Motion::free_flight(pose, from, way, spin).expect("a motion");
        let rest = Motion::at_rest(Pose::new(turn(random), DVec3::ZERO).expect("a pose"));
        let gap = if random.one_in(4) { random.range(0.0, 0.4) } else { 0.0 };
        let tolerance = [None, Some(0.0), Some(1e-7), Some(0.01)][random.index(4)];
        let cast = |[p, q]: &[Solid; 2]| -> MotionOutcome<SolidMotionProof> {
            let cast = MotionCast::new(p.with_motion(&along), q.with_motion(&rest));
            let mut cast = cast.and_then(|cast| cast.with_min_gap(gap)).expect("a cast");
            if let Some(tolerance) = tolerance {
                cast = cast.with_tolerance(tolerance).expect("a tolerance");
            }
            checked_outcome_with_gap(&cast, [&along, &rest], gap)
        };
        let [one, two] = [cast(&once), cast(&twice)];
        let spans = &one.proof().spans;
        lists += usize::from(spans.iter().any(|span| String::from(span.cover.clone()) == "L"));
        match (&one, &two) {
            (MotionOutcome::Contact(a), MotionOutcome::Contact(b)) => {
                contacts += 1;
                let width = |of: &MotionContact<_>| of.upper - of.lower;
                assert!(a.lower <= b.upper && b.lower <= a.upper, "{seed}: {a:?} {b:?}");
                assert!(width(a) < 1e-9 + 4.0 * width(b), "{seed} {tolerance:?}: {a:?} {b:?}");
            }
            (MotionOutcome::Free(_), MotionOutcome::Free(_)) => free += 1,
            (MotionOutcome::Overlapping(_), MotionOutcome::Overlapping(_))
            | (MotionOutcome::Grazing(_), MotionOutcome::Grazing(_)) => {}
            _ => panic!("{seed}: {one:?} {two:?}"),
        }
    }
    let count = cases(160) as usize;
    assert!(contacts > count / 4 && free > count / 10, "{contacts} {free}");
    assert!(lists > count / 2, "{lists} of {count} proofs are one list");
}

/// A cube with sides of length 1, each face of which is divided into `n * n` squares.
fn divided_cube(n: u32) -> Solid {
    let mut vertices: Vec<DVec3> = Vec::new();
    let mut faces: Vec<[u32; 4]> = Vec::new();
    for axis in 0..3 {
        for side in [0, n] {
            let mut corner = |i: u32, j: u32| {
                let mut at = [0; 3];
                (at[axis], at[(axis + 1) % 3], at[(axis + 2) % 3]) = (side, i, j);
                let point = DVec3::from_array(at.map(|k| f64::from(k) / f64::from(n) - 0.5));
                let known = vertices.iter().position(|v| *v == point);
                known.unwrap_or_else(|| {
                    vertices.push(point);
                    vertices.len() - 1
                }) as u32
            };
            for i in 0..n {
                for j in 0..n {
                    let around =
                        [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]].map(|[i, j]| corner(i, j));
                    let [a, b, c, d] = around;
                    faces.push(if side == 0 { [d, c, b, a] } else { around });
                }
            }
        }
    }
    Solid::from_mesh(&vertices, &faces).expect("a solid")
}

/// Cubes with many vertices, also inside of faces, end in contact or slide along each other. They have the classes of
/// answers of cubes with eight vertices.
#[test]
fn finely_divided_cubes_have_the_answers_of_cubes() {
    let cube = ConvexPolyhedron::cuboid(DVec3::splat(-0.5), DVec3::splat(0.5)).expect("a cube");
    let plain = Solid::from_convex(&cube).expect("a solid");
    let fine = divided_cube(16);
    assert!(fine.vertices().len() > 1_000);
    let rest = Motion::at_rest(Pose::IDENTITY);
    let at = |x: f64, y: f64, z: f64| Pose::from_translation(DVec3::new(x, y, z)).expect("a pose");
    let ways = [
        (at(0.25, 0.125, 3.0), at(0.25, 0.125, 1.0)),
        (at(0.25, 0.125, 3.0), at(0.25, 0.125, 0.5)),
        (at(-3.0, 0.0, 1.0), at(3.0, 0.0, 1.0)),
        (at(-3.0, 0.0, 1.0), at(3.0, 0.125, 1.0625)),
        (at(-3.0, 0.0, 1.5), at(0.0, 0.0, 1.0)),
    ];
    for (k, (from, to)) in ways.into_iter().enumerate() {
        let along = Motion::between_poses(from, to).expect("a motion");
        let answer = |solid: &Solid| {
            let cast = MotionCast::new(solid.with_motion(&along), solid.with_motion(&rest));
            let outcome = checked_outcome_with_gap(&cast.expect("a cast"), [&along, &rest], 0.0);
            mem::discriminant(&outcome)
        };
        assert_eq!(answer(&fine), answer(&plain), "motion {k}");
    }
}

/// Rounded bodies as solids have the answers of the convex search.
#[test]
fn rounded_bodies_as_solids_match_convex_search() {
    let (mut contacts, mut free) = (0, 0);
    for seed in 0..cases(120) {
        let random = &mut Random::new(seed);
        let body = |random: &mut Random| {
            let core = match random.index(3) {
                0 => ConvexPolyhedron::from_points(&[random.vector() * 0.3]),
                1 => ConvexPolyhedron::from_points(&[random.vector(), random.vector()]),
                _ => Ok(hull(8, random)),
            };
            let radius = if random.one_in(4) { 0.0 } else { random.range(0.05, 0.8) };
            core.and_then(|core| core.rounded(radius)).expect("a body")
        };
        let [p, q] = [body(random), body(random)];
        if p.radius() + q.radius() == 0.0 {
            continue;
        }
        let from = random.direction() * random.range(3.5, 6.0);
        let pose = Pose::new(random.rotation(), from).expect("a pose");
        let way = (random.vector() * 1.5 - from) * random.range(0.5, 2.0);
        let spin = random.direction() * random.range(0.1, 6.0);
        let along = Motion::free_flight(pose, from, way, spin).expect("a motion");
        let rest = rest_motion();
        let convex = MotionCast::new(p.with_motion(&along), q.with_motion(&rest)).expect("a cast");
        let cast = MotionCast::between_any(p.with_motion(&along), q.with_motion(&rest));
        let cast = cast.and_then(|cast| cast.with_tolerance(0.0)).expect("a cast");
        match (convex.first_contact().expect("an answer"), checked_outcome(&cast, [&along, &rest]))
        {
            (MotionOutcome::Contact(exact), MotionOutcome::Contact(found)) => {
                contacts += 1;
                assert!(found.lower <= exact.upper && exact.lower <= found.upper, "{seed}");
                assert!(found.upper - found.lower < 1e-9, "{seed}: {found:?}");
                let [a, b] = found.points.expect("points");
                assert!((a - b).length() < 1e-7, "{seed}: {found:?}");
            }
            (MotionOutcome::Free(_), MotionOutcome::Free(_)) => free += 1,
            (MotionOutcome::Overlapping(_), MotionOutcome::Overlapping(_)) => {}
            (exact, found) => panic!("{seed}: {exact:?} {found:?}"),
        }
    }
    assert!(contacts > cases(20) && free > cases(5), "{contacts} {free}");
}

/// A ball swings against the face and the edge of a mesh that is not convex.
#[test]
fn swinging_ball_meets_face_and_edge_at_closed_form_times() {
    let ball = ConvexPolyhedron::sphere(DVec3::X * 2.0, 0.3).expect("a ball");
    let quarter = Motion::rotation_about(Pose::IDENTITY, DVec3::ZERO, DVec3::Z, FRAC_PI_2);
    let (quarter, rest) = (quarter.expect("a motion"), rest_motion());
    let wall = |left: f64| {
        let near = colltrans_testkit::bodies::block([left, 1.0, -1.0], [4.0, 3.0, 1.0]);
        let far = colltrans_testkit::bodies::block([3.0, 2.0, -1.0], [9.0, 9.0, 1.0]);
        Solid::from_pieces([&near, &far]).expect("a solid")
    };
    // The edge is at (1.9, 1): the law of cosines.
    let edge = DVec3::new(1.9, 1.0, 0.0);
    let cosine = (4.0 + edge.length_squared() - 0.09) / (4.0 * edge.length());
    let at_edge = edge.y.atan2(edge.x) - cosine.acos();
    for (left, radius, angle) in [(-1.0, 0.0, 0.35_f64.asin()), (-1.0, 0.2, 0.25_f64.asin())] {
        let wall = wall(left).rounded(radius).expect("a solid");
        let cast = MotionCast::between_any(ball.with_motion(&quarter), wall.with_motion(&rest));
        let cast = cast.and_then(|cast| cast.with_tolerance(0.0)).expect("a cast");
        let found = expect_contact(checked_outcome(&cast, [&quarter, &rest]));
        let exact = angle / FRAC_PI_2;
        assert!(found.lower <= exact + 1e-12 && exact <= found.upper + 1e-12, "{found:?} {exact}");
        assert!(found.upper - found.lower < 1e-11, "{found:?}");
    }
    let wall = wall(1.9);
    let cast = MotionCast::between_any(ball.with_motion(&quarter), wall.with_motion(&rest));
    let cast = cast.and_then(|cast| cast.with_tolerance(0.0)).expect("a cast");
    let outcome = cast.certified_first_contact().expect("an answer");
    let found = expect_contact(checked_outcome(&cast, [&quarter, &rest]));
    let exact = at_edge / FRAC_PI_2;
    assert!(found.lower <= exact + 1e-12 && exact <= found.upper + 1e-12, "{found:?} {exact}");
    // The proof is refused for other radii.
    for radius in [0.3 + 1e-6, 0.3 - 1e-6] {
        let other = ConvexPolyhedron::sphere(DVec3::X * 2.0, radius).expect("a ball");
        let other = MotionCast::between_any(other.with_motion(&quarter), wall.with_motion(&rest));
        let other = other.and_then(|cast| cast.with_tolerance(0.0)).expect("a cast");
        assert!(other.verify(outcome.proof()).is_err(), "{radius}");
    }
}

#[test]
fn screw_in_nut_is_free_at_its_pitch_only() {
    let bolt = solid(&thread([1.0, 0.1, 0.5], [0.0, 2.0], [24, 24], None));
    let nut = solid(&thread([1.04, 0.1, 0.5], [0.6, 1.4], [24, 9], Some(1.5)));
    assert_eq!([&bolt, &nut].map(|solid| solid.triangles().len()), [1_200, 576]);
    let turned = |factor: f64| {
        let turn = Motion::screw(Pose::IDENTITY, DVec3::ZERO, DVec3::Z, TAU, 0.5 * factor);
        let (turn, rest) = (turn.expect("a motion"), rest_motion());
        let cast =
            MotionCast::new(bolt.with_motion(&turn), nut.with_motion(&rest)).expect("a cast");
        let steps = cast.first_contact().expect("an answer").steps();
        (checked_outcome(&cast, [&turn, &rest]), steps)
    };
    let (outcome, steps) = turned(1.0);
    assert!(matches!(outcome, MotionOutcome::Free(_)));
    assert!(steps.nodes < 450_000 && steps.leaves < 100, "{steps:?}");
    let (outcome, steps) = turned(0.95);
    assert!(steps.nodes < 450_000 && steps.leaves < 5_000, "{steps:?}");
    let pitch = expect_contact(outcome);
    assert!(pitch.lower > 0.9 && pitch.upper - pitch.lower < 1e-11, "{pitch:?}");
    let (outcome, steps) = turned(0.0);
    assert!(steps.nodes < 25_000 && steps.leaves < 300, "{steps:?}");
    let level = expect_contact(outcome);
    assert!(level.lower > 0.05 && level.upper - level.lower < 1e-11, "{level:?}");
}

#[test]
fn swinging_door_meets_frame_at_closed_form_time() {
    // The door rotates about the origin against a stop of its frame. Its corner (1, 1/8) meets the face y = 1/2 of the
    // stop at sin a + cos a / 8 = 1/2.
    let door = solid(&block([0.0, -0.125, 0.0], [1.0, 0.125, 2.0]));
    let frame = solid(
        &block([0.5, 0.5, -0.5], [1.5, 1.0, 2.5])
            .joined(&block([-0.5, -0.5, -1.5], [1.5, 0.5, -0.5])),
    );
    let swing =
        Motion::rotation_about(Pose::IDENTITY, DVec3::ZERO, DVec3::Z, FRAC_PI_2).expect("a motion");
    let rest = rest_motion();
    let cast = MotionCast::new(door.with_motion(&swing), frame.with_motion(&rest)).expect("a cast");
    let found = expect_contact(checked_outcome(&cast, [&swing, &rest]));
    let (r, phase) = ((1.0_f64 + 1.0 / 64.0).sqrt(), 0.125_f64.atan());
    let expected = ((0.5 / r).asin() - phase) / FRAC_PI_2;
    assert!((found.lower - expected).abs() < 1e-11, "{} {expected}", found.lower);
    assert!(found.upper - found.lower < 1e-11, "{:e}", found.upper - found.lower);
}

/// Builds a block with a slot along x that is 0.5 wide and high, from four blocks.
fn slotted_block() -> Solid {
    let walls = [
        block([0.0, 0.25, -1.0], [1.0, 1.0, 1.0]),
        block([0.0, -1.0, -1.0], [1.0, -0.25, 1.0]),
        block([0.0, -0.25, 0.25], [1.0, 0.25, 1.0]),
        block([0.0, -0.25, -1.0], [1.0, 0.25, -0.25]),
    ];
    solid(&walls[1..].iter().fold(walls[0].clone(), Mesh::joined))
}

#[test]
fn key_rotates_in_slot_if_its_corner_fits() {
    // A blade of 0.4 by 0.2 rotates in a square slot of 0.5, because its corners are at r = sqrt(0.2) / 2 < 0.25. A
    // blade of 0.48 by 0.2 does not.
    let turn = Motion::rotation_about(Pose::IDENTITY, DVec3::ZERO, DVec3::X, PI).expect("a motion");
    let (slotted_block, rest) = (slotted_block(), rest_motion());
    let key = |half: f64| solid(&block([-1.0, -half, -0.1], [0.5, half, 0.1]));
    let (small, large) = (key(0.2), key(0.24));
    let cast = MotionCast::new(small.with_motion(&turn), slotted_block.with_motion(&rest))
        .expect("a cast");
    assert!(matches!(checked_outcome(&cast, [&turn, &rest]), MotionOutcome::Free(_)));
    let cast = MotionCast::new(large.with_motion(&turn), slotted_block.with_motion(&rest))
        .expect("a cast");
    let found = expect_contact(checked_outcome(&cast, [&turn, &rest]));
    // The corner (0.24, -0.1) reaches y = 0.25.
    let r = 0.24_f64.hypot(0.1);
    let expected = ((0.1 / r).asin() - (0.25 / r).acos()) / PI;
    assert!((found.lower - expected).abs() < 1e-11, "{} {expected}", found.lower);
    assert!(found.upper - found.lower < 1e-11, "{:e}", found.upper - found.lower);
    assert!((found.points.expect("points")[0].x - 0.25).abs() < 0.3);
}

#[test]
fn solids_in_contact_may_slide_and_separate_but_not_penetrate() {
    // A step rests on a plate.
    let step =
        solid(&block([0.0; 3], [2.0, 1.0, 1.0]).joined(&block([0.0, 0.0, 1.0], [1.0, 1.0, 2.0])));
    let plate = solid(&block([-4.0, -4.0, -1.0], [4.0, 4.0, 0.0]));
    let rest = rest_motion();
    let query = |motion: Motion| {
        let cast =
            MotionCast::new(step.with_motion(&motion), plate.with_motion(&rest)).expect("a cast");
        checked_outcome(&cast, [&motion, &rest])
    };
    let here = Pose::IDENTITY;
    let turned =
        Motion::rotation_about(here, DVec3::new(0.3, 0.2, 0.0), DVec3::Z, TAU).expect("a motion");
    let slid = Motion::translation(here, DVec3::X).expect("a motion");
    let raised = Motion::screw(here, DVec3::ZERO, DVec3::Z, 3.0, 1.0).expect("a motion");
    let tipped = Motion::rotation_about(here, DVec3::X * 2.0, DVec3::Y, 1.0).expect("a motion");
    for free in [turned, slid, raised, tipped] {
        let outcome = query(free);
        assert!(matches!(outcome, MotionOutcome::Free(_)), "{outcome:?}");
    }
    let pushed = Motion::screw(here, DVec3::ZERO, DVec3::Z, 1.0, -1.0).expect("a motion");
    let levered =
        Motion::rotation_about(here, DVec3::new(1.0, 0.0, 0.0), DVec3::Y, 1.0).expect("a motion");
    for blocked in [pushed, levered] {
        let found = expect_contact(query(blocked));
        assert!(found.lower < 1e-11 && found.upper < 1e-11, "{} {}", found.lower, found.upper);
    }
    // Without a tolerance, contact is not distinguished from overlap.
    let turned = Motion::rotation_about(here, DVec3::ZERO, DVec3::Z, 1.0).expect("a motion");
    let cast =
        MotionCast::new(step.with_motion(&turned), plate.with_motion(&rest)).expect("a cast");
    let cast = cast.with_tolerance(0.0).expect("a tolerance");
    let MotionOutcome::Grazing(found) = checked_outcome(&cast, [&turned, &rest]) else {
        panic!("not grazing")
    };
    assert_eq!(found.lower, 0.0);
}

#[test]
fn fits_containment_and_gaps_are_decided_at_start() {
    let ring = solid(&washer([1.0, 3.0], [-0.5, 0.5], 24));
    let turn =
        Motion::rotation_about(Pose::IDENTITY, DVec3::ZERO, DVec3::Z, 1.0).expect("a motion");
    let rest = rest_motion();
    // A pin with the same corners fits, but can rotate only if both are shrunk by the height of a chord.
    let fitting = solid(&pin(1.0, [-1.0, 1.0], 24));
    let cast =
        MotionCast::new(fitting.with_motion(&turn), ring.with_motion(&rest)).expect("a cast");
    assert!(expect_contact(checked_outcome(&cast, [&turn, &rest])).upper < 1e-4);
    let chord = 1.0 - (PI / 24.0).cos();
    let cast = cast.with_tolerance(1.1 * chord).expect("a tolerance");
    assert!(matches!(checked_outcome(&cast, [&turn, &rest]), MotionOutcome::Free(_)));
    // Inside the material, no surfaces cross.
    let ball = solid(&block([1.5, -0.25, -0.25], [2.0, 0.25, 0.25]));
    let cast = MotionCast::new(ball.with_motion(&turn), ring.with_motion(&rest)).expect("a cast");
    assert!(matches!(checked_outcome(&cast, [&turn, &rest]), MotionOutcome::Overlapping(_)));
    // A block rotates in a closed cavity.
    let hollow = solid(&block([-2.0; 3], [2.0; 3]).joined(&block([-1.0; 3], [1.0; 3]).reversed()));
    let inner = solid(&block([-0.5; 3], [0.5; 3]));
    let cast =
        MotionCast::new(inner.with_motion(&turn), hollow.with_motion(&rest)).expect("a cast");
    assert!(matches!(checked_outcome(&cast, [&turn, &rest]), MotionOutcome::Free(_)));
    assert!(cast.clone().with_tolerance(1.0).is_err(), "nothing is left of the inner one");
    // With a minimum gap: the corner, at 0.5 sqrt(2) from the axis, comes as near as 1 - 0.5 sqrt(2).
    let gap = 1.0 - 0.5_f64.sqrt();
    let query = |gap: f64| {
        let cast = cast.clone().with_min_gap(gap).expect("a gap");
        checked_outcome_with_gap(&cast, [&turn, &rest], gap)
    };
    assert!(matches!(query(gap - 1e-9), MotionOutcome::Free(_)));
    assert!((expect_contact(query(gap + 1e-9)).lower - FRAC_PI_2 / 2.0).abs() < 1e-3);
}

#[test]
fn translation_matches_linear_cast() {
    let mut random = Random::new(11);
    let ell =
        solid(&block([0.0; 3], [3.0, 1.0, 1.0]).joined(&block([0.0, 1.0, 0.0], [1.0, 3.0, 1.0])));
    let mut contacts = 0;
    for _ in 0..60 {
        let place = |random: &mut Random, far: f64| {
            Pose::new(random.rotation(), random.direction() * far).expect("a pose")
        };
        let (a, b) = (place(&mut random, 6.0), place(&mut random, 0.5));
        let by = random.vector() * 2.0 - a.translation() * 1.5;
        let linear = Cast::new(ell.at(a), ell.at(b), by).expect("a cast");
        let (slide, rest) = (Motion::translation(a, by).expect("a motion"), Motion::at_rest(b));
        let cast =
            MotionCast::new(ell.with_motion(&slide), ell.with_motion(&rest)).expect("a cast");
        match (linear.first_contact().expect("an answer"), checked_outcome(&cast, [&slide, &rest]))
        {
            (Outcome::Contact(one), MotionOutcome::Contact(two)) => {
                contacts += 1;
                assert!((one.translation.value - two.lower).abs() < 1e-9, "{one:?} {two:?}");
            }
            (Outcome::Contact(one), MotionOutcome::Free(_)) => {
                assert!(!(-1e-9..1.0).contains(&one.translation.value), "{one:?}");
            }
            (Outcome::Separated(_), MotionOutcome::Free(_)) => {}
            (one, two) => panic!("{one:?} {two:?}"),
        }
    }
    assert!(contacts > 15, "{contacts}");
}

#[test]
fn solids_with_common_motion_are_free_with_few_nodes() {
    // A hook around a bar with a small gap, far from the axis: carried planes prove the motion without halving.
    let hook = solid(
        &block([0.0; 3], [3.0, 1.0, 1.0])
            .joined(&block([0.0, 1.0, 0.0], [1.0, 3.0, 1.0]))
            .joined(&block([0.0, 3.0, 0.0], [3.0, 4.0, 1.0])),
    );
    let bars =
        [1e-3, 1e-8].map(|gap| solid(&block([1.0 + gap, 1.0 + gap, -4.0], [2.0, 3.0 - gap, 4.0])));
    let pose = Pose::new(DQuat::from_rotation_x(0.4), DVec3::new(9.0, 1.0, 2.0)).expect("a pose");
    let (point, axis) = (DVec3::new(-1.0, 2.0, 0.5), DVec3::new(1.0, 2.0, 3.0));
    let both = [0, 1].map(|_| Motion::screw(pose, point, axis, 5.0, 1.0).expect("a motion"));
    for bar in &bars {
        let cast =
            MotionCast::new(hook.with_motion(&both[0]), bar.with_motion(&both[1])).expect("a cast");
        let outcome = checked_outcome(&cast, [&both[0], &both[1]]);
        assert!(matches!(outcome, MotionOutcome::Free(_)), "{outcome:?}");
        assert!(outcome.steps().nodes < 2_000, "{:?}", outcome.steps());
    }
}

#[test]
fn modified_proof_is_rejected_or_weaker() {
    let mut refused = 0;
    let bolt = solid(&thread([1.0, 0.1, 0.5], [0.0, 2.0], [10, 16], None));
    let nut = solid(&thread([1.05, 0.1, 0.5], [0.6, 1.4], [10, 6], Some(1.5)));
    let rest = rest_motion();
    for factor in [1.0, 0.9, 0.0] {
        let turn = Motion::screw(Pose::IDENTITY, DVec3::ZERO, DVec3::Z, 3.0, 0.5 * factor);
        let turn = turn.expect("a motion");
        let cast =
            MotionCast::new(bolt.with_motion(&turn), nut.with_motion(&rest)).expect("a cast");
        let outcome = cast.certified_first_contact().expect("an answer");
        let original = outcome.proof();
        let mut check = |change: &dyn Fn(&mut SolidMotionProof)| {
            let mut changed = original.clone();
            change(&mut changed);
            if changed != *original {
                let all = cast.verify(original).expect("a proof");
                match cast.verify(&changed) {
                    Err(_) => refused += 1,
                    Ok(less) => assert!(less[0] <= all[0] && less[1] >= all[1], "{less:?}"),
                }
            }
        };
        check(&|proof| proof.tolerance *= 2.0);
        check(&|proof| proof.spans[0].until *= 1.0 - 1e-6);
        check(&|proof| proof.spans[0].until = (proof.spans[0].until * (1.0 + 1e-6)).min(1.0));
        check(&|proof| proof.spans.push(proof.spans[0].clone()));
        check(&|proof| {
            proof.spans[0].lists.pop();
        });
        check(&|proof| {
            if let Some(plane) = proof.spans[0].lists.iter_mut().flatten().next() {
                plane.gap *= 1.001;
            }
        });
        check(&|proof| {
            if let Some(meeting) = &mut proof.meeting {
                meeting.time *= 0.999;
            }
        });
        check(&|proof| {
            if let Some(meeting) = &mut proof.meeting {
                meeting.triangles = [u32::MAX; 2];
            }
        });
        // Letters of the cover are changed or removed.
        let cover = String::from(original.spans[0].cover.clone());
        assert_eq!(MotionCover::try_from(cover.clone()).as_ref(), Ok(&original.spans[0].cover));
        let letters: Vec<char> = cover.chars().collect();
        let mut random = Random::new(7);
        for _ in 0..60 {
            let mut changed = letters.clone();
            let at = random.index(changed.len());
            if random.one_in(4) {
                changed.remove(at);
            } else {
                changed[at] = random.pick(&['T', 'P', 'Q', 'L', 'm', 'x', 'y', 'p', 'q', '5']);
            }
            let cover = MotionCover::try_from(changed.into_iter().collect::<String>());
            let cover = cover.expect("a cover");
            check(&|proof| proof.spans[0].cover = cover.clone());
        }
    }
    assert!(refused > 100, "{refused}");
}

#[test]
fn rotations_of_all_families_pass_exact_checks() {
    let families =
        turning::FAMILIES.into_iter().chain(["grid", "mould", "sheets", "balls", "thin"]);
    for family in families.chain(["convex-boxes", "convex-face-face", "convex-identical"]) {
        for seed in 0..cases(12) {
            let seen = turning::examine(family, seed);
            assert!(seen.is_ok(), "{family}:{seed} {seen:?}");
        }
    }
}

/// The normal is that of the shrunk bodies, which are separated where the nominal bodies already overlap.
#[test]
fn normals_point_from_moving_to_fixed_body() {
    let plate = solid(&block(DVec3::new(-3.0, -2.0, -1.0), DVec3::new(3.0, 2.0, 0.0)));
    let peg = solid(&block(DVec3::new(-0.4, -0.3, 0.0), DVec3::new(0.5, 0.6, 2.0)));
    for (tolerance, min_gap) in [(None, 0.0), (Some(0.02), 0.0), (None, 0.1)] {
        for (from, way) in [(9.0, -20.0), (-8.0, 15.0)] {
            let start = Pose::from_translation(DVec3::Z * from).expect("a pose");
            let falls = Motion::translation(start, DVec3::Z * way).expect("a motion");
            let stays = rest_motion();
            let cast = MotionCast::new(peg.with_motion(&falls), plate.with_motion(&stays))
                .expect("a cast");
            let cast =
                tolerance.map_or_else(|| cast.clone(), |l| cast.clone().with_tolerance(l).unwrap());
            let cast = cast.with_min_gap(min_gap).expect("a cast");
            let MotionOutcome::Contact(contact) = cast.first_contact().expect("an answer") else {
                panic!("no contact")
            };
            let normal = contact.normal.expect("a normal");
            assert!(normal.distance(DVec3::Z * way.signum()) < 1e-9, "{tolerance:?} {normal}");
            assert!(contact.features.is_some());
        }
    }
}

/// A face of an oblique cube meets an edge of another cube, which is slightly displaced.
#[test]
fn oblique_cube_face_meets_edge_with_narrow_bounds() {
    let cube = solid(&block([-0.5; 3], [0.5; 3]));
    for slant in [0.3, 0.7, FRAC_PI_2 / 2.0] {
        for aside in [0.05, 0.1, 0.3] {
            for axis in [DVec3::X, DVec3::Y, DVec3::Z, DVec3::ONE] {
                let by = DQuat::from_axis_angle(axis.normalize(), slant);
                let pose = Pose::new(by, DVec3::new(-3.0, aside, 0.0)).expect("a pose");
                let (slide, rest) = (Motion::translation(pose, DVec3::X * 4.0), rest_motion());
                let slide = slide.expect("a motion");
                let cast = MotionCast::new(cube.with_motion(&slide), cube.with_motion(&rest))
                    .expect("a cast");
                let found = expect_contact(checked_outcome(&cast, [&slide, &rest]));
                let width = found.upper - found.lower;
                assert!(width < 1e-11, "{slant} {aside} {axis}: {} {width:e}", found.lower);
            }
        }
    }
}

#[test]
fn flush_contacts_have_narrow_bounds() {
    // A cube is lowered onto a step with faces in common planes: facets first lie in one plane, and cross soon after.
    let block = |low: [f64; 3], high: [f64; 3]| {
        let [x, y, z] = [0, 1, 2].map(|k| [low[k], high[k]]);
        let corners = [0, 1, 2, 3, 4, 5, 6, 7usize];
        let points = corners.map(|k| DVec3::new(x[k & 1], y[k >> 1 & 1], z[k >> 2]));
        ConvexPolyhedron::from_points(&points).expect("a block")
    };
    let pieces = [block([0.0; 3], [3.0, 1.0, 1.0]), block([0.0, 1.0, 0.0], [1.0, 3.0, 1.0])];
    let step = Solid::from_pieces(&pieces.map(|piece| Solid::from_convex(&piece).unwrap()));
    let (step, cube) = (step.unwrap(), Solid::from_convex(&block([0.0; 3], [1.0; 3])).unwrap());
    let (mut blocked, mut free) = (0, 0);
    for k in 0..72_i32 {
        let half = |n: i32| 0.5 * f64::from(n);
        let from = DVec3::new(half(k % 9) - 1.5, 5.0, half(k / 9) - 1.5);
        let start = Pose::from_translation(from).unwrap();
        let down = Motion::translation(start, DVec3::new(0.0, -8.0, 0.0)).unwrap();
        let cast = MotionCast::new(cube.with_motion(&down), step.at(Pose::IDENTITY)).unwrap();
        let linear = Cast::new(cube.at(start), step.at(Pose::IDENTITY), DVec3::NEG_Y).unwrap();
        match (
            checked_outcome(&cast, [&down, &rest_motion()]),
            linear.clearance().unwrap().distance(),
        ) {
            (MotionOutcome::Contact(found), Some(distance)) if distance.is_finite() => {
                blocked += 1;
                let width = found.upper - found.lower;
                assert!(width < 4e-12, "{from} {width:e}");
                assert!((8.0 * found.upper - distance).abs() < 1e-10, "{from}: {distance}");
            }
            (MotionOutcome::Free(_), None | Some(f64::INFINITY)) => free += 1,
            (found, linear) => panic!("{from}: {found:?}, along a line {linear:?}"),
        }
    }
    assert!(blocked > 10 && free > 20, "{blocked} {free}");
}

#[test]
fn prisms_with_equal_cross_sections_have_proven_contact() {
    // No facet crosses another one: all sides of one solid lie in sides of the other, or on diagonals of its faces.
    let (plate, column) =
        (block([0.0; 3], [1.0, 1.0, 0.25]), block([0.0, 0.0, -3.0], [1.0, 1.0, 0.0]));
    let post = block([-0.25, -0.25, 0.0], [0.25, 0.25, 0.5]);
    let [plate, column, post] = [&plate, &column, &post].map(solid);
    let pose = |turn: DQuat, x: f64, y: f64, z: f64| Pose::new(turn, DVec3::new(x, y, z)).unwrap();
    let down = |pose: Pose| Motion::translation(pose, DVec3::new(0.0, 0.0, -4.0)).unwrap();
    let plain = DQuat::IDENTITY;
    // A lid closes about an edge of the column; a plate makes a full turn while it is lowered.
    let open = pose(DQuat::from_rotation_y(-1.0), 0.0, 0.0, 0.0);
    let lid = Motion::rotation_about(open, DVec3::ZERO, DVec3::Y, 2.0).unwrap();
    let whole =
        Motion::screw(pose(plain, 0.0, 0.0, 2.0), DVec3::new(0.5, 0.5, 0.0), DVec3::Z, TAU, -4.0);
    let askew = pose(DQuat::from_rotation_z(FRAC_PI_2), 1.0, 0.0, 1.0);
    for (moving, motion, time) in [
        (&plate, down(pose(plain, 0.0, 0.0, 1.0)), 0.25),
        (&plate, down(askew), 0.25),
        (&post, down(pose(DQuat::from_rotation_z(0.5 * FRAC_PI_2), 0.5, 0.5, 1.0)), 0.25),
        (&plate, lid, 0.5),
        (&plate, whole.unwrap(), 0.5),
    ] {
        let cast = MotionCast::new(moving.with_motion(&motion), column.at(Pose::IDENTITY)).unwrap();
        let outcome = checked_outcome(&cast, [&motion, &rest_motion()]);
        let MotionOutcome::Contact(found) = &outcome else { panic!("{outcome:?}") };
        assert!(found.lower < time + 1e-11 && found.upper > time - 1e-15, "{found:?}");
        assert!(found.upper - found.lower < 1e-11, "{:e}", found.upper - found.lower);
        // A point that is not inside both is not a proof.
        let met = found.proof.meeting.expect("it is proven");
        if let FacetContactProof::Inside { point } = met.met {
            for (axis, far) in [(0, 2.0), (1, -2.0), (2, 1.0), (2, 1e300), (2, f64::NAN)] {
                let mut point = point;
                point[axis] += far;
                let met = FacetContactProof::Inside { point };
                let mut proof = found.proof.clone();
                proof.meeting = proof.meeting.map(|meeting| FacetContact { met, ..meeting });
                assert!(cast.verify(&proof).is_err(), "{axis} {far}");
            }
            let mut proof = found.proof.clone();
            proof.meeting = Some(FacetContact { time: found.lower, ..met });
            assert!(cast.verify(&proof).is_err(), "too early");
        }
    }
}
