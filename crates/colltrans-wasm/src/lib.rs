//! The library in a browser.
//!
//! Each module answers the questions of a part of the page, and is linked as a WebAssembly module of its own that the
//! page loads when it needs it: [`page`] answers the first question of every visitor, so it is the smallest one. All
//! of them export the same names ([`export`]).
//!
//! Data flow: a page writes a question, JSON and perhaps the bytes of a file, to a buffer ([`exports`]) -> the
//! module's state answers it ([`Answers::ask`]) -> an [`Answer`]: JSON, and perhaps numbers in binary for large things.
//!
//! Nothing here computes geometry. The same code runs natively (`examples/native.rs`), so the tests compare what a
//! browser answers with it, byte for byte: numbers are written with as many digits as it takes to read the same bits.
//!
//! Features: `motion` compiles the module [`motion`], and the library with gaps that a cast keeps; `assembly` compiles
//! the module [`assembly`], and the library with all that it has. The other modules need neither and are smaller
//! without them. `report` is for the test of a report's viewer alone.

mod answer;
#[cfg(feature = "assembly")]
pub mod assembly;
pub mod distance;
pub mod exports;
mod fields;
pub mod found;
mod lit;
#[cfg(feature = "motion")]
pub mod motion;
pub mod page;
pub mod picture;
mod placing;
mod pose;

pub use answer::Answer;

/// What answers a page's questions.
pub trait Answers: Default {
    /// Answers one question; `file` holds the bytes that come with it, if any.
    fn ask(&mut self, question: &[u8], file: Vec<u8>) -> Answer;
}
