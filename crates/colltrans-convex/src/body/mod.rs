//! Convex bodies, validated and indexed at construction, and bodies with a pose or a motion.

pub(crate) mod convex;
pub mod error;
mod feature;
mod hull;
pub(crate) mod inertia;
mod moving;
pub(crate) mod placed;

#[doc(hidden)]
pub use colltrans_kernel::derived::{DerivedData, DerivedDataSlot};
pub use colltrans_kernel::topology::HalfEdge;
pub use colltrans_kernel::{Aabb, FaceId, InputFacet, InputVertex, ObstacleId, Pose, VertexId};
pub use convex::{ConvexPolyhedron, ConvexityDefect, OffsetReport, convexity_defect};
pub(crate) use convex::{LargeFace, MAX_RIMS, MAX_SCANNED_NEIGHBOURS, Rim, cyclic_maximum};
pub use feature::{Feature, Features};
pub(crate) use feature::{OwnFeature, feature_in_plane};
pub use hull::VertexHull;
pub(crate) use inertia::Inertia;
pub use moving::Moving;
pub use placed::{AnswerPart, Body, InputNumbered, Placed};
