//! The library in a browser.
//!
//! Each module answers the questions of a part of the page and is linked as a WebAssembly module of its own,
//! which the page loads on demand. [`page`] answers the first question of every visitor, so all that this
//! question does not need is in other modules. All modules export the same names ([`export`]).
//!
//! Data flow: the page writes a question, JSON and optionally the bytes of a file, to a buffer ([`exports`])
//! -> the state of the module answers it ([`Answers::ask`]) -> an [`Answer`]: JSON, and optionally binary
//! numbers for large data.
//!
//! Nothing here computes geometry. The same code runs natively (`examples/native.rs`). Tests compare its
//! answers with those of a browser byte for byte, because numbers are written with enough digits to restore
//! their bits.
//!
//! [`package`] is the library of the npm package, with an interface of its own.
//!
//! Features: `min-gap` compiles the module [`motion`] and the library's minimum gaps, which rounded bodies need;
//! `assembly` compiles the module [`assembly`] and the whole library. The other modules are smaller without them.
//! [`page`] is linked twice, without `min-gap` and with it. The first one has convex polyhedra alone. The page loads
//! the second one for a solid or a body that a name describes (`sphere:0.5`). `report` is only for the test of a
//! report's viewer.

mod answer;
#[cfg(feature = "assembly")]
pub mod assembly;
pub mod exports;
mod fields;
pub mod found;
mod highlight;
#[cfg(feature = "min-gap")]
pub mod motion;
pub mod package;
pub mod page;
pub mod picture;
mod pose;
mod shape;

pub use answer::Answer;

/// The state of a module, which answers the page's questions.
pub trait Answers: Default {
    /// Answers one question. `file` has the attached bytes, if any.
    fn ask(&mut self, question: &[u8], file: Vec<u8>) -> Answer;
}
