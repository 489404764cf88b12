//! Sequences of settings: bodies held against their input points, every lane of trackers asked at every
//! step, each answer checked exactly and compared with the one-off answer, a sample solved again.

use std::mem::discriminant;

use colltrans::{Outcome, StartedFrom};
use colltrans_testkit::oracle::sequences::Walk;
use colltrans_testkit::oracle::tracked::{Finding, Lanes};
use colltrans_testkit::tally::Tally;

use crate::casts::{self, print_answers};
use crate::{Asked, print};

/// Steps of a sequence, with the first setting.
const STEPS: u32 = 60;

/// Lanes at each.
const LANES: u64 = 7;

/// Tracked queries of a sequence.
pub(crate) const QUERIES: u64 = STEPS as u64 * LANES;

/// One step in so many is solved again.
const ORACLE_EVERY: u32 = 20;

fn note(walk: &Walk, finding: &Finding, tally: &mut Tally) {
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

/// What is counted.
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
            note(&walk, finding, tally);
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

fn is_flip(before: &Finding, after: &Finding) -> bool {
    let kind = |finding: &Finding| finding.answer.as_ref().ok().map(discriminant::<Outcome>);
    kind(before) != kind(after)
}

/// One step of a sequence, with all its numbers and what led there.
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
        note(&walk, &finding, &mut tally);
    }
    print_answers(&walk.setting, &bodies);
    print(family, &tally, COLUMNS)
}
