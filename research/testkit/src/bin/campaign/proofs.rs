//! Forged proofs: what the library and `check.py` accept of them, held against the truth.

use std::cell::RefCell;

use colltrans_testkit::oracle::proofs::checkers::Fractions;
use colltrans_testkit::oracle::proofs::{self, Campaign, KINDS};

use crate::Asked;
use crate::tally::Tally;

/// Mutants of a proof, about: to go by their number.
pub(crate) const MUTANTS: u64 = 50;

thread_local! {
    /// The process of this thread that runs `check.py`.
    static FRACTIONS: RefCell<Option<Fractions>> = const { RefCell::new(None) };
}

/// What is counted.
pub(crate) const COLUMNS: &[&str] =
    &["proofs", "mutants", "steps", "accepted", "rounded", "partly", "ends", "false", "disagree"];

/// Takes the proof of one seed through its mutants.
pub(crate) fn examine(asked: &Asked<'_>, tally: &mut Tally) {
    let Some(kind) = KINDS.iter().find(|kind| kind.name == asked.family) else { return };
    let mut of = proofs::Tally::default();
    FRACTIONS.with_borrow_mut(|fractions| {
        if fractions.is_none() {
            match Fractions::start() {
                Ok(started) => *fractions = Some(started),
                Err(error) => tally.disagree(format!("check.py does not start: {error}")),
            }
        }
        Campaign::examine(kind, asked.seed, fractions.as_mut(), &mut of);
    });
    tally.add("proofs", of.proofs);
    tally.add("mutants", of.mutants);
    tally.add("steps", of.steps);
    tally.add("accepted", of.accepted);
    tally.add("rounded", of.rounded);
    tally.add("partly", of.partly);
    tally.add("ends", of.ends);
    tally.add("false", of.false_claims.len() as u64);
    tally.add("disagree", of.disagreements.len() as u64);
    of.false_claims.into_iter().chain(of.disagreements).for_each(|what| tally.disagree(what));
}
