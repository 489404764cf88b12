//! The setting of a query: two placed bodies and, for a cast, a direction.
//!
//! Both are given in the *setting frame*, which all solvers share: the axes of the world, the origin at the
//! moving body's translation.

pub mod error;
pub(crate) mod minkowski;
mod two_bodies;

use derive_where::derive_where;
use std::ops::Deref;

use glam::DVec3;

use crate::body::{ConvexPolyhedron, Placed, VertexId};
use crate::setting::error::QueryError;
use colltrans_kernel::range::{MAX_MAGNITUDE, is_in_exact_range};
pub use two_bodies::TwoBodies;

/// A vertex of each body.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct VertexPair {
    /// Vertex of the moving body.
    pub moving: VertexId,
    /// Vertex of the fixed body.
    pub fixed: VertexId,
}

impl VertexPair {
    /// Builds a pair from the vertex indices in the moving and in the fixed body.
    #[inline]
    #[doc(hidden)]
    pub const fn from_indices(moving: u32, fixed: u32) -> Self {
        Self { moving: VertexId(moving), fixed: VertexId(fixed) }
    }

    /// Returns the vertex indices: `[moving, fixed]`.
    #[inline]
    pub const fn indices(self) -> [u32; 2] {
        [self.moving.0, self.fixed.0]
    }
}

/// Checks that a direction can be cast along.
///
/// # Errors
/// Returns [`QueryError::Direction`] if the direction is zero, not finite or has a component outside the
/// exact range.
#[inline]
pub fn check_direction(direction: DVec3) -> Result<(), QueryError> {
    if direction == DVec3::ZERO || !is_in_exact_range(direction) {
        return Err(QueryError::Direction { direction });
    }
    Ok(())
}

/// Checks a length with which a distance is compared.
///
/// # Errors
/// Returns [`QueryError::Length`] if the length is negative or not a number.
#[inline]
pub fn check_length(length: f64) -> Result<(), QueryError> {
    if length.is_nan() || length < 0.0 {
        return Err(QueryError::Length { length });
    }
    Ok(())
}

/// Checks a minimum gap, in world units.
///
/// # Errors
/// Returns [`QueryError::MinGap`] if the gap is negative, not finite or larger than [`MAX_MAGNITUDE`]. Without
/// the feature `min-gap`, any gap except 0 is an error.
#[inline]
pub fn check_min_gap(gap: f64) -> Result<(), QueryError> {
    let most = if cfg!(feature = "min-gap") { MAX_MAGNITUDE } else { 0.0 };
    if (0.0..=most).contains(&gap) { Ok(()) } else { Err(QueryError::MinGap { gap }) }
}

/// Two placed bodies and a direction.
#[derive(Debug)]
#[derive_where(Clone, Copy)]
pub struct Setting<'a, B = ConvexPolyhedron> {
    /// The placed bodies.
    pub bodies: TwoBodies<'a, B>,
    /// The direction as given.
    pub direction: DVec3,
    /// Length of `direction`.
    pub length: f64,
    /// Unit vector along `direction`.
    pub unit: DVec3,
}

/// Gives access to the methods of the two bodies, which do not depend on the direction.
impl<'a, B> Deref for Setting<'a, B> {
    type Target = TwoBodies<'a, B>;

    #[inline(always)]
    #[expect(clippy::inline_always, reason = "returns a field")]
    fn deref(&self) -> &Self::Target {
        &self.bodies
    }
}

impl<'a, B> Setting<'a, B> {
    /// Builds the setting of two placed bodies.
    ///
    /// Returns the error of [`check_direction`] if the direction is not admissible.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "a copy through memory stalls its reader")]
    pub(crate) fn new(
        moving: Placed<'a, B>,
        fixed: Placed<'a, B>,
        direction: DVec3,
    ) -> Result<Self, QueryError> {
        Self::from_bodies(TwoBodies::new(moving, fixed), direction)
    }

    /// Builds the setting of two bodies that are already in one frame.
    ///
    /// # Errors
    /// Returns [`QueryError::Direction`] if the direction is zero, not finite or out of range.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "a copy through memory stalls its reader")]
    pub fn from_bodies(bodies: TwoBodies<'a, B>, direction: DVec3) -> Result<Self, QueryError> {
        check_direction(direction)?;
        let length = direction.length();
        Ok(Self { bodies, direction, length, unit: direction * (1.0 / length) })
    }

    /// Returns the setting with the opposite direction.
    #[inline]
    pub(crate) fn reversed(&self) -> Self {
        Self { direction: -self.direction, unit: -self.unit, ..*self }
    }
}

impl Setting<'_> {
    /// Returns the distance of two points perpendicular to the direction, in world units.
    ///
    /// `p` is in the frame of the moving body, `q` in that of the fixed one. For points that touched in an
    /// earlier query, this distance measures the change of poses and direction since then.
    pub(crate) fn lateral_displacement(&self, [p, q]: [DVec3; 2]) -> f64 {
        let apart = self.fixed_matrix * q + self.offset - self.moving_matrix * p;
        apart.reject_from_normalized(self.unit).length()
    }
}
