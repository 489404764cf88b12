//! Answers about one body among many, as front ends write them.

use colltrans_convex::answer::{Solver, Steps};
use colltrans_convex::body::ObstacleId;
use colltrans_convex::pair::points;
use colltrans_scene::{Among, ClearanceAmong, Nearby, Nearest};
use colltrans_solid::SolidPairSearch;
use colltrans_solid::kinds::{AnyClearance, AnyNear, ByKind};
use glam::DVec3;

use super::{
    ClearanceRecord, ContactRecord, DistanceRecord, Ending, FeaturesRecord, NearbyRecord,
    SolidClearanceRecord, StartOverlapRecord, coordinates, kept, record,
};

record! {
    /// Which obstacle is nearest to a body.
    #[non_exhaustive]
    pub struct NearestRecord {
        /// How the query ended.
        pub outcome: Ending,
        /// A length that the distance of no obstacle is below. Proven.
        pub lower: Option<f64>,
        /// One that the distance of this obstacle is not above. Proven.
        pub upper: Option<f64>,
        /// Points of the moving body and of the obstacle that are `upper` apart, in the world, rounded.
        pub points: Option<[[f64; 3]; 2]>,
        /// The name of the obstacle.
        pub fixed: Option<String>,
        /// The number of the obstacle.
        pub obstacle: ObstacleId,
        /// How many obstacles were asked about.
        pub obstacles: usize,
        /// Unit normal along the shortest way, from the moving body to the obstacle.
        pub normal: Option<[f64; 3]>,
        /// What is nearest.
        pub features: Option<FeaturesRecord>,
        /// Of convex bodies: how much work it was.
        pub steps: Option<Steps>,
    }
}

record! {
    /// Which obstacles are closer to a body than a length.
    #[non_exhaustive]
    pub struct SceneWithinRecord {
        /// `closer` if an obstacle is, `undecided` if rounding cannot tell of one, else `farther`.
        pub outcome: Ending,
        /// How many obstacles were asked about.
        pub obstacles: usize,
        /// Those that are at most the length away, in the order in which they came.
        pub closer: Option<Vec<NearbyRecord>>,
        /// Those of which rounding cannot tell.
        pub undecided: Vec<NearbyRecord>,
    }
}

record! {
    /// How far a body can move along a direction before one of many obstacles stops it. The distance is that of all
    /// obstacles together, the contact that of the one which stops the body.
    #[non_exhaustive]
    pub struct SceneClearanceRecord {
        /// How the query ended.
        pub outcome: Ending,
        /// Blocked: how far it is safe to move.
        pub distance: Option<f64>,
        /// Overlapping a convex obstacle: how far to go back to be free for certain.
        pub back: Option<f64>,
        /// Overlapping a convex obstacle: how far to go on to be free for certain.
        pub on: Option<f64>,
        /// First contact; of solids, where the facets that stop them meet in their true place.
        pub translation: Option<f64>,
        /// Proven.
        pub translation_bounds: Option<[f64; 2]>,
        /// Of solids: how far they go, shrunk by half the tolerance each.
        pub shrunk_distance: Option<f64>,
        /// Proven.
        pub shrunk_distance_bounds: Option<[f64; 2]>,
        /// Overlapping a convex obstacle: last contact.
        pub exit: Option<f64>,
        /// Proven: beyond the second they never meet.
        pub exit_bounds: Option<[f64; 2]>,
        /// The name of the obstacle.
        pub fixed: Option<String>,
        /// The number of the obstacle; `None` if the body is free.
        pub obstacle: Option<ObstacleId>,
        /// How many obstacles were asked about.
        pub obstacles: usize,
        /// Unit normal of the contact plane, from the moving body to the obstacle.
        pub normal: Option<[f64; 3]>,
        /// The contact point on the obstacle, in the world.
        pub point: Option<[f64; 3]>,
        /// Of convex bodies: what rounding alone can make of the bounds' difference.
        pub rounding: Option<f64>,
        /// Of solids: the one that was used, a length.
        pub tolerance: Option<f64>,
        /// The gap that is kept, a length: bodies count as meeting where they are as near as that.
        pub keep: Option<f64>,
        /// Of solids: what overlaps now.
        pub start_overlaps: Vec<StartOverlapRecord>,
        /// Of solids: which are open, at least in part.
        pub surfaces: Vec<&'static str>,
        /// What touches.
        pub features: Option<FeaturesRecord>,
        /// Of convex bodies.
        pub solver: Option<Solver>,
        /// Of convex bodies: how much work it was.
        pub steps: Option<Steps>,
    }
}

impl NearestRecord {
    /// Of [`Among::nearest`]; `among` is what was asked.
    pub fn of(nearest: &Nearest, among: &Among<'_>) -> Self {
        let Nearest { obstacle, ref distance, lower, .. } = *nearest;
        let of = match (among.pair_with(obstacle), distance) {
            (Some(ByKind::Convex(pair)), ByKind::Convex(of)) => DistanceRecord::of(of, &pair),
            (Some(ByKind::Solid(pair)), ByKind::Solid(of)) => DistanceRecord::of_solids(of, &pair),
            // It has gone since.
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
            obstacles: among.count(),
            normal,
            features,
            steps,
        }
    }
}

impl From<&NearestRecord> for DistanceRecord {
    /// The distance of the nearest obstacle.
    fn from(nearest: &NearestRecord) -> Self {
        let NearestRecord { outcome, lower, upper, points, normal, steps, .. } = *nearest;
        let (fixed, features) = (nearest.fixed.clone(), nearest.features.clone());
        let (moving, surfaces) = (None, Vec::new());
        Self { outcome, lower, upper, points, moving, fixed, normal, surfaces, features, steps }
    }
}

impl SceneWithinRecord {
    /// Of [`Among::within`]; `among` is what was asked.
    pub fn of(nearby: &Nearby, among: &Among<'_>) -> Self {
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
            points: Some([distance.on_moving(), distance.on_fixed()].map(coordinates)),
            ..NearbyRecord::default()
        });
        let (closer, undecided) = (Some(closer.collect()), undecided.collect());
        Self { outcome, obstacles: among.count(), closer, undecided }
    }
}

impl SceneClearanceRecord {
    /// Of [`Among::clearance`]; `among` is what was asked.
    pub fn of(found: &ClearanceAmong, among: &Among<'_>, direction: DVec3) -> Self {
        let record = found.stop.and_then(|(id, stop)| {
            Some(match (among.cast_at(id, direction)?, stop) {
                (ByKind::Convex(cast), AnyClearance::Convex(of)) => {
                    ClearanceRecord::of(&of, &cast).into()
                }
                (ByKind::Solid(cast), AnyClearance::Solid(of)) => {
                    SolidClearanceRecord::of(&of, None, &cast).into()
                }
                _ => return None,
            })
        });
        let free =
            || Self { outcome: Ending::Free, keep: kept(among.options().keep), ..Self::default() };
        Self {
            distance: found.distance().filter(|distance| distance.is_finite()),
            obstacle: found.stop.map(|(id, _)| id),
            obstacles: among.count(),
            ..record.unwrap_or_else(free)
        }
    }
}

impl From<ClearanceRecord> for SceneClearanceRecord {
    fn from(of: ClearanceRecord) -> Self {
        let ContactRecord { translation, translation_bounds, exit, exit_bounds, .. } = of.contact;
        let ContactRecord { normal, point, rounding, keep, features, solver, steps, .. } =
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
            keep,
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
            shrunk_distance: of.shrunk_distance,
            shrunk_distance_bounds: of.shrunk_distance_bounds,
            normal: of.normal,
            point: of.point,
            tolerance: of.tolerance,
            keep: of.keep,
            start_overlaps: of.start_overlaps,
            surfaces: of.surfaces,
            features: of.features,
            ..Self::default()
        }
    }
}

/// Two points that are near, in the world; `None` if the obstacle has gone since.
fn points_of(obstacle: ObstacleId, near: &AnyNear, among: &Among<'_>) -> Option<[[f64; 3]; 2]> {
    let found = match (among.pair_with(obstacle)?, near) {
        (ByKind::Convex(pair), ByKind::Convex(near)) => points(&pair.bodies, near),
        (ByKind::Solid(pair), ByKind::Solid(near)) => pair.points(near).ok()?,
        _ => return None,
    };
    Some(found.map(coordinates))
}
