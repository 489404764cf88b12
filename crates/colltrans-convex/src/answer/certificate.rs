//! Certificates: proofs of an answer that anyone can check who has the two bodies.
//!
//! Notation (section 1 of the paper). `P` moves along `d`, `Q` is fixed, both are placed in the
//! world; `M = {q - p : p in P, q in Q}`. The line `t d` meets `M` for `t` in `[coll, exit]`.
//!
//! - Lower bound: for any `n` with `n.d > 0`, `coll >= (min_Q n.q - max_P n.p) / n.d`.
//! - Upper bound: weights `w_i >= 0` with sum 1 over pairs of vertices `(p_i, q_i)` such that
//!   `sum w_i (q_i - p_i) = t d`; then `coll <= t`.
//! - Separation: `n` with `n.d = 0` and `min_Q n.q - max_P n.p > 0`.
//!
//! Rounding: see [`noise`]. The two bounds differ by at most [`Certificate::rounding`]. A search lowers
//! what it computed by more than its rounding can be. The check computes the heights of the vertices
//! along the normal with hardly any ([`extent`](colltrans_kernel::extent)), so it accepts no lower bound
//! and no margin beyond what the plane proves, and still each that a search has lowered.

use glam::DVec3;
use thiserror::Error;

use crate::body::{InputFacet, ObstacleId};
use crate::setting::error::QueryError;
use crate::setting::{Setting, VertexPair};
use colltrans_kernel::extent;
use colltrans_kernel::noise::{self, Noise};
use colltrans_kernel::pose::STRETCHED;

/// Factor that is more than a few roundings.
const ROUND_UP: f64 = 1.0 + 8.0 * f64::EPSILON;

/// Both bounds of a collision translation with their proofs (section 1 of the paper).
///
/// With `P` the moving body, `Q` the fixed one and `d` the direction:
///
/// - `t >= (min_Q n.q - max_P n.p) / n.d` for any `n` with `n.d > 0`: the plane proves `lower`;
/// - if `sum w_i (q_i - p_i) = t d` with weights `w_i >= 0` of sum 1, the bodies meet at `t`: the
///   pairs prove `upper`.
///
/// `lower <= collision translation <= upper`, exactly, for the bodies as given: the convex hulls of
/// their [`vertices`](crate::ConvexPolyhedron::vertices), in poses as their nine entries and their
/// translations. Both are rounded outwards by what their computation can be off.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct Certificate {
    /// Unit normal of the supporting plane that proves the lower bound, in the world;
    /// `normal . d > 0`.
    pub normal: DVec3,
    /// The lower bound it proves, in multiples of the direction.
    pub lower: f64,
    /// Three pairs of vertices whose differences `q - p` span a triangle that the line `t d`
    /// pierces.
    pub pairs: [VertexPair; 3],
    /// The weights (barycentric coordinates) of the pairs where the line passes: not negative, sum
    /// 1. The witness points are `sum w_i p_i` and `sum w_i q_i`.
    pub weights: [f64; 3],
    /// The upper bound they prove, in multiples of the direction. Infinite in a
    /// [`Grazing`](crate::Grazing) whose shadows rounding cannot tell to overlap: such a one claims
    /// `lower` only.
    #[cfg_attr(feature = "serde", serde(with = "colltrans_kernel::written::or_infinite"))]
    pub upper: f64,
    /// What rounding alone can make of `upper - lower` at the size of this configuration: fifteen
    /// noises (see [the crate's introduction](crate#accuracy)) and what the bodies may reach beyond
    /// their support points, over `normal . d`, in multiples of the direction. Where bodies that only
    /// touch were widened sideways for an answer, what the widening can make of the translation, too.
    pub rounding: f64,
}

/// The proof that two bodies never meet along the direction: a plane parallel to it lies between
/// them.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct Separation {
    /// Unit normal in the world, orthogonal to the direction, from the moving body to the fixed
    /// one.
    pub normal: DVec3,
    /// Lower bound of the distance of the shadows, in world units, and positive: at most `min_Q n'.q - max_P n'.p` over
    /// `|n'|`, where `n'` is what of the normal `n` is orthogonal to the direction.
    pub margin: f64,
}

/// Why a certificate does not prove what it says.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum CertificateError {
    /// The normal is not a unit vector with a component along the direction (contact), or
    /// orthogonal to it (separation).
    #[error("the normal {normal} is not a unit vector on the right side of the direction")]
    Normal {
        /// The normal.
        normal: DVec3,
    },
    /// A vertex index does not exist.
    #[error("pair {pair} names a vertex that does not exist")]
    UnknownVertex {
        /// Index of the pair.
        pair: usize,
    },
    /// The weights are negative or their sum is not 1.
    #[error("the weights {weights:?} are not barycentric coordinates")]
    Weights {
        /// The weights.
        weights: [f64; 3],
    },
    /// The weights of two points are negative or their sum is not 1.
    #[error("the weights {weights:?} are not those of a mean")]
    PointWeights {
        /// The weights.
        weights: [f64; 4],
    },
    /// The witness points do not come together.
    #[error("the witness points miss each other by {residual:e} (tolerated: {tolerance:e})")]
    Residual {
        /// Distance of the witness points after the translation.
        residual: f64,
        /// What rounding explains.
        tolerance: f64,
    },
    /// A bound or a margin says more than is proven.
    #[error("{proven:?} is proven, not {claimed:?}")]
    Bound {
        /// The bound, or margin, that is proven.
        proven: f64,
        /// The one claimed.
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
    /// An estimate that is not between its bounds.
    #[error("the translation {value:?} is not between its bounds, {lower:?} and {upper:?}")]
    Value {
        /// The estimate.
        value: f64,
        /// The lower bound claimed.
        lower: f64,
        /// The upper bound claimed.
        upper: f64,
    },
    /// What is said of rounding is negative, not a number, or more than it explains.
    #[error("the rounding {claimed:e} is not between 0 and what rounding explains, {derived:e}")]
    Rounding {
        /// The one claimed.
        claimed: f64,
        /// The largest that rounding explains.
        derived: f64,
    },
    /// It is about bodies shrunk by another tolerance.
    #[error("the proof is for a tolerance of {claimed:?}, not {asked:?}")]
    OtherTolerance {
        /// The one of the proof.
        claimed: f64,
        /// The one of the cast.
        asked: f64,
    },
    /// What it is about cannot be asked.
    #[error("there is no such query: {0}")]
    Query(#[from] QueryError),
    /// The bodies do not do at the start what it says.
    #[error("what is said of the bodies where they are does not hold")]
    Start,
    /// An entry of a cover does not hold, or does not fit the bodies.
    #[error("entry {entry} of the cover does not hold, or does not fit the bodies")]
    Cover {
        /// Its number; the number of all if the cover ends too early.
        entry: usize,
    },
    /// Two triangles that do not stop the body.
    #[error("triangles {moving} and {fixed} do not stop the body")]
    Facets {
        /// Of the moving body, by its position in `Solid::triangles`.
        moving: u32,
        /// Of the fixed body.
        fixed: u32,
    },
    /// Facets that are said to stop the body, but are not those of the proof.
    #[error(
        "facets {moving} and {fixed} of the input are not those that are proven to stop the body"
    )]
    OtherFacets {
        /// Of the moving body.
        moving: InputFacet,
        /// Of the fixed body.
        fixed: InputFacet,
    },
    /// What is said of one body among many does not hold.
    #[error("of obstacle {obstacle}: {reason}")]
    Obstacle {
        /// Which one.
        obstacle: ObstacleId,
        /// Why not.
        reason: Box<Self>,
    },
    /// A body among many that nothing is proven of: its box is nearer than what is claimed, and no proof
    /// names it.
    #[error("nothing is proven of obstacle {obstacle}")]
    Unproven {
        /// Which one.
        obstacle: ObstacleId,
    },
    /// A proof names a body that is not there, or is ignored, or names bodies out of order.
    #[error("obstacle {obstacle} is not there, or ignored, or out of order")]
    UnknownObstacle {
        /// Which one.
        obstacle: ObstacleId,
    },
}

impl CertificateError {
    #[doc(hidden)]
    #[must_use]
    #[inline]
    pub fn of_obstacle(self, obstacle: ObstacleId) -> Self {
        Self::Obstacle { obstacle, reason: Box::new(self) }
    }

    #[doc(hidden)]
    #[inline]
    pub const fn triangles([moving, fixed]: [u32; 2]) -> Self {
        Self::Facets { moving, fixed }
    }
}

/// A proof to check: of a contact, or of a separation.
#[derive(Debug, Clone, Copy)]
pub enum Proof<'a> {
    /// Of both bounds of a collision translation.
    Contact(&'a Certificate),
    /// Of there being none.
    Separation(&'a Separation),
}

/// What can be checked, each kind a reference under the name of its variant.
#[doc(hidden)]
#[macro_export]
macro_rules! checked_as {
    ($($proof:ident { $($variant:ident($of:ty)),+ $(,)? }),+) => { $($(
        impl<'a> From<&'a $of> for $proof<'a> {
            fn from(of: &'a $of) -> Self {
                Self::$variant(of)
            }
        }
    )+)+ };
}
#[doc(hidden)]
pub use checked_as;

checked_as!(Proof { Contact(Certificate), Separation(Separation) });

/// A bound along a normal, and by how much rounding may have overstated it.
#[derive(Debug, Clone, Copy)]
pub struct NormalBound {
    /// `min_Q n.q - max_P n.p` at the support points.
    pub(crate) distance: f64,
    /// What the computation, and bodies that reach beyond the support points, may take from it.
    pub(crate) error: f64,
}

impl NormalBound {
    /// For a unit normal, also in the frames of the moving and of the fixed body, the support points
    /// along it, and what the bodies reach beyond them.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "passed through memory it stalls its reader")]
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
        Self { distance, error: noise.lowered() + beyond }
    }

    /// The lower bound that it proves, in multiples of the direction, rounded down.
    #[inline]
    pub(crate) fn lower_bound(&self, steepness: f64) -> f64 {
        ((self.distance - self.error) / steepness).next_down()
    }
}

/// What rounding, and a widening sideways, can make of the difference between the estimates of the
/// upper and the lower bound for a normal, in multiples of the direction.
#[inline]
pub fn gap_rounding(setting: &Setting, normal: DVec3, noise: Noise, widening: f64) -> f64 {
    // Unwidened bodies, almost all, need no length.
    let across = if widening == 0.0 { 0.0 } else { normal.cross(setting.unit).length() };
    noise.gap(across, widening) / normal.dot(setting.direction)
}

/// Whether these are weights of a mean: none negative, together 1 to within rounding.
#[inline]
pub fn are_weights(weights: &[f64]) -> bool {
    let sum: f64 = weights.iter().sum();
    weights.iter().all(|w| *w >= 0.0) && (sum - 1.0).abs() <= noise::UNIT_VECTOR
}

impl Certificate {
    /// `upper - lower`: how far apart the proven bounds are, in multiples of the direction.
    pub fn gap(&self) -> f64 {
        self.upper - self.lower
    }

    /// The checks of [`Cast::verify`](crate::Cast::verify) of bodies that are to keep a gap, or none, and how far the
    /// bounds are apart that are proven.
    pub(crate) fn verify(&self, setting: &Setting, keep: f64) -> Result<f64, CertificateError> {
        let normal = self.normal;
        let steepness = normal.dot(setting.direction);
        let unit = (normal.length() - 1.0).abs() <= noise::UNIT_VECTOR;
        if !unit || steepness.is_nan() || steepness <= 0.0 {
            return Err(CertificateError::Normal { normal });
        }
        if self.lower > self.upper {
            return Err(CertificateError::Order { lower: self.lower, upper: self.upper });
        }
        let noise = Noise::of(setting.scale() + keep);
        let gap_bound = (keep > 0.0).then(|| self.upper_bound_within_gap(setting, keep, noise));
        let upper = match gap_bound {
            Some(Ok(upper)) => upper,
            Some(Err(error)) if !noise.is_slight(keep) => return Err(error),
            // Bodies that meet are as near as any gap; of a slight one that may be all that is proven.
            _ => self.proven_upper(setting)? + noise.above_mean() / steepness,
        };
        let lower = proven_lower(setting, normal, keep)?;
        // Of a slight gap the bounds are those of the bodies as they are, apart by the gap more.
        let gap_share = if noise.is_slight(keep) { 2.0 * keep / steepness } else { 0.0 };
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

    /// The upper bound, if the witness points are as near there as a gap; infinite, it claims nothing.
    fn upper_bound_within_gap(
        &self,
        setting: &Setting,
        keep: f64,
        noise: Noise,
    ) -> Result<f64, CertificateError> {
        let mean = self.weighted_mean(setting)?;
        let residual = (mean - setting.direction * self.upper).length() + noise.mean_kept();
        // An infinite one is no distance.
        if self.upper == f64::INFINITY || residual <= keep {
            Ok(self.upper)
        } else {
            Err(CertificateError::Residual { residual, tolerance: keep })
        }
    }

    /// The estimate of the upper bound that the witness pairs prove.
    fn proven_upper(&self, setting: &Setting) -> Result<f64, CertificateError> {
        let mean = self.weighted_mean(setting)?;
        let upper = mean.dot(setting.unit) / setting.length;
        let residual = (mean - setting.direction * upper).length();
        let noise = setting.noise();
        // Bodies that were widened sideways may miss by that, and claim no upper bound.
        let tolerance =
            if self.upper == f64::INFINITY { noise.residual_widened() } else { noise.residual() };
        if residual <= tolerance {
            Ok(upper)
        } else {
            Err(CertificateError::Residual { residual, tolerance })
        }
    }

    /// The point of `M` that the weights make of the pairs.
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
            mean += setting.terms(vertices).point() * (weight / sum);
        }
        Ok(mean)
    }
}

/// The lower bound of the translation that the plane with this normal proves, of bodies that keep a gap.
fn proven_lower(setting: &Setting, normal: DVec3, keep: f64) -> Result<f64, CertificateError> {
    let [least, most] = extent::dot(normal, setting.direction);
    if least <= 0.0 {
        return Err(CertificateError::Normal { normal });
    }
    let distance = reduced_by_gap(setting.distance_along(normal), normal, keep);
    // Rounded down, whichever sign.
    Ok((distance / if distance < 0.0 { least } else { most }).next_down())
}

/// At most what a height along a normal is more than a gap at right angles.
fn reduced_by_gap(distance: f64, normal: DVec3, keep: f64) -> f64 {
    if keep == 0.0 {
        return distance;
    }
    let [_, square] = extent::dot(normal, normal);
    (distance - (keep * square.sqrt().next_up()).next_up()).next_down()
}

/// Returns the largest rounding that a certificate may state, which proves nothing: twice what a search states, of
/// bodies that reach beyond their support points by no more than vertices may be off the planes of their faces.
fn max_rounding(setting: &Setting, normal: DVec3, noise: Noise) -> f64 {
    let rounding =
        (noise.raised() + noise.lowered() + noise.beyond()) / normal.dot(setting.direction);
    2.0 * (gap_rounding(setting, normal, noise, noise.widest()) + rounding)
}

/// Checks that a normal is a unit vector, and orthogonal to the direction, to within rounding.
#[inline]
pub fn check_lateral_normal(setting: &Setting, normal: DVec3) -> Result<(), CertificateError> {
    let is_unit = (normal.length() - 1.0).abs() <= noise::UNIT_VECTOR;
    if is_unit && normal.dot(setting.unit).abs() <= noise::UNIT_VECTOR {
        Ok(())
    } else {
        Err(CertificateError::Normal { normal })
    }
}

/// Returns at most the distance of the bodies' shadows, as what of a normal is orthogonal to the direction proves it;
/// negative if they may overlap, then by no more along that normal.
///
/// What of the normal is along the direction is worth at most its share of the size.
#[inline]
pub fn shadow_gap(setting: &Setting, normal: DVec3) -> f64 {
    let [low, high] = extent::dot(normal, setting.direction);
    let along = low.abs().max(high.abs()) / setting.length * ROUND_UP;
    let closing = along * (setting.scale() * STRETCHED) * ROUND_UP;
    let gap = (setting.distance_along(normal) - closing).next_down();
    let [least, most] = extent::dot(normal, normal);
    let across = if gap > 0.0 {
        most.sqrt().next_up()
    } else {
        (least - along * along).next_down().sqrt().next_down()
    };
    (gap / across).next_down()
}

impl Separation {
    /// The checks of [`Cast::verify`](crate::Cast::verify) of bodies that are to keep a gap, or none, and the margin
    /// proven.
    pub(crate) fn verify(&self, setting: &Setting, keep: f64) -> Result<f64, CertificateError> {
        check_lateral_normal(setting, self.normal)?;
        let (proven, claimed) = (shadow_gap(setting, self.normal), self.margin);
        if claimed > keep && claimed <= proven {
            Ok(proven)
        } else {
            Err(CertificateError::Bound { proven, claimed })
        }
    }
}
