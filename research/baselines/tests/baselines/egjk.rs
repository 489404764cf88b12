//! Enhanced GJK against the exact distance.
//!
//! Requirements on every answer, with the rounding error `noise = 32 u S` of a point of the Minkowski difference:
//! - The distance and that of the nearest points have errors of at most the stated gap and two noises, one for each
//!   bound.
//! - The nearest points are within one noise of their bodies.
//! - The gap is at most [`GOAL`] of the size.

use std::f64::consts::TAU;

use colltrans::{ConvexPolyhedron, Pose};
use colltrans_baselines::Proximity;
use colltrans_baselines::egjk::{Egjk, Steps, SupportSearch};
use colltrans_testkit::bodies::body;
use colltrans_testkit::oracle::distance::{Distance, distance_of_bodies, distance_of_point};
use colltrans_testkit::oracle::scene::size;
use colltrans_testkit::oracle::settings::{FAMILIES, setting};
use colltrans_testkit::random::Random;
use colltrans_testkit::shapes::{cuboid, ring_sphere};
use glam::{DQuat, DVec3};

type Placed<'a> = (&'a ConvexPolyhedron, &'a Pose);

/// The gap that is tolerated, in units of the size: simplices that are thin up to rounding miss a
/// gap of one noise.
const GOAL: f64 = 1e-12;

fn noise(moving: Placed, fixed: Placed) -> f64 {
    16.0 * f64::EPSILON * size([moving.0.vertices(), fixed.0.vertices()], [moving.1, fixed.1])
}

fn check(name: &str, answer: &Proximity<Steps>, moving: Placed, fixed: Placed) -> Distance {
    let exact = distance_of_bodies(moving, fixed);
    let truth = exact.to_f64();
    let noise = noise(moving, fixed);
    // Answers are in the world, at whatever distance from its origin.
    let away = 4.0 * f64::EPSILON * (answer.on_moving.length() + answer.on_fixed.length());
    let error = (answer.distance - truth).abs();
    let report = format!("{name}: {answer:?}, exactly {truth:e}, noise {noise:e}");
    let stated = answer.steps.gap + 2.0 * noise;
    assert!(error <= stated, "distance: {report}");
    assert!(answer.steps.gap <= GOAL * noise / (16.0 * f64::EPSILON), "gap: {report}");
    let between = answer.on_moving.distance(answer.on_fixed);
    assert!((between - truth).abs() <= stated + away, "nearest points: {report}");
    for (point, body) in [(answer.on_moving, moving), (answer.on_fixed, fixed)] {
        let off = distance_of_point(point, body).to_f64();
        assert!(off <= noise + away, "{off:e} off its body: {report}");
    }
    exact
}

fn check_from_scratch(name: &str, moving: Placed, fixed: Placed) -> Distance {
    let egjk = || Egjk::new(moving.0, fixed.0);
    for search in [SupportSearch::Linear, SupportSearch::FirstVertex] {
        let mut other = egjk().with_support_search(search);
        check(name, &other.distance(moving.1, fixed.1), moving, fixed);
    }
    check(name, &egjk().distance(moving.1, fixed.1), moving, fixed)
}

/// Returns the hull of 4 to 20 points in a box or on an ellipsoid, stretched by up to `stretch`.
fn cloud(rng: &mut Random, stretch: f64) -> ConvexPolyhedron {
    let axes = DVec3::from_array([0; 3].map(|_| rng.range(0.3, 1.3) * rng.pick(&[1.0, stretch])));
    let (n, round) = (rng.int(4, 20), rng.one_in(2));
    let points: Vec<DVec3> =
        (0..n).map(|_| axes * if round { rng.direction() } else { rng.vector() }).collect();
    body(&points)
}

fn pose(rng: &mut Random, away: f64) -> Pose {
    Pose::new(rng.rotation(), rng.direction() * away).unwrap()
}

/// Returns an ellipsoid with vertices in rings.
fn rings(count: u32, semi_axes: DVec3) -> ConvexPolyhedron {
    let points = ring_sphere(count, count).mapped(|v| v * semi_axes).vertices;
    body(&points)
}

/// Moves `moving` along the shortest vector until the distance is `gap`, up to rounding.
fn brought_near(moving: Placed, fixed: Placed, gap: f64) -> Option<Pose> {
    let exact = distance_of_bodies(moving, fixed);
    (!exact.intersects()).then(|| {
        let shortest = exact.shortest;
        moving.1.translated_by(shortest - shortest.normalize() * gap).unwrap()
    })
}

#[test]
fn distances_of_all_families_are_exact() {
    for (family, _) in FAMILIES {
        for seed in 0..150 {
            let setting = setting(family, seed);
            let bodies = setting.bodies().unwrap();
            let moving = (&bodies.moving, &setting.moving_pose);
            let fixed = (&bodies.fixed, &setting.fixed_pose);
            check_from_scratch(&setting.to_string(), moving, fixed);
        }
    }
}

/// With linear search every support point visits all vertices.
#[test]
fn linear_search_visits_all_vertices() {
    let mut rng = Random::new(9);
    for count in [5, 40] {
        let (p, q) = (rings(count, DVec3::ONE), rings(count, DVec3::ONE));
        let (at, world) = (pose(&mut rng, 3.0), pose(&mut rng, 0.0));
        let mut egjk = Egjk::new(&p, &q).with_support_search(SupportSearch::Linear);
        let steps = egjk.distance(&at, &world).steps;
        let vertices = p.vertices().len() + q.vertices().len();
        assert!(steps.supports > 0);
        assert_eq!(steps.climbed as usize, steps.supports as usize * vertices);
    }
}

#[test]
fn random_bodies_at_all_distances() {
    let mut rng = Random::new(1);
    let (mut apart, mut near, mut met) = (0, 0, 0);
    for case in 0..1000 {
        let stretch = rng.pick(&[1.0, 1.0, 30.0, 1000.0]);
        let (p, q) = (cloud(&mut rng, stretch), cloud(&mut rng, stretch));
        let away = rng.pick(&[0.0, 0.5, 2.0, 3.0]) * stretch;
        let (at, world) = (pose(&mut rng, away), pose(&mut rng, 0.0));
        let (moving, fixed) = ((&p, &at), (&q, &world));
        let exact = check_from_scratch(&format!("case {case}"), moving, fixed);
        if exact.intersects() {
            met += 1;
            continue;
        }
        apart += 1;
        for gap in [1e-3, 1e-6, 1e-9, 1e-12, 0.0, -1e-12, -1e-9, -1e-3] {
            let at = brought_near(moving, fixed, gap).unwrap();
            check_from_scratch(&format!("case {case}, gap {gap:e}"), (&p, &at), fixed);
            near += 1;
        }
    }
    assert!(apart > 200 && near > 2000 && met > 200, "{apart} {near} {met}");
}

#[test]
fn one_inside_the_other() {
    let mut rng = Random::new(2);
    for case in 0..200 {
        let stretch = rng.pick(&[1.0, 100.0]);
        let q = cloud(&mut rng, stretch);
        let small: Vec<DVec3> = q.vertices().iter().map(|v| *v * 0.25).collect();
        let centre = small.iter().sum::<DVec3>() * (3.0 / small.len() as f64);
        let small: Vec<DVec3> = small.iter().map(|v| *v + centre).collect();
        let p = body(&small);
        let at = pose(&mut rng, 7.0);
        let exact = check_from_scratch(&format!("case {case}"), (&p, &at), (&q, &at));
        assert!(exact.intersects());
        let exact = check_from_scratch(&format!("case {case} turned"), (&q, &at), (&p, &at));
        assert!(exact.intersects());
    }
}

/// Faces, edges and corners in exact contact.
#[test]
fn boxes_on_a_grid() {
    let mut rng = Random::new(3);
    for case in 0..600 {
        let (p, q) =
            (body(&cuboid(rng.grid(1, 3)).vertices), body(&cuboid(rng.grid(1, 3)).vertices));
        let place = |rng: &mut Random| {
            let turn = DQuat::from_rotation_z(TAU / 8.0 * rng.pick(&[0.0, 0.0, 1.0, 2.0]));
            Pose::new(turn, rng.grid(-5, 5)).unwrap()
        };
        let (at, other) = (place(&mut rng), place(&mut rng));
        check_from_scratch(&format!("case {case}"), (&p, &at), (&q, &other));
    }
}

#[test]
fn points_segments_and_polygons() {
    let mut rng = Random::new(4);
    for case in 0..600 {
        let mut flat = || {
            let n = rng.int(1, 6);
            let whole = rng.one_in(2);
            let points: Vec<DVec3> = (0..n)
                .map(|_| if whole { rng.grid(-2, 2) } else { rng.vector() * 2.0 })
                .map(|v| DVec3::new(v.x, v.y, 0.0))
                .collect();
            body(&points)
        };
        let (p, q) = (flat(), flat());
        let turned = rng.one_in(2);
        let at = if turned {
            pose(&mut rng, 1.0)
        } else {
            Pose::from_translation(rng.grid(-2, 2)).unwrap()
        };
        check_from_scratch(&format!("case {case}"), (&p, &at), (&q, &Pose::IDENTITY));
    }
}

/// A common displacement does not change the accuracy of the distance.
#[test]
fn common_displacement_costs_no_accuracy() {
    let mut rng = Random::new(5);
    for case in 0..100 {
        let (p, q) = (cloud(&mut rng, 1.0), cloud(&mut rng, 1.0));
        let far = rng.grid(-9, 9) * 2.0_f64.powi(20);
        let at = pose(&mut rng, 2.0).translated_by(far).unwrap();
        let other = pose(&mut rng, 0.0).translated_by(far).unwrap();
        check_from_scratch(&format!("case {case}"), (&p, &at), (&q, &other));
    }
}

/// The remembered state may save time, but not change the answer.
#[test]
fn coherence_does_not_change_answers() {
    let mut rng = Random::new(6);
    for case in 0..60 {
        let stretch = rng.pick(&[1.0, 1000.0]);
        let (p, q) = (cloud(&mut rng, stretch), cloud(&mut rng, stretch));
        let mut coherent = Egjk::new(&p, &q);
        let mut at = pose(&mut rng, 2.5 * stretch);
        let (turn, step) = (rng.pick(&[0.3, 1e-3]), rng.pick(&[0.5, 1e-2]) * stretch);
        for tick in 0..40 {
            let rotation = DQuat::from_axis_angle(rng.direction(), turn) * at.rotation();
            let there = at.translation() + rng.direction() * step - at.translation() * 0.02;
            at = Pose::new(rotation.normalize(), there).unwrap();
            let (moving, fixed) = ((&p, &at), (&q, &Pose::IDENTITY));
            let answer = coherent.distance(moving.1, fixed.1);
            check(&format!("case {case}, tick {tick}"), &answer, moving, fixed);
            let scratch = Egjk::new(&p, &q).distance(moving.1, fixed.1);
            let off = (scratch.distance - answer.distance).abs();
            let stated = scratch.steps.gap + answer.steps.gap + 2.0 * noise(moving, fixed);
            assert!(off <= stated, "case {case}, tick {tick}: {off:e}");
        }
    }
}

#[test]
fn repeated_query_takes_one_iteration_until_reset() {
    let (p, q) = (rings(20, DVec3::new(1.0, 0.7, 1.3)), rings(20, DVec3::ONE));
    let at = Pose::new(DQuat::from_rotation_x(0.4), DVec3::new(3.0, 1.0, 0.5)).unwrap();
    let mut egjk = Egjk::new(&p, &q);
    let first = egjk.distance(&at, &Pose::IDENTITY);
    let again = egjk.distance(&at, &Pose::IDENTITY);
    assert_eq!(again.distance, first.distance);
    assert_eq!((again.steps.iterations, again.steps.supports, again.steps.climbed), (1, 1, 2));
    egjk.reset();
    assert_eq!(egjk.distance(&at, &Pose::IDENTITY), first);
}

/// From the first vertex, every climb of a query from scratch crosses the body again. A later query starts at the last
/// support points in both modes.
#[test]
fn first_vertex_starts_climbs_of_queries_from_scratch_only() {
    let (p, q) = (rings(60, DVec3::new(1.0, 0.7, 1.3)), rings(60, DVec3::ONE));
    let mut rng = Random::new(8);
    let mut solvers = [SupportSearch::Climbing, SupportSearch::FirstVertex]
        .map(|search| Egjk::new(&p, &q).with_support_search(search));
    let mut climbed = [0; 2];
    for _ in 0..20 {
        let (at, world) = (pose(&mut rng, 4.0), pose(&mut rng, 0.0));
        for (egjk, climbed) in solvers.iter_mut().zip(&mut climbed) {
            egjk.reset();
            *climbed += egjk.distance(&at, &world).steps.climbed;
            let again = egjk.distance(&at, &world).steps;
            assert_eq!((again.iterations, again.supports, again.climbed), (1, 1, 2));
        }
    }
    assert!(climbed[1] > 2 * climbed[0], "{climbed:?}");
}

#[test]
fn large_bodies() {
    let mut rng = Random::new(7);
    for axes in [DVec3::new(1.2, 0.7, 1.0), DVec3::new(1e-3, 1e-3, 1.0), DVec3::new(1.0, 1.0, 1e-3)]
    {
        let (p, q) = (rings(45, axes), rings(45, axes));
        let mut coherent = Egjk::new(&p, &q);
        for case in 0..4 {
            let (at, world) = (pose(&mut rng, 3.0), pose(&mut rng, 0.0));
            let (moving, fixed) = ((&p, &at), (&q, &world));
            check_from_scratch(&format!("{axes}, case {case}"), moving, fixed);
            for gap in [1e-3, 1e-6, 1e-9, -1e-6] {
                let at = brought_near(moving, fixed, gap).unwrap();
                let answer = coherent.distance(&at, &world);
                check(&format!("{axes}, case {case}, gap {gap:e}"), &answer, (&p, &at), fixed);
            }
        }
    }
}
