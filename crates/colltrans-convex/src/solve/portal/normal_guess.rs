//! First guess of the contact normal: the normal if both bodies were ellipsoids.
//!
//! Notation in the shadow frame: `A`, `B` are the matrices of the inertia ellipsoids, `c` is the difference of their
//! centres, and `n = (a, 1)`. For the difference of the ellipsoids the guess maximises
//! `f(a) = c.n - sqrt(n^T A n) - sqrt(n^T B n)`:
//! 1. One ellipsoid `K = (1 + r) A + (1 + 1/r) B` replaces both, and a quadratic equation yields the normal where the
//!    line enters it. A secant method fits `r`.
//! 2. One Newton step on `f` follows.
//!
//! `docs/theory/normal-guesses.md` derives the choice of `r`.

use glam::{DMat2, DVec2, DVec3};

use crate::setting::minkowski::MinkowskiDifference;
use crate::setting::{Setting, VertexPair};
use colltrans_kernel::symmetric::Symmetric;

/// Guess from which portal refinement starts.
#[derive(Debug, Clone, Copy)]
pub(crate) struct NormalGuess {
    /// Guess of the contact normal in the shadow frame: `(a, 1)`, or lateral (height 0) if the bodies
    /// seem to miss each other.
    pub(crate) normal: DVec3,
    /// Vertex pair near the contact, if one is known.
    pub(crate) near: Option<VertexPair>,
}

/// Minimum cosine between the guess and the direction if bodies seem to meet. It is small, because thin bodies may meet
/// at faces that are nearly parallel to the direction.
const MIN_COSINE: f64 = 0.002;
/// Minimum cosine between the guess and the direction if bodies seem to miss each other. A guess with a smaller cosine
/// carries no information about the position of faces that are nearly parallel to the direction.
const MIN_COSINE_IF_MISSED: f64 = 0.05;

/// Mean semi-axis of an ellipsoid, divided by the square root of its trace.
const MEAN_RADIUS: f64 = 0.577_350_269_189_625_8;

/// Maximum length of the Newton step, relative to the normal. A longer step leaves the region in which
/// the quadratic model holds.
const MAX_NEWTON_STEP: f64 = 0.5;

/// Maximum relative change of `r` at which the first ellipsoid is accepted, unless the bodies have many
/// vertices and one of them is not round.
const FIRST_FIT: f64 = 0.5;
/// Maximum relative change of `r` at which a later ellipsoid is accepted.
const FITTED: f64 = 0.1;
/// The value of `FITTED` for bodies with many vertices.
const FINELY_FITTED: f64 = 0.01;
/// Maximum number of ellipsoids.
const MAX_FITS: usize = 16;

/// Maximum change of `r` in one fit, in terms of [`log_ratio`]: a factor of 15.
const MAX_FIT_STEP: f64 = 1.75;
/// Multiple of the change wanted that replaces the secant step, while the bracket is open and the
/// secant points away (measured).
const OPEN_BRACKET_STEP: f64 = 8.0;

/// Number of vertices above which faces are so small that a finer fit pays (measured).
const MANY_VERTICES: usize = 256;

impl NormalGuess {
    /// Returns the guess that suits the bodies: from balls if both resemble balls, else from ellipsoids.
    #[inline]
    pub(crate) fn new(difference: &MinkowskiDifference) -> Self {
        let setting = difference.setting;
        if setting.moving.is_like_ball() && setting.fixed.is_like_ball() {
            Self::from_spheres(difference)
        } else {
            Self::from_ellipsoids(difference)
        }
    }

    /// Returns the guess for bodies that resemble balls. Balls of the same mean size replace their
    /// inertia ellipsoids.
    #[inline]
    fn from_spheres(difference: &MinkowskiDifference) -> Self {
        let setting = difference.setting;
        let radius =
            (setting.moving.inertia().radius + setting.fixed.inertia().radius) * MEAN_RADIUS;
        let lateral = difference.center_difference().truncate();
        let square = radius * radius - lateral.length_squared();
        let normal = if square > 0.0 {
            with_limited_slope(lateral.extend(square.sqrt()))
        } else if lateral != DVec2::ZERO {
            lateral.extend(0.0)
        } else {
            DVec3::Z
        };
        Self { normal, near: None }
    }

    /// Returns the guess from the inertia ellipsoids.
    #[inline]
    pub(crate) fn from_ellipsoids(difference: &MinkowskiDifference) -> Self {
        Self::with_curvatures(difference).0
    }

    /// Returns the guess from the inertia ellipsoids, and the Hessians of their support functions near it, in the
    /// lateral components of a normal. These are zero for a lateral guess.
    #[inline]
    pub(crate) fn with_curvatures(difference: &MinkowskiDifference) -> (Self, [DMat2; 2]) {
        let (center, [a, b]) = difference.inertia_ellipsoids();
        let normal = fitted_entry_normal(difference.setting, center, [&a, &b]);
        Self::after_newton_step(normal, center, [&a, &b])
    }

    /// Returns the guess at the other end of the line: where the line leaves an ellipsoid that it enters with the
    /// normal `other`. `other` points against the direction. Curvatures as in [`Self::with_curvatures`].
    pub(crate) fn opposite_with_curvatures(
        difference: &MinkowskiDifference,
        other: DVec3,
    ) -> (Self, [DMat2; 2]) {
        let setting = difference.setting;
        let (center, [a, b]) = difference.inertia_ellipsoids();
        let r = setting.fixed.inertia().radius / setting.moving.inertia().radius;
        let (j, _) = a.linear_combination(1.0 + r, &b, 1.0 + 1.0 / r).adjugate();
        // Normals at both ends differ by a multiple of the direction, mapped by the inverse of the matrix.
        let normal = other - DVec3::new(j.xz, j.yz, j.zz) * (2.0 * other.z / j.zz);
        Self::after_newton_step(with_limited_slope(normal), center, [&a, &b])
    }

    /// Returns the guess after a Newton step on `f`, if the step is short, and the Hessians before this step.
    #[inline]
    fn after_newton_step(
        mut normal: DVec3,
        center: DVec3,
        [a, b]: [&Symmetric; 2],
    ) -> (Self, [DMat2; 2]) {
        let mut curvatures = [DMat2::ZERO; 2];
        if normal.z > 0.0 {
            let ((p, hessian_p), (q, hessian_q)) =
                (support_derivatives(a, normal), support_derivatives(b, normal));
            let step = (hessian_p + hessian_q).inverse() * (center.truncate() - p - q);
            if step.length_squared() < MAX_NEWTON_STEP * MAX_NEWTON_STEP * normal.length_squared() {
                normal += step.extend(0.0);
            }
            curvatures = [hessian_p, hessian_q];
        }
        (Self { normal, near: None }, curvatures)
    }

    /// Builds a guess from a normal (shadow frame) and a vertex pair that another solver has found.
    pub(crate) fn from_solver(normal: DVec3, near: VertexPair) -> Self {
        Self { normal: with_limited_slope(normal), near: Some(near) }
    }
}

/// Returns the normal where the line enters the fitted ellipsoid `K`. If the line misses `K`, returns the
/// lateral normal where it passes nearest.
#[inline]
fn fitted_entry_normal(setting: &Setting, center: DVec3, [a, b]: [&Symmetric; 2]) -> DVec3 {
    let (moving, fixed) = (setting.moving.inertia(), setting.fixed.inertia());
    let fine = setting.moving.vertices().len().max(setting.fixed.vertices().len()) > MANY_VERTICES;
    let fitted = if fine { FINELY_FITTED } else { FITTED };
    let mut enough = if fine && !(moving.is_round && fixed.is_round) { fitted } else { FIRST_FIT };
    let mut r = fixed.radius / moving.radius;
    let [mut low, mut high] = [0.0, f64::INFINITY];
    let mut last: Option<[f64; 2]> = None;
    let mut normal = DVec3::Z;
    for _ in 0..MAX_FITS {
        normal = entry_normal(&a.linear_combination(1.0 + r, b, 1.0 + 1.0 / r), center);
        let (along_a, along_b) = (a.quadratic_form(normal), b.quadratic_form(normal));
        let [least, most] = [1.0 - enough, 1.0 + enough].map(|f| f * f * r * r * along_a);
        if normal.z == 0.0 || (least < along_b && along_b < most) {
            break;
        }
        enough = fitted;
        let wanted = (along_b / along_a).sqrt();
        let ahead = log_ratio(wanted, r);
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
                if is_forward || is_bracketed { secant } else { OPEN_BRACKET_STEP * ahead }
            }
        };
        last = Some([r, ahead]);
        let step = step.clamp(-MAX_FIT_STEP, MAX_FIT_STEP);
        let next = r * (2.0 + step) / (2.0 - step);
        r = if !is_bracketed || (low < next && next < high) { next } else { (low * high).sqrt() };
    }
    normal
}

/// Approximates the logarithm of `r / q`, with the same bits on every machine. `(2 + s) / (2 - s)` is
/// the inverse.
#[inline]
fn log_ratio(r: f64, q: f64) -> f64 {
    2.0 * (r - q) / (r + q)
}

/// Returns the normal where the line enters the ellipsoid around `center` with matrix `k`. If the line
/// misses it, returns the normal where it passes nearest in the metric of the ellipsoid.
///
/// Let `det` be the determinant of `k` and `J = det k^-1` its adjugate. The line is inside for the heights `h` with
/// `J_zz h^2 - 2 (J c)_z h + c.J c < det`. The normal is parallel to `J c - h J e_z`.
#[inline]
fn entry_normal(k: &Symmetric, center: DVec3) -> DVec3 {
    let (j, det) = k.adjugate();
    let jc = j.times_vector(center);
    let square = jc.z * jc.z - j.zz * (center.dot(jc) - det);
    let root = square.max(0.0).sqrt();
    let lateral = jc.truncate() - DVec2::new(j.xz, j.yz) * ((jc.z - root) / j.zz);
    if square > 0.0 {
        return with_limited_slope(lateral.extend(root));
    }
    // Scaled to a length that can be normalised. If that is out of range, any normal will do.
    let lateral = lateral / lateral.abs().max_element();
    if lateral.is_finite() { lateral.extend(0.0) } else { DVec3::Z }
}

/// Returns `(a, 1)` parallel to `normal`. If `normal` points downwards or its cosine with the direction is below
/// `MIN_COSINE`, returns `(a, 1)` with `a` along its lateral part and a cosine of about `MIN_COSINE`. Returns a lateral
/// normal unchanged.
#[inline]
fn with_limited_slope(normal: DVec3) -> DVec3 {
    if normal.z == 0.0 {
        return normal;
    }
    let lateral = normal.truncate();
    let steepest = MIN_COSINE * MIN_COSINE * normal.length_squared();
    let slope = if normal.z > 0.0 && normal.z * normal.z >= steepest {
        lateral * (1.0 / normal.z)
    } else {
        lateral / steepest.sqrt()
    };
    // Out of range, any normal will do.
    if slope.is_finite() { slope.extend(1.0) } else { DVec3::Z }
}

/// Returns the steepest slope along a lateral direction that is guessed if bodies seem to miss each
/// other.
pub(super) fn steepest_slope(lateral: DVec2) -> DVec2 {
    lateral.normalize_or_zero() / MIN_COSINE_IF_MISSED
}

/// Returns the change of slope that moves the shadow of the support point by minus a given vector: the
/// inverse Hessian of the ellipsoids' support functions at `slope`.
pub(super) fn slope_per_shadow(difference: &MinkowskiDifference, slope: DVec2) -> DMat2 {
    let normal = slope.extend(1.0);
    let (_, ellipsoids) = difference.inertia_ellipsoids();
    let [a, b] = ellipsoids.map(|k| support_derivatives(&k, normal).1);
    (a + b).inverse()
}

/// Predicts the slope of a contact from that of an earlier one: the slope that returns the contact point
/// to the line.
///
/// Earlier, `P` touched along slope `a_P` and `Q` along `a_Q`. These were equal, and have rotated with
/// the bodies since. The shadow of the difference of their contact points is `s` now. With the
/// Hessians `A`, `B` of the ellipsoids' support functions, the shadow at slope `a` is
/// `s - A (a - a_P) - B (a - a_Q)`.
pub(super) fn predicted_slope(
    difference: &MinkowskiDifference,
    shadow: DVec2,
    slopes: [DVec2; 2],
) -> DVec2 {
    let (_, ellipsoids) = difference.inertia_ellipsoids();
    let n = ((slopes[0] + slopes[1]) * 0.5).extend(1.0);
    let [a, b] =
        [support_derivatives(&ellipsoids[0], n).1, support_derivatives(&ellipsoids[1], n).1];
    (a + b).inverse() * (shadow + a * slopes[0] + b * slopes[1])
}

/// Returns the gradient and the Hessian of an ellipsoid's support function with respect to the lateral
/// components of a normal.
#[inline]
fn support_derivatives(k: &Symmetric, normal: DVec3) -> (DVec2, DMat2) {
    let kn = k.times_vector(normal);
    let inverse_length = 1.0 / normal.dot(kn).sqrt();
    let g = kn.truncate() * inverse_length;
    let lateral = DMat2::from_cols(DVec2::new(k.xx, k.xy), DVec2::new(k.xy, k.yy));
    (g, (lateral - DMat2::from_cols(g * g.x, g * g.y)) * inverse_length)
}
