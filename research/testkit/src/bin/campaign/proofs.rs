//! Campaign of forged proofs: compares what the library and `check.py` accept with the truth.

use std::cell::RefCell;

use colltrans_testkit::oracle::proofs::checkers::RationalChecker;
use colltrans_testkit::oracle::proofs::{Campaign, KINDS};
use colltrans_testkit::tally::Tally;

use crate::Asked;

/// Approximate number of mutants of a proof, from which the number of proofs is computed.
pub(crate) const MUTANTS: u64 = 50;

thread_local! {
    /// The process of this thread that runs `check.py`.
    static FRACTIONS: RefCell<Option<RationalChecker>> = const { RefCell::new(None) };
}

/// Examines the proof of a seed and its mutants.
pub(crate) fn examine(asked: &Asked<'_>, tally: &mut Tally) -> Result<(), String> {
    let Some(kind) = KINDS.iter().find(|kind| kind.name == asked.family) else { return Ok(()) };
    FRACTIONS.with_borrow_mut(|fractions| {
        if fractions.is_none() {
            let started =
                RationalChecker::start().map_err(|e| format!("cannot start check.py: {e}"));
            *fractions = Some(started?);
        }
        Campaign::examine(kind, asked.seed, fractions.as_mut(), tally);
        Ok(())
    })
}
