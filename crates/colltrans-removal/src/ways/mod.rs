//! Ways out in several moves: translations one after another, of one body or of several, until some of them are gone.
//!
//! Bodies keep how they are turned. A *place* is a displacement of each of them; a *leg* moves some of them, as one,
//! along a direction. Where a leg stops, another direction has to be possible: `openings` tells where along a first
//! move a second one is, of two bodies. `search` goes from place to place, `candidates` are the directions it tries.
//!
//! What is searched with is rounded, and nothing rests on it: each leg of the answer is a [`Cast`](colltrans_convex::Cast) of
//! each body that moves against each that stays, with its proof. The search has bodies that are a little larger
//! (shrunk by 0.8 of what the tolerance asks for), so rounded places are no overlaps of those that are certified.

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
