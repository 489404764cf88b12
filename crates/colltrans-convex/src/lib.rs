//! Collision translations and distances of convex bodies, and of solids, which are the next crate to leave. What is
//! asked and answered is told in `colltrans`, which is what programs use.
//!
//! Modules that are hidden from the documentation are for the crates of this workspace, without a promise.

#![allow(
    rustdoc::private_intra_doc_links,
    reason = "hidden modules are read with their private parts"
)]

#[doc(hidden)]
pub mod answer;
#[doc(hidden)]
pub mod body;
#[doc(hidden)]
pub mod cast;
#[doc(hidden)]
pub mod pair;
#[doc(hidden)]
pub mod setting;
#[doc(hidden)]
pub mod solve;
#[doc(hidden)]
pub mod tracker;

pub use answer::{
    Bounded, CentralCast, Certificate, CertificateError, Clearance, Contact, ContactRange, Depth,
    DirectionalDepth, Distance, Enclosure, Grazing, Intersection, NearPoints, Outcome,
    OverlapAhead, PlaneGap, Proof, Separated, Separation, Solver, StartedFrom, Steps, WhyFree,
    Within,
};
pub use body::error::{BuildError, TopologyError};
pub use body::{
    Aabb, Body, ConvexPolyhedron, ConvexityDefect, FaceId, Feature, Features, HalfEdge, InputFacet,
    InputVertex, ObstacleId, OffsetReport, Placed, Pose, VertexId, convexity_defect,
};
#[cfg(feature = "json")]
pub use cast::{Case, CaseError};
pub use cast::{Cast, CastBody, WitnessPoints, cast};
pub use colltrans_kernel::PoseError;
pub use colltrans_kernel::range::{MAX_MAGNITUDE, MIN_MAGNITUDE};
pub use colltrans_kernel::written::UnknownName;
pub use glam;
pub use pair::{Pair, PairBody, PairProof};
pub use setting::VertexPair;
pub use setting::error::{QueryError, Stalled};
pub use solve::observe;
pub use solve::options::{Cuts, Focus, NarrowFrom, Narrowing, NoUntil, Options, Region, Until};
pub use tracker::Tracker;
