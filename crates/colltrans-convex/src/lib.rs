//! Convex bodies: casts, distances, penetration depths, and certificates of the answers.
//!
//! Programs use the facade `colltrans`, whose documentation explains the queries. The hidden modules serve
//! the crates of this workspace; their interface may change at any time.
//!
//! # Modules
//!
//! Each module uses only those before it, with one exception: `body` names `answer::RangeEnd` in a trait
//! bound.
//!
//! - `body`: convex bodies, checked and indexed once. [`ConvexPolyhedron`] is in `convex`. `build` makes it
//!   (hulls on exact orientations, meshes, offsets). `support` finds support points in `O(log n)`, with
//!   bisection by angle along a `ring` and around the apex of a `fan`. `excess` bounds how far a body reaches
//!   beyond a support point. `sections` are planar sections across four axes, built when the paper's
//!   algorithm first uses them. The trait [`Body`] describes a kind of body.
//! - `setting`: two placed bodies and, for a cast, a direction. `minkowski` computes support points of `M` in
//!   the shadow frame, and on which side of an edge the line passes.
//! - `answer`: outcomes, ranges and bounds. `certificate` has the proofs and their checks.
//! - `solve`: the solver of one cast. `portal` is portal refinement with exact decisions. It starts from a
//!   guess of the contact normal and ends in the face of `M` that the line enters. The plane and the triangle
//!   of this face are the certificate. `outline` approximates bodies with rims by hulls of ellipses, and
//!   `outline_maximum` computes the contact normal of these hulls. `cta` is the paper's algorithm. It minimises
//!   `phi(x, y)`, the collision translation of two planar sections, by cutting planes in floating point. The
//!   result is a guess of the contact normal. `nearest` descends to the nearest point of `M` over its simplices.
//!   `depth` grows a polytope of points of `M` where the origin is nearest to its boundary. `min_gap` solves casts
//!   with a minimum gap, by Newton's method over nearest points. `observe` reports steps to an observer.
//! - `cast`: [`Cast`], its derived answers, contact details and files. [`CastBody`] is the trait of bodies
//!   that can be cast.
//! - `pair`: [`Pair`], the queries about two placed bodies without a direction, and the checks of their
//!   proofs.
//! - `tracker`: [`Tracker`], which starts each query from the last answer.
//!
//! Both solvers end in `portal`. The sections of `cta` are rounded, but which face of `M` the line enters is
//! a combinatorial question. With one common last stage there is one error analysis and one implementation to
//! test, and a wrong guess costs time but never correctness.
//!
//! # Accuracy
//!
//! The bounds of a contact enclose the true collision translation exactly: [`Certificate::lower`]
//! `<= coll <=` [`Certificate::upper`]. Here a body is the convex hull of its
//! [`vertices`](ConvexPolyhedron::vertices), placed by the nine entries of its pose's matrix and its
//! translation. The bounds also hold for the points from which the bodies were built, because lower bounds
//! are reduced by the distance of these points from the hull ([`ConvexPolyhedron::hull_error`]).
//! [`Contact::translation`] is the best estimate between the bounds.
//!
//! Let `S` be the size of the configuration: the sum of the distance `|t_Q - t_P|` of the two frames and, for each
//! body, the largest distance of a vertex from the origin of its frame. The *noise* `32 u S`, with `u = 2^-53`,
//! bounds the rounding error of a coordinate of a difference of two points.
//!
//! The bounds differ by at most [`Certificate::rounding`]. This is 15 noises, plus the bound on how far the
//! bodies reach beyond the support points of hill climbs, divided by `n . d`. If the search cannot reach this
//! accuracy, the query returns [`QueryError::NotConverged`]. A common displacement of both bodies does not
//! reduce the accuracy. The same input gives the same bits on every run, thread and platform.
//!
//! A tracker does not carry over numbers: certificates are computed from the current poses, so a tracked
//! answer is as accurate as a one-off one. `docs/theory/accuracy.md` lists which steps are exact and which
//! are rounded.

#![allow(
    rustdoc::private_intra_doc_links,
    reason = "the documentation of hidden modules links to private items"
)]

#[doc(hidden)]
pub mod answer;
#[doc(hidden)]
pub mod body;
#[doc(hidden)]
pub mod cast;
/// Options of [`Solver::Cta`], the paper's collision translation algorithm.
pub mod cta {
    pub use crate::solve::cta::options::{Cuts, InvalidUntil, Options, Region, Start, Until};
}
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
    DirectionalDepth, Distance, Enclosure, FreeReason, Grazing, Intersection, NearPoints, Outcome,
    OverlapAhead, PlaneGap, Proof, Separated, Separation, Solver, StartedFrom, Steps, Within,
};
pub use body::error::{BuildError, TopologyError};
pub use body::{
    Aabb, Body, ConvexPolyhedron, ConvexityDefect, FaceId, Feature, Features, HalfEdge, InputFacet,
    InputVertex, Moving, ObstacleId, OffsetReport, Placed, Pose, VertexId, convexity_defect,
};
#[cfg(feature = "json")]
pub use cast::{Case, CaseError};
pub use cast::{Cast, CastBody, WitnessPoints, cast};
pub use colltrans_kernel::PoseError;
pub use colltrans_kernel::range::{MAX_MAGNITUDE, MIN_MAGNITUDE};
pub use colltrans_kernel::serialization::UnknownName;
pub use glam;
pub use pair::{Pair, PairBody, PairProof};
pub use setting::VertexPair;
pub use setting::error::{QueryError, Stalled};
pub use solve::observe;
pub use solve::options::{Focus, Options};
pub use tracker::Tracker;
