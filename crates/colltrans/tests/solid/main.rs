//! Solids, in one program: each is linked for itself.

#[path = "../common/mod.rs"]
mod common;

mod free;
mod points;
mod sheets;
mod solids;
mod solids_convex;
mod solids_distance;
mod solids_features;
mod solids_keep;
mod solids_oracle;
mod solids_proof;
mod solids_properties;
mod ways;
