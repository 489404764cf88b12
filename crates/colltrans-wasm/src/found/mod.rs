//! The search behind an answer. This is a module of its own, because the first answer does not need it.
//!
//! Data flow: the files of both bodies -> [`State`], which has the convex bodies, and the `question` ->
//! `search` (the library's recording of a cast) and `levels` (`phi` over a grid of levels, by a slow and
//! simple method).

mod levels;
mod question;
mod search;
mod state;

pub use state::State;
