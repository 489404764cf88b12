//! Answers about one body among many.

use super::AmongSteps;
use colltrans_convex::body::ObstacleId;
use colltrans_solid::kinds::{AnyClearance, AnyDistance, AnyNear};

/// The answer of [`Among::nearest`](super::Among::nearest).
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Nearest {
    /// The one whose distance has the least upper bound; of equal ones, of those that overlap the moving
    /// body, say, the one that came first.
    pub obstacle: ObstacleId,
    /// How far it is, and where; its upper bound is one of the least distance of all.
    pub distance: AnyDistance,
    /// No obstacle is nearer; rounded down, and at most the lower bound of the distance.
    pub lower: f64,
    /// Work done.
    pub steps: AmongSteps,
}

/// The answer of [`Among::within`](super::Among::within), in the order in which obstacles came.
#[derive(Debug, Clone, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Nearby {
    /// Those that are closer, each with two points of the bodies.
    pub closer: Vec<(ObstacleId, AnyNear)>,
    /// Those of which rounding cannot tell: the length lies between their bounds.
    pub undecided: Vec<(ObstacleId, AnyDistance)>,
    /// Work done.
    pub steps: AmongSteps,
}

/// The answer of [`Among::clearance`](super::Among::clearance).
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct ClearanceAmong {
    /// No obstacle stops the moving body before, in multiples of the direction: infinite where none ever
    /// does, or the end that was asked for; 0 if it overlaps an obstacle now.
    #[cfg_attr(feature = "serde", serde(with = "colltrans_kernel::written::or_infinite"))]
    pub lower: f64,
    /// What stops it, [`Clearance::Blocked`](colltrans_convex::Clearance::Blocked), or overlaps it, [`Clearance::Overlapping`](colltrans_convex::Clearance::Overlapping): the obstacle whose
    /// upper bound is least; of equal ones, and of those that overlap, the one that came first.
    pub stop: Option<(ObstacleId, AnyClearance)>,
    /// Work done.
    pub steps: AmongSteps,
}

impl ClearanceAmong {
    /// How far the moving body may safely move, past all obstacles, in multiples of the direction: infinite
    /// where nothing stops it, `None` if it overlaps an obstacle now.
    pub fn distance(&self) -> Option<f64> {
        let overlaps = self.stop.is_some_and(|(_, stop)| stop.distance().is_none());
        (!overlaps).then_some(self.lower)
    }
}
