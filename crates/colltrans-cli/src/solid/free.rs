//! All directions along which a body of parts can leave another, and the proof.

use colltrans::record::FreeRecord;
use colltrans::removal::directions::{FreeDirections, FreeError, FreeOptions};
use colltrans::solid::SolidCast;
use colltrans::{Pose, ProofFile, Solid};

use super::{Body, PartsQuery, query_failure};
use crate::failure::{Code, Failure};

/// The query of all removal directions of two placed bodies.
#[derive(Clone, Copy)]
pub(crate) struct PartsDirections<'a> {
    pub(crate) bodies: [&'a Body; 2],
    pub(crate) poses: [Pose; 2],
    /// `None` for the default, which follows from the precision of the files.
    pub(crate) tolerance: Option<f64>,
    pub(crate) ignore_start_overlaps: bool,
    pub(crate) options: FreeOptions,
}

/// The answer, with its proof if it was requested.
pub(crate) struct DirectionsAnswer {
    pub(crate) record: FreeRecord,
    /// Notes about surfaces that cannot be offset by the tolerance.
    pub(crate) notes: Vec<String>,
    pub(crate) proof: Option<ProofFile>,
}

impl PartsDirections<'_> {
    /// Answers the query, and proves the answer if `with_proof` is set.
    ///
    /// # Errors
    /// The query fails, or the proof cannot be computed. Bodies that overlap have an answer without a proof.
    pub(crate) fn answer(&self, with_proof: bool) -> Result<DirectionsAnswer, Failure> {
        let query = self.parts_query();
        let cast =
            query.cast_of_bodies().map_err(|e| query_failure(e, self.bodies, self.tolerance))?;
        let tolerance = cast.tolerance();
        let notes = query.offset_notes(tolerance);
        let options =
            self.options.with_tolerance(tolerance).with_start_overlap(cast.options().start_overlap);
        let [moving, fixed] = [0, 1].map(|k| self.bodies[k].solid().at(self.poses[k]));
        let free = match FreeDirections::compute(&moving, &fixed, options) {
            Err(FreeError::Overlapping { .. }) => {
                let overlaps = query.start_overlaps(tolerance, || ())?;
                let record = FreeRecord::overlapping(tolerance, overlaps);
                return Ok(DirectionsAnswer { record, notes, proof: None });
            }
            free => free?,
        };
        let name = |k: usize, triangle| self.bodies[k].file_of_triangle(triangle);
        let record =
            FreeRecord::from_directions(&free, |pair| [name(0, pair[0]), name(1, pair[1])]);
        let proof = with_proof.then(|| {
            let [moving, fixed] = self.bodies.map(Body::solids);
            ProofFile::of_free_directions(&free, [&moving, &fixed])
        });
        let proof_failure =
            |error: colltrans::ProofFileError| Failure::new(Code::Query, error.to_string());
        Ok(DirectionsAnswer { record, notes, proof: proof.transpose().map_err(proof_failure)? })
    }

    /// Returns a query of these bodies whose direction does not matter.
    const fn parts_query(&self) -> PartsQuery<'_> {
        PartsQuery {
            ignore_start_overlaps: self.ignore_start_overlaps,
            ..PartsQuery::without_direction(self.bodies, self.poses, self.tolerance)
        }
    }
}

impl Body {
    /// Returns the name of the file that has a triangle of the solid; `None` if there is only one file.
    fn file_of_triangle(&self, triangle: u32) -> Option<String> {
        if self.pieces.len() == 1 {
            return None;
        }
        let mut facet = self.solid().facet_indices().get(triangle as usize)?.0;
        let has_facet = |piece: &&super::Piece| {
            let [_, count]: [u32; 2] = Solid::input_counts(&piece.solid);
            let is_own = facet < count;
            facet = facet.wrapping_sub(count);
            is_own
        };
        self.pieces.iter().find(has_facet).map(super::Piece::name)
    }
}
