//! Tests of sections and support points on constructed bodies.

pub(crate) mod bodies;
mod sections;
mod supports;
#[cfg(debug_assertions)]
mod work;
