//! Questions about assemblies. This is a module of its own, because it is the largest one and most visitors ask
//! about two bodies.
//!
//! Data flow: files -> parts -> [`State`]: the fit, the blocking graph of a direction, the removal map of
//! some parts, the plan.

mod answers;
mod state;

pub use state::State;
