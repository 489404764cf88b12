//! Free directions of bodies of cubes and of convex ones, each held against ordinary casts, the union of all cones in
//! fractions, themselves turned and with a larger tolerance, and proofs that were changed.

use colltrans_testkit::oracle::solids::free;
pub(crate) use colltrans_testkit::oracle::solids::free::FAMILIES;

use crate::Asked;
use crate::tally::Tally;

/// Directions judged of each setting.
pub(crate) const DIRECTIONS: u64 = 500;

/// What is counted.
pub(crate) const COLUMNS: &[&str] = &[
    "settings",
    "overlapping",
    "judged",
    "free",
    "undecided",
    "fractions",
    "thin",
    "compared",
    "refused",
    "cells",
];

/// Examines a setting.
pub(crate) fn examine(asked: &Asked<'_>, tally: &mut Tally) {
    let Asked { family, seed, .. } = *asked;
    tally.count("settings");
    match free::examine(family, seed, DIRECTIONS) {
        Ok(None) => tally.count("overlapping"),
        Ok(Some(judged)) => {
            let free::Judged { directions, free, undecided, fractions, thin, .. } = judged;
            tally.add("judged", directions);
            tally.add("free", free);
            tally.add("undecided", undecided);
            tally.add("fractions", fractions);
            tally.add("thin", thin);
            tally.add("compared", judged.compared);
            tally.add("refused", judged.refused);
            tally.add("cells", judged.cells);
        }
        Err(objection) => tally.disagree(format!("{family}:{seed}: {objection}")),
    }
}
