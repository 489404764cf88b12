//! Answers about bodies where they are, as front ends write them.

use colltrans_convex::answer::{Depth, Distance, Steps, Within};
use colltrans_convex::body::Body;
use colltrans_convex::pair::{Pair, points};
use colltrans_convex::setting::error::QueryError;
use colltrans_solid::SolidPairSearch;
use colltrans_solid::body::Solid;
use colltrans_solid::pair::OverlapDepth;
use glam::DVec3;

use super::{Ending, FeaturesRecord, StartOverlapRecord, coordinates, open_ones, record};

record! {
    /// How far bodies are apart, or whether they are closer than a length.
    #[non_exhaustive]
    pub struct DistanceRecord {
        /// How the query ended.
        pub outcome: Ending,
        /// A length that the distance is not below. Proven.
        pub lower: Option<f64>,
        /// One that it is not above. Proven.
        pub upper: Option<f64>,
        /// Points of the moving and of the fixed body that are `upper` apart, in the world, rounded.
        pub points: Option<[[f64; 3]; 2]>,
        /// The name of what is nearest, of a moving body that has several.
        pub moving: Option<String>,
        /// The name of what is nearest, of a fixed body that has several.
        pub fixed: Option<String>,
        /// Unit normal along the shortest way, from the moving to the fixed body.
        pub normal: Option<[f64; 3]>,
        /// Of solids: which are open, at least in part.
        pub surfaces: Vec<&'static str>,
        /// What is nearest.
        pub features: Option<FeaturesRecord>,
        /// Of convex bodies: how much work it was.
        pub steps: Option<Steps>,
    }
}

record! {
    /// How deep bodies overlap.
    #[non_exhaustive]
    pub struct DepthRecord {
        /// How the query ended.
        pub outcome: Ending,
        /// The unit vector along which the moving body leaves the fixed one by the shortest way.
        pub direction: Option<[f64; 3]>,
        /// A length that the depth is not below. Proven.
        pub lower: Option<f64>,
        /// One that it is not above. Proven.
        pub upper: Option<f64>,
        /// The name of what overlaps deepest, of a moving body that has several.
        pub moving: Option<String>,
        /// The name of what overlaps deepest, of a fixed body that has several.
        pub fixed: Option<String>,
        /// Of solids: what overlaps now.
        pub start_overlaps: Vec<StartOverlapRecord>,
        /// Of solids: which are open, at least in part.
        pub surfaces: Vec<&'static str>,
        /// Of convex bodies: how much work it was.
        pub steps: Option<Steps>,
    }
}

impl DistanceRecord {
    /// Of [`Pair::distance`] between convex bodies.
    pub fn of(distance: &Distance, pair: &Pair<'_>) -> Self {
        Self { steps: Some(distance.steps), ..Self::between(distance, pair) }
    }

    /// Of [`Pair::distance`] between solids.
    pub fn of_solids(distance: &Distance<Solid>, pair: &Pair<'_, Solid>) -> Self {
        Self { surfaces: open_ones(pair.moving(), pair.fixed()), ..Self::between(distance, pair) }
    }

    /// Of [`Pair::within_counted`] between convex bodies.
    pub fn of_within(within: &Within, steps: Steps, pair: &Pair) -> Self {
        let record = match within {
            Within::Closer(near) => Self::closer(near.distance, points(&pair.bodies, near)),
            Within::Farther(gap) => {
                Self { normal: Some(coordinates(gap.normal)), ..Self::farther(gap.gap) }
            }
            Within::Undecided(distance) => {
                Self { outcome: Ending::Undecided, ..Self::between(distance, pair) }
            }
        };
        Self { steps: Some(steps), ..record }
    }

    /// Of [`Pair::within_counted`] between solids.
    ///
    /// # Errors
    /// None at present.
    pub fn of_solids_within(
        within: &Within<Solid>,
        pair: &Pair<'_, Solid>,
    ) -> Result<Self, QueryError> {
        let record = match within {
            Within::Closer(near) => Self::closer(near.distance(), pair.points(near)?),
            Within::Farther(gap) => Self::farther(gap.gap),
            Within::Undecided(distance) => {
                Self { outcome: Ending::Undecided, ..Self::between(distance, pair) }
            }
        };
        Ok(Self { surfaces: open_ones(pair.moving(), pair.fixed()), ..record })
    }

    fn between<B: Body>(distance: &Distance<B>, pair: &Pair<'_, B>) -> Self {
        let bodies = [pair.moving(), pair.fixed()];
        Self {
            outcome: if distance.lower > 0.0 { Ending::Apart } else { Ending::Meeting },
            lower: Some(distance.lower),
            upper: Some(distance.upper),
            points: Some([coordinates(distance.on_moving), coordinates(distance.on_fixed)]),
            normal: distance.normal.map(coordinates),
            features: distance.features.map(|features| FeaturesRecord::of(features, bodies)),
            ..Self::default()
        }
    }

    fn closer(upper: f64, points: [DVec3; 2]) -> Self {
        let points = Some(points.map(coordinates));
        Self { outcome: Ending::Closer, upper: Some(upper), points, ..Self::default() }
    }

    fn farther(lower: f64) -> Self {
        Self { outcome: Ending::Farther, lower: Some(lower), ..Self::default() }
    }
}

impl DepthRecord {
    /// Of [`Pair::depth`].
    pub fn of(depth: &Depth) -> Self {
        let outcome = match (depth.lower > 0.0, depth.upper > 0.0) {
            (true, _) => Ending::Overlapping,
            (false, true) => Ending::Touching,
            (false, false) => Ending::Apart,
        };
        Self {
            outcome,
            direction: (depth.upper > 0.0).then(|| coordinates(depth.direction)),
            lower: Some(depth.lower),
            upper: Some(depth.upper),
            steps: Some(depth.steps),
            ..Self::default()
        }
    }

    /// Of [`overlap_depth`](colltrans_solid::SolidPair::overlap_depth); `surfaces` are the bodies that are open.
    pub fn of_overlap(depth: OverlapDepth, surfaces: Vec<&'static str>) -> Self {
        let OverlapDepth { meets, least_tolerance, .. } = depth;
        let outcome = match (least_tolerance, meets) {
            (Some(0.0), false) => Ending::Apart,
            (Some(0.0), true) => Ending::Touching,
            _ => {
                let start_overlaps = StartOverlapRecord::parted_by(least_tolerance);
                let outcome = Ending::Overlapping;
                return Self { outcome, start_overlaps, surfaces, ..Self::default() };
            }
        };
        Self { outcome, lower: Some(0.0), upper: Some(0.0), surfaces, ..Self::default() }
    }
}
