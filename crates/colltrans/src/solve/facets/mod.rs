//! How far a solid can move before a facet of it meets a facet of another.
//!
//! The data's way: [`scene`] (two placed solids and a direction) -> [`overlap`] (do they overlap where
//! they are?) -> [`search`] (best first through both trees, with [`bound`] for pairs of nodes and
//! [`leaf`] for pairs of facets) -> an answer. [`sign`] and [`wide`] decide what rounding cannot.

mod bound;
mod clearance;
mod contact;
mod inside;
mod leaf;
mod overlap;
mod scene;
mod search;
mod sign;
mod wide;

pub use clearance::{SolidClearance, SolidOptions, StartOverlap};
pub use contact::SolidContact;
pub use search::Workspace;
