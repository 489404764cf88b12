//! Convex bodies, validated and indexed at construction, and bodies with a pose or a motion.

pub(crate) mod convex;
pub mod error;
mod feature;
mod hull;
pub(crate) mod inertia;
mod moving;
pub(crate) mod placed;

#[doc(hidden)]
pub use colltrans_kernel::kept::{DerivedData, Kept};
pub use colltrans_kernel::topology::HalfEdge;
pub use colltrans_kernel::{Aabb, FaceId, InputFacet, InputVertex, ObstacleId, Pose, VertexId};
pub use convex::{ConvexPolyhedron, ConvexityDefect, OffsetReport, convexity_defect};
pub(crate) use convex::{FAN, LargeFace, MAX_RIMS, Rim, cyclic_maximum};
pub(crate) use feature::feature;
pub use feature::{Feature, Features};
pub use hull::Hull;
pub(crate) use inertia::Inertia;
pub use moving::Moving;
pub use placed::{Body, Numbered, Placed, Told};
