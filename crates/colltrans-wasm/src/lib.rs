//! The library in a browser.
//!
//! The data's way: a page writes a question, JSON and perhaps the bytes of a file, to the [`door`] ->
//! [`Desk::ask`] reads it as a [`question::Question`] -> [`body`] (files become bodies, which stay on
//! the desk), [`convex`] and [`solid`] (casts), [`search`] (how an answer was found) -> an
//! [`Answer`]: JSON, and perhaps numbers in binary for large things.
//!
//! Nothing here computes geometry. The same code runs natively (`examples/native.rs`), so what a
//! browser answers can be held against it, byte for byte: numbers are written with as many digits as
//! it takes to read the same bits.

mod body;
mod convex;
mod desk;
mod door;
mod levels;
mod pose;
mod question;
mod search;
mod solid;

pub use desk::{Answer, Desk};
