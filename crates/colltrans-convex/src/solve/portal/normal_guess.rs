//! A first guess of the contact normal: what it would be if both bodies were ellipsoids.
//!
//! Notation. `A`, `B` are the matrices of the bodies' inertia ellipsoids and `c` the difference of
//! their centres, all in the shadow frame; `n = (a, 1)`. The difference of the ellipsoids has
//! `f(a) = c.n - sqrt(n^T A n) - sqrt(n^T B n)`, whose maximum is sought: first with both replaced
//! by one ellipsoid `K = (1 + r) A + (1 + 1/r) B`, which contains their sum for any `r > 0` and
//! which the line enters where a quadratic equation says; then by one Newton step on `f`.
//! `r^2 = tr B / tr A` makes the mean size of `K` least; `r^2 = n^T B n / n^T A n` makes it touch
//! the sum along `n`: where that is the normal found, the line enters both in one point. The height at
//! which it enters `K` is largest there and falls to either side, so this `r` lies beyond the one tried
//! if it is less than what the normal asks for, and before it if it is more: it is bracketed, and
//! approached by secants. Of thin bodies it may be a thousand times the first one, so the secants are
//! those of the logarithm of `r` and of the logarithm of what is asked over what is tried.

use glam::{DMat2, DVec2, DVec3};

use crate::setting::minkowski::MinkowskiDifference;
use crate::setting::{Setting, VertexPair};
use colltrans_kernel::symmetric::Symmetric;

/// Where to begin.
#[derive(Debug, Clone, Copy)]
pub(crate) struct FirstNormal {
    /// Guess of the contact normal in the shadow frame: `(a, 1)`, or lateral (height 0) if the
    /// bodies seem to pass each other.
    pub(crate) normal: DVec3,
    /// A pair near the contact, if one is known.
    pub(crate) near: Option<VertexPair>,
}

/// Least share of a contact normal along the direction that is guessed where bodies seem to meet (thin
/// ones may do so on walls almost along it), and where they seem to pass each other, so that a steeper
/// guess would say nothing about where the walls are.
const LEAST_INCLINATION: f64 = 0.002;
const LEAST_PASSING: f64 = 0.05;

/// Mean semi-axis of an ellipsoid over the root of its trace.
const MEAN_RADIUS: f64 = 0.577_350_269_189_625_8;

/// Newton's step is taken if it is shorter than this share of the normal; a longer one leaves the
/// region it knows.
const LONGEST_STEP: f64 = 0.5;

/// The first ellipsoid is good enough if its `r` would change by less than this share, of bodies that are
/// round or have large faces; others are fitted until it changes by less than that, or this often.
const LIKE: f64 = 0.5;
const FITTED: f64 = 0.1;
const FINELY_FITTED: f64 = 0.01;
const MAX_FITS: usize = 16;

/// In one fit `r` grows or shrinks at most as [`log_ratio`] of this says, fifteenfold; and while its
/// bracket is open and the secant points away, by this many times what is asked (measured).
const LONGEST_FIT: f64 = 1.75;
const HASTE: f64 = 8.0;

/// Bodies with more vertices than this have faces so small that a finer fit pays (measured).
const FINE: usize = 256;

impl FirstNormal {
    /// The guess that suits the bodies.
    #[inline]
    pub(crate) fn new(difference: &MinkowskiDifference) -> Self {
        let setting = difference.setting;
        if setting.moving.is_like_ball() && setting.fixed.is_like_ball() {
            Self::from_spheres(difference)
        } else {
            Self::from_ellipsoids(difference)
        }
    }

    /// The guess for bodies that resemble balls: their inertia ellipsoids replaced by balls of the
    /// same mean size.
    #[inline]
    fn from_spheres(difference: &MinkowskiDifference) -> Self {
        let setting = difference.setting;
        let radius =
            (setting.moving.inertia().radius + setting.fixed.inertia().radius) * MEAN_RADIUS;
        let lateral = difference.center().truncate();
        let square = radius * radius - lateral.length_squared();
        let normal = if square > 0.0 {
            tempered(lateral.extend(square.sqrt()))
        } else if lateral != DVec2::ZERO {
            lateral.extend(0.0)
        } else {
            DVec3::Z
        };
        Self { normal, near: None }
    }

    /// The guess from the inertia ellipsoids.
    #[inline]
    pub(crate) fn from_ellipsoids(difference: &MinkowskiDifference) -> Self {
        let (center, [a, b]) = difference.ellipsoids();
        let mut normal = entered(difference.setting, center, [&a, &b]);
        if normal.z > 0.0 {
            let ((p, hessian_p), (q, hessian_q)) = (response(&a, normal), response(&b, normal));
            let step = (hessian_p + hessian_q).inverse() * (center.truncate() - p - q);
            if step.length_squared() < LONGEST_STEP * LONGEST_STEP * normal.length_squared() {
                normal += step.extend(0.0);
            }
        }
        Self { normal, near: None }
    }

    /// With a normal (shadow frame) and a pair that another solver found.
    pub(crate) fn guided(normal: DVec3, near: VertexPair) -> Self {
        Self { normal: tempered(normal), near: Some(near) }
    }
}

/// The normal where the axis enters the ellipsoid that suits the bodies', or, if it misses it, where it
/// passes closest.
#[inline]
fn entered(setting: &Setting, center: DVec3, [a, b]: [&Symmetric; 2]) -> DVec3 {
    let (moving, fixed) = (setting.moving.inertia(), setting.fixed.inertia());
    let fine = setting.moving.vertices().len().max(setting.fixed.vertices().len()) > FINE;
    let fitted = if fine { FINELY_FITTED } else { FITTED };
    let mut enough = if fine && !(moving.round && fixed.round) { fitted } else { LIKE };
    let mut r = fixed.radius / moving.radius;
    let [mut low, mut high] = [0.0, f64::INFINITY];
    let mut last: Option<[f64; 2]> = None;
    let mut normal = DVec3::Z;
    for _ in 0..MAX_FITS {
        normal = entry_normal(&a.combine(1.0 + r, b, 1.0 + 1.0 / r), center);
        let (along_a, along_b) = (a.square(normal), b.square(normal));
        let [least, most] = [1.0 - enough, 1.0 + enough].map(|f| f * f * r * r * along_a);
        if normal.z == 0.0 || (least < along_b && along_b < most) {
            break;
        }
        enough = fitted;
        let asked = (along_b / along_a).sqrt();
        let ahead = log_ratio(asked, r);
        if !ahead.is_finite() {
            break;
        }
        if ahead > 0.0 {
            low = r;
        } else {
            high = r;
        }
        let is_bracketed = low > 0.0 && high.is_finite();
        let step = match last {
            None => ahead,
            Some([r0, ahead0]) => {
                let secant = ahead * log_ratio(r, r0) / (ahead0 - ahead);
                let is_forward = secant * ahead > 0.0;
                if is_forward || is_bracketed { secant } else { HASTE * ahead }
            }
        };
        last = Some([r, ahead]);
        let step = step.clamp(-LONGEST_FIT, LONGEST_FIT);
        let next = r * (2.0 + step) / (2.0 - step);
        r = if !is_bracketed || (low < next && next < high) { next } else { (low * high).sqrt() };
    }
    normal
}

/// The logarithm of `r / q`, nearly, alike on every machine: `(2 + s) / (2 - s)` undoes it.
#[inline]
fn log_ratio(r: f64, q: f64) -> f64 {
    2.0 * (r - q) / (r + q)
}

/// The normal where the axis enters the ellipsoid around `center` with matrix `k`, or, if it misses
/// it, where it passes closest in the ellipsoid's metric.
///
/// With `J = det K^-1` the axis is inside for the heights `h` with `J_zz h^2 - 2 (J c)_z h + c.J c <
/// det`; up to its length the normal is `J c - h J e_z`.
#[inline]
fn entry_normal(k: &Symmetric, center: DVec3) -> DVec3 {
    let (j, det) = k.adjugate();
    let jc = j.apply(center);
    let square = jc.z * jc.z - j.zz * (center.dot(jc) - det);
    let root = square.max(0.0).sqrt();
    let lateral = jc.truncate() - DVec2::new(j.xz, j.yz) * ((jc.z - root) / j.zz);
    if square > 0.0 {
        return tempered(lateral.extend(root));
    }
    // Of a length fit to be normalised; out of range, any normal will do.
    let lateral = lateral / lateral.abs().max_element();
    if lateral.is_finite() { lateral.extend(0.0) } else { DVec3::Z }
}

/// `(a, 1)` along `normal`, or along the nearest direction that is not too steep.
#[inline]
fn tempered(normal: DVec3) -> DVec3 {
    if normal.z == 0.0 {
        return normal;
    }
    let lateral = normal.truncate();
    let steepest = LEAST_INCLINATION * LEAST_INCLINATION * normal.length_squared();
    let slope = if normal.z > 0.0 && normal.z * normal.z >= steepest {
        lateral * (1.0 / normal.z)
    } else {
        lateral / steepest.sqrt()
    };
    // Out of range, any normal will do.
    if slope.is_finite() { slope.extend(1.0) } else { DVec3::Z }
}

/// The steepest slope that is guessed where bodies seem to pass each other, along a lateral direction.
pub(super) fn steep(lateral: DVec2) -> DVec2 {
    lateral.normalize_or_zero() / LEAST_PASSING
}

/// The change of slope that moves the shadow of the support point by minus a given vector: the inverse
/// Hessian of the ellipsoids' support functions, at a slope.
pub(super) fn slope_per_shadow(difference: &MinkowskiDifference, slope: DVec2) -> DMat2 {
    let normal = slope.extend(1.0);
    let (_, ellipsoids) = difference.ellipsoids();
    let [a, b] = ellipsoids.map(|k| response(&k, normal).1);
    (a + b).inverse()
}

/// Where the line meets `M`, from where it met before: the slope that brings the point of contact
/// back to the line.
///
/// Before, P touched along slope `a_P` and Q along `a_Q` (equal then, and turned with the bodies
/// since), at points of contact whose difference has the shadow `s` now. With the Hessians `A`, `B`
/// of the ellipsoids' support functions the shadow at slope `a` is `s - A (a - a_P) - B (a - a_Q)`.
pub(super) fn continued(
    difference: &MinkowskiDifference,
    shadow: DVec2,
    slopes: [DVec2; 2],
) -> DVec2 {
    let (_, ellipsoids) = difference.ellipsoids();
    let n = ((slopes[0] + slopes[1]) * 0.5).extend(1.0);
    let [a, b] = [response(&ellipsoids[0], n).1, response(&ellipsoids[1], n).1];
    (a + b).inverse() * (shadow + a * slopes[0] + b * slopes[1])
}

/// Gradient and Hessian of an ellipsoid's support function in the lateral components of a normal.
#[inline]
fn response(k: &Symmetric, normal: DVec3) -> (DVec2, DMat2) {
    let kn = k.apply(normal);
    let inverse_length = 1.0 / normal.dot(kn).sqrt();
    let g = kn.truncate() * inverse_length;
    let lateral = DMat2::from_cols(DVec2::new(k.xx, k.xy), DVec2::new(k.xy, k.yy));
    (g, (lateral - DMat2::from_cols(g * g.x, g * g.y)) * inverse_length)
}
