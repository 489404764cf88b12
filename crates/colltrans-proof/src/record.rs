//! Answers as the command line, batches, Python and the page write them: one flat object of JSON,
//! described by `docs/answers.schema.json`.
//!
//! A record, one struct for each question, holds what people and programs want of an answer: numbers with their proven
//! bounds, points and normals in the world, features by the numbers of the input. What checks a proof is not in it: for
//! that there are the answers themselves, which the feature `serde` writes whole, and `ProofFile`.

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
use colltrans_kernel::written::named;
use colltrans_solid::SolidPair;
use colltrans_solid::body::Solid;
use colltrans_solid::pair::OverlapDepth;

pub use cast::{CastRecord, ClearanceRecord, ContactRecord, SolidClearanceRecord};
pub use free::{BlockedByRecord, FreeRecord, FreeRegionRecord};
pub use motion::{MotionRecord, TimeRecord};
pub use path::PathRecord;
pub use placed::{DepthRecord, DistanceRecord};
pub use scene::{NearestRecord, SceneClearanceRecord, SceneWithinRecord};
pub use ways::{LegRecord, WaysRecord};

/// Defines a record. Its fields are those of the JSON, in this order; values that are absent ([`Field::is_absent`]) are
/// left out. The last field, after `..`, is a record whose own fields follow.
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
        }
    };
}
use record;

/// A value of a field that may be absent.
trait Field {
    /// Checks whether the field is left out.
    fn is_absent(&self) -> bool {
        false
    }
}

impl<T> Field for Option<T> {
    fn is_absent(&self) -> bool {
        self.is_none()
    }
}

impl<T> Field for Vec<T> {
    fn is_absent(&self) -> bool {
        self.is_empty()
    }
}

impl<K, V> Field for BTreeMap<K, V> {
    fn is_absent(&self) -> bool {
        self.is_empty()
    }
}

macro_rules! always_there {
    ($($type:ty),*) => { $(impl Field for $type {})* };
}
always_there!(Ending, ObstacleId, f64, u32, usize, &str);

/// The answer of any question about two bodies: a line of a batch.
///
/// Fields that do not apply are left out, numbers that are infinite are `null`. Translations, the `distance` of a
/// clearance and their bounds are in multiples of the direction, other lengths in the unit of the bodies.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Record {
    /// Where convex bodies meet along a direction.
    Cast(CastRecord),
    /// How far a convex body can move.
    Clearance(ClearanceRecord),
    /// How far a solid can move.
    SolidClearance(SolidClearanceRecord),
    /// How far bodies are apart, or whether they are closer than a length.
    Distance(DistanceRecord),
    /// How deep bodies overlap.
    Depth(DepthRecord),
    /// When bodies that turn first meet, or how far they can go.
    Motion(MotionRecord),
    /// No answer.
    Error(ErrorRecord),
}

record! {
    /// A query that has no answer.
    #[non_exhaustive]
    pub struct ErrorRecord {
        /// `error`.
        pub outcome: Ending,
        /// Of one query among several directions: the direction as it was read.
        pub direction: Option<[f64; 3]>,
    }
}

record! {
    /// Depths to which the surfaces of meshes that are convex only to within the tolerance lie below their hulls, which
    /// stand for these meshes in the answer.
    #[derive(Copy)]
    pub struct Dents {
        /// Depth of the moving body's dent, a length; `None` where the precision of its file explains it.
        pub moving: Option<f64>,
        /// Depth of the fixed body's dent, a length; `None` where the precision of its file explains it.
        pub fixed: Option<f64>,
    }
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

record! {
    /// Two solids that overlap where they are, or two pieces of them by their names.
    pub struct StartOverlapRecord {
        /// The name of the moving piece.
        pub moving: Option<String>,
        /// The name of the fixed piece.
        pub fixed: Option<String>,
        /// The least tolerance with which they would not overlap, if there is one.
        pub least_tolerance: Option<f64>,
    }
}

impl StartOverlapRecord {
    /// Returns the overlap of two bodies as a list, without names.
    fn parted_by(least_tolerance: Option<f64>) -> Vec<Self> {
        vec![Self { least_tolerance, ..Self::default() }]
    }
}

record! {
    /// One of many bodies, and how far it is.
    pub struct NearbyRecord {
        /// Its number.
        pub obstacle: ObstacleId,
        /// Its name.
        pub fixed: Option<String>,
        /// A length that the distance is not below, where it was looked for.
        pub lower: Option<f64>,
        /// One that it is not above.
        pub upper: f64,
        /// Points of the moving and of this body that are so far apart, in the world, rounded.
        pub points: Option<[[f64; 3]; 2]>,
        /// Depth of this body's dent, a length, where its mesh is convex only to within the tolerance.
        pub dent: Option<f64>,
    }
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
            Self::Contact(range) => CastRecord::of_range(range, cast).into(),
            Self::Clearance(clearance) => ClearanceRecord::of(clearance, cast).into(),
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
            Self::Distance(distance) => DistanceRecord::of(distance, pair).into(),
            Self::Depth(depth) => DepthRecord::of(depth).into(),
            Self::OverlapDepth(depth) => DepthRecord::of_overlap(*depth, Vec::new()).into(),
            Self::Within { answer, steps } => {
                DistanceRecord::of_within(answer, *steps, pair).into()
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
        let surfaces = open_ones(pair.moving(), pair.fixed());
        Ok(match self {
            Self::Distance(distance) => DistanceRecord::of_solids(distance, pair).into(),
            Self::Depth(depth) => DepthRecord { surfaces, ..DepthRecord::of(depth) }.into(),
            Self::OverlapDepth(depth) => DepthRecord::of_overlap(*depth, surfaces).into(),
            Self::Within { answer, .. } => DistanceRecord::of_solids_within(answer, pair)?.into(),
        })
    }
}

impl Record {
    /// Returns how the query ended.
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

    /// Returns the contact of convex bodies along a direction; `None` for other questions.
    pub const fn contact(&self) -> Option<&ContactRecord> {
        match self {
            Self::Cast(CastRecord { contact, .. })
            | Self::Clearance(ClearanceRecord { contact, .. }) => Some(contact),
            _ => None,
        }
    }

    /// Adds the direction, one among several; questions without a direction stay as they are.
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
    /// A feature of a body.
    pub fn of<B: Body>(feature: Feature, body: &B) -> Self {
        Self { kind: feature.kind(), vertices: feature.vertices(body) }
    }
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

/// Returns the gap that is kept, if there is one.
fn kept(gap: f64) -> Option<f64> {
    (gap > 0.0).then_some(gap)
}
