//! Records of answers about two bodies in their given poses.

use colltrans_convex::answer::{Depth, Distance, Steps, Within};
use colltrans_convex::body::Body;
use colltrans_convex::pair::{Pair, nearest_points_in_world};
use colltrans_convex::setting::error::QueryError;
use colltrans_solid::SolidPairSearch;
use colltrans_solid::body::Solid;
use colltrans_solid::pair::OverlapDepth;
use colltrans_solid::penetration::SolidDepth;
use glam::DVec3;

use super::{
    Ending, FeaturesRecord, Fields, StartOverlapRecord, open_bodies, record, without_negative_zeros,
};

record! {
    /// Distance of two bodies, or its comparison with a length.
    #[non_exhaustive]
    pub struct DistanceRecord {
        /// Outcome of the query.
        pub outcome: Ending,
        /// Proven lower bound of the distance.
        pub lower: Option<f64>,
        /// Proven upper bound of the distance.
        pub upper: Option<f64>,
        /// Rounded points of the moving and of the fixed body at the distance `upper`, in the world frame.
        pub points: Option<[[f64; 3]; 2]>,
        /// Name of the nearest part, if the moving body has several.
        pub moving: Option<String>,
        /// Name of the nearest part, if the fixed body has several.
        pub fixed: Option<String>,
        /// Unit normal along the shortest connection, from the moving to the fixed body.
        pub normal: Option<[f64; 3]>,
        /// For solids, the bodies that are open, at least in part.
        pub surfaces: Vec<&'static str>,
        /// Features at the nearest points.
        pub features: Option<FeaturesRecord>,
        /// Amounts of work, for convex bodies.
        pub steps: Option<Steps>,
    }
}

record! {
    /// Overlap of two bodies.
    #[non_exhaustive]
    pub struct DepthRecord {
        /// Outcome of the query.
        pub outcome: Ending,
        /// Unit vector of the shortest translation of the moving body that separates the bodies.
        pub direction: Option<[f64; 3]>,
        /// For solids, this translation. Its length is at most `upper`.
        pub separating_translation: Option<[f64; 3]>,
        /// Proven lower bound of the depth.
        pub lower: Option<f64>,
        /// Proven upper bound of the depth.
        pub upper: Option<f64>,
        /// Name of the part that overlaps most, if the moving body has several.
        pub moving: Option<String>,
        /// Name of the part that overlaps most, if the fixed body has several.
        pub fixed: Option<String>,
        /// For solids, the overlaps.
        pub start_overlaps: Vec<StartOverlapRecord>,
        /// For solids, the bodies that are open, at least in part.
        pub surfaces: Vec<&'static str>,
        /// Amounts of work, for convex bodies.
        pub steps: Option<Steps>,
    }
}

impl DistanceRecord {
    /// Converts an answer of [`Pair::distance`] for convex bodies.
    pub fn from_distance(distance: &Distance, pair: &Pair<'_>) -> Self {
        Self::from_distance_with(distance, pair, &Fields::ALL)
    }

    /// Converts an answer as [`Self::from_distance`] does, with the requested features.
    pub(super) fn from_distance_with(
        distance: &Distance,
        pair: &Pair<'_>,
        requested: &Fields,
    ) -> Self {
        let steps = Some(distance.steps);
        Self { steps, ..Self::of_any_distance(distance, pair, requested) }
    }

    /// Converts both bounds of a distance.
    pub(super) fn of_bounds([lower, upper]: [f64; 2]) -> Self {
        let outcome = if lower > 0.0 { Ending::Apart } else { Ending::Meeting };
        Self { outcome, lower: Some(lower), upper: Some(upper), ..Self::default() }
    }

    /// Converts an answer of [`Pair::distance`] for solids.
    pub fn of_solids(distance: &Distance<Solid>, pair: &Pair<'_, Solid>) -> Self {
        Self {
            surfaces: open_bodies(pair.moving(), pair.fixed()),
            ..Self::of_any_distance(distance, pair, &Fields::ALL)
        }
    }

    /// Converts an answer of [`Pair::within_counted`] for convex bodies.
    pub fn of_within(within: &Within, steps: Steps, pair: &Pair) -> Self {
        let record = match within {
            Within::Closer(near) => {
                Self::of_near_points(near.distance, nearest_points_in_world(&pair.bodies, near))
            }
            Within::Farther(gap) => {
                Self { normal: Some(without_negative_zeros(gap.normal)), ..Self::of_gap(gap.gap) }
            }
            Within::Undecided(distance) => Self {
                outcome: Ending::Undecided,
                ..Self::of_any_distance(distance, pair, &Fields::ALL)
            },
        };
        Self { steps: Some(steps), ..record }
    }

    /// Converts an answer of [`Pair::within_counted`] for solids.
    ///
    /// # Errors
    /// Returns an error if the points of the answer cannot be computed.
    pub fn of_solids_within(
        within: &Within<Solid>,
        pair: &Pair<'_, Solid>,
    ) -> Result<Self, QueryError> {
        let record = match within {
            Within::Closer(near) => {
                Self::of_near_points(near.distance(), pair.witness_points(near)?)
            }
            Within::Farther(gap) => Self::of_gap(gap.gap),
            Within::Undecided(distance) => Self {
                outcome: Ending::Undecided,
                ..Self::of_any_distance(distance, pair, &Fields::ALL)
            },
        };
        Ok(Self { surfaces: open_bodies(pair.moving(), pair.fixed()), ..record })
    }

    fn of_any_distance<B: Body>(
        distance: &Distance<B>,
        pair: &Pair<'_, B>,
        requested: &Fields,
    ) -> Self {
        let bodies = [pair.moving(), pair.fixed()];
        let features = distance.features.filter(|_| requested.includes("features"));
        Self {
            points: Some([
                without_negative_zeros(distance.on_moving),
                without_negative_zeros(distance.on_fixed),
            ]),
            normal: distance.normal.map(without_negative_zeros),
            features: features.map(|features| FeaturesRecord::of_bodies(features, bodies)),
            ..Self::of_bounds([distance.lower, distance.upper])
        }
    }

    fn of_near_points(upper: f64, points: [DVec3; 2]) -> Self {
        let points = Some(points.map(without_negative_zeros));
        Self { outcome: Ending::Closer, upper: Some(upper), points, ..Self::default() }
    }

    fn of_gap(lower: f64) -> Self {
        Self { outcome: Ending::Farther, lower: Some(lower), ..Self::default() }
    }
}

impl DepthRecord {
    /// Converts an answer of [`Pair::depth`].
    pub fn from_depth(depth: &Depth) -> Self {
        let outcome = match (depth.lower > 0.0, depth.upper > 0.0) {
            (true, _) => Ending::Overlapping,
            (false, true) => Ending::Touching,
            (false, false) => Ending::Apart,
        };
        Self {
            outcome,
            direction: (depth.upper > 0.0).then(|| without_negative_zeros(depth.direction)),
            lower: Some(depth.lower),
            upper: Some(depth.upper),
            steps: Some(depth.steps),
            ..Self::default()
        }
    }

    /// Converts an answer of [`overlap_depth`](colltrans_solid::SolidPair::overlap_depth). `surfaces` lists
    /// the open bodies. [`Self::with_solid_depth`] adds the depth.
    pub fn of_overlap(depth: OverlapDepth, surfaces: Vec<&'static str>) -> Self {
        let OverlapDepth { meets, least_tolerance, .. } = depth;
        let outcome = match (least_tolerance, meets) {
            (Some(0.0), false) => Ending::Apart,
            (Some(0.0), true) => Ending::Touching,
            _ => {
                let start_overlaps = StartOverlapRecord::with_least_tolerance(least_tolerance);
                let outcome = Ending::Overlapping;
                return Self { outcome, start_overlaps, surfaces, ..Self::default() };
            }
        };
        Self { outcome, lower: Some(0.0), upper: Some(0.0), surfaces, ..Self::default() }
    }

    /// Returns the record with the depth of solids that overlap, and with the translation that separates them. A depth
    /// that is unknown, as of open surfaces, is not added.
    #[must_use]
    pub fn with_solid_depth(self, depth: &SolidDepth) -> Self {
        if !(depth.upper > 0.0 && depth.upper.is_finite()) {
            return self;
        }
        Self {
            direction: Some(without_negative_zeros(depth.direction)),
            separating_translation: Some(without_negative_zeros(depth.translation)),
            lower: Some(depth.lower),
            upper: Some(depth.upper),
            ..self
        }
    }
}
