//! Distances and depths: a module of its own, because the first answer needs neither.
//!
//! Data flow: the files of both bodies -> the bodies, as the page's library has them -> how far they are apart where
//! they are, and if they meet, how deep -> the library's records.

mod state;

pub use state::State;
