//! Records of scene queries.

use colltrans_convex::answer::{Solver, Steps};
use colltrans_convex::body::ObstacleId;
use colltrans_convex::pair::nearest_points_in_world;
use colltrans_scene::{Nearby, Nearest, SceneClearance, SceneQuery};
use colltrans_solid::SolidPairSearch;
use colltrans_solid::kinds::{AnyClearance, AnyNear, ByKind};
use glam::DVec3;

use super::{
    ClearanceRecord, ContactRecord, DistanceRecord, Ending, FeaturesRecord, NearbyRecord,
    SolidClearanceRecord, StartOverlapRecord, positive_gap, record, without_negative_zeros,
};

record! {
    /// Nearest obstacle of a body.
    #[non_exhaustive]
    pub struct NearestRecord {
        /// Outcome of the query.
        pub outcome: Ending,
        /// Proven lower bound of the distances of all obstacles.
        pub lower: Option<f64>,
        /// Proven upper bound of the distance of this obstacle.
        pub upper: Option<f64>,
        /// Rounded points of the moving body and of the obstacle at the distance `upper`, in the world frame.
        pub points: Option<[[f64; 3]; 2]>,
        /// Name of the obstacle.
        pub fixed: Option<String>,
        /// Index of the obstacle.
        pub obstacle: ObstacleId,
        /// Number of obstacles in the query.
        pub obstacles: usize,
        /// Unit normal along the shortest connection, from the moving body to the obstacle.
        pub normal: Option<[f64; 3]>,
        /// Features at the nearest points.
        pub features: Option<FeaturesRecord>,
        /// Amounts of work, for convex bodies.
        pub steps: Option<Steps>,
    }
}

record! {
    /// Obstacles whose distance from a body is at most a length.
    #[non_exhaustive]
    pub struct SceneWithinRecord {
        /// `closer` if the distance of an obstacle is at most the length, otherwise `undecided` if rounding
        /// prevents a decision about one, otherwise `farther`.
        pub outcome: Ending,
        /// Number of obstacles in the query.
        pub obstacles: usize,
        /// Obstacles at a distance of at most the length, in the order of insertion.
        pub closer: Option<Vec<NearbyRecord>>,
        /// Obstacles for which rounding prevents a decision.
        pub undecided: Vec<NearbyRecord>,
    }
}

record! {
    /// Clearance of a body along a direction in a scene. The distance holds for all obstacles together, the
    /// contact is that with the obstacle that blocks the body.
    #[non_exhaustive]
    pub struct SceneClearanceRecord {
        /// Outcome of the query.
        pub outcome: Ending,
        /// Safe travel of a blocked body.
        pub distance: Option<f64>,
        /// For an overlap with a convex obstacle, travel backwards that certainly separates the bodies.
        pub back: Option<f64>,
        /// For an overlap with a convex obstacle, travel forwards that certainly separates the bodies.
        pub on: Option<f64>,
        /// First contact. For solids it is the contact of the blocking facets in nominal position.
        pub translation: Option<f64>,
        /// Proven bounds of `translation`.
        pub translation_bounds: Option<[f64; 2]>,
        /// For solids, travel of the bodies offset by half the tolerance each.
        pub offset_distance: Option<f64>,
        /// Proven bounds of `offset_distance`.
        pub offset_distance_bounds: Option<[f64; 2]>,
        /// Last contact, for an overlap with a convex obstacle.
        pub exit: Option<f64>,
        /// Proven bounds of `exit`. Beyond the upper one the bodies never meet.
        pub exit_bounds: Option<[f64; 2]>,
        /// Name of the obstacle.
        pub fixed: Option<String>,
        /// Index of the obstacle; `None` if the body is free.
        pub obstacle: Option<ObstacleId>,
        /// Number of obstacles in the query.
        pub obstacles: usize,
        /// Unit normal of the contact plane, from the moving body to the obstacle.
        pub normal: Option<[f64; 3]>,
        /// Contact point on the obstacle, in the world frame.
        pub point: Option<[f64; 3]>,
        /// For convex bodies, the part of the bounds' difference that rounding explains.
        pub rounding: Option<f64>,
        /// For solids, the tolerance in use, a length.
        pub tolerance: Option<f64>,
        /// Minimum gap, a length. Bodies meet if their distance falls to it.
        pub min_gap: Option<f64>,
        /// For solids, the overlaps at the start.
        pub start_overlaps: Vec<StartOverlapRecord>,
        /// For solids, the bodies that are open, at least in part.
        pub surfaces: Vec<&'static str>,
        /// Features in contact.
        pub features: Option<FeaturesRecord>,
        /// Solver, for convex bodies.
        pub solver: Option<Solver>,
        /// Amounts of work, for convex bodies.
        pub steps: Option<Steps>,
    }
}

impl NearestRecord {
    /// Converts an answer of [`SceneQuery::nearest`]. `among` must be the query.
    pub fn from_nearest(nearest: &Nearest, among: &SceneQuery<'_>) -> Self {
        let Nearest { obstacle, ref distance, lower, .. } = *nearest;
        let of = match (among.pair_with(obstacle), distance) {
            (Some(ByKind::Convex(pair)), ByKind::Convex(of)) => {
                DistanceRecord::from_distance(of, &pair)
            }
            (Some(ByKind::Solid(pair)), ByKind::Solid(of)) => DistanceRecord::of_solids(of, &pair),
            // The obstacle has been removed since the query.
            _ => DistanceRecord { upper: Some(distance.upper()), ..DistanceRecord::default() },
        };
        let DistanceRecord { upper, points, fixed, normal, features, steps, .. } = of;
        Self {
            outcome: if lower > 0.0 { Ending::Apart } else { Ending::Meeting },
            lower: Some(lower),
            upper,
            points,
            fixed,
            obstacle,
            obstacles: among.queried_count(),
            normal,
            features,
            steps,
        }
    }
}

impl From<&NearestRecord> for DistanceRecord {
    /// Returns the distance of the nearest obstacle.
    fn from(nearest: &NearestRecord) -> Self {
        let NearestRecord { outcome, lower, upper, points, normal, steps, .. } = *nearest;
        let (fixed, features) = (nearest.fixed.clone(), nearest.features.clone());
        let (moving, surfaces) = (None, Vec::new());
        Self { outcome, lower, upper, points, moving, fixed, normal, surfaces, features, steps }
    }
}

impl SceneWithinRecord {
    /// Converts an answer of [`SceneQuery::within`]. `among` must be the query.
    pub fn from_nearby(nearby: &Nearby, among: &SceneQuery<'_>) -> Self {
        let outcome = match (nearby.closer.is_empty(), nearby.undecided.is_empty()) {
            (false, _) => Ending::Closer,
            (true, false) => Ending::Undecided,
            (true, true) => Ending::Farther,
        };
        let closer = nearby.closer.iter().map(|(obstacle, near)| NearbyRecord {
            obstacle: *obstacle,
            upper: near.distance(),
            points: points_of(*obstacle, near, among),
            ..NearbyRecord::default()
        });
        let undecided = nearby.undecided.iter().map(|(obstacle, distance)| NearbyRecord {
            obstacle: *obstacle,
            lower: Some(distance.lower()),
            upper: distance.upper(),
            points: Some([distance.on_moving(), distance.on_fixed()].map(without_negative_zeros)),
            ..NearbyRecord::default()
        });
        let (closer, undecided) = (Some(closer.collect()), undecided.collect());
        Self { outcome, obstacles: among.queried_count(), closer, undecided }
    }
}

impl SceneClearanceRecord {
    /// Converts an answer of [`SceneQuery::clearance`]. `among` must be the query.
    pub fn from_clearance(
        found: &SceneClearance,
        among: &SceneQuery<'_>,
        direction: DVec3,
    ) -> Self {
        let record = found.stop.and_then(|(id, stop)| {
            Some(match (among.cast_with(id, direction)?, stop) {
                (ByKind::Convex(cast), AnyClearance::Convex(of)) => {
                    ClearanceRecord::from_clearance(&of, &cast).into()
                }
                (ByKind::Solid(cast), AnyClearance::Solid(of)) => {
                    SolidClearanceRecord::from_clearance(&of, None, &cast).into()
                }
                _ => return None,
            })
        });
        let free = || Self {
            outcome: Ending::Free,
            min_gap: positive_gap(among.options().min_gap),
            ..Self::default()
        };
        Self {
            distance: found.safe_translation().filter(|distance| distance.is_finite()),
            obstacle: found.stop.map(|(id, _)| id),
            obstacles: among.queried_count(),
            ..record.unwrap_or_else(free)
        }
    }
}

impl From<ClearanceRecord> for SceneClearanceRecord {
    fn from(of: ClearanceRecord) -> Self {
        let ContactRecord { translation, translation_bounds, exit, exit_bounds, .. } = of.contact;
        let ContactRecord { normal, point, rounding, min_gap, features, solver, steps, .. } =
            of.contact;
        Self {
            outcome: of.outcome,
            back: of.back,
            on: of.on,
            translation,
            translation_bounds,
            exit,
            exit_bounds,
            normal,
            point,
            rounding,
            min_gap,
            features,
            solver,
            steps,
            ..Self::default()
        }
    }
}

impl From<SolidClearanceRecord> for SceneClearanceRecord {
    fn from(of: SolidClearanceRecord) -> Self {
        Self {
            outcome: of.outcome,
            translation: of.translation,
            translation_bounds: of.translation_bounds,
            offset_distance: of.offset_distance,
            offset_distance_bounds: of.offset_distance_bounds,
            normal: of.normal,
            point: of.point,
            tolerance: of.tolerance,
            min_gap: of.min_gap,
            start_overlaps: of.start_overlaps,
            surfaces: of.surfaces,
            features: of.features,
            ..Self::default()
        }
    }
}

/// Returns two near points in the world frame. Returns `None` if the obstacle has been removed since the
/// query, or if the points cannot be computed.
fn points_of(
    obstacle: ObstacleId,
    near: &AnyNear,
    among: &SceneQuery<'_>,
) -> Option<[[f64; 3]; 2]> {
    let found = match (among.pair_with(obstacle)?, near) {
        (ByKind::Convex(pair), ByKind::Convex(near)) => nearest_points_in_world(&pair.bodies, near),
        (ByKind::Solid(pair), ByKind::Solid(near)) => pair.witness_points(near).ok()?,
        _ => return None,
    };
    Some(found.map(without_negative_zeros))
}
