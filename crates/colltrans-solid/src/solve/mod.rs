//! The search between solids.
//!
//! Data flow: [`scene`] (two placed solids and a direction) -> [`overlap`] (do they overlap where
//! they are?) -> [`search`] (best first through both trees, with [`bound`] for pairs of nodes and
//! [`leaf`] for pairs of facets, [`rim`] for what is on edge in open shells) -> [`contact`], or a plane between
//! the bodies ([`separate`]) where there is one; [`parted`] has one of any direction. [`thin`] has points and segments,
//! [`line`] where they enter material, [`fan`] the facets around a vertex. [`sign`] decides what rounding cannot. [`nearest`] is of the same
//! scene without a direction. The questions are in `cast/solid` and `pair/solid`.

pub(crate) mod bound;
pub mod contact;
mod fan;
mod inside;
pub(crate) mod leaf;
mod line;
pub mod nearest;
pub mod overlap;
pub(crate) mod parted;
pub mod projected;
pub(crate) mod rim;
pub mod scene;
pub mod search;
pub(crate) mod separate;
pub(crate) mod separating_axes;
mod sign;
pub mod steps;
mod thin;
mod triangle;

pub use bound::Reason;
pub use contact::SolidContact;
pub use nearest::{Apart, SolidGap, SolidNear};
pub use overlap::Overlap;
pub use search::Workspace;
pub use steps::SolidSteps;
