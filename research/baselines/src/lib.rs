//! Implementations of published algorithms with which `colltrans` is compared, on the same bodies.
//!
//! | module | algorithm | question |
//! |---|---|---|
//! | [`egjk`] | enhanced GJK (Cameron 1997) | distance |
//! | [`pqp`] | swept sphere and oriented box trees (Larsen, Gottschalk, Lin, Manocha 1999) | distance, tolerance, intersection |
//! | [`hwalk`] | H-Walk (Guibas, Hsu, Zhang 1999) | distance |
//! | [`vclip`] | V-Clip (Mirtich 1998) | distance |
//! | [`raycast`] | GJK ray cast (van den Bergen 2004) | collision translation |
//! | [`mpr`] | Minkowski portal refinement (Snethen 2008) | overlap |
//! | [`growth`] | growth distance by cutting planes (Thirugnanam, Sreenath 2026) | growth distance |
//!
//! Frames and units are those of `colltrans`: a [`Pose`](colltrans::Pose) places each body, and points of
//! answers are in the world.

pub mod egjk;
mod features;
pub mod growth;
pub mod hwalk;
pub mod mpr;
mod placed;
pub mod pqp;
mod proximity;
pub mod raycast;
pub mod vclip;
mod wedge;

pub use proximity::Proximity;
