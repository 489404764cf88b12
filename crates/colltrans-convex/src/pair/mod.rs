//! Two placed bodies and no direction: how far apart they are, how deep they overlap.

mod convex;
mod verify;

use crate::answer::{CertificateError, Depth, Distance, NearPoints, PlaneGap, Within, checked_as};
use crate::body::{Body, ConvexPolyhedron, Features, Placed, Pose};
use crate::setting::TwoBodies;
use crate::setting::error::QueryError;
pub use convex::distance_from;
pub use convex::points;
use derive_where::derive_where;

/// A kind of body that a [`Pair`] is answered for. It is not meant to be implemented outside this workspace.
pub trait PairBody: Body {
    /// What can be checked about two bodies where they are.
    type PairProof<'p>;

    #[doc(hidden)]
    fn distance(pair: &Pair<'_, Self>) -> Result<Distance<Self>, QueryError>;
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

/// A moving body and a fixed one, where they are: what is asked of both and no direction. Nothing moves;
/// the names tell them apart, as in a [`Cast`](crate::Cast).
///
/// Made once, asked as often as one likes: nothing is searched before a question is asked.
#[derive(Debug)]
#[derive_where(Clone, Copy)]
pub struct Pair<'a, B: Body = ConvexPolyhedron> {
    #[doc(hidden)]
    pub bodies: TwoBodies<'a, B>,
}

/// A proof to check about two convex bodies where they are.
#[derive(Debug, Clone, Copy)]
#[non_exhaustive]
pub enum PairProof<'a> {
    /// That they are not nearer to each other than a number.
    Gap(&'a PlaneGap),
    /// That they are not farther from each other than a number.
    Near(&'a NearPoints),
    /// Both bounds of a depth.
    Depth(&'a Depth),
}

checked_as!(PairProof { Gap(PlaneGap), Near(NearPoints), Depth(Depth) });

impl<'a, B: Body> Pair<'a, B> {
    /// Of two placed bodies.
    ///
    /// # Errors
    /// None today: what a body and a pose admit, a pair does.
    #[inline]
    pub fn new(moving: Placed<'a, B>, fixed: Placed<'a, B>) -> Result<Self, QueryError> {
        Ok(Self { bodies: TwoBodies::new(moving, fixed) })
    }

    /// The moving body.
    pub fn moving(&self) -> &'a B {
        self.bodies.moving
    }

    /// The fixed body.
    pub fn fixed(&self) -> &'a B {
        self.bodies.fixed
    }

    /// Where the moving body is.
    pub fn moving_pose(&self) -> Pose {
        self.bodies.moving_placed().pose
    }

    /// Where the fixed body is.
    pub fn fixed_pose(&self) -> Pose {
        self.bodies.fixed_placed().pose
    }
}

impl<B: PairBody> Pair<'_, B> {
    /// How far apart are the bodies, and where?
    ///
    /// The bounds hold exactly. They are at most four noises apart (`128 u S`, see
    /// [the crate's introduction](crate#accuracy)), however near the bodies are to each other; of thin and
    /// uneven ones, rarely, up to 64, and what uneven faces hide; and by what hulls leave outside. Of bodies that overlap the lower one is 0.
    /// Of bodies that are less than a few noises apart it is, if one shows it, that of a plane whose gap is computed
    /// nearly without rounding, from all vertices: boxes along the axes that are `1e-60` apart mostly are so for
    /// certain; where their corners are lined up too, the bounds are 0 and some noises.
    ///
    /// Of solids the bounds are at most five noises apart (`160 u S`). Solids that meet are 0 apart: if their surfaces
    /// touch, or one lies inside the other. Of open shells the distance is that of the surface.
    ///
    /// # Errors
    /// Only a search of convex bodies that ends without an answer: see [`QueryError::NotConverged`].
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

    /// Are the bodies closer than a length, in world units? Ended as soon as that is known: for bodies
    /// that are far from each other or overlap, after a few steps.
    ///
    /// # Errors
    /// A length that is negative or not a number; and as [`Self::distance`].
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

    /// The same, and how much work it was.
    ///
    /// # Errors
    /// As [`Self::within`].
    #[inline]
    pub fn within_counted(&self, length: f64) -> Result<(Within<B>, B::Steps), QueryError> {
        B::within(self, length)
    }

    /// The vertex, edge or face of each body that faces the other one: what lies in the planes across the
    /// shortest way between them. `None` if they overlap, or are less apart than rounding can tell.
    ///
    /// # Errors
    /// As [`Self::distance`].
    #[inline]
    pub fn closest_features(&self) -> Result<Option<Features>, QueryError> {
        Ok(self.distance()?.features)
    }

    /// Checks a proof against the two bodies, and returns what is really proven, in world units: the gap
    /// of a plane, the distance of two points, or a depth that is not exceeded by the true one; of a certificate of
    /// solids how far its bounds are apart.
    ///
    /// Nothing of the search is used: all vertices are looked at for a plane, the pairs named for points
    /// and surfaces.
    ///
    /// # Errors
    /// What is not proven.
    #[inline]
    pub fn verify<'p>(&self, proof: impl Into<B::PairProof<'p>>) -> Result<f64, CertificateError> {
        B::verify_pair(self, proof.into())
    }
}
