//! The collision translation algorithm of the paper (section III): minimises a convex function over pairs of
//! planar sections of the bodies.
//!
//! - `phi(x, y)` is the collision translation of P's section at level `x` and Q's section at level `y`. It is
//!   convex and piecewise linear. Its minimum is the collision translation of the bodies.
//! - The *shadow plane* has the coordinates `h` (height) and `g`, in which two sections touch at their lowest
//!   common point.
//!
//! Formulas and proofs are in `docs/theory/section-minimisation.md`; `docs/paper.md` compares each line with
//! the paper. Data flow: [`section_pair`], [`start`] -> [`planar`] (by [`section`], [`sectioned_body`]) ->
//! [`piece`], [`cell`] -> [`exit`], else [`region`], [`bound`]; [`mod@minimise`] is the loop. Its result is a
//! floating-point guess of the contact normal and the features. Portal refinement certifies it.

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

pub(crate) use minimise::{ContactGuess, MinimisationOptions, minimise};
pub(crate) use start::{LastSolution, MinimisationStart};

/// Maximum number of planar problems in a query. 40 cuts through centroids leave less than
/// `(1 - 1/e)^40 < 2e-8` of the region.
pub(crate) const MAX_STEPS: u32 = 40;
