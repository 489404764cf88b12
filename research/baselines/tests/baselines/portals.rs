//! Portal refinement and growth distance against the exact distance of scaled bodies.
//!
//! Bodies that are scaled about their centres by less than the growth distance are apart, and by more overlap.

use colltrans::{ConvexPolyhedron, Pose};
use colltrans_baselines::growth::GrowthDistance;
use colltrans_baselines::mpr::Mpr;
use colltrans_testkit::bodies::body;
use colltrans_testkit::oracle::distance::distance_of_bodies;
use colltrans_testkit::random::Random;
use colltrans_testkit::shapes::ring_sphere;
use glam::DVec3;

/// Returns a solid: the hull of points in a box or on an ellipsoid, or an ellipsoid with vertices in rings.
fn solid(rng: &mut Random) -> ConvexPolyhedron {
    let axes = DVec3::from_array([0; 3].map(|_| rng.range(0.3, 1.3) * rng.pick(&[1.0, 1.0, 20.0])));
    if rng.one_in(4) {
        let around = rng.int(3, 12) as u32;
        return body(&ring_sphere(around, around).mapped(|v| v * axes).vertices);
    }
    let (n, round) = (rng.int(5, 30), rng.one_in(2));
    let point = |rng: &mut Random| if round { rng.direction() } else { rng.vector() };
    loop {
        let found = body(&(0..n).map(|_| axes * point(rng)).collect::<Vec<_>>());
        if found.dimension() == 3 {
            return found;
        }
    }
}

/// Returns a body scaled about the mean of its vertices.
fn scaled(solid: &ConvexPolyhedron, factor: f64) -> ConvexPolyhedron {
    let centre = solid.vertices().iter().sum::<DVec3>() / solid.vertices().len() as f64;
    body(&solid.vertices().iter().map(|v| centre + (*v - centre) * factor).collect::<Vec<_>>())
}

/// Checks with exact arithmetic whether bodies overlap after scaling.
fn meet(p: &ConvexPolyhedron, q: &ConvexPolyhedron, at: &Pose, factor: f64) -> bool {
    let [p, q] = [p, q].map(|body| scaled(body, factor));
    distance_of_bodies((&p, at), (&q, &Pose::IDENTITY)).intersects()
}

#[test]
fn growth_distance_separates_scaled_bodies_that_meet_from_others() {
    let mut rng = Random::new(11);
    let (mut apart, mut overlapping) = (0, 0);
    for case in 0..400 {
        let (p, q) = (solid(&mut rng), solid(&mut rng));
        let away = rng.direction() * rng.pick(&[0.3, 2.0, 30.0]) * rng.range(0.5, 1.5);
        let at = Pose::new(rng.rotation(), away).unwrap();
        let growth = GrowthDistance::new(&p, &q).distance(&at, &Pose::IDENTITY);
        assert!(growth.is_converged, "case {case}: {growth:?}");
        // The bounds, and the vertices of the scaled bodies, are rounded.
        let rounding = 1e-9;
        assert!(growth.upper / growth.lower <= 1.0 + 1e-7, "case {case}: {growth:?}");
        assert!(!meet(&p, &q, &at, growth.lower * (1.0 - rounding)), "case {case}: {growth:?}");
        assert!(meet(&p, &q, &at, growth.upper * (1.0 + rounding)), "case {case}: {growth:?}");
        apart += u32::from(growth.lower > 1.0);
        overlapping += u32::from(growth.upper < 1.0);
    }
    assert!(apart > 100 && overlapping > 100, "{apart} {overlapping}");
}

/// Bodies at a growth distance just below and above 1 are a hard case of the overlap query.
#[test]
fn portal_refinement_finds_overlap_of_bodies_near_contact() {
    let mut rng = Random::new(12);
    let mut climbed = 0;
    for case in 0..400 {
        let (p, q) = (solid(&mut rng), solid(&mut rng));
        let at = Pose::new(rng.rotation(), rng.direction() * rng.range(2.0, 40.0)).unwrap();
        let growth = GrowthDistance::new(&p, &q).distance(&at, &Pose::IDENTITY);
        for excess in [-0.5, -1e-2, -1e-5, 1e-5, 1e-2, 0.5] {
            let factor = growth.upper * (1.0 + excess);
            let [p, q] = [&p, &q].map(|body| scaled(body, factor));
            let expected = distance_of_bodies((&p, &at), (&q, &Pose::IDENTITY)).intersects();
            assert_eq!(expected, excess > 0.0, "case {case}, {excess}");
            let found = Mpr::new(&p, &q).with_tolerance(1e-12).overlap(&at, &Pose::IDENTITY);
            assert_eq!(found.overlaps, Some(expected), "case {case}, {excess}: {found:?}");
            climbed += found.steps.climbed;
        }
    }
    assert!(climbed > 0);
}

/// A body inside another one, and equal centres.
#[test]
fn concentric_bodies_overlap() {
    let mut rng = Random::new(13);
    for _ in 0..20 {
        let q = solid(&mut rng);
        let p = scaled(&q, 0.25);
        for offset in [DVec3::ZERO, DVec3::X * 1e-9] {
            let at = Pose::from_translation(offset).unwrap();
            assert_eq!(Mpr::new(&p, &q).overlap(&at, &Pose::IDENTITY).overlaps, Some(true));
            let growth = GrowthDistance::new(&p, &q).distance(&at, &Pose::IDENTITY);
            assert!(growth.upper < 1e-3 && growth.is_converged, "{growth:?}");
        }
    }
}
