//! Exact collision queries of rigid polyhedra: shape casts, swept collisions under rotation, distances,
//! penetration depths and removal directions. Bounds of each answer enclose the exact result.
//! A *certificate* proves them, for solids on request. A program can verify it without a search and without
//! trust in this library.
//!
//! ```
//! use colltrans::glam::DVec3;
//! use colltrans::{Cast, ConvexPolyhedron, Outcome, Pose};
//!
//! // A cube, 3 above a plate, moves downwards.
//! let cube = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE)?;
//! let plate = ConvexPolyhedron::cuboid(DVec3::new(-2.0, -2.0, -1.0), DVec3::new(2.0, 2.0, 0.0))?;
//! let start = Pose::from_translation(DVec3::Z * 3.0)?;
//! let cast = Cast::new(cube.at(start), plate.at(Pose::IDENTITY), DVec3::NEG_Z)?;
//! let Outcome::Contact(contact) = cast.first_contact()? else { panic!("the plate is below") };
//! assert_eq!((contact.translation, contact.normal), (3.0, DVec3::NEG_Z));
//! assert!(cast.verify(&contact.certificate)? <= contact.certificate.rounding);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Questions
//!
//! | question | query | answer |
//! |---|---|---|
//! | How far can a body move before it touches another? | [`Cast::first_contact`], short [`cast()`] | [`Outcome`] |
//! | Where is the first, where the last contact? | [`Cast::contact_range`] | [`ContactRange`] |
//! | How far can it move from where it is, and what stops it? | [`Cast::clearance`] | [`Clearance`] |
//! | How far back until an overlap ends? | [`Cast::directional_depth`] | [`DirectionalDepth`] |
//! | Do the bodies intersect in their poses? | [`Cast::intersects`] | [`Intersection`] |
//! | How far apart are they, and where? | [`Pair::distance`] | [`Distance`] |
//! | How far apart, as two bounds? | [`Pair::distance_bounds`] | `[f64; 2]` |
//! | Are they closer than a length? | [`Pair::within`] | [`Within`] |
//! | How deep do they overlap? | [`Pair::depth`] | [`Depth`] |
//! | When do rotating bodies meet? | [`MotionCast`](motion::MotionCast) | [`MotionOutcome`](motion::MotionOutcome) |
//! | Which links of a robot meet? | [`PathCast`](motion::path::PathCast) | [`PathOutcome`](motion::path::PathOutcome) |
//! | Along which directions can a body be removed? | [`removal::directions`] | all of them, classified |
//! | In which moves can a body be removed? | [`removal::path`] | a path, or a proof of none |
//! | Which of many bodies is nearest? | [`SceneQuery::nearest`] | [`Nearest`] |
//! | Which of them are closer than a length? | [`SceneQuery::within`] | [`Nearby`] |
//! | Which of them stops a body first? | [`SceneQuery::clearance`] | [`SceneClearance`] |
//! | Does a proof hold? | [`Cast::verify`] | the proven gap |
//! | What if the same pair moves on and on? | [`Tracker`], [`FixedRotations`] | those of a cast |
//!
//! The crate `colltrans-mesh` reads bodies from files, `colltrans-assembly` plans and audits assemblies, `colltrans-cli`
//! is the command line program.
//!
//! # Casts
//!
//! A body `P`, the *moving* one, is translated along a direction `d`. A body `Q` is *fixed*. A [`Cast`] computes the
//! *collision translation*
//!
//! `coll = min { t : P + t d meets Q }`
//!
//! together with the contact normal, bounds that enclose `coll`, a contact point on each body
//! ([`Contact::witness_points`]), and the vertices, edges or faces in contact ([`Contact::features`]). If the bodies
//! never meet, the cast proves it. `t` ranges over all real numbers. A negative value is a contact behind the moving
//! body, or an overlap at the start.
//!
//! # Bodies
//!
//! A [`ConvexPolyhedron`] is built once, from points ([`ConvexPolyhedron::from_points`], their convex hull),
//! from a closed mesh ([`ConvexPolyhedron::from_mesh`], checked) or from two corners
//! ([`ConvexPolyhedron::cuboid`]). It can be [rounded](ConvexPolyhedron::rounded) by a radius: spheres and
//! capsules. Any number of queries can use it, from any thread. Flat polygons, segments
//! and single points are also bodies. Bodies that need not be convex are [`Solid`]s, with the same queries.
//!
//! # Frames and units
//!
//! Vertices are in the *body frame*. A [`Pose`] maps a body to the *world frame* by `x_world = R x_body + t`.
//! Directions, normals and points of answers are in the world frame. Both bodies have the same unit of
//! length, which the caller chooses. Translations are multiples of the direction, so they are lengths if the
//! direction has length 1. Normals are unit vectors and point from the moving body to the fixed one. Numbers
//! are `f64`. Numbers other than 0 have magnitudes from [`MIN_MAGNITUDE`] to [`MAX_MAGNITUDE`], `2^-200` to
//! `2^200`.
//!
//! # Answers
//!
//! Convex bodies and solids have the same queries and types of answers, for example `Clearance<Solid>`, with
//! different types of contacts. The directional depth and trackers exist only for convex bodies, the [least
//! tolerance](solid::SolidCast::least_tolerance) only for solids. Answers about convex bodies contain their
//! proofs. A proof between solids costs more and is requested separately, for example by
//! [`certified_clearance`](solid::SolidCast::certified_clearance). Queries about a solid and a convex body
//! (`Cast::between`), and queries of solids alone, need `use colltrans::solid::{SolidCast, SolidPair};`.
//!
//! A [`Tracker`] answers the same queries and starts from its last answer. It is meant for bodies that move
//! little between two queries.
//!
//! An [`Outcome`] is a [`Contact`], [`Separated`] or [`Grazing`]. The *shadows* of the bodies, their
//! projections along the direction, decide which: disjoint shadows are a separation, overlapping ones a
//! contact. If they overlap by no more than the *graze tolerance*, the bodies slide along each other, for
//! example a peg in a hole of its own size. This is an outcome of its own. It includes the contact that
//! results if the overlap is considered real, and the caller decides whether it blocks. For
//! [`Cast::clearance`] it does not block. The default tolerance is the limit of rounding, eight times the
//! *noise*. [`Cast::with_graze_tolerance`] sets a larger one as a length.
//!
//! # Accuracy
//!
//! The bounds of a contact enclose the exact collision translation of the given bodies:
//! [`Certificate::lower`] `<= coll <=` [`Certificate::upper`]. They differ by at most [`Certificate::rounding`]:
//! 15 *noises*, plus the bound on how far the bodies reach beyond their support points, divided by `n . d`. A noise is
//! `32 u S`, where `S` is the size of the configuration and `u = 2^-53`. The same input gives the same bits on every
//! run, thread and platform.
//!
//! # Serialisation
//!
//! With the feature `serde`, answers, proofs, features, poses and options can be serialised. An enum variant
//! is written as its name in snake case (for example `blocked`) with its contents, an option as the name that
//! it prints and parses, a pose by its columns, and an infinite bound as `null`. Numbers are read back with
//! the same bits. Poses and the options of a cast are checked when they are read. A proof is not checked
//! before [`Cast::verify`]. The structs of `record` are answers in the form of the front ends, for users and
//! programs that do not check proofs. The feature `json` adds files of whole queries and proofs (`Case`,
//! `ProofFile`).
//!
//! # Compatibility
//!
//! Options, contacts, amounts of work and errors may get more fields or variants. Therefore build options
//! from their defaults (`Options::default().with_solver(..)`), and match with `..`. Vectors and matrices are
//! those of [`glam`], which is exported as `colltrans::glam` so that versions match. A new major version of
//! `glam` (a minor one while it is `0.x`) means a new major version of this crate (a minor one while it is
//! `0.x`).
//!
//! # Algorithm
//!
//! The Minkowski difference `M = {q - p}` is never built. A search finds the face of `M` that the line `t d`
//! enters first. *Portal refinement*, a method of Snethen (`XenoCollide`, 2008), exchanges the corners of a
//! triangle of points of `M` that the line pierces. It runs alone, or after the *collision translation
//! algorithm*, a convex minimisation over pairs of planar sections of the bodies. Reference: Mirolo, Carpin
//! and Pagello, "Incremental Convex Minimization for Computing Collision Translations of Convex Polyhedra",
//! IEEE Transactions on Robotics 23(3), 2007, which comments call *the paper*. Both methods end in the same
//! portal. The plane of this portal gives the lower bound, its corners give the upper bound. If rounding
//! prevents a decision on which side of an edge the line passes, exact integers decide.
//!
//! # Features
//!
//! `solid`, `motion`, `removal`, `scene` and `min-gap` (casts with a minimum gap) are on by default. Without
//! them the crate is the convex core alone, and of the project's crates only `colltrans-kernel` and
//! `colltrans-convex` are compiled. `serde` enables `solid`, `motion`, `removal` and `scene`; `json` enables
//! `serde`.
//!
//! # Crates
//!
//! The code is in several crates, each of which uses only the previous ones: `colltrans-kernel` (numbers,
//! predicates, poses), `colltrans-convex` (convex bodies), `colltrans-solid`, then `colltrans-removal`
//! ([`removal`]), `colltrans-scene` ([`SceneQuery`], [`FixedRotations`]) and `colltrans-motion`
//! ([`motion`]), and `colltrans-proof` (proof files, `record`). [`solid`] contains items for solids only.

#[cfg(feature = "motion")]
pub mod motion;
/// Removal of a solid from others: the set of free translation directions, and paths of several moves.
#[cfg(feature = "removal")]
pub mod removal {
    #[doc(inline)]
    pub use colltrans_removal::{directions, path};
}
#[cfg(feature = "solid")]
pub mod solid;

#[doc(inline)]
pub use colltrans_convex::{
    Aabb, Body, Bounded, BuildError, Cast, CastBody, CentralCast, Certificate, CertificateError,
    Clearance, Contact, ContactRange, ConvexPolyhedron, ConvexityDefect, Depth, DirectionalDepth,
    Distance, Enclosure, FaceId, Feature, Features, Focus, FreeReason, Grazing, HalfEdge,
    InputFacet, InputVertex, Intersection, MAX_MAGNITUDE, MIN_MAGNITUDE, NearPoints, ObstacleId,
    OffsetReport, Options, Outcome, OverlapAhead, Pair, PairBody, PairProof, Placed, PlaneGap,
    Pose, PoseError, Proof, QueryError, Separated, Separation, Solver, Stalled, StartedFrom, Steps,
    TopologyError, Tracker, UnknownName, VertexId, VertexPair, Within, WitnessPoints,
    convexity_defect, cta, observe,
};
// Only the function, because a module of the core has the same name.
#[doc(inline)]
pub use colltrans_convex::cast::cast;
#[doc(no_inline)]
pub use colltrans_convex::glam;
#[cfg(feature = "json")]
#[doc(inline)]
pub use colltrans_convex::{Case, CaseError};
#[cfg(feature = "serde")]
#[doc(inline)]
pub use colltrans_proof::record;
#[cfg(feature = "json")]
#[doc(inline)]
pub use colltrans_proof::{
    Contacts, DistanceStatement, FreeStatement, ProofError, ProofFile, ProofFileError, Proven,
    Slide, Statement, Stop, Verify,
};
#[cfg(feature = "scene")]
#[doc(inline)]
pub use colltrans_scene::{
    ApartProof, ClearanceProof, Nearby, NearbyProof, Nearest, NearestProof, ObstacleClearanceProof,
    Obstacles, SceneClearance, SceneProof, SceneQuery, SceneSteps, UnknownObstacle,
};
#[cfg(feature = "scene")]
#[doc(inline)]
pub use colltrans_scene::{DirectionMap, FixedRotations};
#[cfg(feature = "solid")]
#[doc(inline)]
pub use colltrans_solid::{AnyBody, AnyClearance, AnyDistance, AnyNear, AnyPlaced, ByKind, Solid};

/// The example of this crate's README, compiled and run as a test.
#[cfg(all(doctest, feature = "json"))]
#[doc = include_str!("../README.md")]
pub struct CrateReadme;

/// The example of the repository's README, compiled and run as a test.
#[cfg(all(doctest, feature = "json"))]
#[doc = include_str!("../../../README.md")]
pub struct Readme;

/// The examples of `docs/guide/casts.md`, compiled and run as tests.
#[cfg(all(doctest, feature = "json"))]
#[doc = include_str!("../../../docs/guide/casts.md")]
pub struct Casts;

/// The examples of `docs/guide/distance.md`, compiled and run as tests.
#[cfg(all(doctest, feature = "json"))]
#[doc = include_str!("../../../docs/guide/distance.md")]
pub struct Distances;

/// The examples of `docs/guide/rounded.md`, compiled and run as tests.
#[cfg(all(doctest, feature = "json"))]
#[doc = include_str!("../../../docs/guide/rounded.md")]
pub struct Rounded;

/// The examples of `docs/guide/scenes.md`, compiled and run as tests.
#[cfg(all(doctest, feature = "json"))]
#[doc = include_str!("../../../docs/guide/scenes.md")]
pub struct Scenes;

/// The examples of `docs/guide/directions.md`, compiled and run as tests.
#[cfg(all(doctest, feature = "json"))]
#[doc = include_str!("../../../docs/guide/directions.md")]
pub struct Directions;

/// The examples of `docs/guide/motions.md`, compiled and run as tests.
#[cfg(all(doctest, feature = "json"))]
#[doc = include_str!("../../../docs/guide/motions.md")]
pub struct Motions;

/// The examples of `docs/guide/robots.md`, compiled and run as tests.
#[cfg(all(doctest, feature = "json"))]
#[doc = include_str!("../../../docs/guide/robots.md")]
pub struct Robots;

/// The examples of `docs/reference/solids.md`, compiled and run as tests.
#[cfg(all(doctest, feature = "json"))]
#[doc = include_str!("../../../docs/reference/solids.md")]
pub struct Solids;

/// The examples of `docs/guide/proofs.md`, compiled and run as tests.
#[cfg(all(doctest, feature = "json"))]
#[doc = include_str!("../../../docs/guide/proofs.md")]
pub struct Proofs;

/// The example of the README of `colltrans-kernel`, compiled and run as a test.
#[cfg(all(doctest, feature = "json"))]
#[doc = include_str!("../../colltrans-kernel/README.md")]
pub struct KernelReadme;

/// The example of the README of `colltrans-convex`, compiled and run as a test.
#[cfg(all(doctest, feature = "json"))]
#[doc = include_str!("../../colltrans-convex/README.md")]
pub struct ConvexReadme;

/// The example of the README of `colltrans-solid`, compiled and run as a test.
#[cfg(all(doctest, feature = "json"))]
#[doc = include_str!("../../colltrans-solid/README.md")]
pub struct SolidBodiesReadme;

/// The example of the README of `colltrans-motion`, compiled and run as a test.
#[cfg(all(doctest, feature = "json"))]
#[doc = include_str!("../../colltrans-motion/README.md")]
pub struct RotationReadme;

/// The example of the README of `colltrans-removal`, compiled and run as a test.
#[cfg(all(doctest, feature = "json"))]
#[doc = include_str!("../../colltrans-removal/README.md")]
pub struct RemovalReadme;

/// The example of the README of `colltrans-scene`, compiled and run as a test.
#[cfg(all(doctest, feature = "json"))]
#[doc = include_str!("../../colltrans-scene/README.md")]
pub struct SceneReadme;

/// The example of the README of `colltrans-proof`, compiled and run as a test.
#[cfg(all(doctest, feature = "json"))]
#[doc = include_str!("../../colltrans-proof/README.md")]
pub struct ProofFilesReadme;
