//! The collision translation algorithm: convex minimisation over pairs of planar sections (the
//! paper, section III).
//!
//! Notation. P moves along the unit direction `d`, Q is fixed. For a section axis `a` of P and `b`
//! of Q, `phi(x, y)` is the collision translation of P's section at level `x` and Q's at level `y`;
//! it is convex and piecewise linear, and its minimum is the collision translation of P and Q. With
//! `c = a/(a.d) - b/(b.d)` and the shadow coordinates `h = c . w`, `g = (d x c) . w`,
//!
//! `phi(x, y) = y/(b.d) - x/(a.d) + psi(x, y)`, `psi` the least `h` common to both sections'
//! shadows.
//!
//! Data flow: [`section_pair`] (a setting in section coordinates), [`start`] (the first levels) ->
//! [`sectioned_body`] and [`section`] (a body's sections in the shadow plane) -> [`planar`] (one `psi`) ->
//! [`piece`] (a linear bound) and [`cell`] (where it is `phi`) -> [`exit`] (whether the cell's best
//! point solves the problem), else [`region`] (what is left of the levels) and [`bound`] (what the
//! pieces prove together) -> [`mod@minimise`]. The result is a guess of the contact normal and
//! features, in floating point: portal refinement makes it exact.

mod bound;
mod cell;
mod crossing;
mod exit;
mod minimise;
pub(crate) mod options;
mod piece;
mod planar;
mod region;
mod section;
mod section_pair;
mod sectioned_body;
mod start;
#[cfg(test)]
mod tests;

pub(crate) use minimise::{CtaOptions, Guess, minimise};
pub(crate) use start::{Origin, RegionFocus};

/// Planar problems per query at most; the cuts leave less than `(1 - 1/e)^40 < 2e-8` of the region
/// by then.
pub(crate) const MAX_STEPS: u32 = 40;
