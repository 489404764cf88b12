//! Tests of records and proof files in one program, because each program is linked separately.

mod claims;
mod common;
mod forged;
mod min_gap;
mod motions;
mod proof_file;
mod written;
