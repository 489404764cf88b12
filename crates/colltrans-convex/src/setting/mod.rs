//! The setting of a query: two placed bodies, and of a cast a direction, in a frame that all solvers
//! share.

pub mod error;
pub(crate) mod minkowski;
mod two_bodies;

use derive_where::derive_where;
use std::ops::Deref;

use glam::DVec3;

use crate::body::{ConvexPolyhedron, Placed, VertexId};
use crate::setting::error::QueryError;
use colltrans_kernel::range::{MAX_MAGNITUDE, in_exact_range};
pub use two_bodies::TwoBodies;

/// One vertex of each body.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct VertexPair {
    /// Of the moving body.
    pub moving: VertexId,
    /// Of the fixed body.
    pub fixed: VertexId,
}

impl VertexPair {
    #[inline]
    #[doc(hidden)]
    pub const fn of(moving: u32, fixed: u32) -> Self {
        Self { moving: VertexId(moving), fixed: VertexId(fixed) }
    }

    /// As searches walk on: of the moving and of the fixed body.
    #[inline]
    pub const fn numbers(self) -> [u32; 2] {
        [self.moving.0, self.fixed.0]
    }
}

/// # Errors
/// A direction that is zero, not finite or out of range.
#[inline]
pub fn check_direction(direction: DVec3) -> Result<(), QueryError> {
    if direction == DVec3::ZERO || !in_exact_range(direction) {
        return Err(QueryError::Direction { direction });
    }
    Ok(())
}

/// # Errors
/// A length that is negative or not a number.
#[inline]
pub fn check_length(length: f64) -> Result<(), QueryError> {
    if length.is_nan() || length < 0.0 {
        return Err(QueryError::Length { length });
    }
    Ok(())
}

/// # Errors
/// A gap that is negative, not finite or beyond the range of coordinates; any but 0 without the feature.
#[inline]
pub fn check_keep(gap: f64) -> Result<(), QueryError> {
    let most = if cfg!(feature = "keep") { MAX_MAGNITUDE } else { 0.0 };
    if (0.0..=most).contains(&gap) { Ok(()) } else { Err(QueryError::Keep { gap }) }
}

/// Two placed bodies and a direction.
#[derive(Debug)]
#[derive_where(Clone, Copy)]
pub struct Setting<'a, B = ConvexPolyhedron> {
    /// The bodies.
    pub bodies: TwoBodies<'a, B>,
    /// The direction as given.
    pub direction: DVec3,
    /// Its length.
    pub length: f64,
    /// `direction` at length 1.
    pub unit: DVec3,
}

/// What is of the bodies alone is asked of them.
impl<'a, B> Deref for Setting<'a, B> {
    type Target = TwoBodies<'a, B>;

    #[inline(always)]
    #[expect(clippy::inline_always, reason = "it is a field")]
    fn deref(&self) -> &Self::Target {
        &self.bodies
    }
}

impl<'a, B> Setting<'a, B> {
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "passed through memory it stalls its reader")]
    pub(crate) fn new(
        moving: Placed<'a, B>,
        fixed: Placed<'a, B>,
        direction: DVec3,
    ) -> Result<Self, QueryError> {
        Self::of(TwoBodies::new(moving, fixed), direction)
    }

    /// Of bodies that are placed.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "passed through memory it stalls its reader")]
    pub fn of(bodies: TwoBodies<'a, B>, direction: DVec3) -> Result<Self, QueryError> {
        check_direction(direction)?;
        let length = direction.length();
        Ok(Self { bodies, direction, length, unit: direction * (1.0 / length) })
    }

    /// The same bodies, and the direction turned round.
    #[inline]
    pub(crate) fn reversed(&self) -> Self {
        Self { direction: -self.direction, unit: -self.unit, ..*self }
    }
}

impl Setting<'_> {
    /// How far two points, in the frames of the moving and of the fixed body, are apart sideways:
    /// for those that met in an earlier query, what poses and direction have changed since.
    pub(crate) fn lateral_displacement(&self, [p, q]: [DVec3; 2]) -> f64 {
        let apart = self.fixed_matrix * q + self.offset - self.moving_matrix * p;
        apart.reject_from_normalized(self.unit).length()
    }
}
