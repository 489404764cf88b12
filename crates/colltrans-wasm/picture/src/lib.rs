//! The view as areas and lines: a module of its own, because few visitors save a drawing.
//!
//! Exported names and answers are the files of `colltrans-wasm`, as they are there. Data flow: what the page
//! shows, already in perspective on it (`scene`) -> `drawing`: areas in the order in which the nearer
//! cover the farther, and of the lines what no opaque area hides -> SVG.

#[path = "../../src/answer.rs"]
mod answer;
mod drawing;
#[path = "../../src/exports.rs"]
mod exports;
mod scene;
mod state;

pub use answer::Answer;
pub use state::State;
