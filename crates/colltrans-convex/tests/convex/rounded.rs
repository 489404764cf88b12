//! Rounded bodies: closed forms, every family against exact arithmetic, degenerate cores, proofs and changed ones.

use std::f64::consts::PI;

use colltrans_convex::{
    BuildError, Cast, Clearance, Contact, ConvexPolyhedron, Depth, Distance, FreeReason, Outcome,
    Pair, Pose, Tracker, Within,
};
use colltrans_testkit::bodies::{at_xyz as at, block as cuboid};
use colltrans_testkit::cases;
use colltrans_testkit::oracle::min_gap::GapJudge;
use colltrans_testkit::oracle::rounded::{RoundedJudge, judge_all};
use colltrans_testkit::oracle::settings::{FAMILIES, setting};
use colltrans_testkit::random::Random;
use glam::{DQuat, DVec3};

fn sphere(radius: f64) -> ConvexPolyhedron {
    ConvexPolyhedron::sphere(DVec3::ZERO, radius).expect("a sphere")
}

fn capsule(half: DVec3, radius: f64) -> ConvexPolyhedron {
    ConvexPolyhedron::capsule([-half, half], radius).expect("a capsule")
}

/// The judged outcome of a cast.
fn judged_outcome(cast: &Cast) -> Outcome {
    let judge = GapJudge::new(*cast);
    let outcome = cast.first_contact().expect("an answer");
    judge.check(&outcome).expect("a right outcome");
    judge.check_clearance(&cast.clearance().expect("an answer")).expect("a right clearance");
    outcome
}

/// The judged first contact.
fn judged_contact(cast: &Cast) -> Contact {
    let Outcome::Contact(contact) = judged_outcome(cast) else { panic!("a contact") };
    contact
}

fn judged_pair(pair: &Pair) -> (Distance, Depth) {
    let judge = RoundedJudge::new(*pair);
    let (distance, depth) = (pair.distance().expect("an answer"), pair.depth().expect("an answer"));
    let width = judge.check(&distance).expect("a right distance");
    assert!(width <= 8.0, "{width} noises");
    let width = judge.check_depth(&depth, true).expect("a right depth");
    assert!(width <= 70.0, "{width} noises");
    for length in [0.0, 1e-3, 0.5 * distance.upper, distance.upper, 2.0 * distance.upper + 1.0] {
        judge.check_within(length, &pair.within(length).expect("an answer")).expect("right");
    }
    (distance, depth)
}

#[test]
fn spheres_meet_where_the_closed_form_says() {
    let mut random = Random::new(7);
    let mut contacts = 0;
    for _ in 0..cases(2000) {
        let scale = 10.0_f64.powf(random.range(-6.0, 6.0));
        let [r, s] = [0, 0].map(|_| 10.0_f64.powf(random.range(-2.0, 1.0)) * scale);
        let from = random.direction() * random.range(0.0, 20.0) * scale;
        let direction = random.direction();
        let (p, q) = (sphere(r), sphere(s));
        let start = Pose::from_translation(from).expect("a pose");
        let cast = Cast::new(p.at(start), q.at(Pose::IDENTITY), direction).expect("a query");
        let lateral = from.reject_from_normalized(direction).length();
        let sum = r + s;
        match judged_outcome(&cast) {
            Outcome::Contact(contact) => {
                let half = ((sum - lateral) * (sum + lateral)).sqrt();
                let first = -from.dot(direction) - half;
                // The bounds are those of a rounded square root near a graze.
                let off = 1e-13 * (from.length() + sum) * (1.0 + sum / half);
                assert!((contact.translation - first).abs() <= off, "{first} {contact:?}");
                let points = contact.witness_points(&cast);
                let met = points.on_moving + direction * contact.translation;
                assert!((met - points.on_fixed).length() <= off, "{met} {}", points.on_fixed);
                assert!((points.on_fixed.length() - s).abs() <= off);
                contacts += 1;
            }
            Outcome::Separated(separated) => {
                let margin = separated.certificate.margin;
                assert!((margin - (lateral - sum)).abs() <= 1e-13 * (from.length() + sum));
            }
            Outcome::Grazing(_) => assert!((lateral - sum).abs() <= 1e-12 * (from.length() + sum)),
        }
        let pair = Pair::new(p.at(start), q.at(Pose::IDENTITY)).expect("a pair");
        let (distance, depth) = judged_pair(&pair);
        let gap = from.length() - sum;
        let off = 1e-13 * (from.length() + sum);
        assert!((distance.upper - gap.max(0.0)).abs() <= off, "{gap} {distance:?}");
        assert!((depth.upper - (-gap).max(0.0)).abs() <= off, "{gap} {depth:?}");
    }
    assert!(contacts > cases(100), "{contacts}");
}

/// The Minkowski difference of parallel axes is a segment.
#[test]
fn parallel_capsules_are_as_far_apart_as_their_axes() {
    let bar = capsule(DVec3::X, 0.25);
    for x in [-4.0_f64, -2.0, -0.5, 0.0, 0.5, 1.0, 2.0, 4.0] {
        for z in [0.0, 1.0, 3.0] {
            let pair = Pair::new(bar.at(at(x, 0.0, z)), bar.at(Pose::IDENTITY)).expect("a pair");
            let distance = pair.distance().expect("an answer");
            RoundedJudge::new(pair).check(&distance).expect("a right distance");
            let gap = ((x.abs() - 2.0).max(0.0).hypot(z) - 0.5).max(0.0);
            assert!((distance.upper - gap).abs() < 1e-13, "{x} {z} {distance:?}");
        }
    }
}

/// A point or ball is near a face, an edge or a corner of a box, also at a distance of a few
/// noises. The bounds alone are in closed form.
#[test]
fn bounds_of_points_and_boxes_hold_and_are_narrow() {
    let mut random = Random::new(11);
    let mut closer = 0;
    for k in 0..cases(4000) {
        let scale = 10.0_f64.powf(random.range(-3.0, 3.0));
        let center = random.direction() * (random.range(0.0, 10.0) * scale);
        let half = DVec3::from_array([(); 3].map(|()| random.range(0.01, 1.0) * scale));
        let block = cuboid(center - half, center + half);
        let rounded = if k % 3 == 0 { random.range(0.0, 0.5) * scale } else { 0.0 };
        let block = block.rounded(rounded).expect("a body");
        let radius = if k % 5 == 0 { 0.0 } else { 10.0_f64.powf(random.range(-3.0, 0.0)) * scale };
        let apart = if k % 2 == 0 { 10.0_f64.powf(random.range(-17.0, 0.0)) } else { 1.0 } * scale;
        // Coordinates within the box, on its surface, or outside of it.
        let place = half.to_array().map(|side| match random.index(3) {
            0 => random.range(-side, side),
            1 => side,
            _ => side + apart * random.range(0.0, 1.0),
        });
        let at_box =
            Pose::new(random.rotation(), random.direction() * (3.0 * scale)).expect("a pose");
        let at_ball = if k % 4 == 0 { at_box } else { Pose::IDENTITY };
        let at_point = center + DVec3::from_array(place);
        let middle = if k % 4 == 0 { at_point } else { at_box.transform_point(at_point) };
        let ball = ConvexPolyhedron::from_points(&[middle]).and_then(|point| point.rounded(radius));
        let ball = ball.expect("a body");
        let placed = [ball.at(at_ball), block.at(at_box)];
        for [moving, fixed] in [placed, [placed[1], placed[0]]] {
            let pair = Pair::new(moving, fixed).expect("a pair");
            let judge = RoundedJudge::new(pair);
            let bounds = pair.distance_bounds().expect("bounds");
            judge.check_bounds(bounds).expect("right bounds");
            let width = (bounds[1] - bounds[0]) / judge.noise;
            assert!(width <= 8.0, "{k}: {width} noises");
            closer += u32::from(bounds[0] > 0.0 && bounds[0] < 100.0 * judge.noise);
        }
    }
    assert!(closer > 20, "{closer}");
}

/// Bodies that slide along each other meet within a long interval. Their points are those at its end.
#[test]
fn contact_points_of_sliding_bodies_are_on_their_surfaces() {
    let block = cuboid(DVec3::splat(-0.5), DVec3::splat(0.5));
    let (moving, fixed) =
        (block.clone().rounded(0.4375).expect("a body"), block.rounded(0.0625).expect("a body"));
    let mut sliding = 0;
    for k in 1..40 {
        let turn = DQuat::from_axis_angle(DVec3::NEG_Y, 5e-12);
        let place = DVec3::new(-1.5 + f64::from(k) * -5e-14, 0.25, -0.5);
        let pose = Pose::new(turn, place).expect("a pose");
        let cast = Cast::new(moving.at(pose), fixed.at(Pose::IDENTITY), DVec3::Z).expect("a cast");
        let answers = judge_all(&cast, &mut Tracker::new(), 0.25, false).expect("right answers");
        let Outcome::Contact(contact) = answers.expect("answers").outcome else { continue };
        sliding += u32::from(contact.certificate.upper - contact.certificate.lower > 1e-4);
    }
    assert!(sliding > 5, "{sliding}");
}

#[test]
fn a_capsule_meets_edges_faces_and_corners_of_a_box() {
    let table = cuboid(DVec3::splat(-1.0), DVec3::splat(1.0));
    let down = |body: &ConvexPolyhedron, pose: Pose| {
        let cast = Cast::new(body.at(pose), table.at(Pose::IDENTITY), DVec3::NEG_Z);
        judged_contact(&cast.expect("a query")).translation
    };
    let along_x = capsule(DVec3::X * 3.0, 0.5);
    // Over the face, over an edge at half of the radius, and across a corner.
    assert!((down(&along_x, at(0.0, 0.0, 5.0)) - 3.5).abs() < 1e-13);
    let beside = 5.0 - 1.0 - (0.25_f64 - 0.0625).sqrt();
    assert!((down(&along_x, at(0.0, 1.25, 5.0)) - beside).abs() < 1e-13);
    let ball = sphere(0.5);
    let corner = 5.0 - 1.0 - (0.25_f64 - 2.0 * 0.04).sqrt();
    assert!((down(&ball, at(1.2, 1.2, 5.0)) - corner).abs() < 1e-13);
    // A box with rounded edges onto a ball: the sum of the radii counts.
    let rounded = table.clone().rounded(0.125).expect("a rounded box");
    let cast = Cast::new(ball.at(at(1.2, 1.2, 5.0)), rounded.at(Pose::IDENTITY), DVec3::NEG_Z);
    let contact = judged_contact(&cast.expect("a query"));
    assert!((contact.translation - (4.0 - (0.625_f64.powi(2) - 0.08).sqrt())).abs() < 1e-13);
    // Into the corner of two walls and a floor, along the diagonal of the room.
    let floor = cuboid(DVec3::new(-9.0, -9.0, -2.0), DVec3::new(9.0, 9.0, -1.0));
    let cast =
        Cast::new(ball.at(at(0.0, 0.0, 1.0)), floor.at(Pose::IDENTITY), DVec3::new(1.0, 1.0, -1.0));
    assert!((judged_contact(&cast.expect("a query")).translation - 1.5).abs() < 1e-13);
}

#[test]
fn a_large_ball_lands_on_a_small_cuboid_and_a_small_one_on_a_large_floor() {
    // Floors of many sizes below a ball: libraries that step or iterate in single precision stop short of them.
    for size in [1.0, 1e2, 1e4, 1e6, 1e8] {
        let floor = cuboid(DVec3::new(-size, -size, -1.0), DVec3::new(size, size, 0.0));
        for radius in [0.05, 0.5, 55.0, 136.0] {
            let start = at(0.123 * size, -0.377 * size, 1000.0);
            let ball = sphere(radius);
            let cast = Cast::new(ball.at(start), floor.at(Pose::IDENTITY), DVec3::NEG_Z);
            let contact = judged_contact(&cast.expect("a query"));
            let off = (contact.translation - (1000.0 - radius)).abs();
            assert!(off <= 1e-14 * (size + 1000.0), "{size} {radius}: {off:e}");
        }
    }
}

#[test]
fn rounded_bodies_of_all_families_are_right() {
    let (mut contacts, mut deep) = (0, 0);
    for (family, _) in FAMILIES {
        for seed in 0..cases(12) {
            let setting = setting(family, seed);
            let bodies = setting.bodies().expect("bodies");
            let mut random = Random::new(seed ^ 0x0b0d);
            let Ok(plain) = setting.query(&bodies) else { continue };
            let size = bodies.moving.vertices().iter().map(|v| v.length()).fold(1e-3, f64::max);
            let mut radius = || match random.index(4) {
                0 => 0.0,
                _ => size * 10.0_f64.powf(random.range(-12.0, 1.0)),
            };
            let round = |body: &ConvexPolyhedron, radius: f64| body.clone().rounded(radius);
            let (Ok(moving), Ok(fixed)) =
                (round(&bodies.moving, radius()), round(&bodies.fixed, radius()))
            else {
                continue;
            };
            let [p, q] = [moving.at(plain.moving_pose()), fixed.at(plain.fixed_pose())];
            let cast = Cast::new(p, q, plain.direction()).expect("a query");
            contacts += u32::from(matches!(judged_outcome(&cast), Outcome::Contact(_)));
            let kept = cast.with_min_gap(0.3 * size).expect("a gap");
            judged_outcome(&kept);
            let pair = Pair::new(p, q).expect("a pair");
            let judge = RoundedJudge::new(pair);
            judge.check(&pair.distance().expect("an answer")).expect("a right distance");
            let depth = pair.depth().expect("an answer");
            let few = moving.vertices().len() * fixed.vertices().len() <= 64;
            judge.check_depth(&depth, few).expect("a right depth");
            deep += u32::from(depth.lower > 0.0);
        }
    }
    assert!(contacts > cases(200) && deep > cases(50), "{contacts} {deep}");
}

/// Settings whose answers were once wrong or refused.
#[test]
fn rounded_bodies_of_single_settings_are_right() {
    let answers_to = |family, seed, [r, s]: [f64; 2]| {
        let setting = setting(family, seed);
        let bodies = setting.bodies().expect("bodies");
        let moving = bodies.moving.rounded(r).expect("a rounded body");
        let fixed = bodies.fixed.rounded(s).expect("a rounded body");
        let [p, q] = [moving.at(setting.moving_pose), fixed.at(setting.fixed_pose)];
        let cast = Cast::new(p, q, setting.direction).expect("a query");
        let found = judge_all(&cast, &mut Tracker::new(), 0.25, false).expect("right answers");
        found.expect("answers")
    };
    // The input reaches 27 noises beyond the vertices, and the certificate states this excess twice.
    answers_to("narrow-rings", 4_294_972_037, [0.324_498_621_002_215_16; 2]);
    // A sample of the distance lies inside of the difference of the cores.
    let radii = [1.521_887_221_190_571_3e-13, 5.920_844_419_922_884e-14];
    answers_to("nearly-straight", 4_294_973_763, radii);
    // The cores meet in a tetrahedron that is flatter than rounded volumes resolve.
    let radii = [2.778_831_260_381_336e-14, 1.409_793_752_603_092e-14];
    let flat = answers_to("nearly-straight", 4_294_969_181, radii);
    assert_eq!(flat.distance.upper, 0.0);
    // The shadows of the cores are farther apart than the sum of the radii by 13 noises.
    let peg = answers_to("peg", 4_294_969_511, [1.032_445_940_458_028_2e-14; 2]);
    assert!(matches!(peg.outcome, Outcome::Separated(_)), "{:?}", peg.outcome);
}

#[test]
fn concentric_and_touching_bodies_have_depths() {
    let world = Pose::IDENTITY;
    let (ball, point) = (sphere(2.0), sphere(0.0));
    let depth = |p: &ConvexPolyhedron, q: &ConvexPolyhedron, x: f64| {
        judged_pair(&Pair::new(p.at(at(x, 0.0, 0.0)), q.at(world)).expect("a pair")).1
    };
    // Concentric spheres, a point inside a sphere, a segment through a sphere.
    assert!((depth(&ball, &sphere(1.0), 0.0).upper - 3.0).abs() < 1e-14);
    assert!((depth(&ball, &point, 0.5).upper - 1.5).abs() < 1e-14);
    assert!((depth(&ball, &capsule(DVec3::X * 9.0, 0.25), 0.5).upper - 2.25).abs() < 1e-13);
    // A ball whose centre is inside a cube: the way out and the radius.
    let cube = cuboid(DVec3::NEG_ONE, DVec3::ONE);
    let found = depth(&ball, &cube, 0.75);
    assert!((found.upper - 2.25).abs() < 1e-13 && found.upper - found.lower < 1e-13, "{found:?}");
    // The centre on a face.
    assert!((depth(&ball, &cube, 1.0).upper - 2.0).abs() < 1e-13);
    assert_eq!(depth(&ball, &cube, 3.5).upper, 0.0);
}

#[test]
fn clearance_range_and_intersection_refer_to_the_round_surfaces() {
    let (ball, cube) = (sphere(0.5), cuboid(DVec3::NEG_ONE, DVec3::ONE));
    let cast = |x: f64, z: f64, direction: DVec3| {
        let pose = at(x, 0.0, z);
        Cast::new(ball.at(pose), cube.at(Pose::IDENTITY), direction).expect("a query")
    };
    let range = cast(0.0, 5.0, DVec3::NEG_Z).contact_range().expect("an answer");
    let [first, last] = range.interval().expect("it goes through");
    assert!((first - 3.5).abs() < 1e-13 && (last - 6.5).abs() < 1e-13);
    assert!(cast(0.0, 1.49, DVec3::X).intersects().expect("an answer").meets);
    assert!(!cast(0.0, 1.51, DVec3::X).intersects().expect("an answer").meets);
    let slides = cast(0.0, 1.5, DVec3::X).clearance().expect("an answer");
    assert!(matches!(slides, Clearance::Free(FreeReason::Slides(_))), "{slides:?}");
    let above = cast(0.0, 1.5, DVec3::Z).clearance().expect("an answer");
    assert!(matches!(above, Clearance::Free(FreeReason::Behind(_))), "{above:?}");
    let depth = cast(0.0, 1.25, DVec3::NEG_Z).directional_depth().expect("an answer");
    assert!((depth.depth - 0.25).abs() < 1e-13);
    let pair = Pair::new(ball.at(at(0.0, 0.0, 2.0)), cube.at(Pose::IDENTITY)).expect("a pair");
    assert!(matches!(pair.within(0.5001).expect("an answer"), Within::Closer(_)));
    assert!(matches!(pair.within(0.4999).expect("an answer"), Within::Farther(_)));
}

#[test]
fn trackers_follow_rounded_bodies() {
    let capsule = capsule(DVec3::X, 0.25);
    let cube = cuboid(DVec3::NEG_ONE, DVec3::ONE).rounded(0.125).expect("a rounded cube");
    let mut tracker = Tracker::new();
    for step in 0..cases(200) {
        let turn = DQuat::from_rotation_z(0.01 * f64::from(step as u32));
        let from = DVec3::new(0.004 * f64::from(step as u32), 0.3, 4.0);
        let pose = Pose::new(turn, from).expect("a pose");
        let cast = Cast::new(capsule.at(pose), cube.at(Pose::IDENTITY), DVec3::NEG_Z);
        let cast = cast.expect("a query");
        let outcome = tracker.first_contact(&cast).expect("an answer");
        GapJudge::new(cast).check(&outcome).expect("right");
        let pair = Pair::new(capsule.at(pose), cube.at(Pose::IDENTITY)).expect("a pair");
        let distance = tracker.distance(&pair).expect("an answer");
        RoundedJudge::new(pair).check(&distance).expect("right");
    }
}

#[test]
fn forged_proofs_of_rounded_bodies_are_refused() {
    let (ball, cube) = (sphere(0.5), cuboid(DVec3::NEG_ONE, DVec3::ONE));
    let start = at(1.25, 0.0, 5.0);
    let cast = Cast::new(ball.at(start), cube.at(Pose::IDENTITY), DVec3::NEG_Z).expect("a query");
    let proof = judged_contact(&cast).certificate;
    let mut forged = proof;
    forged.lower += 1e-9;
    assert!(cast.verify(&forged).is_err());
    let mut forged = proof;
    forged.upper = proof.lower - 1e-9;
    forged.lower = forged.upper;
    assert!(cast.verify(&forged).is_err());
    // The same proof does not hold for a larger or a smaller ball.
    for radius in [0.5 - 1e-9, 0.5 + 1e-9] {
        let other = sphere(radius);
        let cast = Cast::new(other.at(start), cube.at(Pose::IDENTITY), DVec3::NEG_Z);
        assert!(cast.expect("a query").verify(&proof).is_err(), "{radius}");
    }
    let aside = Cast::new(ball.at(at(2.0, 0.0, 5.0)), cube.at(Pose::IDENTITY), DVec3::NEG_Z);
    let aside = aside.expect("a query");
    let Outcome::Separated(separated) = judged_outcome(&aside) else { panic!("it passes") };
    let mut forged = separated.certificate;
    assert!((forged.margin - 0.5).abs() < 1e-13);
    forged.margin += 1e-9;
    assert!(aside.verify(&forged).is_err());
    let pair = Pair::new(ball.at(at(0.0, 0.0, 1.25)), cube.at(Pose::IDENTITY)).expect("a pair");
    let depth = judged_pair(&pair).1;
    for (lower, upper) in [(1e-9, 0.0), (0.0, -1e-9)] {
        let mut forged = depth.clone();
        forged.lower += lower;
        forged.upper += upper;
        assert!(pair.verify(&forged).is_err());
    }
    let mut forged = depth;
    forged.near = None;
    assert!(pair.verify(&forged).is_err());
}

#[test]
fn volumes_follow_the_formula_of_steiner() {
    let ball = 4.0 / 3.0 * PI;
    assert!((sphere(1.0).volume() - ball).abs() < 1e-14);
    assert!((capsule(DVec3::X, 1.0).volume() - (ball + 2.0 * PI)).abs() < 1e-14);
    let plate = cuboid(DVec3::ZERO, DVec3::new(2.0, 3.0, 0.0)).rounded(1.0).expect("a plate");
    assert!((plate.volume() - (12.0 + 5.0 * PI + ball)).abs() < 1e-13);
    let cube = cuboid(DVec3::ZERO, DVec3::ONE).rounded(1.0).expect("a rounded cube");
    assert!((cube.volume() - (1.0 + 6.0 + 3.0 * PI + ball)).abs() < 1e-13);
}

#[test]
fn invalid_radii_are_refused() {
    for radius in [-1.0, f64::NAN, f64::INFINITY, 1e300, 1e-300] {
        let refused = ConvexPolyhedron::sphere(DVec3::ZERO, radius);
        assert!(matches!(refused, Err(BuildError::Radius { .. })), "{radius}");
    }
    let twice = sphere(1.0).rounded(0.5).expect("rounded again");
    assert_eq!(twice.radius(), 1.5);
}

#[test]
fn depth_of_rounded_bodies_is_verified_with_the_length_of_its_direction() {
    // The cores are apart, so that a direction longer than 1 would shorten the distance that it proves.
    for (radii, x, length, upper) in [
        ([0.974_744_170_612_464_4, 0.974_744_170_612_464_7], 1.949_488_341_224_928_9, 2.0, 0.0),
        ([0.849_913_577_866_475_3; 2], 1.693_278_552_380_736_5, 4.0, 0.006_548_603_352_213_523),
    ] {
        let [p, q] = radii.map(sphere);
        let pair = Pair::new(p.at(Pose::IDENTITY), q.at(at(x, 0.0, 0.0))).expect("a pair");
        let honest = pair.depth().expect("an answer");
        pair.verify(&honest).expect("it holds");
        let mut forged = honest;
        forged.direction = DVec3::NEG_X * (1.0 + length * f64::EPSILON);
        (forged.lower, forged.upper, forged.near) = (0.0, upper, None);
        assert!(pair.verify(&forged).is_err(), "{radii:?}");
    }
}

#[test]
fn points_of_closer_bodies_are_on_the_round_surfaces() {
    let (ball, cube) = (sphere(0.5), cuboid(DVec3::NEG_ONE, DVec3::ONE));
    let points = |z: f64, length: f64| {
        let pair = Pair::new(ball.at(at(0.0, 0.0, z)), cube.at(Pose::IDENTITY)).expect("a pair");
        let Within::Closer(near) = pair.within(length).expect("an answer") else {
            panic!("they are closer")
        };
        colltrans_convex::pair::nearest_points_in_world(&pair.bodies, &near)
    };
    let [on_ball, on_cube] = points(2.0, 1.0);
    assert!((on_ball.z - 1.5).abs() < 1e-13 && (on_cube.z - 1.0).abs() < 1e-13);
    let [common, same] = points(1.25, 0.0);
    assert!(common == same && common.z >= 0.75 && common.z <= 1.0, "{common}");
}

#[test]
fn spheres_meet_faces_edges_and_vertices_of_boxes_where_closed_forms_say() {
    let mut random = Random::new(11);
    let mut counts = [0; 4];
    for _ in 0..cases(1000) {
        let half =
            DVec3::new(random.range(0.2, 2.0), random.range(0.2, 2.0), random.range(0.2, 2.0));
        let radius = random.range(0.1, 1.5);
        let ball = sphere(radius);
        let table = cuboid(-half, half);
        // Towards a point of the box or beside it, from outside.
        let target = random.vector() * half * 1.2;
        let from = target + random.direction() * 8.0;
        let direction = (target - from).normalize();
        let start = Pose::from_translation(from).expect("a pose");
        let cast = Cast::new(ball.at(start), table.at(Pose::IDENTITY), direction).expect("a query");
        // Coordinates in which the centre is outside of the box.
        let outside = |at: DVec3| (at - at.clamp(-half, half)).to_array().map(|x| x != 0.0);
        match judged_outcome(&cast) {
            Outcome::Contact(contact) => {
                let center = from + direction * contact.translation;
                let nearest = center.clamp(-half, half);
                let off = center.distance(nearest) - radius;
                assert!(off.abs() <= 1e-12, "{off:e} {contact:?}");
                let normal = (nearest - center).normalize();
                // A plane that is off by this angle proves a bound that is lower by at most 15 noises.
                let slack = (30.0 * 16.0 * f64::EPSILON * 16.0 / radius).sqrt();
                assert!(contact.normal.distance(normal) <= slack, "{} {normal}", contact.normal);
                let points = contact.witness_points(&cast);
                assert!(points.on_fixed.distance(nearest) <= slack, "{points:?} {nearest}");
                counts[outside(center).iter().filter(|is| **is).count()] += 1;
            }
            Outcome::Separated(_) | Outcome::Grazing(_) => {}
        }
        let pair = Pair::new(ball.at(start), table.at(Pose::IDENTITY)).expect("a pair");
        let (distance, _) = judged_pair(&pair);
        let truth = from.distance(from.clamp(-half, half)) - radius;
        assert!((distance.upper - truth.max(0.0)).abs() <= 1e-12, "{truth} {distance:?}");
    }
    let [inside, faces, edges, vertices] = counts;
    assert_eq!(inside, 0);
    assert!(faces.min(edges).min(vertices) > cases(30), "{counts:?}");
}

#[test]
fn a_ball_stops_in_the_corner_between_three_planes() {
    // Walls below, behind and beside; the ball moves along the diagonal into the corner.
    let ball = sphere(0.75);
    let walls = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| {
        let low = DVec3::splat(-9.0);
        (cuboid(low, DVec3::splat(9.0) - axis * 9.0), axis)
    });
    let start = at(2.0, 3.0, 2.5);
    let stops = walls.map(|(wall, axis)| {
        let cast = Cast::new(ball.at(start), wall.at(Pose::IDENTITY), DVec3::NEG_ONE);
        let contact = judged_contact(&cast.expect("a query"));
        assert!(contact.normal.distance(-axis) < 1e-14);
        contact.translation
    });
    for (stop, expected) in stops.into_iter().zip([1.25, 2.25, 1.75]) {
        assert!((stop - expected).abs() < 1e-14, "{stops:?}");
    }
}

#[test]
fn capsules_meet_each_other_where_closed_forms_say() {
    let mut random = Random::new(23);
    let mut contacts = 0;
    for _ in 0..cases(1000) {
        let [r, s] = [0; 2].map(|_| random.range(0.05, 0.8));
        let halves = [0; 2].map(|_| random.direction() * random.range(0.0, 2.0));
        let (p, q) = (capsule(halves[0], r), capsule(halves[1], s));
        let from = random.direction() * 6.0;
        let start = Pose::from_translation(from).expect("a pose");
        let direction = (random.direction() - from).normalize();
        let cast = Cast::new(p.at(start), q.at(Pose::IDENTITY), direction).expect("a query");
        let pair = Pair::new(p.at(start), q.at(Pose::IDENTITY)).expect("a pair");
        let apart =
            |at: DVec3| segment_distance([at - halves[0], at + halves[0]], [-halves[1], halves[1]]);
        let (distance, _) = judged_pair(&pair);
        let truth = (apart(from) - r - s).max(0.0);
        assert!((distance.upper - truth).abs() <= 1e-12, "{truth} {distance:?}");
        if let Outcome::Contact(contact) = judged_outcome(&cast) {
            let off = apart(from + direction * contact.translation) - r - s;
            assert!(off.abs() <= 1e-12, "{off:e}");
            contacts += 1;
        }
    }
    assert!(contacts > cases(300), "{contacts}");
}

/// The distance of two segments: of their lines if its ends are within both, otherwise from an end to the other one.
fn segment_distance(a: [DVec3; 2], b: [DVec3; 2]) -> f64 {
    let from_point = |p: DVec3, [a, b]: [DVec3; 2]| {
        let along = b - a;
        let t = (p - a).dot(along) / along.length_squared().max(1e-300);
        p.distance(a + along * t.clamp(0.0, 1.0))
    };
    let ends = [from_point(a[0], b), from_point(a[1], b), from_point(b[0], a), from_point(b[1], a)];
    let least = ends.into_iter().fold(f64::INFINITY, f64::min);
    let (u, v, w) = (a[1] - a[0], b[1] - b[0], a[0] - b[0]);
    let [uu, uv, vv, uw, vw] = [u.dot(u), u.dot(v), v.dot(v), u.dot(w), v.dot(w)];
    let det = uu * vv - uv * uv;
    let [s, t] = [uv * vw - vv * uw, uu * vw - uv * uw].map(|x| x / det);
    let are_within = det > 0.0 && (0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t);
    if are_within { least.min((w + u * s - v * t).length()) } else { least }
}

/// parry issue 429: a ball stops up to 139 mm short of a large floor.
#[test]
fn published_ball_lands_on_large_cuboids() {
    let ball = sphere(0.5166);
    for half in [5.0, 50.0, 500.0, 5000.0] {
        let floor = cuboid(DVec3::new(-half, -1.0, -half), DVec3::new(half, 0.0, half));
        for i in 0..cases(100) {
            let height = 1.177 + 2e-4 * f64::from(i);
            let aside = 9e-3 * half * f64::from(i);
            let start = at(aside, height, -0.7 * aside);
            let cast = Cast::new(ball.at(start), floor.at(Pose::IDENTITY), DVec3::NEG_Y);
            let contact = judged_contact(&cast.expect("a query"));
            let off = (contact.translation - (height - 0.5166)).abs();
            assert!(off <= contact.certificate.rounding, "{half}, step {i}: {off:e}");
        }
    }
}

/// `PhysX` issue 501: a vertical capsule swept down onto the edge of a triangle enters it.
#[test]
fn published_capsule_stops_at_the_edge_of_a_triangle() {
    let capsule = capsule(DVec3::Y * 0.5, 0.5);
    let corners = [DVec3::ZERO, DVec3::new(0.0, 0.0, 4.0), DVec3::new(4.0, 0.0, 0.0)];
    let triangle = ConvexPolyhedron::from_points(&corners).expect("a triangle");
    // The edge from the origin along z; the capsule is beside the triangle, or over it.
    for aside in [0.4999, 0.4, 0.1, 1e-9, 0.0, -0.3] {
        let start = at(-aside, 3.0, 1.0);
        let cast = Cast::new(capsule.at(start), triangle.at(Pose::IDENTITY), DVec3::NEG_Y);
        let contact = judged_contact(&cast.expect("a query"));
        let beside = f64::max(aside, 0.0);
        let expected = 3.0 - 0.5 - (0.25 - beside * beside).sqrt();
        assert!((contact.translation - expected).abs() < 1e-12, "{aside}: {contact:?}");
    }
}

/// coal issue 351: a sphere of radius 55 beside a cylinder of radius 136, which it enters by 0.061.
#[test]
fn published_sphere_enters_a_cylinder() {
    let sides = 4000;
    let points: Vec<DVec3> = [-50.0, 50.0]
        .into_iter()
        .flat_map(|z| colltrans_testkit::shapes::ring(sides, 136.0, z))
        .collect();
    let cylinder = ConvexPolyhedron::from_points(&points).expect("a prism");
    let rotation = glam::DMat3::from_cols(DVec3::NEG_Z, DVec3::X, DVec3::NEG_Y);
    let placed = Pose::from_matrix(rotation, DVec3::new(0.0, 0.0, 776.5)).expect("a pose");
    let (center, ball) = (DVec3::new(140.834, -45.449, 905.432), sphere(55.0));
    let start = Pose::from_translation(center).expect("a pose");
    let pair = Pair::new(ball.at(start), cylinder.at(placed)).expect("a pair");
    let depth = pair.depth().expect("an answer");
    RoundedJudge::new(pair).check_depth(&depth, false).expect("a right depth");
    let radial = center.x.hypot(center.z - 776.5);
    let truth = 55.0 + 136.0 - radial;
    let chord_error = 136.0 * (1.0 - (PI / sides as f64).cos());
    assert!((0.06..0.063).contains(&truth) && chord_error < 1e-4);
    assert!(depth.lower <= truth && truth <= depth.upper + chord_error, "{truth} {depth:?}");
    assert!(depth.lower > 0.06, "{depth:?}");
    assert_eq!(pair.distance().expect("an answer").upper, 0.0);
}
