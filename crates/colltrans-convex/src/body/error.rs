//! Errors of the construction of bodies. Each states what is wrong, where, and the measured value.

use glam::DVec3;
use thiserror::Error;

pub use colltrans_kernel::error::TopologyError;

/// Error of the construction of a [`ConvexPolyhedron`](crate::ConvexPolyhedron).
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum BuildError {
    /// The list of points is empty.
    #[error("no points given; a body needs at least one")]
    NoPoints,
    /// There are more points than the limit, which keeps vertex and half-edge numbers within 31 bits.
    #[error("{count} points given; at most {limit} are supported")]
    TooManyPoints {
        /// Number of points given.
        count: usize,
        /// Maximum number of points.
        limit: usize,
    },
    /// A coordinate is NaN or infinite.
    #[error("point {index} is not finite: {:?}", .point.to_array())]
    NotFinite {
        /// Index of the point in the input.
        index: usize,
        /// The point as given.
        point: DVec3,
    },
    /// A coordinate is outside the range in which the predicates are exact.
    #[error(
        "point {index} = {:?} has a coordinate outside the exact range \
         (0, or a magnitude from 2^-200 to 2^200); rescale the input",
        .point.to_array()
    )]
    OutOfRange {
        /// Index of the point in the input.
        index: usize,
        /// The point as given.
        point: DVec3,
    },
    /// Vertices and faces of a saved body do not belong to one convex body.
    #[error("{vertices} vertices and {faces} faces do not belong to one convex body")]
    NotABody {
        /// Number of vertices.
        vertices: usize,
        /// Number of faces.
        faces: usize,
    },
    /// The faces of the mesh do not form one closed, consistently oriented surface.
    #[error(transparent)]
    Topology(#[from] TopologyError),
    /// The mesh is closed but its faces are oriented inwards.
    #[error("the faces are oriented inwards (signed volume {signed_volume:e}); reverse them")]
    InsideOut {
        /// Signed volume for the given orientation, in the cube of the input's unit.
        signed_volume: f64,
    },
    /// The mesh is closed but not convex.
    #[error(
        "the mesh is not convex: face {face} lies {depth:?} below the convex hull \
         (tolerated: {tolerance:?})"
    )]
    NotConvex {
        /// Index of the face that lies deepest below the convex hull.
        face: usize,
        /// Depth of this face below the convex hull, in the unit of the input.
        depth: f64,
        /// Maximum depth that is tolerated, in the unit of the input.
        tolerance: f64,
    },
    /// The amount to shrink or grow by is negative, not finite, or takes coordinates out of range.
    #[error(
        "invalid amount {amount} to shrink or grow by; accepted: finite, not negative, in range"
    )]
    Amount {
        /// The amount as given.
        amount: f64,
    },
    /// Nothing with a volume would remain of the shrunk body.
    #[error(
        "nothing remains of the body shrunk by {amount}: it contains no ball of this radius, but one \
         of radius {fits}"
    )]
    TooThin {
        /// The amount as given.
        amount: f64,
        /// Radius of a ball that the body contains, at least half of the largest such radius, up to rounding. It is
        /// 0 for a body of lower dimension.
        fits: f64,
    },
    /// A segment or a point cannot be grown because it has no faces.
    #[error(
        "a body of dimension {dimension} has no faces to move outwards; grow a polygon or a solid"
    )]
    NothingToMove {
        /// Dimension of the body.
        dimension: u8,
    },
    /// The radius of a rounded body is negative, not finite or out of range, or the feature `min-gap` is missing.
    #[error(
        "invalid radius {radius:?}; accepted: 0, or 2^-200 to 2^200 with the feature `min-gap`"
    )]
    Radius {
        /// The radius as given.
        radius: f64,
    },
    /// The operation is not defined for a rounded body.
    #[error("{operation} is not possible for a body that is rounded by a radius of {radius:?}")]
    Rounded {
        /// Name of the operation.
        operation: &'static str,
        /// Radius of the body.
        radius: f64,
    },
    /// The tolerated depth is negative or not a number.
    #[error("invalid tolerance {tolerance}; accepted: not negative")]
    Tolerance {
        /// The tolerance as given.
        tolerance: f64,
    },
}
