//! Free directions of bodies of cubes and of convex ones, each held against ordinary casts, the union of all cones in
//! fractions, themselves turned and with a larger tolerance, and proofs that were changed.

use colltrans_testkit::oracle::solids::free;
pub(crate) use colltrans_testkit::oracle::solids::free::FAMILIES;

/// Directions judged of each setting.
pub(crate) const DIRECTIONS: u64 = 500;

/// What became of the settings of one family.
#[derive(Debug, Default, Clone)]
pub(crate) struct Tally {
    settings: u64,
    overlapping: u64,
    judged: free::Judged,
    disagreements: Vec<String>,
}

impl crate::Tally for Tally {
    const CHUNK: u64 = 4;

    fn header() -> String {
        let counts =
            ["judged", "free", "undecided", "fractions", "thin", "compared", "refused", "cells"];
        let counts = counts.map(|head| format!("{head:>10}")).join(" ");
        format!("{:>8} {:>12} {counts} {:>6}", "settings", "overlapping", "wrong")
    }

    fn line(&self) -> String {
        let free::Judged { directions, free, undecided, fractions, thin, compared, refused, cells } =
            self.judged;
        let counts = [directions, free, undecided, fractions, thin, compared, refused, cells];
        let counts = counts.map(|count| format!("{count:>10}")).join(" ");
        let wrong = self.disagreements.len();
        format!("{:>8} {:>12} {counts} {wrong:>6}", self.settings, self.overlapping)
    }

    fn merge(mut self, other: Self) -> Self {
        self.settings += other.settings;
        self.overlapping += other.overlapping;
        self.judged += other.judged;
        self.disagreements.extend(other.disagreements);
        self
    }

    fn disagreements(&self) -> &[String] {
        &self.disagreements
    }
}

/// Examines a setting.
pub(crate) fn examine(family: &str, seed: u64, tally: &mut Tally) {
    tally.settings += 1;
    match free::examine(family, seed, DIRECTIONS) {
        Ok(None) => tally.overlapping += 1,
        Ok(Some(judged)) => tally.judged += judged,
        Err(objection) => tally.disagreements.push(format!("{family}:{seed}: {objection}")),
    }
}
