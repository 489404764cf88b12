//! A first guess of the contact normal: what it would be if both bodies were ellipsoids.
//!
//! Notation. `A`, `B` are the matrices of the bodies' inertia ellipsoids and `c` the difference of
//! their centres, all in the shadow frame; `n = (a, 1)`. The difference of the ellipsoids has
//! `f(a) = c.n - sqrt(n^T A n) - sqrt(n^T B n)`, whose maximum is sought: first with both replaced
//! by one ellipsoid `K = (1 + r) A + (1 + 1/r) B`, which contains their sum for any `r > 0` and
//! which the line enters where a quadratic equation says; then by one Newton step on `f`.
//! `r^2 = tr B / tr A` makes the mean size of `K` least; `r^2 = n^T B n / n^T A n` makes it touch
//! the sum along `n`, so `r` is fitted to the normal found until both agree.

use glam::{DMat2, DVec2, DVec3};

use crate::minkowski::{Difference, Symmetric};
use crate::setting::VertexPair;

/// Where to begin, and how the shadow of the support point answers to a change of slope.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Start {
    /// Guess of the contact normal in the shadow frame: `(a, 1)`, or lateral (height 0) if the
    /// bodies seem to pass each other.
    pub(crate) normal: DVec3,
    /// A pair near the contact, if one is known.
    pub(crate) near: Option<VertexPair>,
    /// The change of slope that moves the shadow of the support point by minus a given vector: the
    /// inverse Hessian of the ellipsoids' support functions.
    pub(crate) slope_per_shadow: DMat2,
    /// The matrices of the ellipsoids.
    ellipsoids: [Symmetric; 2],
}

/// Least share of a contact normal along the direction that is guessed: a steeper guess
/// would say nothing about where the walls of the body are.
const LEAST_INCLINATION: f64 = 0.05;

/// Newton's step is taken if it is shorter than this share of the normal; a longer one leaves the
/// region it knows.
const LONGEST_STEP: f64 = 0.5;

/// The first ellipsoid is good enough for bodies of like shape, whose `r` would change by less than this
/// share; flat ones across each other are fitted until it changes by less than the second, or this often.
const LIKE: f64 = 0.5;
const FITTED: f64 = 0.1;
const MAX_FITS: usize = 12;

impl Start {
    /// The guess from the inertia ellipsoids.
    pub(crate) fn from_ellipsoids(difference: &Difference) -> Self {
        let (center, [a, b]) = difference.ellipsoids();
        let mut r =
            difference.setting.fixed.measure().radius / difference.setting.moving.measure().radius;
        let mut normal = DVec3::Z;
        let mut enough = LIKE;
        for _ in 0..MAX_FITS {
            let k = a.combine(1.0 + r, &b, 1.0 + 1.0 / r);
            normal = entry_normal(&k.inverse(), center);
            let fit = (b.square(normal) / a.square(normal)).sqrt();
            if normal.z == 0.0 || (fit / r - 1.0).abs() < enough {
                break;
            }
            (r, enough) = (fit, FITTED);
        }
        let sloped = if normal.z == 0.0 { steep(normal.truncate()).extend(1.0) } else { normal };
        let [(shadow_a, hessian_a), (shadow_b, hessian_b)] = [a, b].map(|k| response(&k, sloped));
        let slope_per_shadow = (hessian_a + hessian_b).inverse();
        if normal.z > 0.0 {
            let step = slope_per_shadow * (center.truncate() - shadow_a - shadow_b);
            if step.length_squared() < LONGEST_STEP * LONGEST_STEP * normal.length_squared() {
                normal += step.extend(0.0);
            }
        }
        Self { normal, near: None, slope_per_shadow, ellipsoids: [a, b] }
    }

    /// Where the ellipsoids have their supporting planes across the normal, in the frames of the
    /// moving and of the fixed body.
    pub(crate) fn touching(&self, difference: &Difference) -> [DVec3; 2] {
        let setting = difference.setting;
        let normal = self.normal;
        let away = |k: &Symmetric| {
            let kn = k.apply(normal);
            difference.axes * (kn * (1.0 / normal.dot(kn).sqrt()))
        };
        let [a, b] = &self.ellipsoids;
        [
            setting.moving.measure().center + setting.moving_normal(away(a)),
            setting.fixed.measure().center - setting.fixed_normal(away(b)),
        ]
    }

    /// With a normal (shadow frame) and a pair that another solver found.
    pub(crate) fn guided(&self, normal: DVec3, near: VertexPair) -> Self {
        Self { normal: tempered(normal), near: Some(near), ..*self }
    }
}

/// The normal where the axis enters the ellipsoid around `center` with inverse matrix `j`, or, if
/// it misses it, where it passes closest in the ellipsoid's metric.
fn entry_normal(j: &Symmetric, center: DVec3) -> DVec3 {
    let jc = j.apply(center);
    let middle = jc.z / j.zz;
    let discriminant = middle * middle - (center.dot(jc) - 1.0) / j.zz;
    let entry = if discriminant > 0.0 { middle - discriminant.sqrt() } else { middle };
    let mut normal = jc - DVec3::new(j.xz, j.yz, j.zz) * entry;
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

/// Where the line meets `M`, from where it met before: the slope that brings the point of contact
/// back to the line.
///
/// Before, P touched along slope `a_P` and Q along `a_Q` (equal then, and turned with the bodies
/// since), at points of contact whose difference has the shadow `s` now. With the Hessians `A`, `B`
/// of the ellipsoids' support functions the shadow at slope `a` is `s - A (a - a_P) - B (a - a_Q)`.
pub(super) fn continued(difference: &Difference, shadow: DVec2, slopes: [DVec2; 2]) -> DVec2 {
    let (_, ellipsoids) = difference.ellipsoids();
    let n = ((slopes[0] + slopes[1]) * 0.5).extend(1.0);
    let [a, b] = ellipsoids.map(|k| response(&k, n).1);
    (a + b).inverse() * (shadow + a * slopes[0] + b * slopes[1])
}

/// Gradient and Hessian of an ellipsoid's support function in the lateral components of a normal.
fn response(k: &Symmetric, normal: DVec3) -> (DVec2, DMat2) {
    let kn = k.apply(normal);
    let inverse_length = 1.0 / normal.dot(kn).sqrt();
    let g = kn.truncate() * inverse_length;
    let lateral = DMat2::from_cols(DVec2::new(k.xx, k.xy), DVec2::new(k.xy, k.yy));
    (g, (lateral - DMat2::from_cols(g * g.x, g * g.y)) * inverse_length)
}
