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
            ContactRange::Contact { enter, exit } => {
                Self { outcome: Name::Contact, ..Self::of_contact(enter, exit, moving, fixed) }
            }
            ContactRange::Grazing { enter, exit } => Self {
                outcome: Name::Grazing,
                margin: Some(-enter.overlap),
                message: Some(describe(enter)),
                ..Self::of_contact(&enter.contact, &exit.contact, moving, fixed)
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
        enter: &Contact,
        exit: &Contact,
        moving: &ConvexPolyhedron,
        fixed: &ConvexPolyhedron,
    ) -> Self {
        Self {
            translation: Some(enter.translation),
            exit: Some(exit.translation),
            normal: Some(enter.normal.to_array()),
            point: Some(enter.point_on_fixed.to_array()),
            lower: Some(enter.certificate.lower),
            upper: Some(enter.certificate.upper),
            features: Some(Features {
                moving: FeatureRecord::of(enter.moving_feature, moving),
                fixed: FeatureRecord::of(enter.fixed_feature, fixed),
            }),
            solver: Some(solver_name(enter.solver)),
            steps: Some(StepCounts::of(enter.steps)),
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
        let Steps { planar_problems, supports, pivots } = steps;
        Self { planar_problems, supports, pivots }
    }
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
