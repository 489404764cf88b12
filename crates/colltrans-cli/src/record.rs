//! What is said about an answer, in the fields that `batch --help` documents.

mod line;

use std::path::Path;

use colltrans::glam::DVec3;
use colltrans::{
    Bounded, Cast, Clearance, Contact, ContactRange, ConvexPolyhedron, Feature, Grazing,
    OverlapAhead, Separated, Steps, WhyFree,
};
use colltrans_mesh::body::Excess;
use serde::Serialize;

use crate::numbers::{six_digits, unit_vector};
use crate::solid::{Answer, Kind};

/// One result; fields that do not apply are left out.
#[derive(Debug, Default)]
pub(crate) struct Record {
    pub(crate) outcome: Name,
    /// Of a scan.
    pub(crate) direction: Option<[f64; 3]>,
    pub(crate) distance: Option<f64>,
    pub(crate) back: Option<f64>,
    pub(crate) on: Option<f64>,
    pub(crate) translation: Option<Bounded>,
    /// Of solids.
    pub(crate) shrunk_distance: Option<Bounded>,
    pub(crate) exit: Option<Bounded>,
    /// The file that touches, of a body of several.
    pub(crate) moving: Option<String>,
    pub(crate) fixed: Option<String>,
    pub(crate) normal: Option<[f64; 3]>,
    pub(crate) point: Option<[f64; 3]>,
    pub(crate) rounding: Option<f64>,
    /// Of solids.
    pub(crate) tolerance: Option<f64>,
    /// Of solids.
    pub(crate) start_overlaps: Vec<StartOverlap>,
    /// Of solids, those that are open surfaces, at least in part.
    pub(crate) surfaces: Vec<&'static str>,
    pub(crate) features: Option<Features>,
    pub(crate) margin: Option<f64>,
    pub(crate) overlap: Option<f64>,
    pub(crate) hull: Option<Hulls>,
    pub(crate) solver: Option<&'static str>,
    pub(crate) steps: Option<StepCounts>,
    pub(crate) message: Option<String>,
    /// What was done to the meshes, in a batch; other commands say it on standard error.
    pub(crate) notes: Vec<String>,
}

/// How a query ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) enum Name {
    Contact,
    Grazing,
    Separated,
    Free,
    Blocked,
    Slides,
    Behind,
    Overlapping,
    #[default]
    Error,
}

impl Name {
    /// As it is written.
    pub(crate) const fn text(self) -> &'static str {
        match self {
            Self::Contact => "contact",
            Self::Grazing => "grazing",
            Self::Separated => "separated",
            Self::Free => "free",
            Self::Blocked => "blocked",
            Self::Slides => "slides",
            Self::Behind => "behind",
            Self::Overlapping => "overlapping",
            Self::Error => "error",
        }
    }
}

/// Two files that overlap where they are, or two bodies without names.
#[derive(Debug, Serialize)]
pub(crate) struct StartOverlap {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) moving: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) fixed: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    depth: Option<f64>,
}

/// What the hulls have that their parts have not.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Hulls {
    pub(crate) moving: Option<Excess>,
    pub(crate) fixed: Option<Excess>,
}

impl Hulls {
    /// `None` where the bodies are what they were made of.
    pub(crate) fn of(moving: Option<Excess>, fixed: Option<Excess>) -> Option<Self> {
        (moving.is_some() || fixed.is_some()).then_some(Self { moving, fixed })
    }

    /// Those that there are, by name.
    pub(crate) fn named(&self) -> impl Iterator<Item = (&'static str, Excess)> + use<> {
        let both = [("moving hull", self.moving), ("fixed hull", self.fixed)];
        both.into_iter().filter_map(|(name, excess)| Some((name, excess?)))
    }
}

/// The features of both bodies in the contact plane.
#[derive(Debug)]
pub(crate) struct Features {
    pub(crate) moving: FeatureRecord,
    pub(crate) fixed: FeatureRecord,
}

/// A feature by the indices of the input.
#[derive(Debug, Clone)]
pub(crate) struct FeatureRecord {
    pub(crate) kind: &'static str,
    pub(crate) vertices: Vec<u32>,
}

/// The library's [`Steps`].
#[derive(Debug)]
pub(crate) struct StepCounts {
    planar_problems: u32,
    supports: u32,
    pivots: u32,
}

impl Record {
    /// The result of a query that was answered.
    pub(crate) fn of_answer(answer: &ContactRange, cast: &Cast) -> Self {
        match answer {
            ContactRange::Contact { first, last } => {
                Self { outcome: Name::Contact, ..Self::of_contact(first, last, cast) }
            }
            ContactRange::Grazing { first, last } => Self {
                outcome: Name::Grazing,
                overlap: Some(first.overlap),
                message: Some(describe(first)),
                ..Self::of_contact(&first.contact, &last.contact, cast)
            },
            ContactRange::Separated(separated) => Self::of_separated(separated),
        }
    }

    /// The result of a query for the clearance.
    pub(crate) fn of_clearance(clearance: &Clearance, cast: &Cast) -> Self {
        match clearance {
            Clearance::Blocked { distance, contact } => Self {
                outcome: Name::Blocked,
                distance: Some(*distance),
                ..Self::of_first(contact, cast)
            },
            Clearance::Free(WhyFree::Slides(grazing)) => Self {
                outcome: Name::Slides,
                overlap: Some(grazing.overlap),
                message: Some(describe(grazing)),
                ..Self::of_first(&grazing.contact, cast)
            },
            // The last contact is the first one of the way back.
            Clearance::Free(WhyFree::Behind(last)) => Self {
                outcome: Name::Behind,
                exit: Some(last.exit()),
                translation: None,
                ..Self::of_first(last, &cast.reversed())
            },
            Clearance::Free(WhyFree::Separated(separated)) => Self::of_separated(separated),
            Clearance::Overlapping(OverlapAhead { first, last }) => Self {
                outcome: Name::Overlapping,
                back: Some(-first.certificate.lower),
                on: Some(-last.certificate.lower),
                ..Self::of_contact(first, last, cast)
            },
        }
    }

    /// The result of a query between solids.
    pub(crate) fn of_solids(answer: &Answer<'_>) -> Self {
        let name = |path: &Path| Some(path.display().to_string());
        let start_overlaps: Vec<StartOverlap> = answer
            .overlaps
            .iter()
            .map(|o| StartOverlap { moving: name(o.moving), fixed: name(o.fixed), depth: o.depth })
            .collect();
        let record = match &answer.kind {
            Kind::Free => Self { outcome: Name::Free, ..Self::default() },
            Kind::Overlapping => Self {
                outcome: Name::Overlapping,
                moving: answer.overlaps.first().and_then(|o| name(o.moving)),
                fixed: answer.overlaps.first().and_then(|o| name(o.fixed)),
                ..Self::default()
            },
            Kind::Blocked(stop) => Self {
                outcome: Name::Blocked,
                distance: Some(stop.distance),
                translation: Some(stop.translation),
                shrunk_distance: Some(stop.shrunk),
                moving: name(stop.moving.file),
                fixed: name(stop.fixed.file),
                normal: Some(coordinates(stop.normal)),
                point: Some(coordinates(stop.point)),
                features: Some(Features {
                    moving: stop.moving.feature.clone(),
                    fixed: stop.fixed.feature.clone(),
                }),
                ..Self::default()
            },
        };
        let (tolerance, surfaces) = (Some(answer.tolerance), answer.surface_names());
        Self { exit: answer.exit, tolerance, start_overlaps, surfaces, ..record }
    }

    /// Without the names of files, where a body is one.
    #[must_use]
    pub(crate) fn without_names(mut self) -> Self {
        (self.moving, self.fixed) = (None, None);
        for overlap in &mut self.start_overlaps {
            (overlap.moving, overlap.fixed) = (None, None);
        }
        self
    }

    fn of_separated(separated: &Separated) -> Self {
        let Separated { certificate, solver, steps, .. } = separated;
        Self {
            outcome: Name::Separated,
            normal: Some(coordinates(certificate.normal)),
            margin: Some(certificate.margin),
            solver: Some(solver.name()),
            steps: Some(StepCounts::of(*steps)),
            ..Self::default()
        }
    }

    /// The result of a query that has no answer.
    pub(crate) fn of_error(message: String) -> Self {
        Self { outcome: Name::Error, message: Some(message), ..Self::default() }
    }

    fn of_contact(first: &Contact, last: &Contact, cast: &Cast) -> Self {
        Self { exit: Some(last.exit()), ..Self::of_first(first, cast) }
    }

    fn of_first(first: &Contact, cast: &Cast) -> Self {
        let features = first.features(cast);
        Self {
            translation: Some(first.bounded()),
            normal: Some(coordinates(first.normal)),
            point: Some(coordinates(first.points(cast).on_fixed)),
            rounding: Some(first.certificate.rounding),
            features: Some(Features {
                moving: FeatureRecord::of(features.moving, cast.moving()),
                fixed: FeatureRecord::of(features.fixed, cast.fixed()),
            }),
            solver: Some(first.solver.name()),
            steps: Some(StepCounts::of(first.steps)),
            ..Self::default()
        }
    }
}

impl FeatureRecord {
    fn of(feature: Feature, body: &ConvexPolyhedron) -> Self {
        Self {
            kind: feature.kind(),
            vertices: feature.vertices(body).into_iter().map(u32::from).collect(),
        }
    }
}

impl StepCounts {
    fn of(steps: Steps) -> Self {
        // One-off queries start from scratch.
        let Steps { planar_problems, supports, pivots, .. } = steps;
        Self { planar_problems, supports, pivots }
    }
}

/// Without -0.
fn coordinates(v: DVec3) -> [f64; 3] {
    v.to_array().map(|c| c + 0.0)
}

fn describe(grazing: &Grazing) -> String {
    let (overlap, along) = (six_digits(grazing.overlap), unit_vector(grazing.separating_direction));
    format!("the shadows overlap by {overlap} along [{along}]")
}
