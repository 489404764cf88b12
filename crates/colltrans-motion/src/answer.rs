//! When bodies that turn first meet.

use glam::DVec3;

use super::proof::MotionProof;
use colltrans_convex::body::{Features, Pose};

/// When the bodies first meet. Of solids a proof is made when it is asked for: till then it is `()`.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
#[non_exhaustive]
pub enum MotionOutcome<P = MotionProof, C = MotionContact<P>> {
    /// They do, at a time between two bounds.
    Contact(C),
    /// They come nearer to each other than rounding can tell. Proven is that they do not meet before; not
    /// that they meet, and nothing of later times.
    Grazing(C),
    /// They do not: proven of the whole motion.
    Free(MotionFree<P>),
    /// They overlap at time 0.
    Overlapping(C),
    /// The search took its maximum number of steps. Proven is that they do not meet before [`MotionContact::lower`];
    /// whether they do later is open.
    Undecided(C),
}

/// A first contact, or what may be one.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct MotionContact<P = MotionProof> {
    /// Up to this time the bodies do not meet; 0 if they overlap at the start.
    pub lower: f64,
    /// At this time they do; infinite (`null` in JSON) where that is not proven.
    #[cfg_attr(feature = "serde", serde(with = "colltrans_kernel::written::or_infinite"))]
    pub upper: f64,
    /// The poses at the lower bound, to rounding.
    pub poses: [Pose; 2],
    /// The points of both bodies that are nearest to each other then, in the world, rounded; none where the distance
    /// has no answer.
    pub points: Option<[DVec3; 2]>,
    /// Unit normal in the world, from the moving body to the fixed one, at that time.
    pub normal: Option<DVec3>,
    /// What faces each other across it.
    pub features: Option<Features>,
    /// What proves the bounds.
    pub proof: P,
    /// How much work it was.
    pub steps: MotionSteps,
}

/// No contact.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct MotionFree<P = MotionProof> {
    /// What proves it.
    pub proof: P,
    /// How much work it was.
    pub steps: MotionSteps,
}

/// How much work an answer was.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct MotionSteps {
    /// Times at which the bodies were looked at.
    pub looks: u32,
    /// Support points asked for by distances then.
    pub supports: u32,
    /// Of solids, pairs of nodes of both trees, each in an interval of time.
    #[cfg_attr(
        feature = "serde",
        serde(default, skip_serializing_if = "colltrans_kernel::written::is_none")
    )]
    pub nodes: u64,
    /// Of solids, pairs of facets whose distance was looked at on their way.
    #[cfg_attr(
        feature = "serde",
        serde(default, skip_serializing_if = "colltrans_kernel::written::is_none")
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

/// A contact with its proof.
pub trait Proven<P> {
    /// Returns the proof, and how much work it was.
    #[doc(hidden)]
    fn proven(&self) -> (&P, MotionSteps);
}

impl<P> Proven<P> for MotionContact<P> {
    fn proven(&self) -> (&P, MotionSteps) {
        (&self.proof, self.steps)
    }
}

impl<P, C: Proven<P>> MotionOutcome<P, C> {
    fn proven(&self) -> (&P, MotionSteps) {
        match self {
            Self::Contact(of) | Self::Grazing(of) | Self::Overlapping(of) | Self::Undecided(of) => {
                of.proven()
            }
            Self::Free(of) => (&of.proof, of.steps),
        }
    }

    /// What proves it.
    pub fn proof(&self) -> &P {
        self.proven().0
    }

    /// How much work it was.
    pub fn steps(&self) -> MotionSteps {
        self.proven().1
    }
}
