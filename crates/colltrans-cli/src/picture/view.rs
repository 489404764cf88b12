//! An orthographic view.
//!
//! Notation. `v` is the unit vector towards the viewer. World z points up on the page.

use colltrans::glam::{DVec2, DVec3};

/// An orthographic projection.
#[derive(Debug, Clone, Copy)]
pub(super) struct View {
    right: DVec3,
    up: DVec3,
    /// Unit vector towards the viewer.
    pub(super) toward: DVec3,
}

impl View {
    /// From an azimuth and a height above the horizon, in radians.
    pub(super) fn new(azimuth: f64, elevation: f64) -> Self {
        let (sin_a, cos_a) = libm::sincos(azimuth);
        let (sin_e, cos_e) = libm::sincos(elevation);
        Self {
            right: DVec3::new(-sin_a, cos_a, 0.0),
            up: DVec3::new(-sin_e * cos_a, -sin_e * sin_a, cos_e),
            toward: DVec3::new(cos_e * cos_a, cos_e * sin_a, sin_e),
        }
    }

    /// Right and up on the page.
    pub(super) fn project(&self, p: DVec3) -> DVec2 {
        DVec2::new(self.right.dot(p), self.up.dot(p))
    }
}
