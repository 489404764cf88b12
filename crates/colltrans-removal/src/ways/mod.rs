//! Removal paths in several moves: translations of one body or several, one after another, until some bodies
//! are removed.
//!
//! Orientations do not change. A *placement* is a displacement of each body. A *leg* moves some bodies
//! together along a direction. At the end of a leg another direction must be possible. For two bodies,
//! `openings` finds where along a first move a second one is possible. `search` explores placements along the
//! directions of `candidates`.
//!
//! The search uses rounded numbers, and the answer does not depend on them: each leg is certified by a
//! [`Cast`](colltrans_convex::Cast) of each moving body against each one at rest. The bodies of the search
//! are slightly larger, because they are offset by 0.8 of the tolerance. Therefore rounded placements are not
//! overlaps of the certified bodies.

mod answer;
mod candidates;
mod cells;
mod enclosed;
mod openings;
mod options;
mod pairs;
mod proof;
mod search;
mod verify;

pub use answer::{Leg, WayOut, WaysOut};
pub use candidates::of_large_facets;
pub use cells::{Crossing, Room, RoomCell};
pub use enclosed::NoWay;
pub use options::{Order, Searched, WayOptions};
pub use proof::LegProof;
