//! How far two solids are apart.
//!
//! Data flow: two placed solids -> [`search`] (best first through both trees, with [`bound`] for pairs of nodes
//! and [`triangle`] for pairs of facets) -> the two facets that are nearest, and a length that no pair is below.
//! That is of surfaces alone: whether one body lies inside the other is asked of [`inside`](super::inside).
//! A direction plays no part: the scene's is `z`, so that its query frame is the setting frame. The questions are
//! in `pair/solid`.

mod bound;
pub(crate) mod search;
pub mod triangle;

use glam::DVec3;

use super::overlap::{self, Overlap};
use super::scene::{Scene, Side};
use crate::solve::steps::SolidSteps;
pub use bound::Apart;
pub(crate) use bound::Axes;
use colltrans_convex::body::Feature;
use search::{Found, corners};
use triangle::Nearest;

/// The proof that two solids are not farther from each other than a number.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case", deny_unknown_fields)
)]
pub enum SolidNear {
    /// A point of each body.
    Points {
        /// The triangles that they are of, as positions in [`Solid::triangles`](crate::Solid::triangles).
        triangles: [u32; 2],
        /// The weights of their corners, not negative: the points are `sum w_i p_i / sum w_i`.
        weights: [[f64; 3]; 2],
        /// At least the distance of the two points, in world units, rounded up.
        distance: f64,
    },
    /// The bodies have a point in common: two facets have, or a shell is inside.
    Meeting(Overlap),
}

impl SolidNear {
    /// At least the distance of the bodies.
    pub const fn distance(&self) -> f64 {
        match self {
            Self::Points { distance, .. } => *distance,
            Self::Meeting(_) => 0.0,
        }
    }
}

/// How near two solids are at least, as a search has found. What proves it covers all pairs of facets, and is
/// asked for apart: [`SolidPair::certified_distance`](crate::SolidPair::certified_distance).
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SolidGap {
    /// At most the distance of any two points of the bodies, in world units, rounded down.
    pub gap: f64,
}

/// Two points of the bodies and where they are.
#[derive(Debug, Clone, Copy)]
pub struct Spot {
    pub triangles: [u32; 2],
    pub nearest: Nearest,
}

impl Spot {
    /// Of two triangles.
    pub(crate) fn of(scene: &Scene, triangles: [u32; 2]) -> Self {
        let [f, g] = of_both(scene, triangles);
        Self { triangles, nearest: triangle::nearest(&f, &g, scene.noise) }
    }

    pub(crate) fn near(&self, scene: &Scene) -> SolidNear {
        let Nearest { weights, length, .. } = self.nearest;
        let distance = length + triangle::LENGTH * scene.noise;
        let weights = weights.map(|w| w.to_array());
        SolidNear::Points { triangles: self.triangles, weights, distance }
    }

    /// The two points in the setting frame.
    #[inline]
    pub fn points(&self, scene: &Scene) -> [DVec3; 2] {
        points_of(scene, self.triangles, self.nearest.weights)
    }

    /// What of each body is there.
    #[inline]
    pub fn features(&self, scene: &Scene) -> [Feature; 2] {
        let sides = [&scene.moving, &scene.fixed];
        [0, 1].map(|k| {
            let (side, triangle) = (sides[k], self.triangles[k]);
            let places = side.solid.triangles()[triangle as usize]
                .map(|v| side.solid.vertices()[v as usize]);
            let at = triangle::mean(&places, self.nearest.weights[k]);
            let slack = 2.0 * side.solid.precision() + scene.noise;
            let normal = side.matrix.transpose() * self.nearest.normal;
            side.solid.feature_at(triangle, at, normal, slack)
        })
    }
}

impl From<Found> for Spot {
    fn from(found: Found) -> Self {
        Self { triangles: found.triangles, nearest: found.nearest }
    }
}

fn of_both(scene: &Scene, [s, t]: [u32; 2]) -> [triangle::Corners; 2] {
    [corners(&scene.moving, s as usize), corners(&scene.fixed, t as usize)]
}

/// The points of two triangles that weights say, in the setting frame.
#[inline]
pub fn points_of(scene: &Scene, triangles: [u32; 2], weights: [DVec3; 2]) -> [DVec3; 2] {
    let corners = of_both(scene, triangles);
    [0, 1].map(|k| triangle::mean(&corners[k], weights[k]))
}

/// Where the bodies have a point in common, given how far their surfaces are apart at least.
pub(crate) fn meeting(scene: &Scene, surfaces: f64, steps: &mut SolidSteps) -> Option<Overlap> {
    if surfaces > 0.0 { overlap::nested(scene) } else { overlap::touch(scene, steps) }
}

/// A point that both bodies have, in the setting frame, each body's own to within rounding.
pub(crate) fn shared_points(scene: &Scene, place: Overlap) -> [DVec3; 2] {
    let corner = |side: &Side, t: u32| [corners(side, t as usize)[0]; 2];
    match place {
        Overlap::Facets(s, t) => Spot::of(scene, [s, t]).points(scene),
        Overlap::MovingInside(t) => corner(&scene.moving, t),
        Overlap::FixedInside(t) => corner(&scene.fixed, t),
    }
}

/// At least the distance of points that are claimed to be of the bodies, in world units; nothing if there are no
/// such points.
pub(crate) fn distance_of(
    scene: &Scene,
    triangles: [u32; 2],
    weights: [[f64; 3]; 2],
) -> Option<f64> {
    let known = |side: &Side, t: u32| (t as usize) < side.solid.triangles().len();
    if !known(&scene.moving, triangles[0]) || !known(&scene.fixed, triangles[1]) {
        return None;
    }
    let [f, g] = of_both(scene, triangles);
    let length = triangle::length(&f, &g, weights.map(DVec3::from_array));
    Some(length + triangle::LENGTH * scene.noise)
}
