//! Tests of bodies in motion and of bodies that joints carry, as one program, because each program is linked
//! separately.

mod casts;
mod clearance;
mod fuzz_corpus;
mod path;
mod play;
mod properties;
mod published;
mod solids;
