//! Arms of one to seven joints on random paths, with convex bodies and with solids: proofs are checked by the library,
//! answers by plain matrices at many times.

use colltrans::motion::path::PathOutcome;
use colltrans_testkit::oracle::check::Objection;
use colltrans_testkit::oracle::path::Arm;

use crate::Asked;
use crate::tally::Tally;

/// With convex bodies alone, and with solids that are not.
pub(crate) const FAMILIES: [&str; 2] = ["arms", "arms of solids"];

/// Times at which all pairs are looked at.
const SAMPLES: [usize; 2] = [60, 10];

/// What is counted.
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

/// Asks about an arm, and judges the answer.
pub(crate) fn examine(asked: &Asked<'_>, tally: &mut Tally) {
    let Asked { family, seed, .. } = *asked;
    tally.count("settings");
    let solids = family == FAMILIES[1];
    match Arm::random(seed, solids).judge(SAMPLES[usize::from(solids)]) {
        Err(Objection(what)) => tally.disagree(format!("{family}:{seed} {what}")),
        Ok(outcome) => {
            let looks = outcome.steps().looks;
            tally.mean("looks", looks);
            tally.largest("most looks", looks);
            match outcome {
                PathOutcome::Contact(of) => {
                    tally.count("contacts");
                    tally.largest("widest", of.upper - of.lower);
                }
                PathOutcome::Grazing(_) => tally.count("grazing"),
                PathOutcome::Overlapping(_) => tally.count("overlapping"),
                PathOutcome::Undecided(_) => tally.count("open"),
                _ => tally.count("free"),
            }
        }
    }
}
