//! Why a file is no proof, and what of a proof does not hold.

use thiserror::Error;

use colltrans_convex::answer::CertificateError;
use colltrans_convex::cast::replay::json_error_message;
use colltrans_convex::setting::error::QueryError;
use colltrans_motion::MotionProofError;
use colltrans_motion::path::{PathError, PathProofError};

/// What a file calls itself.
pub(super) const FORMAT: &str = "colltrans proof";
/// The version of the format.
pub(super) const VERSION: u64 = 2;

/// Why a file is no proof, or an answer has none.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ProofFileError {
    /// It is not JSON, or lacks something.
    #[error("not a saved proof: {}", json_error_message(.0))]
    Syntax(serde_json::Error),
    /// An object has to name one thing, and names none or several.
    #[error(
        "not a saved proof: line {}, column {}: an object names none or several things where it has to name one; \
         a proof has one placement, one query and one statement", .0.line(), .0.column()
    )]
    Choice(serde_json::Error),
    /// It is a file of another kind.
    #[error(
        "the format is {found:?}, not {:?}; --save-proof writes the files that are accepted",
        FORMAT
    )]
    Format {
        /// The format that the file names.
        found: String,
    },
    /// It was written by another version.
    #[error("the version of the format is {}, not {}", .found.map_or("missing".into(), |of| of.to_string()), VERSION)]
    Version {
        /// The version that the file names, if it does.
        found: Option<u64>,
    },
    /// A body is none.
    #[error("body {body}: {error}")]
    Body {
        /// Its number in the file.
        body: usize,
        /// What is wrong with it: a `BuildError` of a convex body, a `SolidError` of a solid.
        error: Box<dyn std::error::Error + Send + Sync>,
    },
    /// A solid that its own facets do not make once more.
    #[error("body {body}: {}", CHANGED)]
    Changed {
        /// Its number in the file: 0 is the moving one of two.
        body: usize,
    },
    /// A place is that of a body that is not there.
    #[error("a place names the body {body}, and there are {known}, from 0 on")]
    NoBody {
        /// The one that is named.
        body: usize,
        /// How many there are.
        known: usize,
    },
    /// The direction or a choice is refused.
    #[error(transparent)]
    Query(#[from] QueryError),
    /// A path is refused.
    #[error(transparent)]
    Path(#[from] PathError),
    /// The statement is not one of such a query, or of such bodies, or it says nothing.
    #[error(
        "the statement has to say something, and to fit the query, the placement and the bodies: a cast has \
         contacts or a separation of two convex bodies, or a clearance of two solids; a pair has a distance or a \
         depth of two convex bodies, or a solid_distance or free_directions of two solids; a scene has nearest, \
         within or scene_clearance; motions have motions, one for each pair; a path has a path"
    )]
    Statement,
    /// There is no pair of bodies, so that nothing is said.
    #[error("there is no pair of bodies; a proof is about at least one")]
    NoPairs,
    /// Proofs of several pairs are of several questions.
    #[error(
        "pair {pair} keeps another gap than the others, or is one of solids that a tolerance shrinks; several \
         pairs are asked one question, of bodies as they are"
    )]
    Pairs {
        /// Its number.
        pair: usize,
    },
    /// A name that none of the bodies has, or several.
    #[error(
        "{name:?} is not the name of one of the bodies, or of several; each has one of its own"
    )]
    Name {
        /// That name.
        name: String,
    },
}

/// What of a proof does not hold.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum ProofError {
    /// A certificate does not prove what is claimed.
    #[error(transparent)]
    Certificate(#[from] CertificateError),
    /// A proof of a motion does not.
    #[error(transparent)]
    Motion(#[from] MotionProofError),
    /// A proof of a path does not.
    #[error(transparent)]
    Path(#[from] PathProofError),
    /// It says more than is proven.
    #[error(
        "it says that the first contact is between {} and {}, and proves {} and {}",
        .said[0], .said[1], .proven[0], .proven[1]
    )]
    Said {
        /// What it says.
        said: [f64; 2],
        /// What it proves.
        proven: [f64; 2],
    },
    /// The parts of a solid are not those that are made of its facets.
    #[error("body {body}: {}", CHANGED)]
    Parts {
        /// Its number in the file.
        body: usize,
    },
    /// What it is about cannot be asked.
    #[error("{0}")]
    Setting(String),
}

const CHANGED: &str =
    "its facets, or the parts that it has, are not those that are made of its facets";

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
