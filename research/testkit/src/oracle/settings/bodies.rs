//! Draws bodies and directions that several families use.

use std::f64::consts::TAU;

use glam::DVec3;

use crate::random::Random;
use crate::shapes::cuboid;

/// Draws random points.
pub(super) fn cloud(rng: &mut Random) -> Vec<DVec3> {
    let n = rng.int(4, 12);
    let axes = DVec3::new(rng.range(0.4, 1.4), rng.range(0.4, 1.4), rng.range(0.4, 1.4));
    if rng.one_in(2) {
        (0..n).map(|_| rng.direction() * axes).collect()
    } else {
        (0..n).map(|_| rng.vector() * axes).collect()
    }
}

/// Draws a box with integer half extents.
pub(super) fn whole_box(rng: &mut Random) -> Vec<DVec3> {
    cuboid(rng.grid(1, 4)).vertices
}

/// Returns an upright prism over a regular polygon. The angle of its first corner is `first_rad`.
pub(super) fn prism(sides: u32, radius: f64, half_height: f64, first_rad: f64) -> Vec<DVec3> {
    let corner = |k: u32| {
        let angle_rad = first_rad + TAU * f64::from(k) / f64::from(sides);
        DVec3::new(radius * angle_rad.cos(), radius * angle_rad.sin(), half_height)
    };
    let mirror = DVec3::new(1.0, 1.0, -1.0);
    (0..sides).flat_map(|k| [corner(k), corner(k) * mirror]).collect()
}

/// Returns an octahedron.
pub(super) fn octahedron(radius: f64) -> Vec<DVec3> {
    DVec3::AXES.into_iter().flat_map(|e| [e * radius, -e * radius]).collect()
}

/// Draws points in the plane z = 0.
pub(super) fn flat_body(rng: &mut Random) -> Vec<DVec3> {
    let (n, whole) = (rng.int(3, 7), rng.one_in(2));
    (0..n)
        .map(|_| {
            let v = if whole { rng.grid(-2, 2) } else { rng.vector() * 2.0 };
            DVec3::new(v.x, v.y, 0.0)
        })
        .collect()
}

/// Draws an axis in either direction.
pub(super) fn axis(rng: &mut Random) -> DVec3 {
    rng.pick(&DVec3::AXES) * rng.pick(&[1.0, -1.0])
}

/// Draws an axis, or any direction.
pub(super) fn axis_or_any(rng: &mut Random) -> DVec3 {
    if rng.one_in(2) { axis(rng) } else { rng.direction() }
}

/// Draws a position that a body meets approximately along a direction.
pub(super) fn ahead(rng: &mut Random, direction: DVec3, distance: f64, miss: f64) -> DVec3 {
    direction * distance + rng.direction().cross(direction) * rng.range(0.0, miss)
}
