//! First contacts of bodies that turn: a module of its own, because the first answer needs none.
//!
//! Data flow: the files of both bodies -> the bodies, as the page's library has them -> when they first meet -> the
//! library's record, and its proof, made and checked.

mod state;

pub use state::State;
