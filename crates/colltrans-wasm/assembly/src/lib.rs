//! Assemblies in a browser: a module of its own, because it is as large as all the rest and most
//! visitors ask about two bodies.
//!
//! The door, answers and readers of questions are the files of `colltrans-wasm`, as they are there.
//! The data's way: files -> parts -> [`Desk::ask`]: the fit, who blocks whom along a direction, the
//! removal map of some parts, the plan.

#[path = "../../src/answer.rs"]
mod answer;
mod desk;
#[path = "../../src/door.rs"]
mod door;
#[path = "../../src/fields.rs"]
#[expect(dead_code, reason = "shared: not all of it is read here")]
mod fields;
mod tell;

pub use answer::Answer;
pub use desk::Desk;
