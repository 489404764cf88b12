//! Campaign of sequences of settings. Bodies are compared with their input points. Each lane of trackers is
//! queried at every step. Each answer is checked exactly, and compared with that of a single query. The oracle
//! solves a sample.

use std::mem::discriminant;

use colltrans::{Outcome, StartedFrom};
use colltrans_testkit::oracle::sequences::Walk;
use colltrans_testkit::oracle::tracked::{Finding, Lanes};
use colltrans_testkit::tally::Tally;

use crate::casts::{self, print_answers};
use crate::{Asked, print_tally};

/// Number of steps of a sequence, including the first setting.
const STEPS: u32 = 60;

/// Number of lanes at each step.
const LANES: u64 = 7;

/// Number of tracked queries of a sequence.
pub(crate) const QUERIES: u64 = STEPS as u64 * LANES;

/// The oracle solves one step out of this many.
const ORACLE_EVERY: u32 = 20;

/// Records a finding.
fn record_finding(walk: &Walk, finding: &Finding, tally: &mut Tally) {
    tally.count("queries");
    if let Ok(outcome) = &finding.answer {
        tally.count(casts::kind(outcome));
    }
    match &finding.verdict {
        Ok(agreement) => {
            tally.count(match agreement.path {
                StartedFrom::Difference | StartedFrom::Features => "features",
                StartedFrom::Region => "region",
                StartedFrom::Scratch => "scratch",
            });
            tally.count_if("rounding", agreement.rounding_decides);
            tally.largest("gap/tol", agreement.proof.gap_over_tolerance);
            tally.largest("miss/u", agreement.proof.residual_in_noises);
        }
        Err(objection) => {
            let Finding { lane, solver, .. } = finding;
            tally.disagree(format!("{walk} {lane} ({solver:?}): {objection}"));
        }
    }
}

/// Columns of the table.
pub(crate) const COLUMNS: &[&str] = &[
    "queries",
    "contact",
    "grazing",
    "separated",
    "features",
    "region",
    "scratch",
    "flips",
    "rounding",
    "gap/tol",
    "miss/u",
];

/// Examines the sequence of a family with a seed.
pub(crate) fn examine(asked: &Asked<'_>, tally: &mut Tally) -> Result<(), String> {
    let Asked { family, seed, .. } = *asked;
    let mut walk = Walk::new(family, seed);
    let bodies = walk.setting.bodies().map_err(|error| format!("no body: {error}"))?;
    if let Err(objection) = walk.setting.judge_bodies(&bodies) {
        tally.disagree(format!("{walk} {objection}"));
    }
    let mut lanes = Lanes::new(&bodies);
    let mut before: Vec<Finding> = Vec::new();
    for step in 0..STEPS {
        let findings = lanes.ask(&walk.setting, step.is_multiple_of(ORACLE_EVERY));
        for finding in &findings {
            record_finding(&walk, finding, tally);
        }
        tally.add(
            "flips",
            before.iter().zip(&findings).filter(|(a, b)| is_flip(a, b)).count() as u64,
        );
        before = findings;
        walk.advance();
    }
    Ok(())
}

/// Checks whether the kind of the answer changes between two steps.
fn is_flip(before: &Finding, after: &Finding) -> bool {
    let kind = |finding: &Finding| finding.answer.as_ref().ok().map(discriminant::<Outcome>);
    kind(before) != kind(after)
}

/// Prints and examines one step of a sequence, after replaying the steps before it. Returns whether there are
/// no disagreements.
pub(crate) fn replay(family: &str, seed: u64, step: u32) -> bool {
    let mut walk = Walk::new(family, seed);
    let Ok(bodies) = walk.setting.bodies() else {
        println!("no body");
        return false;
    };
    let mut lanes = Lanes::new(&bodies);
    let mut tally = Tally::default();
    while walk.step < step {
        lanes.ask(&walk.setting, false);
        walk.advance();
    }
    println!("{:#?}", walk.setting);
    for finding in lanes.ask(&walk.setting, true) {
        println!("{finding:#?}");
        record_finding(&walk, &finding, &mut tally);
    }
    print_answers(&walk.setting, &bodies);
    print_tally(family, &tally, COLUMNS)
}
