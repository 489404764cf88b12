//! By whom, and with how much work, an answer was found.

/// How the search is narrowed. The answer, its certificate and its accuracy are the same.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
pub enum Solver {
    /// Whichever was measured to be fastest: at present portal refinement, for all bodies.
    #[default]
    Auto,
    /// The collision translation algorithm (the paper, section III): convex minimisation over pairs
    /// of planar sections, from the centre of the levels, or in a [`Tracker`](crate::Tracker) from those around the last
    /// solution, until the features that touch are seen to solve the problem. One portal, the face of `M` over
    /// these, makes the certificate of it; where the exit is not seen, portal refinement finds the face.
    /// [`cta::Options`](crate::cta::Options) is what can be chosen. Bodies of lower dimension
    /// have no sections to speak of: portal refinement does their work alone. A body's first cast
    /// that solves a planar problem makes its sections
    /// ([`ConvexPolyhedron::prepare_sections`](crate::ConvexPolyhedron::prepare_sections)).
    Cta,
    /// Portal refinement from scratch, starting from what the contact of two ellipsoids would be.
    Portal,
}

/// Work done for one answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Steps {
    /// Planar problems solved (minimisation steps of the collision translation algorithm).
    pub planar_problems: u32,
    /// Supporting planes of the Minkowski difference computed (one support point on each body).
    pub supports: u32,
    /// Portals visited; by `FixedRotations` faces of the Minkowski difference.
    pub pivots: u32,
    /// Iterations of the loops inside planar problems: vertices of sections computed, vertices of
    /// the bodies climbed over, halvings in searches.
    pub iterations: u32,
    /// Sides that the region of section levels had at most, which the collision translation algorithm cuts down; 0 if
    /// there was none, and missing as data.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "is_zero_count"))]
    pub region_sides: u32,
    /// What the search began with; as data it is missing where that was nothing but the bodies.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "StartedFrom::is_scratch"))]
    pub started_from: StartedFrom,
}

impl Steps {
    /// Of a cast that exchanged so many corners.
    #[doc(hidden)]
    pub fn of_pivots(pivots: u32, started_from: StartedFrom) -> Self {
        Self { pivots, started_from, ..Self::default() }
    }

    #[cfg(feature = "serde")]
    pub(crate) fn is_zero(&self) -> bool {
        *self == Self::default()
    }
}

/// Counts another cast in; of both starts the one with more work stands, of both regions that with more sides.
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

/// What the search for an answer began with, from the least work to the most.
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
    /// Nothing but the bodies.
    #[default]
    Scratch,
}

colltrans_kernel::written::named!("solver", Solver { Auto: "auto", Cta: "cta", Portal: "portal" });

colltrans_kernel::written::named!(
    "start",
    StartedFrom {
        Difference: "difference",
        Features: "features",
        Region: "region",
        Scratch: "scratch"
    }
);

#[cfg(feature = "serde")]
#[expect(clippy::trivially_copy_pass_by_ref, reason = "what serde calls")]
fn is_zero_count(count: &u32) -> bool {
    *count == 0
}

#[cfg(feature = "serde")]
impl StartedFrom {
    #[expect(clippy::trivially_copy_pass_by_ref, reason = "what serde calls")]
    fn is_scratch(&self) -> bool {
        *self == Self::Scratch
    }
}
