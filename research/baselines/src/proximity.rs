//! The answer to a distance query.

use glam::DVec3;

/// Distance and nearest points of two placed bodies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Proximity<Steps> {
    /// Distance of the bodies as closed sets, in world units; 0 if they have a common point.
    pub distance: f64,
    /// A nearest point of the moving body, in the world. If the bodies overlap, a common point up to
    /// rounding, or any point of the moving body if the algorithm finds no common point.
    pub on_moving: DVec3,
    /// A nearest point of the fixed body, in the world.
    pub on_fixed: DVec3,
    /// Work of the query.
    pub steps: Steps,
}
