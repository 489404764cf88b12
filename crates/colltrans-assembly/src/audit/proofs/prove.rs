//! Computes the proof files of an audit.

use colltrans::solid::{SolidError, VolumeOptions};
use colltrans::{Pair, Pose, ProofFile, ProofFileError, Solid};
use colltrans_mesh::plain::file_name_part;
use rayon::prelude::*;

use super::{PairProof, ProofClaim};
use crate::audit::{Audit, AuditedPair, PairFinding};
use crate::error::AssemblyError;
use crate::part::{Assembly, Part};
use crate::watch::{Stage, Watch};

/// Maximum number of bytes of the name of a part in that of a file.
const MAX_NAME_BYTES: usize = 60;
/// Minimum number of digits of the number of a pair in the name of a file.
const MIN_DIGITS: usize = 3;

impl ProofClaim {
    /// Returns the claims about a finding.
    fn of_finding(finding: &PairFinding) -> &'static [Self] {
        match finding {
            PairFinding::Apart(_) => &[Self::Distance],
            PairFinding::Touching(_) => &[Self::Distance, Self::Depth],
            PairFinding::Interfering(found)
            | PairFinding::Contained { interference: found, .. } => match found.known_depth() {
                Some(_) => &[Self::Depth, Self::CommonPart],
                None => &[Self::Distance],
            },
        }
    }

    /// Proves the claim.
    fn prove(
        self,
        solids: [&Solid; 2],
        pieces: [&[Solid]; 2],
        volume: VolumeOptions,
    ) -> Result<ProofFile, ProofFileError> {
        let pair = Pair::new(solids[0].at(Pose::IDENTITY), solids[1].at(Pose::IDENTITY))?;
        let [a, b] = pieces.map(|all| all.iter().collect::<Vec<_>>());
        match self {
            Self::Distance => ProofFile::of_solid_distance(&pair, [&a, &b], None),
            Self::Depth => ProofFile::of_solid_depth(&pair, [&a, &b]),
            Self::CommonPart => ProofFile::of_solid_common_part(&pair, [&a, &b], volume),
        }
    }
}

/// Proves all findings of an audit, and passes the name and the text of each proof to `write`, from any thread. Stores
/// the names in [`AuditedPair::proofs`].
///
/// Names are `NUMBER-FIRST--SECOND-CLAIM.json` with the position of the pair in the audit, from 1 on. Characters of the
/// names of parts that a file name may not have are replaced.
///
/// # Errors
/// Returns the first error of `write`, and [`AssemblyError::Cancelled`].
pub fn prove_pairs<E: From<AssemblyError> + Send>(
    assembly: &Assembly,
    audit: &mut Audit,
    volume: VolumeOptions,
    watch: Watch,
    write: impl Fn(&str, &str) -> Result<(), E> + Sync,
) -> Result<(), E> {
    let tally = watch.start_stage(Stage::Proofs, audit.pairs.len());
    let digits = audit.pairs.len().to_string().len().max(MIN_DIGITS);
    let prove = |(k, pair): (usize, &mut AuditedPair)| {
        let parts = pair.parts.map(|part| &assembly.parts()[part]);
        let [first, second] = parts.map(|part| file_name_part(part.name(), MAX_NAME_BYTES));
        let solids = parts.map(Part::solid);
        let [a, b] = solids.map(Solid::to_pieces);
        let pieces = a.and_then(|a| Ok([a, b?])).map_err(|error: SolidError| error.to_string());
        for &claim in ProofClaim::of_finding(&pair.finding) {
            let proof = pieces.as_ref().map_err(Clone::clone).and_then(|[a, b]| {
                claim.prove(solids, [a, b], volume).map_err(|error| error.to_string())
            });
            let file = match proof {
                Ok(proof) => {
                    let number = k + 1;
                    let name = format!("{number:0digits$}-{first}--{second}-{}.json", claim.name());
                    write(&name, &proof.to_json())?;
                    Ok(name)
                }
                Err(reason) => Err(reason),
            };
            pair.proofs.push(PairProof { claim, file });
        }
        Ok(tally.finish_item()?)
    };
    audit.pairs.par_iter_mut().enumerate().try_for_each(prove)
}
