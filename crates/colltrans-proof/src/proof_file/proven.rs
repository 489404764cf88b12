//! What a statement has to be able to do, and what a check of it has proven.

use super::error::ProofError;
use colltrans_removal::free::FreeDirections;

/// A statement that can be checked against what it is about.
pub trait Verify<'a, Setting> {
    /// Checks all of it, without a search.
    ///
    /// # Errors
    /// The first thing that is not proven.
    fn verify(&self, about: &Setting) -> Result<Proven<'a>, ProofError>;
}

/// What a check has proven.
pub enum Proven<'a> {
    /// What the statement says.
    Statement,
    /// Bounds of the time at which bodies first meet: infinity if they are not proven to meet.
    Time([f64; 2]),
    /// Along which directions the moving body can leave.
    Directions(Box<FreeDirections<'a>>),
}

impl std::fmt::Debug for Proven<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Statement => f.write_str("Statement"),
            Self::Time(bounds) => f.debug_tuple("Time").field(bounds).finish(),
            Self::Directions(_) => f.write_str("Directions"),
        }
    }
}

impl Proven<'_> {
    /// Returns the bounds of the time at which bodies first meet, if the proof is about one.
    pub const fn time(&self) -> Option<[f64; 2]> {
        if let Self::Time(bounds) = self { Some(*bounds) } else { None }
    }
}
