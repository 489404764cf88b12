//! PQP against all pairs of triangles, and against the exact distance.

mod walks;

use colltrans::Pose;
use colltrans_oracle::distance::brute_force;
use colltrans_oracle::settings::Rng;
use colltrans_yardsticks::Proximity;
use colltrans_yardsticks::pqp::{Pqp, Soup, SoupError, Steps};
use glam::DVec3;
use walks::{Placed, coherent, hard_settings, random_settings, worst_of};

/// Largest error as a share of the size.
const ACCURACY: f64 = 1e-13;

fn answer(placed: &Placed) -> Proximity<Steps> {
    let [moving, fixed] = [&placed.moving, &placed.fixed].map(Soup::of_polyhedron);
    Pqp::new(&moving, &fixed).distance(&placed.moving_pose, &placed.fixed_pose)
}

/// Surfaces are not solids: settings in which one body is inside the other are left out.
fn error(placed: &Placed) -> f64 {
    let answer = answer(placed);
    if !placed.is_apart() && answer.distance > 1e-6 * placed.size() {
        let (p, q) = (placed.moving.volume(), placed.fixed.volume());
        assert!(p != q, "{}: surfaces of one size must meet", placed.name);
        return 0.0;
    }
    placed.verdict(answer.distance, answer.on_moving, answer.on_fixed, false)
}

#[test]
fn random_solids() {
    let (worst, name) = worst_of(random_settings(2_000), error);
    assert!(worst <= ACCURACY, "{name}: {worst:e}");
}

#[test]
fn tied_solids() {
    let (worst, name) = worst_of(hard_settings(100), error);
    assert!(worst <= ACCURACY, "{name}: {worst:e}");
}

/// Triangles anywhere, slivers among them, some with common corners.
fn soup(rng: &mut Rng, count: usize) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let vertices: Vec<DVec3> =
        (0..count).map(|_| rng.vector() * DVec3::new(1.0, 1.0, 0.3)).collect();
    let mut corner = || rng.int(0, count as i64 - 1) as u32;
    let triangles = (0..count).map(|_| [corner(), corner(), corner()]).collect();
    (vertices, triangles)
}

/// The least distance over all pairs of triangles, each pair a soup of its own.
fn over_all_pairs(
    (p, s): &(Vec<DVec3>, Vec<[u32; 3]>),
    (q, t): &(Vec<DVec3>, Vec<[u32; 3]>),
    pose: &Pose,
) -> f64 {
    let mut least = f64::INFINITY;
    for a in s {
        let moving = Soup::new(p, &[*a]).unwrap();
        for b in t {
            let fixed = Soup::new(q, &[*b]).unwrap();
            let near = Pqp::new(&moving, &fixed).distance(pose, &Pose::IDENTITY);
            least = least.min(near.distance);
        }
    }
    least
}

#[test]
fn any_triangles() {
    let mut rng = Rng::new(21);
    for round in 0..200 {
        let (a, b) = (soup(&mut rng, 24), soup(&mut rng, 17));
        let apart = rng.direction() * [0.0, 0.4, 1.5, 6.0][round % 4];
        let pose = Pose::new(rng.rotation(), apart).unwrap();
        let least = over_all_pairs(&a, &b, &pose);
        let (moving, fixed) = (Soup::new(&a.0, &a.1).unwrap(), Soup::new(&b.0, &b.1).unwrap());
        let mut solver = Pqp::new(&moving, &fixed);
        let near = solver.distance(&pose, &Pose::IDENTITY);
        assert!((near.distance - least).abs() < 1e-13, "{round}: {} {least}", near.distance);
        assert!((near.on_moving.distance(near.on_fixed) - least).abs() < 1e-13);
        let rough = solver.distance_within(&pose, &Pose::IDENTITY, 0.1, 0.0).distance;
        assert!(rough <= 1.1 * least + 1e-13 && rough >= least - 1e-13);
        for share in [0.5, 0.999, 1.001, 2.0] {
            if least > 0.0 {
                let (within, _) = solver.is_within(&pose, &Pose::IDENTITY, share * least);
                assert_eq!(within, share > 1.0, "{round}: {share}");
            }
        }
        let (meet, _) = solver.intersects(&pose, &Pose::IDENTITY);
        if least == 0.0 || least > 1e-9 {
            assert_eq!(meet, least == 0.0, "{round}");
        }
    }
}

#[test]
fn a_coherent_query_is_the_same_and_cheaper() {
    let mut rng = Rng::new(22);
    let (mut warm, mut cold) = (0, 0);
    for placed in random_settings(100).filter(Placed::is_apart) {
        let [moving, fixed] = [&placed.moving, &placed.fixed].map(Soup::of_polyhedron);
        let mut solver = Pqp::new(&moving, &fixed);
        for (step, at) in coherent(&placed, 2.5e-3, 20, &mut rng).iter().enumerate() {
            let tracked = solver.distance(&at.moving_pose, &at.fixed_pose);
            let fresh = Pqp::new(&moving, &fixed).distance(&at.moving_pose, &at.fixed_pose);
            assert!((tracked.distance - fresh.distance).abs() <= 1e-13 * at.size());
            if step > 0 {
                warm += tracked.steps.volume_tests;
                cold += fresh.steps.volume_tests;
            }
        }
    }
    assert!(warm < cold, "{warm} volume tests tracked, {cold} from scratch");
}

#[test]
fn the_oracle_and_the_tree_agree_on_larger_solids() {
    let mut rng = Rng::new(23);
    for placed in walks::large(300, 10, &mut rng) {
        let bodies = [(&placed.moving, &placed.moving_pose), (&placed.fixed, &placed.fixed_pose)];
        let exact = brute_force(bodies[0], bodies[1]);
        let found = answer(&placed);
        assert!((found.distance - exact).abs() <= 1e-12 * placed.size());
        // The tree looks at a small part of all pairs.
        assert!(found.steps.triangle_tests < 2_000, "{:?}", found.steps);
    }
}

#[test]
fn what_is_no_soup_is_refused() {
    assert_eq!(Soup::new(&[DVec3::ZERO], &[]).unwrap_err(), SoupError::Empty);
    let far = Soup::new(&[DVec3::ZERO; 3], &[[0, 1, 2], [0, 1, 3]]).unwrap_err();
    assert_eq!(far, SoupError::NoSuchVertex { triangle: 1, vertex: 3 });
    let nan = Soup::new(&[DVec3::ZERO, DVec3::NAN], &[[0, 1, 1]]).unwrap_err();
    assert_eq!(nan, SoupError::NotFinite { vertex: 1 });
    assert!(far.to_string().contains("triangle 1"));
}
