//! Computes correct answers for the tests of `colltrans` in exact rational arithmetic.
//!
//! A setting ([`settings`]) is given to the library. [`input`] compares its bodies with their input points.
//! [`check`] compares the answer with the [`scene`] in exact coordinates ([`exact`]), and for a sample with the
//! linear programme ([`simplex`]) and the exact lateral overlap ([`shadow`]). Other modules judge:
//!
//! - [`distance`] the algorithms for distances, [`nearest`] the library's distances and depths, [`min_gap`] casts
//!   with a minimum gap, [`rounded`] distances and depths of rounded bodies,
//! - [`among`] scene queries, [`still`] bulk casts without rotation,
//! - [`motion`] rotating bodies, [`path`] bodies moved by joints, [`play`] both with little play,
//! - [`cubes`] puzzles of cubes, [`proofs`] saved and forged proofs.

pub mod among;
pub mod check;
pub mod cubes;
pub mod distance;
pub mod exact;
pub mod fuzz;
pub mod input;
pub mod min_gap;
pub mod motion;
pub mod nearest;
pub mod path;
pub mod play;
pub mod proofs;
pub mod rounded;
pub mod scene;
pub mod sequences;
pub mod settings;
pub mod shadow;
pub mod simplex;
pub mod solids;
pub mod still;
pub mod tracked;
