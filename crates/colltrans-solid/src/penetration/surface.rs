//! Distance of two surfaces, and signed distances of points.
//!
//! - The distance search of [`pair`](crate::pair) compares facets only. Its bounds are those of the surfaces, whether
//!   the bodies are nested or not.
//! - If the search proves no positive distance, an exact test decides whether two facets have a common point. Otherwise
//!   an exact test finds a shell of one body inside the other.
//! - A point is a solid with one facet without area, in a pose that translates it from the origin. Therefore its
//!   position is exact, and both tests apply to it. It is inside if its one shell is.

use std::sync::LazyLock;

use glam::DVec3;
use thiserror::Error;

use crate::body::{AsSolid, Solid, SolidError, check_is_not_rounded};
use crate::pair::{pair_scene, search_nearest};
use crate::solve::nearest::search::SearchEnd;
use crate::solve::nearest::{NearestPoints, find_common_point, shared_points};
use crate::solve::overlap::Overlap;
use crate::solve::scene::PairFrame;
use crate::solve::steps::SolidSteps;
use colltrans_convex::PoseError;
use colltrans_convex::body::{ConvexPolyhedron, Placed, Pose};
use colltrans_convex::pair::Pair;
use colltrans_convex::setting::error::QueryError;

/// The distance of the surfaces of two solids.
///
/// The surface consists of all facets. Of a union of pieces that overlap, it includes facets within the union.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct SurfaceDistance {
    /// Lower bound in world units, rounded down. It is 0 if the surfaces have a common point or nothing is proven.
    pub lower: f64,
    /// Upper bound in world units, rounded up. It is 0 only if the surfaces have a common point.
    pub upper: f64,
    /// Point of the surface of the moving body that is nearest to the other surface, in the world.
    pub on_moving: DVec3,
    /// Point of the surface of the fixed body that is nearest to the other surface, in the world.
    pub on_fixed: DVec3,
    /// Triangles of the moving and of the fixed body that contain these points, as positions in
    /// [`Solid::triangles`](crate::Solid::triangles).
    pub triangles: [u32; 2],
    /// Two facets with a common point or, if there are none, a shell that lies inside the other body. `None` if the
    /// bodies have no common point. Decided exactly.
    pub place: Option<Overlap>,
    /// Number of steps of the search.
    #[cfg_attr(feature = "serde", serde(default))]
    pub steps: SolidSteps,
}

/// The distance of a point from the surface of a solid, negative inside.
///
/// The surface consists of all facets. Of a union of pieces that overlap, it includes facets within the union.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct SignedDistance {
    /// Lower bound in world units, rounded down. It is negative if the point is inside.
    pub lower: f64,
    /// Upper bound in world units, rounded up. Both bounds are 0 if the point is on the surface.
    pub upper: f64,
    /// Point of the surface that is nearest to the given point, in the world.
    pub nearest: DVec3,
    /// Triangle that contains this point, as a position in [`Solid::triangles`](crate::Solid::triangles).
    pub triangle: u32,
    /// Whether the point is inside the solid and not on its surface, decided exactly.
    pub is_inside: bool,
    /// Number of steps of the search.
    #[cfg_attr(feature = "serde", serde(default))]
    pub steps: SolidSteps,
}

/// Reason why signed distances cannot be computed.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum SignedDistanceError {
    /// A coordinate of a point is not finite or out of range.
    #[error("point {index}: {reason}")]
    Point {
        /// Position of the point in the list, counted from 0.
        index: usize,
        /// Error of the point as a translation.
        #[source]
        reason: PoseError,
    },
    /// The solid is not accepted.
    #[error("{0}")]
    Solid(#[from] SolidError),
    /// A query of one of the points failed.
    #[error("{0}")]
    Query(#[from] QueryError),
}

impl Solid {
    /// Computes the signed distances of points (world coordinates) from the surface of this solid in a pose.
    ///
    /// # Errors
    /// Returns [`SignedDistanceError::Point`] for the first point with a coordinate that is not finite or out of range,
    /// and [`SignedDistanceError::Solid`] for a rounded solid. [`SignedDistanceError::Query`] is the
    /// error of the query of a point.
    ///
    /// ```
    /// use colltrans::glam::DVec3;
    /// use colltrans::solid::AsSolid;
    /// use colltrans::{ConvexPolyhedron, Pose};
    ///
    /// let cube = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::splat(4.0))?;
    /// let points = [DVec3::new(2.0, 2.0, 3.0), DVec3::new(7.0, 8.0, 2.0), DVec3::new(4.0, 1.0, 1.0)];
    /// let found = cube.as_solid()?.signed_distances(Pose::IDENTITY, &points)?;
    /// for (distance, exact) in found.iter().zip([-1.0, 5.0, 0.0]) {
    ///     assert!(distance.lower <= exact && exact <= distance.upper);
    ///     assert!(distance.upper - distance.lower < 1e-12);
    /// }
    /// assert!(found[0].is_inside && !found[1].is_inside && !found[2].is_inside);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn signed_distances(
        &self,
        pose: Pose,
        points: &[DVec3],
    ) -> Result<Vec<SignedDistance>, SignedDistanceError> {
        check_is_not_rounded(self.radius())?;
        core_distances(self.at(pose), points)
    }
}

/// The origin as a body of one facet without area.
static ORIGIN: LazyLock<Result<Solid, SignedDistanceError>> = LazyLock::new(|| {
    let origin = ConvexPolyhedron::from_points(&[DVec3::ZERO])
        .map_err(|error| QueryError::NotASolid { reason: error.to_string() })?;
    Ok(origin.as_surface()?.clone())
});

/// Computes the signed distances of points from the surface of a solid without its radius.
pub(super) fn core_distances(
    solid: Placed<'_, Solid>,
    points: &[DVec3],
) -> Result<Vec<SignedDistance>, SignedDistanceError> {
    let origin = ORIGIN.as_ref().map_err(Clone::clone)?;
    let distance = |(index, at): (usize, &DVec3)| {
        let place = Pose::from_translation(*at)
            .map_err(|reason| SignedDistanceError::Point { index, reason })?;
        Ok(signed_distance(origin.at(place), solid)?)
    };
    points.iter().enumerate().map(distance).collect()
}

/// Computes the signed distance of a point, a body of one facet without area, from the surface of a solid.
fn signed_distance(
    point: Placed<'_, Solid>,
    solid: Placed<'_, Solid>,
) -> Result<SignedDistance, QueryError> {
    let SurfaceDistance { lower, upper, on_fixed, triangles, place, steps, .. } =
        core_distance(&Pair::new(point, solid)?)?;
    let is_inside = matches!(place, Some(Overlap::MovingInside(_)));
    let [lower, upper] = if is_inside { [-upper, -lower] } else { [lower, upper] };
    Ok(SignedDistance { lower, upper, nearest: on_fixed, triangle: triangles[1], is_inside, steps })
}

/// Computes the distance of the surfaces of two bodies in their frame.
pub(super) fn surface_distance(
    pair: &Pair<'_, Solid>,
    scene: &PairFrame,
) -> Result<SurfaceDistance, QueryError> {
    for body in [pair.moving(), pair.fixed()] {
        check_is_not_rounded(body.radius())?;
    }
    Ok(core_distance_in(pair, scene))
}

/// Computes the distance of the surfaces of two bodies without their radii.
pub(super) fn core_distance(pair: &Pair<'_, Solid>) -> Result<SurfaceDistance, QueryError> {
    Ok(core_distance_in(pair, &pair_scene(pair)?))
}

/// Computes the distance of the surfaces of two bodies without their radii, in their frame.
fn core_distance_in(pair: &Pair<'_, Solid>, scene: &PairFrame) -> SurfaceDistance {
    let found = search_nearest(pair, scene, SearchEnd::LEAST, false);
    let mut steps = found.steps;
    let place =
        if found.are_separated { None } else { find_common_point(scene, found.lower, &mut steps) };
    let spot = found.spot.unwrap_or_else(|| NearestPoints::from_triangles(scene, [0, 0]));
    let (triangles, points, bounds) = if let Some(Overlap::Facets(f, g)) = place {
        ([f, g], shared_points(scene, Overlap::Facets(f, g)), [0.0; 2])
    } else {
        let upper = spot.solid_near(scene).distance();
        (spot.triangles, spot.witness_points(scene), [found.lower.max(0.0), upper])
    };
    let origin = pair.bodies.translations[0];
    let [on_moving, on_fixed] = points.map(|point| point + origin);
    let [lower, upper] = bounds;
    SurfaceDistance { lower, upper, on_moving, on_fixed, triangles, place, steps }
}
