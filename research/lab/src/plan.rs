//! How much to measure.

use std::path::PathBuf;

/// The scale of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// Bodies of a few hundred vertices, a few queries: for tests, in seconds.
    Tiny,
    /// All sizes, few queries: under three minutes on two cores for everything.
    Quick,
    /// All sizes, eight pairs of bodies of each, many queries: under half an hour.
    Full,
}

impl Scale {
    /// Its name on the command line and in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Tiny => "tiny",
            Self::Quick => "quick",
            Self::Full => "full",
        }
    }
}

/// What an experiment is given.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Plan {
    /// How much.
    pub scale: Scale,
    /// Everything random is drawn from it; the same seed draws the same bodies and settings.
    pub seed: u64,
    /// Passes over every experiment, each with another pair of bodies of each size, if not what the scale has.
    pub passes: Option<u32>,
    /// A folder of mesh files, real parts to be measured as well.
    pub parts: Option<PathBuf>,
}

/// Told how far an experiment is.
pub trait Progress {
    /// `done` of `all` parts (shares of the expected time, not counts), and what is going on.
    fn at(&mut self, done: f64, all: f64, doing: &str);
}
