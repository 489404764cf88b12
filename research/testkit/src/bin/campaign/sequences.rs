//! Sequences of settings: bodies held against their input points, every lane of trackers asked at every
//! step, each answer checked exactly and compared with the one-off answer, a sample solved again.

use std::mem::discriminant;

use colltrans::{Outcome, StartedFrom};
use colltrans_testkit::oracle::check::Proof;
use colltrans_testkit::oracle::sequences::Walk;
use colltrans_testkit::oracle::tracked::{Finding, Lanes};

use crate::casts::print_answers;
use crate::print;

/// Steps of a sequence, with the first setting.
const STEPS: u32 = 60;

/// Lanes at each.
const LANES: u64 = 7;

/// Tracked queries of a sequence.
pub(crate) const QUERIES: u64 = STEPS as u64 * LANES;

/// One step in so many is solved again.
const ORACLE_EVERY: u32 = 20;

/// What became of the sequences of one family.
#[derive(Debug, Default, Clone)]
pub(crate) struct Tally {
    queries: u64,
    /// Contacts, grazings, separations.
    outcomes: [u64; 3],
    /// By [`StartedFrom`].
    paths: [u64; 3],
    /// Queries with another outcome than the lane's last.
    flips: u64,
    /// Answers other than from scratch, both admissible.
    rounding_decides: u64,
    worst: Proof,
    disagreements: Vec<String>,
}

impl crate::Tally for Tally {
    const CHUNK: u64 = 4;

    fn header() -> String {
        format!(
            "{:>8} {:>8} {:>8} {:>9} {:>8} {:>8} {:>8} {:>8} {:>8} {:>7} {:>7} {:>6}",
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
            "wrong"
        )
    }

    fn line(&self) -> String {
        let [contact, grazing, separated] = self.outcomes;
        let [features, region, scratch] = self.paths;
        format!(
            "{:>8} {contact:>8} {grazing:>8} {separated:>9} {features:>8} {region:>8} {scratch:>8} \
             {:>8} {:>8} {:>7.3} {:>7.3} {:>6}",
            self.queries,
            self.flips,
            self.rounding_decides,
            self.worst.gap_over_tolerance,
            self.worst.residual_in_noises,
            self.disagreements.len()
        )
    }

    fn merge(mut self, other: Self) -> Self {
        self.queries += other.queries;
        self.outcomes = add(self.outcomes, other.outcomes);
        self.paths = add(self.paths, other.paths);
        self.flips += other.flips;
        self.rounding_decides += other.rounding_decides;
        self.worst = self.worst.worse(&other.worst);
        self.disagreements.extend(other.disagreements);
        self
    }

    fn disagreements(&self) -> &[String] {
        &self.disagreements
    }
}

impl Tally {
    fn note(&mut self, walk: &Walk, finding: &Finding) {
        self.queries += 1;
        if let Ok(outcome) = &finding.answer {
            self.outcomes[match outcome {
                Outcome::Contact(_) => 0,
                Outcome::Grazing(_) => 1,
                Outcome::Separated(_) => 2,
            }] += 1;
        }
        match &finding.verdict {
            Ok(agreement) => {
                self.paths[match agreement.path {
                    StartedFrom::Difference | StartedFrom::Features => 0,
                    StartedFrom::Region => 1,
                    StartedFrom::Scratch => 2,
                }] += 1;
                self.rounding_decides += u64::from(agreement.rounding_decides);
                self.worst = self.worst.worse(&agreement.proof);
            }
            Err(objection) => {
                let Finding { lane, solver, .. } = finding;
                self.disagreements.push(format!("{walk} {lane} ({solver:?}): {objection}"));
            }
        }
    }
}

fn add(a: [u64; 3], b: [u64; 3]) -> [u64; 3] {
    [0, 1, 2].map(|i| a[i] + b[i])
}

/// Examines the sequence of a family with a seed.
pub(crate) fn examine(family: &str, seed: u64, tally: &mut Tally) {
    let mut walk = Walk::new(family, seed);
    let bodies = match walk.setting.bodies() {
        Ok(bodies) => bodies,
        Err(error) => {
            tally.disagreements.push(format!("{walk} no body: {error}"));
            return;
        }
    };
    if let Err(objection) = walk.setting.judge_bodies(&bodies) {
        tally.disagreements.push(format!("{walk} {objection}"));
    }
    let mut lanes = Lanes::new(&bodies);
    let mut before: Vec<Finding> = Vec::new();
    for step in 0..STEPS {
        let findings = lanes.ask(&walk.setting, step.is_multiple_of(ORACLE_EVERY));
        for finding in &findings {
            tally.note(&walk, finding);
        }
        tally.flips += before.iter().zip(&findings).filter(|(a, b)| is_flip(a, b)).count() as u64;
        before = findings;
        walk.advance();
    }
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
        tally.note(&walk, &finding);
    }
    print_answers(&walk.setting, &bodies);
    print(family, &tally);
    tally.disagreements.is_empty()
}
