//! Columns of bulk answers: their names, and the conversion of an answer to a row.
//!
//! The classes of answers in Python list the columns of each question (`colltrans.columns`, ...).

use colltrans::record::{
    Ending, FeatureRecord, FeaturesRecord, MotionRecord, Record, StartOverlapRecord,
};
use colltrans::{
    Cast, Clearance, Contact, ContactRange, Features, FreeReason, InputVertex, Outcome,
    OverlapAhead,
};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::arrays::coordinates;
use crate::repeats::RowAnswerer;

/// The values of an answer; NaN for a missing number.
#[derive(Clone, Copy)]
pub(crate) struct Row {
    /// An index into the outcomes of the question.
    pub(crate) outcome: u8,
    pub(crate) numbers: [f64; NUMBERS.len()],
    pub(crate) vectors: [[f64; 3]; VECTORS.len()],
    /// The features of both bodies, if the features are requested.
    pub(crate) features: [Corners; 2],
}

/// The first vertices of a feature, as numbers of the input: one for a vertex, two for an edge, three for a
/// face; -1 for the remaining entries.
pub(crate) type Corners = [i64; 3];
pub(crate) const NO_CORNERS: Corners = [-1; 3];
/// The names of the columns of features.
pub(crate) const FEATURES: [&str; 2] = ["moving_feature", "fixed_feature"];

/// Declares columns: a constant with the index of each one in a row, and a list of all names in this order.
macro_rules! columns {
    ($(#[$documentation:meta])* $names:ident, $places:ident: $($place:ident = $name:literal,)*) => {
        $(#[$documentation])*
        pub(crate) const $names: [&str; [$($name),*].len()] = [$($name),*];
        #[allow(clippy::upper_case_acronyms, non_camel_case_types, reason = "they count places")]
        enum $places { $($place),* }
        $(pub(crate) const $place: usize = $places::$place as usize;)*
    };
}

columns! {
    /// The names of [`Row::numbers`].
    NUMBERS, Numbers:
    DISTANCE = "distance",
    TRANSLATION = "translation",
    EXIT = "exit",
    BACK = "back",
    ON = "on",
    LOWER = "translation_lower",
    UPPER = "translation_upper",
    ROUNDING = "rounding",
    MARGIN = "margin",
    EXIT_LOWER = "exit_lower",
    EXIT_UPPER = "exit_upper",
    OVERLAP = "overlap",
    AT_LEAST = "lower",
    AT_MOST = "upper",
    LEAST_TOLERANCE = "least_tolerance",
    ROW = "row",
    SHARE = "share",
    FIRST = "first",
    SECOND = "second",
}

columns! {
    /// The names of [`Row::vectors`].
    VECTORS, Vectors:
    NORMAL = "normal",
    POINT = "point",
    ON_MOVING = "on_moving",
    ON_FIXED = "on_fixed",
    DIRECTION = "direction",
}

/// The question that is answered for every row.
#[derive(Clone, Copy)]
pub(crate) enum Question {
    Contact,
    Range,
    Clearance,
    Distance,
    Depth,
    Within,
    Motion,
    MotionClearance,
}

impl Question {
    pub(crate) fn from_name(name: &str) -> PyResult<Self> {
        match name {
            "contact" => Ok(Self::Contact),
            "range" => Ok(Self::Range),
            "clearance" => Ok(Self::Clearance),
            "distance" => Ok(Self::Distance),
            "depth" => Ok(Self::Depth),
            "within" => Ok(Self::Within),
            "motion" => Ok(Self::Motion),
            "motion_clearance" => Ok(Self::MotionClearance),
            _ => Err(PyValueError::new_err(format!("no question {name:?}"))),
        }
    }

    /// Returns the names of the outcomes, in the order of their numbers. The last one is *error*.
    pub(crate) fn outcomes(self) -> &'static [&'static str] {
        match self {
            Self::Contact | Self::Range => &["contact", "grazing", "separated", "error"],
            Self::Clearance => {
                &["blocked", "slides", "behind", "separated", "overlapping", "error"]
            }
            Self::Distance => &["apart", "meeting", "error"],
            Self::Depth => &["overlapping", "touching", "apart", "error"],
            Self::Within => &["closer", "farther", "undecided", "error"],
            Self::Motion => &["contact", "grazing", "free", "overlapping", "undecided", "error"],
            Self::MotionClearance => &["blocked", "free", "overlapping", "error"],
        }
    }

    /// Answers a question that has a direction, and adds the features in contact if `featured` is set.
    pub(crate) fn ask<'a>(
        self,
        cast: &Cast<'a>,
        by: &RowAnswerer<'_, '_, 'a>,
        featured: bool,
    ) -> Result<Row, colltrans::QueryError> {
        let of = |outcome: u8, first: &Contact| Row::from_contact(outcome, first, cast, featured);
        Ok(match self {
            Self::Contact => match by.first_contact(cast)? {
                Outcome::Contact(contact) => of(0, &contact),
                Outcome::Grazing(grazing) => {
                    of(1, &grazing.contact).with_number(OVERLAP, grazing.overlap)
                }
                Outcome::Separated(separated) => Row::from_separation(2, &separated),
            },
            Self::Range => match by.contact_range(cast)? {
                ContactRange::Contact { first, last } => of(0, &first).with_exit(&last),
                ContactRange::Grazing { first, last } => of(1, &first.contact)
                    .with_exit(&last.contact)
                    .with_number(OVERLAP, first.overlap),
                ContactRange::Separated(separated) => Row::from_separation(2, &separated),
            },
            // The other questions have no direction and do not reach this function.
            _ => Row::from_clearance(&by.clearance(cast)?, cast, featured),
        })
    }
}

impl Row {
    pub(crate) const NONE: Self = Self {
        outcome: 0,
        numbers: [f64::NAN; NUMBERS.len()],
        vectors: [[f64::NAN; 3]; VECTORS.len()],
        features: [NO_CORNERS; 2],
    };

    pub(crate) fn with_number(mut self, which: usize, number: f64) -> Self {
        self.numbers[which] = number;
        self
    }

    pub(crate) fn with_vector(mut self, which: usize, vector: [f64; 3]) -> Self {
        self.vectors[which] = vector;
        self
    }

    /// Converts the record of a question about two bodies at fixed poses.
    pub(crate) fn from_record(question: Question, record: &Record) -> Self {
        let row = Self::from_ending(question, record.outcome());
        match record {
            Record::Distance(of) => row
                .with_bounds(of.lower, of.upper)
                .with_optional_vector(NORMAL, of.normal)
                .with_optional_vector(ON_MOVING, of.points.map(|points| points[0]))
                .with_optional_vector(ON_FIXED, of.points.map(|points| points[1]))
                .with_features(of.features.as_ref()),
            Record::Depth(of) => row
                .with_bounds(of.lower, of.upper)
                .with_overlaps(&of.start_overlaps)
                .with_optional_vector(DIRECTION, of.direction),
            // Records of other questions have no columns here.
            _ => row,
        }
    }

    /// Converts the record of a motion.
    pub(crate) fn from_motion(question: Question, of: &MotionRecord) -> Self {
        Self::from_ending(question, of.outcome)
            .with_bounds(of.time.map(|time| time.lower), of.time.and_then(|time| time.upper))
            .with_overlaps(&of.start_overlaps)
            .with_optional_vector(NORMAL, of.normal)
            .with_optional_vector(POINT, of.point)
            .with_features(of.features.as_ref())
    }

    fn from_ending(question: Question, outcome: Ending) -> Self {
        let found = question.outcomes().iter().position(|known| *known == outcome.name());
        Self { outcome: found.unwrap_or_default() as u8, ..Self::NONE }
    }

    fn with_bounds(self, lower: Option<f64>, upper: Option<f64>) -> Self {
        self.with_number(AT_LEAST, lower.unwrap_or(f64::NAN))
            .with_number(AT_MOST, upper.unwrap_or(f64::NAN))
    }

    fn with_overlaps(self, overlaps: &[StartOverlapRecord]) -> Self {
        let least = overlaps.first().and_then(|overlap| overlap.least_tolerance);
        self.with_number(LEAST_TOLERANCE, least.unwrap_or(f64::NAN))
    }

    fn with_optional_vector(self, which: usize, vector: Option<[f64; 3]>) -> Self {
        vector.map_or(self, |vector| self.with_vector(which, vector))
    }

    fn with_features(mut self, features: Option<&FeaturesRecord>) -> Self {
        if let Some(FeaturesRecord { moving, fixed }) = features {
            let of = |feature: &FeatureRecord| corners(feature.vertices.iter().copied());
            self.features = [of(moving), of(fixed)];
        }
        self
    }

    fn with_exit(self, last: &Contact) -> Self {
        let exit = last.exit();
        self.with_number(EXIT, exit.value)
            .with_number(EXIT_LOWER, exit.lower)
            .with_number(EXIT_UPPER, exit.upper)
    }

    fn from_contact(outcome: u8, first: &Contact, cast: &Cast<'_>, featured: bool) -> Self {
        let mut row = Self { outcome, ..Self::NONE }
            .with_vector(NORMAL, coordinates(first.normal))
            .with_vector(POINT, coordinates(first.witness_points(cast).on_fixed));
        if featured {
            let Features { moving, fixed } = first.features(cast);
            row.features =
                [corners(moving.vertices(cast.moving())), corners(fixed.vertices(cast.fixed()))];
        }
        let proof = &first.certificate;
        row.with_number(TRANSLATION, first.translation)
            .with_number(LOWER, proof.lower)
            .with_number(UPPER, proof.upper)
            .with_number(ROUNDING, proof.rounding)
    }

    fn from_separation(outcome: u8, separated: &colltrans::Separated) -> Self {
        let normal = coordinates(separated.certificate.normal);
        let row = Self { outcome, ..Self::NONE }.with_vector(NORMAL, normal);
        row.with_number(MARGIN, separated.certificate.margin)
    }

    fn from_clearance(answer: &Clearance, cast: &Cast<'_>, featured: bool) -> Self {
        let of = |outcome: u8, first: &Contact| Self::from_contact(outcome, first, cast, featured);
        let row = match answer {
            Clearance::Blocked { contact, .. } => of(0, contact),
            Clearance::Free(FreeReason::Slides(grazing)) => {
                of(1, &grazing.contact).with_number(OVERLAP, grazing.overlap)
            }
            // The last contact is the first one of the reversed cast, so its bounds do not apply to this
            // direction.
            Clearance::Free(FreeReason::Behind(last)) => Self {
                numbers: Self::NONE.with_number(ROUNDING, last.certificate.rounding).numbers,
                ..Self::from_contact(2, last, &cast.reversed(), featured)
            }
            .with_exit(last),
            Clearance::Free(FreeReason::Separated(separated)) => {
                Self::from_separation(3, separated)
            }
            Clearance::Overlapping(OverlapAhead { first, last }) => of(4, first)
                .with_exit(last)
                .with_number(BACK, -first.certificate.lower)
                .with_number(ON, -last.certificate.lower),
        };
        row.with_number(DISTANCE, answer.distance().unwrap_or(f64::NAN))
    }
}

/// Returns the first three vertices of a feature.
fn corners(vertices: impl IntoIterator<Item = InputVertex>) -> Corners {
    let mut corners = NO_CORNERS;
    for (corner, vertex) in corners.iter_mut().zip(vertices) {
        *corner = u32::from(vertex).into();
    }
    corners
}
