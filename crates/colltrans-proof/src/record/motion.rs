//! Records of first contacts and clearances along motions.

use super::{
    Ending, FeaturesRecord, StartOverlapRecord, open_bodies, positive_gap, record,
    without_negative_zeros,
};
use colltrans_convex::body::Body;
use colltrans_motion::{MotionCast, MotionClearance, MotionContact, MotionOutcome, MotionOverlap};
use colltrans_solid::body::Solid;

record! {
    /// Bounds of a time. For a motion, times are from 0 at the start to 1 at the end. For a path, they are the
    /// times of the path.
    #[derive(Copy)]
    pub struct TimeRecord {
        /// The bodies do not meet before this time.
        pub lower: f64,
        /// The bodies meet at this time or earlier; absent if no contact is proven.
        pub upper: Option<f64>,
    }
}

record! {
    /// First contact or clearance of bodies along a motion.
    #[non_exhaustive]
    pub struct MotionRecord {
        /// Outcome of the query; `undecided` if the search took its maximum number of steps.
        pub outcome: Ending,
        /// First contact, as a fraction of the motion.
        pub time: Option<TimeRecord>,
        /// First contact of the offset bodies, for a clearance.
        pub shrunk_time: Option<TimeRecord>,
        /// Name of the part in contact, if the moving body has several.
        pub moving: Option<String>,
        /// Name of the part in contact, if the fixed body has several.
        pub fixed: Option<String>,
        /// Unit normal from the moving to the fixed body.
        pub normal: Option<[f64; 3]>,
        /// Contact point on the fixed body, in the world frame.
        pub point: Option<[f64; 3]>,
        /// Tolerated depth for convex bodies, tolerance in use for solids; a length.
        pub tolerance: Option<f64>,
        /// Minimum gap, a length. The bodies meet if their distance falls to it.
        pub min_gap: Option<f64>,
        /// Overlaps at the start of the motion.
        pub start_overlaps: Vec<StartOverlapRecord>,
        /// For solids, the bodies that are open, at least in part.
        pub surfaces: Vec<&'static str>,
        /// Features in contact.
        pub features: Option<FeaturesRecord>,
        /// Number of distance samples.
        pub looks: u32,
        /// Number of planes of the proof, for convex bodies.
        pub planes: Option<usize>,
    }
}

impl MotionRecord {
    /// Converts an answer of [`MotionCast::first_contact`] for convex bodies. `cast` must be the cast of the
    /// query.
    pub fn from_outcome(outcome: &MotionOutcome, cast: &MotionCast<'_>) -> Self {
        let planes = outcome.proof().plane_count();
        let tolerance = Some(cast.tolerance()).filter(|depth| *depth > 0.0);
        Self { planes: Some(planes), tolerance, ..Self::of_motion_outcome(outcome, cast) }
    }

    /// Converts the first contact of solids, with or without a proof. `cast` must be the cast of the query.
    pub fn of_solids<P>(outcome: &MotionOutcome<P>, cast: &MotionCast<'_, Solid>) -> Self {
        let surfaces = open_bodies(cast.bodies()[0], cast.bodies()[1]);
        Self {
            tolerance: Some(cast.tolerance()),
            surfaces,
            ..Self::of_motion_outcome(outcome, cast)
        }
    }

    /// Converts an answer of [`MotionCast::clearance`] for convex bodies. `cast` must be the cast of the
    /// query. If the body is blocked, `time` is the contact in nominal position.
    pub fn of_clearance(clearance: &MotionClearance, cast: &MotionCast<'_>) -> Self {
        let record =
            Self::of_motion_clearance(clearance, |outcome| Self::from_outcome(outcome, cast));
        Self { min_gap: positive_gap(cast.min_gap()), ..record }
    }

    /// Converts an answer of [`MotionCast::clearance`] for solids. `cast` must be the cast of the query.
    pub fn of_solid_clearance(
        clearance: &MotionClearance<()>,
        cast: &MotionCast<'_, Solid>,
    ) -> Self {
        let record = Self::of_motion_clearance(clearance, |outcome| Self::of_solids(outcome, cast));
        let surfaces = open_bodies(cast.bodies()[0], cast.bodies()[1]);
        let (tolerance, min_gap) = (Some(cast.tolerance()), positive_gap(cast.min_gap()));
        Self { tolerance, min_gap, surfaces, ..record }
    }

    fn of_motion_clearance<P: Clone>(
        clearance: &MotionClearance<P>,
        record_of: impl Fn(&MotionOutcome<P>) -> Self,
    ) -> Self {
        match clearance {
            MotionClearance::Blocked { time, contact } => {
                let record = record_of(&MotionOutcome::Contact(contact.shrunk.clone()));
                let upper = Some(contact.time.upper).filter(|upper| upper.is_finite());
                let true_time = Some(TimeRecord { lower: *time, upper });
                let (outcome, tolerance) = (Ending::Blocked, Some(contact.tolerance));
                Self { outcome, tolerance, time: true_time, shrunk_time: record.time, ..record }
            }
            MotionClearance::Free(free) => record_of(&MotionOutcome::Free(free.clone())),
            MotionClearance::Overlapping(MotionOverlap { least_tolerance, .. }) => {
                let start_overlaps = StartOverlapRecord::with_least_tolerance(*least_tolerance);
                Self { outcome: Ending::Overlapping, start_overlaps, ..Self::default() }
            }
        }
    }

    fn of_motion_outcome<P, B: Body>(outcome: &MotionOutcome<P>, cast: &MotionCast<'_, B>) -> Self {
        let (min_gap, looks) = (positive_gap(cast.min_gap()), outcome.steps().looks);
        let record = Self { min_gap, looks, ..Self::default() };
        match outcome {
            MotionOutcome::Contact(contact) => record.with_contact(Ending::Contact, contact, cast),
            MotionOutcome::Grazing(contact) => record.with_contact(Ending::Grazing, contact, cast),
            MotionOutcome::Undecided(contact) => {
                record.with_contact(Ending::Undecided, contact, cast)
            }
            MotionOutcome::Free(_) => Self { outcome: Ending::Free, ..record },
            MotionOutcome::Overlapping(_) => Self { outcome: Ending::Overlapping, ..record },
            _ => Self { outcome: Ending::Undecided, ..record },
        }
    }

    /// Returns the record with time, place and features of a contact.
    fn with_contact<P, B: Body>(
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
            point: points.map(|[_, on_fixed]| without_negative_zeros(on_fixed)),
            normal: normal.map(without_negative_zeros),
            features: features.map(|of| FeaturesRecord::of_bodies(of, cast.bodies())),
            ..self
        }
    }
}
