//! How far apart two bodies are, how deep they overlap, and whether they are closer than a length: with
//! bounds on either side, and what proves each.
//!
//! Notation. `M = {q - p : p in P, q in Q}`. The distance is that of `M` from the origin; the depth, if `M`
//! contains the origin, is that of the origin from the outside of `M`.
//!
//! - Distance from below: for any `n`, `|q - p| >= (min_Q n.q - max_P n.p) / |n|`.
//! - Distance from above: a point of each body.
//! - Depth from below: a closed surface of triangles between points of `M` that winds around the origin;
//!   `M` contains each of them and, being convex, all that they enclose.
//! - Depth from above: moved by `-min_M n.m` against a unit normal `n`, the bodies are parted.

use derive_where::derive_where;
use glam::DVec3;

use crate::answer::Steps;
use crate::body::{Body, ConvexPolyhedron, Features};
use crate::setting::VertexPair;

/// The answer of [`Pair::distance`](crate::Pair::distance): how far apart the bodies are, and where.
///
/// `lower <= true distance <= upper`, exactly, for the bodies as given, and for the points that they were made from.
#[derive(Debug)]
#[derive_where(Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(bound = ""))]
pub struct Distance<B: Body = ConvexPolyhedron> {
    /// The gap of a plane between the bodies, in world units, rounded down; 0 where none was found: they
    /// overlap, or are less apart than rounding can tell.
    pub lower: f64,
    /// The distance of two points of the bodies, rounded up; 0 where they are proven to meet.
    pub upper: f64,
    /// The point of the moving body that is nearest to the fixed one, in the world, rounded. Of bodies
    /// that overlap a point of both.
    pub on_moving: DVec3,
    /// The point of the fixed body that is nearest to the moving one.
    pub on_fixed: DVec3,
    /// Unit normal in the world, from the moving body to the fixed one: that of the plane, if there is one.
    pub normal: Option<DVec3>,
    /// The parts of the bodies that lie in the planes across the normal, if there is one.
    pub features: Option<Features>,
    /// What proves the upper bound.
    pub near: B::Near,
    /// What proves the lower bound, where that is not 0.
    pub gap: Option<B::Gap>,
    /// How much work it was.
    #[cfg_attr(feature = "serde", serde(default))]
    pub steps: B::Steps,
}

impl<B: Body> Distance<B> {
    /// `[lower, upper]`.
    pub const fn bounds(&self) -> [f64; 2] {
        [self.lower, self.upper]
    }
}

/// The answer of [`Pair::within`](crate::Pair::within): are the bodies closer than a length?
#[derive(Debug)]
#[derive_where(Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case", bound = "")
)]
pub enum Within<B: Body = ConvexPolyhedron> {
    /// They are: two points of them are at most the length apart.
    Closer(B::Near),
    /// They are not: the gap of a plane between them is more than the length.
    Farther(B::Gap),
    /// The length lies between the bounds that rounding leaves, at most a few noises apart: those of
    /// [`Pair::distance`](crate::Pair::distance).
    Undecided(Distance<B>),
}

/// The proof that two convex bodies are not nearer to each other than a number: a plane between them.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct PlaneGap {
    /// Unit normal in the world, from the moving body to the fixed one.
    pub normal: DVec3,
    /// At most `min_Q n.q - max_P n.p`, and so at most the distance; in world units, rounded down.
    pub gap: f64,
}

/// The proof that two convex bodies are not farther from each other than a number: a point of each.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct NearPoints {
    /// Pairs of vertices.
    pub pairs: [VertexPair; 4],
    /// Their weights, not negative: the points are `sum w_i p_i / sum w_i` and `sum w_i q_i / sum w_i`.
    pub weights: [f64; 4],
    /// At least the distance of the two points, in world units, rounded up. If 0, the differences of
    /// the pairs enclose the origin, so that the bodies meet; then the weights prove nothing.
    pub distance: f64,
}

/// The answer of [`Pair::depth`](crate::Pair::depth): the least translation, over all directions, that
/// parts two convex bodies.
///
/// `lower <= true depth <= upper`, exactly, for the bodies as given; both are 0 if they are apart.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
#[non_exhaustive]
pub struct Depth {
    /// The bodies overlap after every shorter translation of the moving body; rounded down.
    pub lower: f64,
    /// The length of a translation, along `direction`, after which they do not; rounded up.
    pub upper: f64,
    /// Unit vector in the world.
    pub direction: DVec3,
    /// What proves the lower bound; what proves the upper one is the direction.
    pub enclosure: Enclosure,
    /// How much work it was. A proof as a file does not say.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Steps::is_zero"))]
    pub steps: Steps,
}

impl Depth {
    /// `[lower, upper]`.
    pub const fn bounds(&self) -> [f64; 2] {
        [self.lower, self.upper]
    }

    /// The translation of the moving body that parts the bodies.
    pub fn translation(&self) -> DVec3 {
        self.direction * self.upper
    }
}

/// A closed surface of triangles around the origin, between points `q - p`; nothing if no depth is claimed.
#[derive(Debug, Clone, PartialEq, Default)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct Enclosure {
    /// The pairs of vertices whose differences are its corners.
    pub pairs: Vec<VertexPair>,
    /// Its triangles, counter-clockwise as seen from outside, by positions among the pairs.
    pub triangles: Vec<[u32; 3]>,
    /// For each triangle a unit vector along which all its corners are farther from the origin than the
    /// depth.
    pub normals: Vec<DVec3>,
}
