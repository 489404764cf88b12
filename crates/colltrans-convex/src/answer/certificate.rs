//! Certificates: proofs of an answer that can be checked with nothing but the two bodies.
//!
//! Notation (section 1 of the paper): `P` moves along `d`, `Q` is fixed, and `M = {q - p : p in P, q in Q}`.
//! The line `t d` intersects `M` for `t` in `[coll, exit]`.
//!
//! - Lower bound: for any `n` with `n.d > 0`, `coll >= (min_Q n.q - max_P n.p) / n.d`.
//! - Upper bound: weights `w_i >= 0` with sum 1 over pairs of vertices `(p_i, q_i)` such that
//!   `sum w_i (q_i - p_i) = t d`; then `coll <= t`.
//! - Separation: `n` with `n.d = 0` and `min_Q n.q - max_P n.p > 0`.
//!
//! Rounding (see [`noise`]): a search rounds its bounds outwards. A check evaluates the plane nearly without
//! rounding ([`height_bounds`](colltrans_kernel::height_bounds)), and accepts no lower bound or margin above the one
//! that the plane proves.

use glam::DVec3;
use thiserror::Error;

use crate::body::{InputFacet, ObstacleId};
use crate::setting::error::QueryError;
use crate::setting::{Setting, VertexPair};
use colltrans_kernel::height_bounds;
use colltrans_kernel::noise::{self, Noise};
use colltrans_kernel::pose::MAX_STRETCH;

/// Factor that exceeds the rounding errors of a few operations.
const ROUND_UP: f64 = 1.0 + 8.0 * f64::EPSILON;

/// Lower and upper bound of a collision translation, with their proofs (section 1 of the paper).
///
/// With the moving body `P`, the fixed body `Q` and the direction `d`:
///
/// - The plane proves `lower`: `t >= (min_Q n.q - max_P n.p) / n.d` for any `n` with `n.d > 0`.
/// - The pairs prove `upper`: if `sum w_i (q_i - p_i) = t d` with weights `w_i >= 0` of sum 1, the bodies are
///   in contact at `t`.
///
/// `lower <= collision translation <= upper` holds exactly for the bodies as given: the convex hulls of their
/// [`vertices`](crate::ConvexPolyhedron::vertices), placed by the nine matrix entries and the translation of
/// their poses. Both bounds are rounded outwards.
///
/// For a cast with a minimum gap `g` (see [`Cast::with_min_gap`](crate::Cast::with_min_gap)), the bounds are those of
/// the translation at which the distance falls to `g`. The plane proves
/// `t >= (min_Q n.q - max_P n.p - g) / n.d`. The pairs prove `|sum w_i (q_i - p_i) - t d| <= g`.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct Certificate {
    /// Unit normal, in the world, of the supporting plane that proves the lower bound; `normal . d > 0`.
    pub normal: DVec3,
    /// The lower bound that the plane proves, in multiples of the direction.
    pub lower: f64,
    /// Three pairs of vertices whose differences `q - p` span a triangle that the line `t d` intersects. With a
    /// minimum gap, the distance of their weighted mean from `upper d` is at most the gap.
    pub pairs: [VertexPair; 3],
    /// Barycentric coordinates of the intersection in this triangle, not negative, with sum 1. The witness
    /// points are `sum w_i p_i` and `sum w_i q_i`.
    pub weights: [f64; 3],
    /// The upper bound that the pairs prove, in multiples of the direction.
    ///
    /// Infinite in a [`Grazing`](crate::Grazing) whose shadows overlap by less than rounding error. Such a
    /// certificate claims only `lower`.
    #[cfg_attr(
        feature = "serde",
        serde(with = "colltrans_kernel::serialization::null_as_infinity")
    )]
    pub upper: f64,
    /// Bound on the part of `upper - lower` that is due to rounding, in multiples of the direction.
    ///
    /// It is the sum of fifteen noises (see [the crate's introduction](crate#accuracy)) and of the bound on
    /// how far the bodies reach beyond their support points, divided by `normal . d`. If bodies that only
    /// touch were widened laterally, it includes the effect of the widening. A cast with a minimum gap may state more,
    /// for example if the bodies pass each other at about the gap.
    pub rounding: f64,
}

/// Proof that two bodies never meet along the direction: a plane between them that is parallel to the
/// direction.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct Separation {
    /// Unit normal in the world, orthogonal to the direction, pointing from the moving body to the fixed one.
    pub normal: DVec3,
    /// Lower bound of the distance of the shadows, in world units; positive.
    ///
    /// It is at most `(min_Q n'.q - max_P n'.p) / |n'|`, where `n'` is the component of the normal orthogonal
    /// to the direction.
    pub margin: f64,
}

/// Reason why a certificate is rejected.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum CertificateError {
    /// The normal is not a unit vector, or its angle to the direction is wrong. For a contact its component
    /// along the direction must be positive, for a separation zero.
    #[error("the normal {normal} is not a unit vector, or its angle to the direction is wrong")]
    Normal {
        /// The normal.
        normal: DVec3,
    },
    /// A vertex index is out of range.
    #[error("pair {pair} names a vertex that does not exist")]
    UnknownVertex {
        /// Position of its pair in the list of pairs.
        pair: usize,
    },
    /// Weights of three pairs are negative, or their sum is not 1.
    #[error(
        "the weights {weights:?} are not barycentric coordinates: one is negative, or the sum is not 1"
    )]
    Weights {
        /// The weights.
        weights: [f64; 3],
    },
    /// Weights of four pairs are negative, or their sum is not 1.
    #[error("the weights {weights:?} do not define a mean: one is negative, or the sum is not 1")]
    PointWeights {
        /// The weights.
        weights: [f64; 4],
    },
    /// The witness points do not coincide after the translation.
    #[error("the distance of the witness points is {residual:e}, accepted: at most {tolerance:e}")]
    Residual {
        /// Distance of the witness points after the translation, in world units.
        residual: f64,
        /// The largest accepted distance: a bound on the rounding error or the lateral widening, or the
        /// minimum gap of the cast.
        tolerance: f64,
    },
    /// A claimed bound or margin is stronger than the proven one.
    #[error("the proof claims {claimed:?}, but proves only {proven:?}")]
    Bound {
        /// The proven bound or margin.
        proven: f64,
        /// The claimed bound or margin.
        claimed: f64,
    },
    /// The lower bound is above the upper one.
    #[error("the lower bound {lower:?} is above the upper bound {upper:?}")]
    Order {
        /// The lower bound.
        lower: f64,
        /// The upper bound.
        upper: f64,
    },
    /// An estimate is not between its bounds.
    #[error("the translation {value:?} is not between its bounds, {lower:?} and {upper:?}")]
    Value {
        /// The estimate.
        value: f64,
        /// The claimed lower bound.
        lower: f64,
        /// The claimed upper bound.
        upper: f64,
    },
    /// The claimed rounding is negative, not a number, or larger than the rounding error of the
    /// configuration.
    #[error("the claimed rounding {claimed:e} is not between 0 and {derived:e}")]
    Rounding {
        /// The claimed rounding.
        claimed: f64,
        /// The largest accepted rounding.
        derived: f64,
    },
    /// The proof is for bodies that are shrunk by another tolerance.
    #[error("the proof is for a tolerance of {claimed:?}, not {expected:?}")]
    OtherTolerance {
        /// Tolerance of the proof.
        claimed: f64,
        /// Tolerance of the cast.
        expected: f64,
    },
    /// The query that the proof is about is invalid.
    #[error("the query of the proof is invalid: {0}")]
    Query(#[from] QueryError),
    /// A claim about the bodies in their given poses does not hold.
    #[error("the claim about the bodies in their given poses does not hold")]
    StartClaim,
    /// An entry of a cover does not hold, or does not fit the bodies.
    #[error("entry {entry} of the cover does not hold, or does not fit the bodies")]
    Cover {
        /// Index of the entry, or the number of entries if the cover ends too early.
        entry: usize,
    },
    /// Two triangles do not block the body.
    #[error("triangles {moving} and {fixed} do not block the body")]
    Facets {
        /// Triangle of the moving body, an index into `Solid::triangles`.
        moving: u32,
        /// Triangle of the fixed body, an index into `Solid::triangles`.
        fixed: u32,
    },
    /// The facets that the answer names as blocking are not those of the proof.
    #[error(
        "facets {moving} and {fixed} of the input are not those that are proven to block the body"
    )]
    OtherFacets {
        /// Facet of the moving body.
        moving: InputFacet,
        /// Facet of the fixed body.
        fixed: InputFacet,
    },
    /// A claim about one obstacle of a scene does not hold.
    #[error("obstacle {obstacle}: {reason}")]
    Obstacle {
        /// The obstacle.
        obstacle: ObstacleId,
        /// Reason why the claim is rejected.
        reason: Box<Self>,
    },
    /// The proof does not cover an obstacle whose box is nearer than the claim.
    #[error("the proof does not cover obstacle {obstacle}")]
    Unproven {
        /// The obstacle.
        obstacle: ObstacleId,
    },
    /// The proof names an obstacle that does not exist or is ignored, or names obstacles out of order.
    #[error("obstacle {obstacle} does not exist, is ignored, or is out of order")]
    UnknownObstacle {
        /// The obstacle, as named by the proof.
        obstacle: ObstacleId,
    },
}

impl CertificateError {
    /// Wraps this error as that of one obstacle.
    #[doc(hidden)]
    #[must_use]
    #[inline]
    pub fn of_obstacle(self, obstacle: ObstacleId) -> Self {
        Self::Obstacle { obstacle, reason: Box::new(self) }
    }

    /// Builds [`Self::Facets`] from the triangles of the moving and of the fixed body.
    #[doc(hidden)]
    #[inline]
    pub const fn blocking_triangles([moving, fixed]: [u32; 2]) -> Self {
        Self::Facets { moving, fixed }
    }
}

/// A proof to check: of a contact, or of a separation.
#[derive(Debug, Clone, Copy)]
pub enum Proof<'a> {
    /// Proof of both bounds of a collision translation.
    Contact(&'a Certificate),
    /// Proof that the bodies never meet.
    Separation(&'a Separation),
}

/// Implements `From<&T>` for an enum of proofs, for the type `T` of each listed variant.
#[doc(hidden)]
#[macro_export]
macro_rules! impl_from_proofs {
    ($($proof:ident { $($variant:ident($of:ty)),+ $(,)? }),+) => { $($(
        impl<'a> From<&'a $of> for $proof<'a> {
            fn from(of: &'a $of) -> Self {
                Self::$variant(of)
            }
        }
    )+)+ };
}
#[doc(hidden)]
pub use impl_from_proofs;

impl_from_proofs!(Proof { Contact(Certificate), Separation(Separation) });

/// The distance of the bodies along a normal, with its error.
#[derive(Debug, Clone, Copy)]
pub struct NormalBound {
    /// `min_Q n.q - max_P n.p` at the support points, in world units.
    pub(crate) distance: f64,
    /// Bound on the amount by which `distance` exceeds the true minimum: rounding, and the reach of the
    /// bodies beyond the support points.
    pub(crate) error: f64,
}

impl NormalBound {
    /// Computes the distance of the support points along `normal`, a unit vector.
    ///
    /// `normals` is the normal in the frames of the moving and of the fixed body. `beyond` bounds how far the
    /// bodies reach beyond the support points.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "a copy through memory stalls its reader")]
    pub(crate) fn new(
        setting: &Setting,
        noise: Noise,
        normal: DVec3,
        normals: &[DVec3; 2],
        support: VertexPair,
        beyond: f64,
    ) -> Self {
        let [p, q] = setting.vertices(support);
        let distance = (normals[1].dot(q) - normals[0].dot(p)) + normal.dot(setting.offset);
        Self { distance, error: noise.lower_bound_margin() + beyond }
    }

    /// Returns the lower bound of the collision translation that the normal proves, in multiples of the
    /// direction, rounded down. `steepness` is `n . d`.
    #[inline]
    pub(crate) fn lower_bound(&self, steepness: f64) -> f64 {
        ((self.distance - self.error) / steepness).next_down()
    }
}

/// Bounds the difference of the estimates of the upper and the lower bound that is due to rounding and to a
/// lateral widening, in multiples of the direction.
#[inline]
pub fn gap_rounding(setting: &Setting, normal: DVec3, noise: Noise, widening: f64) -> f64 {
    // Without widening, which is the usual case, the lateral part is not needed.
    let across = if widening == 0.0 { 0.0 } else { normal.cross(setting.unit).length() };
    noise.max_bound_gap(across, widening) / normal.dot(setting.direction)
}

/// Checks whether numbers are weights of a mean: none is negative, and their sum is 1 to within rounding.
#[inline]
pub fn are_weights(weights: &[f64]) -> bool {
    let sum: f64 = weights.iter().sum();
    weights.iter().all(|w| *w >= 0.0) && (sum - 1.0).abs() <= noise::UNIT_VECTOR
}

impl Certificate {
    /// Returns `upper - lower`, the difference of the proven bounds, in multiples of the direction.
    pub fn gap(&self) -> f64 {
        self.upper - self.lower
    }

    /// Checks the certificate for [`Cast::verify`](crate::Cast::verify), with the minimum gap `min_gap` or 0.
    /// Returns the proven difference of the bounds.
    ///
    /// The bodies have the gap where their cores have it in addition to both radii.
    pub(crate) fn verify_with_gap(
        &self,
        setting: &Setting,
        min_gap: f64,
    ) -> Result<f64, CertificateError> {
        let [least_gap, min_gap] = setting.core_gap_bounds(min_gap);
        let normal = self.normal;
        let steepness = normal.dot(setting.direction);
        let unit = (normal.length() - 1.0).abs() <= noise::UNIT_VECTOR;
        if !unit || steepness.is_nan() || steepness <= 0.0 {
            return Err(CertificateError::Normal { normal });
        }
        if self.lower > self.upper {
            return Err(CertificateError::Order { lower: self.lower, upper: self.upper });
        }
        let noise = Noise::for_size(setting.size() + min_gap);
        let gap_bound =
            (min_gap > 0.0).then(|| self.upper_bound_within_gap(setting, least_gap, noise));
        let upper = match gap_bound {
            Some(Ok(upper)) => upper,
            Some(Err(error)) if !noise.is_below_noise(min_gap) => return Err(error),
            // Bodies in contact are within any gap. For a slight gap, contact may be the only provable claim.
            _ => self.proven_upper(setting)? + noise.checked_upper_bound_margin() / steepness,
        };
        let lower = proven_lower(setting, normal, min_gap)?;
        // For a slight gap, the upper bound may be that of contact. The bounds then differ by the gap as
        // well.
        let gap_share = if noise.is_below_noise(min_gap) { 2.0 * min_gap / steepness } else { 0.0 };
        let derived = max_rounding(setting, normal, noise) + gap_share;
        if self.lower.is_nan() || self.lower > lower {
            return Err(CertificateError::Bound { proven: lower, claimed: self.lower });
        }
        if self.upper.is_nan() || self.upper < upper {
            return Err(CertificateError::Bound { proven: upper, claimed: self.upper });
        }
        if !(0.0..=derived).contains(&self.rounding) {
            return Err(CertificateError::Rounding { claimed: self.rounding, derived });
        }
        Ok(upper - lower)
    }

    /// Returns the claimed upper bound if the distance of the witness points is at most `min_gap` after this
    /// translation. An infinite bound is accepted.
    fn upper_bound_within_gap(
        &self,
        setting: &Setting,
        min_gap: f64,
        noise: Noise,
    ) -> Result<f64, CertificateError> {
        let mean = self.weighted_mean(setting)?;
        let residual =
            (mean - setting.direction * self.upper).length() + noise.checked_gap_margin();
        // An infinite bound claims nothing. Its residual is not finite.
        if self.upper == f64::INFINITY || residual <= min_gap {
            Ok(self.upper)
        } else {
            Err(CertificateError::Residual { residual, tolerance: min_gap })
        }
    }

    /// Computes the estimate of the upper bound that the witness pairs prove.
    fn proven_upper(&self, setting: &Setting) -> Result<f64, CertificateError> {
        let mean = self.weighted_mean(setting)?;
        let upper = mean.dot(setting.unit) / setting.length;
        let residual = (mean - setting.direction * upper).length();
        let noise = setting.noise();
        // Certificates of widened bodies have no upper bound, and their witness points may differ by the
        // widening.
        let tolerance = if self.upper == f64::INFINITY {
            noise.widened_residual_tolerance(max_excess(setting, noise))
        } else {
            noise.residual_tolerance()
        };
        if residual <= tolerance {
            Ok(upper)
        } else {
            Err(CertificateError::Residual { residual, tolerance })
        }
    }

    /// Computes the weighted mean of the pairs' points of `M`.
    ///
    /// Returns an error if the weights are not those of a mean, or if a vertex does not exist.
    fn weighted_mean(&self, setting: &Setting) -> Result<DVec3, CertificateError> {
        let weights = self.weights;
        if !are_weights(&weights) {
            return Err(CertificateError::Weights { weights });
        }
        let sum: f64 = weights.iter().sum();
        let mut mean = DVec3::ZERO;
        for (pair, (&vertices, weight)) in self.pairs.iter().zip(weights).enumerate() {
            let VertexPair { moving, fixed } = vertices;
            let exists = moving.index() < setting.moving.vertices().len()
                && fixed.index() < setting.fixed.vertices().len();
            if !exists {
                return Err(CertificateError::UnknownVertex { pair });
            }
            mean += setting.terms(vertices).rounded_point() * (weight / sum);
        }
        Ok(mean)
    }
}

/// Computes the lower bound of the translation that the plane with this normal proves, for bodies with the
/// minimum gap `min_gap`.
///
/// Returns [`CertificateError::Normal`] if `n . d` may not be positive.
fn proven_lower(setting: &Setting, normal: DVec3, min_gap: f64) -> Result<f64, CertificateError> {
    let [least, most] = height_bounds::dot_bounds(normal, setting.direction);
    if least <= 0.0 {
        return Err(CertificateError::Normal { normal });
    }
    let distance = reduced_by_gap(setting.distance_along(normal), normal, min_gap);
    // The larger divisor gives the lower quotient if the distance is positive, the smaller one if it is
    // negative.
    Ok((distance / if distance < 0.0 { least } else { most }).next_down())
}

/// Returns a lower bound of `distance - min_gap * |normal|`.
fn reduced_by_gap(distance: f64, normal: DVec3, min_gap: f64) -> f64 {
    if min_gap == 0.0 {
        return distance;
    }
    let [_, square] = height_bounds::dot_bounds(normal, normal);
    (distance - (min_gap * square.sqrt().next_up()).next_up()).next_down()
}

/// Returns a bound on how far the bodies and their inputs reach beyond support points: the tolerance of coplanar
/// vertices, and [`TwoBodies::input_excess`](crate::setting::TwoBodies::input_excess).
fn max_excess(setting: &Setting, noise: Noise) -> f64 {
    noise.max_excess() + setting.input_excess()
}

/// Returns the largest rounding that a certificate may state. The field proves nothing.
///
/// The limit is twice the rounding that a search states. A search with a gap states the excess beyond support points
/// twice.
fn max_rounding(setting: &Setting, normal: DVec3, noise: Noise) -> f64 {
    let margins = noise.upper_bound_margin() + noise.lower_bound_margin();
    let excess = max_excess(setting, noise);
    let rounding = (margins + excess) / normal.dot(setting.direction);
    2.0 * (gap_rounding(setting, normal, noise, noise.max_widening_half_side(excess)) + rounding)
}

/// Checks that a normal is a unit vector and orthogonal to the direction, to within rounding.
///
/// # Errors
/// Returns [`CertificateError::Normal`] if the normal is not.
#[inline]
pub fn check_lateral_normal(setting: &Setting, normal: DVec3) -> Result<(), CertificateError> {
    let is_unit = (normal.length() - 1.0).abs() <= noise::UNIT_VECTOR;
    if is_unit && normal.dot(setting.unit).abs() <= noise::UNIT_VECTOR {
        Ok(())
    } else {
        Err(CertificateError::Normal { normal })
    }
}

/// Returns a lower bound of the distance of the bodies' shadows, in world units, from the lateral component
/// of a normal. A negative result bounds their overlap along this component.
///
/// The component of the normal along the direction contributes at most its share of the size `S`, which is
/// subtracted.
#[inline]
pub fn shadow_gap(setting: &Setting, normal: DVec3) -> f64 {
    let [low, high] = height_bounds::dot_bounds(normal, setting.direction);
    let along = low.abs().max(high.abs()) / setting.length * ROUND_UP;
    let closing = along * (setting.size() * MAX_STRETCH) * ROUND_UP;
    let gap = (setting.distance_along(normal) - closing).next_down();
    let [least, most] = height_bounds::dot_bounds(normal, normal);
    let across = if gap > 0.0 {
        most.sqrt().next_up()
    } else {
        (least - along * along).next_down().sqrt().next_down()
    };
    (gap / across).next_down()
}

impl Separation {
    /// Checks the separation for [`Cast::verify`](crate::Cast::verify), with the minimum gap `min_gap` or 0.
    /// Returns the proven margin.
    pub(crate) fn verify_with_gap(
        &self,
        setting: &Setting,
        min_gap: f64,
    ) -> Result<f64, CertificateError> {
        self.verify_margin(setting, min_gap, |core_margin| setting.less_radii(core_margin))
    }

    /// Checks the separation as one of the cores of rounded bodies. Returns the proven margin.
    pub(crate) fn verify_of_cores(&self, setting: &Setting) -> Result<f64, CertificateError> {
        self.verify_margin(setting, 0.0, |core_margin| core_margin)
    }

    /// Checks that the margin is larger than `min_gap`, and at most the proven one. `of_bodies` returns this one from
    /// that of the cores.
    #[inline]
    fn verify_margin(
        &self,
        setting: &Setting,
        min_gap: f64,
        of_bodies: impl Fn(f64) -> f64,
    ) -> Result<f64, CertificateError> {
        check_lateral_normal(setting, self.normal)?;
        let proven = of_bodies(shadow_gap(setting, self.normal));
        let claimed = self.margin;
        if claimed > min_gap && claimed <= proven {
            Ok(proven)
        } else {
            Err(CertificateError::Bound { proven, claimed })
        }
    }
}
