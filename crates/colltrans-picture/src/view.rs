//! An orthographic projection.
//!
//! Notation. `v` is the unit vector towards the viewer.

use glam::{DVec2, DVec3};

/// An orthographic projection.
#[derive(Debug, Clone, Copy)]
pub struct View {
    right: DVec3,
    up: DVec3,
    /// The unit vector towards the viewer.
    pub toward: DVec3,
}

impl View {
    /// Builds a view from an azimuth and an elevation above the horizon, in radians. World z points up on the
    /// page.
    pub fn new(azimuth: f64, elevation: f64) -> Self {
        let (sin_a, cos_a) = libm::sincos(azimuth);
        let (sin_e, cos_e) = libm::sincos(elevation);
        Self {
            right: DVec3::new(-sin_a, cos_a, 0.0),
            up: DVec3::new(-sin_e * cos_a, -sin_e * sin_a, cos_e),
            toward: DVec3::new(cos_e * cos_a, cos_e * sin_a, sin_e),
        }
    }

    /// Builds a view from a direction towards the viewer and the upward direction, which must not be parallel.
    pub fn looking_along(toward: DVec3, up: DVec3) -> Self {
        let toward = toward.normalize();
        let right = up.cross(toward).normalize();
        Self { right, up: toward.cross(right), toward }
    }

    /// Returns the brightness of a face with this normal, from 0 to 1. The light comes from the upper left, in
    /// front of the page.
    pub fn brightness(&self, normal: DVec3) -> f64 {
        let on_page = self.project(normal);
        let light = DVec3::new(-0.45, 0.65, 0.61);
        let lit = light.dot(DVec3::new(on_page.x, on_page.y, normal.dot(self.toward)));
        (0.22 + 0.78 * lit).clamp(0.0, 1.0)
    }

    /// Returns the coordinates on the page, to the right and upwards.
    pub fn project(&self, p: DVec3) -> DVec2 {
        DVec2::new(self.right.dot(p), self.up.dot(p))
    }
}
