//! Errors of queries about free directions.

use thiserror::Error;

use colltrans_convex::answer::CertificateError;
use colltrans_convex::setting::error::QueryError;
use colltrans_solid::solve::overlap::Overlap;

/// Reason why free directions cannot be computed or proven.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum FreeError {
    /// The bodies or options are rejected by a cast.
    #[error(transparent)]
    Query(#[from] QueryError),
    /// A body has an open shell. A facet edge-on to the direction blocks arcs of directions, which cells
    /// cannot represent.
    #[error("the {which} body has an open shell; free directions need closed bodies")]
    Open {
        /// `"moving"` or `"fixed"`.
        which: &'static str,
    },
    /// The bodies, each offset inwards by half the tolerance, overlap at the start, and the overlap is not
    /// ignored.
    #[error(
        "the bodies overlap at the start ({place}), so no direction is free; increase the tolerance or ignore the \
         start overlap"
    )]
    Overlapping {
        /// A common point.
        place: Overlap,
    },
    /// No body is rounded, so the free directions are not a half-space.
    #[error("no body is rounded: use FreeDirections")]
    NotRounded,
    /// Rounded bodies are apart. They block a cone with a curved border.
    #[error(
        "the rounded bodies are {distance} apart, and their blocked directions have a curved border: query the \
         clearance along single directions"
    )]
    Apart {
        /// A lower bound of the distance.
        distance: f64,
    },
    /// Rounded bodies overlap by more than the tolerance, so no direction is free.
    #[error(
        "the rounded bodies overlap by up to {depth}, more than the tolerance {tolerance}, so no direction is free; \
         increase the tolerance"
    )]
    Deep {
        /// An upper bound of the depth.
        depth: f64,
        /// The tolerance.
        tolerance: f64,
    },
    /// The search was cancelled.
    #[error("cancelled")]
    Cancelled,
    /// A claim of a proof does not hold.
    #[error("not proven: {0}")]
    NotProven(#[from] CertificateError),
}
