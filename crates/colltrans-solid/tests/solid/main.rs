//! Solids, in one program: each program is linked for itself.

mod allocation;
mod casts;
mod common;
mod common_proof;
mod convex;
mod depth_proof;
mod distance;
mod features;
mod fuzz_corpus;
mod golden;
mod min_gap;
mod oracle;
mod penetration;
mod points;
mod proof;
mod properties;
mod rounded;
mod sheets;
mod work;
