//! The view as SVG: a module of its own, because few visitors save a drawing.
//!
//! Data flow: what the page shows, already in perspective on it (`scene`) -> `drawing`: areas in the order in which
//! the nearer cover the farther, and of the lines what no opaque area hides -> SVG.

mod drawing;
mod scene;
mod state;

pub use state::State;
