//! Answers about one body among many.

use super::SceneSteps;
use colltrans_convex::body::ObstacleId;
use colltrans_solid::kinds::{AnyClearance, AnyDistance, AnyNear};

/// The answer of [`SceneQuery::nearest`](super::SceneQuery::nearest).
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Nearest {
    /// The obstacle whose distance has the least upper bound. If several are equal, for example if they overlap the
    /// moving body, the one inserted first.
    pub obstacle: ObstacleId,
    /// Distance of this obstacle. Its upper bound is an upper bound of the least distance of all obstacles.
    pub distance: AnyDistance,
    /// Lower bound of the distances of all obstacles, rounded down. It is at most the lower bound of `distance`.
    pub lower: f64,
    /// Work of the query.
    pub steps: SceneSteps,
}

/// The answer of [`SceneQuery::within`](super::SceneQuery::within), in the order of insertion.
#[derive(Debug, Clone, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Nearby {
    /// The obstacles that are closer, each with two near points.
    pub closer: Vec<(ObstacleId, AnyNear)>,
    /// The obstacles that rounding errors cannot decide: the length lies between the bounds of their distance.
    pub undecided: Vec<(ObstacleId, AnyDistance)>,
    /// Work of the query.
    pub steps: SceneSteps,
}

/// The answer of [`SceneQuery::clearance`](super::SceneQuery::clearance).
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct SceneClearance {
    /// Translation before which no obstacle stops the moving body, in multiples of the direction. It is infinity if
    /// none does, or the end of the query, and 0 if the body overlaps an obstacle at the start.
    #[cfg_attr(
        feature = "serde",
        serde(with = "colltrans_kernel::serialization::null_as_infinity")
    )]
    pub lower: f64,
    /// The obstacle that stops the body ([`Clearance::Blocked`](colltrans_convex::Clearance::Blocked)) or overlaps it
    /// ([`Clearance::Overlapping`](colltrans_convex::Clearance::Overlapping)): the one with the least upper bound. If
    /// several are equal or overlap, the one inserted first.
    pub stop: Option<(ObstacleId, AnyClearance)>,
    /// Work of the query.
    pub steps: SceneSteps,
}

impl SceneClearance {
    /// Returns the translation by which the moving body can safely move past all obstacles, in multiples of the
    /// direction. If nothing stops the body, it is infinity, or the end of the query
    /// ([`SceneQuery::clearance_before`](super::SceneQuery::clearance_before)). `None` if the body overlaps an obstacle
    /// at the start.
    pub fn safe_translation(&self) -> Option<f64> {
        let overlaps = self.stop.is_some_and(|(_, stop)| stop.distance().is_none());
        (!overlaps).then_some(self.lower)
    }
}
