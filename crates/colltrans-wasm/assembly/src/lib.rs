//! Assemblies in a browser: a module of its own, because it is as large as all the rest and most
//! visitors ask about two bodies.
//!
//! Exported names, answers and readers of questions are the files of `colltrans-wasm`, as they are there.
//! Data flow: files -> parts -> [`State::ask`]: the fit, who blocks whom along a direction, the
//! removal map of some parts, the plan.

#[path = "../../src/answer.rs"]
mod answer;
#[path = "../../src/exports.rs"]
mod exports;
#[path = "../../src/fields.rs"]
mod fields;
mod state;
mod tell;

pub use answer::Answer;
pub use state::State;
