//! How much is looked at for an answer: bounds on support points, which no machine disturbs.

use colltrans::glam::DVec3;
use colltrans::{Cast, ConvexPolyhedron, Outcome, Pose};
use colltrans_testkit::random::Random;
use colltrans_testkit::shapes::{Mesh, ring_sphere};

const CASTS: u32 = 400;

/// An ellipsoid of about 2,000 vertices.
fn ellipsoid(axes: DVec3) -> ConvexPolyhedron {
    let Mesh { vertices, .. } = ring_sphere(60, 33).mapped(|v| v * axes);
    ConvexPolyhedron::from_points(&vertices).expect("a body")
}

/// Mean number of support points for a contact of a body with itself, in random poses.
fn supports(body: &ConvexPolyhedron) -> f64 {
    let mut random = Random::new(7);
    let (mut contacts, mut sum) = (0, 0);
    for _ in 0..CASTS {
        let direction = random.direction();
        let aside = random.direction() * random.range(0.0, 0.8);
        let start = Pose::new(random.rotation(), aside - direction * 4.0).expect("a pose");
        let target = Pose::new(random.rotation(), DVec3::ZERO).expect("a pose");
        let cast = Cast::new(body.at(start), body.at(target), direction).expect("a query");
        if let Ok(Outcome::Contact(contact)) = cast.first_contact() {
            contacts += 1;
            sum += contact.steps.supports;
        }
    }
    assert!(contacts > CASTS / 8, "{contacts} contacts");
    f64::from(sum) / f64::from(contacts)
}

/// The guess from inertia ellipsoids is right for ellipsoids however thin: two support points, one to
/// prove the answer.
#[test]
fn ellipsoids_are_met_at_once() {
    for axes in [
        DVec3::ONE,
        DVec3::new(1.0, 1.0, 1e-3),
        DVec3::new(1.0, 0.7, 1e-2),
        DVec3::new(1.0, 1e-3, 1e-3),
    ] {
        let mean = supports(&ellipsoid(axes));
        assert!(mean < 2.4, "{axes}: {mean} support points");
    }
}
