//! Assemblies: a module of its own, because it is as large as all the rest and most visitors ask about two bodies.
//!
//! Data flow: files -> parts -> [`State`]: the fit, who blocks whom along a direction, the removal map of some parts,
//! the plan.

mod state;
mod tell;

pub use state::State;
