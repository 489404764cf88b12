//! Directions along which a solid can be removed from another one ([`directions`]), and removal paths in several
//! moves ([`path`]).
//!
//! - `directions` classifies every direction of the sphere as free, blocked or undecided. Its module head lists
//!   the data flow.
//! - `path` searches a graph of placements. `path::pairs` casts two bodies at a displacement and caches the
//!   result, `openings` finds where along one move another move becomes possible, and `search` explores the
//!   placements. `proof` certifies each leg by casts, and `verify` checks these certificates.
//! - `path::cells` describes cells of displacements, and tests whether an edge and a facet block a cell.
//!   `path::enclosed` uses blocked cells to prove that no path exists.

#![allow(
    rustdoc::private_intra_doc_links,
    reason = "the documentation of hidden modules is read together with private items"
)]

pub mod directions;
pub mod path;
