//! The separating plane of a proof about a motion.

use glam::DVec3;

/// A plane between the bodies at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct TimedPlane {
    /// Time of the plane.
    pub time: f64,
    /// Unit normal in the world, from the moving body to the fixed one.
    pub normal: DVec3,
    /// Lower bound of the gap of the plane minus the minimum gap, in world units.
    pub gap: f64,
    /// Whether this plane alone proves all times up to the next one, by the arcs of all vertices. Otherwise both planes
    /// together do.
    pub alone: bool,
}
