//! Answers about the first contact of bodies in motion.

use glam::DVec3;

use super::proof::MotionProof;
use colltrans_convex::body::{Features, Pose};

/// The first contact of two bodies in motion. For solids, `P` is `()` unless a proof was requested.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
#[non_exhaustive]
pub enum MotionOutcome<P = MotionProof, C = MotionContact<P>> {
    /// The bodies meet, at a time between two bounds.
    Contact(C),
    /// The bodies are so near that rounding errors hide whether they meet. They do not meet before
    /// [`MotionContact::lower`]. A contact is not proven, and later times are not decided.
    Grazing(C),
    /// The bodies do not meet during the whole motion.
    Free(MotionFree<P>),
    /// The bodies overlap at time 0.
    Overlapping(C),
    /// The search took its maximum number of steps. The bodies do not meet before [`MotionContact::lower`]. Later times
    /// are not decided.
    Undecided(C),
}

/// A first contact, or a possible one.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct MotionContact<P = MotionProof> {
    /// Time up to which the bodies do not meet; 0 if they overlap at the start.
    pub lower: f64,
    /// Time at which the bodies meet; infinity (`null` in JSON) if a contact is not proven.
    #[cfg_attr(
        feature = "serde",
        serde(with = "colltrans_kernel::serialization::null_as_infinity")
    )]
    pub upper: f64,
    /// Poses of both bodies at the lower bound, rounded.
    pub poses: [Pose; 2],
    /// Nearest points of both bodies at the lower bound, in the world, rounded. `None` if no distance was computed.
    pub points: Option<[DVec3; 2]>,
    /// Unit normal at the lower bound, in the world, from the moving body to the fixed one. `None` if no separating
    /// plane was found at this time.
    pub normal: Option<DVec3>,
    /// Features of both bodies that face each other across the normal.
    pub features: Option<Features>,
    /// Proof of the bounds.
    pub proof: P,
    /// Work of the search.
    pub steps: MotionSteps,
}

/// The bodies do not meet.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct MotionFree<P = MotionProof> {
    /// Proof that the bodies do not meet.
    pub proof: P,
    /// Work of the search.
    pub steps: MotionSteps,
}

/// Counters of the work of a query.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct MotionSteps {
    /// Number of distance samples and contact tests.
    pub looks: u32,
    /// Number of support points computed for distances.
    pub supports: u32,
    /// For solids, number of pairs of tree nodes, each with a time interval.
    #[cfg_attr(
        feature = "serde",
        serde(default, skip_serializing_if = "colltrans_kernel::serialization::is_zero_count")
    )]
    pub nodes: u64,
    /// For solids, number of pairs of facets that were sampled.
    #[cfg_attr(
        feature = "serde",
        serde(default, skip_serializing_if = "colltrans_kernel::serialization::is_zero_count")
    )]
    pub leaves: u64,
}

impl std::ops::AddAssign for MotionSteps {
    fn add_assign(&mut self, other: Self) {
        self.looks += other.looks;
        self.supports += other.supports;
        self.nodes += other.nodes;
        self.leaves += other.leaves;
    }
}

/// An answer with a proof.
pub trait HasProof<P> {
    /// Returns the proof and the work of the search.
    #[doc(hidden)]
    fn proof_and_steps(&self) -> (&P, MotionSteps);
}

impl<P> HasProof<P> for MotionContact<P> {
    fn proof_and_steps(&self) -> (&P, MotionSteps) {
        (&self.proof, self.steps)
    }
}

impl<P, C: HasProof<P>> MotionOutcome<P, C> {
    fn proven(&self) -> (&P, MotionSteps) {
        match self {
            Self::Contact(of) | Self::Grazing(of) | Self::Overlapping(of) | Self::Undecided(of) => {
                of.proof_and_steps()
            }
            Self::Free(of) => (&of.proof, of.steps),
        }
    }

    /// Returns the proof of the answer.
    pub fn proof(&self) -> &P {
        self.proven().0
    }

    /// Returns the work of the search.
    pub fn steps(&self) -> MotionSteps {
        self.proven().1
    }
}
