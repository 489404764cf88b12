//! All directions along which a body leaves, and the proof.

use colltrans::free::{FreeDirections, FreeError, FreeOptions};
use colltrans::record::FreeRecord;
use colltrans::solid::SolidCast;
use colltrans::{Pose, ProofFile, Solid};

use super::{Body, PartsQuery, refused};
use crate::failure::{Code, Failure};

/// Two bodies where they are.
#[derive(Clone, Copy)]
pub(crate) struct PartsFree<'a> {
    pub(crate) bodies: [&'a Body; 2],
    pub(crate) poses: [Pose; 2],
    /// `None` for what the files' precision asks for.
    pub(crate) tolerance: Option<f64>,
    pub(crate) ignore_start_overlaps: bool,
    pub(crate) options: FreeOptions,
}

/// What can be said, with its proof where it was asked for.
pub(crate) struct FreeAnswer {
    pub(crate) record: FreeRecord,
    /// What could not be shrunk as the tolerance asks for.
    pub(crate) notes: Vec<String>,
    pub(crate) proof: Option<ProofFile>,
}

impl PartsFree<'_> {
    pub(crate) fn ask(&self, with_proof: bool) -> Result<FreeAnswer, Failure> {
        let query = self.query();
        let cast = query.of_bodies().map_err(|e| refused(e, self.bodies, self.tolerance))?;
        let tolerance = cast.tolerance();
        let notes = query.unshrunk(tolerance);
        let options =
            self.options.with_tolerance(tolerance).with_start_overlap(cast.options().start_overlap);
        let [moving, fixed] = [0, 1].map(|k| self.bodies[k].solid().at(self.poses[k]));
        let free = match FreeDirections::of(&moving, &fixed, options) {
            Err(FreeError::Overlapping { .. }) => {
                let overlaps = query.overlaps(tolerance, || ())?;
                let record = FreeRecord::overlapping(tolerance, overlaps);
                return Ok(FreeAnswer { record, notes, proof: None });
            }
            free => free?,
        };
        let name = |k: usize, triangle| self.bodies[k].owner(triangle);
        let record = FreeRecord::of(&free, |pair| [name(0, pair[0]), name(1, pair[1])]);
        let proof = with_proof.then(|| {
            let [moving, fixed] = self.bodies.map(Body::solids);
            ProofFile::of_free_directions(&free, [&moving, &fixed])
        });
        let refused =
            |error: colltrans::ProofFileError| Failure::new(Code::Query, error.to_string());
        Ok(FreeAnswer { record, notes, proof: proof.transpose().map_err(refused)? })
    }

    /// The same bodies in a query whose direction plays no part.
    const fn query(&self) -> PartsQuery<'_> {
        PartsQuery {
            ignore_start_overlaps: self.ignore_start_overlaps,
            ..PartsQuery::placed(self.bodies, self.poses, self.tolerance)
        }
    }
}

impl Body {
    /// The file that a triangle of the solid is of, where there are several.
    fn owner(&self, triangle: u32) -> Option<String> {
        if self.pieces.len() == 1 {
            return None;
        }
        let mut facet = self.solid().facet_indices().get(triangle as usize)?.0;
        let of = |piece: &&super::Piece| {
            let [_, count]: [u32; 2] = Solid::input_counts(&piece.solid);
            let own = facet < count;
            facet = facet.wrapping_sub(count);
            own
        };
        self.pieces.iter().find(of).map(super::Piece::name)
    }
}
