//! Polyhedra with which pictures draw rounded bodies.

use std::borrow::Cow;
use std::f64::consts::{PI, TAU};

use colltrans::ConvexPolyhedron;
use glam::DVec3;

/// Number of rings of the ball that is placed at each vertex, including both poles.
const RINGS: u32 = 11;
/// Number of points in a ring.
const RING_POINTS: u32 = 24;
/// Maximum number of vertices of a rounded body that is drawn with its radius.
const MAX_VERTICES: usize = 2000;

/// Returns the body that a picture draws: for a rounded body a polyhedron with vertices on its surface, or the core if
/// that has more than 2,000 vertices. Other bodies are returned unchanged.
pub fn drawn_body(body: &ConvexPolyhedron) -> Cow<'_, ConvexPolyhedron> {
    let radius = body.radius();
    if radius == 0.0 || body.vertices().len() > MAX_VERTICES {
        return Cow::Borrowed(body);
    }
    let ring = |k: u32| {
        let (sine, cosine) = (PI * f64::from(k) / f64::from(RINGS - 1)).sin_cos();
        (0..RING_POINTS).map(move |j| {
            let (y, x) = (TAU * f64::from(j) / f64::from(RING_POINTS)).sin_cos();
            DVec3::new(x * sine, y * sine, cosine) * radius
        })
    };
    let ball: Vec<DVec3> = (0..RINGS).flat_map(ring).collect();
    let points: Vec<DVec3> =
        body.vertices().iter().flat_map(|&v| ball.iter().map(move |&w| v + w)).collect();
    ConvexPolyhedron::from_points(&points).map_or(Cow::Borrowed(body), Cow::Owned)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn drawn_bodies_are_inside_of_rounded_ones_and_nearly_as_large() {
        let cube = ConvexPolyhedron::cuboid(-DVec3::ONE, DVec3::ONE).expect("a cube");
        assert!(matches!(drawn_body(&cube), Cow::Borrowed(_)));
        for core in [ConvexPolyhedron::from_points(&[DVec3::X]).expect("a point"), cube] {
            let body = core.rounded(0.5).expect("a body");
            let drawn = drawn_body(&body);
            assert_eq!(drawn.radius(), 0.0);
            let share = drawn.volume() / body.volume();
            assert!((0.9..1.0).contains(&share), "{share}");
        }
    }
}
