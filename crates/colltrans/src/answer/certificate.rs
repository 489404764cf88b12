//! Certificates: proofs of an answer that two support evaluations can check.
//!
//! Notation (section 1 of the paper). `P` moves along `d`, `Q` is fixed, both are placed in the
//! world; `M = {q - p : p in P, q in Q}`. The line `t d` meets `M` for `t` in `[coll, exit]`.
//!
//! - Lower bound: for any `n` with `n.d > 0`, `coll >= (min_Q n.q - max_P n.p) / n.d`.
//! - Upper bound: weights `w_i >= 0` with sum 1 over pairs of vertices `(p_i, q_i)` such that
//!   `sum w_i (q_i - p_i) = t d`; then `coll <= t`.
//! - Separation: `n` with `n.d = 0` and `min_Q n.q - max_P n.p > 0`.
//!
//! Rounding: see [`noise`]. The two bounds differ by at most [`Certificate::tolerance`].

use glam::DVec3;
use thiserror::Error;

use crate::body::ConvexPolyhedron;
use crate::body::Pose;
use crate::error::QueryError;
use crate::number::noise::{self, Noise};
use crate::setting::{Setting, VertexPair};

/// Both bounds of a collision translation with their proofs (section 1 of the paper).
///
/// With `P` the moving body, `Q` the fixed one and `d` the direction:
///
/// - `t >= (min_Q n.q - max_P n.p) / n.d` for any `n` with `n.d > 0`: the plane proves `lower`;
/// - if `sum w_i (q_i - p_i) = t d` with weights `w_i >= 0` of sum 1, the bodies meet at `t`: the
///   pairs prove `upper`.
///
/// `lower` and `upper` may change places by rounding error. In [`Grazing`](crate::Grazing) the
/// bounds are those of the bodies *widened sideways* by a little more than rounding error, and so
/// is `tolerance`.
#[derive(Debug, Clone, Copy, PartialEq)]
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
    /// The upper bound they prove, in multiples of the direction.
    pub upper: f64,
    /// What rounding alone can make of `upper - lower` at the size of this configuration: ten
    /// noises (see [the crate's introduction](crate#accuracy)) over `normal . d`, in multiples of
    /// the direction.
    pub tolerance: f64,
}

/// The proof that two bodies never meet along the direction: a plane parallel to it lies between
/// them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Separation {
    /// Unit normal in the world, orthogonal to the direction, from the moving body to the fixed
    /// one.
    pub normal: DVec3,
    /// `min_Q n.q - max_P n.p > 0`: how far the shadows stay apart along `normal`, in world units.
    /// A lower bound of the distance of the shadows, not the distance itself.
    pub margin: f64,
}

/// Why a certificate does not prove what it says.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum CertificateError {
    /// The setting itself is not valid.
    #[error(transparent)]
    Setting(#[from] QueryError),
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
    /// The witness points do not come together.
    #[error("the witness points miss each other by {residual:e} (tolerated: {tolerance:e})")]
    Residual {
        /// Distance of the witness points after the translation.
        residual: f64,
        /// What rounding explains.
        tolerance: f64,
    },
    /// The bodies reach across the plane.
    #[error("the plane proves {proven}, not {claimed} (tolerated: {tolerance:e})")]
    Bound {
        /// The bound, or margin, that the plane proves.
        proven: f64,
        /// The one claimed.
        claimed: f64,
        /// What rounding explains.
        tolerance: f64,
    },
}

/// `min_Q n.q - max_P n.p`.
fn distance_along(setting: &Setting, normal: DVec3) -> f64 {
    let (in_moving, in_fixed) = (setting.moving_normal(normal), setting.fixed_normal(normal));
    let p = setting.moving.vertices()[setting.moving.support(in_moving) as usize];
    let q = setting.fixed.vertices()[setting.fixed.support(-in_fixed) as usize];
    (in_fixed.dot(q) - in_moving.dot(p)) + normal.dot(setting.offset)
}

/// What rounding, and a widening sideways, can make of `upper - lower` for a normal, in multiples
/// of the direction.
pub(crate) fn gap_tolerance(setting: &Setting, normal: DVec3, noise: Noise, widening: f64) -> f64 {
    // Unwidened bodies, almost all, need no length.
    let across = if widening == 0.0 { 0.0 } else { normal.cross(setting.unit).length() };
    noise.gap(across, widening) / normal.dot(setting.direction)
}

impl Certificate {
    /// `upper - lower`: how far apart the proven bounds are, in multiples of the direction.
    pub fn gap(&self) -> f64 {
        self.upper - self.lower
    }

    /// Checks the certificate against the two bodies, in `O(log n)`, and returns the gap
    /// `upper - lower` that is really proven, in multiples of the direction.
    ///
    /// Nothing of the solver is used: two support points for the lower bound, three pairs of
    /// vertices for the upper one. Bodies, poses and direction must be those of the query; for the
    /// `last` contact of a [`ContactRange`](crate::ContactRange) the direction is the opposite one.
    ///
    /// # Errors
    /// What the certificate fails to prove.
    ///
    /// ```
    /// # use colltrans::glam::DVec3;
    /// # use colltrans::{ConvexPolyhedron, Outcome, Pose, cast};
    /// let triangle = ConvexPolyhedron::from_points(&[DVec3::X, DVec3::Y, DVec3::Z])?;
    /// let start = Pose::from_translation(DVec3::new(-5.0, 0.0, 0.0))?;
    /// let world = Pose::IDENTITY;
    /// let Outcome::Contact(contact) = cast(&triangle, &start, &triangle, &world, DVec3::X)? else {
    ///     unreachable!("the same triangle, five units further")
    /// };
    /// let proof = contact.certificate;
    /// let gap = proof.verify(&triangle, &start, &triangle, &world, DVec3::X)?;
    /// assert!(gap <= proof.tolerance);
    ///
    /// let mut lie = proof;
    /// lie.lower += 1.0;
    /// assert!(lie.verify(&triangle, &start, &triangle, &world, DVec3::X).is_err());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn verify(
        &self,
        moving: &ConvexPolyhedron,
        moving_pose: &Pose,
        fixed: &ConvexPolyhedron,
        fixed_pose: &Pose,
        direction: DVec3,
    ) -> Result<f64, CertificateError> {
        let setting = Setting::new(moving, moving_pose, fixed, fixed_pose, direction)?;
        let normal = self.normal;
        let along = normal.dot(direction);
        if (normal.length() - 1.0).abs() > noise::UNIT_VECTOR || along.is_nan() || along <= 0.0 {
            return Err(CertificateError::Normal { normal });
        }
        let lower = distance_along(&setting, normal) / along;
        let upper = self.proven_upper(&setting)?;
        // What a certificate says of its own tolerance proves nothing: it is derived anew.
        let noise = setting.noise();
        let tolerance = gap_tolerance(&setting, normal, noise, noise.widest());
        for (proven, claimed, holds) in [
            (lower, self.lower, self.lower <= lower + tolerance),
            (upper, self.upper, (self.upper - upper).abs() <= tolerance),
            (tolerance, self.tolerance, self.tolerance <= 2.0 * tolerance),
        ] {
            if !holds {
                return Err(CertificateError::Bound { proven, claimed, tolerance });
            }
        }
        Ok(upper - lower)
    }

    /// The upper bound that the witness pairs prove.
    fn proven_upper(&self, setting: &Setting) -> Result<f64, CertificateError> {
        let weights = self.weights;
        let sum: f64 = weights.iter().sum();
        if weights.iter().any(|w| w.is_nan() || *w < 0.0) || (sum - 1.0).abs() > noise::UNIT_VECTOR
        {
            return Err(CertificateError::Weights { weights });
        }
        let mut difference = setting.offset;
        for (pair, (vertices, weight)) in self.pairs.iter().zip(weights).enumerate() {
            let unknown = CertificateError::UnknownVertex { pair };
            let q = setting.fixed.vertices().get(vertices.fixed as usize);
            let p = setting.moving.vertices().get(vertices.moving as usize);
            let (Some(&q), Some(&p)) = (q, p) else { return Err(unknown) };
            difference += (setting.fixed_matrix * q - setting.moving_matrix * p) * weight;
        }
        let upper = difference.dot(setting.unit) / setting.direction.length();
        let residual = (difference - setting.direction * upper).length();
        // Grazing contacts may miss by the widening along both lateral axes.
        let tolerance = setting.noise().residual();
        if residual <= tolerance {
            Ok(upper)
        } else {
            Err(CertificateError::Residual { residual, tolerance })
        }
    }
}

impl Separation {
    /// Checks the separation against the two bodies, in `O(log n)`, and returns the margin that is
    /// really proven, in world units.
    ///
    /// Nothing of the solver is used: two support points. Bodies, poses and direction must be those
    /// of the query.
    ///
    /// # Errors
    /// What the certificate fails to prove.
    ///
    /// ```
    /// # use colltrans::glam::DVec3;
    /// # use colltrans::{ConvexPolyhedron, Outcome, Pose, cast};
    /// let point = ConvexPolyhedron::from_points(&[DVec3::ZERO])?;
    /// let beside = Pose::from_translation(DVec3::new(-5.0, 2.0, 0.0))?;
    /// let world = Pose::IDENTITY;
    /// let Outcome::Separated(separated) = cast(&point, &beside, &point, &world, DVec3::X)? else {
    ///     unreachable!("it passes two units beside")
    /// };
    /// let margin = separated.certificate.verify(&point, &beside, &point, &world, DVec3::X)?;
    /// assert!(margin > 0.0 && margin <= 2.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn verify(
        &self,
        moving: &ConvexPolyhedron,
        moving_pose: &Pose,
        fixed: &ConvexPolyhedron,
        fixed_pose: &Pose,
        direction: DVec3,
    ) -> Result<f64, CertificateError> {
        let setting = Setting::new(moving, moving_pose, fixed, fixed_pose, direction)?;
        let normal = self.normal;
        let is_unit = (normal.length() - 1.0).abs() <= noise::UNIT_VECTOR;
        if !is_unit || normal.dot(setting.unit).abs() > noise::UNIT_VECTOR {
            return Err(CertificateError::Normal { normal });
        }
        let margin = distance_along(&setting, normal);
        let tolerance = setting.noise().point();
        let claimed = self.margin;
        if margin > 0.0 && claimed > 0.0 && claimed <= margin + tolerance {
            Ok(margin)
        } else {
            Err(CertificateError::Bound { proven: margin, claimed, tolerance })
        }
    }
}
