//! One number over the bits of all answers: it says when they change, and where they differ between
//! platforms.
//!
//! Settings are drawn with sines and cosines, whose last bits differ between platforms; so their
//! numbers are rounded to 24 significant bits first, poses as the nine entries of their matrices.
//!
//! After a change that is meant to change bits, the test prints the new number.

use colltrans::glam::{DMat3, DVec3};
use colltrans::{Cast, Contact, ConvexPolyhedron, Outcome, Pose, Solver, Tracker};
use colltrans_oracle::settings::{FAMILIES, Setting, setting};

/// Settings of each family.
const SETTINGS: u64 = 60;

/// The number.
const GOLDEN: u64 = 0xcf43_76ad_5872_dcfd;

/// Fowler, Noll and Vo's hash, 64 bits, 1a.
struct Hash(u64);

impl Hash {
    fn number(&mut self, x: f64) {
        self.bits(x.to_bits());
    }

    fn bits(&mut self, x: u64) {
        for byte in x.to_le_bytes() {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }

    fn vector(&mut self, v: DVec3) {
        for x in v.to_array() {
            self.number(x);
        }
    }

    fn contact(&mut self, contact: &Contact, cast: &Cast) {
        let proof = &contact.certificate;
        self.number(contact.translation);
        self.vector(contact.normal);
        for x in [proof.lower, proof.upper, proof.tolerance] {
            self.number(x);
        }
        for weight in proof.weights {
            self.number(weight);
        }
        for pair in proof.pairs {
            self.bits(u64::from(pair.moving) << 32 | u64::from(pair.fixed));
        }
        let points = contact.points(cast);
        self.vector(points.on_moving);
        self.vector(points.on_fixed);
        let features = contact.features(cast);
        for (feature, body) in [(features.moving, cast.moving()), (features.fixed, cast.fixed())] {
            for vertex in feature.vertices(body) {
                self.bits(vertex.into());
            }
        }
        let steps = contact.steps;
        for count in [steps.planar_problems, steps.supports, steps.pivots] {
            self.bits(count.into());
        }
    }

    fn outcome(&mut self, outcome: &Outcome, cast: &Cast) {
        match outcome {
            Outcome::Contact(contact) => self.contact(contact, cast),
            Outcome::Grazing(grazing) => {
                self.number(grazing.overlap);
                self.vector(grazing.separating_direction);
                self.contact(&grazing.contact, cast);
            }
            Outcome::Separated(separated) => {
                self.vector(separated.certificate.normal);
                self.number(separated.certificate.margin);
            }
        }
    }
}

/// To 24 significant bits.
fn rounded(x: f64) -> f64 {
    f64::from_bits((x.to_bits() + (1 << 28)) & !((1 << 29) - 1))
}

fn rounded_vector(v: DVec3) -> DVec3 {
    DVec3::from_array(v.to_array().map(rounded))
}

fn rounded_pose(pose: &Pose) -> Pose {
    // Entries that are rounding noise of zero are zero.
    let entry = |x: f64| if x.abs() < 1e-7 { 0.0 } else { rounded(x) };
    let matrix = DMat3::from_cols_array(&pose.matrix().to_cols_array().map(entry));
    Pose::from_matrix(matrix, rounded_vector(pose.translation())).expect("nearly a rotation")
}

fn body(points: &[DVec3]) -> ConvexPolyhedron {
    // What sines and cosines make of zero differs, too.
    let size = points.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max);
    let clean = |x: f64| if x.abs() < 1e-9 * size { 0.0 } else { rounded(x) };
    let points: Vec<DVec3> =
        points.iter().map(|p| DVec3::from_array(p.to_array().map(clean))).collect();
    ConvexPolyhedron::from_points(&points).expect("a body")
}

#[test]
fn all_families_have_the_bits_they_had() {
    let mut hash = Hash(0xcbf2_9ce4_8422_2325);
    for (family, ..) in FAMILIES {
        for seed in 0..SETTINGS {
            let Setting { moving, fixed, moving_pose, fixed_pose, direction, .. } =
                setting(family, seed);
            let (moving, fixed) = (body(&moving), body(&fixed));
            let poses = [rounded_pose(&moving_pose), rounded_pose(&fixed_pose)];
            let direction = rounded_vector(direction);
            let cast = Cast::new(moving.at(poses[0]), fixed.at(poses[1]), direction);
            let cast = cast.expect("a query");
            let mut tracker = Tracker::new();
            for solver in [Solver::Portal, Solver::Cta] {
                for cast in [cast, cast.reversed()].map(|cast| cast.with_solver(solver)) {
                    let outcome = cast.first_contact().expect("an answer");
                    hash.outcome(&outcome, &cast);
                    hash.outcome(&tracker.first_contact(&cast).expect("an answer"), &cast);
                }
            }
        }
    }
    let found = hash.0;
    assert_eq!(found, GOLDEN, "bits have changed; the new number is {found:#018x}");
}
