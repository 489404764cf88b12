//! The question between two bodies made of parts that turn.

use colltrans::motion::{Motion, MotionCast};
use colltrans::record::{Ending, MotionRecord};
use colltrans::solid::StartOverlap;
use colltrans::{QueryError, Solid};
use colltrans_mesh::body::between_motions;

use super::{Body, PartsQuery, name_features};

/// Two bodies and what they do.
#[derive(Clone, Copy)]
pub(crate) struct PartsMotion<'a> {
    pub(crate) bodies: [&'a Body; 2],
    pub(crate) motions: &'a [Motion; 2],
    /// `None` for what the files' precision asks for.
    pub(crate) tolerance: Option<f64>,
    /// Whether it is asked how far they can go.
    pub(crate) clears: bool,
    pub(crate) ignore_start_overlaps: bool,
    /// The gap to be kept, or 0.
    pub(crate) keep: f64,
}

impl PartsMotion<'_> {
    /// The answer, with the names of files: the first contact, or how far they can go; that too where what overlaps when
    /// the motion begins is ignored, and what that is.
    pub(crate) fn ask(&self) -> Result<MotionRecord, QueryError> {
        let cast = self.cast()?;
        let mut record = if self.clears || self.ignore_start_overlaps {
            self.clearance(cast)?
        } else {
            MotionRecord::of_solids(&cast.first_contact()?, &cast)
        };
        [record.moving, record.fixed] = name_features(self.bodies, &mut record.features);
        Ok(record)
    }

    fn clearance(&self, cast: MotionCast<'_, Solid>) -> Result<MotionRecord, QueryError> {
        let ignores = self.ignore_start_overlaps;
        let start = if ignores { StartOverlap::Ignore } else { StartOverlap::Refuse };
        let cast = cast.with_start_overlap(start);
        let mut record = MotionRecord::of_solid_clearance(&cast.clearance()?, &cast);
        if record.outcome == Ending::Blocked && !self.clears {
            let is_proven = record.time.is_some_and(|time| time.upper.is_some());
            record.outcome = if is_proven { Ending::Contact } else { Ending::Grazing };
        }
        if ignores || record.outcome == Ending::Overlapping {
            record.start_overlaps = self.start().overlaps(cast.tolerance(), || ())?;
        }
        Ok(record)
    }

    /// The question as the library has it.
    pub(crate) fn cast(&self) -> Result<MotionCast<'_, Solid>, QueryError> {
        let [moving, fixed] = [0, 1].map(|k| self.bodies[k].solid().along(&self.motions[k]));
        let precisions = self.bodies.map(Body::precision);
        between_motions(moving, fixed, precisions, self.tolerance)?.keeping(self.keep)
    }

    /// The bodies where the motion begins; of no direction.
    fn start(&self) -> PartsQuery<'_> {
        let poses = self.motions.each_ref().map(Motion::start);
        PartsQuery { keep: self.keep, ..PartsQuery::placed(self.bodies, poses, self.tolerance) }
    }
}
