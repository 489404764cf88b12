//! Bodies that turn, or that joints carry, in one program: each program is linked for itself.

mod casts;
mod clearance;
mod fuzz_corpus;
mod path;
mod play;
mod properties;
mod published;
mod solids;
