//! Choices of a query.

use crate::answer::{
    CentralCast, Contact, Grazing, NearPoints, OverlapAhead, PlaneGap, Separated, Solver, WhyFree,
};
use crate::body::{Body, ConvexPolyhedron};
use crate::setting::check_keep;
use crate::setting::error::QueryError;

/// Choices of a query; the default is right for most. More may be added: begin with it.
///
/// ```
/// # use colltrans::{Narrowing, NarrowFrom, Options, Solver};
/// let to_the_end = Narrowing::new(NarrowFrom::Center, 0.0);
/// let options = Options::default().with_solver(Solver::Cta).with_narrowing(to_the_end);
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
    pub(crate) fn check(&self) -> Result<(), QueryError> {
        let tolerance = self.graze_tolerance;
        if !tolerance.is_finite() || tolerance < 0.0 {
            return Err(QueryError::GrazeTolerance { tolerance });
        }
        let gap = self.narrowing.gap;
        if gap.is_nan() || gap < 0.0 {
            return Err(QueryError::NarrowingGap { gap });
        }
        check_keep(self.keep)
    }
}

/// From where, and how far, the collision translation algorithm narrows the search before portal
/// refinement takes over; the defaults do least work. Answers do not depend on it.
///
/// However wide the gap, planar problems end where the features that touch are seen to solve the
/// problem (the paper's exit test); portal refinement then only proves them.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Narrowing {
    /// Where the minimisation starts, if not in the region of a [`Tracker`](crate::Tracker)'s last
    /// solution.
    pub start: NarrowFrom,
    /// It ends at the latest when its upper and lower bound are apart by no more than this share of
    /// the extent of both bodies along the direction; at `0` it goes on to the contact itself.
    pub gap: f64,
    /// Whether a cell shift ends in its cell, as the paper's does, so that planar problems are the
    /// paper's steps. If not, it goes on from cell to cell where little of the region is left: fewer
    /// planar problems and less time.
    pub keeps_to_cell: bool,
}

impl Narrowing {
    /// From a start to a gap, and from cell to cell.
    pub const fn new(start: NarrowFrom, gap: f64) -> Self {
        Self { start, gap, keeps_to_cell: false }
    }

    /// With cell shifts that end in their cells, or not.
    #[must_use]
    pub const fn with_keeps_to_cell(self, keeps_to_cell: bool) -> Self {
        Self { keeps_to_cell, ..self }
    }
}

impl Default for Narrowing {
    /// Ellipsoids, a fifth, and from cell to cell.
    fn default() -> Self {
        Self::new(NarrowFrom::Ellipsoids, 0.2)
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
    /// Where the bodies would meet if they were ellipsoids: portal refinement begins there, and
    /// planar problems are solved only if the ellipsoids pass each other and the bodies may not.
    #[default]
    Ellipsoids,
    /// At the centre of all section levels (the paper, section III-A).
    Center,
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
        Self { features: true, region: Region::Automatic }
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
    narrow_from: NarrowFrom,
    #[serde(with = "crate::written::or_infinite")]
    narrowing_gap: f64,
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    keeps_to_cell: bool,
    #[serde(default, skip_serializing_if = "crate::written::is_zero")]
    keep: f64,
}

#[cfg(feature = "serde")]
impl From<Options> for OptionsRecord {
    fn from(Options { solver, graze_tolerance, narrowing, keep }: Options) -> Self {
        let Narrowing { start: narrow_from, gap: narrowing_gap, keeps_to_cell } = narrowing;
        Self { solver, graze_tolerance, narrow_from, narrowing_gap, keeps_to_cell, keep }
    }
}

#[cfg(feature = "serde")]
impl TryFrom<OptionsRecord> for Options {
    type Error = QueryError;

    fn try_from(record: OptionsRecord) -> Result<Self, QueryError> {
        let OptionsRecord { solver, graze_tolerance, keep, .. } = record;
        let OptionsRecord { narrow_from, narrowing_gap, keeps_to_cell, .. } = record;
        let narrowing = Narrowing { start: narrow_from, gap: narrowing_gap, keeps_to_cell };
        let options = Self { solver, graze_tolerance, narrowing, keep };
        options.check()?;
        Ok(options)
    }
}
