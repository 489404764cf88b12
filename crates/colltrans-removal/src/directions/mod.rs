//! All directions along which a solid can leave another one, with a proof.
//!
//! `A` moves, `B` is fixed. The directions that [`Cast::clearance`](colltrans_convex::Cast::clearance)
//! reports as blocked are a union of open convex cones, one for each pair of facets (`cone`). The search
//! divides the sphere into `cell`s until each one is blocked, is free, or is divided by a few cones into
//! exact convex pieces (`remainder`). Two boxes inside the bodies can block a cell that no single pair of
//! facets blocks (`inner`). Derivation: `docs/theory/free-directions.md`.
//!
//! Data flow: `bodies` (vertices, trees down to facets) -> `line` (great circles, exact signs) -> `cone`,
//! `window` (pairs of nodes that block no direction of a rectangle), `remainder`, `inner` -> `proof` (claims
//! about cells), `verify` (their check) -> `search` -> [`FreeDirections`]. `region` joins free pieces,
//! `lower_dimensional` finds free arcs and isolated directions, `blocker` decides single cells. `half_space` has the
//! directions of rounded convex bodies in contact.

mod answer;
mod blocker;
mod bodies;
mod cell;
mod cone;
mod error;
mod half_space;
mod inner;
mod line;
mod lower_dimensional;
mod options;
mod proof;
mod region;
mod remainder;
mod search;
mod verify;
mod window;

pub(crate) use bodies::{Bodies, NodeBounds};

pub use answer::{CellKind, FreeCell, FreeDirections, FreePiece, Verdict};
pub use blocker::{CellBlocker, DirectionCell};
pub use error::FreeError;
pub use half_space::{FreeHalfSpace, HalfSpaceVerdict};
pub use inner::InnerBox;
pub use line::PlaneVertex;
pub use lower_dimensional::{FreeArc, FreePlane, FreePoint, PlaneFacets};
pub use options::FreeOptions;
pub use proof::{CellProof, FreeProof};
pub use region::FreeRegion;
