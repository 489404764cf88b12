//! Chooses the view that shows the motion and the contact.
//!
//! Notation: `v` is the unit vector towards the viewer, `d` the direction of motion, `n` the contact normal. The viewer is
//! above the ground.
//!
//! The functions are those of `libm`, so that the choice is the same on all platforms.

use colltrans::glam::DVec3;
use colltrans_picture::View;

use super::solid::Solid;

/// Elevations above the horizon that are tried, in degrees.
const ELEVATIONS: [f64; 6] = [22.0, 12.0, 32.0, 45.0, 58.0, 72.0];
/// Number of azimuths that are tried for each elevation.
const AZIMUTHS: u32 = 72;
/// Number of faces above which the shape of a body does not affect the score.
const MAX_SHAPE_FACES: usize = 1000;

/// Returns the view with the best score. It shows `d` and `n` with little foreshortening and many faces of both bodies.
/// Views in which `n` points away from the viewer are preferred, so that the moving body is in front.
pub(super) fn best_view(bodies: [&Solid; 2], d: DVec3, n: DVec3) -> View {
    let mut best = (f64::NEG_INFINITY, View::new(0.0, 0.0));
    for elevation in ELEVATIONS {
        for step in 0..AZIMUTHS {
            // The first of equal views wins; the order starts at the front right.
            let azimuth = f64::from(step) * 360.0 / f64::from(AZIMUTHS) - 60.0;
            let view = View::new(azimuth.to_radians(), elevation.to_radians());
            let score = score(&view, bodies, d, n)
                - 0.006 * (elevation - ELEVATIONS[0]).abs()
                - 0.02 * (1.0 - libm::cos((azimuth + 60.0).to_radians()));
            if score > best.0 + 1e-9 {
                best = (score, view);
            }
        }
    }
    best.1
}

/// Returns the score of a view; larger is better.
fn score(view: &View, bodies: [&Solid; 2], d: DVec3, n: DVec3) -> f64 {
    // A direction that is nearly perpendicular to the view counts as perpendicular.
    let shown_length = |u: DVec3| view.project(u).length().min(0.96);
    let shapes: f64 = bodies.into_iter().map(|body| shape_score(view, body)).sum();
    let against = (-n.dot(view.toward)).clamp(-0.28, 0.28);
    2.0 * shown_length(d) + 1.5 * shown_length(n) + 0.6 * shapes + 1.2 * against
}

/// Returns how evenly the visible area is distributed over the faces: the entropy of their projected areas, which is 1 if
/// half of the faces are visible with equal areas. Returns 0 for fewer than four faces or more than
/// [`MAX_SHAPE_FACES`], except for flat bodies.
fn shape_score(view: &View, body: &Solid) -> f64 {
    match body.areas.as_slice() {
        // Of a flat body, the cosine between its normal and the view.
        [front, _] => return front.normalize_or_zero().dot(view.toward).abs(),
        areas if areas.len() < 4 || areas.len() > MAX_SHAPE_FACES => return 0.0,
        _ => {}
    }
    let areas: Vec<f64> =
        body.areas.iter().map(|a| a.dot(view.toward)).filter(|&a| a > 0.0).collect();
    let total: f64 = areas.iter().sum();
    let entropy: f64 = areas.iter().map(|a| a / total).map(|p| -p * libm::log(p)).sum();
    entropy / libm::log(body.faces.len() as f64 / 2.0)
}
