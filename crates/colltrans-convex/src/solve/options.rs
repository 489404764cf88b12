//! Options of a cast, and the use that a tracker makes of its last answer.

use crate::answer::{
    CentralCast, Contact, FreeReason, Grazing, NearPoints, OverlapAhead, PlaneGap, Separated,
    Solver, Steps,
};
use crate::body::{Body, ConvexPolyhedron};
use crate::setting::check_min_gap;
use crate::setting::error::QueryError;
use crate::solve::cta::options as cta;

/// Options of a cast. The default suits most casts.
///
/// Options may be added in later versions. Therefore construct a value from the default.
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
    /// Solver that searches for the contact.
    pub solver: Solver,
    /// Maximum lateral overlap (world units) at which a contact counts as grazing.
    ///
    /// The rounding error of the configuration is the minimum that is used: eight noises, `256 u S` (see
    /// [the crate's introduction](crate#accuracy)). The default is 0, which selects this minimum.
    pub graze_tolerance: f64,
    /// Options of [`Solver::Cta`]. Other solvers ignore them.
    pub narrowing: cta::Options,
    /// Minimum gap between the bodies (world units): the cast ends when their distance falls to this length. See
    /// [`Cast::with_min_gap`](crate::Cast::with_min_gap). The default is 0, with which the cast ends when the bodies
    /// touch.
    pub min_gap: f64,
}

impl Body for ConvexPolyhedron {
    type Options = Options;
    type Contact = Contact;
    type Grazing = Grazing;
    type Separated = Separated;
    type Free = FreeReason;
    type Overlap = OverlapAhead;
    type Evidence = CentralCast;
    type Near = NearPoints;
    type Gap = PlaneGap;
    type Steps = Steps;
}

impl Options {
    /// Returns these options with another solver.
    #[must_use]
    pub const fn with_solver(self, solver: Solver) -> Self {
        Self { solver, ..self }
    }

    /// Returns these options with another graze tolerance (world units). It is not checked here; a cast rejects an
    /// invalid one.
    #[must_use]
    pub const fn with_graze_tolerance(self, graze_tolerance: f64) -> Self {
        Self { graze_tolerance, ..self }
    }

    /// Returns these options with other options of [`Solver::Cta`].
    #[must_use]
    pub const fn with_narrowing(self, narrowing: cta::Options) -> Self {
        Self { narrowing, ..self }
    }

    /// Returns these options with another minimum gap (world units). It is not checked here; a cast rejects an invalid
    /// one.
    #[must_use]
    pub const fn with_min_gap(self, min_gap: f64) -> Self {
        Self { min_gap, ..self }
    }

    /// Checks that the lengths are in range.
    ///
    /// # Errors
    /// - [`QueryError::GrazeTolerance`] if the graze tolerance is negative or not finite.
    /// - [`QueryError::NarrowingGap`] if the gap at which [`Solver::Cta`] ends is negative or not a number.
    /// - [`QueryError::MinGap`] if the minimum gap is negative or beyond the range of coordinates, or not 0 without the
    ///   feature `min-gap`.
    #[inline]
    #[doc(hidden)]
    pub fn check_lengths(&self) -> Result<(), QueryError> {
        let tolerance = self.graze_tolerance;
        if !tolerance.is_finite() || tolerance < 0.0 {
            return Err(QueryError::GrazeTolerance { tolerance });
        }
        if let cta::Until::Gap(gap) = self.narrowing.until
            && (gap.is_nan() || gap < 0.0)
        {
            return Err(QueryError::NarrowingGap { gap });
        }
        check_min_gap(self.min_gap)
    }
}

/// Use that a [`Tracker`](crate::Tracker) makes of its last answer.
///
/// It affects the work only, not the answers and certificates.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Focus {
    /// Feature focus (the paper, section V-F): whether to start from the features of the last answer. These are the
    /// contact features and their neighbours, or the separating direction.
    pub features: bool,
    /// Region focus (the paper, section III-D): the region of sections around the last contact points in which
    /// [`Solver::Cta`] starts.
    pub region: cta::Region,
}

impl Focus {
    /// Starts every cast from scratch.
    pub const NONE: Self = Self { features: false, region: cta::Region::Everywhere };

    /// Returns the focus that a [`Tracker`](crate::Tracker) uses by default: for [`Solver::Cta`] the region alone, as
    /// in the paper, otherwise features and region.
    pub const fn for_solver(solver: Solver) -> Self {
        let features = !matches!(solver, Solver::Cta);
        Self { features, region: cta::Region::Automatic }
    }

    /// Returns this focus with feature focus switched on or off.
    #[must_use]
    pub const fn with_features(self, features: bool) -> Self {
        Self { features, ..self }
    }

    /// Returns this focus with another region.
    #[must_use]
    pub const fn with_region(self, region: cta::Region) -> Self {
        Self { region, ..self }
    }
}

impl Default for Focus {
    /// Returns the focus for [`Solver::Auto`]: features first, then the region.
    fn default() -> Self {
        Self::for_solver(Solver::Auto)
    }
}

/// Serialised form of [`Options`]. Deserialised options are checked.
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
    #[serde(default, skip_serializing_if = "colltrans_kernel::serialization::is_zero")]
    min_gap: f64,
}

#[cfg(feature = "serde")]
impl From<Options> for OptionsRecord {
    fn from(Options { solver, graze_tolerance, narrowing, min_gap }: Options) -> Self {
        let cta::Options { start, until, keeps_to_cell, cuts, starts_cold } = narrowing;
        Self { solver, graze_tolerance, start, until, keeps_to_cell, cuts, starts_cold, min_gap }
    }
}

#[cfg(feature = "serde")]
impl TryFrom<OptionsRecord> for Options {
    type Error = QueryError;

    fn try_from(record: OptionsRecord) -> Result<Self, QueryError> {
        let OptionsRecord { start, until, keeps_to_cell, cuts, starts_cold, .. } = record;
        let narrowing = cta::Options { start, until, keeps_to_cell, cuts, starts_cold };
        let OptionsRecord { solver, graze_tolerance, min_gap, .. } = record;
        let options = Self { solver, graze_tolerance, narrowing, min_gap };
        options.check_lengths()?;
        Ok(options)
    }
}
