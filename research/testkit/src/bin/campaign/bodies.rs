//! Nearly flat bodies, held against their input points in fractions, and a cast onto each that is judged
//! by the input points too.

use colltrans_testkit::oracle::settings::{Setting, setting};

use crate::casts;

/// What became of the bodies of one family.
#[derive(Debug, Default, Clone)]
pub(crate) struct Tally {
    bodies: u64,
    /// By dimension.
    dimensions: [u64; 4],
    dropped: usize,
    /// Largest distance of a dropped point, and largest hull error, in multiples of the largest
    /// coordinate.
    farthest: f64,
    error: f64,
    casts: casts::Tally,
}

impl crate::Tally for Tally {
    const CHUNK: u64 = 64;

    fn header() -> String {
        format!(
            "{:>8} {:>8} {:>8} {:>8} {:>9} {:>10} {:>10} {}",
            "bodies",
            "solid",
            "flat",
            "straight",
            "dropped",
            "farthest",
            "claimed",
            casts::Tally::header()
        )
    }

    fn line(&self) -> String {
        let [point, segment, flat, solid] = self.dimensions;
        format!(
            "{:>8} {solid:>8} {flat:>8} {:>8} {:>9} {:>10.2e} {:>10.2e} {}",
            self.bodies,
            point + segment,
            self.dropped,
            self.farthest,
            self.error,
            self.casts.line()
        )
    }

    fn merge(mut self, other: Self) -> Self {
        self.bodies += other.bodies;
        for (mine, theirs) in self.dimensions.iter_mut().zip(other.dimensions) {
            *mine += theirs;
        }
        self.dropped += other.dropped;
        self.farthest = self.farthest.max(other.farthest);
        self.error = self.error.max(other.error);
        self.casts = self.casts.merge(other.casts);
        self
    }

    fn disagreements(&self) -> &[String] {
        self.casts.disagreements()
    }
}

/// Examines the fixed body of a setting, and a cast onto it that is solved again.
pub(crate) fn examine(family: &str, seed: u64, tally: &mut Tally) {
    let setting = setting(family, seed);
    tally.note(&setting);
    casts::examine_setting(&setting, true, &mut tally.casts);
}

impl Tally {
    fn note(&mut self, setting: &Setting) {
        let Ok(bodies) = setting.bodies() else { return };
        self.bodies += 1;
        self.dimensions[usize::from(bodies.fixed.dimension())] += 1;
        let largest = setting.fixed.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max);
        self.error = self.error.max(bodies.fixed.hull_error() / largest);
        if let Ok([_, kept]) = setting.judge_bodies(&bodies) {
            self.dropped += kept.dropped;
            self.farthest = self.farthest.max(kept.farthest / largest);
        }
    }
}
