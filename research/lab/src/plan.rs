//! The amount of measurements.

use std::path::PathBuf;

/// The scale of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// Bodies of a few hundred vertices and a few queries, for tests, in seconds.
    Tiny,
    /// All sizes and few queries: under three minutes on two cores for everything.
    Quick,
    /// All sizes, eight pairs of bodies of each, and many queries: under half an hour.
    Full,
}

impl Scale {
    /// Returns the name on the command line and in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Tiny => "tiny",
            Self::Quick => "quick",
            Self::Full => "full",
        }
    }
}

/// Parameters of the experiments.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Plan {
    /// Scale of the measurements.
    pub scale: Scale,
    /// Seed of all random numbers; the same seed yields the same bodies and settings.
    pub seed: u64,
    /// Number of passes over every experiment, each with another pair of bodies of each size; `None` for that
    /// of the scale.
    pub passes: Option<u32>,
    /// A folder of mesh files of real parts to measure too.
    pub parts: Option<PathBuf>,
}

/// Receiver of progress reports.
pub trait Progress {
    /// Reports that `done` of `all` parts are finished (shares of the expected time, not counts), and the
    /// current activity.
    fn at(&mut self, done: f64, all: f64, doing: &str);
}
