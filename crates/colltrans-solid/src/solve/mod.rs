//! Queries between two solids: overlap, first contact along a direction, and distance, for `cast` and `pair`.
//!
//! - [`scene`]: two placed solids and a direction, in the frames that the folder shares.
//! - [`overlap`]: whether the solids overlap at the start, exactly; [`inside`] tests nested shells.
//! - [`search`]: the least gap along the direction, best first through both trees. [`bound`] bounds pairs of nodes from
//!   their [`projected`] bounds and [`separating_axes`]; [`leaf`] compares pairs of facets, and [`edge_on`] edge-on facets
//!   of open shells.
//! - [`contact`]: points, normal, features and bounds of the result.
//! - [`separate`], [`parted`]: a separating plane parallel to the direction, or of any direction.
//! - [`thin`], [`line`], [`fan`]: points and segments, lines that enter material, the facets around a vertex.
//! - [`sign`]: exact signs where rounding cannot decide.
//! - [`nearest`]: the distance, for which the direction plays no part.
//! - [`hulls`]: two convex solids as two convex bodies, which the queries of `cast` and `pair` ask first.

pub(crate) mod bound;
pub mod contact;
pub(crate) mod edge_on;
mod fan;
pub mod hulls;
pub(crate) mod inside;
pub(crate) mod leaf;
mod line;
pub mod nearest;
pub mod overlap;
pub(crate) mod parted;
pub mod projected;
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
