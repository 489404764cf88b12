//! The common part of two solids, their depth, and distances of surfaces, also of bodies inside each other.
//!
//! - `surface`: the distance of two surfaces, also if one lies inside the other body, and signed distances of points.
//! - `common`: how two bodies lie to each other, and their common part, with its volume by `arrangement` or `cells`.
//! - `depth`: the length of the shortest translation that separates two overlapping bodies, from below by `inner` and `cover`.
//! - `prepared`: one pair for several of these queries.
//! - `certificate`: proofs of both bounds of the depth, and their verification.
//! - `common_certificate`: proofs of common parts, and their verification in exact cells (`cuts`) of bodies with exact
//!   coordinates (`exact_pair`). `common_search` finds them.

mod arrangement;
mod cells;
mod certificate;
mod common;
mod common_certificate;
mod common_search;
mod cover;
mod cuts;
mod depth;
mod exact_pair;
mod facet_tree;
mod inner;
mod piece;
mod prepared;
mod surface;

pub use certificate::{DepthCertificate, InnerCore};
pub use common::{CommonPart, Relation, VolumeOptions};
pub use common_certificate::{
    CommonNode, CommonPartCertificate, CommonPartError, NodeFault, ProvenRelation,
};
pub use depth::SolidDepth;
pub use inner::InnerPair;
pub use prepared::PreparedPair;
pub use surface::{SignedDistance, SignedDistanceError, SurfaceDistance};

use crate::body::Solid;
use colltrans_convex::answer::CertificateError;
use colltrans_convex::body::Placed;
use colltrans_convex::pair::Pair;
use colltrans_convex::setting::error::QueryError;

/// Relative margin for rounding errors of lengths.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// Returns both bodies in their poses.
fn placed_solids<'a>(pair: &Pair<'a, Solid>) -> [Placed<'a, Solid>; 2] {
    [pair.bodies.moving_placed(), pair.bodies.fixed_placed()]
}

/// Queries about the interiors of two [`Solid`]s that may overlap.
pub trait SolidPenetration {
    /// Computes the distance of the surfaces of two bodies, also if one lies inside the other.
    ///
    /// [`Pair::distance`] is 0 for nested bodies. For these this query computes the thickness of the wall between the
    /// surfaces. For bodies that are apart, both queries have equal bounds. Of a union of pieces that overlap, facets
    /// within the union count as surface.
    ///
    /// # Errors
    /// Returns [`QueryError::NotASolid`] for a rounded body.
    ///
    /// ```
    /// use colltrans::glam::DVec3;
    /// use colltrans::solid::{Overlap, SolidPair, SolidPenetration};
    /// use colltrans::{ConvexPolyhedron, Pair, Pose};
    ///
    /// let outer = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::splat(8.0))?;
    /// let inner = ConvexPolyhedron::cuboid(DVec3::splat(3.0), DVec3::new(4.0, 6.0, 4.0))?;
    /// let pair = Pair::between(inner.at(Pose::IDENTITY), outer.at(Pose::IDENTITY))?;
    /// assert_eq!(pair.distance()?.upper, 0.0);
    /// let wall = pair.surface_distance()?;
    /// assert!(wall.lower <= 2.0 && 2.0 <= wall.upper && wall.upper - wall.lower < 1e-12);
    /// assert!(matches!(wall.place, Some(Overlap::MovingInside(_))));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    fn surface_distance(&self) -> Result<SurfaceDistance, QueryError>;

    /// Computes how two bodies lie to each other, and the volume, the box and a point of their common part.
    ///
    /// # Errors
    /// Returns [`QueryError::NotASolid`] for a rounded body.
    ///
    /// ```
    /// use colltrans::glam::DVec3;
    /// use colltrans::solid::{Relation, SolidPair, SolidPenetration, VolumeOptions};
    /// use colltrans::{ConvexPolyhedron, Pair, Pose};
    ///
    /// let cube = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::splat(2.0))?;
    /// let there = Pose::from_translation(DVec3::new(1.0, 1.5, 0.0))?;
    /// let pair = Pair::between(cube.at(Pose::IDENTITY), cube.at(there))?;
    /// let common = pair.common_part(VolumeOptions::default())?;
    /// assert!(matches!(common.relation, Relation::Crossing(_)) && common.is_accurate);
    /// assert!(common.volume[0] <= 1.0 && 1.0 <= common.volume[1]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    fn common_part(&self, options: VolumeOptions) -> Result<CommonPart, QueryError>;

    /// Computes bounds of the depth: the length of the shortest translation of the moving body after which the
    /// interiors have no common point.
    ///
    /// Both bounds are proven. The upper one is the length of the shortest translation that was found, and a shorter one
    /// may exist. The lower one is the depth of convex bodies inside the solids. For convex solids both bounds are those
    /// of their hulls, unless these are thinner than rounding errors.
    ///
    /// The depth is 0 if the overlap test finds none, or if a body has no closed shell. An open shell that passes through
    /// the other body counts as overlap if both bodies have a closed shell.
    ///
    /// # Errors
    /// Returns the error of [`Pair::distance`].
    ///
    /// ```
    /// use colltrans::glam::DVec3;
    /// use colltrans::solid::{SolidPair, SolidPenetration};
    /// use colltrans::{ConvexPolyhedron, Pair, Pose, Solid};
    ///
    /// // A post of width 1 stands 1/2 deep in the corner of a step.
    /// let low = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::new(4.0, 2.0, 1.0))?;
    /// let high = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::new(2.0, 2.0, 3.0))?;
    /// let step = Solid::from_pieces([&low, &high])?;
    /// let post = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::new(1.0, 1.0, 4.0))?;
    /// let there = Pose::from_translation(DVec3::new(3.0, 0.5, 0.5))?;
    /// let depth = Pair::between(post.at(there), step.at(Pose::IDENTITY))?.depth()?;
    /// assert!(depth.lower <= 0.5 && 0.5 <= depth.upper && depth.upper < 0.5 + 1e-9);
    /// assert!(depth.lower > 0.49);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    fn depth(&self) -> Result<SolidDepth, QueryError>;

    /// Computes bounds of the depth and their proof. The bounds may be farther apart than those of
    /// [`depth`](Self::depth), because the proof moves the bodies apart by more than rounding errors, and of rounded
    /// bodies whose cores do not overlap it proves no lower bound.
    ///
    /// # Errors
    /// Returns the errors of [`Pair::distance`], and [`QueryError::NotASolid`] if the bodies are not proven to be apart
    /// after any translation.
    ///
    /// ```
    /// use colltrans::glam::DVec3;
    /// use colltrans::solid::{SolidPair, SolidPenetration};
    /// use colltrans::{ConvexPolyhedron, Pair, Pose};
    ///
    /// let cube = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::splat(2.0))?;
    /// let there = Pose::from_translation(DVec3::new(1.0, 1.5, 0.0))?;
    /// let pair = Pair::between(cube.at(Pose::IDENTITY), cube.at(there))?;
    /// let mut proof = pair.certified_depth()?;
    /// assert!(proof.lower <= 0.5 && 0.5 <= proof.upper && proof.upper - proof.lower < 1e-9);
    /// pair.verify_depth(&proof)?;
    /// proof.lower += 0.01;
    /// assert!(pair.verify_depth(&proof).is_err());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    fn certified_depth(&self) -> Result<DepthCertificate, QueryError>;

    /// Verifies a proof of the depth without a search. Returns the difference of its bounds.
    ///
    /// # Errors
    /// Returns the first claim that is not proven.
    fn verify_depth(&self, proof: &DepthCertificate) -> Result<f64, CertificateError>;

    /// Computes the common part of two bodies and its proof: bounds of its volume, its box, a point of it, and how the
    /// bodies lie to each other, as far as it is proven.
    ///
    /// The bounds of the volume of simple bodies are as close as rounding allows. Otherwise the search ends when they are
    /// as close as the options require. It also ends after a limited amount of work, so that the proof can be verified
    /// quickly. Then the bounds may be farther apart than those of [`common_part`](Self::common_part).
    ///
    /// # Errors
    /// Returns [`CommonPartError::Query`] for a rounded body. Other errors report that the proof cannot be verified, for
    /// example because coordinates are out of range.
    ///
    /// ```
    /// use colltrans::glam::DVec3;
    /// use colltrans::solid::{ProvenRelation, SolidPair, SolidPenetration, VolumeOptions};
    /// use colltrans::{ConvexPolyhedron, Pair, Pose};
    ///
    /// let cube = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::splat(2.0))?;
    /// let there = Pose::from_translation(DVec3::new(1.0, 1.5, 0.0))?;
    /// let pair = Pair::between(cube.at(Pose::IDENTITY), cube.at(there))?;
    /// let mut proof = pair.certified_common_part(VolumeOptions::default())?;
    /// assert!(proof.volume[0] <= 1.0 && 1.0 <= proof.volume[1]);
    /// assert!(proof.volume[1] - proof.volume[0] < 1e-9);
    /// assert!(matches!(proof.relation, Some(ProvenRelation::Crossing { .. })));
    /// pair.verify_common_part(&proof)?;
    /// proof.volume[0] += 0.01;
    /// assert!(pair.verify_common_part(&proof).is_err());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    fn certified_common_part(
        &self,
        options: VolumeOptions,
    ) -> Result<CommonPartCertificate, CommonPartError>;

    /// Verifies a proof of the common part exactly and without a search. Returns the difference of the bounds of the
    /// volume.
    ///
    /// # Errors
    /// Returns the first claim that is not proven, and [`CommonPartError::Work`] for a proof whose verification exceeds a
    /// limit.
    fn verify_common_part(&self, proof: &CommonPartCertificate) -> Result<f64, CommonPartError>;
}

impl SolidPenetration for Pair<'_, Solid> {
    fn surface_distance(&self) -> Result<SurfaceDistance, QueryError> {
        PreparedPair::new(self)?.surface_distance()
    }

    fn common_part(&self, options: VolumeOptions) -> Result<CommonPart, QueryError> {
        PreparedPair::new(self)?.common_part(options)
    }

    fn depth(&self) -> Result<SolidDepth, QueryError> {
        PreparedPair::new(self)?.depth()
    }

    fn certified_depth(&self) -> Result<DepthCertificate, QueryError> {
        certificate::certified_depth(self)
    }

    fn verify_depth(&self, proof: &DepthCertificate) -> Result<f64, CertificateError> {
        certificate::verify_depth(self, proof)
    }

    fn certified_common_part(
        &self,
        options: VolumeOptions,
    ) -> Result<CommonPartCertificate, CommonPartError> {
        common_search::certified_common_part(self, options)
    }

    fn verify_common_part(&self, proof: &CommonPartCertificate) -> Result<f64, CommonPartError> {
        common_certificate::verify_common_part(self, proof)
    }
}
