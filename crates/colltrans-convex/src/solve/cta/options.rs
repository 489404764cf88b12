//! Choices of the collision translation algorithm.

/// From where, and how far, [`Solver::Cta`](crate::Solver::Cta) narrows the search by planar problems. Answers do not depend on it.
///
/// The default is the paper's algorithm: from the centre of the levels, or in a tracker from `N(p)`, until the
/// features that touch are seen to solve the problem. A certificate is made of its result by
/// one portal, the face of `M` that the exit test has found.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Options {
    /// Where the minimisation starts, if not in the region of a [`Tracker`](crate::Tracker)'s last
    /// solution.
    pub start: Start,
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

impl Options {
    /// A first guess and rough: from the ellipsoids to a fifth of the extent, from cell to cell. Portal refinement
    /// does nearly all of the work; planar problems are solved only if the ellipsoids pass each other and the
    /// bodies may not.
    pub const ROUGH: Self = Self::new(Start::Ellipsoids, Until::Gap(0.2)).with_keeps_to_cell(false);

    /// From a start to an end, each shift within its cell.
    pub const fn new(start: Start, until: Until) -> Self {
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

impl Default for Options {
    /// The paper: the centre, until the exit test, each shift within its cell.
    fn default() -> Self {
        Self::new(Start::default(), Until::default())
    }
}

/// Where a minimisation starts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
pub enum Start {
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
    pub(crate) fn is_shifted(&self) -> bool {
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

/// A share as it is written, nothing if it is infinite; or `exit`.
#[cfg(feature = "serde")]
#[derive(serde::Serialize, serde::Deserialize)]
#[serde(untagged)]
enum UntilRecord {
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

colltrans_kernel::written::named!("start", Start { Center: "center", Ellipsoids: "ellipsoids" });

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
