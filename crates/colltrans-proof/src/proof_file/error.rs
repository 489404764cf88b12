//! Errors of proof files and of their checks.

use thiserror::Error;

use colltrans_convex::answer::CertificateError;
use colltrans_convex::cast::case_file::json_error_message;
use colltrans_convex::setting::error::QueryError;
use colltrans_motion::MotionProofError;
use colltrans_motion::path::{PathError, PathProofError};
use colltrans_solid::proof::CommonPartError;

/// Name of the format.
pub(super) const FORMAT: &str = "colltrans proof";
/// Version of the format.
pub(super) const VERSION: u64 = 2;

/// Reason why a text is not a proof file, or an answer has no proof.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ProofFileError {
    /// The text is not JSON, or a part is missing.
    #[error("not a saved proof: {}", json_error_message(.0))]
    Syntax(serde_json::Error),
    /// An object that must have one of several keys has none or several of them.
    #[error(
        "not a saved proof: line {}, column {}: the object needs exactly one key; \
         a proof has one placement, one query and one statement", .0.line(), .0.column()
    )]
    Choice(serde_json::Error),
    /// The file has another format.
    #[error(
        "the format is {found:?}, not {:?}; --save-proof writes the files that are accepted",
        FORMAT
    )]
    Format {
        /// Format that the file names.
        found: String,
    },
    /// The file has another version.
    #[error("the version of the format is {}, not {}", .found.map_or("missing".into(), |of| of.to_string()), VERSION)]
    Version {
        /// Version that the file names, if any.
        found: Option<u64>,
    },
    /// A body is invalid.
    #[error("body {body}: {error}")]
    Body {
        /// Index of the body in the file.
        body: usize,
        /// The error: a `BuildError` of a convex body, or a `SolidError` of a solid.
        error: Box<dyn std::error::Error + Send + Sync>,
    },
    /// A solid cannot be rebuilt from its own facets.
    #[error("body {body}: {}", CHANGED)]
    Changed {
        /// Index of the body in the file; 0 is the moving one of two.
        body: usize,
    },
    /// A place refers to a body that does not exist.
    #[error("a place refers to body {body}; the file has {known} bodies, counted from 0")]
    NoBody {
        /// Index in the place.
        body: usize,
        /// Number of bodies.
        known: usize,
    },
    /// The direction or an option is rejected.
    #[error(transparent)]
    Query(#[from] QueryError),
    /// A path is rejected.
    #[error(transparent)]
    Path(#[from] PathError),
    /// A common part has no proof.
    #[error(transparent)]
    CommonPart(#[from] CommonPartError),
    /// The statement does not fit the query or the bodies, or claims nothing.
    #[error(
        "the statement must make a claim and fit the query, the placement and the bodies: a cast has \
         contacts or a separation of two convex bodies, or a clearance of two solids; a pair has a distance or a \
         depth of two convex bodies, or a solid_distance, solid_depth, solid_common_part or free_directions of two \
         solids; a scene has nearest, within or scene_clearance; motions have motions, one for each pair; a path has a path"
    )]
    Statement,
    /// The file has no pair of bodies, and therefore no claim.
    #[error("there is no pair of bodies; a proof needs at least one")]
    NoPairs,
    /// The proofs of several pairs belong to different queries.
    #[error(
        "pair {pair} is a pair of convex bodies with a larger minimum gap than another pair, or a pair of solids with \
         a tolerance; of several pairs, all convex ones need the smallest minimum gap, and solids need the tolerance 0"
    )]
    Pairs {
        /// Index of the pair.
        pair: usize,
    },
    /// A name belongs to no body, or to several.
    #[error(
        "{name:?} does not name exactly one body; give each body a name of its own, and use these names"
    )]
    Name {
        /// The name.
        name: String,
    },
}

/// Reason why a proof is not valid.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum ProofError {
    /// A certificate does not prove its claim.
    #[error(transparent)]
    Certificate(#[from] CertificateError),
    /// A proof of a motion is not valid.
    #[error(transparent)]
    Motion(#[from] MotionProofError),
    /// A proof of a path is not valid.
    #[error(transparent)]
    Path(#[from] PathProofError),
    /// A proof of a common part is not valid.
    #[error(transparent)]
    CommonPart(#[from] CommonPartError),
    /// A piece of a body is inside out.
    #[error(
        "a shell of the {} body is inside out; a common part is proven only for facets that point outwards",
        if *is_moving { "moving" } else { "fixed" }
    )]
    InsideOut {
        /// Whether it is the moving body.
        is_moving: bool,
    },
    /// A cut names a facet that does not exist or has no area.
    #[error("a cut is in the plane of facet {facet}, which does not exist or has no area")]
    UnknownFacet {
        /// Index of the facet in the file.
        facet: u32,
    },
    /// A claim is stronger than the proof.
    #[error(
        "the claimed bounds of the first contact are {} and {}, the proven ones {} and {}",
        .claimed[0], .claimed[1], .proven[0], .proven[1]
    )]
    ClaimTooStrong {
        /// Claimed bounds.
        claimed: [f64; 2],
        /// Proven bounds.
        proven: [f64; 2],
    },
    /// The parts of a solid differ from those that its facets determine.
    #[error("body {body}: {}", CHANGED)]
    Parts {
        /// Index of the body in the file.
        body: usize,
    },
    /// The bodies or the query are invalid.
    #[error("{0}")]
    Setting(String),
}

const CHANGED: &str =
    "its facets or its stored parts differ from those that are rebuilt from its facets";

impl From<QueryError> for ProofError {
    fn from(error: QueryError) -> Self {
        Self::Certificate(error.into())
    }
}

impl From<ProofFileError> for ProofError {
    fn from(error: ProofFileError) -> Self {
        match error {
            ProofFileError::Query(error) => error.into(),
            other => Self::Setting(other.to_string()),
        }
    }
}
