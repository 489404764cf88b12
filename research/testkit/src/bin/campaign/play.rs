//! Campaign of convex bodies that rotate with little play: pairs of screws, and arms close to contact. The
//! library checks the proofs, and answers are checked at many times before a contact.

use colltrans::motion::MotionOutcome;
use colltrans::motion::path::PathOutcome;
use colltrans_testkit::oracle::play::{KINDS, Screw, chain, slider};
use colltrans_testkit::tally::Tally;

use crate::{Asked, column_of};

/// Families of arms. The other families are kinds of screws.
const ARMS: [&str; 2] = ["arms with a pin", "arms over a table"];

/// Number of times before a contact at which arms are checked.
const SAMPLES: usize = 40;

/// Columns of the table.
pub(crate) const COLUMNS: &[&str] = &[
    "settings",
    "contacts",
    "grazing",
    "free",
    "overlapping",
    "undecided",
    "solids",
    "most looks",
];

/// Returns the names of all families.
pub(crate) fn families() -> Vec<&'static str> {
    KINDS.into_iter().chain(ARMS).collect()
}

/// Queries a setting, and judges the answer.
pub(crate) fn examine(asked: &Asked<'_>, tally: &mut Tally) -> Result<(), String> {
    let Asked { family, seed, .. } = *asked;
    tally.count("settings");
    let (column, solids, steps) = if let Some(kind) = KINDS.iter().position(|kind| *kind == family)
    {
        let outcome = Screw::random(kind, seed).judge()?;
        let solids = outcome.proof().solids.is_some();
        (column_of!(outcome, MotionOutcome, "undecided"), solids, outcome.steps())
    } else {
        let arm = if family == ARMS[0] { chain(seed) } else { slider(seed) };
        let outcome = arm.judge(SAMPLES)?;
        let solids = !outcome.proof().solids.is_empty();
        (column_of!(outcome, PathOutcome, "undecided"), solids, outcome.steps())
    };
    tally.count(column);
    tally.count_if("solids", solids);
    tally.largest("most looks", steps.looks);
    Ok(())
}
