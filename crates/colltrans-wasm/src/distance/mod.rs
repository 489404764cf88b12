//! Distances and depths. This is a module of its own, because the first answer does not need it.
//!
//! Data flow: the files of both bodies -> the bodies, as in the module `page` -> their distance and, if they
//! meet, their depth -> records of the library.

mod state;

pub use state::State;
