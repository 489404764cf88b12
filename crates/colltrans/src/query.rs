//! The public queries, each a one-off function.

use glam::DVec3;

use crate::error::QueryError;
use crate::outcome::{Clearance, ContactRange, Outcome, Solver};
use crate::polyhedron::ConvexPolyhedron;
use crate::pose::Pose;

/// Choices of a query; the default is right for almost everyone.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Options {
    /// How the search is narrowed.
    pub solver: Solver,
    /// Sideways overlap (world units) up to which a contact counts as grazing. `0`, the default, stands for the rounding
    /// error of the configuration, which is the least that is ever used.
    pub graze_tolerance: f64,
}

/// How far `moving` can translate along `direction` before it touches `fixed`.
pub fn cast(
    moving: &ConvexPolyhedron,
    moving_pose: &Pose,
    fixed: &ConvexPolyhedron,
    fixed_pose: &Pose,
    direction: DVec3,
) -> Result<Outcome, QueryError> {
    cast_with(moving, moving_pose, fixed, fixed_pose, direction, &Options::default())
}

/// [`cast`] with [`Options`].
pub fn cast_with(
    moving: &ConvexPolyhedron,
    moving_pose: &Pose,
    fixed: &ConvexPolyhedron,
    fixed_pose: &Pose,
    direction: DVec3,
    options: &Options,
) -> Result<Outcome, QueryError> {
    let _ = (moving, moving_pose, fixed, fixed_pose, options);
    Err(QueryError::Direction { direction })
}

/// All translations along `direction` at which the bodies meet.
pub fn contact_range(
    moving: &ConvexPolyhedron,
    moving_pose: &Pose,
    fixed: &ConvexPolyhedron,
    fixed_pose: &Pose,
    direction: DVec3,
    options: &Options,
) -> Result<ContactRange, QueryError> {
    let _ = (moving, moving_pose, fixed, fixed_pose, options);
    Err(QueryError::Direction { direction })
}

/// How far `moving` can move from where it is along `direction`.
pub fn clearance(
    moving: &ConvexPolyhedron,
    moving_pose: &Pose,
    fixed: &ConvexPolyhedron,
    fixed_pose: &Pose,
    direction: DVec3,
    options: &Options,
) -> Result<Clearance, QueryError> {
    let _ = (moving, moving_pose, fixed, fixed_pose, options);
    Err(QueryError::Direction { direction })
}
