//! Convex bodies that turn with little play: screws of two, and arms near a touch. Proofs are checked by the library,
//! answers at many times before a contact.

use colltrans::motion::MotionOutcome;
use colltrans::motion::path::PathOutcome;
use colltrans_testkit::oracle::check::Objection;
use colltrans_testkit::oracle::play::{KINDS, Screw, chain, slider};

use crate::Asked;
use crate::tally::Tally;

/// Families of arms; the others are kinds of screws.
const ARMS: [&str; 2] = ["arms with a pin", "arms over a table"];

/// Times before a contact at which arms are looked at.
const SAMPLES: usize = 40;

/// What is counted.
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

/// Names of all families.
pub(crate) fn families() -> Vec<&'static str> {
    KINDS.into_iter().chain(ARMS).collect()
}

/// Asks about one setting, and judges the answer.
pub(crate) fn examine(asked: &Asked<'_>, tally: &mut Tally) {
    let Asked { family, seed, .. } = *asked;
    tally.count("settings");
    let found = match KINDS.iter().position(|kind| *kind == family) {
        Some(kind) => Screw::random(kind, seed).judge().map(|outcome| {
            tally.count(match outcome {
                MotionOutcome::Contact(_) => "contacts",
                MotionOutcome::Grazing(_) => "grazing",
                MotionOutcome::Overlapping(_) => "overlapping",
                MotionOutcome::Undecided(_) => "undecided",
                _ => "free",
            });
            (outcome.proof().solids.is_some(), outcome.steps())
        }),
        None => if family == ARMS[0] { chain(seed) } else { slider(seed) }.judge(SAMPLES).map(
            |outcome| {
                tally.count(match outcome {
                    PathOutcome::Contact(_) => "contacts",
                    PathOutcome::Grazing(_) => "grazing",
                    PathOutcome::Overlapping(_) => "overlapping",
                    PathOutcome::Undecided(_) => "undecided",
                    _ => "free",
                });
                (!outcome.proof().solids.is_empty(), outcome.steps())
            },
        ),
    };
    match found {
        Ok((solids, steps)) => {
            tally.count_if("solids", solids);
            tally.largest("most looks", steps.looks);
        }
        Err(Objection(what)) => tally.disagree(format!("{family}:{seed} {what}")),
    }
}
