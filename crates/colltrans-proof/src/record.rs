//! Answers as the command line, batches, Python and the page write them: one JSON object for each answer,
//! described by `docs/answers.schema.json`.
//!
//! Each query has a record, a struct with the values that users and programs need: numbers with their proven
//! bounds, points and normals in the world frame, and features by the indices of the input. A record contains
//! no certificates. The answer types themselves, which the feature `serde` serialises completely, and
//! `ProofFile` contain them.

mod cast;
mod free;
mod motion;
mod path;
mod placed;
mod scene;
mod ways;

use std::collections::BTreeMap;

use derive_where::derive_where;
use glam::DVec3;
use serde::{Deserialize, Serialize};

use colltrans_convex::answer::{Clearance, ContactRange, Depth, Distance, Within};
use colltrans_convex::body::{Body, ConvexPolyhedron, Feature, Features, InputVertex, ObstacleId};
use colltrans_convex::cast::Cast;
use colltrans_convex::pair::Pair;
use colltrans_convex::setting::error::QueryError;
use colltrans_convex::solve::observe::{NoObserver, Observer};
use colltrans_kernel::serialization::named;
use colltrans_solid::SolidPair;
use colltrans_solid::body::Solid;
use colltrans_solid::pair::OverlapDepth;
use colltrans_solid::penetration::SolidPenetration;

pub use cast::{CastRecord, ClearanceRecord, ContactRecord, SolidClearanceRecord};
pub use free::{BlockedByRecord, FreeRecord, FreeRegionRecord};
pub use motion::{MotionRecord, TimeRecord};
pub use path::PathRecord;
pub use placed::{DepthRecord, DistanceRecord};
pub use scene::{NearestRecord, SceneClearanceRecord, SceneWithinRecord};
pub use ways::{LegRecord, WaysRecord};

/// Defines a record. Its fields are those of the JSON object, in the same order. Absent values
/// ([`Field::is_absent`]) are omitted. The last field, after `..`, is a record whose own fields follow.
macro_rules! record {
    ($(#[$about:meta])* pub struct $name:ident {
        $($(#[$doc:meta])* pub $field:ident: $type:ty,)*
        $(.. $(#[$more:meta])* pub $rest:ident: $rest_type:ty,)?
    }) => {
        $(#[$about])*
        #[derive(Debug, Clone, PartialEq, Default, serde::Serialize)]
        pub struct $name {
            $(
                $(#[$doc])*
                #[serde(skip_serializing_if = "crate::record::Field::is_absent")]
                pub $field: $type,
            )*
            $($(#[$more])* #[serde(flatten)] pub $rest: $rest_type,)?
        }

        impl $name {
            /// Returns the names of all fields, in the order of the JSON.
            pub fn fields() -> Vec<&'static str> {
                let own: &[_] = &[$(stringify!($field)),*];
                [own, $(&<$rest_type>::fields())?].concat()
            }

            /// Removes the fields that are not requested. Fields that every record has stay.
            pub fn keep_fields(&mut self, requested: &crate::record::Fields) {
                $(if !requested.includes(stringify!($field)) {
                    crate::record::Field::remove(&mut self.$field);
                })*
                $(self.$rest.keep_fields(requested);)?
            }
        }
    };
}
use record;

/// Value of a field that may be absent.
trait Field {
    /// Checks whether the field is omitted.
    fn is_absent(&self) -> bool {
        false
    }

    /// Makes the field absent, unless every record has it.
    fn remove(&mut self) {}
}

impl<T> Field for Option<T> {
    fn is_absent(&self) -> bool {
        self.is_none()
    }

    fn remove(&mut self) {
        *self = None;
    }
}

impl<T> Field for Vec<T> {
    fn is_absent(&self) -> bool {
        self.is_empty()
    }

    fn remove(&mut self) {
        self.clear();
    }
}

impl<K, V> Field for BTreeMap<K, V> {
    fn is_absent(&self) -> bool {
        self.is_empty()
    }

    fn remove(&mut self) {
        self.clear();
    }
}

macro_rules! always_present {
    ($($type:ty),*) => { $(impl Field for $type {})* };
}
always_present!(Ending, ObstacleId, f64, u32, usize, &str);

/// Names of fields that are requested. The default is all fields.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Fields(Option<Box<[String]>>);

impl Fields {
    /// All fields.
    pub const ALL: Self = Self(None);

    /// Requests only the fields with these names. Unknown names have no effect.
    pub fn from_names(names: impl IntoIterator<Item = String>) -> Self {
        Self(Some(names.into_iter().collect()))
    }

    /// Checks whether a field is requested.
    #[inline]
    pub fn includes(&self, name: &str) -> bool {
        self.0.as_deref().is_none_or(|names| names.iter().any(|requested| requested == name))
    }
}

/// Answer to any query about two bodies, for example a line of a batch.
///
/// Fields that do not apply are omitted. Infinite numbers are `null`. These values along a direction, and their
/// bounds, are multiples of the direction: `translation`, `exit`, the `distance` of a clearance, `offset_distance`,
/// `back`, `on` and `rounding`. Lengths have the unit of the bodies.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Record {
    /// First and last contact of convex bodies along a direction.
    Cast(CastRecord),
    /// Clearance of a convex body.
    Clearance(ClearanceRecord),
    /// Clearance of a solid.
    SolidClearance(SolidClearanceRecord),
    /// Distance of two bodies, or its comparison with a length.
    Distance(DistanceRecord),
    /// Overlap of two bodies.
    Depth(DepthRecord),
    /// First contact or clearance along a motion.
    Motion(MotionRecord),
    /// Failed query.
    Error(ErrorRecord),
}

record! {
    /// Query that has no answer.
    #[non_exhaustive]
    pub struct ErrorRecord {
        /// Always `error`.
        pub outcome: Ending,
        /// The direction as it was read, for one of several directions.
        pub direction: Option<[f64; 3]>,
    }
}

record! {
    /// Depths to which the surfaces of meshes lie below their convex hulls. The hulls replace meshes that are
    /// convex only within the tolerance.
    #[derive(Copy)]
    pub struct Dents {
        /// Depth of the moving body's dent, a length. It is `None` if the precision of its file explains the
        /// dent.
        pub moving: Option<f64>,
        /// Depth of the fixed body's dent, a length. It is `None` if the precision of its file explains the
        /// dent.
        pub fixed: Option<f64>,
    }
}

impl Dents {
    /// Collects the dents of both bodies. Returns `None` if neither body has one.
    pub fn from_depths([moving, fixed]: [Option<f64>; 2]) -> Option<Self> {
        (moving.is_some() || fixed.is_some()).then_some(Self { moving, fixed })
    }
}

/// Outcome of a query, in one word.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Ending {
    /// The bodies meet along the direction.
    Contact,
    /// The shadows overlap by no more than the graze tolerance. For a motion or a path: the bodies come
    /// nearer than rounding errors can decide.
    Grazing,
    /// The bodies never meet.
    Separated,
    /// Nothing blocks a solid, or nothing blocks a body in a scene. For a motion or a path: no bodies meet. For
    /// free directions: some directions are free.
    Free,
    /// A body is blocked after a finite distance. For free directions: it is proven that no direction is
    /// free.
    Blocked,
    /// Nothing blocks a convex body, because it slides along the other one.
    Slides,
    /// Nothing blocks a convex body, because the only contacts are behind it.
    Behind,
    /// The bodies overlap at the start.
    Overlapping,
    /// The bodies have no common point.
    Apart,
    /// The bodies touch, or overlap by less than the rounding error.
    Touching,
    /// The bodies touch or overlap. `upper` is 0 if this is proven, otherwise a bound on the rounding error.
    Meeting,
    /// The distance is at most the given length.
    Closer,
    /// The distance is larger than the given length.
    Farther,
    /// The given length lies between the bounds of the distance. For a motion or a path: the search took its
    /// maximum number of steps. For free directions: no free direction was found, and some directions are
    /// undecided.
    Undecided,
    /// The query has no answer.
    #[default]
    Error,
}

record! {
    /// Overlap of two solids at the start, or of two pieces of them.
    pub struct StartOverlapRecord {
        /// Name of the moving piece.
        pub moving: Option<String>,
        /// Name of the fixed piece.
        pub fixed: Option<String>,
        /// Smallest tolerance at which the pieces do not overlap; absent if there is none.
        pub least_tolerance: Option<f64>,
    }
}

impl StartOverlapRecord {
    /// Returns a list with the overlap of two bodies, without names.
    fn with_least_tolerance(least_tolerance: Option<f64>) -> Vec<Self> {
        vec![Self { least_tolerance, ..Self::default() }]
    }
}

record! {
    /// One of several obstacles, and its distance.
    pub struct NearbyRecord {
        /// Index of the obstacle.
        pub obstacle: ObstacleId,
        /// Name of the obstacle.
        pub fixed: Option<String>,
        /// Lower bound of the distance, if it was computed.
        pub lower: Option<f64>,
        /// Upper bound of the distance.
        pub upper: f64,
        /// Rounded points of the moving body and of this obstacle at the distance `upper`, in the world
        /// frame.
        pub points: Option<[[f64; 3]; 2]>,
        /// Depth of the dent of a mesh that is convex only within the tolerance, a length.
        pub dent: Option<f64>,
    }
}

/// Features of both bodies in the contact plane.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct FeaturesRecord {
    /// Feature of the moving body.
    pub moving: FeatureRecord,
    /// Feature of the fixed body.
    pub fixed: FeatureRecord,
}

impl FeaturesRecord {
    /// Converts the features of two bodies.
    pub(crate) fn of_bodies<B: Body>(features: Features, [moving, fixed]: [&B; 2]) -> Self {
        Self {
            moving: FeatureRecord::from_feature(features.moving, moving),
            fixed: FeatureRecord::from_feature(features.fixed, fixed),
        }
    }
}

/// Feature, given by vertices of the input.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct FeatureRecord {
    /// `vertex`, `edge` or `face`.
    pub kind: &'static str,
    /// Indices of its vertices: one, two, or the corners of a face.
    pub vertices: Vec<InputVertex>,
}

/// Query about two convex bodies and a direction. Its names are `contact` and `clearance`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Question {
    /// [`Cast::contact_range`].
    Contact,
    /// [`Cast::clearance`].
    Clearance,
}

/// Answer to a [`Question`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Answer {
    /// Range of translations with contact.
    Contact(ContactRange),
    /// Clearance.
    Clearance(Clearance),
}

/// Query about two bodies in their given poses, without a direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PairQuestion {
    /// [`Pair::distance`].
    Distance,
    /// [`Pair::depth`], or `SolidPair::overlap_depth` for solids.
    Depth,
    /// [`Pair::within`] with a length.
    Within(f64),
}

/// Answer to a [`PairQuestion`].
#[derive(Debug, Serialize, Deserialize)]
#[derive_where(Clone, PartialEq)]
#[serde(rename_all = "snake_case", bound = "")]
pub enum PairAnswer<B: Body = ConvexPolyhedron> {
    /// Distance of the bodies.
    Distance(Distance<B>),
    /// Penetration depth of convex bodies, with the translation that separates them.
    Depth(Depth),
    /// Overlap depth of solids.
    OverlapDepth(OverlapDepth),
    /// Comparison of the distance with a length.
    Within {
        /// Answer of [`Pair::within`].
        answer: Within<B>,
        /// Amounts of work.
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
    /// Computes the answer for a cast.
    ///
    /// # Errors
    /// Returns the errors of the query's method.
    pub fn answer(self, cast: &Cast) -> Result<Answer, QueryError> {
        self.answer_observed(cast, &mut NoObserver)
    }

    /// Computes the answer for a cast and reports events to an observer, like
    /// [`Cast::first_contact_observed`].
    ///
    /// # Errors
    /// Returns the errors of the query's method.
    pub fn answer_observed<O: Observer>(
        self,
        cast: &Cast,
        observer: &mut O,
    ) -> Result<Answer, QueryError> {
        Ok(match self {
            Self::Contact => Answer::Contact(cast.contact_range_observed(observer)?),
            Self::Clearance => Answer::Clearance(cast.clearance_observed(observer)?),
        })
    }

    /// Computes the requested fields of the record for a cast.
    ///
    /// A contact for which neither `exit` nor `exit_bounds` is requested is answered by [`Cast::first_contact`]. Its
    /// translation can then differ in the last digits, and it grazes only if the first contact does. Features and
    /// points that are not requested are not computed.
    ///
    /// # Errors
    /// Returns the errors of the query's method.
    ///
    /// ```
    /// use colltrans::glam::DVec3;
    /// use colltrans::record::{Fields, Question};
    /// use colltrans::{Cast, ConvexPolyhedron, Pose};
    ///
    /// let cube = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE)?;
    /// let start = Pose::from_translation(DVec3::new(-3.0, 0.5, 0.0))?;
    /// let cast = Cast::new(cube.at(start), cube.at(Pose::IDENTITY), DVec3::X)?;
    /// let requested = Fields::from_names(["translation".into()]);
    /// let record = Question::Contact.record(&cast, &requested)?;
    /// let contact = record.contact().expect("it is the record of a cast");
    /// assert_eq!(contact.translation, Some(2.0));
    /// assert!(contact.features.is_none() && contact.exit.is_none());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn record(self, cast: &Cast, requested: &Fields) -> Result<Record, QueryError> {
        let needs_exit = ["exit", "exit_bounds"].iter().any(|name| requested.includes(name));
        let mut record: Record = match self {
            Self::Contact if needs_exit => {
                CastRecord::of_range_with(&cast.contact_range()?, cast, requested).into()
            }
            Self::Contact => {
                CastRecord::of_outcome_with(&cast.first_contact()?, cast, requested).into()
            }
            Self::Clearance => {
                ClearanceRecord::from_clearance_with(&cast.clearance()?, cast, requested).into()
            }
        };
        record.keep_fields(requested);
        Ok(record)
    }
}

impl Answer {
    /// Converts the answer to a record. `cast` must be the cast of the query.
    pub fn record(&self, cast: &Cast) -> Record {
        match self {
            Self::Contact(range) => CastRecord::of_range(range, cast).into(),
            Self::Clearance(clearance) => ClearanceRecord::from_clearance(clearance, cast).into(),
        }
    }

    /// Builds the proof file of the answer. `cast` must be the cast of the query.
    #[cfg(feature = "json")]
    pub fn proof(&self, cast: &Cast<'_>) -> crate::ProofFile {
        match self {
            Self::Contact(range) => crate::ProofFile::of_range(cast, range),
            Self::Clearance(clearance) => crate::ProofFile::of_clearance(cast, clearance),
        }
    }
}

impl PairQuestion {
    /// Computes the answer for convex bodies.
    ///
    /// # Errors
    /// Returns the errors of the query's method.
    pub fn answer(self, pair: &Pair) -> Result<PairAnswer, QueryError> {
        Ok(match self {
            Self::Distance => PairAnswer::Distance(pair.distance()?),
            Self::Depth => PairAnswer::Depth(pair.depth()?),
            Self::Within(length) => PairAnswer::within_answer(pair.within_counted(length)?),
        })
    }

    /// Computes the requested fields of the record for convex bodies.
    ///
    /// A distance of which only `lower` and `upper` are requested is answered by [`Pair::distance_bounds`], whose
    /// bounds can differ in the last digits for bodies that are points or spheres.
    ///
    /// # Errors
    /// Returns the errors of the query's method.
    pub fn record(self, pair: &Pair, requested: &Fields) -> Result<Record, QueryError> {
        let more = ["points", "normal", "features", "steps"];
        let mut record: Record = match self {
            Self::Distance if more.iter().any(|name| requested.includes(name)) => {
                DistanceRecord::from_distance_with(&pair.distance()?, pair, requested).into()
            }
            Self::Distance => DistanceRecord::of_bounds(pair.distance_bounds()?).into(),
            Self::Depth | Self::Within(_) => self.answer(pair)?.record(pair),
        };
        record.keep_fields(requested);
        Ok(record)
    }

    /// Computes the answer for solids.
    ///
    /// # Errors
    /// Returns the errors of the query's method.
    pub fn answer_solids(self, pair: &Pair<'_, Solid>) -> Result<PairAnswer<Solid>, QueryError> {
        Ok(match self {
            Self::Distance => PairAnswer::Distance(pair.distance()?),
            Self::Depth => PairAnswer::OverlapDepth(pair.overlap_depth()?),
            Self::Within(length) => PairAnswer::within_answer(pair.within_counted(length)?),
        })
    }

    /// Computes the answer for solids, and its proof file. See
    /// [`ProofFile::with_solid_distance`](crate::ProofFile::with_solid_distance). That of a depth is
    /// about translations ([`ProofFile::of_solid_depth`](crate::ProofFile::of_solid_depth)). Its bounds may be farther
    /// apart than those of the record.
    ///
    /// # Errors
    /// Returns the errors of the query's method, and an error for a body that cannot be rebuilt from its own
    /// facets.
    #[cfg(feature = "json")]
    pub fn prove_solids(
        self,
        pair: &Pair<'_, Solid>,
        pieces: [&[&Solid]; 2],
    ) -> Result<(PairAnswer<Solid>, crate::ProofFile), crate::ProofFileError> {
        use crate::ProofFile;
        Ok(match self {
            Self::Distance => {
                let (distance, proof) = ProofFile::with_solid_distance(pair, pieces)?;
                (PairAnswer::Distance(distance), proof)
            }
            Self::Depth => {
                let proof = ProofFile::of_solid_depth(pair, pieces)?;
                (PairAnswer::OverlapDepth(pair.overlap_depth()?), proof)
            }
            Self::Within(length) => {
                let (within, proof) = ProofFile::with_solid_within(pair, pieces, length)?;
                (PairAnswer::within_answer(within), proof)
            }
        })
    }
}

impl<B: Body> PairAnswer<B> {
    fn within_answer((answer, steps): (Within<B>, B::Steps)) -> Self {
        Self::Within { answer, steps }
    }
}

impl PairAnswer {
    /// Converts the answer to a record. `pair` must be the pair of the query.
    pub fn record(&self, pair: &Pair) -> Record {
        match self {
            Self::Distance(distance) => DistanceRecord::from_distance(distance, pair).into(),
            Self::Depth(depth) => DepthRecord::from_depth(depth).into(),
            Self::OverlapDepth(depth) => DepthRecord::of_overlap(*depth, Vec::new()).into(),
            Self::Within { answer, steps } => {
                DistanceRecord::of_within(answer, *steps, pair).into()
            }
        }
    }

    /// Builds the proof file of the answer. `pair` must be the pair of the query. Returns `None` for an
    /// overlap depth.
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
    /// Converts the answer to a record. `pair` must be the pair of the query. Computes the depth of solids that overlap.
    ///
    /// # Errors
    /// Returns an error if the points of the answer or the depth cannot be computed.
    pub fn record(&self, pair: &Pair<'_, Solid>) -> Result<Record, QueryError> {
        let surfaces = open_bodies(pair.moving(), pair.fixed());
        Ok(match self {
            Self::Distance(distance) => DistanceRecord::of_solids(distance, pair).into(),
            Self::Depth(depth) => DepthRecord { surfaces, ..DepthRecord::from_depth(depth) }.into(),
            Self::OverlapDepth(depth) => {
                let record = DepthRecord::of_overlap(*depth, surfaces);
                match record.outcome {
                    Ending::Overlapping => record.with_solid_depth(&pair.depth()?).into(),
                    _ => record.into(),
                }
            }
            Self::Within { answer, .. } => DistanceRecord::of_solids_within(answer, pair)?.into(),
        })
    }
}

impl Record {
    /// Returns the outcome of the query.
    pub const fn outcome(&self) -> Ending {
        match self {
            Self::Cast(of) => of.outcome,
            Self::Clearance(of) => of.outcome,
            Self::SolidClearance(of) => of.outcome,
            Self::Distance(of) => of.outcome,
            Self::Depth(of) => of.outcome,
            Self::Motion(of) => of.outcome,
            Self::Error(of) => of.outcome,
        }
    }

    /// Returns the contact of convex bodies along a direction, and `None` for other queries.
    pub const fn contact(&self) -> Option<&ContactRecord> {
        match self {
            Self::Cast(CastRecord { contact, .. })
            | Self::Clearance(ClearanceRecord { contact, .. }) => Some(contact),
            _ => None,
        }
    }

    /// Returns the names of all fields of records, each once.
    pub fn fields() -> Vec<&'static str> {
        let mut names = [
            CastRecord::fields(),
            ClearanceRecord::fields(),
            SolidClearanceRecord::fields(),
            DistanceRecord::fields(),
            DepthRecord::fields(),
            MotionRecord::fields(),
        ]
        .concat();
        names.sort_unstable();
        names.dedup();
        names
    }

    /// Removes the fields that are not requested. Fields that every record has stay: `outcome`, and `looks` of motions.
    pub fn keep_fields(&mut self, requested: &Fields) {
        match self {
            Self::Cast(of) => of.keep_fields(requested),
            Self::Clearance(of) => of.keep_fields(requested),
            Self::SolidClearance(of) => of.keep_fields(requested),
            Self::Distance(of) => of.keep_fields(requested),
            Self::Depth(of) => of.keep_fields(requested),
            Self::Motion(of) => of.keep_fields(requested),
            Self::Error(of) => of.keep_fields(requested),
        }
    }

    /// Returns the record with a direction. Records of queries without a direction are returned unchanged.
    #[must_use]
    pub fn with_direction(mut self, along: [f64; 3]) -> Self {
        match &mut self {
            Self::Cast(CastRecord { direction, .. })
            | Self::Clearance(ClearanceRecord { direction, .. })
            | Self::SolidClearance(SolidClearanceRecord { direction, .. })
            | Self::Error(ErrorRecord { direction, .. }) => *direction = Some(along),
            Self::Distance(_) | Self::Depth(_) | Self::Motion(_) => {}
        }
        self
    }
}

macro_rules! records {
    ($($case:ident($record:ident)),*) => {$(
        impl From<$record> for Record {
            fn from(record: $record) -> Self {
                Self::$case(record)
            }
        }
    )*};
}
records!(
    Cast(CastRecord),
    Clearance(ClearanceRecord),
    SolidClearance(SolidClearanceRecord),
    Distance(DistanceRecord),
    Depth(DepthRecord),
    Motion(MotionRecord),
    Error(ErrorRecord)
);

impl FeatureRecord {
    /// Converts a feature of a body.
    pub fn from_feature<B: Body>(feature: Feature, body: &B) -> Self {
        Self { kind: feature.kind(), vertices: feature.vertices(body) }
    }
}

/// Returns which of two solids are open, at least in part. A rounded surface is not, because it has a thickness.
fn open_bodies(moving: &Solid, fixed: &Solid) -> Vec<&'static str> {
    let sides = [("moving", moving), ("fixed", fixed)].into_iter();
    sides
        .filter(|(_, body)| !body.is_closed() && body.radius() == 0.0)
        .map(|(name, _)| name)
        .collect()
}

/// Returns the coordinates with -0 replaced by 0.
fn without_negative_zeros(v: DVec3) -> [f64; 3] {
    v.to_array().map(|c| c + 0.0)
}

/// Returns the minimum gap, or `None` if it is 0.
fn positive_gap(gap: f64) -> Option<f64> {
    (gap > 0.0).then_some(gap)
}
