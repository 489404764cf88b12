//! Errors of the construction of solids.

use glam::DVec3;
use thiserror::Error;

use colltrans_convex::setting::error::QueryError;

/// Why a [`Solid`](super::Solid) could not be built: the defect, its place, and the number of such defects.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum SolidError {
    /// The mesh has no facet with an area.
    #[error(
        "the mesh has no facets with an area; accepted: at least one facet whose corners are not on one line"
    )]
    Empty,
    /// A point or a segment, given to a query that requires facets.
    #[error(
        "a {what} has no area, which this query requires; casts, distances, motions and scenes accept a \
         {what}, and all queries accept a small box around it"
    )]
    NoArea {
        /// `point` or `segment`.
        what: &'static str,
    },
    /// The body is rounded, and the operation is defined for polyhedra only.
    #[error(
        "a body is rounded by a radius of {radius:?}, for which this is not defined; casts, distances, motions, \
         paths and scenes accept it"
    )]
    Rounded {
        /// Radius of the body.
        radius: f64,
    },
    /// The radius of a rounded body is negative, not finite or out of range, or the feature `min-gap` is missing.
    #[error(
        "invalid radius {radius:?}; accepted: 0, or 2^-200 to 2^200 with the feature `min-gap`"
    )]
    Radius {
        /// The radius as given.
        radius: f64,
    },
    /// The mesh has more vertices, facets or corners than 32-bit indices support.
    #[error(
        "the mesh has {count} facets, triangles, vertices or corners; accepted: at most {limit}"
    )]
    TooMany {
        /// Largest of the numbers of vertices, facets, triangles and corners.
        count: usize,
        /// Maximum number that is supported.
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
    /// A facet has a vertex index that does not exist.
    #[error(
        "facet {facet} names vertex {vertex}, but there are only {vertices} vertices, counted from 0"
    )]
    UnknownVertex {
        /// Index of the facet.
        facet: usize,
        /// The invalid vertex index.
        vertex: usize,
        /// Number of vertices.
        vertices: usize,
    },
    /// Edges with a facet on one side only; [`Solid::from_open_mesh`](crate::Solid::from_open_mesh) accepts them.
    #[error(
        "the surface is open: {count} edges have a facet on one side only, the first from vertex \
         {from} to vertex {to} of facet {facet}; close it, or declare the surface as open if it is a \
         sheet or a scan"
    )]
    Open {
        /// Number of such edges.
        count: usize,
        /// Start vertex of the first such edge, along its facet.
        from: usize,
        /// End vertex of this edge.
        to: usize,
        /// The facet at this edge.
        facet: usize,
    },
    /// Edges at which adjacent facets have inconsistent orientations.
    #[error(
        "{count} edges have facets with inconsistent orientations, the first between vertices {from} \
         and {to} of facet {facet}; accepted: all facets counter-clockwise as seen from outside"
    )]
    Inconsistent {
        /// Number of such edges.
        count: usize,
        /// One end of the first such edge.
        from: usize,
        /// The other end of this edge.
        to: usize,
        /// A facet at this edge.
        facet: usize,
    },
    /// A polygon that crosses itself and therefore has no triangulation.
    #[error(
        "facet {facet} is a polygon that crosses itself or folds back; divide it into simple polygons"
    )]
    Polygon {
        /// Index of the facet.
        facet: usize,
    },
    /// An offset that is negative, not finite, or moves coordinates out of range.
    #[error(
        "invalid amount {amount} to shrink or grow by; accepted: finite, not negative, in range"
    )]
    Amount {
        /// The amount as given.
        amount: f64,
    },
}

impl From<SolidError> for QueryError {
    fn from(error: SolidError) -> Self {
        Self::NotASolid { reason: error.to_string() }
    }
}
