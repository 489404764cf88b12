//! Convex bodies and what is asked of them, in one program: each is linked for itself.

#[path = "../common/mod.rs"]
mod common;

mod among;
mod api;
mod bulk;
mod degenerate;
mod distance;
mod fuzz_corpus;
mod hull;
mod input;
mod keep;
mod offset;
mod paper;
mod properties;
mod published_distances;
mod published_failures;
mod replay;
mod rims;
mod sliding;
mod tracker;
mod written;
