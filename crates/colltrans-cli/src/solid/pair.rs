//! Distances and depths of two placed bodies of parts.

use colltrans::record::{Ending, PairQuestion, Record};
use colltrans::solid::VolumeOptions;
use colltrans::{Pair, Pose, ProofFile, ProofFileError, QueryError, Solid};

use super::{Body, PartsQuery, extent, renumber_features};
use crate::distance::Accuracy;
use crate::failure::{Code, Failure};

/// The proof, or the failure of computing it.
type ProofResult = Result<ProofFile, Failure>;

/// Two placed bodies.
#[derive(Clone, Copy)]
pub(crate) struct PartsPair<'a> {
    pub(crate) bodies: [&'a Body; 2],
    pub(crate) poses: [Pose; 2],
}

impl<'a> PartsPair<'a> {
    /// Answers the question, with the names of files.
    pub(crate) fn answer(&self, question: PairQuestion) -> Result<Record, QueryError> {
        let pair = self.pair()?;
        self.with_names(question.answer_solids(&pair)?.record(&pair)?)
    }

    /// Answers the question, and proves the distance, its comparison with a length, or the length of the shortest
    /// separating translation.
    ///
    /// # Errors
    /// The query fails. A failure of the proof is part of the result.
    pub(crate) fn prove(
        &self,
        question: PairQuestion,
    ) -> Result<(Record, ProofResult), QueryError> {
        let [moving, fixed] = self.bodies.map(Body::solids);
        let pair = self.pair()?;
        match question.prove_solids(&pair, [&moving, &fixed]) {
            Ok((answer, proof)) => Ok((self.with_names(answer.record(&pair)?)?, Ok(proof))),
            Err(ProofFileError::Query(error)) => Err(error),
            Err(error) => {
                let failed = Failure::new(Code::Query, error.to_string());
                Ok((self.answer(question)?, Err(failed)))
            }
        }
    }

    /// Answers the question, and proves the common part.
    ///
    /// # Errors
    /// The query fails. A failure of the proof is part of the result.
    pub(crate) fn prove_common_part(
        &self,
        question: PairQuestion,
    ) -> Result<(Record, ProofResult), QueryError> {
        let [moving, fixed] = self.bodies.map(Body::solids);
        let options = VolumeOptions::default();
        let proof = ProofFile::of_solid_common_part(&self.pair()?, [&moving, &fixed], options);
        let proof = proof.map_err(|error| Failure::new(Code::Query, error.to_string()));
        Ok((self.answer(question)?, proof))
    }

    /// Adds the names of files to a record.
    fn with_names(&self, mut record: Record) -> Result<Record, QueryError> {
        match &mut record {
            Record::Distance(of) => {
                [of.moving, of.fixed] = renumber_features(self.bodies, &mut of.features);
            }
            Record::Depth(of) if of.outcome == Ending::Overlapping => {
                of.start_overlaps = self.parts_query().start_overlaps(0.0, || ())?;
                let deepest = of.start_overlaps.first();
                (of.moving, of.fixed) =
                    deepest.map_or((None, None), |of| (of.moving.clone(), of.fixed.clone()));
            }
            _ => {}
        }
        Ok(record)
    }

    /// Returns the accuracy of the answer.
    pub(crate) fn accuracy(&self) -> Accuracy {
        Accuracy { error: self.parts_query().length_error(), extent: extent(self.bodies) }
    }

    /// Returns the pair of the library.
    fn pair(&self) -> Result<Pair<'a, Solid>, QueryError> {
        let [moving, fixed] = [0, 1].map(|k| self.bodies[k].solid().at(self.poses[k]));
        Pair::new(moving, fixed)
    }

    /// Returns a query of the nominal bodies whose direction does not matter.
    const fn parts_query(&self) -> PartsQuery<'a> {
        PartsQuery::without_direction(self.bodies, self.poses, Some(0.0))
    }
}
