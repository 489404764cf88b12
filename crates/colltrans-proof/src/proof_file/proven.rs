//! The trait of statements that can be checked, and results of checks.

use super::error::ProofError;
use colltrans_removal::directions::FreeDirections;

/// Statement that can be checked against its query and bodies.
pub trait Verify<'a, Setting> {
    /// Checks the whole statement without a search.
    ///
    /// # Errors
    /// Returns the first claim that is not proven.
    fn verify(&self, about: &Setting) -> Result<Proven<'a>, ProofError>;
}

/// Result of a check.
pub enum Proven<'a> {
    /// The statement is proven.
    Statement,
    /// Bounds of the time of the first contact. The upper one is infinite if no contact is proven.
    Time([f64; 2]),
    /// Directions along which the moving body can leave.
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
    /// Returns the bounds of the time of the first contact, and `None` for other proofs.
    pub const fn time_bounds(&self) -> Option<[f64; 2]> {
        if let Self::Time(bounds) = self { Some(*bounds) } else { None }
    }
}
