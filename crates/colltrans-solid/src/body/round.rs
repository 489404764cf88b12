//! Rounded solids: a solid, the *core*, swept by a ball.
//!
//! Notation: the body is `K + B(r)`, all points at a distance of at most the radius `r` from the core `K`. The distance
//! of two rounded bodies is that of their cores less both radii, whether the cores are convex or not. Therefore each
//! query about rounded solids is a query about their cores with a gap:
//! [`TwoBodies::core_gap_bounds`](colltrans_convex::setting::TwoBodies::core_gap_bounds).

use super::{Solid, SolidError};
use colltrans_convex::body::DerivedDataSlot;
use colltrans_kernel::range::{MAX_MAGNITUDE, MIN_MAGNITUDE};

impl Solid {
    /// Returns the solid swept by a ball: all points at a distance of at most `radius` from it. A solid that is
    /// already rounded is rounded further, by the rounded sum of the radii.
    ///
    /// Vertices, facets and features of the result are those of the core, the solid without radius. The mathematical
    /// shape is exact: nothing is tessellated. Casts, distances, motions, paths and scenes accept the result. A
    /// tolerance offsets the core inwards and leaves the radius unchanged. Offsets ([`Self::shrunk`]), unions
    /// ([`Self::from_pieces`]) and removal queries refuse it with [`SolidError::Rounded`].
    ///
    /// # Errors
    /// [`SolidError::Radius`] if the radius is negative, not finite or outside the exact range, or without the feature
    /// `min-gap` not 0.
    ///
    /// ```
    /// use colltrans::glam::DVec3;
    /// use colltrans::solid::SolidCast;
    /// use colltrans::{Cast, ConvexPolyhedron, Pose, Solid};
    ///
    /// // A ball of radius 1 falls into the corner of a step with rounded edges.
    /// let low = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::new(4.0, 2.0, 1.0))?;
    /// let high = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::new(2.0, 2.0, 3.0))?;
    /// let step = Solid::from_pieces([&low, &high])?.rounded(0.25)?;
    /// let ball = ConvexPolyhedron::sphere(DVec3::ZERO, 1.0)?;
    /// let above = Pose::from_translation(DVec3::new(3.5, 1.0, 9.0))?;
    /// let down = Cast::between(ball.at(above), step.at(Pose::IDENTITY), DVec3::NEG_Z)?;
    /// let distance = down.clearance()?.distance().expect("the step is below");
    /// assert!((distance - (9.0 - 1.0 - 1.25)).abs() < 1e-12);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn rounded(self, radius: f64) -> Result<Self, SolidError> {
        let sum = self.radius + radius;
        let most = if cfg!(feature = "min-gap") { MAX_MAGNITUDE } else { 0.0 };
        let is_sound = radius == 0.0 || (MIN_MAGNITUDE..=most).contains(&radius);
        if !is_sound || sum > most {
            return Err(SolidError::Radius { radius });
        }
        // Data that other crates derive from the body do not fit the new one.
        Ok(Self { radius: sum, kept: DerivedDataSlot::default(), ..self })
    }

    /// Returns the radius of the ball that sweeps the solid, in the unit of the input; 0 unless it is
    /// [rounded](Self::rounded).
    #[inline]
    pub fn radius(&self) -> f64 {
        // Without the feature no body is rounded, and the compiler removes code that only a radius reaches.
        if cfg!(feature = "min-gap") { self.radius } else { 0.0 }
    }
}

/// Returns an error for a rounded body, for operations that are not defined for it.
///
/// # Errors
/// [`SolidError::Rounded`] if the radius is not 0.
pub fn check_is_not_rounded(radius: f64) -> Result<(), SolidError> {
    if radius == 0.0 { Ok(()) } else { Err(SolidError::Rounded { radius }) }
}
