//! First contacts of bodies that turn, in a browser: a module of its own, because the first answer needs none.
//!
//! Exported names, answers, poses and what touches are the files of `colltrans-wasm`, bodies that of
//! `colltrans-wasm-distance`, as they are there. Data flow: the files of both bodies -> the bodies, as the page's
//! library has them -> when they first meet -> the library's record, and its proof, made and checked.

#[path = "../../src/answer.rs"]
mod answer;
#[path = "../../src/exports.rs"]
mod exports;
#[path = "../../src/lit.rs"]
mod lit;
#[path = "../../distance/src/placing.rs"]
mod placing;
#[path = "../../src/pose.rs"]
mod pose;
mod state;

pub use answer::Answer;
pub use state::State;
