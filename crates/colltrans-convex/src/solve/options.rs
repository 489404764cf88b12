//! Choices of a query.

use crate::answer::{
    CentralCast, Contact, Grazing, NearPoints, OverlapAhead, PlaneGap, Separated, Solver, Steps,
    WhyFree,
};
use crate::body::{Body, ConvexPolyhedron};
use crate::setting::check_keep;
use crate::setting::error::QueryError;

/// Choices of a query; the default is right for most. More may be added: begin with it.
///
/// ```
/// # use colltrans::{Narrowing, NarrowFrom, Options, Solver, Until};
/// let nearly = Narrowing::new(NarrowFrom::Center, Until::Gap(0.01));
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
    pub narrowing: Narrowing,
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
    pub const fn with_narrowing(self, narrowing: Narrowing) -> Self {
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
        if let Until::Gap(gap) = self.narrowing.until
            && (gap.is_nan() || gap < 0.0)
        {
            return Err(QueryError::NarrowingGap { gap });
        }
        check_keep(self.keep)
    }
}

/// From where, and how far, [`Solver::Cta`] narrows the search by planar problems. Answers do not depend on it.
///
/// The default is the paper's algorithm: from the centre of the levels, or in a tracker from `N(p)`, until the
/// features that touch are seen to solve the problem. A certificate is made of its result by
/// one portal, the face of `M` that the exit test has found.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Narrowing {
    /// Where the minimisation starts, if not in the region of a [`Tracker`](crate::Tracker)'s last
    /// solution.
    pub start: NarrowFrom,
    /// Where it ends; portal refinement goes on from there.
    pub until: Until,
    /// Whether a cell shift ends in its cell, as the paper's does, so that planar problems are the
    /// paper's steps. If not, it goes on from cell to cell where little of the region is left: fewer
    /// planar problems and less time.
    pub keeps_to_cell: bool,
    /// Where the region of levels is cut.
    pub cuts: Cuts,
    /// Whether each planar problem is searched from nothing, as the paper's are (its section V-F says what that
    /// costs). If not, from the edges that the one before ended with, also that of the last query.
    pub starts_cold: bool,
}

impl Narrowing {
    /// A first guess and rough: from the ellipsoids to a fifth of the extent, from cell to cell. Portal refinement
    /// does nearly all of the work; planar problems are solved only if the ellipsoids pass each other and the
    /// bodies may not.
    pub const ROUGH: Self =
        Self::new(NarrowFrom::Ellipsoids, Until::Gap(0.2)).with_keeps_to_cell(false);

    /// From a start to an end, each shift within its cell.
    pub const fn new(start: NarrowFrom, until: Until) -> Self {
        Self { start, until, keeps_to_cell: true, cuts: Cuts::Shifted, starts_cold: false }
    }

    /// With cell shifts that end in their cells, or not.
    #[must_use]
    pub const fn with_keeps_to_cell(self, keeps_to_cell: bool) -> Self {
        Self { keeps_to_cell, ..self }
    }

    /// With cuts through other levels.
    #[must_use]
    pub const fn with_cuts(self, cuts: Cuts) -> Self {
        Self { cuts, ..self }
    }

    /// With planar problems that are searched from nothing, or not.
    #[must_use]
    pub const fn with_starts_cold(self, starts_cold: bool) -> Self {
        Self { starts_cold, ..self }
    }
}

impl Default for Narrowing {
    /// The paper: the centre, until the exit test, each shift within its cell.
    fn default() -> Self {
        Self::new(NarrowFrom::default(), Until::default())
    }
}

/// Where a minimisation starts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
pub enum NarrowFrom {
    /// At the centre of all section levels (the paper, section III-A).
    #[default]
    Center,
    /// Where the bodies would meet if they were ellipsoids: portal refinement begins there, and
    /// planar problems are solved only if the ellipsoids pass each other and the bodies may not.
    Ellipsoids,
}

/// Where a minimisation cuts the region of levels.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
pub enum Cuts {
    /// Shifted to the best point of the cell in which the same features touch (the paper, line 5).
    #[default]
    Shifted,
    /// Through the levels of the planar problem themselves, as the method before the paper's cuts, its reference
    /// \[3\], which knows no cells. More steps, and only to compare with.
    Centroid,
}

#[cfg(feature = "serde")]
impl Cuts {
    #[expect(clippy::trivially_copy_pass_by_ref, reason = "what serde calls")]
    fn is_shifted(&self) -> bool {
        *self == Self::Shifted
    }
}

/// Where a minimisation ends. As text `exit`, or a number.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(into = "UntilRecord", try_from = "UntilRecord"))]
pub enum Until {
    /// Where the features that touch are seen to solve the problem (the paper, line 6 of its algorithm), or rounding
    /// hides what is left.
    #[default]
    Exit,
    /// There, or before: where its upper and lower bound are apart by no more than this share of the extent of both
    /// bodies along the direction.
    Gap(f64),
}

impl Until {
    /// Less than what tells the best features of large bodies apart, more than the rounding of `phi`.
    const ROUNDING: f64 = 1e-9;

    /// The share at which it ends at the latest.
    pub(crate) fn gap(self) -> f64 {
        match self {
            Self::Exit => Self::ROUNDING,
            Self::Gap(gap) => gap.max(Self::ROUNDING),
        }
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
    pub region: Region,
}

impl Focus {
    /// Every query from scratch.
    pub const NONE: Self = Self { features: false, region: Region::Everywhere };

    /// What a [`Tracker`](crate::Tracker) does unless it is told: with [`Solver::Cta`] the paper's, the region
    /// alone; else the default.
    pub const fn of(solver: Solver) -> Self {
        let features = !matches!(solver, Solver::Cta);
        Self { features, region: Region::Automatic }
    }

    /// With feature focus, or without.
    #[must_use]
    pub const fn with_features(self, features: bool) -> Self {
        Self { features, ..self }
    }

    /// With a region.
    #[must_use]
    pub const fn with_region(self, region: Region) -> Self {
        Self { region, ..self }
    }
}

impl Default for Focus {
    /// Features first, then the region.
    fn default() -> Self {
        Self::of(Solver::Auto)
    }
}

/// The neighbourhood `N(p)` of the last solution `p`, a square in the plane of the two section
/// levels, to which the minimisation is confined while nothing speaks against it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
pub enum Region {
    /// All levels: no focus.
    Everywhere,
    /// Half-side by what changed: how far the last contact points have moved apart sideways. If that
    /// is a large part of the bodies, or they have turned far against each other, all levels.
    #[default]
    Automatic,
    /// This half-side `delta`, in world units along the section axes.
    Fixed(f64),
}

/// Choices as they are written; read, they are checked like any others.
#[cfg(feature = "serde")]
#[derive(serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct OptionsRecord {
    solver: Solver,
    graze_tolerance: f64,
    #[serde(alias = "narrow_from")]
    start: NarrowFrom,
    #[serde(alias = "narrowing_gap")]
    until: Until,
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    keeps_to_cell: bool,
    #[serde(default, skip_serializing_if = "Cuts::is_shifted")]
    cuts: Cuts,
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    starts_cold: bool,
    #[serde(default, skip_serializing_if = "colltrans_kernel::written::is_zero")]
    keep: f64,
}

#[cfg(feature = "serde")]
impl From<Options> for OptionsRecord {
    fn from(Options { solver, graze_tolerance, narrowing, keep }: Options) -> Self {
        let Narrowing { start, until, keeps_to_cell, cuts, starts_cold } = narrowing;
        Self { solver, graze_tolerance, start, until, keeps_to_cell, cuts, starts_cold, keep }
    }
}

#[cfg(feature = "serde")]
impl TryFrom<OptionsRecord> for Options {
    type Error = QueryError;

    fn try_from(record: OptionsRecord) -> Result<Self, QueryError> {
        let OptionsRecord { start, until, keeps_to_cell, cuts, starts_cold, .. } = record;
        let narrowing = Narrowing { start, until, keeps_to_cell, cuts, starts_cold };
        let OptionsRecord { solver, graze_tolerance, keep, .. } = record;
        let options = Self { solver, graze_tolerance, narrowing, keep };
        options.check()?;
        Ok(options)
    }
}

/// A share as it is written, nothing if it is infinite; or `exit`.
#[cfg(feature = "serde")]
#[derive(serde::Serialize, serde::Deserialize)]
#[serde(untagged)]
pub(crate) enum UntilRecord {
    Share(Option<f64>),
    Name(String),
}

#[cfg(feature = "serde")]
impl From<Until> for UntilRecord {
    fn from(until: Until) -> Self {
        match until {
            Until::Exit => Self::Name(until.to_string()),
            Until::Gap(gap) => Self::Share(Some(gap).filter(|gap| gap.is_finite())),
        }
    }
}

#[cfg(feature = "serde")]
impl TryFrom<UntilRecord> for Until {
    type Error = NoUntil;

    fn try_from(record: UntilRecord) -> Result<Self, Self::Error> {
        match record {
            UntilRecord::Share(gap) => Ok(Self::Gap(gap.unwrap_or(f64::INFINITY))),
            UntilRecord::Name(name) => name.parse(),
        }
    }
}

colltrans_kernel::written::named!(
    "start",
    NarrowFrom { Center: "center", Ellipsoids: "ellipsoids" }
);

/// A text that says no end of a minimisation.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{text:?} is neither `exit` nor a number that is not negative")]
pub struct NoUntil {
    /// The text.
    pub text: String,
}

impl std::fmt::Display for Until {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Exit => f.pad("exit"),
            Self::Gap(gap) => gap.fmt(f),
        }
    }
}

impl std::str::FromStr for Until {
    type Err = NoUntil;

    fn from_str(text: &str) -> Result<Self, NoUntil> {
        if text == "exit" {
            return Ok(Self::Exit);
        }
        let gap = text.parse().ok().filter(|gap: &f64| *gap >= 0.0);
        gap.map(Self::Gap).ok_or_else(|| NoUntil { text: text.into() })
    }
}
