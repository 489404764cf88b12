//! Side of the origin relative to the plane through three points of `M`: exact signs of determinants.
//!
//! Algorithm. A rounded determinant decides if its error allows, otherwise exact integers.
//! `docs/theory/exact-arithmetic.md` derives the error bounds.

use std::cmp::Ordering;

use glam::DVec3;

use super::integer::{Integer, LARGE_LIMBS, SMALL_LIMBS, determinant};
use super::orientation::PointTerms;

/// Factors of the error bound of a rounded determinant: the first of the sum of the magnitudes of its terms, the
/// second of the third power of the size of the configuration.
const DETERMINANT_ERROR: [f64; 2] = [64.0 * f64::EPSILON, f64::from_bits((1023 - 90) << 52)];

/// Bound on the error of the determinant of rounded points, in multiples of the third power of the size. It is
/// `64 u`, which covers `3 * 9 u` for the points and `8 u` for the determinant.
const ROUNDED_POINT_ERROR: f64 = 32.0 * f64::EPSILON;

/// Returns the exact sign of `det[a, b, c]`. It is positive if the three points are counter-clockwise as seen
/// from the side of their plane opposite to the origin. `size` is the size of the configuration.
#[inline]
pub fn origin_side(points: [&PointTerms; 3], size: f64) -> Ordering {
    let [a, b, c] = points.map(PointTerms::rounded_point);
    let det = a.dot(b.cross(c));
    let [relative, absolute] = DETERMINANT_ERROR;
    if det.abs() > relative * term_magnitude(a, b, c) + absolute * (size * size * size) {
        return det.total_cmp(&0.0);
    }
    sign_by_integers::<SMALL_LIMBS>(points)
        .or_else(|| sign_by_integers::<LARGE_LIMBS>(points))
        .unwrap_or(Ordering::Equal)
}

/// Returns the sign of `det[a, b, c]` for points as `TwoBodies::difference_point` rounds them, with an error below
/// `9 u size` each. `None` if rounding leaves it uncertain.
#[inline]
pub fn rounded_origin_side([a, b, c]: [DVec3; 3], size: f64) -> Option<Ordering> {
    let det = a.dot(b.cross(c));
    (det.abs() > ROUNDED_POINT_ERROR * (size * size * size)).then(|| det.total_cmp(&0.0))
}

/// Returns the sum of the magnitudes of the terms of the determinant.
#[inline]
fn term_magnitude(a: DVec3, b: DVec3, c: DVec3) -> f64 {
    let [a, b, c] = [a, b, c].map(DVec3::abs);
    let minors = DVec3::new(b.y * c.z + b.z * c.y, b.z * c.x + b.x * c.z, b.x * c.y + b.y * c.x);
    a.dot(minors)
}

/// Computes the sign of the determinant with integers of `N` limbs; `None` if a number did not fit.
#[inline(never)]
fn sign_by_integers<const N: usize>(points: [&PointTerms; 3]) -> Option<Ordering> {
    let [a, b, c] = points.map(PointTerms::exact_coordinates::<N>);
    determinant(&a, &b, &c).sign()
}

/// Returns the faces of a tetrahedron, each opposite to the corner of the same index.
#[inline]
fn tetrahedron_faces<'a>([a, b, c, d]: &'a [PointTerms<'a>; 4]) -> [[&'a PointTerms<'a>; 3]; 4] {
    [[b, c, d], [a, d, c], [a, b, d], [a, c, b]]
}

/// Checks exactly whether a tetrahedron contains the origin, in its interior or on its surface. `false` for a
/// tetrahedron without volume.
#[inline]
pub fn contains_origin(corners: &[PointTerms; 4], size: f64) -> bool {
    let signs = tetrahedron_faces(corners).map(|face| origin_side(face, size));
    let none = |unwanted| signs.iter().all(|sign| *sign != unwanted);
    let some = signs.iter().any(|sign| sign.is_ne());
    some && (none(Ordering::Less) || none(Ordering::Greater))
}

/// Computes the barycentric coordinates of the origin in a tetrahedron, with errors of a few roundings: the
/// volumes spanned by the origin and each face, relative to the whole volume. `None` for a tetrahedron
/// without volume.
#[inline]
pub fn weights_of_origin(corners: &[PointTerms; 4]) -> Option<[f64; 4]> {
    weights_by_integers::<SMALL_LIMBS>(corners)
        .or_else(|| weights_by_integers::<LARGE_LIMBS>(corners))
}

/// Computes the barycentric coordinates with integers of `N` limbs; `None` if a number did not fit or the
/// volume is 0.
#[inline(never)]
fn weights_by_integers<const N: usize>(corners: &[PointTerms; 4]) -> Option<[f64; 4]> {
    let volumes = tetrahedron_faces(corners).map(|face| {
        let [a, b, c] = face.map(PointTerms::exact_coordinates::<N>);
        determinant(&a, &b, &c)
    });
    let whole = volumes.iter().fold(Integer::ZERO, |sum, volume| sum.add(volume));
    whole.sign().filter(|sign| sign.is_ne())?;
    let [a, b, c, d] = volumes.map(|volume| volume.ratio(&whole));
    Some([a?, b?, c?, d?])
}
