//! Records of answers about two bodies and a direction.

use colltrans_convex::answer::{
    Bounded, Clearance, Contact, ContactRange, FreeReason, Grazing, Outcome, OverlapAhead,
    Separated, Solver, Steps,
};
use colltrans_convex::cast::Cast;
use colltrans_solid::SolidCast;
use colltrans_solid::body::Solid;

use super::{
    Ending, Features, FeaturesRecord, Fields, StartOverlapRecord, open_bodies, positive_gap,
    record, without_negative_zeros,
};

record! {
    /// First and last contact of convex bodies along a direction.
    #[non_exhaustive]
    pub struct CastRecord {
        /// Outcome of the query.
        pub outcome: Ending,
        /// The direction as it was read, for one of several directions.
        pub direction: Option<[f64; 3]>,
        ..
        /// Contact, or the separation of the bodies.
        pub contact: ContactRecord,
    }
}

record! {
    /// Clearance of a convex body along a direction.
    #[non_exhaustive]
    pub struct ClearanceRecord {
        /// Outcome of the query.
        pub outcome: Ending,
        /// The direction as it was read, for one of several directions.
        pub direction: Option<[f64; 3]>,
        /// Safe travel of a blocked body.
        pub distance: Option<f64>,
        /// For an overlap, travel backwards that certainly separates the bodies.
        pub back: Option<f64>,
        /// For an overlap, travel forwards that certainly separates the bodies.
        pub on: Option<f64>,
        ..
        /// Contact, or the separation of the bodies.
        pub contact: ContactRecord,
    }
}

record! {
    /// Contact of convex bodies along a direction, or their separation.
    #[non_exhaustive]
    pub struct ContactRecord {
        /// First contact.
        pub translation: Option<f64>,
        /// Proven bounds of `translation`.
        pub translation_bounds: Option<[f64; 2]>,
        /// Last contact.
        pub exit: Option<f64>,
        /// Proven bounds of `exit`. Beyond the upper one the bodies never meet.
        pub exit_bounds: Option<[f64; 2]>,
        /// Unit normal of the contact plane or the separating plane, from the moving to the fixed body.
        pub normal: Option<[f64; 3]>,
        /// Contact point on the fixed body, in the world frame.
        pub point: Option<[f64; 3]>,
        /// The part of the bounds' difference that rounding explains.
        pub rounding: Option<f64>,
        /// Minimum gap, a length. The bodies meet if their distance falls to it.
        pub min_gap: Option<f64>,
        /// Features in contact.
        pub features: Option<FeaturesRecord>,
        /// Gap between the shadows of separated bodies, along the normal.
        pub margin: Option<f64>,
        /// Overlap of the shadows of bodies that graze or slide; negative if they may not overlap.
        pub overlap: Option<f64>,
        /// Unit vector of this overlap, perpendicular to the direction, from the moving body's shadow to that
        /// of the fixed one.
        pub sideways: Option<[f64; 3]>,
        /// Solver that found the answer.
        pub solver: Option<Solver>,
        /// Amounts of work.
        pub steps: Option<Steps>,
    }
}

record! {
    /// Clearance of a solid along a direction.
    #[non_exhaustive]
    pub struct SolidClearanceRecord {
        /// Outcome of the query.
        pub outcome: Ending,
        /// The direction as it was read, for one of several directions.
        pub direction: Option<[f64; 3]>,
        /// Safe travel of a blocked body.
        pub distance: Option<f64>,
        /// Contact of the blocking facets in nominal position.
        pub translation: Option<f64>,
        /// Proven bounds of `translation`.
        pub translation_bounds: Option<[f64; 2]>,
        /// Travel of the bodies offset by half the tolerance each.
        pub offset_distance: Option<f64>,
        /// Proven bounds of `offset_distance`.
        pub offset_distance_bounds: Option<[f64; 2]>,
        /// Last contact.
        pub exit: Option<f64>,
        /// Proven bounds of `exit`. Beyond the upper one the bodies never meet.
        pub exit_bounds: Option<[f64; 2]>,
        /// Name of the part in contact, or of the part that overlaps most, if the moving body has several.
        pub moving: Option<String>,
        /// Name of the part in contact, or of the part that overlaps most, if the fixed body has several.
        pub fixed: Option<String>,
        /// Unit normal of the contact plane, from the moving to the fixed body.
        pub normal: Option<[f64; 3]>,
        /// Contact point on the fixed body, in the world frame.
        pub point: Option<[f64; 3]>,
        /// Tolerance in use, a length.
        pub tolerance: Option<f64>,
        /// Minimum gap, a length. The bodies meet if their distance falls to it.
        pub min_gap: Option<f64>,
        /// Overlaps at the start.
        pub start_overlaps: Vec<StartOverlapRecord>,
        /// Bodies that are open, at least in part.
        pub surfaces: Vec<&'static str>,
        /// Features in contact.
        pub features: Option<FeaturesRecord>,
    }
}

impl CastRecord {
    /// Converts an answer of [`Cast::first_contact`].
    pub fn of_outcome(outcome: &Outcome, cast: &Cast) -> Self {
        Self::of_outcome_with(outcome, cast, &Fields::ALL)
    }

    /// Converts an answer as [`Self::of_outcome`] does, with the requested points and features.
    pub(super) fn of_outcome_with(outcome: &Outcome, cast: &Cast, requested: &Fields) -> Self {
        match outcome {
            Outcome::Contact(first) => Self::with_outcome(
                Ending::Contact,
                ContactRecord::of_contact(first, cast, requested),
            ),
            Outcome::Grazing(first) => Self::with_outcome(
                Ending::Grazing,
                ContactRecord::of_grazing(first, cast, requested),
            ),
            Outcome::Separated(separated) => {
                Self::with_outcome(Ending::Separated, ContactRecord::of_separated(separated, cast))
            }
        }
    }

    /// Converts an answer of [`Cast::contact_range`].
    pub fn of_range(range: &ContactRange, cast: &Cast) -> Self {
        Self::of_range_with(range, cast, &Fields::ALL)
    }

    /// Converts an answer as [`Self::of_range`] does, with the requested points and features.
    pub(super) fn of_range_with(range: &ContactRange, cast: &Cast, requested: &Fields) -> Self {
        match range {
            ContactRange::Contact { first, last } => Self::with_outcome(
                Ending::Contact,
                ContactRecord::of_contact(first, cast, requested).with_last(last),
            ),
            ContactRange::Grazing { first, last } => {
                let contact = ContactRecord::of_grazing(first, cast, requested);
                Self::with_outcome(Ending::Grazing, contact.with_last(&last.contact))
            }
            ContactRange::Separated(separated) => {
                Self::with_outcome(Ending::Separated, ContactRecord::of_separated(separated, cast))
            }
        }
    }

    fn with_outcome(outcome: Ending, contact: ContactRecord) -> Self {
        Self { outcome, direction: None, contact }
    }
}

impl ClearanceRecord {
    /// Converts an answer of [`Cast::clearance`] for convex bodies.
    pub fn from_clearance(clearance: &Clearance, cast: &Cast) -> Self {
        Self::from_clearance_with(clearance, cast, &Fields::ALL)
    }

    /// Converts an answer as [`Self::from_clearance`] does, with the requested points and features.
    pub(super) fn from_clearance_with(
        clearance: &Clearance,
        cast: &Cast,
        requested: &Fields,
    ) -> Self {
        let at = |outcome, contact| Self { outcome, contact, ..Self::default() };
        match clearance {
            Clearance::Blocked { distance, contact } => {
                let record =
                    at(Ending::Blocked, ContactRecord::of_contact(contact, cast, requested));
                Self { distance: Some(*distance), ..record }
            }
            Clearance::Free(FreeReason::Slides(grazing)) => {
                at(Ending::Slides, ContactRecord::of_grazing(grazing, cast, requested))
            }
            // The last contact is the first one of the reversed cast.
            Clearance::Free(FreeReason::Behind(last)) => {
                let contact = ContactRecord::of_contact(last, &cast.reversed(), requested)
                    .with_exit(last.exit());
                let (translation, translation_bounds) = (None, None);
                at(Ending::Behind, ContactRecord { translation, translation_bounds, ..contact })
            }
            Clearance::Free(FreeReason::Separated(separated)) => {
                at(Ending::Separated, ContactRecord::of_separated(separated, cast))
            }
            Clearance::Overlapping(OverlapAhead { first, last }) => {
                let contact =
                    ContactRecord::of_contact(first, cast, requested).with_exit(last.exit());
                let [back, on] = [first, last].map(|contact| Some(-contact.certificate.lower));
                Self { back, on, ..at(Ending::Overlapping, contact) }
            }
        }
    }
}

impl ContactRecord {
    /// Converts a contact. Points and features are computed if they are requested.
    fn of_contact(contact: &Contact, cast: &Cast, requested: &Fields) -> Self {
        let point = || without_negative_zeros(contact.witness_points(cast).on_fixed);
        let features = || {
            let bodies = [cast.moving(), cast.fixed()];
            FeaturesRecord::of_bodies(contact.features(cast), bodies)
        };
        let translation = contact.bounded();
        Self {
            translation: Some(translation.value),
            translation_bounds: Some(translation.bounds()),
            normal: Some(without_negative_zeros(contact.normal)),
            point: requested.includes("point").then(point),
            rounding: Some(contact.certificate.rounding),
            min_gap: positive_gap(cast.options().min_gap),
            features: requested.includes("features").then(features),
            solver: Some(contact.solver),
            steps: Some(contact.steps),
            ..Self::default()
        }
    }

    fn of_grazing(grazing: &Grazing, cast: &Cast, requested: &Fields) -> Self {
        Self {
            overlap: Some(grazing.overlap),
            sideways: Some(without_negative_zeros(grazing.separating_direction)),
            ..Self::of_contact(&grazing.contact, cast, requested)
        }
    }

    fn of_separated(separated: &Separated, cast: &Cast) -> Self {
        let Separated { certificate, solver, steps, .. } = separated;
        Self {
            normal: Some(without_negative_zeros(certificate.normal)),
            min_gap: positive_gap(cast.options().min_gap),
            margin: Some(certificate.margin),
            solver: Some(*solver),
            steps: Some(*steps),
            ..Self::default()
        }
    }

    /// Adds the last contact. With [`Solver::Cta`], the steps count both contacts, because the last one starts from the
    /// first one.
    fn with_last(self, last: &Contact) -> Self {
        let mut record = self.with_exit(last.exit());
        if let Some(steps) = record.steps.as_mut().filter(|_| last.solver == Solver::Cta) {
            *steps += last.steps;
        }
        record
    }

    fn with_exit(self, exit: Bounded) -> Self {
        Self { exit: Some(exit.value), exit_bounds: Some(exit.bounds()), ..self }
    }
}

impl SolidClearanceRecord {
    /// Converts an answer of [`Cast::clearance`] for solids. `exit` is the result of `SolidCast::exit`.
    pub fn from_clearance(
        clearance: &Clearance<Solid>,
        exit: Option<Bounded>,
        cast: &Cast<'_, Solid>,
    ) -> Self {
        let record = Self {
            exit: exit.map(|exit| exit.value),
            exit_bounds: exit.map(|exit| exit.bounds()),
            tolerance: Some(cast.tolerance()),
            min_gap: positive_gap(cast.options().min_gap),
            surfaces: open_bodies(cast.moving(), cast.fixed()),
            ..Self::default()
        };
        match clearance {
            Clearance::Free(_) => Self { outcome: Ending::Free, ..record },
            Clearance::Overlapping(overlap) => Self {
                outcome: Ending::Overlapping,
                start_overlaps: StartOverlapRecord::with_least_tolerance(overlap.least_tolerance),
                ..record
            },
            Clearance::Blocked { distance, contact } => Self {
                outcome: Ending::Blocked,
                distance: Some(*distance),
                translation: Some(contact.translation.value),
                translation_bounds: Some(contact.translation.bounds()),
                offset_distance: Some(contact.offset_distance.value),
                offset_distance_bounds: Some(contact.offset_distance.bounds()),
                normal: Some(without_negative_zeros(contact.normal)),
                point: Some(without_negative_zeros(contact.point_on_fixed)),
                features: Some(FeaturesRecord::of_bodies(
                    Features { moving: contact.moving_feature, fixed: contact.fixed_feature },
                    [cast.moving(), cast.fixed()],
                )),
                ..record
            },
        }
    }
}
