//! Campaign of nearly flat bodies. Bodies are compared with their input points in rational arithmetic. A cast
//! onto each is judged by the input points as well.

use colltrans_testkit::oracle::settings::{Setting, setting};
use colltrans_testkit::tally::Tally;

use crate::{Asked, casts};

/// Columns: numbers of bodies by dimension, of dropped points, the largest distance of a point from its body
/// and the largest hull error in multiples of the largest coordinate, then the columns of casts.
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

/// Examines the fixed body of a setting, and a cast onto it, which the oracle solves as well.
pub(crate) fn examine(asked: &Asked<'_>, tally: &mut Tally) -> Result<(), String> {
    let setting = setting(asked.family, asked.seed);
    examine_body(&setting, tally);
    casts::examine_setting(&setting, true, tally)
}

/// Compares the fixed body of a setting with its input points.
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
