//! Removal paths in several moves: translations of one body or several, one after another, until some bodies
//! are removed.
//!
//! Orientations do not change. A *placement* is a displacement of each body. A *leg* moves some bodies
//! together along a direction. At the end of a leg another direction must be possible. For two bodies,
//! `openings` finds where along a first move a second one is possible. `search` explores placements along the
//! directions of `candidates`, and later along those of `walls` that stopped bodies.
//!
//! The search uses rounded numbers. No removal path depends on them, because a
//! [`Cast`](colltrans_convex::Cast) of each moving body against each one at rest certifies each leg. The
//! search uses 0.8 of the tolerance, so its bodies are slightly larger than the certified ones. Therefore
//! rounded placements are not overlaps of the certified bodies.

mod answer;
mod candidates;
mod cells;
mod enclosed;
mod openings;
mod options;
mod pairs;
mod proof;
mod scene;
mod search;
mod verify;
mod walls;

pub use answer::{Leg, MAX_BODIES, RemovalPath, RemovalSearch};
pub use candidates::large_facet_axes;
pub use cells::{Crossing, DisplacementCell, DisplacementGrid};
pub use enclosed::NoRemovalPath;
pub use options::{Order, RemovalOptions, SearchWork};
pub use proof::LegProof;
pub use scene::{BlockingPair, PairRelation, RemovalScene};
