//! What the tests of `colltrans` are judged by: an oracle in exact rational arithmetic, an exact
//! checker of certificates, and settings that are hard on purpose.
//!
//! Data flow: [`settings`] -> the library -> [`input`], which holds bodies against the points that
//! they were made of -> [`check`], which reads the answer against the
//! [`scene`] in exact coordinates ([`exact`]), and for a sample against the linear programme
//! ([`simplex`]) and the exact sideways overlap ([`shadow`]). Algorithms that compute distances are
//! judged by [`distance`], answers of the library about distance and depth by [`nearest`], about one
//! body among many by [`among`], casts that keep a gap by [`keep`], bodies that
//! turn by [`motion`], such that do not, asked in bulk, by [`still`], bodies that joints carry by [`path`], with little play by
//! [`play`], burrs by
//! [`cubes`]. Saved proofs, forged ones too, are judged by [`proofs`].

pub mod among;
pub mod check;
pub mod cubes;
pub mod distance;
pub mod exact;
pub mod fuzz;
pub mod input;
pub mod keep;
pub mod motion;
pub mod nearest;
pub mod path;
pub mod play;
pub mod proofs;
pub mod scene;
pub mod sequences;
pub mod settings;
pub mod shadow;
pub mod simplex;
pub mod solids;
pub mod still;
pub mod tracked;
