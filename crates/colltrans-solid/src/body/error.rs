//! Why no solid could be built.

use glam::DVec3;
use thiserror::Error;

use colltrans_convex::setting::error::QueryError;

/// Why a [`Solid`](super::Solid) was refused: what is wrong, where, and how often.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum SolidError {
    /// There are no facets with an area.
    #[error("the mesh has no facets with an area")]
    Empty,
    /// A point or a segment in place of a body with facets.
    #[error(
        "a {what} has no area, which this question needs; casts, distances, motions and scenes accept a \
         {what} as it is, and a small box around it is accepted everywhere"
    )]
    NoArea {
        /// `point` or `segment`.
        what: &'static str,
    },
    /// More than 32-bit indices can number.
    #[error("{count} facets were given; at most {limit} are supported")]
    TooMany {
        /// Number of facets given.
        count: usize,
        /// Number of facets supported.
        limit: usize,
    },
    /// A coordinate is NaN, infinite or outside the range in which the predicates are exact.
    #[error(
        "vertex {vertex} = {:?} is not finite or has a coordinate outside the exact range \
         (0, or a magnitude from 2^-200 to 2^200)",
        .point.to_array()
    )]
    Coordinate {
        /// Index of the vertex.
        vertex: usize,
        /// The vertex as given.
        point: DVec3,
    },
    /// A facet names a vertex that does not exist.
    #[error("facet {facet} names vertex {vertex}, but there are only {vertices} vertices")]
    UnknownVertex {
        /// Index of the facet.
        facet: usize,
        /// The index that does not exist.
        vertex: usize,
        /// Number of vertices.
        vertices: usize,
    },
    /// Edges with a facet on one side only: see [`Solid::from_open_mesh`](crate::Solid::from_open_mesh).
    #[error(
        "the surface is open: {count} edges have a facet on one side only, the first from vertex \
         {from} to vertex {to} of facet {facet}; one that is open on purpose, as a scan is, has to be \
         called open"
    )]
    Open {
        /// How many edges.
        count: usize,
        /// Start of the first one, along its facet.
        from: usize,
        /// Its end.
        to: usize,
        /// The facet on the side that has one.
        facet: usize,
    },
    /// Edges along which neighbouring facets run in the same direction.
    #[error(
        "{count} edges have facets that are oriented against each other, the first between \
         vertices {from} and {to} of facet {facet}"
    )]
    Inconsistent {
        /// How many edges.
        count: usize,
        /// One end of the first one.
        from: usize,
        /// Its other end.
        to: usize,
        /// A facet at it.
        facet: usize,
    },
    /// A polygon that crosses itself: it has no triangulation.
    #[error("facet {facet} is a polygon that crosses itself or folds back")]
    Polygon {
        /// Index of the facet.
        facet: usize,
    },
    /// An amount to shrink or grow by that is negative, not finite or out of range.
    #[error("the amount {amount} to shrink or grow by is negative, not finite or out of range")]
    Amount {
        /// The amount as given.
        amount: f64,
    },
}

impl From<SolidError> for QueryError {
    fn from(error: SolidError) -> Self {
        Self::NoSolid { reason: error.to_string() }
    }
}
