//! Motions with rotation: closed forms, samples of the motion, proofs and modified proofs, counts of work.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use colltrans_convex::{Cast, ConvexPolyhedron, Outcome, Pair, Pose, QueryError};
use colltrans_motion::{
    Motion, MotionCast, MotionClearance, MotionContact, MotionOutcome, MotionProof,
    MotionProofError, ProvenContact,
};
use colltrans_solid::Solid;
use colltrans_testkit::bodies::{at_xyz as at, centered as cuboid, hull};
use colltrans_testkit::cases;
use colltrans_testkit::oracle::settings::{FAMILIES, setting};
use colltrans_testkit::random::Random;
use colltrans_testkit::shapes::ring_sphere;
use glam::{DQuat, DVec3};

/// Returns a random motion that rotates by at most `most` and passes near the origin.
fn random_motion(random: &mut Random, most: f64) -> Motion {
    let from = random.direction() * random.range(2.5, 5.0);
    let pose = Pose::new(random.rotation(), from).expect("a pose");
    let to = random.vector() * 1.5;
    let angle = random.range(-most, most);
    let way = (to - from) * random.range(0.5, 2.0);
    match random.index(5) {
        0 => Motion::rotation_about(pose, random.vector() * 3.0, random.direction(), angle),
        1 => {
            let rise = random.range(-3.0, 3.0);
            Motion::screw(pose, random.vector() * 3.0, random.direction(), angle, rise)
        }
        2 => Motion::free_flight(pose, from, way, random.direction() * angle),
        3 => Motion::translation(pose, way),
        _ => {
            let poses = [(); 3]
                .map(|()| Pose::new(random.rotation(), random.vector() * 4.0).expect("a pose"));
            Motion::through_poses(&[pose, poses[0], poses[1], poses[2]])
        }
    }
    .expect("a motion")
}

/// Returns a lower bound of the depth of the bodies at a time; negative if they are separated.
fn overlap_lower_bound(cast: [(&ConvexPolyhedron, &Motion); 2], time: f64) -> f64 {
    let [(p, along), (q, other)] = cast;
    let [a, b] = [along, other].map(|motion| motion.pose_at(time).expect("a pose"));
    Pair::new(p.at(a), q.at(b)).expect("a pair").depth().expect("a depth").lower
}

/// Computes the first contact and checks it: its proof, and samples of the motion up to its bounds.
fn checked_outcome(
    bodies: [&ConvexPolyhedron; 2],
    motions: [&Motion; 2],
    min_gap: f64,
) -> MotionOutcome {
    let cast =
        MotionCast::new(bodies[0].with_motion(motions[0]), bodies[1].with_motion(motions[1]));
    let cast = cast.and_then(|cast| cast.with_min_gap(min_gap)).expect("a cast");
    let outcome = cast.first_contact().expect("an answer");
    let proof = proof_of(&outcome);
    let [lower, upper] = cast.verify(proof).unwrap_or_else(|error| panic!("{error}: {outcome:?}"));
    let both = [(bodies[0], motions[0]), (bodies[1], motions[1])];
    match &outcome {
        MotionOutcome::Contact(contact) => {
            assert_eq!([contact.lower, contact.upper], [lower, upper]);
        }
        MotionOutcome::Grazing(contact) => assert_eq!(contact.lower, lower),
        MotionOutcome::Overlapping(_) => assert_eq!([lower, upper], [0.0; 2]),
        MotionOutcome::Free(_) => assert_eq!([lower, upper], [1.0, f64::INFINITY]),
        _ => unreachable!("all outcomes"),
    }
    for k in 0..if upper == 0.0 { 0 } else { 100 } {
        let time = lower * f64::from(k) / 100.0;
        if min_gap > 0.0 {
            let [a, b] = motions.map(|motion| motion.pose_at(time).expect("a pose"));
            let pair = Pair::new(bodies[0].at(a), bodies[1].at(b)).expect("a pair");
            let distance = pair.distance().expect("a distance");
            assert!(distance.upper > min_gap * (1.0 - 1e-12) - 1e-12, "{time}: {outcome:?}");
        } else {
            assert!(overlap_lower_bound(both, time) < 1e-12, "{time}: {outcome:?}");
        }
    }
    if min_gap == 0.0 && upper <= 1.0 {
        assert!(overlap_lower_bound(both, upper) > 0.0, "{outcome:?}");
    }
    outcome
}

fn proof_of(outcome: &MotionOutcome) -> &MotionProof {
    match outcome {
        MotionOutcome::Contact(contact)
        | MotionOutcome::Grazing(contact)
        | MotionOutcome::Overlapping(contact) => &contact.proof,
        MotionOutcome::Free(free) => &free.proof,
        _ => unreachable!("all outcomes"),
    }
}

fn expect_contact(outcome: MotionOutcome) -> MotionContact {
    match outcome {
        MotionOutcome::Contact(contact) => contact,
        other => panic!("no contact: {other:?}"),
    }
}

#[test]
fn random_motions_match_samples_and_verify() {
    let (mut contacts, mut free, mut looks, mut widths) = (0, 0, Vec::new(), Vec::new());
    for seed in 0..400 {
        let mut random = Random::new(seed);
        let n = random.pick(&[4, 8, 16, 32, 128]);
        let [p, q] = [hull(n, &mut random), hull(n, &mut random)];
        let most = random.pick(&[1.0, 6.0, 6.0, 100.0]);
        let along = random_motion(&mut random, most);
        let still = Motion::at_rest(Pose::new(random.rotation(), DVec3::ZERO).expect("a pose"));
        let other = if random.one_in(3) { random_motion(&mut random, most) } else { still };
        let min_gap = if random.one_in(4) { random.pick(&[1e-9, 0.01, 0.3]) } else { 0.0 };
        match checked_outcome([&p, &q], [&along, &other], min_gap) {
            MotionOutcome::Contact(contact) => {
                contacts += 1;
                looks.push(contact.steps.looks);
                widths.push(contact.upper - contact.lower);
            }
            MotionOutcome::Free(_) => free += 1,
            _ => {}
        }
    }
    looks.sort_unstable();
    widths.sort_by(f64::total_cmp);
    println!("{contacts} contacts, {free} free; looks {looks:?}; widths {widths:?}");
    assert!(contacts > 100 && free > 50, "{contacts} {free}");
}

#[test]
fn swinging_door_meets_wall_at_closed_form_time() {
    let door = ConvexPolyhedron::cuboid(DVec3::new(0.0, -0.125, 0.0), DVec3::new(1.0, 0.125, 2.0));
    let door = door.expect("a box");
    let swing =
        Motion::rotation_about(Pose::IDENTITY, DVec3::ZERO, DVec3::Z, PI).expect("a motion");
    let wall = ConvexPolyhedron::cuboid(DVec3::new(-9.0, 0.5, -1.0), DVec3::new(9.0, 1.0, 3.0));
    let still = Motion::at_rest(Pose::IDENTITY);
    let found =
        expect_contact(checked_outcome([&door, &wall.expect("a box")], [&swing, &still], 0.0));
    // The corner (1, 1/8) of the door reaches the plane y = 1/2 at sin a + cos a / 8 = 1/2.
    let (r, phase) = ((1.0_f64 + 1.0 / 64.0).sqrt(), 0.125_f64.atan());
    let expected = ((0.5 / r).asin() - phase) / PI;
    assert!(found.lower <= expected && expected <= found.upper);
    assert!(found.upper - found.lower < 2e-12, "{:e}", found.upper - found.lower);
}

#[test]
fn translation_matches_linear_cast() {
    let mut random = Random::new(5);
    let mut contacts = 0;
    for _ in 0..200 {
        let [p, q] = [hull(16, &mut random), hull(16, &mut random)];
        let pose = Pose::new(random.rotation(), random.direction() * 4.0).expect("a pose");
        let by = random.direction() * 3.0 - pose.translation();
        let cast = Cast::new(p.at(pose), q.at(Pose::IDENTITY), by).expect("a cast");
        let slide = Motion::translation(pose, by).expect("a motion");
        let motions = [&slide, &Motion::at_rest(Pose::IDENTITY)];
        let outcome = checked_outcome([&p, &q], motions, 0.0);
        match (cast.first_contact().expect("an answer"), outcome) {
            (Outcome::Contact(linear), MotionOutcome::Contact(found)) => {
                contacts += 1;
                assert!(found.lower <= linear.certificate.upper);
                assert!(linear.certificate.lower <= found.upper);
            }
            (Outcome::Contact(linear), MotionOutcome::Free(_)) => {
                assert!(linear.certificate.upper > 1.0 || linear.certificate.upper < 0.0);
            }
            (Outcome::Separated(_), MotionOutcome::Free(_)) => {}
            (linear, found) => panic!("{linear:?}, but {found:?}"),
        }
    }
    assert!(contacts > 40, "{contacts}");
}

#[test]
fn pin_rotating_next_to_wall_takes_at_most_four_samples() {
    let rim = |k: usize| DQuat::from_rotation_z(TAU * k as f64 / 48.0) * DVec3::X;
    let corners: Vec<DVec3> =
        (0..48).flat_map(|k| [rim(k) + DVec3::Z, rim(k) - DVec3::Z]).collect();
    let pin = ConvexPolyhedron::from_points(&corners).expect("a pin");
    let wall = cuboid([1.0, 9.0, 9.0]);
    let turn =
        Motion::rotation_about(Pose::IDENTITY, DVec3::ZERO, DVec3::Z, TAU).expect("a motion");
    for gap in [1e-2, 1e-6, 1e-9, 1e-12] {
        let still = Motion::at_rest(at(2.0 + gap, 0.0, 0.0));
        let MotionOutcome::Free(free) = checked_outcome([&pin, &wall], [&turn, &still], 0.0) else {
            panic!("not free at {gap}");
        };
        assert!(free.steps.looks <= 4, "{} looks at {gap}", free.steps.looks);
    }
}

#[test]
fn rotating_blade_clears_tip_with_gap_and_meets_it_with_overlap() {
    let blade = cuboid([1.0, 0.05, 0.2]);
    let tip = ConvexPolyhedron::from_points(&[
        DVec3::new(0.0, 0.0, 0.0),
        DVec3::new(1.0, 0.3, 0.2),
        DVec3::new(1.0, -0.3, 0.2),
        DVec3::new(1.0, 0.0, -0.3),
    ])
    .expect("a tip");
    let turn = Motion::rotation_about(Pose::IDENTITY, DVec3::ZERO, DVec3::Z, PI).expect("a motion");
    let reach = (1.0_f64 + 0.05 * 0.05).sqrt();
    for gap in [1e-1, 1e-3, 1e-6, 1e-9] {
        let pose = Pose::new(DQuat::from_rotation_z(FRAC_PI_2), DVec3::Y * (reach + gap));
        let motion = Motion::at_rest(pose.expect("a pose"));
        let outcome = checked_outcome([&blade, &tip], [&turn, &motion], 0.0);
        let MotionOutcome::Free(free) = outcome else { panic!("{gap}: {outcome:?}") };
        println!("{gap:e}: {} looks", free.steps.looks);
    }
    for depth in [1e-1, 1e-3, 1e-6, 1e-9] {
        let pose = Pose::new(DQuat::from_rotation_z(FRAC_PI_2), DVec3::Y * (reach - depth));
        let found = expect_contact(checked_outcome(
            [&blade, &tip],
            [&turn, &Motion::at_rest(pose.expect("a pose"))],
            0.0,
        ));
        assert!(found.steps.looks < 100, "{} looks", found.steps.looks);
        println!("{depth:e}: {} looks, width {:e}", found.steps.looks, found.upper - found.lower);
    }
}

#[test]
fn bodies_overlapping_at_start_report_overlap() {
    let cube = cuboid([0.5; 3]);
    let turn =
        Motion::rotation_about(Pose::IDENTITY, DVec3::ZERO, DVec3::Z, 1.0).expect("a motion");
    let near = Motion::at_rest(at(0.75, 0.0, 0.0));
    let outcome = checked_outcome([&cube, &cube], [&turn, &near], 0.0);
    assert!(matches!(outcome, MotionOutcome::Overlapping(_)), "{outcome:?}");
}

#[test]
fn resting_part_with_tolerance_may_rotate_and_leave_but_not_sink() {
    let (part, table) = (cuboid([0.5; 3]), cuboid([5.0, 5.0, 1.0]));
    let still = Motion::at_rest(at(0.0, 0.0, -1.5));
    let query = |motion: &Motion, depth: f64| {
        let cast =
            MotionCast::new(part.with_motion(motion), table.with_motion(&still)).expect("a cast");
        let cast = cast.with_tolerance(depth).expect("a depth");
        let outcome = cast.first_contact().expect("an answer");
        cast.verify(proof_of(&outcome)).unwrap_or_else(|error| panic!("{error}: {outcome:?}"));
        outcome
    };
    let here = Pose::IDENTITY;
    let turning = Motion::rotation_about(here, DVec3::ZERO, DVec3::Z, TAU).expect("a motion");
    let leaving = Motion::screw(here, DVec3::ZERO, DVec3::Z, 3.0, 2.0).expect("a motion");
    let tipping =
        Motion::rotation_about(here, DVec3::new(0.5, 0.0, -0.5), DVec3::Y, 1.0).expect("a motion");
    let sinking = Motion::translation(here, DVec3::NEG_Z).expect("a motion");
    for depth in [1e-12, 1e-9, 1e-3] {
        for motion in [&turning, &leaving, &tipping] {
            let outcome = query(motion, depth);
            let MotionOutcome::Free(free) = &outcome else { panic!("{depth}: {outcome:?}") };
            assert!(free.steps.looks < 40, "{} looks at {depth}", free.steps.looks);
        }
        let found = expect_contact(query(&sinking, depth));
        assert!(found.lower <= depth && depth <= found.upper && found.upper < depth + 1e-12);
    }
    for motion in [&turning, &leaving, &tipping, &sinking] {
        assert!(matches!(query(motion, 0.0), MotionOutcome::Grazing(found) if found.lower == 0.0));
    }
}

/// Returns the penetration depth by all candidate axes: face normals and cross products of edges. Negative if the
/// bodies are separated.
fn depth_by_all_axes(bodies: [(&ConvexPolyhedron, Pose); 2]) -> f64 {
    let placed = bodies.map(|(body, pose)| {
        let vertices: Vec<DVec3> =
            body.vertices().iter().map(|v| pose.transform_point(*v)).collect();
        let faces: Vec<Vec<DVec3>> = (0..body.face_count() as u32)
            .map(|f| body.face_vertices(f).map(|v| vertices[v as usize]).collect())
            .collect();
        let normal = |f: &Vec<DVec3>| (f[1] - f[0]).cross(f[2] - f[0]).normalize();
        let normals: Vec<DVec3> = faces.iter().map(normal).collect();
        let edges = faces.iter().flat_map(|f| (0..f.len()).map(|k| f[(k + 1) % f.len()] - f[k]));
        (vertices, normals, edges.collect::<Vec<_>>())
    });
    let [(p, own, along), (q, other, across)] = &placed;
    let crossed = along.iter().flat_map(|e| across.iter().map(|f| e.cross(*f).normalize_or_zero()));
    let axes = own.iter().copied().chain(other.iter().copied()).chain(crossed);
    let out = |n: DVec3| {
        let high = p.iter().map(|v| n.dot(*v)).fold(f64::NEG_INFINITY, f64::max);
        high - q.iter().map(|v| n.dot(*v)).fold(f64::INFINITY, f64::min)
    };
    let ways = axes.filter(|n| n.length_squared() > 0.5).flat_map(|n| [out(n), out(-n)]);
    ways.fold(f64::INFINITY, f64::min)
}

#[test]
fn direction_of_least_depth_may_change_within_tolerance() {
    // A block is 1/10 deep in a table. It moves sideways off the table and sinks at the same time.
    let (block, table) = (cuboid([0.5; 3]), cuboid([5.0, 5.0, 1.0]));
    let still = Motion::at_rest(at(-4.6, 0.0, -1.4));
    for (by, free) in [([0.85, 0.0, -0.1], true), ([0.8, 0.0, -0.3], false)] {
        let by = DVec3::from_array(by);
        let motions = [
            Motion::translation(Pose::IDENTITY, by),
            Motion::screw(Pose::IDENTITY, DVec3::ZERO, by, 1e-3, by.length()),
        ];
        for motion in motions.map(|motion| motion.expect("a motion")) {
            let cast = MotionCast::new(block.with_motion(&motion), table.with_motion(&still))
                .expect("a cast");
            let cast = cast.with_tolerance(0.2).expect("a depth");
            let outcome = cast.first_contact().expect("an answer");
            cast.verify(outcome.proof()).unwrap_or_else(|error| panic!("{error}: {outcome:?}"));
            let is_free = matches!(outcome, MotionOutcome::Free(_));
            assert!(is_free == free && outcome.steps().looks < 40, "{outcome:?}");
            if !free {
                let found = expect_contact(outcome);
                assert!(
                    (found.lower - 1.0 / 3.0).abs() < 1e-3 && found.upper - found.lower < 1e-11
                );
            }
        }
    }
}

#[test]
fn tolerated_depth_is_first_exceeded_within_bounds() {
    let (mut counts, mut looks) = ([0; 4], Vec::new());
    for seed in 0..cases(400) {
        let mut random = Random::new(seed);
        let body = |random: &mut Random| match random.index(3) {
            0 => cuboid([random.range(0.2, 2.0), random.range(0.2, 2.0), random.range(0.2, 2.0)]),
            _ => hull(random.pick(&[4, 6, 8]), random),
        };
        let [p, q] = [body(&mut random), body(&mut random)];
        let most = random.pick(&[0.5, 3.0]);
        let along = random_motion(&mut random, most);
        let still = Motion::at_rest(Pose::new(random.rotation(), DVec3::ZERO).expect("a pose"));
        let depth = 10.0_f64.powf(random.range(-4.0, 0.0));
        let cast = MotionCast::new(p.with_motion(&along), q.with_motion(&still)).expect("a cast");
        let cast = cast.with_tolerance(depth).expect("a depth");
        let outcome = cast.first_contact().expect("an answer");
        cast.verify(outcome.proof()).unwrap_or_else(|error| panic!("{seed} {error}: {outcome:?}"));
        looks.push(outcome.steps().looks);
        let deep = |time: f64| {
            let place = |motion: &Motion| motion.pose_at(time).expect("a pose");
            depth_by_all_axes([(&p, place(&along)), (&q, place(&still))])
        };
        let (kind, [lower, upper]) = match &outcome {
            MotionOutcome::Contact(found) => (0, [found.lower, found.upper]),
            MotionOutcome::Free(_) => (1, [1.0, f64::INFINITY]),
            MotionOutcome::Overlapping(_) => (2, [0.0; 2]),
            MotionOutcome::Grazing(found) => {
                // The depth reaches the tolerance up to rounding.
                assert!((deep(found.lower) - depth).abs() < 1e-9, "{seed}: {outcome:?}");
                (3, [found.lower, f64::INFINITY])
            }
            _ => unreachable!("all outcomes"),
        };
        counts[kind] += 1;
        let before = (0..=80).map(|k| deep(lower * f64::from(k) / 80.0)).fold(0.0, f64::max);
        assert!(upper == 0.0 || before < depth + 1e-12, "{seed}: {before} {depth} {outcome:?}");
        assert!(upper > 1.0 || deep(upper) > depth - 1e-12, "{seed}: {outcome:?}");
    }
    looks.sort_unstable();
    println!("{counts:?}, looks {} and {}", looks[looks.len() / 2], looks[looks.len() - 1]);
    assert!(counts[0] > 20 && counts[1] > 20 && counts[3] == 0, "{counts:?}");
}

/// Far from a contact, distances are computed to a relative accuracy only.
#[test]
fn contacts_take_few_samples_and_support_points() {
    let mesh = ring_sphere(60, 33);
    let of = |axes: DVec3| {
        let points: Vec<DVec3> = mesh.vertices.iter().map(|v| *v * axes).collect();
        ConvexPolyhedron::from_points(&points).expect("a body")
    };
    let [p, q] = [of(DVec3::new(1.0, 0.7, 0.4)), of(DVec3::new(0.5, 1.0, 0.6))];
    let (mut contacts, mut looks, mut supports) = (0, 0, 0);
    for seed in 0..200 {
        let mut random = Random::new(seed);
        let along = random_motion(&mut random, 6.0);
        let pose = Pose::new(random.rotation(), DVec3::ZERO).expect("a pose");
        let cast = MotionCast::new(p.with_motion(&along), q.at(pose)).expect("a cast");
        let outcome = cast.first_contact().expect("an answer");
        if let MotionOutcome::Contact(found) = &outcome {
            contacts += 1;
            (looks, supports) = (looks + found.steps.looks, supports + found.steps.supports);
        }
    }
    let [looks, supports] = [looks, supports].map(|n| f64::from(n) / f64::from(contacts));
    println!("{contacts} contacts: {looks} looks, {supports} support points");
    assert!(contacts > 50 && looks < 12.0 && supports < 32.0, "{looks} looks, {supports}");
}

#[test]
fn too_long_motions_return_coarse_error() {
    let cube = cuboid([1.0; 3]);
    let solid = Solid::from_convex(&cube).expect("a solid");
    let still = Motion::at_rest(at(3.0, 0.0, 0.0));
    for far in [1e20, 1e50, 1e60] {
        let slide = Motion::translation(Pose::IDENTITY, DVec3::X * far).expect("a motion");
        let cast =
            MotionCast::new(cube.with_motion(&slide), cube.with_motion(&still)).expect("a cast");
        let solids =
            MotionCast::new(solid.with_motion(&slide), solid.with_motion(&still)).expect("a cast");
        for found in [cast.first_contact().map(|_| ()), solids.first_contact().map(|_| ())] {
            assert!(matches!(found, Err(QueryError::PositionError { .. })), "{far:e}: {found:?}");
        }
        let found = cast.clearance().map(|_| ());
        assert!(matches!(found, Err(QueryError::PositionError { .. })), "{far:e}: {found:?}");
        // Bodies that move apart never meet, at any distance.
        let away = Motion::translation(at(1e60, 0.0, 0.0), DVec3::X * 1e40).expect("a motion");
        let cast =
            MotionCast::new(cube.with_motion(&away), cube.with_motion(&still)).expect("a cast");
        assert!(matches!(cast.first_contact(), Ok(MotionOutcome::Free(_))));
    }
}

#[test]
fn bodies_with_common_motion_are_free_if_apart_at_start() {
    let mut random = Random::new(17);
    for _ in 0..50 {
        let [p, q] = [hull(12, &mut random), hull(12, &mut random)];
        let [a, b] = [random.direction() * 2.5, random.direction() * -2.5];
        let [a, b] = [a, b].map(|t| Pose::new(random.rotation(), t).expect("a pose"));
        let apart = Pair::new(p.at(a), q.at(b)).expect("a pair").distance().expect("a distance");
        let (point, axis) = (random.vector() * 3.0, random.direction());
        let both = [a, b].map(|pose| Motion::screw(pose, point, axis, 3.0, 1.0).expect("a motion"));
        let outcome = checked_outcome([&p, &q], [&both[0], &both[1]], 0.0);
        assert_eq!(matches!(outcome, MotionOutcome::Free(_)), apart.lower > 0.0, "{outcome:?}");
    }
}

#[test]
fn bounds_are_equal_far_from_origin() {
    let cube = cuboid([0.5; 3]);
    let found = |far: DVec3| {
        let pose = Pose::from_translation(far + DVec3::X * 3.0).expect("a pose");
        let motion = Motion::free_flight(pose, pose.translation(), DVec3::X * -3.0, DVec3::Z * 2.0);
        let still = Motion::at_rest(Pose::from_translation(far).expect("a pose"));
        let found = expect_contact(checked_outcome(
            [&cube, &cube],
            [&motion.expect("a motion"), &still],
            0.0,
        ));
        [found.lower, found.upper]
    };
    assert_eq!(found(DVec3::ZERO), found(DVec3::splat(2.0_f64.powi(30))));
}

#[test]
fn modified_proof_is_rejected_or_equivalent() {
    let mut random = Random::new(23);
    let mut refused = 0;
    for _ in 0..60 {
        let [p, q] = [hull(10, &mut random), hull(10, &mut random)];
        let along = random_motion(&mut random, 4.0);
        let still = Motion::at_rest(Pose::IDENTITY);
        let cast = MotionCast::new(p.with_motion(&along), q.with_motion(&still)).expect("a cast");
        let outcome = cast.first_contact().expect("an answer");
        let original = proof_of(&outcome).clone();
        if original.spans.iter().all(Vec::is_empty) {
            continue;
        }
        let mut check = |change: &dyn Fn(&mut MotionProof)| {
            let mut changed = original.clone();
            change(&mut changed);
            if changed != original {
                let result = cast.verify(&changed);
                assert!(result.is_err() || result == cast.verify(&original), "{changed:?}");
                refused += u32::from(result.is_err());
            }
        };
        check(&|proof| proof.spans[0][0].time = 1e-3);
        check(&|proof| proof.spans[0][0].gap *= 1.0 + 1e-6);
        check(&|proof| proof.spans[0][0].normal = -proof.spans[0][0].normal);
        check(&|proof| proof.spans[0][0].normal *= 2.0);
        check(&|proof| {
            let last = proof.spans[0].len() - 1;
            proof.spans[0].drain(1..last.max(1));
        });
        check(&|proof| {
            if let Some(ProvenContact { time, .. }) = &mut proof.meeting {
                *time *= 0.5;
            }
        });
    }
    assert!(refused > 200, "{refused}");
    let cube = cuboid([0.5; 3]);
    let (along, still) = (Motion::at_rest(at(3.0, 0.0, 0.0)), Motion::at_rest(Pose::IDENTITY));
    let cast = MotionCast::new(cube.with_motion(&along), cube.with_motion(&still)).expect("a cast");
    let found = cast.first_contact().expect("an answer");
    let mut turned = proof_of(&found).clone();
    turned.spans.push(turned.spans[0].clone());
    assert!(matches!(cast.verify(&turned), Err(MotionProofError::Plane { span: 1, .. })));
}

#[test]
fn rotations_of_all_families_have_verified_proofs() {
    let mut contacts = 0;
    for (family, _) in FAMILIES {
        for seed in 0..6 {
            let setting = setting(family, seed);
            let bodies = setting.bodies().expect("bodies");
            let cast = setting.query(&bodies).expect("a query");
            let mut random = Random::new(seed);
            let (a, b) = (cast.moving_pose(), cast.fixed_pose());
            let between = a.translation().lerp(b.translation(), random.unit());
            let angle = random.range(-6.0, 6.0);
            let Ok(turn) = Motion::rotation_about(a, between, random.direction(), angle) else {
                continue;
            };
            let still = Motion::at_rest(b);
            let cast =
                MotionCast::new(cast.moving().with_motion(&turn), cast.fixed().with_motion(&still));
            let cast = cast.expect("a cast");
            let outcome = cast.first_contact().unwrap_or_else(|e| panic!("{family} {seed}: {e}"));
            let checked = cast.verify(proof_of(&outcome));
            assert!(checked.is_ok(), "{family} {seed}: {checked:?}");
            contacts += u32::from(matches!(outcome, MotionOutcome::Contact(_)));
        }
    }
    println!("{contacts}");
}

/// For bodies with tiny coordinates, the error of a computed place exceeds the gap.
#[test]
fn start_overlap_is_reported_for_any_minimum_gap() {
    let cube = |half: f64| {
        ConvexPolyhedron::cuboid(DVec3::splat(-half), DVec3::splat(half)).expect("a cube")
    };
    for (half, min_gap) in [(1e-50, 2.8e-60), (1e-50, 0.0), (1.0, 1e-18), (1.0, 1e-17), (1.0, 1e-3)]
    {
        let (p, q) = (cube(half), cube(2.0 * half));
        let axis = DVec3::new(1.0, 2.0, 3.0).normalize();
        let turn = Motion::rotation_about(Pose::IDENTITY, DVec3::ZERO, axis, 1.0).expect("a turn");
        let cast = MotionCast::new(p.with_motion(&turn), q.at(Pose::IDENTITY)).expect("a cast");
        let cast = cast.with_min_gap(min_gap).expect("a gap");
        let outcome = cast.first_contact().expect("an answer");
        assert!(matches!(outcome, MotionOutcome::Overlapping(_)), "{half} {min_gap}: {outcome:?}");
        assert_eq!(cast.verify(outcome.proof()).expect("it holds"), [0.0, 0.0]);
        let clearance = cast.clearance().expect("an answer");
        assert!(
            matches!(clearance, MotionClearance::Overlapping(_)),
            "{half} {min_gap}: {clearance:?}"
        );
    }
}

/// Two points have no size, so rounding errors of places do not make the query too coarse.
#[test]
fn two_points_passing_through_each_other_graze() {
    let point = ConvexPolyhedron::from_points(&[DVec3::ZERO]).expect("a point");
    let motion = Motion::translation(Pose::IDENTITY, DVec3::X * 4.0).expect("a motion");
    for x in [0.0, 1.0, 3.7] {
        let pose = Pose::from_translation(DVec3::X * x).expect("a pose");
        let cast = MotionCast::new(point.with_motion(&motion), point.at(pose)).expect("a cast");
        let outcome = cast.first_contact().expect("an answer");
        let MotionOutcome::Grazing(contact) = &outcome else { panic!("{outcome:?}") };
        assert!((contact.lower - 0.25 * x).abs() < 1e-12, "{}", contact.lower);
        cast.verify(outcome.proof()).expect("it holds");
    }
}

#[test]
fn ball_on_arm_meets_floor_at_time_of_closed_form() {
    let floor = cuboid(DVec3::new(20.0, 20.0, 1.0));
    for radius in [0.01, 0.25, 0.75] {
        // The centre of the ball falls on a circle of radius 2 about the y axis, from a height of 2 to one of 0.
        let ball = ConvexPolyhedron::sphere(DVec3::ZERO, radius).expect("a sphere");
        let start = at(0.0, 0.0, 2.0);
        let turn = Motion::rotation_about(start, DVec3::ZERO, DVec3::Y, FRAC_PI_2).expect("a turn");
        let top = floor.vertices().iter().map(|v| v.z).fold(f64::NEG_INFINITY, f64::max);
        let place = at(0.0, 0.0, -top);
        let cast = MotionCast::new(ball.with_motion(&turn), floor.at(place)).expect("a cast");
        let MotionOutcome::Contact(contact) = cast.first_contact().expect("an answer") else {
            panic!("the ball reaches the floor")
        };
        let time = (radius / 2.0).acos() / FRAC_PI_2;
        assert!(contact.lower <= time && time <= contact.upper, "{radius}: {time} {contact:?}");
        assert!(contact.upper - contact.lower < 1e-11, "{radius}: {contact:?}");
        let [lower, upper] = cast.verify(&contact.proof).expect("a proof");
        assert!(lower >= contact.lower && upper <= contact.upper);
    }
}

#[test]
fn rounded_bodies_move_as_their_cores_with_a_gap() {
    let mut random = Random::new(0x0b0e);
    let mut contacts = 0;
    for _ in 0..cases(200) {
        let cores = [hull(6, &mut random), hull(12, &mut random)];
        let radii = [0.0, 0.0].map(|_| random.range(0.0, 0.4) * f64::from(random.index(3) as u32));
        let round = |k: usize| cores[k].clone().rounded(radii[k]).expect("a radius");
        let bodies = [round(0), round(1)];
        let motions = [random_motion(&mut random, PI), Motion::at_rest(Pose::IDENTITY)];
        let [p, q] = [0, 1].map(|k| bodies[k].with_motion(&motions[k]));
        let cast = MotionCast::new(p, q).expect("a cast");
        let outcome = cast.first_contact().expect("an answer");
        cast.verify(proof_of(&outcome)).expect("a proof");
        let [p, q] = [0, 1].map(|k| cores[k].with_motion(&motions[k]));
        let gap = radii[0] + radii[1];
        let kept = MotionCast::new(p, q).and_then(|cast| cast.with_min_gap(gap)).expect("a cast");
        let expected = kept.first_contact().expect("an answer");
        match (&outcome, &expected) {
            (MotionOutcome::Free(_), MotionOutcome::Free(_))
            | (MotionOutcome::Overlapping(_), MotionOutcome::Overlapping(_)) => {}
            (
                MotionOutcome::Contact(a) | MotionOutcome::Grazing(a),
                MotionOutcome::Contact(b) | MotionOutcome::Grazing(b),
            ) => {
                assert!(a.lower <= b.upper && b.lower <= a.upper, "{a:?} {b:?}");
                contacts += 1;
            }
            other => panic!("{other:?}"),
        }
        // Nothing meets before the lower bound.
        let until = match &outcome {
            MotionOutcome::Contact(of) | MotionOutcome::Grazing(of) => of.lower,
            MotionOutcome::Overlapping(_) => 0.0,
            _ => 1.0,
        };
        for k in 0..8 {
            let [a, b] = [0, 1].map(|which: usize| {
                motions[which].pose_at(until * f64::from(k) / 8.0).expect("a pose")
            });
            let pair = Pair::new(bodies[0].at(a), bodies[1].at(b)).expect("a pair");
            let apart = pair.distance().expect("an answer");
            assert!(until == 0.0 || apart.upper > 0.0, "they meet before {until}");
        }
        cast.clearance().expect("an answer");
    }
    assert!(contacts > cases(20), "{contacts}");
}
