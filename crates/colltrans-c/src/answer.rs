//! Answers as plain structs: numbers with their proven bounds, points and normals in the world frame, features by the
//! indices of the input. Numbers that do not apply are NaN. `-0` is written as 0 in vectors.

use colltrans::glam::DVec3;
use colltrans::record::{
    DepthRecord, DistanceRecord, Ending, FeatureRecord, FeaturesRecord, MotionRecord, TimeRecord,
};
use colltrans::solid::{SolidCast, SolidContact};
use colltrans::{
    AnyDistance, Bounded, Cast, Clearance, Contact, ContactRange, ConvexPolyhedron, FreeReason,
    Grazing, InputVertex, Outcome as CastOutcome, OverlapAhead, Separated, Solid,
};

use crate::COLLTRANS_NO_VERTEX;

/// Outcome of a query.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outcome {
    /// The query has no answer.
    Error = 0,
    /// The bodies meet along the direction or the motion.
    Contact = 1,
    /// Convex bodies slide along each other, to within the graze tolerance; rotating bodies come nearer than rounding
    /// errors can decide.
    Grazing = 2,
    /// The bodies never meet along the direction.
    Separated = 3,
    /// Nothing blocks a solid, a body in a scene, or a motion; with the option `before`, not before this translation.
    Free = 4,
    /// The body is blocked after a finite distance.
    Blocked = 5,
    /// Nothing blocks a convex body, because it slides along the other one.
    Slides = 6,
    /// Nothing blocks a convex body, because the only contacts are behind it.
    Behind = 7,
    /// The bodies overlap at the start.
    Overlapping = 8,
    /// The bodies have no common point.
    Apart = 9,
    /// The bodies touch, or overlap by less than the rounding error.
    Touching = 10,
    /// The bodies touch or overlap, or are so near that rounding cannot decide.
    Meeting = 11,
    /// The distance is at most the length.
    Closer = 12,
    /// The distance is larger than the length.
    Farther = 13,
    /// The length lies between the bounds of the distance, or the search along a motion took its maximum of steps.
    Undecided = 14,
}

/// Kind of a feature.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FeatureKind {
    /// The feature is unknown, or was not requested.
    UnknownFeature = 0,
    /// A vertex.
    Vertex = 1,
    /// An edge.
    Edge = 2,
    /// A face.
    Face = 3,
}

/// Vertex, edge or face of a body, by the indices of its points or of the vertices of its mesh. The vertices of the
/// pieces of a union are numbered consecutively, those that no face uses too. Corner `k` of a cuboid has the high
/// coordinate of axis `j` if bit `j` of `k` is 1.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Feature {
    /// Kind of the feature.
    pub kind: FeatureKind,
    /// The vertex, the two ends, or the first three corners; the rest is `COLLTRANS_NO_VERTEX`.
    pub vertices: [u32; 3],
}

/// Answer of a cast. Translations, bounds, `distance`, `exit`, `back`, `on` and `rounding` are multiples of the
/// direction: they are lengths if it is a unit vector. Numbers that do not apply are NaN.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct CastAnswer {
    /// Outcome of the query.
    pub outcome: Outcome,
    /// Safe travel of a clearance, a multiple of the direction: proven, infinite for a free body, at most the option
    /// `before`.
    pub distance: f64,
    /// First contact.
    pub translation: f64,
    /// Proven lower bound of the first contact.
    pub translation_lower: f64,
    /// Proven upper bound of the first contact.
    pub translation_upper: f64,
    /// Last contact.
    pub exit: f64,
    /// Proven lower bound of the last contact.
    pub exit_lower: f64,
    /// Proven upper bound of the last contact. Beyond it the bodies never meet.
    pub exit_upper: f64,
    /// For convex bodies that overlap, travel backwards that certainly separates them.
    pub back: f64,
    /// For convex bodies that overlap, travel forwards that certainly separates them.
    pub on: f64,
    /// Overlap of the shadows of convex bodies that graze or slide, a length.
    pub overlap: f64,
    /// Gap between the shadows of separated convex bodies, a length.
    pub margin: f64,
    /// The part of the bounds' difference that rounding explains, for convex bodies.
    pub rounding: f64,
    /// Tolerance in use, a length, for solids.
    pub tolerance: f64,
    /// For solids that overlap, the smallest tolerance at which they do not, otherwise NaN.
    pub least_tolerance: f64,
    /// Unit normal of the contact plane or the separating plane, from the moving to the fixed body.
    pub normal: [f64; 3],
    /// Contact point on the moving body at its start pose.
    pub point_on_moving: [f64; 3],
    /// Contact point on the fixed body.
    pub point_on_fixed: [f64; 3],
    /// Feature of the moving body in contact, if features are requested.
    pub moving_feature: Feature,
    /// Feature of the fixed body in contact, if features are requested.
    pub fixed_feature: Feature,
}

/// Answer of a distance, or of its comparison with a length. Bounds that were not computed are 0 and infinity.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct DistanceAnswer {
    /// Outcome of the query.
    pub outcome: Outcome,
    /// Proven lower bound of the distance.
    pub lower: f64,
    /// Proven upper bound of the distance.
    pub upper: f64,
    /// Unit normal along the shortest connection, from the moving to the fixed body; NaN if the bodies meet.
    pub normal: [f64; 3],
    /// Point of the moving body at the distance `upper`, rounded; NaN if it was not computed.
    pub point_on_moving: [f64; 3],
    /// Point of the fixed body at the distance `upper`, rounded; NaN if it was not computed.
    pub point_on_fixed: [f64; 3],
    /// Feature of the moving body at its nearest point, unless the query is about a scene.
    pub moving_feature: Feature,
    /// Feature of the fixed body at its nearest point, unless the query is about a scene.
    pub fixed_feature: Feature,
}

/// Answer of a penetration depth.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct DepthAnswer {
    /// Outcome of the query.
    pub outcome: Outcome,
    /// Proven lower bound of the depth; NaN if it is unknown, as for open surfaces.
    pub lower: f64,
    /// Proven upper bound of the depth; NaN if it is unknown.
    pub upper: f64,
    /// For solids that overlap, the smallest tolerance at which they do not, otherwise NaN.
    pub least_tolerance: f64,
    /// Unit vector along which a translation of the moving body by `upper` separates the bodies.
    pub direction: [f64; 3],
}

/// Answer about bodies along their motions, from time 0 to time 1.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct MotionAnswer {
    /// Outcome of the query.
    pub outcome: Outcome,
    /// Proven lower bound of the time of contact: the bodies do not meet before. NaN without a contact.
    pub time_lower: f64,
    /// Proven upper bound of the time of contact; infinite if no contact is proven. NaN without a contact.
    pub time_upper: f64,
    /// Tolerance in use, a length; NaN without one.
    pub tolerance: f64,
    /// For solids that overlap at the start, the smallest tolerance at which they do not, otherwise NaN.
    pub least_tolerance: f64,
    /// Unit normal at the contact, from the moving to the fixed body.
    pub normal: [f64; 3],
    /// Contact point on the fixed body.
    pub point: [f64; 3],
    /// Feature of the moving body in contact.
    pub moving_feature: Feature,
    /// Feature of the fixed body in contact.
    pub fixed_feature: Feature,
}

/// Columns for the answers of many casts. Each pointer is null or has room for all rows; vectors have three numbers for
/// each row. The fields are those of `colltrans_cast_answer`.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct CastColumns {
    /// Status of each row.
    pub status: *mut crate::Status,
    /// Outcomes.
    pub outcome: *mut Outcome,
    /// Safe travels.
    pub distance: *mut f64,
    /// First contacts.
    pub translation: *mut f64,
    /// Lower bounds of the first contacts.
    pub translation_lower: *mut f64,
    /// Upper bounds of the first contacts.
    pub translation_upper: *mut f64,
    /// Last contacts.
    pub exit: *mut f64,
    /// Lower bounds of the last contacts.
    pub exit_lower: *mut f64,
    /// Upper bounds of the last contacts.
    pub exit_upper: *mut f64,
    /// Travels backwards.
    pub back: *mut f64,
    /// Travels forwards.
    pub on: *mut f64,
    /// Overlaps of shadows.
    pub overlap: *mut f64,
    /// Gaps between shadows.
    pub margin: *mut f64,
    /// Parts of the bounds' differences that rounding explains.
    pub rounding: *mut f64,
    /// Tolerances.
    pub tolerance: *mut f64,
    /// Least tolerances.
    pub least_tolerance: *mut f64,
    /// Normals.
    pub normal: *mut f64,
    /// Contact points on the moving body at its start pose.
    pub point_on_moving: *mut f64,
    /// Contact points on the fixed body.
    pub point_on_fixed: *mut f64,
    /// Features of the moving body.
    pub moving_feature: *mut Feature,
    /// Features of the fixed body.
    pub fixed_feature: *mut Feature,
}

/// Columns for many distances, as `colltrans_cast_columns`. The fields are those of `colltrans_distance_answer`.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct DistanceColumns {
    /// Status of each row.
    pub status: *mut crate::Status,
    /// Outcomes.
    pub outcome: *mut Outcome,
    /// Lower bounds.
    pub lower: *mut f64,
    /// Upper bounds.
    pub upper: *mut f64,
    /// Normals.
    pub normal: *mut f64,
    /// Points of the moving body.
    pub point_on_moving: *mut f64,
    /// Points of the fixed body.
    pub point_on_fixed: *mut f64,
    /// Features of the moving body.
    pub moving_feature: *mut Feature,
    /// Features of the fixed body.
    pub fixed_feature: *mut Feature,
}

const NO_VECTOR: [f64; 3] = [f64::NAN; 3];

impl From<Ending> for Outcome {
    fn from(ending: Ending) -> Self {
        match ending {
            Ending::Contact => Self::Contact,
            Ending::Grazing => Self::Grazing,
            Ending::Separated => Self::Separated,
            Ending::Free => Self::Free,
            Ending::Blocked => Self::Blocked,
            Ending::Slides => Self::Slides,
            Ending::Behind => Self::Behind,
            Ending::Overlapping => Self::Overlapping,
            Ending::Apart => Self::Apart,
            Ending::Touching => Self::Touching,
            Ending::Meeting => Self::Meeting,
            Ending::Closer => Self::Closer,
            Ending::Farther => Self::Farther,
            Ending::Undecided => Self::Undecided,
            Ending::Error => Self::Error,
        }
    }
}

impl Feature {
    const UNKNOWN: Self =
        Self { kind: FeatureKind::UnknownFeature, vertices: [COLLTRANS_NO_VERTEX; 3] };

    fn new(kind: FeatureKind, of: impl IntoIterator<Item = InputVertex>) -> Self {
        let mut vertices = [COLLTRANS_NO_VERTEX; 3];
        vertices.iter_mut().zip(of).for_each(|(to, vertex)| *to = vertex.into());
        Self { kind, vertices }
    }

    fn of_convex(feature: colltrans::Feature, body: &ConvexPolyhedron) -> Self {
        match feature {
            colltrans::Feature::Vertex(vertex) => Self::new(FeatureKind::Vertex, [vertex]),
            colltrans::Feature::Edge(ends) => Self::new(FeatureKind::Edge, ends),
            colltrans::Feature::Face(face) => {
                let input = |corner: u32| body.input_indices()[corner as usize];
                Self::new(FeatureKind::Face, body.face_vertices(face.0).map(input))
            }
        }
    }

    fn of_solid(feature: colltrans::Feature, body: &Solid) -> Self {
        let kind = match feature {
            colltrans::Feature::Vertex(_) => FeatureKind::Vertex,
            colltrans::Feature::Edge(_) => FeatureKind::Edge,
            colltrans::Feature::Face(_) => FeatureKind::Face,
        };
        Self::new(kind, feature.vertices(body))
    }

    fn of_record(record: &FeatureRecord) -> Self {
        let kind = match record.kind {
            "vertex" => FeatureKind::Vertex,
            "edge" => FeatureKind::Edge,
            _ => FeatureKind::Face,
        };
        Self::new(kind, record.vertices.iter().copied())
    }

    /// Returns the features of both bodies in a record.
    fn of_records(features: Option<&FeaturesRecord>) -> [Self; 2] {
        features.map_or([Self::UNKNOWN; 2], |FeaturesRecord { moving, fixed }| {
            [Self::of_record(moving), Self::of_record(fixed)]
        })
    }
}

/// Returns the coordinates with 0 for -0.
#[inline]
fn coordinates(v: DVec3) -> [f64; 3] {
    v.to_array().map(|c| c + 0.0)
}

impl CastAnswer {
    /// No answer: all numbers are NaN.
    pub(crate) const NONE: Self = Self {
        outcome: Outcome::Error,
        distance: f64::NAN,
        translation: f64::NAN,
        translation_lower: f64::NAN,
        translation_upper: f64::NAN,
        exit: f64::NAN,
        exit_lower: f64::NAN,
        exit_upper: f64::NAN,
        back: f64::NAN,
        on: f64::NAN,
        overlap: f64::NAN,
        margin: f64::NAN,
        rounding: f64::NAN,
        tolerance: f64::NAN,
        least_tolerance: f64::NAN,
        normal: NO_VECTOR,
        point_on_moving: NO_VECTOR,
        point_on_fixed: NO_VECTOR,
        moving_feature: Feature::UNKNOWN,
        fixed_feature: Feature::UNKNOWN,
    };

    /// Writes the first contact of convex bodies.
    #[inline]
    pub(crate) fn set_outcome(&mut self, outcome: &CastOutcome, cast: &Cast<'_>, featured: bool) {
        match outcome {
            CastOutcome::Contact(first) => {
                self.set_contact(Outcome::Contact, first, cast, featured);
            }
            CastOutcome::Grazing(first) => {
                self.set_grazing(Outcome::Grazing, first, cast, featured);
            }
            CastOutcome::Separated(of) => self.set_separated(of),
        }
    }

    /// Writes the first and the last contact of convex bodies.
    #[inline]
    pub(crate) fn set_range(&mut self, range: &ContactRange, cast: &Cast<'_>, featured: bool) {
        match range {
            ContactRange::Contact { first, last } => {
                self.set_contact(Outcome::Contact, first, cast, featured);
                self.set_exit(last.exit());
            }
            ContactRange::Grazing { first, last } => {
                self.set_grazing(Outcome::Grazing, first, cast, featured);
                self.set_exit(last.contact.exit());
            }
            ContactRange::Separated(of) => self.set_separated(of),
        }
    }

    /// Writes the clearance of convex bodies.
    #[inline]
    pub(crate) fn set_clearance(&mut self, clearance: &Clearance, cast: &Cast<'_>, featured: bool) {
        self.distance = clearance.distance().unwrap_or(f64::NAN);
        match clearance {
            Clearance::Blocked { contact, .. } => {
                self.set_contact(Outcome::Blocked, contact, cast, featured);
            }
            Clearance::Free(FreeReason::Slides(of)) => {
                self.set_grazing(Outcome::Slides, of, cast, featured);
            }
            // The last contact is the first one of the reversed cast, whose bounds do not apply to this direction.
            Clearance::Free(FreeReason::Behind(last)) => {
                self.set_place(Outcome::Behind, last, &cast.reversed(), featured);
                self.set_exit(last.exit());
            }
            Clearance::Free(FreeReason::Separated(of)) => self.set_separated(of),
            Clearance::Overlapping(OverlapAhead { first, last }) => {
                self.set_contact(Outcome::Overlapping, first, cast, featured);
                self.set_exit(last.exit());
                [self.back, self.on] = [first, last].map(|contact| -contact.certificate.lower);
            }
        }
    }

    /// Writes the first contact of solids.
    pub(crate) fn set_solid_outcome(
        &mut self,
        outcome: &CastOutcome<Solid>,
        cast: &Cast<'_, Solid>,
    ) {
        match outcome {
            CastOutcome::Contact(first) => self.set_solid_contact(Outcome::Contact, first, cast),
            CastOutcome::Grazing(none) => match *none {},
            CastOutcome::Separated(_) => self.outcome = Outcome::Separated,
        }
    }

    /// Writes the first and the last contact of solids.
    pub(crate) fn set_solid_range(&mut self, range: &ContactRange<Solid>, cast: &Cast<'_, Solid>) {
        match range {
            ContactRange::Contact { first, last } => {
                self.set_solid_contact(Outcome::Contact, first, cast);
                self.set_exit(last.exit());
            }
            ContactRange::Grazing { first, .. } => match *first {},
            ContactRange::Separated(_) => self.outcome = Outcome::Separated,
        }
    }

    /// Writes the clearance of solids.
    pub(crate) fn set_solid_clearance(
        &mut self,
        clearance: &Clearance<Solid>,
        cast: &Cast<'_, Solid>,
    ) {
        match clearance {
            Clearance::Blocked { contact, .. } => {
                self.set_solid_contact(Outcome::Blocked, contact, cast);
            }
            Clearance::Free(_) => self.outcome = Outcome::Free,
            Clearance::Overlapping(overlap) => {
                self.outcome = Outcome::Overlapping;
                self.least_tolerance = overlap.least_tolerance.unwrap_or(f64::NAN);
            }
        }
        // From the end of the query on, contacts were ignored.
        let end = cast.options().before.unwrap_or(f64::INFINITY);
        self.distance = clearance.distance().map_or(f64::NAN, |distance| distance.min(end));
        self.tolerance = cast.tolerance();
    }

    /// Returns the answer of a body that nothing stops in a scene.
    pub(crate) fn free(distance: f64) -> Self {
        Self { outcome: Outcome::Free, distance, ..Self::NONE }
    }

    #[inline]
    fn set_contact(&mut self, outcome: Outcome, first: &Contact, cast: &Cast<'_>, featured: bool) {
        self.set_translation(first.bounded());
        self.set_place(outcome, first, cast, featured);
    }

    #[inline]
    fn set_translation(&mut self, first: Bounded) {
        self.translation = first.value;
        [self.translation_lower, self.translation_upper] = first.bounds();
    }

    #[inline]
    fn set_exit(&mut self, exit: Bounded) {
        self.exit = exit.value;
        [self.exit_lower, self.exit_upper] = exit.bounds();
    }

    /// Writes where the bodies are in contact.
    #[inline]
    fn set_place(&mut self, outcome: Outcome, contact: &Contact, cast: &Cast<'_>, featured: bool) {
        let points = contact.witness_points(cast);
        self.outcome = outcome;
        self.normal = coordinates(contact.normal);
        self.point_on_moving = coordinates(points.on_moving);
        self.point_on_fixed = coordinates(points.on_fixed);
        self.rounding = contact.certificate.rounding;
        if featured {
            let features = contact.features(cast);
            self.moving_feature = Feature::of_convex(features.moving, cast.moving());
            self.fixed_feature = Feature::of_convex(features.fixed, cast.fixed());
        }
    }

    #[inline]
    fn set_grazing(&mut self, outcome: Outcome, of: &Grazing, cast: &Cast<'_>, featured: bool) {
        self.overlap = of.overlap;
        self.set_contact(outcome, &of.contact, cast, featured);
    }

    #[inline]
    fn set_separated(&mut self, separated: &Separated) {
        self.outcome = Outcome::Separated;
        self.normal = coordinates(separated.certificate.normal);
        self.margin = separated.certificate.margin;
    }

    fn set_solid_contact(
        &mut self,
        outcome: Outcome,
        contact: &SolidContact,
        cast: &Cast<'_, Solid>,
    ) {
        self.set_translation(contact.translation);
        self.outcome = outcome;
        self.normal = coordinates(contact.normal);
        self.point_on_moving = coordinates(contact.point_on_moving);
        self.point_on_fixed = coordinates(contact.point_on_fixed);
        self.moving_feature = Feature::of_solid(contact.moving_feature, cast.moving());
        self.fixed_feature = Feature::of_solid(contact.fixed_feature, cast.fixed());
    }
}

impl DistanceAnswer {
    /// No answer: all numbers are NaN.
    pub(crate) const NONE: Self = Self {
        outcome: Outcome::Error,
        lower: f64::NAN,
        upper: f64::NAN,
        normal: NO_VECTOR,
        point_on_moving: NO_VECTOR,
        point_on_fixed: NO_VECTOR,
        moving_feature: Feature::UNKNOWN,
        fixed_feature: Feature::UNKNOWN,
    };

    /// Returns the distance of a body from an empty scene.
    pub(crate) fn infinite() -> Self {
        let (lower, upper) = (f64::INFINITY, f64::INFINITY);
        Self { outcome: Outcome::Apart, lower, upper, ..Self::NONE }
    }

    /// Converts the distance of convex bodies.
    #[inline]
    pub(crate) fn of_convex(
        distance: &colltrans::Distance,
        [moving, fixed]: [&ConvexPolyhedron; 2],
    ) -> Self {
        let (mut of_moving, mut of_fixed) = (Feature::UNKNOWN, Feature::UNKNOWN);
        if let Some(features) = distance.features {
            of_moving = Feature::of_convex(features.moving, moving);
            of_fixed = Feature::of_convex(features.fixed, fixed);
        }
        Self {
            outcome: if distance.lower > 0.0 { Outcome::Apart } else { Outcome::Meeting },
            lower: distance.lower,
            upper: distance.upper,
            normal: distance.normal.map_or(NO_VECTOR, coordinates),
            point_on_moving: coordinates(distance.on_moving),
            point_on_fixed: coordinates(distance.on_fixed),
            moving_feature: of_moving,
            fixed_feature: of_fixed,
        }
    }

    /// Converts the distance of bodies of either kind, without features, with another lower bound.
    pub(crate) fn of_any(distance: &AnyDistance, lower: f64) -> Self {
        Self {
            outcome: if lower > 0.0 { Outcome::Apart } else { Outcome::Meeting },
            lower,
            upper: distance.upper(),
            normal: distance.normal().map_or(NO_VECTOR, coordinates),
            point_on_moving: coordinates(distance.on_moving()),
            point_on_fixed: coordinates(distance.on_fixed()),
            ..Self::NONE
        }
    }
}

impl From<&DistanceRecord> for DistanceAnswer {
    fn from(of: &DistanceRecord) -> Self {
        let [point_on_moving, point_on_fixed] = of.points.unwrap_or([NO_VECTOR; 2]);
        let [moving_feature, fixed_feature] = Feature::of_records(of.features.as_ref());
        Self {
            outcome: of.outcome.into(),
            lower: of.lower.unwrap_or(0.0),
            upper: of.upper.unwrap_or(f64::INFINITY),
            normal: of.normal.unwrap_or(NO_VECTOR),
            point_on_moving,
            point_on_fixed,
            moving_feature,
            fixed_feature,
        }
    }
}

impl From<&DepthRecord> for DepthAnswer {
    fn from(of: &DepthRecord) -> Self {
        let overlap = of.start_overlaps.first();
        Self {
            outcome: of.outcome.into(),
            lower: of.lower.unwrap_or(f64::NAN),
            upper: of.upper.unwrap_or(f64::NAN),
            least_tolerance: overlap.and_then(|of| of.least_tolerance).unwrap_or(f64::NAN),
            direction: of.direction.unwrap_or(NO_VECTOR),
        }
    }
}

impl From<&MotionRecord> for MotionAnswer {
    fn from(of: &MotionRecord) -> Self {
        let (time_lower, time_upper) =
            of.time.map_or((f64::NAN, f64::NAN), |TimeRecord { lower, upper }| {
                (lower, upper.unwrap_or(f64::INFINITY))
            });
        let overlap = of.start_overlaps.first();
        let [moving_feature, fixed_feature] = Feature::of_records(of.features.as_ref());
        Self {
            outcome: of.outcome.into(),
            time_lower,
            time_upper,
            tolerance: of.tolerance.unwrap_or(f64::NAN),
            least_tolerance: overlap.and_then(|of| of.least_tolerance).unwrap_or(f64::NAN),
            normal: of.normal.unwrap_or(NO_VECTOR),
            point: of.point.unwrap_or(NO_VECTOR),
            moving_feature,
            fixed_feature,
        }
    }
}
