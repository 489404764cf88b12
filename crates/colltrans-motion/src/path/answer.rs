//! Answers about paths.

use glam::DVec3;

use super::super::answer::{MotionOutcome, MotionSteps, Proven};
use super::mechanism::Place;
use super::proof::PathProof;
use colltrans_convex::body::{Features, Pose};

/// What the bodies of a mechanism do on a path: which two of them meet first, or that none do, proven of the whole path.
///
/// [`MotionOutcome::Undecided`]: the search between the two bodies of [`PathContact::pair`] took its maximum number of
/// steps. Proven is that no two bodies of all pairs meet before [`PathContact::lower`]; whether these two do later is open.
/// A finite [`PathContact::upper`] is when the two bodies of [`PathProof::meeting`] are proven to meet.
pub type PathOutcome = MotionOutcome<PathProof, PathContact>;

/// A first contact, or what may be one.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct PathContact {
    /// Up to this time no two of the bodies meet.
    pub lower: f64,
    /// At this time these two do; infinite (`null` in JSON) where that is not proven.
    #[cfg_attr(feature = "serde", serde(with = "colltrans_kernel::written::or_infinite"))]
    pub upper: f64,
    /// Where on the path that is.
    pub place: Place,
    /// Which two bodies, by their numbers.
    pub pair: [usize; 2],
    /// Where they are then, to rounding.
    pub poses: [Pose; 2],
    /// The points of both that are nearest to each other then, in the world, rounded; none where the distance has no
    /// answer.
    pub points: Option<[DVec3; 2]>,
    /// Unit normal in the world, from the first to the second.
    pub normal: Option<DVec3>,
    /// What faces each other across it, of bodies that are convex.
    pub features: Option<Features>,
    /// What proves the bounds.
    pub proof: PathProof,
    /// How much work it was.
    pub steps: MotionSteps,
}

impl Proven<PathProof> for PathContact {
    fn proven(&self) -> (&PathProof, MotionSteps) {
        (&self.proof, self.steps)
    }
}

impl PathOutcome {
    pub(super) fn parts_mut(&mut self) -> (&mut PathProof, &mut MotionSteps) {
        match self {
            Self::Contact(of) | Self::Grazing(of) | Self::Overlapping(of) | Self::Undecided(of) => {
                (&mut of.proof, &mut of.steps)
            }
            Self::Free(of) => (&mut of.proof, &mut of.steps),
        }
    }
}
