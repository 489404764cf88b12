//! Queries about two placed bodies without a direction: distance, proximity and penetration depth.

mod convex;
mod depth;
mod rounded;
mod verify;

use crate::answer::{
    CertificateError, Depth, Distance, Enclosure, NearPoints, PlaneGap, Within, impl_from_proofs,
};
use crate::body::{Body, ConvexPolyhedron, Features, Placed, Pose};
use crate::setting::TwoBodies;
use crate::setting::error::QueryError;
pub use convex::distance_from;
pub use convex::nearest_points_in_world;
use derive_where::derive_where;
pub use rounded::surface_points;

/// A kind of body for which a [`Pair`] can be answered. It is not meant to be implemented outside this
/// workspace.
pub trait PairBody: Body {
    /// The proofs that a pair can check.
    type PairProof<'p>;

    #[doc(hidden)]
    fn distance(pair: &Pair<'_, Self>) -> Result<Distance<Self>, QueryError>;
    /// Computes the bounds of [`Self::distance`] alone.
    #[doc(hidden)]
    #[inline]
    fn distance_bounds(pair: &Pair<'_, Self>) -> Result<[f64; 2], QueryError> {
        Ok(Self::distance(pair)?.bounds())
    }
    /// Decides whether the bodies are closer than a length, and counts the work.
    #[doc(hidden)]
    fn within(
        pair: &Pair<'_, Self>,
        length: f64,
    ) -> Result<(Within<Self>, Self::Steps), QueryError>;
    #[doc(hidden)]
    fn verify_pair(
        pair: &Pair<'_, Self>,
        proof: Self::PairProof<'_>,
    ) -> Result<f64, CertificateError>;
}

/// A moving body and a fixed one in their poses. Nothing moves; the names only distinguish the bodies, as in
/// a [`Cast`](crate::Cast).
///
/// A pair is cheap to build, because a search runs only when a query method is called.
#[derive(Debug)]
#[derive_where(Clone, Copy)]
pub struct Pair<'a, B: Body = ConvexPolyhedron> {
    #[doc(hidden)]
    pub bodies: TwoBodies<'a, B>,
}

/// A proof to check about two placed convex bodies.
#[derive(Debug, Clone, Copy)]
#[non_exhaustive]
pub enum PairProof<'a> {
    /// Proof that the distance is at least a number.
    Gap(&'a PlaneGap),
    /// Proof that the distance is at most a number.
    Near(&'a NearPoints),
    /// Proof of both bounds of a depth.
    Depth(&'a Depth),
    /// Proof that the depth of the cores, the bodies without their radii, is at least a number.
    Enclosure(&'a Enclosure),
}

impl_from_proofs!(
    PairProof { Gap(PlaneGap), Near(NearPoints), Depth(Depth), Enclosure(Enclosure) }
);

impl<'a, B: Body> Pair<'a, B> {
    /// Builds a pair of two placed bodies.
    ///
    /// # Errors
    /// Never fails at present, because every placed body is admissible.
    #[inline]
    pub fn new(moving: Placed<'a, B>, fixed: Placed<'a, B>) -> Result<Self, QueryError> {
        Ok(Self { bodies: TwoBodies::new(moving, fixed) })
    }

    /// Returns the moving body.
    pub fn moving(&self) -> &'a B {
        self.bodies.moving
    }

    /// Returns the fixed body.
    pub fn fixed(&self) -> &'a B {
        self.bodies.fixed
    }

    /// Returns the pose of the moving body.
    pub fn moving_pose(&self) -> Pose {
        self.bodies.moving_placed().pose
    }

    /// Returns the pose of the fixed body.
    pub fn fixed_pose(&self) -> Pose {
        self.bodies.fixed_placed().pose
    }
}

impl<B: PairBody> Pair<'_, B> {
    /// Computes the distance of the bodies and their nearest points.
    ///
    /// The bounds hold exactly. For convex bodies they differ by at most four noises (`128 u S`, see [the
    /// crate's introduction](crate#accuracy)), however close the bodies are. The difference may rarely reach
    /// 64 noises for thin or uneven bodies. In addition it includes the unevenness of faces and the distance
    /// by which inputs lie outside of their hulls.
    ///
    /// - Overlapping bodies have a lower bound of 0.
    /// - If the distance is a few noises or less, a plane may still prove a positive lower bound. Its gap is
    ///   computed from all vertices, nearly without rounding. Axis-aligned boxes with a distance of
    ///   `1e-60` are usually proven to be separated. If their corners are aligned as well, the bounds are 0
    ///   and a few noises.
    /// - For solids the bounds differ by at most five noises (`160 u S`). The distance is 0 if their surfaces
    ///   touch or if one contains the other. The distance of an open shell is that of its surface.
    ///
    /// # Errors
    /// Returns [`QueryError::NotConverged`] if a search of convex bodies ends without an answer.
    ///
    /// ```
    /// use colltrans::glam::DVec3;
    /// use colltrans::{ConvexPolyhedron, Pair, Pose};
    ///
    /// let cube = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE)?;
    /// let there = Pose::from_translation(DVec3::new(4.0, 5.0, 0.25))?;
    /// let pair = Pair::new(cube.at(Pose::IDENTITY), cube.at(there))?;
    ///
    /// let distance = pair.distance()?;
    /// assert!(distance.lower <= 5.0 && 5.0 <= distance.upper);
    /// assert!(distance.upper - distance.lower < 1e-13);
    /// let features = distance.features.expect("they are apart");
    /// assert_eq!((features.moving.kind(), features.fixed.kind()), ("edge", "edge"));
    /// // The proofs: checked against the two bodies alone.
    /// let gap = distance.gap.expect("they are apart");
    /// assert!(pair.verify(&gap)? >= distance.lower);
    /// assert!(pair.verify(&distance.near)? <= distance.upper);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[inline]
    pub fn distance(&self) -> Result<Distance<B>, QueryError> {
        B::distance(self)
    }

    /// Computes bounds of the distance, `[lower, upper]`, without points, features and proofs, which take longer than the
    /// search for small and round bodies.
    ///
    /// The bounds hold as exactly as those of [`Self::distance`]. Both may differ by a few noises, because the bounds of
    /// a point or sphere and a point, a sphere or a box along the axes of its frame are in closed form here.
    ///
    /// # Errors
    /// Returns the errors of [`Self::distance`].
    ///
    /// ```
    /// # use colltrans::glam::DVec3;
    /// # use colltrans::{ConvexPolyhedron, Pair, Pose};
    /// let ball = ConvexPolyhedron::sphere(DVec3::ZERO, 0.5)?;
    /// let there = Pose::from_translation(DVec3::new(3.0, 4.0, 0.0))?;
    /// let pair = Pair::new(ball.at(Pose::IDENTITY), ball.at(there))?;
    /// let [lower, upper] = pair.distance_bounds()?;
    /// assert!(lower <= 4.0 && 4.0 <= upper && upper - lower < 1e-13);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[inline]
    pub fn distance_bounds(&self) -> Result<[f64; 2], QueryError> {
        B::distance_bounds(self)
    }

    /// Decides whether the bodies are closer than a length, in world units.
    ///
    /// The search ends as soon as this is decided, which takes a few steps if the bodies are far apart or
    /// overlap.
    ///
    /// # Errors
    /// Returns [`QueryError::Length`] if the length is negative or not a number, and the errors of
    /// [`Self::distance`].
    ///
    /// ```
    /// # use colltrans::glam::DVec3;
    /// # use colltrans::{ConvexPolyhedron, Pair, Pose, Within};
    /// let cube = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE)?;
    /// let there = Pose::from_translation(DVec3::new(4.0, 5.0, 0.25))?;
    /// let pair = Pair::new(cube.at(Pose::IDENTITY), cube.at(there))?;
    /// assert!(matches!(pair.within(5.1)?, Within::Closer(_)));
    /// let Within::Farther(plane) = pair.within(4.9)? else { unreachable!("they are 5 apart") };
    /// assert!(pair.verify(&plane)? > 4.9);
    /// assert!(matches!(pair.within(5.0)?, Within::Undecided(_)));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[inline]
    pub fn within(&self, length: f64) -> Result<Within<B>, QueryError> {
        Ok(B::within(self, length)?.0)
    }

    /// Decides whether the bodies are closer than a length, in world units, and returns the work as well. See
    /// [`Self::within`].
    ///
    /// # Errors
    /// Returns the errors of [`Self::within`].
    #[inline]
    pub fn within_counted(&self, length: f64) -> Result<(Within<B>, B::Steps), QueryError> {
        B::within(self, length)
    }

    /// Computes the vertex, edge or face of each body that faces the other one: the features in the planes
    /// perpendicular to the shortest connection.
    ///
    /// Returns `None` if the bodies overlap, or if their distance is below the rounding error.
    ///
    /// # Errors
    /// Returns the errors of [`Self::distance`].
    #[inline]
    pub fn closest_features(&self) -> Result<Option<Features>, QueryError> {
        Ok(self.distance()?.features)
    }

    /// Checks a proof against the two bodies, and returns the proven value:
    ///
    /// - for a plane its gap, in world units,
    /// - for two points their distance, in world units,
    /// - for a depth or an enclosure a lower bound of the true depth, in world units,
    /// - for a certificate of solids the difference of its bounds.
    ///
    /// The check is independent of the search. For convex bodies it examines all vertices for a plane, and
    /// the named pairs for points and surfaces.
    ///
    /// # Errors
    /// Returns the reason if a claim is not proven.
    #[inline]
    pub fn verify<'p>(&self, proof: impl Into<B::PairProof<'p>>) -> Result<f64, CertificateError> {
        B::verify_pair(self, proof.into())
    }
}
