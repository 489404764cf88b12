//! All directions along which a solid can leave another one, with a proof.
//!
//! `A` moves, `B` is fixed. The directions that [`Cast::clearance`](colltrans_convex::Cast::clearance)
//! reports as blocked are a union of open convex cones, one for each pair of facets (`cone`). The search
//! divides the sphere into `cell`s until each one is blocked, is free, or is divided by a few cones into
//! exact convex pieces (`rest`). Two boxes inside the bodies can block a cell whose facets are too small for
//! this (`inner`). Derivation: `docs/theory/free-directions.md`.
//!
//! Data flow: `bodies` (vertices, trees down to facets) -> `line` (great circles, exact signs) -> `cone`,
//! `window` (pairs of nodes that block no direction of a rectangle), `rest`, `inner` -> `proof` (claims about
//! cells), `verify` (their check) -> `search` -> [`FreeDirections`]. `region` joins free pieces, `thin` finds
//! free arcs and isolated directions, `blocker` decides single cells.

mod answer;
mod blocker;
mod bodies;
mod cell;
mod cone;
mod error;
mod inner;
mod line;
mod options;
mod proof;
mod region;
mod rest;
mod search;
mod thin;
mod verify;
mod window;

pub(crate) use bodies::{Bodies, View};

pub use answer::{CellKind, FreeCell, FreeDirections, FreePiece, Verdict};
pub use blocker::{CellBlocker, DirectionCell};
pub use error::FreeError;
pub use inner::InnerBox;
pub use line::PlaneVertex;
pub use options::FreeOptions;
pub use proof::{CellProof, FreeProof};
pub use region::FreeRegion;
pub use thin::{FreeArc, FreePlane, FreePoint, PlaneFacets};
