//! Distance of two solids.
//!
//! - Data flow: two placed solids -> [`search`] (best first through both trees, with [`bound`] for pairs of nodes and
//!   [`triangle`] for pairs of facets) -> the nearest two facets, and a lower bound of the distance of all pairs.
//! - The search compares surfaces only. [`inside`](super::inside) tests whether one body lies inside the other.
//! - The direction has no effect. The scene's direction is `z`, so that its query frame equals the setting frame.
//!
//! The queries themselves are in `pair`.

mod bound;
pub(crate) mod search;
pub mod triangle;

use glam::DVec3;

use super::overlap::{self, Overlap};
use super::scene::{PairFrame, PlacedBody};
use crate::solve::steps::SolidSteps;
pub use bound::Apart;
pub(crate) use bound::Axes;
use colltrans_convex::body::Feature;
use search::{NearestFacets, facet_corners};
use triangle::Nearest;

/// Proof of an upper bound of the distance of two solids.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case", deny_unknown_fields)
)]
pub enum SolidNear {
    /// A point of each body.
    Points {
        /// The triangles that contain the points, as positions in [`Solid::triangles`](crate::Solid::triangles).
        triangles: [u32; 2],
        /// Weights of the triangles' corners, not negative: the points are `sum w_i p_i / sum w_i`.
        weights: [[f64; 3]; 2],
        /// Upper bound of the distance of the two points, in world units, rounded up.
        distance: f64,
    },
    /// The bodies have a common point: two facets share one, or a shell is inside the other body.
    Meeting(Overlap),
}

impl SolidNear {
    /// Returns an upper bound of the distance of the bodies.
    pub const fn distance(&self) -> f64 {
        match self {
            Self::Points { distance, .. } => *distance,
            Self::Meeting(_) => 0.0,
        }
    }
}

/// Lower bound of the distance of two solids, found by a search. Its proof covers all pairs of facets and is computed
/// on request by [`SolidPair::certified_distance`](crate::SolidPair::certified_distance).
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SolidGap {
    /// Lower bound of the distance of any two points of the bodies, in world units, rounded down.
    pub gap: f64,
}

/// A point of each of two triangles, nearest to the other one.
#[derive(Debug, Clone, Copy)]
pub struct NearestPoints {
    pub triangles: [u32; 2],
    pub nearest: Nearest,
}

impl NearestPoints {
    /// Computes the nearest points of two triangles.
    pub(crate) fn from_triangles(scene: &PairFrame, triangles: [u32; 2]) -> Self {
        let [f, g] = both_corners(scene, triangles);
        Self { triangles, nearest: triangle::nearest_points(&f, &g, scene.noise) }
    }

    pub(crate) fn solid_near(&self, scene: &PairFrame) -> SolidNear {
        let Nearest { weights, length, .. } = self.nearest;
        let distance = length + triangle::LENGTH_NOISES * scene.noise;
        let weights = weights.map(|w| w.to_array());
        SolidNear::Points { triangles: self.triangles, weights, distance }
    }

    /// Returns the two points in the setting frame.
    #[inline]
    pub fn witness_points(&self, scene: &PairFrame) -> [DVec3; 2] {
        weighted_points(scene, self.triangles, self.nearest.weights)
    }

    /// Returns the features of both bodies at the points.
    #[inline]
    pub fn features(&self, scene: &PairFrame) -> [Feature; 2] {
        let sides = [&scene.moving, &scene.fixed];
        [0, 1].map(|k| {
            let (side, triangle) = (sides[k], self.triangles[k]);
            let places = side.solid.triangles()[triangle as usize]
                .map(|v| side.solid.vertices()[v as usize]);
            let at = triangle::weighted_point(&places, self.nearest.weights[k]);
            let slack = 2.0 * side.solid.coordinate_precision() + scene.noise;
            let normal = side.matrix.transpose() * self.nearest.normal;
            side.solid.feature_at(triangle, at, normal, slack)
        })
    }
}

impl From<NearestFacets> for NearestPoints {
    fn from(found: NearestFacets) -> Self {
        Self { triangles: found.triangles, nearest: found.nearest }
    }
}

fn both_corners(scene: &PairFrame, [s, t]: [u32; 2]) -> [triangle::Corners; 2] {
    [facet_corners(&scene.moving, s as usize), facet_corners(&scene.fixed, t as usize)]
}

/// Returns the points of two triangles with the given weights, in the setting frame.
#[inline]
pub fn weighted_points(scene: &PairFrame, triangles: [u32; 2], weights: [DVec3; 2]) -> [DVec3; 2] {
    let corners = both_corners(scene, triangles);
    [0, 1].map(|k| triangle::weighted_point(&corners[k], weights[k]))
}

/// Finds a place where the bodies have a common point, given a lower bound of the distance of their surfaces; `None` if
/// there is no such place.
pub(crate) fn find_common_point(
    scene: &PairFrame,
    surfaces: f64,
    steps: &mut SolidSteps,
) -> Option<Overlap> {
    if surfaces > 0.0 { overlap::nested_shell(scene) } else { overlap::find_contact(scene, steps) }
}

/// Returns a common point of both bodies in the setting frame, once for each body, equal within rounding.
pub(crate) fn shared_points(scene: &PairFrame, place: Overlap) -> [DVec3; 2] {
    let corner = |side: &PlacedBody, t: u32| [facet_corners(side, t as usize)[0]; 2];
    match place {
        Overlap::Facets(s, t) => NearestPoints::from_triangles(scene, [s, t]).witness_points(scene),
        Overlap::MovingInside(t) => corner(&scene.moving, t),
        Overlap::FixedInside(t) => corner(&scene.fixed, t),
    }
}

/// Returns an upper bound, in world units, of the distance of a point on each of two triangles, given by weights of
/// their corners. `None` if a triangle does not exist.
pub(crate) fn distance_of(
    scene: &PairFrame,
    triangles: [u32; 2],
    weights: [[f64; 3]; 2],
) -> Option<f64> {
    let known = |side: &PlacedBody, t: u32| (t as usize) < side.solid.triangles().len();
    if !known(&scene.moving, triangles[0]) || !known(&scene.fixed, triangles[1]) {
        return None;
    }
    let [f, g] = both_corners(scene, triangles);
    let length = triangle::weighted_distance(&f, &g, weights.map(DVec3::from_array));
    Some(length + triangle::LENGTH_NOISES * scene.noise)
}
