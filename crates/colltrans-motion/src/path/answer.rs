//! Answers about paths of joints.

use glam::DVec3;

use super::super::answer::{HasProof, MotionOutcome, MotionSteps};
use super::mechanism::PathPlace;
use super::proof::PathProof;
use colltrans_convex::body::{Features, Pose};

/// The first contact of two bodies of a mechanism on a path.
///
/// [`MotionOutcome::Undecided`] means that the search between the two bodies of [`PathContact::pair`] took its maximum
/// number of steps. No two bodies of any pair meet before [`PathContact::lower`]. A finite [`PathContact::upper`] is
/// the time at which the two bodies of [`PathProof::meeting`] are proven to meet.
pub type PathOutcome = MotionOutcome<PathProof, PathContact>;

/// A first contact on a path, or a possible one.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct PathContact {
    /// Time up to which no two bodies of any pair meet.
    pub lower: f64,
    /// Time at which the two bodies meet, or those of [`PathProof::meeting`] if the outcome is undecided; infinity
    /// (`null` in JSON) if a contact is not proven.
    #[cfg_attr(
        feature = "serde",
        serde(with = "colltrans_kernel::serialization::null_as_infinity")
    )]
    pub upper: f64,
    /// Place on the path of the lower bound.
    pub place: PathPlace,
    /// Numbers of the two bodies.
    pub pair: [usize; 2],
    /// Poses of the two bodies at this place, rounded.
    pub poses: [Pose; 2],
    /// Nearest points of both bodies at this place, in the world, rounded. `None` if no distance was computed.
    pub points: Option<[DVec3; 2]>,
    /// Unit normal in the world, from the first to the second body. `None` if it has no direction.
    pub normal: Option<DVec3>,
    /// Features of both bodies that face each other across the normal; for convex bodies only.
    pub features: Option<Features>,
    /// Proof of the bounds.
    pub proof: PathProof,
    /// Work of the search.
    pub steps: MotionSteps,
}

impl HasProof<PathProof> for PathContact {
    fn proof_and_steps(&self) -> (&PathProof, MotionSteps) {
        (&self.proof, self.steps)
    }
}

impl PathOutcome {
    /// Returns the proof and the counters of work for changes.
    pub(super) fn proof_and_steps_mut(&mut self) -> (&mut PathProof, &mut MotionSteps) {
        match self {
            Self::Contact(of) | Self::Grazing(of) | Self::Overlapping(of) | Self::Undecided(of) => {
                (&mut of.proof, &mut of.steps)
            }
            Self::Free(of) => (&mut of.proof, &mut of.steps),
        }
    }
}
