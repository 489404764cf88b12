//! First contacts of moving bodies. This is a module of its own, because the first answer does not need it.
//!
//! Data flow: the files of both bodies -> the bodies, as in the module `page` -> their first contact -> the
//! record of the library, and its proof, built and checked.

mod places;
mod state;

pub use state::State;
