//! Choices of a query.

use crate::error::QueryError;
use crate::outcome::Solver;

/// Choices of a query; the default is right for most.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Options {
    /// How the search is narrowed.
    pub solver: Solver,
    /// Sideways overlap (world units) up to which a contact counts as grazing. `0`, the default,
    /// stands for the rounding error of the configuration, which is the least that is ever used:
    /// eight noises, `256 u S` (see [the crate's introduction](crate#accuracy)).
    pub graze_tolerance: f64,
}

impl Options {
    pub(crate) fn check(&self) -> Result<(), QueryError> {
        let tolerance = self.graze_tolerance;
        if !tolerance.is_finite() || tolerance < 0.0 {
            return Err(QueryError::GrazeTolerance { tolerance });
        }
        Ok(())
    }
}

/// What a [`Tracker`](crate::Tracker) makes of its last answer. Answers and certificates do not
/// depend on it, only the work does.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Focus {
    /// Feature focus (the paper, section V-F): try first to end with the last contact features or
    /// their neighbours, and with the last separating direction.
    pub features: bool,
    /// Region focus (the paper, section III-D), where the collision translation algorithm narrows
    /// the search ([`Solver::Cta`]): start from the sections through the last contact points.
    pub region: Region,
}

impl Focus {
    /// Every query from scratch.
    pub const NONE: Self = Self { features: false, region: Region::Everywhere };
}

impl Default for Focus {
    /// Features first, then the region.
    fn default() -> Self {
        Self { features: true, region: Region::Automatic }
    }
}

/// The neighbourhood `N(p)` of the last solution `p`, a square in the plane of the two section
/// levels, to which the minimisation is confined while nothing speaks against it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Region {
    /// All levels: no focus.
    Everywhere,
    /// Half-side by what changed: how far the last contact points have moved apart sideways, and
    /// how far the bodies have turned against each other.
    #[default]
    Automatic,
    /// This half-side `delta`, in world units along the section axes.
    Fixed(f64),
}
