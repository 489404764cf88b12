//! The library of the npm package: bodies, and the questions about two of them.
//!
//! Data flow: `web/package` writes a question ([`question`]), a list of numbers whose first one is its
//! [`Question`], to the buffer of [`crate::exports`], with the coordinates of a mesh or the rows of many
//! questions behind it -> a state answers it -> the numbers of an answer ([`answers`]), or an error: the text
//! of the answer.
//!
//! There are two states. [`Casts`] has convex bodies and questions along a direction, so that its module is
//! small. [`Bodies`] has bodies of both kinds and all questions. Both build and cast convex bodies by the same
//! code, and return the same bits.
//!
//! [`answers::description`] describes all answers. `web/package/build.mjs` makes the types and the decoder of
//! the package of it.

pub mod answers;
mod casts;
mod convex;
mod error;
mod question;
mod rows;
mod store;

#[cfg(feature = "min-gap")]
mod bodies;
#[cfg(feature = "min-gap")]
mod motion;
#[cfg(feature = "min-gap")]
mod pairs;
#[cfg(feature = "min-gap")]
mod solid;

#[cfg(feature = "min-gap")]
pub use bodies::Bodies;
pub use casts::Casts;
pub use question::Question;
