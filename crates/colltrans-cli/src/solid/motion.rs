//! The question between two bodies made of parts that turn.

use colltrans::QueryError;
use colltrans::motion::Motion;
use colltrans::record::{FeaturesRecord, Record};
use colltrans_mesh::body::between_motions;

use super::Body;

/// Two bodies and what they do.
#[derive(Clone, Copy)]
pub(crate) struct PartsMotion<'a> {
    pub(crate) bodies: [&'a Body; 2],
    pub(crate) motions: &'a [Motion; 2],
    /// `None` for what the files' precision asks for.
    pub(crate) tolerance: Option<f64>,
    /// The gap to be kept, or 0.
    pub(crate) keep: f64,
}

impl PartsMotion<'_> {
    /// The answer, with the names of files.
    pub(crate) fn ask(&self) -> Result<Record, QueryError> {
        let [moving, fixed] = [0, 1].map(|k| self.bodies[k].solid().along(&self.motions[k]));
        let precisions = self.bodies.map(Body::precision);
        let cast = between_motions(moving, fixed, precisions, self.tolerance)?;
        let cast = cast.keeping(self.keep)?;
        let mut record = Record::of_solid_motion(&cast.first_contact()?, &cast);
        if let Some(FeaturesRecord { moving, fixed }) = &mut record.features {
            record.moving = Some(self.bodies[0].renumber(moving));
            record.fixed = Some(self.bodies[1].renumber(fixed));
        }
        Ok(record)
    }
}
