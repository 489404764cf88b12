//! Casts of two bodies: everything that the first answer of the page needs.
//!
//! Data flow: [`State::ask`](crate::Answers::ask) reads a `question::Question` -> `body` (files become
//! bodies, which stay in the state), `convex` and `solid` (casts, with the answers of `record`), `certify`
//! (proofs between solids).
//!
//! Without the feature `min-gap` the module has convex bodies alone, because it is loaded at once. The page loads the
//! module with the feature in its place when a body is a solid or rounded.

mod body;
#[cfg(feature = "min-gap")]
mod certify;
mod convex;
mod question;
mod record;
#[cfg(feature = "min-gap")]
mod solid;
mod state;

pub use state::State;
