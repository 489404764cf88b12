//! Forged proofs: what the library and `check.py` accept of them, held against the truth.

use std::cell::RefCell;

use colltrans_testkit::oracle::proofs::checkers::Fractions;
use colltrans_testkit::oracle::proofs::{self, Campaign, KINDS};

/// Mutants of a proof, about: to go by their number.
pub(crate) const MUTANTS: u64 = 50;

thread_local! {
    /// The process of this thread that runs `check.py`.
    static FRACTIONS: RefCell<Option<Fractions>> = const { RefCell::new(None) };
}

/// What became of the proofs of one kind.
#[derive(Debug, Default)]
pub(crate) struct Tally {
    of: proofs::Tally,
    faults: Vec<String>,
}

impl crate::Tally for Tally {
    const CHUNK: u64 = 4;

    fn header() -> String {
        format!(
            "{:>8} {:>9} {:>10} {:>9} {:>8} {:>8} {:>8} {:>6} {:>9}",
            "proofs",
            "mutants",
            "steps",
            "accepted",
            "rounded",
            "partly",
            "ends",
            "false",
            "disagree"
        )
    }

    fn line(&self) -> String {
        let of = &self.of;
        format!(
            "{:>8} {:>9} {:>10} {:>9} {:>8} {:>8} {:>8} {:>6} {:>9}",
            of.proofs,
            of.mutants,
            of.steps,
            of.accepted,
            of.rounded,
            of.partly,
            of.ends,
            of.false_claims.len(),
            of.disagreements.len()
        )
    }

    fn merge(mut self, mut other: Self) -> Self {
        let (of, and) = (&mut self.of, &mut other.of);
        of.proofs += and.proofs;
        of.mutants += and.mutants;
        of.steps += and.steps;
        of.accepted += and.accepted;
        of.rounded += and.rounded;
        of.partly += and.partly;
        of.ends += and.ends;
        of.false_claims.append(&mut and.false_claims);
        of.disagreements.append(&mut and.disagreements);
        self.faults.append(&mut other.faults);
        self
    }

    fn disagreements(&self) -> &[String] {
        &self.faults
    }
}

/// Takes the proof of one seed through its mutants.
pub(crate) fn examine(name: &str, seed: u64, tally: &mut Tally) {
    let Some(kind) = KINDS.iter().find(|kind| kind.name == name) else { return };
    FRACTIONS.with_borrow_mut(|fractions| {
        if fractions.is_none() {
            match Fractions::start() {
                Ok(started) => *fractions = Some(started),
                Err(error) => tally.faults.push(format!("check.py does not start: {error}")),
            }
        }
        let of = &mut tally.of;
        let before = [of.false_claims.len(), of.disagreements.len()];
        Campaign::examine(kind, seed, fractions.as_mut(), of);
        tally.faults.extend_from_slice(&of.false_claims[before[0]..]);
        tally.faults.extend_from_slice(&of.disagreements[before[1]..]);
    });
}
