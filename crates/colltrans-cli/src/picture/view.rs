//! Where to look from: an orthographic view that shows the motion and the contact.
//!
//! Notation. `v` is the unit vector towards the viewer, `d` the direction of motion, `n` the
//! contact normal. World z points up on the page; the viewer stands above the ground.

use colltrans::glam::{DVec2, DVec3};

use super::solid::Solid;

/// An orthographic projection.
#[derive(Debug, Clone, Copy)]
pub(super) struct View {
    right: DVec3,
    up: DVec3,
    /// Unit vector towards the viewer.
    pub(super) toward: DVec3,
}

/// Heights above the horizon that are tried, in degrees.
const ELEVATIONS: [f64; 6] = [22.0, 12.0, 32.0, 45.0, 58.0, 72.0];
const AZIMUTHS: u32 = 72;
/// Bodies with more faces look alike from everywhere.
const MANY_FACES: usize = 1000;

impl View {
    fn new(azimuth: f64, elevation: f64) -> Self {
        let (sin_a, cos_a) = azimuth.sin_cos();
        let (sin_e, cos_e) = elevation.sin_cos();
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

    /// The view that shows `d` and `n` at length and much of the shapes of both bodies, if
    /// possible from the side that `n` comes from.
    pub(super) fn choose(bodies: [&Solid; 2], d: DVec3, n: DVec3) -> Self {
        let mut best = (f64::NEG_INFINITY, Self::new(0.0, 0.0));
        for elevation in ELEVATIONS {
            for step in 0..AZIMUTHS {
                // Starting from the front right makes that the choice among equals.
                let azimuth = f64::from(step) * 360.0 / f64::from(AZIMUTHS) - 60.0;
                let view = Self::new(azimuth.to_radians(), elevation.to_radians());
                let score = view.score(bodies, d, n)
                    - 0.006 * (elevation - ELEVATIONS[0]).abs()
                    - 0.02 * (1.0 - (azimuth + 60.0).to_radians().cos());
                if score > best.0 + 1e-9 {
                    best = (score, view);
                }
            }
        }
        best.1
    }

    fn score(&self, bodies: [&Solid; 2], d: DVec3, n: DVec3) -> f64 {
        // Nearly sideways is as good as sideways.
        let seen = |u: DVec3| self.project(u).length().min(0.96);
        let shapes: f64 = bodies.into_iter().map(|body| self.shape_seen(body)).sum();
        let against = (-n.dot(self.toward)).clamp(-0.28, 0.28);
        2.0 * seen(d) + 1.5 * seen(n) + 0.6 * shapes + 1.2 * against
    }

    /// How evenly the visible area is spread over the faces: the entropy of their projected
    /// areas, 1 if all of one half are seen alike.
    fn shape_seen(&self, body: &Solid) -> f64 {
        match body.areas.as_slice() {
            // A flat body: how little it is foreshortened.
            [front, _] => return front.normalize_or_zero().dot(self.toward).abs(),
            areas if areas.len() < 4 || areas.len() > MANY_FACES => return 0.0,
            _ => {}
        }
        let areas: Vec<f64> =
            body.areas.iter().map(|a| a.dot(self.toward)).filter(|&a| a > 0.0).collect();
        let total: f64 = areas.iter().sum();
        let entropy: f64 = areas.iter().map(|a| a / total).map(|p| -p * p.ln()).sum();
        entropy / (body.faces.len() as f64 / 2.0).ln()
    }
}
