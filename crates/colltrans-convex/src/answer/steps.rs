//! The solver and the work of an answer.

/// How the search is narrowed. The accuracy of the answer does not depend on this choice. The normal, the features and
/// the certificate may depend on it where they are not unique, for example if vertices or parallel edges meet.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
pub enum Solver {
    /// The solver that was fastest in measurements: at present portal refinement, for all bodies.
    #[default]
    Auto,
    /// The collision translation algorithm (the paper, section III): convex minimisation over pairs of planar
    /// sections.
    ///
    /// The search starts at the central section levels, or in a [`Tracker`](crate::Tracker) at the levels
    /// around the last solution. It ends when the touching features are shown to solve the problem. The face
    /// of `M` over these features is the portal of the certificate. If this exit test fails, portal
    /// refinement finds the face. [`cta::Options`](crate::cta::Options) configures the algorithm.
    ///
    /// Bodies of lower dimension are solved by portal refinement alone, because their sections are
    /// degenerate. A body's first cast that solves a planar problem builds its sections
    /// ([`ConvexPolyhedron::prepare_sections`](crate::ConvexPolyhedron::prepare_sections)).
    Cta,
    /// Minkowski portal refinement (Snethen 2008) along the line of the cast, with exact decisions. In a
    /// [`Tracker`](crate::Tracker) it can start from the last answer. Otherwise it starts from a pair of large
    /// opposed faces if this pair gives the answer, else from a guess of the contact normal.
    Portal,
}

/// Work done for one answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Steps {
    /// Number of planar problems solved (minimisation steps of the collision translation algorithm).
    pub planar_problems: u32,
    /// Number of supporting planes of the Minkowski difference computed (one support point on each body).
    pub supports: u32,
    /// Number of portals visited; for `FixedRotations`, the number of faces of the Minkowski difference.
    pub pivots: u32,
    /// Number of iterations inside planar problems: section vertices computed, body vertices climbed over,
    /// and bisection steps.
    pub iterations: u32,
    /// Maximum number of sides of the region of section levels, which the collision translation algorithm
    /// cuts down. It is 0 if there was no region, and is then omitted in serialised data.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "is_zero_count"))]
    pub region_sides: u32,
    /// Start of the search. [`StartedFrom::Scratch`] is omitted in serialised data.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "StartedFrom::is_scratch"))]
    pub started_from: StartedFrom,
}

impl Steps {
    /// Builds the work of a cast that made `pivots` exchanges and nothing else.
    #[doc(hidden)]
    pub fn from_pivots(pivots: u32, started_from: StartedFrom) -> Self {
        Self { pivots, started_from, ..Self::default() }
    }

    /// Checks whether no work was counted.
    #[cfg(feature = "serde")]
    pub(crate) fn is_zero(&self) -> bool {
        *self == Self::default()
    }
}

/// Adds the work of another cast. `started_from` and `region_sides` become the larger of both values.
impl std::ops::AddAssign for Steps {
    fn add_assign(&mut self, other: Self) {
        self.planar_problems += other.planar_problems;
        self.supports += other.supports;
        self.pivots += other.pivots;
        self.iterations += other.iterations;
        self.region_sides = self.region_sides.max(other.region_sides);
        self.started_from = self.started_from.max(other.started_from);
    }
}

/// Start of a search, ordered from the least to the most work.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
pub enum StartedFrom {
    /// The faces of the Minkowski difference (`FixedRotations` only).
    Difference,
    /// The last answer's contact features or separating direction ([`Tracker`](crate::Tracker)
    /// only).
    Features,
    /// The region around the last answer ([`Tracker`](crate::Tracker) only).
    Region,
    /// Only the bodies.
    #[default]
    Scratch,
}

colltrans_kernel::serialization::named!(
    "solver",
    Solver { Auto: "auto", Cta: "cta", Portal: "portal" }
);

colltrans_kernel::serialization::named!(
    "start",
    StartedFrom {
        Difference: "difference",
        Features: "features",
        Region: "region",
        Scratch: "scratch"
    }
);

#[cfg(feature = "serde")]
#[expect(clippy::trivially_copy_pass_by_ref, reason = "signature required by serde")]
fn is_zero_count(count: &u32) -> bool {
    *count == 0
}

#[cfg(feature = "serde")]
impl StartedFrom {
    #[expect(clippy::trivially_copy_pass_by_ref, reason = "signature required by serde")]
    fn is_scratch(&self) -> bool {
        *self == Self::Scratch
    }
}
