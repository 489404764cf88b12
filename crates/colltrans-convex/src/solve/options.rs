//! Choices of a query.

use crate::answer::{
    CentralCast, Contact, Grazing, NearPoints, OverlapAhead, PlaneGap, Separated, Solver, Steps,
    WhyFree,
};
use crate::body::{Body, ConvexPolyhedron};
use crate::setting::check_keep;
use crate::setting::error::QueryError;
use crate::solve::cta::options as cta;

/// Choices of a query; the default is right for most. More may be added: begin with it.
///
/// ```
/// # use colltrans::{Options, Solver, cta};
/// let nearly = cta::Options::new(cta::Start::Center, cta::Until::Gap(0.01));
/// let options = Options::default().with_solver(Solver::Cta).with_narrowing(nearly);
/// assert_eq!(options.graze_tolerance, 0.0);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(into = "OptionsRecord", try_from = "OptionsRecord")
)]
#[non_exhaustive]
pub struct Options {
    /// How the search is narrowed.
    pub solver: Solver,
    /// Sideways overlap (world units) up to which a contact counts as grazing. `0`, the default,
    /// stands for the rounding error of the configuration, which is the least that is ever used:
    /// eight noises, `256 u S` (see [the crate's introduction](crate#accuracy)).
    pub graze_tolerance: f64,
    /// How [`Solver::Cta`] narrows the search; of no effect on the others.
    pub narrowing: cta::Options,
    /// How near to each other the bodies may come (world units): see
    /// [`Cast::keeping`](crate::Cast::keeping). `0`, the default: until they touch.
    pub keep: f64,
}

impl Body for ConvexPolyhedron {
    type Options = Options;
    type Contact = Contact;
    type Grazing = Grazing;
    type Separated = Separated;
    type Free = WhyFree;
    type Overlap = OverlapAhead;
    type Evidence = CentralCast;
    type Near = NearPoints;
    type Gap = PlaneGap;
    type Steps = Steps;
}

impl Options {
    /// With a solver.
    #[must_use]
    pub const fn with_solver(self, solver: Solver) -> Self {
        Self { solver, ..self }
    }

    /// With a graze tolerance, a length. It is checked where it is used.
    #[must_use]
    pub const fn with_graze_tolerance(self, graze_tolerance: f64) -> Self {
        Self { graze_tolerance, ..self }
    }

    /// With a narrowing.
    #[must_use]
    pub const fn with_narrowing(self, narrowing: cta::Options) -> Self {
        Self { narrowing, ..self }
    }

    /// With a gap to be kept, a length. It is checked where it is used.
    #[must_use]
    pub const fn with_keep(self, keep: f64) -> Self {
        Self { keep, ..self }
    }

    #[inline]
    #[doc(hidden)]
    pub fn check(&self) -> Result<(), QueryError> {
        let tolerance = self.graze_tolerance;
        if !tolerance.is_finite() || tolerance < 0.0 {
            return Err(QueryError::GrazeTolerance { tolerance });
        }
        if let cta::Until::Gap(gap) = self.narrowing.until
            && (gap.is_nan() || gap < 0.0)
        {
            return Err(QueryError::NarrowingGap { gap });
        }
        check_keep(self.keep)
    }
}

/// What a [`Tracker`](crate::Tracker) makes of its last answer. Answers and certificates do not
/// depend on it, only the work does.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Focus {
    /// Feature focus (the paper, section V-F): try first to end with the last contact features or
    /// their neighbours, and with the last separating direction.
    pub features: bool,
    /// Region focus (the paper, section III-D), where the collision translation algorithm narrows
    /// the search ([`Solver::Cta`]): start from the sections through the last contact points.
    pub region: cta::Region,
}

impl Focus {
    /// Every query from scratch.
    pub const NONE: Self = Self { features: false, region: cta::Region::Everywhere };

    /// What a [`Tracker`](crate::Tracker) does unless it is told: with [`Solver::Cta`] the paper's, the region
    /// alone; else the default.
    pub const fn of(solver: Solver) -> Self {
        let features = !matches!(solver, Solver::Cta);
        Self { features, region: cta::Region::Automatic }
    }

    /// With feature focus, or without.
    #[must_use]
    pub const fn with_features(self, features: bool) -> Self {
        Self { features, ..self }
    }

    /// With a region.
    #[must_use]
    pub const fn with_region(self, region: cta::Region) -> Self {
        Self { region, ..self }
    }
}

impl Default for Focus {
    /// Features first, then the region.
    fn default() -> Self {
        Self::of(Solver::Auto)
    }
}

/// Choices as they are written; read, they are checked like any others.
#[cfg(feature = "serde")]
#[derive(serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct OptionsRecord {
    solver: Solver,
    graze_tolerance: f64,
    #[serde(alias = "narrow_from")]
    start: cta::Start,
    #[serde(alias = "narrowing_gap")]
    until: cta::Until,
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    keeps_to_cell: bool,
    #[serde(default, skip_serializing_if = "cta::Cuts::is_shifted")]
    cuts: cta::Cuts,
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    starts_cold: bool,
    #[serde(default, skip_serializing_if = "colltrans_kernel::written::is_zero")]
    keep: f64,
}

#[cfg(feature = "serde")]
impl From<Options> for OptionsRecord {
    fn from(Options { solver, graze_tolerance, narrowing, keep }: Options) -> Self {
        let cta::Options { start, until, keeps_to_cell, cuts, starts_cold } = narrowing;
        Self { solver, graze_tolerance, start, until, keeps_to_cell, cuts, starts_cold, keep }
    }
}

#[cfg(feature = "serde")]
impl TryFrom<OptionsRecord> for Options {
    type Error = QueryError;

    fn try_from(record: OptionsRecord) -> Result<Self, QueryError> {
        let OptionsRecord { start, until, keeps_to_cell, cuts, starts_cold, .. } = record;
        let narrowing = cta::Options { start, until, keeps_to_cell, cuts, starts_cold };
        let OptionsRecord { solver, graze_tolerance, keep, .. } = record;
        let options = Self { solver, graze_tolerance, narrowing, keep };
        options.check()?;
        Ok(options)
    }
}
