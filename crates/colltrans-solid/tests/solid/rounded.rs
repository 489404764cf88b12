//! Rounded solids: exact arithmetic over all pairs of facets, closed forms, rounded convex bodies, proofs, refusals.

use colltrans_convex::{
    BuildError, Cast, Clearance, ConvexPolyhedron, Outcome, Pair, Pose, Within,
};
use colltrans_solid::proof::{DistanceCertificate, SolidCertificate};
use colltrans_solid::{AsSolid, Solid, SolidCast, SolidError, SolidNear, SolidPair};
use colltrans_testkit::bodies::{at_xyz as at, block, centered, floor_with_wall, hull};
use colltrans_testkit::cases;
use colltrans_testkit::oracle::settings;
use colltrans_testkit::oracle::solids::min_gap::examine;
use colltrans_testkit::oracle::solids::nearest::{MESHES, Setting};
use colltrans_testkit::oracle::solids::settings::FAMILIES;
use colltrans_testkit::oracle::solids::sheets;
use colltrans_testkit::random::Random;
use glam::DVec3;

/// Largest difference of an answer from its closed form: 32 noises of a configuration of size 32, the largest here. The
/// proven bounds of solids are about 20 noises below the answer.
const CLOSE: f64 = 32.0 * 16.0 * f64::EPSILON * 32.0;

fn families() -> impl Iterator<Item = String> {
    let convex = settings::FAMILIES.iter().map(|family| format!("convex-{}", family.0));
    let known = FAMILIES.into_iter().chain(sheets::FAMILIES).chain(MESHES).map(str::to_owned);
    known.chain(convex)
}

fn ball(radius: f64) -> Solid {
    let ball = ConvexPolyhedron::sphere(DVec3::ZERO, radius).expect("a ball");
    Solid::from_convex(&ball).expect("a solid")
}

#[test]
fn casts_of_all_families_agree_with_exact_distances() {
    let mut counts = [0; 3];
    for family in families() {
        for seed in 0..cases(8) {
            let seen = examine(&family, seed, true);
            let seen = seen.unwrap_or_else(|e| panic!("{family}:{seed}: {e}"));
            counts[seen.map_or(0, |seen| seen as usize)] += 1;
        }
    }
    let [_, free, blocked] = counts;
    assert!(free >= cases(31) && blocked >= cases(31), "{free} {blocked}");
}

#[test]
fn distances_of_all_families_agree_with_exact_arithmetic() {
    let mut seen = [0; 4];
    for family in families() {
        for seed in 0..cases(8) {
            let Some(setting) = Setting::draw(&family, seed).expect("a family") else { continue };
            let random = &mut Random::stream(seed, &[family.len() as u64, 0x2ad]);
            let found = setting.rounded(random).and_then(|setting| setting.examine());
            seen[found.unwrap_or_else(|e| panic!("{family}:{seed}: {e}")) as usize] += 1;
        }
    }
    let [touching, _, _, apart] = seen;
    assert!(touching > cases(31) && apart > cases(31), "{seen:?}");
}

/// Returns the distance that a ball falls onto a floor with a wall, after its proof is checked.
fn fall(start: DVec3, radius: f64, floor: &Solid) -> f64 {
    let ball = ball(radius);
    let cast =
        Cast::new(ball.at(at(start.x, start.y, start.z)), floor.at(Pose::IDENTITY), -DVec3::Z);
    let cast = cast.and_then(|cast| cast.with_tolerance(0.0)).expect("a cast");
    let (clearance, proof) = cast.certified_clearance().expect("an answer");
    assert!(cast.verify(&proof).expect("a proof") < CLOSE);
    let Clearance::Blocked { distance, contact } = clearance else { panic!("{clearance:?}") };
    let center = start - DVec3::Z * contact.translation.value;
    let point = contact.point_on_moving - DVec3::Z * contact.translation.value;
    assert!(((point - center).length() - radius).abs() < CLOSE, "on the ball");
    assert!((point - contact.point_on_fixed).length() < CLOSE, "{contact:?}");
    assert!(((point - center).normalize() - contact.normal).length() < 1e-9, "{contact:?}");
    distance
}

/// A ball falls onto a face, an edge, a corner, and into the reflex edge of an L.
#[test]
fn ball_meets_face_edge_corner_and_reflex_edge_of_an_l() {
    let floor = floor_with_wall();
    let side = |aside: f64| (0.25 - aside * aside).sqrt();
    for (start, expected) in [
        // The floor, the top of the wall.
        (DVec3::new(0.0, 0.0, 9.0), 8.5),
        (DVec3::new(3.5, 0.0, 9.0), 3.5),
        // The edge of the floor 0.3 beside it, the edge of the wall 0.2 beside it.
        (DVec3::new(-4.3, 0.0, 9.0), 9.0 - side(0.3)),
        (DVec3::new(2.8, 0.0, 9.0), 4.0 - side(0.2)),
        // The corners of the floor and of the wall.
        (DVec3::new(-4.2, 2.3, 9.0), 9.0 - (0.25_f64 - 0.04 - 0.09).sqrt()),
        (DVec3::new(4.1, -2.4, 9.0), 4.0 - (0.25_f64 - 0.01 - 0.16).sqrt()),
        // Along the wall, at a distance of the radius, down to the floor.
        (DVec3::new(2.5, 0.0, 9.0), 8.5),
    ] {
        let found = fall(start, 0.5, &floor);
        assert!((found - expected).abs() < CLOSE, "{start}: {found} {expected}");
        // A part of the radius may be that of the other body.
        let rounded = floor.clone().rounded(0.125).expect("a solid");
        let found = fall(start, 0.375, &rounded);
        assert!((found - expected).abs() < CLOSE, "{start}: {found} {expected}");
    }
}

/// A ball moves diagonally into the corner between floor and wall: it meets the nearer of both.
#[test]
fn ball_in_a_corner_is_stopped_by_both_sides() {
    let (floor, ball) = (floor_with_wall(), ball(0.5));
    let direction = DVec3::new(1.0, 0.0, -1.0);
    for (x, z, expected) in [(0.0, 3.0, 2.5), (0.0, 4.0, 2.5), (-1.0, 2.0, 1.5), (0.5, 2.5, 2.0)] {
        let cast = Cast::new(ball.at(at(x, 0.0, z)), floor.at(Pose::IDENTITY), direction);
        let cast = cast.and_then(|cast| cast.with_tolerance(0.0)).expect("a cast");
        let (clearance, proof) = cast.certified_clearance().expect("an answer");
        cast.verify(&proof).expect("a proof");
        let found = clearance.distance().expect("blocked");
        assert!((found - expected).abs() < CLOSE, "{x} {z}: {found}");
    }
    // In the corner, it touches both, and is free to leave.
    let cast = Cast::new(ball.at(at(2.5, 0.0, 0.5)), floor.at(Pose::IDENTITY), -direction);
    let cast = cast.and_then(|cast| cast.with_tolerance(0.0)).expect("a cast");
    assert!(cast.clearance().expect("an answer").is_free());
    assert!(cast.reversed().clearance().expect("an answer").distance().expect("blocked") < CLOSE);
}

/// A capsule meets the edge of a mesh across and along its axis.
#[test]
fn capsule_meets_an_edge() {
    let floor = floor_with_wall();
    let across = ConvexPolyhedron::capsule([-DVec3::X, DVec3::X], 0.25).expect("a capsule");
    let along = ConvexPolyhedron::capsule([-DVec3::Y, DVec3::Y], 0.25).expect("a capsule");
    for (capsule, x, expected) in [
        // The edge of the floor is 0.2 beside the axis, or beside its end.
        (&along, -4.2, 3.0 - 0.15),
        (&across, -5.2, 3.0 - 0.15),
        // The axis crosses above the edge.
        (&across, -4.5, 3.0 - 0.25),
    ] {
        let cast = Cast::between(capsule.at(at(x, 0.0, 3.0)), floor.at(Pose::IDENTITY), -DVec3::Z);
        let cast = cast.and_then(|cast| cast.with_tolerance(0.0)).expect("a cast");
        let (clearance, proof) = cast.certified_clearance().expect("an answer");
        cast.verify(&proof).expect("a proof");
        let found = clearance.distance().expect("blocked");
        assert!((found - expected).abs() < CLOSE, "{x}: {found} {expected}");
    }
}

/// Rounded convex bodies as solids have the answers of the convex search.
#[test]
fn rounded_convex_bodies_agree_as_solids() {
    let random = &mut Random::new(0x2a);
    for case in 0..cases(200) {
        let body = |random: &mut Random| {
            let core = match random.index(4) {
                0 => ConvexPolyhedron::from_points(&[random.vector()]),
                1 => ConvexPolyhedron::from_points(&[random.vector(), random.vector()]),
                2 => Ok(centered(DVec3::splat(random.range(0.1, 1.0)))),
                _ => Ok(hull(12, random)),
            };
            core.and_then(|core| core.rounded(random.range(0.01, 1.0))).expect("a body")
        };
        let (p, q) = (body(random), body(random));
        let pose = |random: &mut Random, far: f64| {
            Pose::new(random.rotation(), random.direction() * far).expect("a pose")
        };
        let (a, b) = (pose(random, 6.0), pose(random, 0.5));
        let toward = b.translation() - a.translation() + random.vector();
        let [s, t] = [p.as_surface(), q.as_surface()].map(|solid| solid.expect("a solid"));

        let exact =
            Pair::new(p.at(a), q.at(b)).and_then(|pair| pair.distance()).expect("a distance");
        let pair = Pair::new(s.at(a), t.at(b)).expect("a pair");
        let (found, proof) = pair.certified_distance().expect("a distance");
        pair.verify(&proof).expect("a proof");
        assert!(found.lower <= exact.upper && exact.lower <= found.upper, "{case}");
        assert!((found.upper - exact.upper).abs() < CLOSE, "{case}: {found:?} {exact:?}");

        let exact = Cast::new(p.at(a), q.at(b), toward).expect("a cast");
        let cast = Cast::new(s.at(a), t.at(b), toward).expect("a cast");
        let cast = cast.with_tolerance(0.0).expect("a tolerance");
        match (exact.first_contact(), cast.first_contact()) {
            (Ok(Outcome::Contact(exact)), Ok(Outcome::Contact(found))) => {
                let [lower, upper] = [exact.certificate.lower, exact.certificate.upper];
                assert!(found.translation.lower <= upper && lower <= found.translation.upper);
                assert!((found.translation.value - exact.translation).abs() < 1e-9, "{case}");
            }
            (Ok(Outcome::Separated(exact)), Ok(Outcome::Separated(found))) => {
                // The plane of solids need not be the one with the largest margin.
                let (found, most) = (found.separation.expect("a plane"), exact.certificate.margin);
                assert!(0.0 < found.margin && found.margin <= most + 1e-9, "{case}: {found:?}");
                cast.verify(&found).expect("a proof");
            }
            (exact, found) => panic!("{case}: {exact:?} {found:?}"),
        }
    }
}

#[test]
fn two_radii_add_and_the_gap_is_added_to_them() {
    let (a, b) = (floor_with_wall(), Solid::from_convex(&centered(DVec3::ONE)).expect("a solid"));
    let twice = a.clone().rounded(0.25).and_then(|a| a.rounded(0.125)).expect("a solid");
    assert_eq!((twice.radius(), a.radius()), (0.375, 0.0));
    let b = b.rounded(0.5).expect("a solid");
    let cast = Cast::new(b.at(at(0.0, 0.0, 9.0)), twice.at(Pose::IDENTITY), -DVec3::Z);
    let cast = cast.and_then(|cast| cast.with_tolerance(0.0)).expect("a cast");
    for (gap, expected) in [(0.0, 7.125), (0.125, 7.0), (1e-300, 7.125)] {
        let cast = cast.with_min_gap(gap).expect("a gap");
        let found = cast.clearance().expect("an answer").distance().expect("blocked");
        assert!((found - expected).abs() < CLOSE, "{gap}: {found}");
    }
    let pair = Pair::new(b.at(at(-3.0, 0.0, 4.0)), twice.at(Pose::IDENTITY)).expect("a pair");
    let distance = pair.distance().expect("a distance");
    assert!(distance.lower <= 2.125 && 2.125 <= distance.upper);
    assert!(
        (distance.on_moving.z - 2.5).abs() < CLOSE && (distance.on_fixed.z - 0.375).abs() < CLOSE
    );
    assert!(matches!(pair.within(2.13), Ok(Within::Closer(_))));
    assert!(matches!(pair.within(2.12), Ok(Within::Farther(gap)) if gap.gap > 2.12));
    // The cores are apart, the bodies overlap: both points are one point of both bodies.
    let pair = Pair::new(b.at(at(0.0, 0.0, 1.5)), twice.at(Pose::IDENTITY)).expect("a pair");
    let (found, proof) = pair.certified_distance().expect("a distance");
    assert!(matches!(found.near, SolidNear::Points { distance: 0.0, .. }), "{found:?}");
    assert_eq!((found.bounds(), found.on_moving), ([0.0; 2], found.on_fixed));
    assert!((0.0..=0.375).contains(&found.on_moving.z) && found.on_moving.z <= 0.5);
    assert_eq!(pair.verify(&proof), Ok(0.0));
    let depth = pair.overlap_depth().expect("a depth");
    assert!(depth.meets && depth.least_tolerance.is_some_and(|least| least > 0.3), "{depth:?}");
}

/// The least tolerance offsets the cores until the bodies are apart.
#[test]
fn least_tolerance_includes_the_radii() {
    let cube = Solid::from_convex(&centered(DVec3::ONE)).expect("a solid").rounded(0.25);
    let cube = cube.expect("a solid");
    for height in [2.4, 2.25, 1.75] {
        let pair = Pair::new(cube.at(at(0.25, 0.125, height)), cube.at(Pose::IDENTITY));
        let depth = pair.expect("a pair").overlap_depth().expect("a depth");
        let least = depth.least_tolerance.expect("there is one");
        assert!(depth.meets && (least - (2.5 - height)).abs() < 1e-9, "{height}: {depth:?}");
    }
    let apart = Pair::new(cube.at(at(0.0, 0.0, 2.6)), cube.at(Pose::IDENTITY)).expect("a pair");
    let depth = apart.overlap_depth().expect("a depth");
    assert!(!depth.meets && depth.least_tolerance == Some(0.0));
}

/// A proof about two bodies is refused about bodies of other radii for which its statement is false.
#[test]
fn proofs_of_other_radii_are_refused() {
    let floor = floor_with_wall();
    let start = at(-3.0, 0.5, 2.0);
    let cube = Solid::from_convex(&centered(DVec3::splat(0.5))).expect("a solid");
    let rounded = |more: f64| cube.clone().rounded(0.25 + more).expect("a solid");
    let (body, larger, smaller) = (rounded(0.0), rounded(1e-6), rounded(-1e-6));
    let slanted = DVec3::new(1.0, 0.25, -0.125);
    for direction in [-DVec3::Z, DVec3::X, slanted] {
        let cast = |body| {
            let cast = Cast::<Solid>::new(body, floor.at(Pose::IDENTITY), direction);
            cast.and_then(|cast| cast.with_tolerance(0.0)).expect("a cast")
        };
        let (clearance, proof) = cast(body.at(start)).certified_clearance().expect("an answer");
        assert!(cast(body.at(start)).verify(&proof).is_ok() && clearance.distance().is_some());
        for other in [&larger, &smaller, &cube] {
            assert!(cast(other.at(start)).verify(&proof).is_err(), "{direction}");
        }
        let more = SolidCertificate { lower: proof.lower + 1e-9, ..proof.clone() };
        assert!(cast(body.at(start)).verify(&more).is_err());
    }
    // A plane between the bodies.
    let aside = at(0.0, 4.0, 2.0);
    let cast = |body| Cast::<Solid>::new(body, floor.at(Pose::IDENTITY), DVec3::X).expect("a cast");
    let Ok(Clearance::Free(free)) = cast(body.at(aside)).clearance() else { panic!("it is free") };
    let plane = free.separation.expect("a plane");
    assert!((plane.margin - 1.25).abs() < CLOSE, "{plane:?}");
    assert!(cast(body.at(aside)).verify(&plane).is_ok());
    assert!(cast(larger.at(aside)).verify(&plane).is_err());
    // Distances.
    let pair = |body| Pair::<Solid>::new(body, floor.at(Pose::IDENTITY)).expect("a pair");
    let (_, proof) = pair(body.at(start)).certified_distance().expect("a distance");
    assert!(pair(body.at(start)).verify(&proof).is_ok());
    assert!(pair(larger.at(start)).verify(&proof).is_err());
    assert!(pair(smaller.at(start)).verify(&proof).is_err());
    assert!(pair(cube.at(start)).verify(&proof).is_err());
    let more = DistanceCertificate { lower: proof.lower + 1e-9, ..proof };
    assert!(pair(body.at(start)).verify(&more).is_err());
}

#[test]
fn contained_cores_overlap() {
    let shell = Solid::from_convex(&centered(DVec3::splat(9.0))).expect("a solid");
    for (body, inside) in
        [(ball(0.5), shell.clone()), (ball(0.5), shell.rounded(1.0).expect("a solid"))]
    {
        let cast = Cast::new(body.at(Pose::IDENTITY), inside.at(Pose::IDENTITY), DVec3::X);
        let cast = cast.expect("a cast");
        assert!(matches!(cast.clearance(), Ok(Clearance::Overlapping(_))));
        assert!(cast.intersects().expect("an answer").meets);
        let pair = Pair::new(body.at(Pose::IDENTITY), inside.at(Pose::IDENTITY)).expect("a pair");
        let (found, proof) = pair.certified_distance().expect("a distance");
        assert_eq!(found.bounds(), [0.0; 2]);
        pair.verify(&proof).expect("a proof");
    }
}

#[test]
fn undefined_operations_and_bad_radii_are_refused() {
    let cube = Solid::from_convex(&centered(DVec3::ONE)).expect("a solid");
    for radius in [-1.0, f64::NAN, f64::INFINITY, 1e-70, 1e70] {
        let refused = cube.clone().rounded(radius);
        assert!(matches!(refused, Err(SolidError::Radius { .. })), "{radius}");
    }
    let huge = cube.clone().rounded(1.5e60).and_then(|cube| cube.rounded(1e60));
    assert!(matches!(huge, Err(SolidError::Radius { .. })));
    let round = cube.clone().rounded(0.25).expect("a solid");
    assert!(matches!(round.shrunk(0.1), Err(SolidError::Rounded { radius: 0.25 })));
    assert!(matches!(round.grown(0.1), Err(SolidError::Rounded { .. })));
    assert!(matches!(Solid::from_pieces([&round, &cube]), Err(SolidError::Rounded { .. })));
    assert!(
        matches!(round.as_solid(), Err(SolidError::Rounded { .. })) && round.as_surface().is_ok()
    );
    let pill = ConvexPolyhedron::capsule([DVec3::ZERO, DVec3::X], 0.5).expect("a capsule");
    assert!(matches!(pill.as_solid(), Err(SolidError::Rounded { .. })));
    assert_eq!(pill.as_surface().map(Solid::radius), Ok(0.5));
    let segment = ConvexPolyhedron::from_points(&[DVec3::ZERO, DVec3::X]).expect("a segment");
    assert!(matches!(Solid::from_convex(&segment), Err(SolidError::NoArea { what: "segment" })));
    assert!(matches!(segment.rounded(-1.0), Err(BuildError::Radius { .. })));
    assert_eq!(Solid::from_convex(&block([0.0; 3], [1.0; 3])).expect("a solid").radius(), 0.0);
}
