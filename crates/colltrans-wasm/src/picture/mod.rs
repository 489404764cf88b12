//! The view as SVG. This is a module of its own, because few visitors save a drawing.
//!
//! Data flow: the geometry that the page shows, projected to the page (`scene`) -> `drawing`: areas sorted by
//! depth, and the visible parts of lines -> SVG.

mod drawing;
mod scene;
mod state;

pub use state::State;
