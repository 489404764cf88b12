//! Distances and depths in a browser: a module of its own, because the first answer needs neither.
//!
//! Exported names, answers and poses are the files of `colltrans-wasm`, as they are there. Data flow:
//! the files of both bodies -> the bodies, as the page's library has them -> how far they are apart where they
//! are, and if they meet, how deep -> the library's records.

#[path = "../../src/answer.rs"]
mod answer;
#[path = "../../src/exports.rs"]
mod exports;
mod placing;
#[path = "../../src/pose.rs"]
mod pose;
mod state;

pub use answer::Answer;
pub use state::State;
