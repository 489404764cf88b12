//! Free directions of rounded bodies in contact: against the clearance along each direction; bodies that are refused.

use colltrans_convex::{Cast, Clearance, ConvexPolyhedron, Outcome, Placed, Pose, QueryError};
use colltrans_removal::directions::{FreeError, FreeHalfSpace, HalfSpaceVerdict};
use colltrans_testkit::bodies::at_xyz as at;
use colltrans_testkit::cases;
use colltrans_testkit::random::Random;
use colltrans_testkit::shapes::random_hull;
use glam::DVec3;

/// A sphere, a capsule, or a rounded hull.
fn body(random: &mut Random) -> ConvexPolyhedron {
    let radius = random.range(0.1, 1.0);
    let body = match random.index(3) {
        0 => ConvexPolyhedron::sphere(random.vector(), radius),
        1 => ConvexPolyhedron::capsule([random.vector(), random.vector()], radius),
        _ => ConvexPolyhedron::from_points(&random_hull(12, random).vertices)
            .and_then(|hull| hull.rounded(radius)),
    };
    body.expect("a body")
}

fn is_blocked(p: Placed, q: Placed, direction: DVec3) -> bool {
    let cast = Cast::new(p, q, direction).expect("a query");
    matches!(
        cast.clearance().expect("an answer"),
        Clearance::Blocked { .. } | Clearance::Overlapping(_)
    )
}

#[test]
fn directions_of_bodies_in_contact_agree_with_clearances() {
    let mut random = Random::new(5);
    let mut counts = [0; 3];
    for _ in 0..cases(200) {
        let (p, q) = (body(&mut random), body(&mut random));
        let from = random.direction() * 9.0;
        let start = Pose::new(random.rotation(), from).expect("a pose");
        let world = Pose::new(random.rotation(), DVec3::ZERO).expect("a pose");
        let cast = Cast::new(p.at(start), q.at(world), -from).expect("a query");
        let Outcome::Contact(contact) = cast.first_contact().expect("an answer") else { continue };
        let there = contact.pose_before(&cast).expect("a pose");
        let (p, q) = (p.at(there), q.at(world));
        let free = FreeHalfSpace::compute(p, q, 1e-11).expect("contact");
        free.verify().expect("proven");
        assert!(free.normal().distance(contact.normal) < 1e-6);
        for _ in 0..8 {
            // Half of the directions are near the border.
            let off = random.direction();
            let lateral = free.normal().any_orthonormal_vector();
            let direction = if random.one_in(2) { off } else { lateral + off * 1e-3 };
            match free.classify(direction).expect("a verdict") {
                HalfSpaceVerdict::Free => {
                    assert!(free.normal().dot(direction) <= 1e-15);
                    assert!(!is_blocked(p, q, direction), "{direction}");
                    counts[0] += 1;
                }
                HalfSpaceVerdict::Blocked => {
                    assert!(is_blocked(p, q, direction), "{direction}");
                    counts[1] += 1;
                }
                HalfSpaceVerdict::Undecided => {
                    let cosine = free.normal().dot(direction.normalize());
                    assert!((0.0..1e-4).contains(&cosine), "{cosine}");
                    counts[2] += 1;
                }
            }
        }
    }
    assert!(counts[0].min(counts[1]) > cases(200) && counts[2] < cases(100), "{counts:?}");
}

#[test]
fn bodies_without_a_half_space_are_refused() {
    let ball = ConvexPolyhedron::sphere(DVec3::ZERO, 1.0).expect("a sphere");
    let cube = ConvexPolyhedron::cuboid(DVec3::NEG_ONE, DVec3::ONE).expect("a cube");
    let world = Pose::IDENTITY;
    let compute = |height: f64, tolerance: f64| {
        FreeHalfSpace::compute(ball.at(at(0.0, 0.0, height)), cube.at(world), tolerance).map(drop)
    };
    assert_eq!(compute(2.0, 1e-12), Ok(()));
    assert!(
        matches!(compute(2.001, 1e-12), Err(FreeError::Apart { distance }) if distance < 1.1e-3)
    );
    assert!(matches!(compute(1.999, 1e-12), Err(FreeError::Deep { depth, .. }) if depth > 0.9e-3));
    // Rounding hides whether the bodies overlap.
    assert!(matches!(compute(2.0, 0.0), Err(FreeError::NotProven(_))));
    assert_eq!(compute(1.999, 1e-2), Ok(()));
    assert_eq!(compute(2.001, 1e-2), Ok(()));
    for tolerance in [-1.0, f64::NAN, 1.0] {
        let refused = compute(2.0, tolerance);
        assert!(matches!(refused, Err(FreeError::Query(QueryError::Tolerance { .. }))));
    }
    let plain = FreeHalfSpace::compute(cube.at(at(0.0, 0.0, 2.0)), cube.at(world), 0.0);
    assert!(matches!(plain, Err(FreeError::NotRounded)));
}
