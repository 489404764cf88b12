//! One number for each family over the bits of its answers, as for convex bodies. The families are drawn without sines
//! and cosines, whose last bits differ between platforms.
//!
//! After a change that is meant to change bits, the test prints the new lines.

use colltrans_convex::{Cast, Clearance};
use colltrans_solid::{Solid, SolidCast};
use colltrans_testkit::golden::{Hash, assert_unchanged};
use colltrans_testkit::oracle::solids::settings::Setting;

/// Settings of each family.
const SETTINGS: u64 = 60;

/// Families of solids.
const SOLIDS: &[(&str, u64)] = &[
    ("grid", 0x41f0_7c39_a053_e170),
    ("sheared", 0x7b3c_f442_a04e_a914),
    ("quarter", 0xe22c_07c1_5311_8aba),
    ("halves", 0x9f03_04d5_bfd8_38a5),
    ("mould", 0x82bc_b2a1_ee94_1a82),
    ("rotated", 0x689e_be44_e5e8_7340),
];

fn solids(family: &str) -> u64 {
    let mut hash = Hash::default();
    for seed in 0..SETTINGS {
        let drawn = Setting::draw(family, seed).expect("a family");
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
                    hash.number(contact.offset_distance.value);
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
    hash.finish()
}

#[test]
fn solids_have_the_bits_they_had() {
    assert_unchanged(SOLIDS, solids);
}
