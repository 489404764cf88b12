//! Solids, in one program: each program is linked for itself.

mod casts;
mod common;
mod convex;
mod distance;
mod features;
mod keep;
mod oracle;
mod points;
mod proof;
mod properties;
mod sheets;
