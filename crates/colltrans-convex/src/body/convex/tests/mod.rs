//! Sections and bodies, tested together.

pub(crate) mod bodies;
mod sections;
mod supports;
#[cfg(debug_assertions)]
mod work;
