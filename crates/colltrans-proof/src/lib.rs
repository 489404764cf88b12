//! Answers as the front ends write them ([`record`]), and proofs of answers as files that contain the bodies
//! and the query.

#![allow(
    rustdoc::private_intra_doc_links,
    reason = "the documentation of hidden modules is read together with private items"
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
