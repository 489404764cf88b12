//! A first guess of the contact normal: what it would be if both bodies were ellipsoids.
//!
//! The line enters the ellipsoid that `M` resembles where a quadratic equation says.

use glam::{DMat2, DMat3, DVec2, DVec3};

use crate::certificate::VertexPair;
use crate::minkowski::Difference;

/// Where to begin, and how the shadow of the support point answers to a change of slope.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Start {
    /// Guess of the contact normal in the shadow frame: `(a, 1)`, or lateral (height 0) if the bodies seem to pass each other.
    pub(crate) normal: DVec3,
    /// A pair near the contact, if one is known.
    pub(crate) near: Option<VertexPair>,
    /// The change of slope that moves the shadow of the support point by minus a given vector: the inverse Hessian of the
    /// ellipsoid's support function.
    pub(crate) slope_per_shadow: DMat2,
}

/// Least share of a contact normal along the direction that is guessed: a steeper guess
/// would say nothing about where the walls of the body are.
const LEAST_INCLINATION: f64 = 0.05;

impl Start {
    /// The guess from the inertia ellipsoids.
    pub(crate) fn from_ellipsoids(difference: &Difference) -> Self {
        let (center, k) = difference.ellipsoid();
        let normal = entry_normal(&k.inverse(), center);
        Self { normal, near: None, slope_per_shadow: inverse_hessian(&k, normal) }
    }

    /// From a normal (shadow frame) and a pair that another solver found.
    pub(crate) fn from_guess(difference: &Difference, normal: DVec3, near: VertexPair) -> Self {
        let (_, k) = difference.ellipsoid();
        let normal = tempered(normal);
        Self { normal, near: Some(near), slope_per_shadow: inverse_hessian(&k, normal) }
    }
}

/// The normal where the axis enters the ellipsoid around `center` with inverse matrix `j`, or, if it misses it,
/// where it passes closest in the ellipsoid's metric.
fn entry_normal(j: &DMat3, center: DVec3) -> DVec3 {
    let jc = *j * center;
    let middle = jc.z / j.z_axis.z;
    let discriminant = middle * middle - (center.dot(jc) - 1.0) / j.z_axis.z;
    let entry = if discriminant > 0.0 { middle - discriminant.sqrt() } else { middle };
    let mut normal = jc - j.z_axis * entry;
    if discriminant <= 0.0 {
        normal.z = 0.0;
        return normal;
    }
    tempered(normal)
}

/// `(a, 1)` along `normal`, or along the nearest direction that is not too steep.
fn tempered(normal: DVec3) -> DVec3 {
    if normal.z == 0.0 {
        return normal;
    }
    let along = normal.z.max(LEAST_INCLINATION * normal.length());
    if along > 0.0 { (normal.truncate() / along).extend(1.0) } else { DVec3::Z }
}

/// The steepest slope that is guessed, along a lateral direction.
pub(super) fn steep(lateral: DVec2) -> DVec2 {
    lateral.normalize_or_zero() / LEAST_INCLINATION
}

/// Inverse of the Hessian of `sqrt(n^T K n)` in the lateral components of `n`.
fn inverse_hessian(k: &DMat3, normal: DVec3) -> DMat2 {
    let n = if normal.z == 0.0 { steep(normal.truncate()).extend(1.0) } else { normal };
    let kn = *k * n;
    let square = n.dot(kn);
    let length = square.sqrt();
    let s: DVec2 = kn.truncate();
    let lateral = DMat2::from_cols(k.x_axis.truncate(), k.y_axis.truncate());
    let hessian = (lateral - DMat2::from_cols(s * s.x, s * s.y) * (1.0 / square)) * (1.0 / length);
    hessian.inverse()
}
