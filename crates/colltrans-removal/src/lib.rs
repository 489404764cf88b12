//! Directions along which a solid can be removed from another one ([`directions`]), and removal paths in several
//! moves ([`path`]).
//!
//! - `free` decides for every direction of the sphere whether a translation along it is free. Its module head
//!   lists the data flow.
//! - `ways` searches a graph of placements. `pairs` classifies pairs of nodes by displacement, `openings`
//!   finds where along one move another move becomes possible, `search` explores the placements, `proof` and
//!   `verify` certify each leg by casts.
//! - `cells` finds cells of displacements in which the bodies overlap. `enclosed` uses them to prove that no
//!   path exists.

#![allow(
    rustdoc::private_intra_doc_links,
    reason = "the documentation of hidden modules is read together with private items"
)]

pub mod directions;
pub mod path;
