//! Answers and proofs as files, in one program: each program is linked for itself.

mod claims;
mod common;
mod forged;
mod keep;
mod motions;
mod proof_file;
mod written;
