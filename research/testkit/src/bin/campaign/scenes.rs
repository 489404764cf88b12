//! Scenes: one body among many that came, moved and went.

use colltrans_testkit::oracle::among::Setting;

/// What became of the scenes of one family.
#[derive(Debug, Default, Clone)]
pub(crate) struct Tally {
    scenes: u64,
    obstacles: usize,
    asked: usize,
    overlapped: u64,
    tied: u64,
    stopped: u64,
    refused: usize,
    disagreements: Vec<String>,
}

impl crate::Tally for Tally {
    const CHUNK: u64 = 16;

    fn header() -> String {
        let names = ["scenes", "obstacles", "asked", "overlapped", "tied", "stopped", "refused"];
        let heads: Vec<String> = names.iter().map(|name| format!("{name:>11}")).collect();
        format!("{} {:>8}", heads.concat(), "wrong")
    }

    fn line(&self) -> String {
        format!(
            "{:>11}{:>11}{:>11}{:>11}{:>11}{:>11}{:>11} {:>8}",
            self.scenes,
            self.obstacles,
            self.asked,
            self.overlapped,
            self.tied,
            self.stopped,
            self.refused,
            self.disagreements.len()
        )
    }

    fn merge(mut self, other: Self) -> Self {
        self.scenes += other.scenes;
        self.obstacles += other.obstacles;
        self.asked += other.asked;
        self.overlapped += other.overlapped;
        self.tied += other.tied;
        self.stopped += other.stopped;
        self.refused += other.refused;
        self.disagreements.extend(other.disagreements);
        self
    }

    fn disagreements(&self) -> &[String] {
        &self.disagreements
    }
}

/// Draws a scene, asks everything, and judges it.
pub(crate) fn examine(family: &str, seed: u64, tally: &mut Tally) {
    tally.scenes += 1;
    match Setting::draw(family, seed).and_then(|setting| setting.examine()) {
        Ok(seen) => {
            tally.obstacles += seen.obstacles;
            tally.asked += seen.asked;
            tally.overlapped += u64::from(seen.overlapped);
            tally.tied += u64::from(seen.tied);
            tally.stopped += u64::from(seen.stopped);
            tally.refused += seen.refused;
        }
        Err(objection) => tally.disagreements.push(format!("{family}:{seed}: {objection}")),
    }
}
