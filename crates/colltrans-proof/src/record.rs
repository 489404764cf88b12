//! Answers as the command line, batches, Python and the page write them: one flat object of JSON,
//! described by `docs/answers.schema.json`.
//!
//! A [`Record`] says what people and programs ask of an answer: numbers with their proven bounds, points
//! and normals in the world, features by the numbers of the input. What checks a proof is not in it: for
//! that there are the answers themselves, which the feature `serde` writes whole, and `ProofFile`.

mod free;
mod motion;
mod path;
mod ways;

use derive_where::derive_where;
use glam::DVec3;
use serde::{Deserialize, Serialize};

use colltrans_convex::answer::{
    Bounded, Clearance, Contact, ContactRange, Depth, Distance, Grazing, Outcome, OverlapAhead,
    Separated, Solver, Steps, WhyFree, Within,
};
use colltrans_convex::body::{Body, ConvexPolyhedron, Feature, Features, InputVertex, ObstacleId};
use colltrans_convex::cast::Cast;
use colltrans_convex::pair::{Pair, points};
use colltrans_convex::setting::error::QueryError;
use colltrans_convex::solve::observe::{NoObserver, Observer};
use colltrans_kernel::written::named;
use colltrans_scene::{Among, ClearanceAmong, Nearby, Nearest};
use colltrans_solid::body::Solid;
use colltrans_solid::kinds::{AnyClearance, AnyNear, ByKind};
use colltrans_solid::pair::OverlapDepth;
use colltrans_solid::{SolidCast, SolidPair, SolidPairSearch};
pub use free::{BlockedByRecord, FreeRecord, FreeRegionRecord};
pub use motion::TimeRecord;
pub use path::PathRecord;
pub use ways::{LegRecord, WaysRecord};

/// An answer; fields that do not apply are left out, numbers that are infinite are `null`.
///
/// Translations, the `distance` of a clearance and their bounds are in multiples of the direction, other
/// lengths in the unit of the bodies.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
#[non_exhaustive]
pub struct Record {
    /// How the query ended.
    pub outcome: Ending,
    /// Of one query among several directions: the direction as it was read. Of a depth: the unit vector
    /// along which the moving body leaves the fixed one by the shortest way.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub direction: Option<[f64; 3]>,
    /// Blocked: how far it is safe to move.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub distance: Option<f64>,
    /// Overlapping: how far to go back to be free for certain.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub back: Option<f64>,
    /// Overlapping: how far to go on to be free for certain.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub on: Option<f64>,
    /// First contact; of solids, where the facets that stop them meet in their true place.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub translation: Option<f64>,
    /// Proven.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub translation_bounds: Option<[f64; 2]>,
    /// Of solids: how far they go, shrunk by half the tolerance each.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub shrunk_distance: Option<f64>,
    /// Proven.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub shrunk_distance_bounds: Option<[f64; 2]>,
    /// Last contact.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub exit: Option<f64>,
    /// Proven: beyond the second they never meet.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub exit_bounds: Option<[f64; 2]>,
    /// Of a motion: when they first meet, in parts of it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time: Option<TimeRecord>,
    /// Of the clearance of a motion: when they do as the tolerance leaves them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub shrunk_time: Option<TimeRecord>,
    /// Of bodies where they are: a length that their distance, or depth, is not below. Proven.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lower: Option<f64>,
    /// One that it is not above. Proven.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub upper: Option<f64>,
    /// Points of the moving and of the fixed body that are `upper` apart, in the world, rounded.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub points: Option<[[f64; 3]; 2]>,
    /// The name of what touches, or overlaps deepest, of a moving body that has several.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub moving: Option<String>,
    /// The same of the fixed body.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fixed: Option<String>,
    /// One body among many: the number of the one that is told of, the nearest or the first.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub obstacle: Option<ObstacleId>,
    /// One body among many: how many were asked about.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub obstacles: Option<usize>,
    /// One body among many: those that are at most the length away, in the order in which they came.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub closer: Option<Vec<NearbyRecord>>,
    /// One body among many: those of which rounding cannot tell.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub undecided: Vec<NearbyRecord>,
    /// Unit normal from the moving to the fixed body: of the contact plane, of the separating one, or along
    /// the shortest way.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub normal: Option<[f64; 3]>,
    /// The contact point on the fixed body, in the world.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub point: Option<[f64; 3]>,
    /// Of convex bodies: what rounding alone can make of the bounds' difference.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rounding: Option<f64>,
    /// Of solids: the one that was used, a length. Of a motion of convex bodies: the depth that is tolerated.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tolerance: Option<f64>,
    /// The gap that is kept, a length: the bodies count as meeting where they are as near as that.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub keep: Option<f64>,
    /// Of solids: what overlaps now.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub start_overlaps: Vec<StartOverlapRecord>,
    /// Of solids: which are open, at least in part.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub surfaces: Vec<&'static str>,
    /// What touches.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub features: Option<FeaturesRecord>,
    /// Separated: the gap between the shadows along the normal.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub margin: Option<f64>,
    /// Grazing, slides: by how much the shadows overlap; negative where they may not.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub overlap: Option<f64>,
    /// Grazing, slides: the unit vector along which they do, across the direction, from the moving
    /// body's shadow to the fixed one's.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sideways: Option<[f64; 3]>,
    /// Of convex bodies.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub solver: Option<Solver>,
    /// Of convex bodies: how much work it was.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub steps: Option<Steps>,
    /// Of a motion: how many times of it were looked at.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub looks: Option<u32>,
    /// Of a motion: how many planes the proof has.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub planes: Option<usize>,
    /// Depths of the dents of meshes that are convex only to within the tolerance.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dents: Option<Dents>,
    /// For people: what is wrong.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub message: Option<String>,
}

/// Depths to which the surfaces of meshes that are convex only to within the tolerance lie below their hulls, which
/// stand for these meshes in the answer.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Dents {
    /// Depth of the moving body's dent, a length; `None` where the precision of its file explains it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub moving: Option<f64>,
    /// Depth of the fixed body's dent, a length; `None` where the precision of its file explains it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fixed: Option<f64>,
}

impl Dents {
    /// Collects the dents of the moving and of the fixed body; returns `None` if neither body has one.
    pub fn of([moving, fixed]: [Option<f64>; 2]) -> Option<Self> {
        (moving.is_some() || fixed.is_some()).then_some(Self { moving, fixed })
    }
}

/// How a query ended, in a word.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Ending {
    /// The bodies meet along the direction, somewhere.
    Contact,
    /// Their shadows overlap by no more than the graze tolerance.
    Grazing,
    /// They never meet.
    Separated,
    /// Nothing stops a solid.
    Free,
    /// It can go so far.
    Blocked,
    /// Nothing stops a convex body: it slides along the other.
    Slides,
    /// Nothing stops a convex body: they only meet behind.
    Behind,
    /// They overlap now.
    Overlapping,
    /// They have no point in common.
    Apart,
    /// They touch, or overlap by less than rounding can tell.
    Touching,
    /// They touch or overlap: `upper` is 0 where that is proven, else what rounding leaves.
    Meeting,
    /// They are at most the length apart.
    Closer,
    /// They are farther apart than the length.
    Farther,
    /// The length lies between the bounds of their distance. Of a motion or a path: the search took its maximum number of
    /// steps.
    Undecided,
    /// There is no answer.
    #[default]
    Error,
}

/// Two solids that overlap where they are, or two pieces of them by their names.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct StartOverlapRecord {
    /// The name of the moving piece.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub moving: Option<String>,
    /// The name of the fixed piece.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fixed: Option<String>,
    /// The least tolerance with which they would not overlap, if there is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub least_tolerance: Option<f64>,
}

/// One of many bodies, and how far it is.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct NearbyRecord {
    /// Its number.
    pub obstacle: ObstacleId,
    /// Its name.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fixed: Option<String>,
    /// A length that the distance is not below, where it was looked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lower: Option<f64>,
    /// One that it is not above.
    pub upper: f64,
    /// Points of the moving and of this body that are so far apart, in the world, rounded.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub points: Option<[[f64; 3]; 2]>,
    /// Depth of this body's dent, a length, where its mesh is convex only to within the tolerance.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dent: Option<f64>,
}

/// The features of both bodies in the contact plane.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct FeaturesRecord {
    /// Of the moving body.
    pub moving: FeatureRecord,
    /// Of the fixed body.
    pub fixed: FeatureRecord,
}

impl FeaturesRecord {
    /// Of two bodies.
    pub(crate) fn of<B: Body>(features: Features, [moving, fixed]: [&B; 2]) -> Self {
        Self {
            moving: FeatureRecord::of(features.moving, moving),
            fixed: FeatureRecord::of(features.fixed, fixed),
        }
    }
}

/// A feature by the vertices of the input.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct FeatureRecord {
    /// `vertex`, `edge` or `face`.
    pub kind: &'static str,
    /// Its vertices: one, two, or the corners of a face.
    pub vertices: Vec<InputVertex>,
}

/// A question about two convex bodies and a direction, by its name: what command lines, batches and the
/// page ask. Solids are asked for their clearance.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Question {
    /// [`Cast::contact_range`].
    Contact,
    /// [`Cast::clearance`].
    Clearance,
}

/// The answer of a [`Question`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Answer {
    /// Where they meet.
    Contact(ContactRange),
    /// How far one can go.
    Clearance(Clearance),
}

/// A question about two bodies where they are, without a direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PairQuestion {
    /// [`Pair::distance`].
    Distance,
    /// [`Pair::depth`]; of solids `SolidPair::overlap_depth`.
    Depth,
    /// [`Pair::within`] a length.
    Within(f64),
}

/// The answer of a [`PairQuestion`].
#[derive(Debug, Serialize, Deserialize)]
#[derive_where(Clone, PartialEq)]
#[serde(rename_all = "snake_case", bound = "")]
pub enum PairAnswer<B: Body = ConvexPolyhedron> {
    /// How far they are apart.
    Distance(Distance<B>),
    /// Which translation parts convex bodies.
    Depth(Depth),
    /// How deep solids overlap.
    OverlapDepth(OverlapDepth),
    /// Whether they are closer than a length.
    Within {
        /// What [`Pair::within`] says.
        answer: Within<B>,
        /// How much work it was.
        steps: B::Steps,
    },
}

named!("query", Question { Contact: "contact", Clearance: "clearance" });
named!(
    "outcome",
    Ending {
        Contact: "contact",
        Grazing: "grazing",
        Separated: "separated",
        Free: "free",
        Blocked: "blocked",
        Slides: "slides",
        Behind: "behind",
        Overlapping: "overlapping",
        Apart: "apart",
        Touching: "touching",
        Meeting: "meeting",
        Closer: "closer",
        Farther: "farther",
        Undecided: "undecided",
        Error: "error"
    }
);

impl Question {
    /// The answer.
    ///
    /// # Errors
    /// As the question itself.
    pub fn ask(self, cast: &Cast) -> Result<Answer, QueryError> {
        self.ask_observed(cast, &mut NoObserver)
    }

    /// The same, with an observer, as for [`Cast::first_contact_observed`].
    ///
    /// # Errors
    /// As the question itself.
    pub fn ask_observed<O: Observer>(
        self,
        cast: &Cast,
        observer: &mut O,
    ) -> Result<Answer, QueryError> {
        Ok(match self {
            Self::Contact => Answer::Contact(cast.contact_range_observed(observer)?),
            Self::Clearance => Answer::Clearance(cast.clearance_observed(observer)?),
        })
    }
}

impl Answer {
    /// As front ends write it; `cast` is the one that was asked.
    pub fn record(&self, cast: &Cast) -> Record {
        match self {
            Self::Contact(range) => Record::of_contact_range(range, cast),
            Self::Clearance(clearance) => Record::of_clearance(clearance, cast),
        }
    }

    /// Its proof as a file; `cast` is the one that was asked.
    #[cfg(feature = "json")]
    pub fn proof(&self, cast: &Cast<'_>) -> crate::ProofFile {
        match self {
            Self::Contact(range) => crate::ProofFile::of_range(cast, range),
            Self::Clearance(clearance) => crate::ProofFile::of_clearance(cast, clearance),
        }
    }
}

impl PairQuestion {
    /// The answer of convex bodies.
    ///
    /// # Errors
    /// As the question itself.
    pub fn ask(self, pair: &Pair) -> Result<PairAnswer, QueryError> {
        Ok(match self {
            Self::Distance => PairAnswer::Distance(pair.distance()?),
            Self::Depth => PairAnswer::Depth(pair.depth()?),
            Self::Within(length) => PairAnswer::within(pair.within_counted(length)?),
        })
    }

    /// The answer of solids.
    ///
    /// # Errors
    /// As the question itself.
    pub fn ask_solids(self, pair: &Pair<'_, Solid>) -> Result<PairAnswer<Solid>, QueryError> {
        Ok(match self {
            Self::Distance => PairAnswer::Distance(pair.distance()?),
            Self::Depth => PairAnswer::OverlapDepth(pair.overlap_depth()?),
            Self::Within(length) => PairAnswer::within(pair.within_counted(length)?),
        })
    }

    /// The answer of solids and its proof as a file, if it has one: see
    /// [`ProofFile::with_solid_distance`](crate::ProofFile::with_solid_distance).
    ///
    /// # Errors
    /// As the question itself; a body that its own facets do not make once more.
    #[cfg(feature = "json")]
    pub fn prove_solids(
        self,
        pair: &Pair<'_, Solid>,
        pieces: [&[&Solid]; 2],
    ) -> Result<(PairAnswer<Solid>, Option<crate::ProofFile>), crate::ProofFileError> {
        use crate::ProofFile;
        Ok(match self {
            Self::Distance => {
                let (distance, proof) = ProofFile::with_solid_distance(pair, pieces)?;
                (PairAnswer::Distance(distance), Some(proof))
            }
            Self::Depth => (PairAnswer::OverlapDepth(pair.overlap_depth()?), None),
            Self::Within(length) => {
                let (within, proof) = ProofFile::with_solid_within(pair, pieces, length)?;
                (PairAnswer::within(within), Some(proof))
            }
        })
    }
}

impl<B: Body> PairAnswer<B> {
    fn within((answer, steps): (Within<B>, B::Steps)) -> Self {
        Self::Within { answer, steps }
    }
}

impl PairAnswer {
    /// As front ends write it; `pair` is the one that was asked.
    pub fn record(&self, pair: &Pair) -> Record {
        match self {
            Self::Distance(distance) => Record::of_convex_distance(distance, pair),
            Self::Depth(depth) => Record::of_depth(depth),
            Self::OverlapDepth(depth) => Record::of_overlap_depth(*depth),
            Self::Within { answer, steps } => {
                Record { steps: Some(*steps), ..Record::of_within(answer, pair) }
            }
        }
    }

    /// Its proof as a file; `pair` is the one that was asked.
    #[cfg(feature = "json")]
    pub fn proof(&self, pair: &Pair<'_>) -> Option<crate::ProofFile> {
        match self {
            Self::Distance(distance) => Some(crate::ProofFile::of_distance(pair, distance)),
            Self::Depth(depth) => Some(crate::ProofFile::of_depth(pair, depth)),
            Self::OverlapDepth(_) => None,
            Self::Within { answer, .. } => Some(crate::ProofFile::of_distance(pair, answer)),
        }
    }
}

impl PairAnswer<Solid> {
    /// As front ends write it; `pair` is the one that was asked.
    ///
    /// # Errors
    /// As the question itself.
    pub fn record(&self, pair: &Pair<'_, Solid>) -> Result<Record, QueryError> {
        let record = match self {
            Self::Distance(distance) => Record::of_distance(distance, pair),
            Self::Depth(depth) => Record::of_depth(depth),
            Self::OverlapDepth(depth) => Record::of_overlap_depth(*depth),
            Self::Within { answer, .. } => Record::of_solids_within(answer, pair)?,
        };
        Ok(Record { surfaces: open_ones(pair.moving(), pair.fixed()), ..record })
    }
}

impl Record {
    /// Of a query that has no answer, and why.
    pub fn error(message: String) -> Self {
        Self { message: Some(message), ..Self::default() }
    }

    /// Of [`Cast::first_contact`].
    pub fn of_outcome(outcome: &Outcome, cast: &Cast) -> Self {
        let record = match outcome {
            Outcome::Contact(first) => Self::contact(Ending::Contact, first, cast),
            Outcome::Grazing(grazing) => Self::grazing(Ending::Grazing, grazing, cast),
            Outcome::Separated(separated) => Self::separated(separated),
        };
        record.keeping(cast.options().keep)
    }

    /// Of [`Cast::contact_range`].
    pub fn of_contact_range(range: &ContactRange, cast: &Cast) -> Self {
        let record = match range {
            ContactRange::Contact { first, last } => {
                Self::contact(Ending::Contact, first, cast).with_exit(last.exit())
            }
            ContactRange::Grazing { first, last } => {
                Self::grazing(Ending::Grazing, first, cast).with_exit(last.contact.exit())
            }
            ContactRange::Separated(separated) => Self::separated(separated),
        };
        record.keeping(cast.options().keep)
    }

    /// Of [`Cast::clearance`] between convex bodies.
    pub fn of_clearance(clearance: &Clearance, cast: &Cast) -> Self {
        let record = match clearance {
            Clearance::Blocked { distance, contact } => {
                let record = Self::contact(Ending::Blocked, contact, cast);
                Self { distance: Some(*distance), ..record }
            }
            Clearance::Free(WhyFree::Slides(grazing)) => {
                Self::grazing(Ending::Slides, grazing, cast)
            }
            // The last contact is the first one of the way back.
            Clearance::Free(WhyFree::Behind(last)) => {
                let record = Self::contact(Ending::Behind, last, &cast.reversed());
                let record = Self { translation: None, translation_bounds: None, ..record };
                record.with_exit(last.exit())
            }
            Clearance::Free(WhyFree::Separated(separated)) => Self::separated(separated),
            Clearance::Overlapping(OverlapAhead { first, last }) => {
                let record = Self::contact(Ending::Overlapping, first, cast);
                let [back, on] = [first, last].map(|contact| Some(-contact.certificate.lower));
                Self { back, on, ..record }.with_exit(last.exit())
            }
        };
        record.keeping(cast.options().keep)
    }

    /// Of [`Cast::clearance`] between solids; `exit` as `SolidCast::exit` says.
    pub fn of_solids(
        clearance: &Clearance<Solid>,
        exit: Option<Bounded>,
        cast: &Cast<'_, Solid>,
    ) -> Self {
        let record = match clearance {
            Clearance::Free(_) => Self { outcome: Ending::Free, ..Self::default() },
            Clearance::Overlapping(overlap) => {
                let least_tolerance = overlap.least_tolerance;
                let overlap = StartOverlapRecord { least_tolerance, ..Default::default() };
                let start_overlaps = vec![overlap];
                Self { outcome: Ending::Overlapping, start_overlaps, ..Self::default() }
            }
            Clearance::Blocked { distance, contact } => Self {
                outcome: Ending::Blocked,
                distance: Some(*distance),
                shrunk_distance: Some(contact.shrunk_distance.value),
                shrunk_distance_bounds: Some(contact.shrunk_distance.bounds()),
                normal: Some(coordinates(contact.normal)),
                point: Some(coordinates(contact.point_on_fixed)),
                features: Some(FeaturesRecord {
                    moving: FeatureRecord::of(contact.moving_feature, cast.moving()),
                    fixed: FeatureRecord::of(contact.fixed_feature, cast.fixed()),
                }),
                ..Self::default()
            }
            .with_translation(contact.translation),
        };
        let surfaces = open_ones(cast.moving(), cast.fixed());
        let record = Self { tolerance: Some(cast.tolerance()), surfaces, ..record };
        let record = record.keeping(cast.options().keep);
        exit.into_iter().fold(record, Self::with_exit)
    }

    /// Of [`Pair::distance`].
    pub fn of_distance<B: Body>(distance: &Distance<B>, pair: &Pair<'_, B>) -> Self {
        let outcome = if distance.lower > 0.0 { Ending::Apart } else { Ending::Meeting };
        Self {
            outcome,
            lower: Some(distance.lower),
            upper: Some(distance.upper),
            points: Some([coordinates(distance.on_moving), coordinates(distance.on_fixed)]),
            normal: distance.normal.map(coordinates),
            features: distance
                .features
                .map(|features| FeaturesRecord::of(features, [pair.moving(), pair.fixed()])),
            ..Self::default()
        }
    }

    fn of_convex_distance(distance: &Distance, pair: &Pair<'_>) -> Self {
        Self { steps: Some(distance.steps), ..Self::of_distance(distance, pair) }
    }

    /// Of [`Pair::depth`].
    pub fn of_depth(depth: &Depth) -> Self {
        let outcome = match (depth.lower > 0.0, depth.upper > 0.0) {
            (true, _) => Ending::Overlapping,
            (false, true) => Ending::Touching,
            (false, false) => Ending::Apart,
        };
        let direction = depth.upper > 0.0;
        Self {
            outcome,
            direction: direction.then(|| coordinates(depth.direction)),
            lower: Some(depth.lower),
            upper: Some(depth.upper),
            steps: Some(depth.steps),
            ..Self::default()
        }
    }

    /// Of `SolidPair::overlap_depth`.
    pub fn of_overlap_depth(depth: OverlapDepth) -> Self {
        let OverlapDepth { meets, least_tolerance, .. } = depth;
        let outcome = match (least_tolerance, meets) {
            (Some(0.0), false) => Ending::Apart,
            (Some(0.0), true) => Ending::Touching,
            _ => {
                let overlap = StartOverlapRecord { least_tolerance, ..Default::default() };
                let start_overlaps = vec![overlap];
                return Self { outcome: Ending::Overlapping, start_overlaps, ..Self::default() };
            }
        };
        Self { outcome, lower: Some(0.0), upper: Some(0.0), ..Self::default() }
    }

    /// Of [`Pair::within`] between convex bodies.
    pub fn of_within(within: &Within, pair: &Pair) -> Self {
        match within {
            Within::Closer(near) => Self::closer(near.distance, points(&pair.bodies, near)),
            Within::Farther(gap) => {
                Self { normal: Some(coordinates(gap.normal)), ..Self::farther(gap.gap) }
            }
            Within::Undecided(distance) => {
                Self { outcome: Ending::Undecided, ..Self::of_distance(distance, pair) }
            }
        }
    }

    /// Of [`Pair::within`] between solids.
    ///
    /// # Errors
    /// None at present.
    pub fn of_solids_within(
        within: &Within<Solid>,
        pair: &Pair<'_, Solid>,
    ) -> Result<Self, QueryError> {
        Ok(match within {
            Within::Closer(near) => Self::closer(near.distance(), pair.points(near)?),
            Within::Farther(gap) => Self::farther(gap.gap),
            Within::Undecided(distance) => {
                Self { outcome: Ending::Undecided, ..Self::of_distance(distance, pair) }
            }
        })
    }

    /// Of [`Among::nearest`]; `among` is what was asked.
    pub fn of_nearest(nearest: &Nearest, among: &Among<'_>) -> Self {
        let Nearest { obstacle, ref distance, lower, .. } = *nearest;
        let record = match (among.pair_with(obstacle), distance) {
            (Some(ByKind::Convex(pair)), ByKind::Convex(of)) => Self::of_convex_distance(of, &pair),
            (Some(ByKind::Solid(pair)), ByKind::Solid(of)) => Self::of_distance(of, &pair),
            // It has gone since.
            _ => Self { upper: Some(distance.upper()), ..Self::default() },
        };
        let outcome = if lower > 0.0 { Ending::Apart } else { Ending::Meeting };
        Self { outcome, lower: Some(lower), ..record }.among(Some(obstacle), among)
    }

    /// Of [`Among::within`]: *closer* if one is, *undecided* if rounding cannot tell of one, else *farther*.
    pub fn of_nearby(nearby: &Nearby, among: &Among<'_>) -> Self {
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
        Self { outcome, closer, undecided, ..Self::default() }.among(None, among)
    }

    /// Of [`Among::clearance`]; `among` is what was asked. The distance is that of all obstacles together, the
    /// contact that of the one which stops the body.
    pub fn of_clearance_among(found: &ClearanceAmong, among: &Among<'_>, direction: DVec3) -> Self {
        let obstacle = found.stop.map(|(id, _)| id);
        let record = found.stop.and_then(|(id, stop)| {
            Some(match (among.cast_at(id, direction)?, stop) {
                (ByKind::Convex(cast), AnyClearance::Convex(of)) => Self::of_clearance(&of, &cast),
                (ByKind::Solid(cast), AnyClearance::Solid(of)) => Self::of_solids(&of, None, &cast),
                _ => return None,
            })
        });
        let keep = among.options().keep;
        let free = || Self { outcome: Ending::Free, ..Self::default() }.keeping(keep);
        let record = record.unwrap_or_else(free);
        let distance = found.distance().filter(|distance| distance.is_finite());
        Self { distance, ..record }.among(obstacle, among)
    }

    fn among(self, obstacle: Option<ObstacleId>, among: &Among<'_>) -> Self {
        Self { obstacle, obstacles: Some(among.count()), ..self }
    }

    fn closer(upper: f64, points: [DVec3; 2]) -> Self {
        let points = Some(points.map(coordinates));
        Self { outcome: Ending::Closer, upper: Some(upper), points, ..Self::default() }
    }

    fn farther(lower: f64) -> Self {
        Self { outcome: Ending::Farther, lower: Some(lower), ..Self::default() }
    }

    /// With the gap that is kept, if there is one.
    fn keeping(self, gap: f64) -> Self {
        Self { keep: (gap > 0.0).then_some(gap), ..self }
    }

    fn separated(separated: &Separated) -> Self {
        let Separated { certificate, solver, steps, .. } = separated;
        Self {
            outcome: Ending::Separated,
            normal: Some(coordinates(certificate.normal)),
            margin: Some(certificate.margin),
            solver: Some(*solver),
            steps: Some(*steps),
            ..Self::default()
        }
    }

    fn grazing(outcome: Ending, grazing: &Grazing, cast: &Cast) -> Self {
        Self {
            overlap: Some(grazing.overlap),
            sideways: Some(coordinates(grazing.separating_direction)),
            ..Self::contact(outcome, &grazing.contact, cast)
        }
    }

    fn contact(outcome: Ending, contact: &Contact, cast: &Cast) -> Self {
        let Features { moving, fixed } = contact.features(cast);
        Self {
            outcome,
            normal: Some(coordinates(contact.normal)),
            point: Some(coordinates(contact.points(cast).on_fixed)),
            rounding: Some(contact.certificate.rounding),
            features: Some(FeaturesRecord {
                moving: FeatureRecord::of(moving, cast.moving()),
                fixed: FeatureRecord::of(fixed, cast.fixed()),
            }),
            solver: Some(contact.solver),
            steps: Some(contact.steps),
            ..Self::default()
        }
        .with_translation(contact.bounded())
    }

    fn with_translation(self, t: Bounded) -> Self {
        Self { translation: Some(t.value), translation_bounds: Some(t.bounds()), ..self }
    }

    fn with_exit(self, exit: Bounded) -> Self {
        Self { exit: Some(exit.value), exit_bounds: Some(exit.bounds()), ..self }
    }
}

impl FeatureRecord {
    /// A feature of a body.
    pub fn of<B: Body>(feature: Feature, body: &B) -> Self {
        Self { kind: feature.kind(), vertices: feature.vertices(body) }
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

/// Which of two solids are open, at least in part.
fn open_ones(moving: &Solid, fixed: &Solid) -> Vec<&'static str> {
    let sides = [("moving", moving), ("fixed", fixed)].into_iter();
    sides.filter(|(_, body)| !body.is_closed()).map(|(name, _)| name).collect()
}

/// Without -0.
fn coordinates(v: DVec3) -> [f64; 3] {
    v.to_array().map(|c| c + 0.0)
}
