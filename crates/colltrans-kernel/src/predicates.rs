//! Exact signs of determinants of given points: the adaptive predicates of the crate `robust`, with the
//! conventions of this project.

use std::cmp::Ordering;

use glam::{DVec2, DVec3};
use robust::{Coord, Coord3D};

/// Returns a positive number if `a b c` turn to the left, a negative number for a right turn, 0 for collinear
/// points. The sign is exact.
#[inline]
pub fn orient2d(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    let coord = |p: DVec2| Coord { x: p.x, y: p.y };
    robust::orient2d(coord(a), coord(b), coord(c))
}

/// Returns a positive number if `p` is above the plane of the counter-clockwise triangle `a b c`, a negative
/// number if it is below, and 0 if it lies on the plane. The sign is exact.
#[inline]
pub fn orient3d(a: DVec3, b: DVec3, c: DVec3, p: DVec3) -> f64 {
    let coord = |v: DVec3| Coord3D { x: v.x, y: v.y, z: v.z };
    -robust::orient3d(coord(a), coord(b), coord(c), coord(p))
}

/// Returns the sign of a number; `Equal` for NaN.
#[inline]
pub fn sign_of(x: f64) -> Ordering {
    x.partial_cmp(&0.0).unwrap_or(Ordering::Equal)
}
