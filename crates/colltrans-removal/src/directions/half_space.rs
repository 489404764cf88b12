//! Free directions of rounded convex bodies in contact: a half-space.
//!
//! Notation: `M` is the Minkowski difference `{q - p}` of the cores, `R` the sum of the radii less the tolerance, `n`
//! the unit normal of a plane between the cores, from the moving to the fixed one. A direction `u` is blocked if the
//! ray along it from the origin meets the interior of `M + B(R)`.
//!
//! - *Free*: if the plane keeps the cores `R` apart, every `u` with `n . u <= 0` is free, because the distance along
//!   `n` does not decrease.
//! - *Blocked*: let `m` be a point of `M` with `R <= |m| <= d`. The ray along `u` meets the interior of the ball of
//!   radius `R` about `m` if the cosine of the angle between `u` and `m` exceeds `sqrt(d^2 - R^2) / d`.
//!
//! In contact `d` is `R`, and `m` is parallel to `n`: the free directions are the half-space. Rounding and the
//! tolerance make `d` larger than `R` by a little. The directions between the two sets are undecided.

use std::cmp::Ordering;

use glam::DVec3;

use super::error::FreeError;
use colltrans_convex::answer::{CertificateError, NearPoints};
use colltrans_convex::body::Placed;
use colltrans_convex::pair::Pair;
use colltrans_convex::setting::check_direction;
use colltrans_convex::setting::error::QueryError;
use colltrans_kernel::integer::{Integer, LARGE_LIMBS};

/// All directions along which a rounded convex body can leave another convex body that it touches.
#[derive(Debug, Clone, Copy)]
pub struct FreeHalfSpace<'a> {
    pair: Pair<'a>,
    tolerance: f64,
    normal: DVec3,
    near: NearPoints,
    /// The point of the difference of the cores, and the cosine of the angle to it within which directions are blocked.
    blocked_cone: (DVec3, f64),
}

/// Classification of a direction by [`FreeHalfSpace`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum HalfSpaceVerdict {
    /// No translation along the direction is blocked.
    Free,
    /// The bodies overlap after a translation along the direction.
    Blocked,
    /// The direction is within rounding error and tolerance of the border.
    Undecided,
}

impl<'a> FreeHalfSpace<'a> {
    /// Computes the free directions of two convex bodies in contact, of which at least one is rounded. Contact means
    /// that they overlap by at most `tolerance`, a length, and are at most `tolerance` apart. The sum of the radii is
    /// reduced by it.
    ///
    /// Rounded bodies that are apart block a cone with a curved border, which has no finite description:
    /// [`Cast::clearance`](colltrans_convex::cast::Cast::clearance) answers single directions. Bodies that overlap have
    /// no free direction. [`FreeDirections`](super::FreeDirections) answers for bodies that are not rounded.
    ///
    /// # Errors
    /// - [`QueryError::Tolerance`] if the tolerance is negative, or not below the sum of the radii.
    /// - [`FreeError::NotRounded`], [`FreeError::Apart`] and [`FreeError::Deep`] for other bodies.
    /// - [`FreeError::NotProven`] if the tolerance is about as small as the rounding errors.
    /// - The errors of [`Pair::distance`] and [`Pair::depth`].
    ///
    /// ```
    /// use colltrans::glam::DVec3;
    /// use colltrans::removal::directions::{FreeHalfSpace, HalfSpaceVerdict};
    /// use colltrans::{ConvexPolyhedron, Pose};
    ///
    /// // A ball on a table.
    /// let ball = ConvexPolyhedron::sphere(DVec3::ZERO, 0.5)?;
    /// let table = ConvexPolyhedron::cuboid(DVec3::splat(-1.0), DVec3::splat(1.0))?;
    /// let above = Pose::from_translation(DVec3::new(0.25, 0.5, 1.5))?;
    /// let free = FreeHalfSpace::compute(ball.at(above), table.at(Pose::IDENTITY), 1e-12)?;
    /// assert_eq!(free.normal(), DVec3::NEG_Z);
    /// assert_eq!(free.classify(DVec3::new(1.0, 0.0, 1.0))?, HalfSpaceVerdict::Free);
    /// assert_eq!(free.classify(DVec3::X)?, HalfSpaceVerdict::Free);
    /// assert_eq!(free.classify(DVec3::new(1.0, 0.0, -0.01))?, HalfSpaceVerdict::Blocked);
    /// free.verify()?;
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn compute(
        moving: Placed<'a>,
        fixed: Placed<'a>,
        tolerance: f64,
    ) -> Result<Self, FreeError> {
        let pair = Pair::new(moving, fixed)?;
        let bodies = &pair.bodies;
        if !bodies.is_rounded() {
            return Err(FreeError::NotRounded);
        }
        let [radii, _] = bodies.core_gap_bounds(0.0);
        if !(0.0..radii).contains(&tolerance) {
            return Err(QueryError::Tolerance { tolerance }.into());
        }
        let distance = pair.distance()?;
        if distance.lower > tolerance {
            return Err(FreeError::Apart { distance: distance.lower });
        }
        let normal = match distance.normal {
            Some(normal) => normal,
            None => -pair.depth()?.direction,
        };
        let free = Self {
            pair,
            tolerance,
            normal,
            near: distance.near,
            blocked_cone: blocked_cone(&pair, &distance.near, tolerance),
        };
        if let Err(error) = free.verify() {
            let depth = pair.depth()?;
            return Err(if depth.lower > tolerance {
                FreeError::Deep { depth: depth.upper, tolerance }
            } else {
                error.into()
            });
        }
        Ok(free)
    }

    /// Returns the unit contact normal in the world, from the moving to the fixed body. Directions that do not have a
    /// positive product with it are free.
    pub fn normal(&self) -> DVec3 {
        self.normal
    }

    /// Classifies a direction of any length. The decision that it is free is exact.
    ///
    /// # Errors
    /// [`QueryError::Direction`] if the direction is zero, not finite or out of range.
    pub fn classify(&self, direction: DVec3) -> Result<HalfSpaceVerdict, QueryError> {
        check_direction(direction)?;
        let product = (0..3).fold(Integer::<LARGE_LIMBS>::ZERO, |sum, k| {
            sum.add(&Integer::exact_product(self.normal[k], direction[k]))
        });
        if product.sign().is_some_and(Ordering::is_le) {
            return Ok(HalfSpaceVerdict::Free);
        }
        let (axis, cosine) = self.blocked_cone;
        let is_blocked = direction.normalize().dot(axis) > cosine;
        Ok(if is_blocked { HalfSpaceVerdict::Blocked } else { HalfSpaceVerdict::Undecided })
    }

    /// Checks that the plane keeps the bodies apart, up to the tolerance, and that the nearest points prove their
    /// contact.
    ///
    /// # Errors
    /// The reason why one of them does not.
    pub fn verify(&self) -> Result<(), CertificateError> {
        let Self { pair, tolerance, normal, near, .. } = self;
        let proven = pair.bodies.proven_gap(*normal);
        if proven < -tolerance {
            return Err(CertificateError::Bound { proven, claimed: -tolerance });
        }
        let apart = pair.verify(near)?;
        if apart > *tolerance {
            return Err(CertificateError::Bound { proven: apart, claimed: *tolerance });
        }
        Ok(())
    }
}

/// Returns the unit vector along the point of the difference of the cores, and a bound on the cosine of the angle to it
/// above which directions are blocked. Errors are added to the cosine.
fn blocked_cone(pair: &Pair, near: &NearPoints, tolerance: f64) -> (DVec3, f64) {
    let bodies = &pair.bodies;
    let [least, most] = bodies.core_gap_bounds(0.0);
    let radius = (least - tolerance).next_down();
    let distance = (most + near.distance).next_up();
    let [p, q] = bodies.weighted_points(&near.pairs, &near.weights);
    let point = bodies.fixed_matrix * q - bodies.moving_matrix * p + bodies.offset;
    let cosine = ((distance - radius) * (distance + radius)).sqrt() / distance;
    // The cosine changes by at most the angle by which the rounded point is off.
    let error = 2.0 * bodies.noise().point_error() / radius + 16.0 * f64::EPSILON;
    (point.normalize_or_zero(), cosine + error)
}
