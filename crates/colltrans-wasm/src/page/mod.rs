//! Casts of two bodies: everything that the first answer of the page needs.
//!
//! Data flow: [`State::ask`](crate::Answers::ask) reads a `question::Question` -> `body` (files become
//! bodies, which stay in the state), `convex` and `solid` (casts, with the answers of `record`), `certify`
//! (proofs between solids).

mod body;
mod certify;
mod convex;
mod question;
mod record;
mod solid;
mod state;

pub use state::State;
