//! A first contact of bodies that turn, as front ends write it.

use serde::Serialize;

use super::{Ending, FeaturesRecord, coordinates};
use crate::motion::{MotionCast, MotionContact, MotionOutcome};

/// When bodies that turn first meet. Fields that do not apply are left out.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
#[non_exhaustive]
pub struct MotionRecord {
    /// `contact`; `grazing`: nearer than rounding can tell; `free` throughout; `overlapping` when the motion begins.
    pub outcome: Ending,
    /// Of a contact, in parts of the motion; of a grazing one the upper bound is missing.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time: Option<TimeRecord>,
    /// Where the moving body is then, in the world.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub point: Option<[f64; 3]>,
    /// Unit vector in the world, from the moving to the fixed body.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub normal: Option<[f64; 3]>,
    /// What touches.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub features: Option<FeaturesRecord>,
    /// Times at which the bodies were looked at.
    pub looks: u32,
    /// Planes in the proof.
    pub planes: usize,
}

/// Bounds of a time.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct TimeRecord {
    /// They do not meet before.
    pub lower: f64,
    /// They do meet then.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub upper: Option<f64>,
}

impl MotionRecord {
    /// Of an answer; `cast` is the one that was asked.
    pub fn of(outcome: &MotionOutcome, cast: &MotionCast<'_>) -> Self {
        let ending = match outcome {
            MotionOutcome::Contact(_) => Ending::Contact,
            MotionOutcome::Grazing(_) => Ending::Grazing,
            MotionOutcome::Free(_) => Ending::Free,
            MotionOutcome::Overlapping(_) => Ending::Overlapping,
        };
        let steps = outcome.steps();
        let planes = outcome.proof().spans.iter().map(Vec::len).sum();
        let record = Self { outcome: ending, looks: steps.looks, planes, ..Self::default() };
        match outcome {
            MotionOutcome::Contact(contact) | MotionOutcome::Grazing(contact) => {
                record.with(contact, cast)
            }
            _ => record,
        }
    }

    fn with(self, contact: &MotionContact, cast: &MotionCast<'_>) -> Self {
        let MotionContact { lower, upper, points, normal, .. } = contact;
        let upper = upper.is_finite().then_some(*upper);
        Self {
            time: Some(TimeRecord { lower: *lower, upper }),
            point: points.map(|points| coordinates(points[0])),
            normal: normal.map(coordinates),
            features: contact.features.map(|of| FeaturesRecord::of(of, cast.bodies())),
            ..self
        }
    }
}
