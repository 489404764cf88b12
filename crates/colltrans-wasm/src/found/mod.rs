//! How an answer was found: a module of its own, because the first answer needs none of it.
//!
//! Data flow: the files of both bodies -> [`State`], the convex bodies and the `question` -> `search` (the library's
//! recording of a cast) and `levels` (`phi` over a grid of levels, the slow and obvious way).

mod levels;
mod question;
mod search;
mod state;

pub use state::State;
