//! Nearly flat bodies, held against their input points in fractions, and a cast onto each that is judged
//! by the input points too.

use colltrans_testkit::oracle::settings::{Setting, setting};
use colltrans_testkit::tally::Tally;

use crate::{Asked, casts};

/// What is counted: bodies by dimension, points that were dropped, and, in multiples of the largest coordinate, how
/// far from the body the farthest one is and the largest hull error; then what casts count.
pub(crate) const COLUMNS: &[&str] = &[
    "bodies",
    "solid",
    "flat",
    "straight",
    "dropped",
    "farthest",
    "claimed",
    "settings",
    "contact",
    "grazing",
    "separated",
    "proven",
    "lp",
    "gap/size",
    "gap/tol",
    "miss/u",
];

/// Examines the fixed body of a setting, and a cast onto it that is solved again.
pub(crate) fn examine(asked: &Asked<'_>, tally: &mut Tally) -> Result<(), String> {
    let setting = setting(asked.family, asked.seed);
    examine_body(&setting, tally);
    casts::examine_setting(&setting, true, tally)
}

fn examine_body(setting: &Setting, tally: &mut Tally) {
    let Ok(bodies) = setting.bodies() else { return };
    tally.count("bodies");
    tally.count(match bodies.fixed.dimension() {
        0 | 1 => "straight",
        2 => "flat",
        _ => "solid",
    });
    let largest = setting.fixed.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max);
    tally.largest("claimed", bodies.fixed.hull_error() / largest);
    if let Ok([_, kept]) = setting.judge_bodies(&bodies) {
        tally.add("dropped", kept.dropped as u64);
        tally.largest("farthest", kept.farthest / largest);
    }
}
