//! The library in a browser.
//!
//! Data flow: a page writes a question, JSON and perhaps the bytes of a file, to a buffer (`exports`) ->
//! [`State::ask`] reads it as a `question::Question` -> `body` (files become bodies, which stay in the
//! state), `convex` and `solid` (casts, as `record` has them), `certify` (proofs between solids) -> an
//! [`Answer`]: JSON, and perhaps numbers in binary for large things.
//!
//! The parts for assemblies, for distances, for motions that turn and for how an answer was found are modules of
//! their own, read when they are asked for (`assembly/`, `distance/`, `motion/`, `found/`); they have the same
//! exported names.
//!
//! Nothing here computes geometry. The same code runs natively (`examples/native.rs`), so what a
//! browser answers can be held against it, byte for byte: numbers are written with as many digits as
//! it takes to read the same bits.

mod answer;
mod body;
mod certify;
mod convex;
mod exports;
mod fields;
mod lit;
mod pose;
mod question;
mod record;
mod solid;
mod state;

pub use answer::Answer;
pub use state::State;
