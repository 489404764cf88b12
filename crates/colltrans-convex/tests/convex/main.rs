//! Convex bodies, in one program: each program is linked for itself.

mod allocation;
mod api;
mod common;
mod degenerate;
mod distance;
mod fuzz_corpus;
mod golden;
mod hull;
mod input;
mod min_gap;
mod offset;
mod oracle;
mod paper;
mod properties;
mod published_distances;
mod published_failures;
mod replay;
mod rims;
mod rounded;
mod sliding;
mod tracker;
mod work;
