//! Convex bodies: how far can one move before it touches another? Casts, distances, depths, and certificates of them.
//!
//! Programs use the facade `colltrans`, whose documentation tells what is asked and answered. Modules that are hidden from
//! the documentation are for the crates of this workspace, without a promise.
//!
//! # Modules
//!
//! Each module uses only those before it, but for what bounds say of an answer's ends (`answer::RangeEnd`).
//!
//! - `body`: a body is checked and indexed once. `inertia` and `feature` follow. `convex` is [`ConvexPolyhedron`]: `build` makes it (hulls on exact orientations, meshes, offsets), `support`
//!   finds support points in `O(log n)`, along a `ring` by its angle and around the apex of a `fan`, `excess` bounds how far
//!   a body reaches beyond one, and `sections` are planar sections across four axes, made when the paper's algorithm first
//!   asks. [`Body`] is what a kind of body brings.
//! - `setting`: two placed bodies, and of a cast a direction, in a frame at the moving body's translation. `minkowski` is `M`
//!   seen along `d`: support points, noise, and on which side of an edge the line passes.
//! - `answer`: outcomes, ranges, bounds, and `certificate`, which anyone can check.
//! - `solve`: one cast. `portal` is portal refinement: from any guess to the face of `M` that the line enters, with exact
//!   decisions; the plane and triangle it ends with are the certificate. `outline` takes bodies with rims for hulls of
//!   ellipses, `ascent` finds where these meet. `cta` is the paper's algorithm: it minimises `phi(x, y)`, the collision
//!   translation of two planar sections, by cutting planes in floating point; its result is a guess of the contact normal.
//!   `nearest` descends to the nearest point of `M` over its simplices, `depth` grows a polytope of points of `M` where the
//!   origin is nearest. `keep` finds how far until a gap is left, by Newton's method over nearest points. `observe` lets an
//!   observer hear of every step.
//! - `cast`: [`Cast`], the query. `derive` has answers of more than one cast, `contact` points and features on request,
//!   `replay` a query as a file. [`CastBody`] is the trait by which other kinds of bodies are cast.
//! - `pair`: [`Pair`], what is asked of two placed bodies without a direction, and the checks of its proofs.
//! - `tracker`: the same questions, each begun from the last answer.
//!
//! Both solvers end in `portal`: `cta` carries the rounding of sections, while the last digits are a combinatorial matter,
//! which face of `M` the line enters. So there is one finish, one error analysis and one thing to test, and a wrong guess
//! costs time but never correctness.
//!
//! # Accuracy
//!
//! A contact's bounds enclose the true collision translation of the bodies as given, exactly:
//! [`Certificate::lower`] `<= coll <=` [`Certificate::upper`], where a body is the convex hull of
//! its [`vertices`](ConvexPolyhedron::vertices), placed by the nine entries of its pose's matrix and
//! its translation. They enclose that of the points that the bodies were made from, too: what a hull leaves
//! outside ([`ConvexPolyhedron::hull_error`]) is taken off lower bounds. [`Contact::translation`] is the best
//! estimate between them.
//!
//! Let `S` be the size of the configuration: the largest distance of a vertex from the origin of
//! its body frame, for each body, plus the distance `|t_Q - t_P|` of the two frames. The *noise*
//! `32 u S`, with `u = 2^-53`, bounds the rounding error of a coordinate of a difference of two
//! points. The bounds differ by at most 15 noises, and what a body may reach beyond a support point
//! that was found by climbing, divided by `n . d` ([`Certificate::rounding`]); if they do not come
//! that close, the query returns [`QueryError::NotConverged`], never a number. A displacement of both
//! bodies together costs the translation nothing. The same input gives the same bits on every run,
//! thread and platform.
//!
//! # Coherence
//!
//! A tracker keeps what a cast ended with: three pairs of vertices, or a separating direction. The next cast tries
//!
//! 1. *Features* (`portal/follow`): do the three pairs still enclose the line? If it left over an edge, the next
//!    face is found by gift wrapping; if it is many faces away, slopes and curvatures say where to look.
//! 2. *Region* (`cta` only; the paper, III-D): the minimisation starts at the last contact points and is
//!    confined to a square of levels around them, until that fails.
//! 3. *Scratch*, as a one-off query does.
//!
//! Certificates are made anew from today's poses. Nothing numerical is carried over, so a tracked answer is
//! exactly as tight as a one-off one.
//!
//! # Numbers: what is exact, what is rounded
//!
//! All bounds are derived in the head of `colltrans_kernel::noise`, in multiples of `u S`: `u = 2^-53`, `S` the size of the
//! configuration. *Exact*: the orientations that decide what a hull has, and on which side of an edge the line
//! passes (a rounded determinant where its error allows, whole numbers otherwise; ties as if the line were
//! moved by `(eps, eps^2)`, consistently). *Rounded with a bound*: everything else. *Only guesses*: sections,
//! ellipsoids, tables.
//!
//! - A body is the convex hull of its `vertices()`, exactly. Points within `64 u r` of a face are dropped, and
//!   `hull_error` bounds how far from the body any input point was left.
//! - A plane supports `M` when no support point is deeper below it than one noise, `32 u S`. Projections that
//!   overlap by less than eight noises are *touching*: the outcome is grazing.
//! - The lower bound is lowered by one noise over `n . d` and by what bodies may reach beyond support points, the
//!   upper bound raised by four: `lower <= coll <= upper` holds exactly. A clearance is the lower bound.
//! - No function of libm but the square root is called, sine and cosine are `colltrans_kernel::angle`: bits are the same on every platform (`crates/colltrans/tests/golden.rs`).

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
/// The choices of [`Solver::Cta`], the paper's collision translation algorithm.
pub mod cta {
    pub use crate::solve::cta::options::{Cuts, NoUntil, Options, Region, Start, Until};
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
pub use solve::options::{Focus, Options};
pub use tracker::Tracker;
