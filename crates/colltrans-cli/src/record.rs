//! What is said about an answer, in the fields that `batch --help` documents.

use colltrans::{
    Contact, ContactRange, ConvexPolyhedron, Feature, Grazing, Separated, Solver, Steps,
};
use serde::Serialize;
use serde_json::value::RawValue;

/// One result; fields that do not apply are left out.
#[derive(Debug, Default, Serialize)]
pub(crate) struct Record {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) id: Option<Box<RawValue>>,
    pub(crate) outcome: Name,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) translation: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) exit: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) normal: Option<[f64; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) point: Option<[f64; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) lower: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) upper: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) features: Option<Features>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) margin: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) solver: Option<&'static str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) steps: Option<StepCounts>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) message: Option<String>,
}

/// How a query ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Name {
    Contact,
    Grazing,
    Separated,
    #[default]
    Error,
}

/// The features of both bodies in the contact plane.
#[derive(Debug, Serialize)]
pub(crate) struct Features {
    pub(crate) moving: FeatureRecord,
    pub(crate) fixed: FeatureRecord,
}

/// A feature by the indices of the input.
#[derive(Debug, Serialize)]
pub(crate) struct FeatureRecord {
    pub(crate) kind: &'static str,
    pub(crate) vertices: Vec<u32>,
}

/// The library's [`Steps`].
#[derive(Debug, Serialize)]
pub(crate) struct StepCounts {
    planar_problems: u32,
    supports: u32,
    pivots: u32,
}

impl Record {
    /// The result of a query that was answered.
    pub(crate) fn of_answer(
        answer: &ContactRange,
        moving: &ConvexPolyhedron,
        fixed: &ConvexPolyhedron,
    ) -> Self {
        match answer {
            ContactRange::Contact { first, last } => {
                Self { outcome: Name::Contact, ..Self::of_contact(first, last, moving, fixed) }
            }
            ContactRange::Grazing { first, last } => Self {
                outcome: Name::Grazing,
                margin: Some(-first.overlap),
                message: Some(describe(first)),
                ..Self::of_contact(&first.contact, &last.contact, moving, fixed)
            },
            ContactRange::Separated(Separated { certificate, solver, steps }) => Self {
                outcome: Name::Separated,
                normal: Some(certificate.normal.to_array()),
                margin: Some(certificate.margin),
                solver: Some(solver_name(*solver)),
                steps: Some(StepCounts::of(*steps)),
                ..Self::default()
            },
        }
    }

    /// The result of a query that has no answer.
    pub(crate) fn of_error(message: String) -> Self {
        Self { outcome: Name::Error, message: Some(message), ..Self::default() }
    }

    fn of_contact(
        first: &Contact,
        last: &Contact,
        moving: &ConvexPolyhedron,
        fixed: &ConvexPolyhedron,
    ) -> Self {
        Self {
            translation: Some(first.translation),
            exit: Some(exit_of(last)),
            normal: Some(first.normal.to_array()),
            point: Some(first.point_on_fixed.to_array()),
            lower: Some(first.certificate.lower),
            upper: Some(first.certificate.upper),
            features: Some(Features {
                moving: FeatureRecord::of(first.moving_feature, moving),
                fixed: FeatureRecord::of(first.fixed_feature, fixed),
            }),
            solver: Some(solver_name(first.solver)),
            steps: Some(StepCounts::of(first.steps)),
            ..Self::default()
        }
    }
}

impl FeatureRecord {
    fn of(feature: Feature, body: &ConvexPolyhedron) -> Self {
        let input = body.input_indices();
        let vertices = feature.vertices(body).into_iter().map(|v| input[v as usize]).collect();
        Self { kind: feature.kind(), vertices }
    }
}

impl StepCounts {
    fn of(steps: Steps) -> Self {
        // One-off queries start from scratch.
        let Steps { planar_problems, supports, pivots, iterations: _, started_from: _ } = steps;
        Self { planar_problems, supports, pivots }
    }
}

/// The translation of the last contact, which its own cast counts backwards.
pub(crate) fn exit_of(last: &Contact) -> f64 {
    // Not -0.
    0.0 - last.translation
}

fn describe(grazing: &Grazing) -> String {
    let [x, y, z] = grazing.separating_direction.to_array();
    format!("the shadows overlap by {:e} along [{x},{y},{z}]", grazing.overlap)
}

pub(crate) fn solver_name(solver: Solver) -> &'static str {
    match solver {
        Solver::Auto => "auto",
        Solver::Cta => "cta",
        Solver::Portal => "portal",
    }
}
