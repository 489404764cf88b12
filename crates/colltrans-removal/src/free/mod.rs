//! All directions along which a solid can leave another one, proven.
//!
//! `A` moves, `B` is fixed. What [`Cast::clearance`](colltrans_convex::Cast::clearance) calls blocked is a union of open convex
//! cones, one for each pair of facets (`cone`). So four directions that one pair blocks block all between them, and
//! six pairs may prove that no direction is free. The sphere is cut into `cell`s until each is blocked, free, or cut
//! by few cones into exact convex pieces (`rest`). Where facets are too small for that, two boxes inside the bodies may
//! block a cell (`inner`).
//!
//! Data flow: `bodies` (vertices, and trees down to single facets) -> `line` (great circles and exact signs) ->
//! `cone`, `window` (which pairs of nodes miss a rectangle of directions), `rest`, `inner` -> `proof` (what is said of a
//! cell), `verify` (its check) -> `search` -> [`FreeDirections`]; `region` joins what is free in
//! pieces, `thin` what is so without an area; `blocker` tells of single cells.

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
