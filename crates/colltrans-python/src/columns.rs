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

/// The entries of a row in the columns of a chunk of rows. Answers are written where they stay.
pub(crate) struct Row<'a> {
    /// Position of the row in the chunk.
    pub(crate) at: usize,
    pub(crate) places: &'a Places,
    /// Indices into the outcomes of the question.
    pub(crate) outcomes: &'a mut [u8],
    pub(crate) numbers: Vec<&'a mut [f64]>,
    pub(crate) vectors: Vec<&'a mut [[f64; 3]]>,
    /// Empty, or one column for each of the two bodies.
    pub(crate) features: Vec<&'a mut [Corners]>,
}

/// The position of each of [`NUMBERS`] and [`VECTORS`] among the requested columns; `None` if it is not requested.
pub(crate) struct Places {
    numbers: [Option<u8>; NUMBERS.len()],
    vectors: [Option<u8>; VECTORS.len()],
}

impl Places {
    /// Returns the positions for columns in the order of [`NUMBERS`] and [`VECTORS`].
    pub(crate) fn new(names: &[String]) -> Self {
        Self { numbers: positions(NUMBERS, names), vectors: positions(VECTORS, names) }
    }

    /// Returns the names of the requested columns of numbers, and of those of vectors.
    pub(crate) fn names(&self) -> [Vec<&'static str>; 2] {
        let of = |names: &[&'static str], places: &[Option<u8>]| {
            let known = names.iter().zip(places);
            known.filter(|(_, place)| place.is_some()).map(|(name, _)| *name).collect()
        };
        [of(&NUMBERS, &self.numbers), of(&VECTORS, &self.vectors)]
    }
}

/// Returns the positions of the requested names among all requested ones, in the order of `known`.
fn positions<const N: usize>(known: [&str; N], requested: &[String]) -> [Option<u8>; N] {
    let mut count = 0;
    known.map(|known| {
        let is_requested = requested.iter().any(|name| name == known);
        count += u8::from(is_requested);
        is_requested.then(|| count - 1)
    })
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
    /// The names of columns of numbers.
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
    /// The names of columns of vectors.
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
    Intersects,
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
            "intersects" => Ok(Self::Intersects),
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
            Self::Intersects => &["meeting", "apart", "error"],
            Self::Within => &["closer", "farther", "undecided", "error"],
            Self::Motion => &["contact", "grazing", "free", "overlapping", "undecided", "error"],
            Self::MotionClearance => &["blocked", "free", "overlapping", "error"],
        }
    }

    /// Answers a question that has a direction.
    pub(crate) fn answer_row<'a>(
        self,
        cast: &Cast<'a>,
        by: &RowAnswerer<'_, '_, 'a>,
        row: &mut Row<'_>,
    ) -> Result<(), colltrans::QueryError> {
        match self {
            Self::Contact => match by.first_contact(cast)? {
                Outcome::Contact(contact) => row.set_contact(0, &contact, cast),
                Outcome::Grazing(grazing) => {
                    row.set_contact(1, &grazing.contact, cast).set_number(OVERLAP, grazing.overlap)
                }
                Outcome::Separated(separated) => row.set_separation(2, &separated),
            },
            Self::Range => match by.contact_range(cast)? {
                ContactRange::Contact { first, last } => {
                    row.set_contact(0, &first, cast).set_exit(&last)
                }
                ContactRange::Grazing { first, last } => row
                    .set_contact(1, &first.contact, cast)
                    .set_exit(&last.contact)
                    .set_number(OVERLAP, first.overlap),
                ContactRange::Separated(separated) => row.set_separation(2, &separated),
            },
            // The other questions have no direction and do not reach this function.
            _ => row.set_clearance(&by.clearance(cast)?, cast),
        };
        Ok(())
    }
}

impl Row<'_> {
    /// Removes the answers of all rows of the chunk.
    pub(crate) fn clear_all(&mut self) {
        self.outcomes.fill(0);
        self.numbers.iter_mut().for_each(|column| column.fill(f64::NAN));
        self.vectors.iter_mut().for_each(|column| column.fill([f64::NAN; 3]));
        self.features.iter_mut().for_each(|column| column.fill(NO_CORNERS));
    }

    /// Removes the answer.
    pub(crate) fn clear(&mut self) {
        let at = self.at;
        self.outcomes[at] = 0;
        self.numbers.iter_mut().for_each(|column| column[at] = f64::NAN);
        self.vectors.iter_mut().for_each(|column| column[at] = [f64::NAN; 3]);
        self.features.iter_mut().for_each(|column| column[at] = NO_CORNERS);
    }

    /// Sets the index of the outcome.
    pub(crate) fn set_outcome(&mut self, outcome: u8) -> &mut Self {
        self.outcomes[self.at] = outcome;
        self
    }

    pub(crate) fn set_number(&mut self, which: usize, number: f64) -> &mut Self {
        if let Some(place) = self.places.numbers[which] {
            self.numbers[usize::from(place)][self.at] = number;
        }
        self
    }

    pub(crate) fn set_vector(&mut self, which: usize, vector: [f64; 3]) -> &mut Self {
        if let Some(place) = self.places.vectors[which] {
            self.vectors[usize::from(place)][self.at] = vector;
        }
        self
    }

    /// Writes the record of a question about two bodies at fixed poses.
    pub(crate) fn set_record(&mut self, question: Question, record: &Record) {
        self.set_ending(question, record.outcome());
        match record {
            Record::Distance(of) => self
                .set_bounds(of.lower, of.upper)
                .set_optional_vector(NORMAL, of.normal)
                .set_optional_vector(ON_MOVING, of.points.map(|points| points[0]))
                .set_optional_vector(ON_FIXED, of.points.map(|points| points[1]))
                .set_features(of.features.as_ref()),
            Record::Depth(of) => self
                .set_bounds(of.lower, of.upper)
                .set_overlaps(&of.start_overlaps)
                .set_optional_vector(DIRECTION, of.direction),
            // Records of other questions have no columns here.
            _ => self,
        };
    }

    /// Writes the record of a motion.
    pub(crate) fn set_motion(&mut self, question: Question, of: &MotionRecord) {
        // The bounds are those of single answers.
        let [lower, upper] = match (of.time, of.outcome, question) {
            (Some(time), ..) => [time.lower, time.upper.unwrap_or(f64::INFINITY)],
            (None, Ending::Free, Question::MotionClearance) => [1.0; 2],
            (None, Ending::Free, _) => [1.0, f64::INFINITY],
            (None, Ending::Overlapping, Question::Motion) => [0.0; 2],
            (None, ..) => [f64::NAN; 2],
        };
        self.set_ending(question, of.outcome)
            .set_bounds(Some(lower), Some(upper))
            .set_overlaps(&of.start_overlaps)
            .set_optional_vector(NORMAL, of.normal)
            .set_optional_vector(POINT, of.point)
            .set_features(of.features.as_ref());
    }

    fn set_ending(&mut self, question: Question, outcome: Ending) -> &mut Self {
        let found = question.outcomes().iter().position(|known| *known == outcome.name());
        self.set_outcome(found.unwrap_or_default() as u8)
    }

    fn set_bounds(&mut self, lower: Option<f64>, upper: Option<f64>) -> &mut Self {
        self.set_number(AT_LEAST, lower.unwrap_or(f64::NAN))
            .set_number(AT_MOST, upper.unwrap_or(f64::NAN))
    }

    fn set_overlaps(&mut self, overlaps: &[StartOverlapRecord]) -> &mut Self {
        let least = overlaps.first().and_then(|overlap| overlap.least_tolerance);
        self.set_number(LEAST_TOLERANCE, least.unwrap_or(f64::NAN))
    }

    pub(crate) fn set_optional_vector(
        &mut self,
        which: usize,
        vector: Option<[f64; 3]>,
    ) -> &mut Self {
        match vector {
            Some(vector) => self.set_vector(which, vector),
            None => self,
        }
    }

    fn set_features(&mut self, features: Option<&FeaturesRecord>) -> &mut Self {
        if let Some(FeaturesRecord { moving, fixed }) = features {
            for (column, feature) in self.features.iter_mut().zip([moving, fixed]) {
                let FeatureRecord { vertices, .. } = feature;
                column[self.at] = corners(vertices.iter().copied());
            }
        }
        self
    }

    fn set_exit(&mut self, last: &Contact) -> &mut Self {
        let exit = last.exit();
        self.set_number(EXIT, exit.value)
            .set_number(EXIT_LOWER, exit.lower)
            .set_number(EXIT_UPPER, exit.upper)
    }

    fn set_contact(&mut self, outcome: u8, first: &Contact, cast: &Cast<'_>) -> &mut Self {
        let proof = &first.certificate;
        self.set_place(outcome, first, cast)
            .set_number(TRANSLATION, first.translation)
            .set_number(LOWER, proof.lower)
            .set_number(UPPER, proof.upper)
    }

    /// Writes where the bodies are in contact: all but the translation and its bounds.
    fn set_place(&mut self, outcome: u8, contact: &Contact, cast: &Cast<'_>) -> &mut Self {
        if let [of_moving, of_fixed] = &mut self.features[..] {
            let Features { moving, fixed } = contact.features(cast);
            of_moving[self.at] = corners(moving.vertices(cast.moving()));
            of_fixed[self.at] = corners(fixed.vertices(cast.fixed()));
        }
        self.set_outcome(outcome)
            .set_vector(NORMAL, coordinates(contact.normal))
            .set_vector(POINT, coordinates(contact.witness_points(cast).on_fixed))
            .set_number(ROUNDING, contact.certificate.rounding)
    }

    fn set_separation(&mut self, outcome: u8, separated: &colltrans::Separated) -> &mut Self {
        self.set_outcome(outcome)
            .set_vector(NORMAL, coordinates(separated.certificate.normal))
            .set_number(MARGIN, separated.certificate.margin)
    }

    fn set_clearance(&mut self, answer: &Clearance, cast: &Cast<'_>) -> &mut Self {
        match answer {
            Clearance::Blocked { contact, .. } => self.set_contact(0, contact, cast),
            Clearance::Free(FreeReason::Slides(grazing)) => {
                self.set_contact(1, &grazing.contact, cast).set_number(OVERLAP, grazing.overlap)
            }
            // The last contact is the first one of the reversed cast, so its bounds do not apply to this
            // direction.
            Clearance::Free(FreeReason::Behind(last)) => {
                self.set_place(2, last, &cast.reversed()).set_exit(last)
            }
            Clearance::Free(FreeReason::Separated(separated)) => self.set_separation(3, separated),
            Clearance::Overlapping(OverlapAhead { first, last }) => self
                .set_contact(4, first, cast)
                .set_exit(last)
                .set_number(BACK, -first.certificate.lower)
                .set_number(ON, -last.certificate.lower),
        }
        .set_number(DISTANCE, answer.distance().unwrap_or(f64::NAN))
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
