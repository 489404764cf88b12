//! One number for each family over the bits of its answers: they say which answers change, and where
//! they differ between platforms.
//!
//! Settings are drawn with sines and cosines, whose last bits differ between platforms; so their
//! numbers are rounded to 24 significant bits first, poses as the nine entries of their matrices. Of
//! nearly flat bodies that would leave nothing: their families are left out. The solids are of
//! families that are drawn without sines.
//!
//! After a change that is meant to change bits, the test prints the new lines.

use colltrans::glam::{DMat3, DVec3};
use colltrans::solid::SolidCast;
use colltrans::{
    Cast, Clearance, Contact, ConvexPolyhedron, Outcome, Pose, Solid, Solver, Tracker, VertexId,
};
use colltrans_testkit::oracle::settings::{FAMILIES, NEARLY_FLAT, Setting, setting};
use colltrans_testkit::oracle::solids;

/// Settings of each family.
const SETTINGS: u64 = 60;

/// Families of convex bodies.
const CASTS: &[(&str, u64)] = &[
    ("random", 0x20da_bc2a_e7c4_0182),
    ("boxes", 0x62ad_bb17_85a4_44a3),
    ("turned-boxes", 0xd95f_3335_449e_19b2),
    ("prisms", 0x2d80_e9c3_9593_3014),
    ("grid", 0x8b87_de7b_ef31_a8c9),
    ("face-face", 0x460e_d558_d0ff_6b80),
    ("edge-edge-parallel", 0xc3bf_9574_31b9_1afd),
    ("vertex-over-vertex", 0x615b_0538_0602_8c00),
    ("rim", 0xbaec_d9e4_e345_044e),
    ("identical", 0xd9ac_32fd_7462_e46f),
    ("peg", 0xb364_987a_be12_30be),
    ("needle-plate", 0x329d_c3e9_78bb_257c),
    ("size-ratio", 0xe980_a2bf_73bb_b70f),
    ("offset", 0xc4ac_0840_5591_0223),
    ("far", 0x186a_ce36_c242_d5cf),
    ("flat", 0x4174_2989_0472_a15d),
    ("segment-point", 0x2935_3245_53e4_edfd),
    ("nearly", 0x1c51_1507_436e_cdc4),
    ("shallow", 0x0fd5_8e0d_80c5_7d36),
    ("thin", 0xd9b3_778f_aea5_5955),
    ("cylinders", 0x314c_ed2e_56ac_f165),
    ("magnitude", 0x26b5_df2c_4a10_afa6),
    ("narrow-rings", 0xba3c_fd5e_9e3e_bbe9),
];

/// Families of solids.
const SOLIDS: &[(&str, u64)] = &[
    ("grid", 0x7f4d_12c6_7c07_0c04),
    ("sheared", 0x770c_8211_b115_3581),
    ("quarter", 0xe22c_07c1_5311_8aba),
    ("halves", 0x956b_efe9_e35f_8274),
    ("mould", 0x82bc_b2a1_ee94_1a82),
    ("rotated", 0x689e_be44_e5e8_7340),
];

/// Fowler, Noll and Vo's hash, 64 bits, 1a.
struct Hash(u64);

impl Default for Hash {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

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
        for x in [proof.lower, proof.upper, proof.rounding] {
            self.number(x);
        }
        for weight in proof.weights {
            self.number(weight);
        }
        for pair in proof.pairs {
            self.bits(u64::from(pair.moving.0) << 32 | u64::from(pair.fixed.0));
        }
        let points = contact.points(cast);
        self.vector(points.on_moving);
        self.vector(points.on_fixed);
        let features = contact.features(cast);
        for (feature, body) in [(features.moving, cast.moving()), (features.fixed, cast.fixed())] {
            for VertexId(vertex) in feature.own_vertices(body) {
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
                hash.outcome(&outcome, &cast);
                hash.outcome(&tracker.first_contact(&cast).expect("an answer"), &cast);
            }
        }
    }
    hash.0
}

fn solids(family: &str) -> u64 {
    let mut hash = Hash::default();
    for seed in 0..SETTINGS {
        let drawn = solids::settings::Setting::draw(family, seed).expect("a family");
        let [a, b] = drawn
            .surfaces
            .map(|(points, faces)| Solid::from_mesh(&points, &faces).expect("closed"));
        let cast = Cast::new(a.at(drawn.poses[0]), b.at(drawn.poses[1]), drawn.direction);
        let cast = cast.expect("a query");
        for tolerance in [0.0, 1.0 / 64.0] {
            let cast = cast.with_tolerance(tolerance).expect("a tolerance");
            match cast.clearance().expect("an answer") {
                Clearance::Free(_) => hash.bits(0),
                Clearance::Blocked { contact, .. } => {
                    hash.number(contact.shrunk_distance.value);
                    hash.number(contact.translation.value);
                    hash.vector(contact.normal);
                }
                Clearance::Overlapping(overlap) => {
                    hash.number(overlap.least_tolerance.unwrap_or(-1.0));
                }
            }
            hash.number(cast.exit().map_or(-1.0, |exit| exit.value));
        }
    }
    hash.0
}

fn unchanged(known: &[(&str, u64)], asked: impl Fn(&str) -> u64) {
    let line = |&(family, golden): &(&str, u64)| {
        let found = asked(family);
        (found != golden).then(|| format!("    (\"{family}\", {found:#018x}),\n"))
    };
    let changed: String = known.iter().filter_map(line).collect();
    assert!(changed.is_empty(), "bits have changed; the new lines are\n{changed}");
}

#[test]
fn casts_have_the_bits_they_had() {
    let known: Vec<&str> =
        CASTS.iter().map(|line| line.0).chain(NEARLY_FLAT.iter().copied()).collect();
    assert!(FAMILIES.iter().all(|family| known.contains(&family.0)), "a family has no line");
    unchanged(CASTS, convex);
}

#[test]
fn solids_have_the_bits_they_had() {
    unchanged(SOLIDS, solids);
}
