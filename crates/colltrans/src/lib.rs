//! Collision translations of convex polyhedra: how far can one body move before it touches
//! another?
//!
//! A convex body `P`, the *moving* one, is translated along a direction `d`; a convex body `Q`
//! is *fixed*. A [`Cast`] asks for the *collision translation*
//!
//! `coll = min { t : P + t d meets Q }`
//!
//! and gets it with the contact normal, bounds that enclose it exactly, a contact point on each body
//! and the vertices, edges or faces that meet; or a proof that they never do. `t` ranges over all
//! real numbers: a negative answer is a contact that lies behind, or an overlap now. Every answer
//! carries a proof that can be checked without trusting the search that found it.
//!
//! ```
//! use colltrans::glam::DVec3;
//! use colltrans::{Cast, ConvexPolyhedron, Outcome, Pose};
//!
//! // A pyramid one unit high, and a plate of 4 x 4 x 1 whose top is at z = 0.
//! let pyramid = ConvexPolyhedron::from_points(&[
//!     DVec3::new(-1.0, -1.0, 1.0),
//!     DVec3::new(1.0, -1.0, 1.0),
//!     DVec3::new(1.0, 1.0, 1.0),
//!     DVec3::new(-1.0, 1.0, 1.0),
//!     DVec3::ZERO,
//! ])?;
//! let plate = ConvexPolyhedron::cuboid(DVec3::new(-2.0, -2.0, -1.0), DVec3::new(2.0, 2.0, 0.0))?;
//!
//! // The pyramid starts with its apex at (0.5, 0, 3) and moves downwards.
//! let start = Pose::from_translation(DVec3::new(0.5, 0.0, 3.0))?;
//! let cast = Cast::new(pyramid.at(start), plate.at(Pose::IDENTITY), DVec3::NEG_Z)?;
//! let Outcome::Contact(contact) = cast.first_contact()? else {
//!     unreachable!("the plate is below")
//! };
//! assert_eq!(contact.translation, 3.0);
//! assert_eq!(contact.normal, DVec3::NEG_Z);
//! assert_eq!(contact.points(&cast).on_fixed, DVec3::new(0.5, 0.0, 0.0));
//! let features = contact.features(&cast);
//! assert_eq!((features.moving.kind(), features.fixed.kind()), ("vertex", "face"));
//!
//! // The proof: checked against the two bodies alone.
//! assert!(cast.verify(&contact.certificate)? <= contact.certificate.rounding);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Bodies
//!
//! A [`ConvexPolyhedron`] is built once, from points ([`ConvexPolyhedron::from_points`], their
//! convex hull), from a closed mesh ([`ConvexPolyhedron::from_mesh`], checked) or from two corners
//! ([`ConvexPolyhedron::cuboid`]), and then asked as often as one likes, from any thread. Flat
//! polygons, segments and single points are bodies too. Bodies that are not convex are [`Solid`]s,
//! asked in the same way.
//!
//! # Frames and units
//!
//! Vertices are in the *body frame*; a [`Pose`] places a body in the *world*, by
//! `x_world = R x_body + t`. Directions, normals and points of answers are in the world.
//! The unit of length is the caller's, the same for both bodies. Translations are counted in
//! multiples of the direction, so they are lengths if the direction has length 1. Normals are
//! unit vectors and point from the moving body to the fixed one. Numbers are `f64`; those that
//! are not 0 have magnitudes from [`MIN_MAGNITUDE`] to [`MAX_MAGNITUDE`], `2^-200` to `2^200`.
//!
//! # Questions and answers
//!
//! | query | question | answer |
//! |---|---|---|
//! | [`Cast::first_contact`], short [`cast()`] | at which translation do the bodies first meet? | [`Outcome`] |
//! | [`Cast::contact_range`] | at which do they first and last meet? | [`ContactRange`] |
//! | [`Cast::clearance`] | how far can one move from where it is? | [`Clearance`] |
//! | [`Cast::directional_depth`] | how far must one go back until the overlap ends? | [`DirectionalDepth`] |
//! | [`Cast::intersects`] | do they meet where they are? | [`Intersection`] |
//! | [`Cast::verify`] | is this proof one? | the gap proven |
//! | [`Pair::distance`] | how far apart are they, and where? | [`Distance`] |
//! | [`Pair::within`] | are they closer than a length? | [`Within`] |
//! | [`Pair::depth`] | which least translation parts them? | [`Depth`] |
//! | [`motion::MotionCast::first_contact`] | of bodies that turn: when do they first meet? | [`motion::MotionOutcome`] |
//! | [`motion::path::PathCast::first_contact`] | of bodies that joints carry: which first meet, and when? | [`motion::path::PathOutcome`] |
//! | [`Among::nearest`] | which of many is nearest? | [`Nearest`] |
//! | [`Among::within`] | which of many are closer than a length? | [`Nearby`] |
//! | [`Among::clearance`] | which of many is hit first, and how far is it? | [`ClearanceAmong`] |
//!
//! Both kinds of bodies are asked in these words and answer in these types, `Clearance<Solid>` and so on,
//! with contacts of their own; directions to go back, and trackers, are of convex bodies alone, the
//! [least tolerance](solid::SolidCast::least_tolerance) of solids. Answers about convex bodies carry their proofs;
//! between solids a proof costs more and is asked for apart, by
//! [`certified_clearance`](solid::SolidCast::certified_clearance). Queries of a solid and a convex body together
//! (`Cast::between`), and those that only solids answer, need `use colltrans::solid::{SolidCast, SolidPair};`.
//!
//! A [`Tracker`] answers the same questions, starting from its last answer: for bodies that move a
//! little between two queries.
//!
//! An [`Outcome`] is a [`Contact`], [`Separated`] or [`Grazing`]. The bodies' *shadows*, their
//! projections along the direction, decide: disjoint shadows are a separation, overlapping
//! ones a contact. Where they overlap by no more than the *graze tolerance* the bodies slide
//! along each other, as a peg does in a hole of its own size. That is an outcome of its own,
//! with the contact that results if the overlap is taken for real: whether it blocks is for the
//! caller to say ([`Cast::clearance`] says it does not). The default tolerance is what rounding
//! cannot decide, eight times the *noise*; a larger one may be set as a length by
//! [`Cast::with_graze_tolerance`].
//!
//! # Accuracy
//!
//! A contact's bounds enclose the true collision translation of the bodies as given:
//! [`Certificate::lower`] `<= coll <=` [`Certificate::upper`]. They differ by at most 15 *noises* (`32 u S`, with `S` the
//! size of the configuration and `u = 2^-53`) divided by `n . d`. [`Certificate`] says it in full. The same input gives
//! the same bits on every run, thread and platform.
//!
//! # As data
//!
//! With the feature `serde` answers, proofs, features, poses and choices can be written and read in any
//! of its formats. A case of several is written as its name in lower case (`blocked`, with what it
//! holds), choices by the names that they print and parse, a pose column by column, an infinite bound as
//! nothing (`null`). Numbers come back as the same bits. What is read is checked where it is a pose or a
//! choice of a cast; a proof is read, and believed by nobody before [`Cast::verify`]. An answer as front
//! ends write it, for people and programs that do not check it, is a struct of `record`. The feature
//! `json` adds whole queries and proofs as files (`Case`, `ProofFile`).
//!
//! # What may change
//!
//! Choices, contacts, counts of work and errors may grow: make choices from their defaults
//! (`Options::default().with_solver(..)`), match with `..`. Vectors and matrices are those of [`glam`],
//! which is exported as `colltrans::glam`: use that one, and versions fit. A new major version of
//! `glam` (a minor one while that is `0.x`) makes a new major version of this crate (minor while `0.x`).
//!
//! # How it works
//!
//! The Minkowski difference `M = {q - p}` is never built. A search narrows down which face of `M`
//! the line `t d` enters first: *portal refinement*, which exchanges the corners of a triangle of
//! points of `M` that the line pierces, alone or after the *collision translation algorithm*,
//! a convex minimisation over pairs of planar sections of the bodies (Mirolo, Carpin and Pagello,
//! "Incremental Convex Minimization for Computing Collision Translations of Convex
//! Polyhedra", IEEE Transactions on Robotics 23(3), 2007: *the paper* of all comments). Both end
//! in the same portal, whose plane is the lower bound and whose corners are the upper one.
//! Ties, where rounding cannot tell on which side of an edge the line passes, are decided in
//! whole numbers.
//!
//! # Features
//!
//! `solid`, `motion`, `removal`, `scene` and `keep` (casts with a minimum gap) are on by default. Without them the crate
//! is the convex core alone: no other crate of the project but `colltrans-kernel` and `colltrans-convex` is compiled.
//! `serde` and `json` bring all questions.
//!
//! # Crates
//!
//! The code is in crates of its own, each using only those before it: `colltrans-kernel` (numbers, predicates, poses),
//! `colltrans-convex` (convex bodies), `colltrans-solid`, then `colltrans-removal` ([`free`], [`ways`]), `colltrans-scene`
//! ([`Among`], [`FixedRotations`]) and `colltrans-motion` ([`motion`]), and `colltrans-proof` (files). [`solid`] holds what
//! is of solids alone.

#[cfg(feature = "motion")]
pub mod motion;
#[cfg(feature = "solid")]
pub mod solid;

#[doc(inline)]
pub use colltrans_convex::{
    Aabb, Body, Bounded, BuildError, Cast, CastBody, CentralCast, Certificate, CertificateError,
    Clearance, Contact, ContactRange, ConvexPolyhedron, ConvexityDefect, Depth, DirectionalDepth,
    Distance, Enclosure, FaceId, Feature, Features, Focus, Grazing, HalfEdge, InputFacet,
    InputVertex, Intersection, MAX_MAGNITUDE, MIN_MAGNITUDE, NearPoints, ObstacleId, OffsetReport,
    Options, Outcome, OverlapAhead, Pair, PairBody, PairProof, Placed, PlaneGap, Pose, PoseError,
    Proof, QueryError, Separated, Separation, Solver, Stalled, StartedFrom, Steps, TopologyError,
    Tracker, UnknownName, VertexId, VertexPair, WhyFree, Within, WitnessPoints, convexity_defect,
    cta, observe,
};
// The function alone: the name of the core's module is the same.
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
#[cfg(feature = "removal")]
#[doc(inline)]
pub use colltrans_removal::{free, ways};
#[cfg(feature = "scene")]
#[doc(inline)]
pub use colltrans_scene::{
    Among, AmongProof, AmongSteps, ApartProof, ClearanceAmong, ClearanceProof, Nearby, NearbyProof,
    Nearest, NearestProof, Obstacles, PassedProof, UnknownObstacle,
};
#[cfg(feature = "scene")]
#[doc(inline)]
pub use colltrans_scene::{Approach, FixedRotations};
#[cfg(feature = "solid")]
#[doc(inline)]
pub use colltrans_solid::{AnyBody, AnyClearance, AnyDistance, AnyNear, AnyPlaced, ByKind, Solid};

/// The example of the README, compiled and run as a test.
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
