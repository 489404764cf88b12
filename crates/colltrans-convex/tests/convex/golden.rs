//! One number for each family over the bits of its answers: they say which answers change, and where
//! they differ between platforms.
//!
//! Settings are drawn with sines and cosines, whose last bits differ between platforms; so their
//! numbers are rounded to 24 significant bits first, poses as the nine entries of their matrices. Of
//! nearly flat bodies that would leave nothing: their families are left out.
//!
//! After a change that is meant to change bits, the test prints the new lines.

use colltrans_convex::{Cast, Contact, ConvexPolyhedron, Outcome, Pose, Solver, Tracker, VertexId};
use colltrans_testkit::golden::{Hash, assert_unchanged};
use colltrans_testkit::oracle::settings::{FAMILIES, NEARLY_FLAT, Setting, setting};
use glam::{DMat3, DVec3};

/// Settings of each family.
const SETTINGS: u64 = 60;

/// Families of convex bodies.
const CASTS: &[(&str, u64)] = &[
    ("random", 0x07e1_2b5c_2cb2_672d),
    ("boxes", 0x62ad_bb17_85a4_44a3),
    ("turned-boxes", 0x6ab2_b3e1_2947_03a6),
    ("prisms", 0x72a5_8b1a_0252_e3f4),
    ("grid", 0x9937_bb80_9fbf_d9e5),
    ("face-face", 0x7b89_221b_0047_8d89),
    ("edge-edge-parallel", 0xc3bf_9574_31b9_1afd),
    ("vertex-over-vertex", 0x0a13_9eda_41e7_6597),
    ("rim", 0x8cbb_6ebb_9e84_7f83),
    ("identical", 0x16e0_6620_9f26_ba9e),
    ("peg", 0xb364_987a_be12_30be),
    ("needle-plate", 0x63be_9f5a_35fb_121c),
    ("size-ratio", 0xb10a_ed40_20a7_9986),
    ("offset", 0xd92d_d640_f6e9_23c1),
    ("far", 0x85e8_41e2_f1e9_f5da),
    ("flat", 0x4174_2989_0472_a15d),
    ("segment-point", 0x2935_3245_53e4_edfd),
    ("nearly", 0xf363_c08c_afa5_7647),
    ("shallow", 0xa3d3_169d_e996_e20a),
    ("thin", 0xd9b3_778f_aea5_5955),
    ("cylinders", 0x6463_6d01_d964_0ecd),
    ("magnitude", 0x3970_db53_4a72_2b5a),
    ("narrow-rings", 0x8561_b207_136f_c115),
];

fn hash_contact(hash: &mut Hash, contact: &Contact, cast: &Cast) {
    let proof = &contact.certificate;
    hash.number(contact.translation);
    hash.vector(contact.normal);
    for x in [proof.lower, proof.upper, proof.rounding] {
        hash.number(x);
    }
    for weight in proof.weights {
        hash.number(weight);
    }
    for pair in proof.pairs {
        hash.bits(u64::from(pair.moving.0) << 32 | u64::from(pair.fixed.0));
    }
    let points = contact.witness_points(cast);
    hash.vector(points.on_moving);
    hash.vector(points.on_fixed);
    let features = contact.features(cast);
    for (feature, body) in [(features.moving, cast.moving()), (features.fixed, cast.fixed())] {
        for VertexId(vertex) in feature.vertex_positions(body) {
            hash.bits(vertex.into());
        }
    }
    let steps = contact.steps;
    for count in [steps.planar_problems, steps.supports, steps.pivots] {
        hash.bits(count.into());
    }
}

fn hash_outcome(hash: &mut Hash, outcome: &Outcome, cast: &Cast) {
    match outcome {
        Outcome::Contact(contact) => hash_contact(hash, contact, cast),
        Outcome::Grazing(grazing) => {
            hash.number(grazing.overlap);
            hash.vector(grazing.separating_direction);
            hash_contact(hash, &grazing.contact, cast);
        }
        Outcome::Separated(separated) => {
            hash.vector(separated.certificate.normal);
            hash.number(separated.certificate.margin);
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

fn convex(family: &str) -> u64 {
    let mut hash = Hash::default();
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
                hash_outcome(&mut hash, &outcome, &cast);
                hash_outcome(&mut hash, &tracker.first_contact(&cast).expect("an answer"), &cast);
            }
        }
    }
    hash.finish()
}

#[test]
fn casts_have_the_bits_they_had() {
    let known: Vec<&str> =
        CASTS.iter().map(|line| line.0).chain(NEARLY_FLAT.iter().copied()).collect();
    assert!(FAMILIES.iter().all(|family| known.contains(&family.0)), "a family has no line");
    assert_unchanged(CASTS, convex);
}
