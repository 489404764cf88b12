//! Distance, penetration depth and proximity of two bodies, with proven bounds.
//!
//! Notation: `M = {q - p : p in P, q in Q}`. The distance is that of `M` from the origin. If `M` contains the
//! origin, the depth is the distance of the origin from the boundary of `M`.
//!
//! - Distance, lower bound: for any `n`, `|q - p| >= (min_Q n.q - max_P n.p) / |n|`.
//! - Distance, upper bound: a point of each body.
//! - Depth, lower bound: a closed triangulated surface around the origin, whose corners are points of `M`.
//!   `M` contains everything that the surface encloses, because `M` is convex.
//! - Depth, upper bound: a translation by `-min_M n.m` against a unit normal `n` separates the bodies.

use derive_where::derive_where;
use glam::DVec3;

use crate::answer::Steps;
use crate::body::{Body, ConvexPolyhedron, Features};
use crate::setting::VertexPair;

/// The answer of [`Pair::distance`](crate::Pair::distance): the distance of the bodies, and their nearest
/// points.
///
/// `lower <= true distance <= upper` holds exactly, for the bodies as given and for the points that they were
/// built from.
#[derive(Debug)]
#[derive_where(Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(bound = ""))]
pub struct Distance<B: Body = ConvexPolyhedron> {
    /// Gap of a plane between the bodies, in world units, rounded down. It is 0 if no plane was found: the
    /// bodies overlap, or their distance is below the rounding error.
    pub lower: f64,
    /// Distance of two points of the bodies, in world units, rounded up; 0 if the bodies are proven to meet.
    pub upper: f64,
    /// Point of the moving body that is nearest to the fixed one, in the world, rounded. For overlapping
    /// bodies, a point of both.
    pub on_moving: DVec3,
    /// Point of the fixed body that is nearest to the moving one, in the world, rounded.
    pub on_fixed: DVec3,
    /// Unit normal of the plane, in the world, pointing from the moving body to the fixed one; `None` without
    /// a plane.
    pub normal: Option<DVec3>,
    /// Parts of the bodies that lie in the planes perpendicular to the normal; `None` without a plane.
    pub features: Option<Features>,
    /// Proof of the upper bound.
    pub near: B::Near,
    /// Proof of the lower bound; `None` if that is 0.
    pub gap: Option<B::Gap>,
    /// Work done.
    #[cfg_attr(feature = "serde", serde(default))]
    pub steps: B::Steps,
}

impl<B: Body> Distance<B> {
    /// Returns `[lower, upper]`.
    pub const fn bounds(&self) -> [f64; 2] {
        [self.lower, self.upper]
    }
}

/// The answer of [`Pair::within`](crate::Pair::within): whether the bodies are closer than a length.
#[derive(Debug)]
#[derive_where(Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case", bound = "")
)]
pub enum Within<B: Body = ConvexPolyhedron> {
    /// The bodies are: the distance of two of their points is at most the length.
    Closer(B::Near),
    /// The bodies are not: the gap of a plane between them exceeds the length.
    Farther(B::Gap),
    /// The length lies between the bounds of [`Pair::distance`](crate::Pair::distance), which differ by at
    /// most a few noises.
    Undecided(Distance<B>),
}

/// Proof that the distance of two convex bodies is at least a number: a plane between them.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct PlaneGap {
    /// Unit normal in the world, from the moving body to the fixed one.
    pub normal: DVec3,
    /// Lower bound of `min_Q n.q - max_P n.p`, less the radii of rounded bodies, and of the distance, in world units,
    /// rounded down.
    pub gap: f64,
}

/// Proof that the distance of two convex bodies is at most a number: a point of each.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct NearPoints {
    /// Pairs of vertices whose weighted means are the points.
    pub pairs: [VertexPair; 4],
    /// Weights of the pairs, not negative. The points are `sum w_i p_i / sum w_i` and
    /// `sum w_i q_i / sum w_i`.
    pub weights: [f64; 4],
    /// Upper bound of the distance of the two points, less the radii of rounded bodies, in world units, rounded up.
    ///
    /// If it is 0, the differences of the pairs enclose the origin, so the bodies meet. The weights prove
    /// nothing in this case, except for rounded bodies: there the bodies also meet if the distance of the two points,
    /// which are points of the cores, is at most the sum of the radii.
    pub distance: f64,
}

/// The answer of [`Pair::depth`](crate::Pair::depth): the length of the shortest translation, in any
/// direction, that separates two convex bodies.
///
/// `lower <= true depth <= upper` holds exactly for the bodies as given. Both bounds are 0 if a plane is proven to
/// separate the bodies.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
#[non_exhaustive]
pub struct Depth {
    /// Lower bound, in world units, rounded down: the bodies overlap after every shorter translation of the
    /// moving body.
    pub lower: f64,
    /// Upper bound, in world units, rounded up: a translation of this length along `direction` separates the
    /// bodies.
    pub upper: f64,
    /// Direction of the separating translation of the moving body, a unit vector in the world. It proves the
    /// upper bound.
    pub direction: DVec3,
    /// Proof of the lower bound: for rounded bodies, of the depth of their cores.
    pub enclosure: Enclosure,
    /// For rounded bodies, points of the cores. If their distance is at most `d`, the depth is at least the sum of the
    /// radii less `d`. Used if `enclosure` is empty.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Option::is_none"))]
    pub near: Option<NearPoints>,
    /// Work done. A proof in a file omits this field.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Steps::is_zero"))]
    pub steps: Steps,
}

impl Depth {
    /// Returns `[lower, upper]`.
    pub const fn bounds(&self) -> [f64; 2] {
        [self.lower, self.upper]
    }

    /// Returns the translation of the moving body that separates the bodies, a vector in the world.
    pub fn translation(&self) -> DVec3 {
        self.direction * self.upper
    }
}

/// A closed triangulated surface around the origin, whose corners are points `q - p`. It is empty if no depth
/// is claimed.
#[derive(Debug, Clone, PartialEq, Default)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct Enclosure {
    /// Pairs of vertices whose differences are the corners.
    pub pairs: Vec<VertexPair>,
    /// Triangles, counter-clockwise as seen from outside, as indices into `pairs`.
    pub triangles: Vec<[u32; 3]>,
    /// For each triangle a unit vector along which all its corners are at least as far from the origin as the lower
    /// bound of the depth.
    pub normals: Vec<DVec3>,
}
