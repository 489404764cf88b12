//! Why bodies and poses are refused: each error says what is wrong, where, and by how much.

use glam::DVec3;
use thiserror::Error;

pub use colltrans_kernel::error::TopologyError;

/// Why no [`ConvexPolyhedron`](crate::ConvexPolyhedron) could be built.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum BuildError {
    /// The list of points was empty.
    #[error("no points were given")]
    NoPoints,
    /// More points than 32-bit indices can number.
    #[error("{count} points were given; at most {limit} are supported")]
    TooManyPoints {
        /// Number of points given.
        count: usize,
        /// Number of points supported.
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
    /// Vertices and faces of a saved body that do not belong together.
    #[error("{vertices} vertices and {faces} faces are not those of a convex body")]
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
        /// The signed volume that the orientation implies.
        signed_volume: f64,
    },
    /// The mesh is closed but not convex.
    #[error(
        "the mesh is not convex: face {face} lies {depth:?} below the convex hull \
         (tolerated: {tolerance:?})"
    )]
    NotConvex {
        /// The face that lies deepest below the convex hull.
        face: usize,
        /// How deep, in the units of the input.
        depth: f64,
        /// The depth that would have been tolerated.
        tolerance: f64,
    },
    /// An amount to shrink or grow by that is negative, not finite, or takes coordinates out of range.
    #[error("the amount {amount} to shrink or grow by is negative, not finite or out of range")]
    Amount {
        /// The amount as given.
        amount: f64,
    },
    /// A body to be shrunk of which nothing with a volume would be left.
    #[error(
        "shrunk by {amount} nothing is left of the body: it holds no ball of this radius, one of \
         radius {fits} it does"
    )]
    TooThin {
        /// The amount as given.
        amount: f64,
        /// The radius of a ball that the body holds, at least half of the largest one's, to within
        /// rounding; 0 for a body of lower dimension.
        fits: f64,
    },
    /// A segment or a point to be grown.
    #[error("a body of dimension {dimension} has no faces to be moved outwards")]
    NothingToMove {
        /// Its dimension.
        dimension: u8,
    },
    /// The depth to be tolerated is negative or not a number.
    #[error("the tolerance {tolerance} is negative or not a number")]
    Tolerance {
        /// The tolerance as given.
        tolerance: f64,
    },
}
