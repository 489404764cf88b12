//! Options of the collision translation algorithm.

/// Start and end of the minimisation with which [`Solver::Cta`](crate::Solver::Cta) narrows the search. Answers
/// do not depend on them.
///
/// The default is the algorithm of the paper. It starts at the centre of the levels, or in a tracker in the
/// neighbourhood `N(p)` of the last solution. It ends when the exit test proves that the touching features
/// solve the problem. Portal refinement certifies the result from one portal, the face of `M` that the exit
/// test has found.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Options {
    /// Start of the minimisation, unless a [`Tracker`](crate::Tracker) starts it at its last solution.
    pub start: Start,
    /// End of the minimisation; portal refinement continues from there.
    pub until: Until,
    /// Whether a cell shift ends in its cell. If it does, planar problems are the paper's steps. If not, a
    /// shift continues into neighbouring cells where little of the region is left, and in `N(p)` planar problems
    /// are first solved where their answers predict the solution. This takes fewer planar problems and less time.
    pub keeps_to_cell: bool,
    /// Value of `phi` at which the region of levels is cut.
    pub cuts: Cuts,
    /// Whether each planar problem is searched without a hint, as in the paper (its section V-F states the
    /// cost). If not, the search starts at the edges of the preceding answer, also that of the last query.
    pub starts_cold: bool,
}

impl Options {
    /// Rough guess: starts at the ellipsoids, ends at a gap of a fifth of the extent, and shifts from cell to
    /// cell. Portal refinement does nearly all of the work. Planar problems are solved only if the ellipsoids
    /// miss each other and the bodies may not.
    pub const ROUGH: Self = Self::new(Start::Ellipsoids, Until::Gap(0.2)).with_keeps_to_cell(false);

    /// Creates options with a start and an end. Shifts end in their cells.
    pub const fn new(start: Start, until: Until) -> Self {
        Self { start, until, keeps_to_cell: true, cuts: Cuts::Shifted, starts_cold: false }
    }

    /// Sets whether cell shifts end in their cells.
    #[must_use]
    pub const fn with_keeps_to_cell(self, keeps_to_cell: bool) -> Self {
        Self { keeps_to_cell, ..self }
    }

    /// Sets the value of `phi` at which the region is cut.
    #[must_use]
    pub const fn with_cuts(self, cuts: Cuts) -> Self {
        Self { cuts, ..self }
    }

    /// Sets whether planar problems are searched without a hint.
    #[must_use]
    pub const fn with_starts_cold(self, starts_cold: bool) -> Self {
        Self { starts_cold, ..self }
    }
}

impl Default for Options {
    /// Returns the options of the paper: the centre, until the exit test, each shift within its cell.
    fn default() -> Self {
        Self::new(Start::default(), Until::default())
    }
}

/// Start of a minimisation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
pub enum Start {
    /// The centre of all section levels (the paper, section III-A).
    #[default]
    Center,
    /// The contact of the bodies' inertia ellipsoids. Portal refinement starts there. Planar problems are
    /// solved only if the ellipsoids miss each other and the bodies may not.
    Ellipsoids,
    /// The neighbourhood `N(p)` of a guessed solution `p` (the paper, line 2 of figure 7, without an earlier
    /// query). `p` is the contact that the bodies' outlines predict, or a face and the vertex opposite it, or it comes
    /// from a few support points. `delta` is the lateral distance of these points. Without a guess, because the
    /// bodies seem to miss each other, the centre.
    Guess,
}

/// Value of `phi` at which a minimisation cuts the region of levels.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
pub enum Cuts {
    /// The least value found, after the shift to the best point of the cell (the paper, line 5).
    #[default]
    Shifted,
    /// The value at the levels of the planar problem, as in the earlier method (reference \[3\] of the paper),
    /// which has no cells. It takes more steps; for comparison only.
    Centroid,
}

#[cfg(feature = "serde")]
impl Cuts {
    /// Checks for the default.
    #[expect(clippy::trivially_copy_pass_by_ref, reason = "serde passes a reference")]
    pub(crate) fn is_shifted(&self) -> bool {
        *self == Self::Shifted
    }
}

/// End of a minimisation. Its text is `exit`, or a number.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(into = "UntilRecord", try_from = "UntilRecord"))]
pub enum Until {
    /// The exit test proves that the touching features solve the problem (the paper, line 6), or rounding hides
    /// the remainder.
    #[default]
    Exit,
    /// As [`Self::Exit`], or earlier: the upper and the lower bound differ by at most this share of the bodies'
    /// extent along the direction.
    Gap(f64),
}

impl Until {
    /// Least share. It is smaller than the differences between the best features of large bodies, and larger
    /// than the rounding error of `phi`.
    const ROUNDING: f64 = 1e-9;

    /// Returns the share at which the minimisation ends at the latest.
    pub(crate) fn gap(self) -> f64 {
        match self {
            Self::Exit => Self::ROUNDING,
            Self::Gap(gap) => gap.max(Self::ROUNDING),
        }
    }
}

/// The neighbourhood `N(p)` of the last solution `p`: a square in the plane of the two section levels. The
/// minimisation is confined to it until the cuts exclude it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
pub enum Region {
    /// All levels: no focus.
    Everywhere,
    /// Half-side from the change since the last query: the lateral distance by which the last contact points
    /// have moved apart. All levels if this is a large part of the bodies, or if the bodies have rotated far
    /// relative to each other.
    #[default]
    Automatic,
    /// This half-side `delta`, in world units along the section axes.
    Fixed(f64),
}

/// Serialised [`Until`]: a share, `null` if it is infinite, or the name `exit`.
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
    type Error = InvalidUntil;

    fn try_from(record: UntilRecord) -> Result<Self, Self::Error> {
        match record {
            UntilRecord::Share(gap) => Ok(Self::Gap(gap.unwrap_or(f64::INFINITY))),
            UntilRecord::Name(name) => name.parse(),
        }
    }
}

colltrans_kernel::serialization::named!("cut", Cuts { Shifted: "shifted", Centroid: "centroid" });
colltrans_kernel::serialization::named!(
    "start",
    Start { Center: "center", Ellipsoids: "ellipsoids", Guess: "guess" }
);

/// Error for a text that is not a valid [`Until`].
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("invalid end {text:?}; accepted: `exit`, or a number that is not negative")]
pub struct InvalidUntil {
    /// The rejected text.
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
    type Err = InvalidUntil;

    fn from_str(text: &str) -> Result<Self, InvalidUntil> {
        if text == "exit" {
            return Ok(Self::Exit);
        }
        let gap = text.parse().ok().filter(|gap: &f64| *gap >= 0.0);
        gap.map(Self::Gap).ok_or_else(|| InvalidUntil { text: text.into() })
    }
}
