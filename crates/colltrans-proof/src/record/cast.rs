//! Answers about bodies along a direction, as front ends write them.

use colltrans_convex::answer::{
    Bounded, Clearance, Contact, ContactRange, Grazing, Outcome, OverlapAhead, Separated, Solver,
    Steps, WhyFree,
};
use colltrans_convex::cast::Cast;
use colltrans_solid::SolidCast;
use colltrans_solid::body::Solid;

use super::{
    Ending, Features, FeaturesRecord, StartOverlapRecord, coordinates, kept, open_ones, record,
};

record! {
    /// Where convex bodies meet along a direction.
    #[non_exhaustive]
    pub struct CastRecord {
        /// How the query ended.
        pub outcome: Ending,
        /// Of one query among several directions: the direction as it was read.
        pub direction: Option<[f64; 3]>,
        ..
        /// Where they meet, or what separates them.
        pub contact: ContactRecord,
    }
}

record! {
    /// How far a convex body can move along a direction before another one blocks it.
    #[non_exhaustive]
    pub struct ClearanceRecord {
        /// How the query ended.
        pub outcome: Ending,
        /// Of one query among several directions: the direction as it was read.
        pub direction: Option<[f64; 3]>,
        /// Blocked: how far it is safe to move.
        pub distance: Option<f64>,
        /// Overlapping: how far to go back to be free for certain.
        pub back: Option<f64>,
        /// Overlapping: how far to go on to be free for certain.
        pub on: Option<f64>,
        ..
        /// Where they meet, or what separates them.
        pub contact: ContactRecord,
    }
}

record! {
    /// Where convex bodies meet along a direction, or what separates them.
    #[non_exhaustive]
    pub struct ContactRecord {
        /// First contact.
        pub translation: Option<f64>,
        /// Proven.
        pub translation_bounds: Option<[f64; 2]>,
        /// Last contact.
        pub exit: Option<f64>,
        /// Proven: beyond the second they never meet.
        pub exit_bounds: Option<[f64; 2]>,
        /// Unit normal from the moving to the fixed body: of the contact plane, or of the separating one.
        pub normal: Option<[f64; 3]>,
        /// The contact point on the fixed body, in the world.
        pub point: Option<[f64; 3]>,
        /// What rounding alone can make of the bounds' difference.
        pub rounding: Option<f64>,
        /// The gap that is kept, a length: the bodies count as meeting where they are as near as that.
        pub keep: Option<f64>,
        /// What touches.
        pub features: Option<FeaturesRecord>,
        /// Separated: the gap between the shadows along the normal.
        pub margin: Option<f64>,
        /// Grazing, slides: by how much the shadows overlap; negative where they may not.
        pub overlap: Option<f64>,
        /// Grazing, slides: the unit vector along which they do, across the direction, from the moving
        /// body's shadow to the fixed one's.
        pub sideways: Option<[f64; 3]>,
        /// Which solver found it.
        pub solver: Option<Solver>,
        /// How much work it was.
        pub steps: Option<Steps>,
    }
}

record! {
    /// How far a solid can move along a direction before another one blocks it.
    #[non_exhaustive]
    pub struct SolidClearanceRecord {
        /// How the query ended.
        pub outcome: Ending,
        /// Of one query among several directions: the direction as it was read.
        pub direction: Option<[f64; 3]>,
        /// Blocked: how far it is safe to move.
        pub distance: Option<f64>,
        /// Where the facets that stop them meet in their true place.
        pub translation: Option<f64>,
        /// Proven.
        pub translation_bounds: Option<[f64; 2]>,
        /// How far they go, shrunk by half the tolerance each.
        pub shrunk_distance: Option<f64>,
        /// Proven.
        pub shrunk_distance_bounds: Option<[f64; 2]>,
        /// Last contact.
        pub exit: Option<f64>,
        /// Proven: beyond the second they never meet.
        pub exit_bounds: Option<[f64; 2]>,
        /// The name of what touches, or overlaps deepest, of a moving body that has several.
        pub moving: Option<String>,
        /// The name of what touches, or overlaps deepest, of a fixed body that has several.
        pub fixed: Option<String>,
        /// Unit normal of the contact plane, from the moving to the fixed body.
        pub normal: Option<[f64; 3]>,
        /// The contact point on the fixed body, in the world.
        pub point: Option<[f64; 3]>,
        /// The one that was used, a length.
        pub tolerance: Option<f64>,
        /// The gap that is kept, a length: the bodies count as meeting where they are as near as that.
        pub keep: Option<f64>,
        /// What overlaps now.
        pub start_overlaps: Vec<StartOverlapRecord>,
        /// Which are open, at least in part.
        pub surfaces: Vec<&'static str>,
        /// What touches.
        pub features: Option<FeaturesRecord>,
    }
}

impl CastRecord {
    /// Of [`Cast::first_contact`].
    pub fn of_outcome(outcome: &Outcome, cast: &Cast) -> Self {
        match outcome {
            Outcome::Contact(first) => Self::at(Ending::Contact, ContactRecord::of(first, cast)),
            Outcome::Grazing(first) => {
                Self::at(Ending::Grazing, ContactRecord::grazing(first, cast))
            }
            Outcome::Separated(separated) => {
                Self::at(Ending::Separated, ContactRecord::separated(separated, cast))
            }
        }
    }

    /// Of [`Cast::contact_range`].
    pub fn of_range(range: &ContactRange, cast: &Cast) -> Self {
        match range {
            ContactRange::Contact { first, last } => {
                Self::at(Ending::Contact, ContactRecord::of(first, cast).with_exit(last.exit()))
            }
            ContactRange::Grazing { first, last } => {
                let contact = ContactRecord::grazing(first, cast);
                Self::at(Ending::Grazing, contact.with_exit(last.contact.exit()))
            }
            ContactRange::Separated(separated) => {
                Self::at(Ending::Separated, ContactRecord::separated(separated, cast))
            }
        }
    }

    fn at(outcome: Ending, contact: ContactRecord) -> Self {
        Self { outcome, direction: None, contact }
    }
}

impl ClearanceRecord {
    /// Of [`Cast::clearance`] between convex bodies.
    pub fn of(clearance: &Clearance, cast: &Cast) -> Self {
        let at = |outcome, contact| Self { outcome, contact, ..Self::default() };
        match clearance {
            Clearance::Blocked { distance, contact } => {
                let record = at(Ending::Blocked, ContactRecord::of(contact, cast));
                Self { distance: Some(*distance), ..record }
            }
            Clearance::Free(WhyFree::Slides(grazing)) => {
                at(Ending::Slides, ContactRecord::grazing(grazing, cast))
            }
            // The last contact is the first one of the way back.
            Clearance::Free(WhyFree::Behind(last)) => {
                let contact = ContactRecord::of(last, &cast.reversed()).with_exit(last.exit());
                let (translation, translation_bounds) = (None, None);
                at(Ending::Behind, ContactRecord { translation, translation_bounds, ..contact })
            }
            Clearance::Free(WhyFree::Separated(separated)) => {
                at(Ending::Separated, ContactRecord::separated(separated, cast))
            }
            Clearance::Overlapping(OverlapAhead { first, last }) => {
                let contact = ContactRecord::of(first, cast).with_exit(last.exit());
                let [back, on] = [first, last].map(|contact| Some(-contact.certificate.lower));
                Self { back, on, ..at(Ending::Overlapping, contact) }
            }
        }
    }
}

impl ContactRecord {
    fn of(contact: &Contact, cast: &Cast) -> Self {
        let features = contact.features(cast);
        let translation = contact.bounded();
        Self {
            translation: Some(translation.value),
            translation_bounds: Some(translation.bounds()),
            normal: Some(coordinates(contact.normal)),
            point: Some(coordinates(contact.points(cast).on_fixed)),
            rounding: Some(contact.certificate.rounding),
            keep: kept(cast.options().keep),
            features: Some(FeaturesRecord::of(features, [cast.moving(), cast.fixed()])),
            solver: Some(contact.solver),
            steps: Some(contact.steps),
            ..Self::default()
        }
    }

    fn grazing(grazing: &Grazing, cast: &Cast) -> Self {
        Self {
            overlap: Some(grazing.overlap),
            sideways: Some(coordinates(grazing.separating_direction)),
            ..Self::of(&grazing.contact, cast)
        }
    }

    fn separated(separated: &Separated, cast: &Cast) -> Self {
        let Separated { certificate, solver, steps, .. } = separated;
        Self {
            normal: Some(coordinates(certificate.normal)),
            keep: kept(cast.options().keep),
            margin: Some(certificate.margin),
            solver: Some(*solver),
            steps: Some(*steps),
            ..Self::default()
        }
    }

    fn with_exit(self, exit: Bounded) -> Self {
        Self { exit: Some(exit.value), exit_bounds: Some(exit.bounds()), ..self }
    }
}

impl SolidClearanceRecord {
    /// Of [`Cast::clearance`] between solids; `exit` as `SolidCast::exit` says.
    pub fn of(clearance: &Clearance<Solid>, exit: Option<Bounded>, cast: &Cast<'_, Solid>) -> Self {
        let record = Self {
            exit: exit.map(|exit| exit.value),
            exit_bounds: exit.map(|exit| exit.bounds()),
            tolerance: Some(cast.tolerance()),
            keep: kept(cast.options().keep),
            surfaces: open_ones(cast.moving(), cast.fixed()),
            ..Self::default()
        };
        match clearance {
            Clearance::Free(_) => Self { outcome: Ending::Free, ..record },
            Clearance::Overlapping(overlap) => Self {
                outcome: Ending::Overlapping,
                start_overlaps: StartOverlapRecord::parted_by(overlap.least_tolerance),
                ..record
            },
            Clearance::Blocked { distance, contact } => Self {
                outcome: Ending::Blocked,
                distance: Some(*distance),
                translation: Some(contact.translation.value),
                translation_bounds: Some(contact.translation.bounds()),
                shrunk_distance: Some(contact.shrunk_distance.value),
                shrunk_distance_bounds: Some(contact.shrunk_distance.bounds()),
                normal: Some(coordinates(contact.normal)),
                point: Some(coordinates(contact.point_on_fixed)),
                features: Some(FeaturesRecord::of(
                    Features { moving: contact.moving_feature, fixed: contact.fixed_feature },
                    [cast.moving(), cast.fixed()],
                )),
                ..record
            },
        }
    }
}
