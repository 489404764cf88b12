//! Bodies with rims of many corners, in random and in tied placements: every answer's proof, looked at by all vertices,
//! how near its bounds are, and the answer of the paper's algorithm.

use colltrans_convex::{Cast, ConvexPolyhedron, Outcome, Pose, Solver};
use colltrans_testkit::random::Random;
use colltrans_testkit::shapes::{cuboid, revolved};
use glam::{DQuat, DVec3};

/// Casts of each pair of bodies.
const CASTS: usize = 20;

/// Bounds are no farther from each other, as a share of the size, along the contact normal.
const OPEN: f64 = 1e-13;

/// A name, rings by radius and height, and tips.
type Kind = (&'static str, &'static [[f64; 2]], &'static [f64]);

const KINDS: [Kind; 7] = [
    ("cylinder", &[[1.0, -1.0], [1.0, 1.0]], &[]),
    ("disc", &[[1.0, -0.01], [1.0, 0.01]], &[]),
    ("chamfers", &[[0.99, -1.0], [1.0, -0.99], [1.0, 0.99], [0.99, 1.0]], &[]),
    ("frustum", &[[1.0, -1.0], [0.5, 1.0]], &[]),
    ("cone", &[[1.0, -0.5]], &[1.0]),
    ("bicone", &[[1.0, 0.0]], &[-1.0, 1.0]),
    ("bottle", &[[1.0, -1.0], [1.0, 0.0]], &[1.0]),
];

fn body(rings: &[[f64; 2]], tips: &[f64], sides: usize, stretch: DVec3) -> ConvexPolyhedron {
    let mesh = revolved(rings, tips, sides).mapped(|p| p * stretch);
    ConvexPolyhedron::from_points(&mesh.vertices).expect("a body")
}

/// A rotation, a place beside the axis and a direction: anything, or lined up with the other body.
fn placed(random: &mut Random) -> (DQuat, DVec3, DVec3) {
    let axes = [DVec3::X, DVec3::Y, DVec3::Z, DVec3::NEG_Z];
    let quarter = DQuat::from_rotation_arc(DVec3::Z, axes[random.index(4)]);
    let aside = random.pick(&[DVec3::ZERO, DVec3::X * 0.5, DVec3::Y, DVec3::Z * 0.25]);
    match random.index(4) {
        0 => (quarter, aside, axes[random.index(4)]),
        1 => (quarter, random.vector() * 0.7, axes[random.index(4)]),
        2 => (quarter, aside, random.direction()),
        _ => (random.rotation(), random.vector() * 2.5, random.direction()),
    }
}

/// What is wrong with an answer, and whether it is a contact.
fn examined(cast: &Cast, size: f64) -> Result<bool, String> {
    let outcome = cast.first_contact().map_err(|error| error.to_string())?;
    let contact = match &outcome {
        Outcome::Separated(apart) => {
            let proven = cast.verify(&apart.certificate).map_err(|error| error.to_string())?;
            return if proven > 0.0 { Ok(false) } else { Err(format!("a margin of {proven}")) };
        }
        Outcome::Contact(contact) => contact,
        Outcome::Grazing(grazing) => {
            let proof = &grazing.contact.certificate;
            return cast.verify(proof).map(|_| false).map_err(|error| error.to_string());
        }
    };
    let proof = &contact.certificate;
    cast.verify(proof).map_err(|error| error.to_string())?;
    let inclination = proof.normal.dot(cast.direction()) / cast.direction().length();
    let open = (proof.upper - proof.lower) * inclination;
    if open > OPEN * size {
        return Err(format!("bounds {open:e} apart"));
    }
    let by_cta = (*cast).with_solver(Solver::Cta).first_contact();
    match by_cta.map_err(|error| error.to_string())? {
        Outcome::Contact(other)
            if (other.translation - contact.translation).abs() * inclination > OPEN * size =>
        {
            Err(format!("{} and {} by cta", contact.translation, other.translation))
        }
        _ => Ok(true),
    }
}

#[test]
fn proofs_hold_and_are_close() {
    let mut random = Random::new(11);
    let (mut wrong, mut contacts, mut asked) = (Vec::new(), 0, 0);
    for (moving, rings, tips) in KINDS {
        for (fixed, other_rings, other_tips) in KINDS {
            for sides in [33, 64, 400] {
                let mut stretch = || match random.index(3) {
                    0 => DVec3::ONE,
                    1 => DVec3::new(0.7, 0.7, 1.3),
                    _ => DVec3::from_array([0; 3].map(|_| random.range(0.5, 1.5))),
                };
                let p = body(rings, tips, sides, stretch());
                let q = body(other_rings, other_tips, sides, stretch());
                for which in 0..CASTS {
                    let (turn, aside, direction) = placed(&mut random);
                    let start = Pose::new(turn, aside - direction * 5.0).expect("a pose");
                    let cast = Cast::new(p.at(start), q.at(Pose::IDENTITY), direction);
                    asked += 1;
                    match examined(&cast.expect("a query"), 10.0) {
                        Ok(contact) => contacts += u32::from(contact),
                        Err(objection) => {
                            wrong.push(format!("{moving}, {fixed}, {sides}, {which}: {objection}"));
                        }
                    }
                }
            }
        }
    }
    println!("{asked} casts, {contacts} contacts");
    assert!(wrong.is_empty(), "{} of {asked}:\n{}", wrong.len(), wrong.join("\n"));
    let apart = asked - contacts;
    assert!(apart > 100 && contacts > asked / 3, "{contacts} contacts of {asked} casts");
}

/// A few corners stand for themselves beside a rim.
#[test]
fn a_box_against_rims() {
    let mut random = Random::new(12);
    let mesh = cuboid(DVec3::new(0.3, 0.8, 0.5));
    let block = ConvexPolyhedron::from_points(&mesh.vertices).expect("a box");
    let mut contacts = 0;
    for (name, rings, tips) in KINDS {
        let round = body(rings, tips, 300, DVec3::ONE);
        for _ in 0..3 * CASTS {
            let (turn, aside, direction) = placed(&mut random);
            let start = Pose::new(turn, aside - direction * 5.0).expect("a pose");
            let cast = Cast::new(block.at(start), round.at(Pose::IDENTITY), direction);
            let contact = examined(&cast.expect("a query"), 10.0);
            contacts +=
                u32::from(contact.unwrap_or_else(|objection| panic!("{name}: {objection}")));
        }
    }
    assert!(contacts > 100, "{contacts} contacts");
}
