//! Proof files of the findings of an audit.
//!
//! - Apart: the distance. Touching: the distance, and the depth, whose upper bound is the length of a translation that
//!   separates the parts.
//! - Interfering and contained: the depth and the common part. If the depth is unknown, as for open surfaces, the distance
//!   proves a common point.
//! - Each file contains both parts, at their places in the assembly. A thread holds one proof at a time.

#[cfg(feature = "proofs")]
mod prove;

use super::AuditedPair;

#[cfg(feature = "proofs")]
pub use prove::prove_pairs;

/// What a proof file of a pair claims.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum ProofClaim {
    /// Bounds of the distance; the lower one is 0 if the parts touch or overlap.
    Distance,
    /// Bounds of the depth.
    Depth,
    /// The volume, the box and a point of the common part, and the relation of the parts.
    CommonPart,
}

impl ProofClaim {
    /// Returns the name in answers.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Distance => "distance",
            Self::Depth => "depth",
            Self::CommonPart => "common_part",
        }
    }
}

/// A proof of a finding.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct PairProof {
    /// What the proof claims.
    pub claim: ProofClaim,
    /// Name of the file; the reason if there is no proof.
    pub file: Result<String, String>,
}

impl AuditedPair {
    /// Iterates over the names of the proof files.
    pub fn proof_files(&self) -> impl Iterator<Item = &str> {
        self.proofs.iter().filter_map(|proof| proof.file.as_deref().ok())
    }
}
