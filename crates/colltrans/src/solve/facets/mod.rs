//! How far a solid can move before a facet of it meets a facet of another.
//!
//! The data's way: [`scene`] (two placed solids and a direction) -> [`overlap`] (do they overlap where
//! they are?) -> [`search`] (best first through both trees, with [`bound`] for pairs of nodes and
//! [`leaf`] for pairs of facets, [`rim`] for what is on edge in open shells) -> an answer, with a plane between the bodies ([`separate`]) where
//! there is one, and on request with its [`proof`], which [`verify`] checks. [`sign`] and [`wide`] decide what rounding cannot.

mod bound;
mod clearance;
mod contact;
mod fan;
mod inside;
mod leaf;
mod overlap;
mod proof;
mod rim;
#[cfg(feature = "json")]
mod saved;
mod scene;
mod search;
mod separate;
mod sign;
mod verify;
mod wide;

pub use bound::Reason;
pub use clearance::{SolidOptions, SolidOverlap, StartOverlap};
pub use contact::SolidContact;
pub use overlap::Overlap;
pub use proof::{Claim, Cover, SolidCertificate, StartProof, StopProof};
pub use search::Workspace;
pub use verify::SolidProof;
