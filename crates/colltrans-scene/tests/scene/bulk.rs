//! Many casts of bodies with fixed rotations, by the faces of their difference: against ordinary casts and exact
//! arithmetic, random and degenerate; proofs and modified proofs, counts of visited faces.

use colltrans_convex::{
    Cast, Clearance, ContactRange, ConvexPolyhedron, Outcome, Pose, Solver, StartedFrom,
};
use colltrans_scene::FixedRotations;
use colltrans_testkit::bodies::hull;
use colltrans_testkit::cases;
use colltrans_testkit::oracle::settings::{FAMILIES, setting};
use colltrans_testkit::oracle::still;
use colltrans_testkit::random::Random;
use glam::{DQuat, DVec3};

/// Number of settings of a family.
const SETTINGS: u64 = 16;

#[test]
fn answers_match_ordinary_casts_and_exact_judge() {
    let (mut wrong, mut by_faces, mut answers) = (Vec::new(), 0, 0);
    for (family, seed) in
        FAMILIES.iter().flat_map(|f| (0..cases(SETTINGS)).map(move |seed| (f.0, seed)))
    {
        let setting = setting(family, seed);
        let bodies = setting.bodies().expect("bodies");
        let [p, q] = [bodies.moving.at(setting.moving_pose), bodies.fixed.at(setting.fixed_pose)];
        let rotations = FixedRotations::new(p, q);
        let approach = rotations.for_direction(setting.direction).expect("a direction");
        let mut random = Random::new(seed);
        for which in 0..still::CASTS {
            let Ok(cast) = still::cast(&setting, &bodies, which, &mut random) else { continue };
            match still::ask(&rotations, &approach, &cast, &setting, seed == 0) {
                Err(objection) => wrong.push(format!("{setting} {which}: {objection}")),
                Ok(findings) => {
                    for (who, outcome, verdict) in findings {
                        answers += 1;
                        by_faces += u32::from(is_by_faces(&outcome));
                        if let Err(objection) = verdict {
                            wrong.push(format!("{setting} {which} {who}: {objection}"));
                        }
                    }
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    // The settings include hard ones, for example flat bodies.
    assert!(2 * by_faces > answers, "{by_faces} of {answers}");
}

fn is_by_faces(outcome: &Outcome) -> bool {
    outcome.steps().started_from == StartedFrom::Difference
}

/// Returns poses with a common rotation, and their common direction.
fn poses_along_direction(count: usize, random: &mut Random) -> Vec<(Pose, DVec3)> {
    let (turn, along) = (random.rotation(), random.direction());
    let side = along.any_orthonormal_vector();
    let place = |random: &mut Random| {
        let [x, y] = [0; 2].map(|_| random.range(-2.2, 2.2));
        let at = side * x + along.cross(side) * y - along * random.range(2.0, 6.0);
        (Pose::new(turn, at).expect("a pose"), along)
    };
    (0..count).map(|_| place(random)).collect()
}

/// In general position, casts are answered by the faces and visit two to four of them.
#[test]
fn casts_in_general_position_visit_few_faces() {
    for (n, most) in [(8, 3.0), (16, 3.0), (64, 4.5)] {
        let mut random = Random::new(n as u64);
        let [p, q] = [hull(n, &mut random), hull(n, &mut random)];
        let world = Pose::new(random.rotation(), DVec3::ZERO).expect("a pose");
        let placements = poses_along_direction(2_000, &mut random);
        let rotations = FixedRotations::new(p.at(placements[0].0), q.at(world));
        let approach = rotations.for_direction(placements[0].1).expect("a direction");
        let (mut left, mut visited) = ([0; 2], [0; 2]);
        for (pose, along) in &placements {
            let cast = Cast::new(p.at(*pose), q.at(world), *along).expect("a query");
            let outcomes = [rotations.first_contact(&cast), approach.first_contact(&cast)];
            for (k, outcome) in outcomes.into_iter().enumerate() {
                let outcome = outcome.expect("an answer");
                left[k] += u32::from(!is_by_faces(&outcome));
                visited[k] += outcome.steps().pivots;
                assert!(outcome.steps().supports == 0 || !is_by_faces(&outcome));
            }
        }
        println!("{n}: {left:?} left, {visited:?} faces");
        let mean = visited.map(|visited| f64::from(visited) / placements.len() as f64);
        assert!(left.iter().all(|left| *left <= 10), "{left:?} of {n} vertices are left");
        assert!(mean[0] < most && mean[1] < 2.2, "{mean:?} faces of {n} vertices");
    }
}

/// Axis-aligned boxes along an axis: their sides are parallel to the direction, and lines pass through the middles of
/// faces.
#[test]
fn axis_aligned_boxes_are_answered_by_faces_unless_grazing() {
    let cube = ConvexPolyhedron::cuboid(-DVec3::ONE, DVec3::ONE).expect("a cube");
    let rotations = FixedRotations::new(cube.at(Pose::IDENTITY), cube.at(Pose::IDENTITY));
    let approach = rotations.for_direction(DVec3::X).expect("a direction");
    let (mut by_faces, mut all) = ([0; 2], 0);
    for y in -12..=12 {
        for z in -12..=12 {
            let place = DVec3::new(-8.0, 0.25 * f64::from(y), 0.25 * f64::from(z));
            let pose = Pose::from_translation(place).expect("a pose");
            let cast =
                Cast::new(cube.at(pose), cube.at(Pose::IDENTITY), DVec3::X).expect("a query");
            let ordinary = cast.first_contact().expect("an answer");
            let grazing = matches!(ordinary, Outcome::Grazing(_));
            all += u32::from(!grazing);
            let outcomes = [rotations.first_contact(&cast), approach.first_contact(&cast)];
            for (k, outcome) in outcomes.into_iter().enumerate() {
                let outcome = outcome.expect("an answer");
                assert_eq!(is_by_faces(&outcome), !grazing, "{place}");
                by_faces[k] += u32::from(is_by_faces(&outcome));
                if let (Outcome::Contact(a), Outcome::Contact(b)) = (outcome, ordinary) {
                    assert_eq!((a.translation, a.normal), (b.translation, b.normal));
                }
            }
        }
    }
    assert_eq!(by_faces, [all; 2], "all except grazing casts");
}

#[test]
fn modified_certificate_is_rejected() {
    let mut random = Random::new(3);
    let [p, q] = [hull(20, &mut random), hull(20, &mut random)];
    let world = Pose::new(random.rotation(), DVec3::ZERO).expect("a pose");
    let placements = poses_along_direction(300, &mut random);
    let rotations = FixedRotations::new(p.at(placements[0].0), q.at(world));
    let (mut contacts, mut separations) = (0, 0);
    for (pose, along) in &placements {
        let cast = Cast::new(p.at(*pose), q.at(world), *along).expect("a query");
        match rotations.first_contact(&cast).expect("an answer") {
            Outcome::Contact(contact) => {
                contacts += 1;
                let proof = contact.certificate;
                assert!(cast.verify(&proof).expect("a proof") <= proof.rounding);
                assert!(proof.gap() <= proof.rounding && proof.gap() < 1e-13 * 8.0 / 0.01);
                assert!((proof.lower..=proof.upper).contains(&contact.translation));
                let mut changed = [proof; 6];
                changed[0].lower += 2.0 * proof.rounding;
                changed[1].upper -= 2.0 * proof.rounding;
                changed[2].pairs[0] = changed[2].pairs[1];
                changed[3].weights.swap(0, 1);
                changed[4].normal = -proof.normal;
                changed[5].rounding *= 1e3;
                for (which, changed) in changed.into_iter().enumerate() {
                    assert!(cast.verify(&changed).is_err(), "{which}: {changed:?}");
                }
            }
            Outcome::Separated(separated) => {
                separations += 1;
                let proof = separated.certificate;
                assert!(cast.verify(&proof).expect("a proof") >= proof.margin);
                let mut changed = [proof; 2];
                changed[0].margin += 1e-13;
                changed[1].normal = DQuat::from_axis_angle(*along, 2.0) * proof.normal;
                assert!(changed.iter().all(|changed| cast.verify(changed).is_err()), "{proof:?}");
            }
            Outcome::Grazing(_) => {}
        }
    }
    assert!(contacts > 60 && separations > 60, "{contacts} and {separations}");
}

#[test]
fn ranges_and_clearances_match_ordinary_casts() {
    let mut random = Random::new(11);
    let [p, q] = [hull(12, &mut random), hull(30, &mut random)];
    let world = Pose::new(random.rotation(), DVec3::ZERO).expect("a pose");
    let placements = poses_along_direction(300, &mut random);
    let rotations = FixedRotations::new(p.at(placements[0].0), q.at(world));
    let approach = rotations.for_direction(placements[0].1).expect("a direction");
    for (pose, along) in &placements {
        for back in [0.0, 4.0, 8.0] {
            let pose = pose.translated_by(*along * back).expect("a pose");
            let cast = Cast::new(p.at(pose), q.at(world), *along).expect("a query");
            // Both are infinite for bodies that pass each other.
            let near = |a: f64, b: f64| a == b || (a - b).abs() < 1e-11;
            let ordinary = cast.contact_range().expect("an answer").interval();
            let ways = [rotations.contact_range(&cast), approach.contact_range(&cast)];
            for range in ways.map(|way| way.expect("an answer")) {
                match (range.interval(), ordinary) {
                    (None, None) => assert!(matches!(range, ContactRange::Separated(_))),
                    (Some(a), Some(b)) => assert!(near(a[0], b[0]) && near(a[1], b[1])),
                    (a, b) => panic!("{a:?}, ordinarily {b:?}"),
                }
            }
            let ordinary = cast.clearance().expect("an answer");
            let ways = [rotations.clearance(&cast), approach.clearance(&cast)];
            for clearance in ways.map(|way| way.expect("an answer")) {
                let kind = |c: &Clearance| std::mem::discriminant(c);
                assert_eq!(kind(&clearance), kind(&ordinary));
                match (clearance.distance(), ordinary.distance()) {
                    (Some(a), Some(b)) => assert!(near(a, b), "{a} and {b}"),
                    (a, b) => assert_eq!(a, b),
                }
            }
        }
    }
}

#[test]
fn bits_are_independent_of_order_and_threads() {
    let mut random = Random::new(5);
    let [p, q] = [hull(16, &mut random), hull(16, &mut random)];
    let world = Pose::new(random.rotation(), DVec3::ZERO).expect("a pose");
    let placements = poses_along_direction(400, &mut random);
    let rotations = FixedRotations::new(p.at(placements[0].0), q.at(world));
    let approach = rotations.for_direction(placements[0].1).expect("a direction");
    let one = |(pose, along): &(Pose, DVec3)| {
        let cast = Cast::new(p.at(*pose), q.at(world), *along).expect("a query");
        [rotations.first_contact(&cast), approach.first_contact(&cast)].map(|o| o.expect("one"))
    };
    let in_order: Vec<_> = placements.iter().map(one).collect();
    let mut backwards: Vec<_> = placements.iter().rev().map(one).collect();
    backwards.reverse();
    assert_eq!(in_order, backwards);
    let halves = std::thread::scope(|scope| {
        let threads = placements
            .chunks(200)
            .map(|part| scope.spawn(move || part.iter().map(one).collect::<Vec<_>>()));
        let threads: Vec<_> = threads.collect();
        threads.into_iter().flat_map(|t| t.join().expect("a thread")).collect::<Vec<_>>()
    });
    assert_eq!(in_order, halves);
    // Faces that are computed again give the same bits.
    let again = FixedRotations::new(p.at(placements[7].0), q.at(world));
    let (pose, along) = placements[0];
    let cast = Cast::new(p.at(pose), q.at(world), along).expect("a query");
    assert_eq!(again.first_contact(&cast), Ok(in_order[0][0]));
    // Contacts have the same bits by both methods.
    let same = in_order.iter().filter(|[any, one]| match (any, one) {
        (Outcome::Contact(a), Outcome::Contact(b)) => a.certificate == b.certificate,
        _ => false,
    });
    assert!(same.count() > 100);
}

/// Casts that the faces do not support have the bits of ordinary casts.
#[test]
fn unsupported_casts_match_ordinary_casts_bitwise() {
    let mut random = Random::new(9);
    let [p, q] = [hull(10, &mut random), hull(10, &mut random)];
    let turn = random.rotation();
    let pose = Pose::new(turn, DVec3::new(-4.0, 0.1, 0.2)).expect("a pose");
    let rotations = FixedRotations::new(p.at(pose), q.at(Pose::IDENTITY));
    let cast = Cast::new(p.at(pose), q.at(Pose::IDENTITY), DVec3::X).expect("a query");
    assert!(is_by_faces(&rotations.first_contact(&cast).expect("an answer")));
    let turned = Pose::new(DQuat::from_rotation_z(1e-9) * turn, pose.translation());
    let turned = p.at(turned.expect("a pose"));
    let swapped = [q.at(pose), p.at(Pose::IDENTITY)];
    let others = [
        Cast::new(turned, q.at(Pose::IDENTITY), DVec3::X).expect("a query"),
        Cast::new(swapped[0], swapped[1], DVec3::X).expect("a query"),
        cast.with_min_gap(0.25).expect("a gap"),
        cast.with_solver(Solver::Cta),
        cast.with_graze_tolerance(100.0).expect("a tolerance"),
    ];
    for other in others {
        assert_eq!(rotations.first_contact(&other), other.first_contact());
    }
    // Flat bodies, and bodies with too many vertices.
    let square =
        ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::new(1.0, 1.0, 0.0)).expect("a square");
    let large = hull(200, &mut random);
    assert_eq!(FixedRotations::break_even_casts(&square, &square), None);
    assert_eq!(FixedRotations::break_even_casts(&large, &large), None);
    assert!(FixedRotations::break_even_casts(&p, &large).is_some_and(|casts| casts > 500));
    for body in [square, large] {
        let rotations = FixedRotations::new(body.at(pose), body.at(Pose::IDENTITY));
        let cast = Cast::new(body.at(pose), body.at(Pose::IDENTITY), DVec3::X).expect("a query");
        let approach = rotations.for_direction(DVec3::X).expect("a direction");
        assert_eq!(rotations.first_contact(&cast), cast.first_contact());
        assert_eq!(approach.first_contact(&cast), cast.first_contact());
    }
    assert!(rotations.for_direction(DVec3::ZERO).is_err());
}
