//! The answers of the package, and their description.
//!
//! An answer is a list of doubles: its number in [`description`], then its fields in order. The macro defines
//! the order once, for the encoder here and for the description of which the build makes the types and the
//! decoder in TypeScript.

use std::fmt::Write as _;

use colltrans::glam::DVec3;
use colltrans::{Body, Feature};

/// Writes a field as doubles. `TYPE` names its decoder.
pub(crate) trait Field {
    /// The name of the decoder and of the type in TypeScript.
    const TYPE: &'static str;

    fn write(&self, numbers: &mut Vec<f64>);
}

impl Field for f64 {
    const TYPE: &'static str = "number";

    fn write(&self, numbers: &mut Vec<f64>) {
        numbers.push(self + 0.0);
    }
}

/// NaN if it is absent.
impl Field for Option<f64> {
    const TYPE: &'static str = "numberOrNull";

    fn write(&self, numbers: &mut Vec<f64>) {
        self.unwrap_or(f64::NAN).write(numbers);
    }
}

/// NaN if it is absent.
impl Field for Option<bool> {
    const TYPE: &'static str = "booleanOrNull";

    fn write(&self, numbers: &mut Vec<f64>) {
        numbers.push(self.map_or(f64::NAN, |flag| f64::from(u8::from(flag))));
    }
}

impl Field for bool {
    const TYPE: &'static str = "boolean";

    fn write(&self, numbers: &mut Vec<f64>) {
        numbers.push(f64::from(u8::from(*self)));
    }
}

impl Field for DVec3 {
    const TYPE: &'static str = "Vector";

    fn write(&self, numbers: &mut Vec<f64>) {
        numbers.extend(self.to_array().map(|c| c + 0.0));
    }
}

/// NaN if it is absent.
impl Field for Option<DVec3> {
    const TYPE: &'static str = "VectorOrNull";

    fn write(&self, numbers: &mut Vec<f64>) {
        self.unwrap_or(DVec3::NAN).write(numbers);
    }
}

/// A vertex, an edge or a face, by vertices of the input.
#[derive(Debug, Clone)]
pub(crate) struct FeatureField {
    kind: u8,
    vertices: Vec<usize>,
}

impl FeatureField {
    pub(crate) fn from_feature<B: Body>(feature: Feature, body: &B) -> Self {
        let vertices =
            feature.vertices(body).into_iter().map(colltrans::InputVertex::index).collect();
        let kind = match feature {
            Feature::Vertex(_) => 0,
            Feature::Edge(_) => 1,
            Feature::Face(_) => 2,
        };
        Self { kind, vertices }
    }

    #[cfg(feature = "min-gap")]
    pub(crate) fn from_record(record: &colltrans::record::FeatureRecord) -> Self {
        let kind = match record.kind {
            "vertex" => 0,
            "edge" => 1,
            _ => 2,
        };
        Self { kind, vertices: record.vertices.iter().map(|vertex| vertex.index()).collect() }
    }
}

/// The features of the moving and of the fixed body.
pub(crate) type FeaturesField = [FeatureField; 2];

impl Field for FeaturesField {
    const TYPE: &'static str = "Features";

    fn write(&self, numbers: &mut Vec<f64>) {
        for FeatureField { kind, vertices } in self {
            numbers.extend([f64::from(*kind), vertices.len() as f64]);
            numbers.extend(vertices.iter().map(|vertex| *vertex as f64));
        }
    }
}

/// A single NaN if it is absent.
impl Field for Option<FeaturesField> {
    const TYPE: &'static str = "FeaturesOrNull";

    fn write(&self, numbers: &mut Vec<f64>) {
        match self {
            Some(features) => features.write(numbers),
            None => numbers.push(f64::NAN),
        }
    }
}

/// An answer that has a number in the description.
pub(crate) trait Encode {
    /// Returns the doubles of the answer.
    fn encode(&self) -> Vec<f64>;

    /// Returns the number of the answer and its fields in columns; NaN for fields that it does not have.
    fn columns(&self) -> [f64; COLUMNS];

    /// Returns the answer as an answer of any type.
    fn found(self) -> Found
    where
        Self: Sized + 'static,
    {
        Box::new(self)
    }
}

/// An answer of any type.
pub(crate) type Found = Box<dyn Encode>;

/// Number of columns of an answer among many: its number, `value`, `lower`, `upper`, normal and point.
pub(crate) const COLUMNS: usize = 10;

/// Returns the first column of a field; `None` if it has no column.
fn column(field: &str) -> Option<usize> {
    Some(match field {
        "value" => 1,
        "lower" => 2,
        "upper" => 3,
        "normal" => 4,
        "point" | "point_on_fixed" => 7,
        _ => return None,
    })
}

/// Defines the answers: the name of the type, its outcome, and its fields.
macro_rules! answers {
    ($($(#[doc = $doc:literal])* $name:ident $outcome:literal {
        $($(#[doc = $field_doc:literal])* $field:ident: $type:ty,)*
    })*) => {
        #[derive(Clone, Copy)]
        enum Number { $($name),* }

        $(
            $(#[doc = $doc])*
            #[derive(Debug, Clone)]
            #[cfg_attr(not(feature = "min-gap"), allow(dead_code, reason = "other questions have it"))]
            pub(crate) struct $name {
                $($(#[doc = $field_doc])* pub(crate) $field: $type,)*
            }

            impl Encode for $name {
                fn encode(&self) -> Vec<f64> {
                    let mut numbers = vec![f64::from(Number::$name as u8)];
                    $(self.$field.write(&mut numbers);)*
                    numbers
                }

                fn columns(&self) -> [f64; COLUMNS] {
                    let mut columns = [f64::NAN; COLUMNS];
                    columns[0] = f64::from(Number::$name as u8);
                    $(if let Some(first) = column(stringify!($field)) {
                        let mut numbers = Vec::new();
                        self.$field.write(&mut numbers);
                        columns[first..first + numbers.len()].copy_from_slice(&numbers);
                    })*
                    columns
                }
            }
        )*

        /// Returns the description of all answers as JSON: a list of `{name, outcome, doc, fields}`, each field
        /// with `name`, `type` and `doc`. The index of an answer is the number with which it begins.
        pub fn description() -> String {
            let mut text = String::from("[");
            $(
                let separator = if text.len() > 1 { "," } else { "" };
                let doc = concat!($($doc, "\n"),*);
                let _ = write!(
                    text,
                    "{separator}\n{{\"name\":\"{}\",\"outcome\":{:?},\"doc\":{:?},\"fields\":[",
                    stringify!($name), $outcome, doc.trim(),
                );
                let fields: &[(&str, &str, &str)] = &[
                    $((stringify!($field), <$type as Field>::TYPE, concat!($($field_doc, "\n"),*))),*
                ];
                for (k, (name, kind, doc)) in fields.iter().enumerate() {
                    let separator = if k > 0 { "," } else { "" };
                    let doc = doc.trim();
                    let _ = write!(
                        text,
                        "{separator}{{\"name\":{name:?},\"type\":{kind:?},\"doc\":{doc:?}}}",
                    );
                }
                text.push_str("]}");
            )*
            text.push_str("\n]");
            text
        }
    };
}

answers! {
    /// The bodies meet along the direction.
    Contact "contact" {
        /// The translation at which they first meet, in multiples of the direction. It is negative for a contact behind
        /// the moving body or an overlap at the start.
        value: f64,
        /// A proven lower bound of the translation.
        lower: f64,
        /// A proven upper bound of the translation; `Infinity` if the contact is not proven.
        upper: f64,
        /// Unit normal from the moving to the fixed body.
        normal: DVec3,
        /// The contact point, in the world.
        point: DVec3,
        /// The contact point on the moving body at its start pose.
        point_at_start: DVec3,
        /// The vertices, edges or faces in contact.
        features: FeaturesField,
    }
    /// The shadows of convex bodies along the direction overlap by at most the graze tolerance: the bodies slide along
    /// each other.
    Grazing "grazing" {
        /// The translation of the contact, if the overlap is real.
        value: f64,
        /// A proven lower bound of the translation.
        lower: f64,
        /// A proven upper bound of the translation; `Infinity` if the bodies may pass each other.
        upper: f64,
        /// The overlap of the shadows, a length.
        overlap: f64,
        /// Unit vector perpendicular to the direction, from the shadow of the moving body to that of the fixed one.
        separating_direction: DVec3,
        /// Unit normal from the moving to the fixed body.
        normal: DVec3,
        /// The contact point, in the world.
        point: DVec3,
        /// The vertices, edges or faces in contact.
        features: FeaturesField,
    }
    /// Convex bodies never meet along the direction.
    Separated "separated" {
        /// `Infinity`.
        value: f64,
        /// `Infinity`.
        lower: f64,
        /// `Infinity`.
        upper: f64,
        /// A lower bound of the distance of the shadows along the direction, a length.
        margin: f64,
        /// Unit normal of a plane between the bodies, parallel to the direction.
        normal: DVec3,
    }
    /// Nothing blocks a solid, or solids or moving bodies never meet.
    Free "free" {
        /// `Infinity`.
        value: f64,
        /// `Infinity`.
        lower: f64,
        /// `Infinity`.
        upper: f64,
    }
    /// The moving body can move until it touches.
    Blocked "blocked" {
        /// The free travel in multiples of the direction, rounded down.
        value: f64,
        /// The free travel, which is proven.
        lower: f64,
        /// A proven upper bound of the translation at which the bodies meet.
        upper: f64,
        /// Unit normal from the moving to the fixed body.
        normal: DVec3,
        /// The contact point, in the world.
        point: DVec3,
        /// The contact point on the moving body at its start pose.
        point_at_start: DVec3,
        /// The vertices, edges or faces in contact.
        features: FeaturesField,
    }
    /// Nothing blocks a convex body, because it slides along the other one.
    Slides "slides" {
        /// `Infinity`.
        value: f64,
        /// `Infinity`.
        lower: f64,
        /// `Infinity`.
        upper: f64,
        /// The overlap of the shadows, a length.
        overlap: f64,
        /// Unit vector perpendicular to the direction, from the shadow of the moving body to that of the fixed one.
        separating_direction: DVec3,
    }
    /// Nothing blocks a convex body, because all contacts are behind it.
    Behind "behind" {
        /// `Infinity`.
        value: f64,
        /// `Infinity`.
        lower: f64,
        /// `Infinity`.
        upper: f64,
        /// The translation of the last contact, which is not positive.
        exit: f64,
    }
    /// The bodies overlap at the start, so that there is no free travel.
    Overlapping "overlapping" {
        /// `null`.
        value: Option<f64>,
        /// Convex bodies: a travel backwards that certainly separates them.
        back: Option<f64>,
        /// Convex bodies: a travel forwards that certainly separates them.
        on: Option<f64>,
        /// Solids: the smallest tolerance at which they do not overlap; `null` if there is none.
        least_tolerance: Option<f64>,
    }
    /// The first and the last contact of bodies along the direction.
    ContactRange "range" {
        /// The translation of the first contact.
        value: f64,
        /// A proven lower bound of the first translation.
        lower: f64,
        /// A proven upper bound of the first translation.
        upper: f64,
        /// The translation of the last contact.
        exit: f64,
        /// A proven lower bound of the last translation.
        exit_lower: f64,
        /// A proven upper bound of the last translation, beyond which the bodies never meet.
        exit_upper: f64,
        /// Unit normal of the first contact, from the moving to the fixed body.
        normal: DVec3,
        /// The overlap of the shadows of bodies that only graze, a length; otherwise `null`.
        overlap: Option<f64>,
    }
    /// The distance of the bodies.
    Distance "distance" {
        /// The middle of both bounds.
        value: f64,
        /// A proven lower bound of the distance.
        lower: f64,
        /// A proven upper bound of the distance.
        upper: f64,
        /// Whether the bodies touch or overlap.
        meets: bool,
        /// The nearest point of the moving body, in the world.
        point_on_moving: Option<DVec3>,
        /// The nearest point of the fixed body, in the world.
        point_on_fixed: Option<DVec3>,
        /// Unit normal along the shortest connection, from the moving to the fixed body.
        normal: Option<DVec3>,
        /// The features at the nearest points.
        features: Option<FeaturesField>,
    }
    /// The depth of the overlap: the length of the shortest translation that separates convex bodies, or the least
    /// tolerance at which solids do not overlap.
    Depth "depth" {
        /// The middle of both bounds.
        value: f64,
        /// A proven lower bound of the depth.
        lower: f64,
        /// A proven upper bound of the depth; `Infinity` if no tolerance separates the solids.
        upper: f64,
        /// Whether the bodies overlap by more than rounding errors explain.
        overlaps: bool,
        /// Unit vector of the shortest translation of the moving convex body that separates the bodies.
        direction: Option<DVec3>,
    }
    /// The comparison of the distance with a length.
    Within "within" {
        /// Whether the distance is at most the length; `null` if the length lies between the bounds.
        closer: Option<bool>,
        /// A proven lower bound of the distance, if it was computed.
        lower: Option<f64>,
        /// A proven upper bound of the distance, if it was computed.
        upper: Option<f64>,
    }
    /// The bodies meet during the motion.
    MotionContact "contact" {
        /// The time of the first contact, from 0 to 1: the middle of both bounds.
        value: f64,
        /// A proven lower bound of the time.
        lower: f64,
        /// A proven upper bound of the time.
        upper: f64,
        /// Unit normal from the moving to the fixed body at the contact.
        normal: Option<DVec3>,
        /// The contact point, in the world.
        point: Option<DVec3>,
        /// The vertices, edges or faces in contact.
        features: Option<FeaturesField>,
    }
    /// The bodies come nearer than rounding errors can decide, or the search took its maximum number of steps.
    MotionUndecided "undecided" {
        /// `null`.
        value: Option<f64>,
        /// The bodies certainly do not meet before this time.
        lower: f64,
        /// `Infinity`.
        upper: f64,
        /// Whether the bodies graze: they come nearer than rounding errors can decide.
        grazes: bool,
    }
    /// The pose of a body at a time.
    PoseAnswer "pose" {
        /// The position of the body's origin, in the world.
        position: DVec3,
        /// First column of the rotation matrix.
        x_axis: DVec3,
        /// Second column of the rotation matrix.
        y_axis: DVec3,
        /// Third column of the rotation matrix.
        z_axis: DVec3,
    }
    /// Whether the bodies meet.
    Intersection "intersection" {
        /// Whether they have a common point.
        meets: bool,
    }
}

#[cfg(feature = "min-gap")]
impl Free {
    /// The only value.
    pub(crate) const ANSWER: Self =
        Self { value: f64::INFINITY, lower: f64::INFINITY, upper: f64::INFINITY };
}
