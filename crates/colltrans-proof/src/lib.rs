//! Answers about collision translations as front ends write them ([`record`]), and proofs of answers with all that they
//! are about, as files.

#![allow(
    rustdoc::private_intra_doc_links,
    reason = "hidden modules are read with their private parts"
)]

#[cfg(feature = "json")]
mod proof_file;
pub mod record;

#[cfg(feature = "json")]
pub use proof_file::{
    Contacts, DistanceStatement, FreeStatement, MotionCase, MotionStatement, PathStatement,
    ProofError, ProofFile, ProofFileError, Proven, Slide, SolidMotionStatement, SolidStatement,
    Statement, Stop, Verify,
};
