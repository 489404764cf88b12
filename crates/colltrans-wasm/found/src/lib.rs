//! How an answer was found, in a browser: a module of its own, because the first answer needs none of it.
//!
//! Exported names, answers and poses are the files of `colltrans-wasm`, as they are there. Data flow:
//! the files of both bodies -> [`State`], the convex bodies and the `question` -> `search` (the library's recording
//! of a cast) and `levels` (`phi` over a grid of levels, the slow and obvious way).

#[path = "../../src/answer.rs"]
mod answer;
#[path = "../../src/exports.rs"]
mod exports;
mod levels;
#[path = "../../src/pose.rs"]
mod pose;
mod question;
mod search;
mod state;

pub use answer::Answer;
pub use state::State;
