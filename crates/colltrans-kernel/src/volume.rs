//! On which side of the plane through three points of `M` the origin is: exact signs of determinants.
//!
//! A rounded determinant decides where its error allows. Coordinates that were computed in twice the usual
//! precision are rounded by `2 u` of themselves and `2^-100` of the size, the determinant by `8 u` of the
//! sum of its terms' magnitudes; whole numbers tell the rest.

use std::cmp::Ordering;

use glam::DVec3;

use super::integer::{Integer, LARGE, SMALL, determinant};
use super::orientation::Terms;

/// Error of a rounded determinant, in its terms' magnitudes, and in the third power of the size.
const ERROR: [f64; 2] = [64.0 * f64::EPSILON, f64::from_bits((1023 - 90) << 52)];

/// Error of the determinant of rounded points, in the third power of the size: three times `9 u` for the points,
/// and `8 u` for itself.
const ROUNDED: f64 = 32.0 * f64::EPSILON;

/// The sign of `det[a, b, c]`: positive if the three are counter-clockwise as seen from beyond their plane,
/// from the origin's other side. `size` is that of the configuration.
#[inline]
pub fn sign(points: [&Terms; 3], size: f64) -> Ordering {
    let [a, b, c] = points.map(Terms::point);
    let det = a.dot(b.cross(c));
    let [relative, absolute] = ERROR;
    if det.abs() > relative * magnitude(a, b, c) + absolute * (size * size * size) {
        return det.total_cmp(&0.0);
    }
    by_integers::<SMALL>(points).or_else(|| by_integers::<LARGE>(points)).unwrap_or(Ordering::Equal)
}

/// The same of points as `TwoBodies::difference` rounds them, off by less than
/// `9 u` of the size each: where that and the determinant's own rounding leave it.
#[inline]
pub fn rounded_sign([a, b, c]: [DVec3; 3], size: f64) -> Option<Ordering> {
    let det = a.dot(b.cross(c));
    (det.abs() > ROUNDED * (size * size * size)).then(|| det.total_cmp(&0.0))
}

/// The sum of the magnitudes of the determinant's terms.
#[inline]
fn magnitude(a: DVec3, b: DVec3, c: DVec3) -> f64 {
    let [a, b, c] = [a, b, c].map(DVec3::abs);
    let minors = DVec3::new(b.y * c.z + b.z * c.y, b.z * c.x + b.x * c.z, b.x * c.y + b.y * c.x);
    a.dot(minors)
}

#[inline(never)]
fn by_integers<const N: usize>(points: [&Terms; 3]) -> Option<Ordering> {
    let [a, b, c] = points.map(Terms::coordinates::<N>);
    determinant(&a, &b, &c).sign()
}

/// The faces of a tetrahedron, each opposite to a corner.
#[inline]
fn faces<'a>([a, b, c, d]: &'a [Terms<'a>; 4]) -> [[&'a Terms<'a>; 3]; 4] {
    [[b, c, d], [a, d, c], [a, b, d], [a, c, b]]
}

/// Whether a tetrahedron with some volume contains the origin, certainly; on its surface does.
#[inline]
pub fn encloses(corners: &[Terms; 4], size: f64) -> bool {
    let signs = faces(corners).map(|face| sign(face, size));
    let none = |unwanted| signs.iter().all(|sign| *sign != unwanted);
    let some = signs.iter().any(|sign| sign.is_ne());
    some && (none(Ordering::Less) || none(Ordering::Greater))
}

/// The weights by which the corners of a tetrahedron with some volume have the origin as their mean, to
/// within a few roundings: the volumes that it spans with the faces, as shares of the whole.
#[inline]
pub fn weights_of_origin(corners: &[Terms; 4]) -> Option<[f64; 4]> {
    shares::<SMALL>(corners).or_else(|| shares::<LARGE>(corners))
}

#[inline(never)]
fn shares<const N: usize>(corners: &[Terms; 4]) -> Option<[f64; 4]> {
    let volumes = faces(corners).map(|face| {
        let [a, b, c] = face.map(Terms::coordinates::<N>);
        determinant(&a, &b, &c)
    });
    let whole = volumes.iter().fold(Integer::ZERO, |sum, volume| sum.add(volume));
    whole.sign().filter(|sign| sign.is_ne())?;
    let [a, b, c, d] = volumes.map(|volume| volume.ratio(&whole));
    Some([a?, b?, c?, d?])
}
