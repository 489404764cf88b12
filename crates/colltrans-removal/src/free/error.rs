//! Why free directions cannot be told.

use thiserror::Error;

use colltrans_convex::answer::CertificateError;
use colltrans_convex::setting::error::QueryError;
use colltrans_solid::solve::overlap::Overlap;

/// Why free directions cannot be told.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum FreeError {
    /// The bodies cannot be asked about.
    #[error(transparent)]
    Query(#[from] QueryError),
    /// A body has an open shell: what is on edge blocks arcs of directions, which are no cells.
    #[error("the {which} body has an open shell: free directions are told of closed bodies")]
    Open {
        /// `"moving"` or `"fixed"`.
        which: &'static str,
    },
    /// The bodies, shrunk by half the tolerance each, overlap where they are, and that is not to be ignored.
    #[error("the bodies overlap where they are, at {place:?}: no direction is free")]
    Overlapping {
        /// Where.
        place: Overlap,
    },
    /// It was cancelled.
    #[error("cancelled")]
    Cancelled,
    /// A proof that does not hold.
    #[error("not proven: {0}")]
    NotProven(#[from] CertificateError),
}
