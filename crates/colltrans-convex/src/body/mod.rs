//! Bodies, checked and indexed once, and where they stand.

mod aabb;
pub(crate) mod convex;
pub mod error;
mod feature;
mod hull;
mod id;
pub(crate) mod inertia;
mod kept;
pub mod motion;
mod moving;
pub(crate) mod placed;
pub mod pose;
pub mod pose_error;
pub mod split;
pub(crate) mod topology;

pub use aabb::Aabb;
pub use convex::{ConvexPolyhedron, ConvexityDefect, OffsetReport, convexity_defect};
pub(crate) use convex::{FAN, LargeFace, MOST_RIMS, Rim, greatest_near};
pub(crate) use feature::feature;
pub use feature::{Feature, Features};
pub use hull::Hull;
pub use id::{FaceId, InputFacet, InputVertex, ObstacleId, VertexId};
pub(crate) use inertia::Inertia;
#[doc(hidden)]
pub use kept::{Keepable, Kept};
pub use moving::Moving;
pub use placed::{Body, Numbered, Placed, Told};
pub use pose::Pose;
pub use topology::HalfEdge;
