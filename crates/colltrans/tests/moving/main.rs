//! Bodies that turn, in one program: each is linked for itself.

mod motion;
mod motion_clearance;
mod motion_properties;
mod path;
mod play;
mod proof_claims;
mod published_motions;
mod solids_motion;
