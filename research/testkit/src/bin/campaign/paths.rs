//! Arms of one to seven joints on random paths, with convex bodies and with solids: proofs are checked by the library,
//! answers by plain matrices at many times.

use colltrans::motion::path::PathOutcome;
use colltrans_testkit::oracle::check::Objection;
use colltrans_testkit::oracle::path::Arm;

/// With convex bodies alone, and with solids that are not.
pub(crate) const FAMILIES: [&str; 2] = ["arms", "arms of solids"];

/// Times at which all pairs are looked at.
const SAMPLES: [usize; 2] = [60, 10];

/// What became of the settings of one family.
#[derive(Debug, Default, Clone)]
pub(crate) struct Tally {
    settings: u64,
    contacts: u64,
    grazing: u64,
    free: u64,
    overlapping: u64,
    /// Without an answer.
    open: u64,
    looks: u64,
    most_looks: u32,
    widest: f64,
    disagreements: Vec<String>,
}

impl crate::Tally for Tally {
    const CHUNK: u64 = 16;

    fn header() -> String {
        let heads = ["settings", "contacts", "grazing", "free", "overlap", "open", "looks"];
        let heads = heads.iter().chain(&["most", "widest", "wrong"]);
        heads.map(|head| format!("{head:>9} ")).collect::<Vec<_>>().concat()
    }

    fn line(&self) -> String {
        let looks = self.looks as f64 / self.settings.max(1) as f64;
        let counts =
            [self.settings, self.contacts, self.grazing, self.free, self.overlapping, self.open]
                .map(|count| format!("{count:>9} "))
                .concat();
        let Self { most_looks, widest, .. } = self;
        let wrong = self.disagreements.len();
        format!("{counts}{looks:>9.2} {most_looks:>9} {widest:>9.1e} {wrong:>9} ")
    }

    fn merge(mut self, other: Self) -> Self {
        self.settings += other.settings;
        self.contacts += other.contacts;
        self.grazing += other.grazing;
        self.free += other.free;
        self.overlapping += other.overlapping;
        self.open += other.open;
        self.looks += other.looks;
        self.most_looks = self.most_looks.max(other.most_looks);
        self.widest = self.widest.max(other.widest);
        self.disagreements.extend(other.disagreements);
        self
    }

    fn disagreements(&self) -> &[String] {
        &self.disagreements
    }
}

/// Asks about an arm, and judges the answer.
pub(crate) fn examine(family: &str, seed: u64, tally: &mut Tally) {
    tally.settings += 1;
    let solids = family == FAMILIES[1];
    match Arm::random(seed, solids).judge(SAMPLES[usize::from(solids)]) {
        Err(Objection(what)) => tally.disagreements.push(format!("{family}:{seed} {what}")),
        Ok(outcome) => {
            let looks = outcome.steps().looks;
            tally.looks += u64::from(looks);
            tally.most_looks = tally.most_looks.max(looks);
            match outcome {
                PathOutcome::Contact(of) => {
                    tally.contacts += 1;
                    tally.widest = tally.widest.max(of.upper - of.lower);
                }
                PathOutcome::Grazing(_) => tally.grazing += 1,
                PathOutcome::Overlapping(_) => tally.overlapping += 1,
                PathOutcome::Undecided(_) => tally.open += 1,
                _ => tally.free += 1,
            }
        }
    }
}
