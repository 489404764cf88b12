//! Solvers.

pub(crate) mod facets;
