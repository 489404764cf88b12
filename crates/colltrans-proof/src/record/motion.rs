//! A first contact of bodies that turn, as front ends write it.

use serde::Serialize;

use super::{Ending, FeaturesRecord, Record, StartOverlapRecord, coordinates, open_ones};
use colltrans_convex::body::Body;
use colltrans_motion::{MotionCast, MotionClearance, MotionContact, MotionOutcome, MotionOverlap};
use colltrans_solid::body::Solid;

/// Bounds of a time, from 0 at the start of a motion to 1 at its end.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct TimeRecord {
    /// They do not meet before.
    pub lower: f64,
    /// They do meet then; missing where that is not proven.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub upper: Option<f64>,
}

impl Record {
    /// Of [`MotionCast::first_contact`] of convex bodies; `cast` is the one that was asked.
    pub fn of_motion(outcome: &MotionOutcome, cast: &MotionCast<'_>) -> Self {
        let planes = outcome.proof().planes();
        let tolerance = Some(cast.tolerance()).filter(|depth| *depth > 0.0);
        Self { planes: Some(planes), tolerance, ..Self::of_motions(outcome, cast) }
    }

    /// Of the first contact of solids, with or without a proof; `cast` is the one that was asked.
    pub fn of_solid_motion<P>(outcome: &MotionOutcome<P>, cast: &MotionCast<'_, Solid>) -> Self {
        let surfaces = open_ones(cast.bodies()[0], cast.bodies()[1]);
        Self { tolerance: Some(cast.tolerance()), surfaces, ..Self::of_motions(outcome, cast) }
    }

    /// Of [`MotionCast::clearance`] of convex bodies; `cast` is the one that was asked. Where they are stopped, `time` is
    /// that of their true place.
    pub fn of_motion_clearance(clearance: &MotionClearance, cast: &MotionCast<'_>) -> Self {
        let record = Self::cleared(clearance, |outcome| Self::of_motion(outcome, cast));
        record.keeping(cast.keep())
    }

    /// The same of solids.
    pub fn of_solid_motion_clearance(
        clearance: &MotionClearance<()>,
        cast: &MotionCast<'_, Solid>,
    ) -> Self {
        let record = Self::cleared(clearance, |outcome| Self::of_solid_motion(outcome, cast));
        let surfaces = open_ones(cast.bodies()[0], cast.bodies()[1]);
        Self { tolerance: Some(cast.tolerance()), surfaces, ..record.keeping(cast.keep()) }
    }

    fn cleared<P: Clone>(
        clearance: &MotionClearance<P>,
        told: impl Fn(&MotionOutcome<P>) -> Self,
    ) -> Self {
        match clearance {
            MotionClearance::Blocked { time, contact } => {
                let record = told(&MotionOutcome::Contact(contact.shrunk.clone()));
                let upper = Some(contact.time.upper).filter(|upper| upper.is_finite());
                let true_time = Some(TimeRecord { lower: *time, upper });
                let (outcome, tolerance) = (Ending::Blocked, Some(contact.tolerance));
                Self { outcome, tolerance, time: true_time, shrunk_time: record.time, ..record }
            }
            MotionClearance::Free(free) => told(&MotionOutcome::Free(free.clone())),
            MotionClearance::Overlapping(MotionOverlap { least_tolerance, .. }) => {
                let least_tolerance = *least_tolerance;
                let overlap = StartOverlapRecord { least_tolerance, ..Default::default() };
                let (outcome, looks) = (Ending::Overlapping, Some(0));
                Self { outcome, looks, start_overlaps: vec![overlap], ..Self::default() }
            }
        }
    }

    fn of_motions<P, B: Body>(outcome: &MotionOutcome<P>, cast: &MotionCast<'_, B>) -> Self {
        let looks = Some(outcome.steps().looks);
        let record = Self { looks, ..Self::default() }.keeping(cast.keep());
        match outcome {
            MotionOutcome::Contact(contact) => record.touching(Ending::Contact, contact, cast),
            MotionOutcome::Grazing(contact) => record.touching(Ending::Grazing, contact, cast),
            MotionOutcome::Undecided(contact) => record.touching(Ending::Undecided, contact, cast),
            MotionOutcome::Free(_) => Self { outcome: Ending::Free, ..record },
            MotionOutcome::Overlapping(_) => Self { outcome: Ending::Overlapping, ..record },
            _ => Self { outcome: Ending::Undecided, ..record },
        }
    }

    /// With when, where and what.
    fn touching<P, B: Body>(
        self,
        outcome: Ending,
        contact: &MotionContact<P>,
        cast: &MotionCast<'_, B>,
    ) -> Self {
        let MotionContact { lower, upper, points, normal, features, .. } = contact;
        let upper = upper.is_finite().then_some(*upper);
        Self {
            outcome,
            time: Some(TimeRecord { lower: *lower, upper }),
            point: points.map(|[_, on_fixed]| coordinates(on_fixed)),
            normal: normal.map(coordinates),
            features: features.map(|of| FeaturesRecord::of(of, cast.bodies())),
            ..self
        }
    }
}
