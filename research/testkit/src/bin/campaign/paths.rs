//! Campaign of arms with one to seven joints on random paths, with convex bodies and with solids. The library
//! checks the proofs, and the answers are checked by plain matrices at many times.

use colltrans::motion::path::PathOutcome;
use colltrans_testkit::oracle::path::Arm;
use colltrans_testkit::tally::Tally;

use crate::{Asked, column_of};

/// With convex bodies only, and with solids that are not convex.
pub(crate) const FAMILIES: [&str; 2] = ["arms", "arms of solids"];

/// Number of times at which all pairs are checked.
const SAMPLES: [usize; 2] = [60, 10];

/// Columns of the table.
pub(crate) const COLUMNS: &[&str] = &[
    "settings",
    "contacts",
    "grazing",
    "free",
    "overlapping",
    "open",
    "looks",
    "most looks",
    "widest",
];

/// Queries the path of an arm, and judges the answer.
pub(crate) fn examine(asked: &Asked<'_>, tally: &mut Tally) -> Result<(), String> {
    tally.count("settings");
    let solids = asked.family == FAMILIES[1];
    let outcome = Arm::random(asked.seed, solids).judge(SAMPLES[usize::from(solids)])?;
    let looks = outcome.steps().looks;
    tally.mean("looks", looks);
    tally.largest("most looks", looks);
    tally.count(column_of!(&outcome, PathOutcome, "open"));
    if let PathOutcome::Contact(of) = outcome {
        tally.largest("widest", of.upper - of.lower);
    }
    Ok(())
}
