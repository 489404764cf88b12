//! The questions about two placed bodies without a direction.

use colltrans::record::{Ending, PairQuestion, Record};
use colltrans::{Pair, Pose, ProofFile, ProofFileError, QueryError, Solid};

use super::{Body, PartsQuery, name_features};
use crate::failure::{Code, Failure};

/// A proof, where there is one; or why none could be made.
type Proven = Result<Option<ProofFile>, Failure>;

/// Two bodies where they are.
#[derive(Clone, Copy)]
pub(crate) struct PartsPair<'a> {
    pub(crate) bodies: [&'a Body; 2],
    pub(crate) poses: [Pose; 2],
}

impl<'a> PartsPair<'a> {
    /// The answer, with the names of files.
    pub(crate) fn ask(&self, question: PairQuestion) -> Result<Record, QueryError> {
        let pair = self.pair()?;
        self.named(question.ask_solids(&pair)?.record(&pair)?)
    }

    /// The same by the same search, and the proof of a distance, or of its comparison with a length.
    pub(crate) fn prove(&self, question: PairQuestion) -> Result<(Record, Proven), QueryError> {
        let [moving, fixed] = self.bodies.map(Body::solids);
        let pair = self.pair()?;
        match question.prove_solids(&pair, [&moving, &fixed]) {
            Ok((answer, proof)) => Ok((self.named(answer.record(&pair)?)?, Ok(proof))),
            Err(ProofFileError::Query(error)) => Err(error),
            Err(error) => {
                let failed = Failure::new(Code::Query, error.to_string());
                Ok((self.ask(question)?, Err(failed)))
            }
        }
    }

    fn named(&self, mut record: Record) -> Result<Record, QueryError> {
        match &mut record {
            Record::Distance(of) => {
                [of.moving, of.fixed] = name_features(self.bodies, &mut of.features);
            }
            Record::Depth(of) if of.outcome == Ending::Overlapping => {
                of.start_overlaps = self.clearance().overlaps(0.0, || ())?;
                let deepest = of.start_overlaps.first();
                (of.moving, of.fixed) =
                    deepest.map_or((None, None), |of| (of.moving.clone(), of.fixed.clone()));
            }
            _ => {}
        }
        Ok(record)
    }

    /// How far lengths may be off by the precision of the files and by rounding.
    pub(crate) fn error(&self) -> f64 {
        self.clearance().error()
    }

    fn pair(&self) -> Result<Pair<'a, Solid>, QueryError> {
        let [moving, fixed] = [0, 1].map(|k| self.bodies[k].solid().at(self.poses[k]));
        Pair::new(moving, fixed)
    }

    /// The same bodies, as they are, in a query whose direction plays no part.
    const fn clearance(&self) -> PartsQuery<'a> {
        PartsQuery::placed(self.bodies, self.poses, Some(0.0))
    }
}
