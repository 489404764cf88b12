//! A first contact of bodies that turn, as front ends write it.

use super::{Ending, FeaturesRecord, StartOverlapRecord, coordinates, kept, open_ones, record};
use colltrans_convex::body::Body;
use colltrans_motion::{MotionCast, MotionClearance, MotionContact, MotionOutcome, MotionOverlap};
use colltrans_solid::body::Solid;

record! {
    /// Bounds of a time, from 0 at the start of a motion to 1 at its end.
    #[derive(Copy)]
    pub struct TimeRecord {
        /// They do not meet before.
        pub lower: f64,
        /// They do meet then; missing where that is not proven.
        pub upper: Option<f64>,
    }
}

record! {
    /// When bodies that turn first meet, or how far they can go.
    #[non_exhaustive]
    pub struct MotionRecord {
        /// How the query ended; `undecided` if the search took its maximum number of steps.
        pub outcome: Ending,
        /// When they first meet, in parts of the motion.
        pub time: Option<TimeRecord>,
        /// Of a clearance: when they do as the tolerance leaves them.
        pub shrunk_time: Option<TimeRecord>,
        /// The name of what touches, of a moving body that has several.
        pub moving: Option<String>,
        /// The name of what touches, of a fixed body that has several.
        pub fixed: Option<String>,
        /// Unit normal from the moving to the fixed body.
        pub normal: Option<[f64; 3]>,
        /// The contact point on the fixed body, in the world.
        pub point: Option<[f64; 3]>,
        /// Of convex bodies: the depth that is tolerated. Of solids: the tolerance that was used, a length.
        pub tolerance: Option<f64>,
        /// The gap that is kept, a length: the bodies count as meeting where they are as near as that.
        pub keep: Option<f64>,
        /// What overlaps when the motion begins.
        pub start_overlaps: Vec<StartOverlapRecord>,
        /// Of solids: which are open, at least in part.
        pub surfaces: Vec<&'static str>,
        /// What touches.
        pub features: Option<FeaturesRecord>,
        /// How many times of it were looked at.
        pub looks: u32,
        /// Of convex bodies: how many planes the proof has.
        pub planes: Option<usize>,
    }
}

impl MotionRecord {
    /// Of [`MotionCast::first_contact`] of convex bodies; `cast` is the one that was asked.
    pub fn of(outcome: &MotionOutcome, cast: &MotionCast<'_>) -> Self {
        let planes = outcome.proof().planes();
        let tolerance = Some(cast.tolerance()).filter(|depth| *depth > 0.0);
        Self { planes: Some(planes), tolerance, ..Self::of_motions(outcome, cast) }
    }

    /// Of the first contact of solids, with or without a proof; `cast` is the one that was asked.
    pub fn of_solids<P>(outcome: &MotionOutcome<P>, cast: &MotionCast<'_, Solid>) -> Self {
        let surfaces = open_ones(cast.bodies()[0], cast.bodies()[1]);
        Self { tolerance: Some(cast.tolerance()), surfaces, ..Self::of_motions(outcome, cast) }
    }

    /// Of [`MotionCast::clearance`] of convex bodies; `cast` is the one that was asked. Where they are stopped, `time` is
    /// that of their true place.
    pub fn of_clearance(clearance: &MotionClearance, cast: &MotionCast<'_>) -> Self {
        let record = Self::cleared(clearance, |outcome| Self::of(outcome, cast));
        Self { keep: kept(cast.keep()), ..record }
    }

    /// Of [`MotionCast::clearance`] of solids; `cast` is the one that was asked.
    pub fn of_solid_clearance(
        clearance: &MotionClearance<()>,
        cast: &MotionCast<'_, Solid>,
    ) -> Self {
        let record = Self::cleared(clearance, |outcome| Self::of_solids(outcome, cast));
        let surfaces = open_ones(cast.bodies()[0], cast.bodies()[1]);
        let (tolerance, keep) = (Some(cast.tolerance()), kept(cast.keep()));
        Self { tolerance, keep, surfaces, ..record }
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
                let start_overlaps = StartOverlapRecord::parted_by(*least_tolerance);
                Self { outcome: Ending::Overlapping, start_overlaps, ..Self::default() }
            }
        }
    }

    fn of_motions<P, B: Body>(outcome: &MotionOutcome<P>, cast: &MotionCast<'_, B>) -> Self {
        let (keep, looks) = (kept(cast.keep()), outcome.steps().looks);
        let record = Self { keep, looks, ..Self::default() };
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
