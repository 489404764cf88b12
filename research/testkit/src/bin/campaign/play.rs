//! Convex bodies that turn with little play: screws of two, and arms near a touch. Proofs are checked by the library,
//! answers at many times before a contact.

use colltrans::motion::MotionOutcome;
use colltrans::motion::path::PathOutcome;
use colltrans_testkit::oracle::check::Objection;
use colltrans_testkit::oracle::play::{KINDS, Screw, chain, slider};

/// Families of arms; the others are kinds of screws.
const ARMS: [&str; 2] = ["arms with a pin", "arms over a table"];

/// Times before a contact at which arms are looked at.
const SAMPLES: usize = 40;

/// Names of all families.
pub(crate) fn families() -> Vec<&'static str> {
    KINDS.into_iter().chain(ARMS).collect()
}

/// What became of the settings of one family.
#[derive(Debug, Default, Clone)]
pub(crate) struct Tally {
    settings: u64,
    contacts: u64,
    grazing: u64,
    free: u64,
    overlapping: u64,
    /// Without an answer.
    undecided: u64,
    /// Taken as solids.
    solids: u64,
    most_looks: u32,
    disagreements: Vec<String>,
}

impl crate::Tally for Tally {
    const CHUNK: u64 = 4;

    fn header() -> String {
        [
            "settings",
            "contacts",
            "grazing",
            "free",
            "overlap",
            "undecided",
            "solids",
            "most",
            "wrong",
        ]
        .map(|head| format!("{head:>9} "))
        .concat()
    }

    fn line(&self) -> String {
        let Self { settings, contacts, grazing, free, overlapping, undecided, solids, .. } = self;
        let counts = [settings, contacts, grazing, free, overlapping, undecided, solids]
            .map(|count| format!("{count:>9} "))
            .concat();
        format!("{counts}{:>9} {:>9} ", self.most_looks, self.disagreements.len())
    }

    fn merge(mut self, other: Self) -> Self {
        self.settings += other.settings;
        self.contacts += other.contacts;
        self.grazing += other.grazing;
        self.free += other.free;
        self.overlapping += other.overlapping;
        self.undecided += other.undecided;
        self.solids += other.solids;
        self.most_looks = self.most_looks.max(other.most_looks);
        self.disagreements.extend(other.disagreements);
        self
    }

    fn disagreements(&self) -> &[String] {
        &self.disagreements
    }
}

/// Asks about one setting, and judges the answer.
pub(crate) fn examine(family: &str, seed: u64, tally: &mut Tally) {
    tally.settings += 1;
    let found = match KINDS.iter().position(|kind| *kind == family) {
        Some(kind) => Screw::random(kind, seed).judge().map(|outcome| {
            let count = match outcome {
                MotionOutcome::Contact(_) => &mut tally.contacts,
                MotionOutcome::Grazing(_) => &mut tally.grazing,
                MotionOutcome::Overlapping(_) => &mut tally.overlapping,
                MotionOutcome::Undecided(_) => &mut tally.undecided,
                _ => &mut tally.free,
            };
            *count += 1;
            (outcome.proof().solids.is_some(), outcome.steps())
        }),
        None => if family == ARMS[0] { chain(seed) } else { slider(seed) }.judge(SAMPLES).map(
            |outcome| {
                let count = match outcome {
                    PathOutcome::Contact(_) => &mut tally.contacts,
                    PathOutcome::Grazing(_) => &mut tally.grazing,
                    PathOutcome::Overlapping(_) => &mut tally.overlapping,
                    PathOutcome::Undecided(_) => &mut tally.undecided,
                    _ => &mut tally.free,
                };
                *count += 1;
                (!outcome.proof().solids.is_empty(), outcome.steps())
            },
        ),
    };
    match found {
        Ok((solids, steps)) => {
            tally.solids += u64::from(solids);
            tally.most_looks = tally.most_looks.max(steps.looks);
        }
        Err(Objection(what)) => tally.disagreements.push(format!("{family}:{seed} {what}")),
    }
}
