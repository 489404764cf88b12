//! Motions of two bodies of parts.

use colltrans::motion::{Motion, MotionCast};
use colltrans::record::{Ending, MotionRecord};
use colltrans::solid::StartOverlap;
use colltrans::{QueryError, Solid};
use colltrans_mesh::body::between_motions;

use super::{Body, PartsQuery, renumber_features};

/// The query of two bodies and their motions.
#[derive(Clone, Copy)]
pub(crate) struct PartsMotion<'a> {
    pub(crate) bodies: [&'a Body; 2],
    pub(crate) motions: &'a [Motion; 2],
    /// `None` for the default, which follows from the precision of the files.
    pub(crate) tolerance: Option<f64>,
    /// Whether the query is how far they can move, instead of their first contact.
    pub(crate) clears: bool,
    pub(crate) ignore_start_overlaps: bool,
    /// The minimum gap, or 0.
    pub(crate) min_gap: f64,
}

impl PartsMotion<'_> {
    /// Answers the query, with the names of files. If overlaps at the start are ignored, the first contact is computed as
    /// a clearance, and the record lists these overlaps.
    pub(crate) fn answer(&self) -> Result<MotionRecord, QueryError> {
        let cast = self.cast()?;
        let mut record = if self.clears || self.ignore_start_overlaps {
            self.clearance_record(cast)?
        } else {
            MotionRecord::of_solids(&cast.first_contact()?, &cast)
        };
        [record.moving, record.fixed] = renumber_features(self.bodies, &mut record.features);
        Ok(record)
    }

    /// Returns the record of a clearance. Without `clears` its outcome is that of a first contact.
    fn clearance_record(&self, cast: MotionCast<'_, Solid>) -> Result<MotionRecord, QueryError> {
        let ignores = self.ignore_start_overlaps;
        let start = if ignores { StartOverlap::Ignore } else { StartOverlap::Refuse };
        let cast = cast.with_start_overlap(start);
        let mut record = MotionRecord::of_solid_clearance(&cast.clearance()?, &cast);
        if record.outcome == Ending::Blocked && !self.clears {
            let is_proven = record.time.is_some_and(|time| time.upper.is_some());
            record.outcome = if is_proven { Ending::Contact } else { Ending::Grazing };
        }
        if ignores || record.outcome == Ending::Overlapping {
            record.start_overlaps =
                self.query_at_start().start_overlaps(cast.tolerance(), || ())?;
        }
        Ok(record)
    }

    /// Returns the cast of the library.
    pub(crate) fn cast(&self) -> Result<MotionCast<'_, Solid>, QueryError> {
        let [moving, fixed] = [0, 1].map(|k| self.bodies[k].solid().with_motion(&self.motions[k]));
        let precisions = self.bodies.map(Body::precision);
        between_motions(moving, fixed, precisions, self.tolerance)?.with_min_gap(self.min_gap)
    }

    /// Returns a query at the start of the motions whose direction does not matter.
    fn query_at_start(&self) -> PartsQuery<'_> {
        let poses = self.motions.each_ref().map(Motion::start_pose);
        PartsQuery {
            min_gap: self.min_gap,
            ..PartsQuery::without_direction(self.bodies, poses, self.tolerance)
        }
    }
}
