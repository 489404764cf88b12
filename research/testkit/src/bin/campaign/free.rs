//! Free directions of bodies of cubes, each held against ordinary casts, the union of all cones in fractions, and
//! proofs that were changed.

use colltrans_testkit::oracle::solids::free;

/// Directions judged of each setting.
pub(crate) const DIRECTIONS: u64 = 100;

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
        format!(
            "{:>8} {:>12} {:>10} {:>10} {:>10} {:>10} {:>10} {:>6}",
            "settings", "overlapping", "judged", "free", "undecided", "refused", "cells", "wrong"
        )
    }

    fn line(&self) -> String {
        let free::Judged { directions, free, undecided, refused, cells } = self.judged;
        format!(
            "{:>8} {:>12} {directions:>10} {free:>10} {undecided:>10} {refused:>10} {cells:>10} {:>6}",
            self.settings,
            self.overlapping,
            self.disagreements.len()
        )
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
