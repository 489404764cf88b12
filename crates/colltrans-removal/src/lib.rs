//! Along which directions a body can leave another one ([`free`]), and in which moves ([`ways`]).
//!
//! In `free`, `cone` is what two facets block, `cell` a square of directions, `rest` what cones leave of it, `inner` boxes
//! inside, `window` which pairs of nodes miss one; `search` cuts the sphere, `proof` is what is said of each cell, `verify` checks it,
//! `region` joins what is free, `thin` says what is so without an area, `blocker` asks about one cell. In `ways`, `openings`
//! is where along one move another is possible, `pairs` what two bodies do by their displacement, `search` goes from place to
//! place; `proof` certifies every leg by casts, `verify` checks them. `cells` are displacements in which two bodies overlap, with
//! which `enclosed` proves that there is no way.

#![allow(
    rustdoc::private_intra_doc_links,
    reason = "hidden modules are read with their private parts"
)]

pub mod free;
pub mod ways;
