//! Queries about solids that may overlap or lie inside each other.
//!
//! - `surface`: the distance of two surfaces, also if one lies inside the other body, and signed distances of points.

mod surface;

pub use surface::{SignedDistance, SignedDistanceError, SurfaceDistance};

use crate::body::Solid;
use colltrans_convex::pair::Pair;
use colltrans_convex::setting::error::QueryError;

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
}

impl SolidPenetration for Pair<'_, Solid> {
    fn surface_distance(&self) -> Result<SurfaceDistance, QueryError> {
        surface::surface_distance(self)
    }
}
