//! `assembly --free`: all directions along which groups of parts can leave the others.

use std::fmt::Write as _;
use std::sync::atomic::AtomicBool;

use colltrans::ProofFile;
use colltrans::record::FreeRecord;
use colltrans::removal::directions::FreeOptions;
use colltrans_assembly::Bodies;
use colltrans_assembly::free::RemovalPair;
use serde_json::{Value, json};

use crate::directions;
use crate::failure::{Code, Failure};
use crate::terminal::escape_line;

/// The removal directions of a group.
pub(super) struct GroupRemoval {
    /// The group as the option names it.
    pub(super) name: String,
    parts: Vec<String>,
    record: FreeRecord,
    /// A proof about the offset parts, in which the group and the others are one body each.
    pub(super) proof: Option<ProofFile>,
}

/// Computes the removal directions of all groups, and their proofs if `with_proofs` is set.
///
/// # Errors
/// The query of a group fails, or a proof cannot be computed.
pub(super) fn group_removals(
    bodies: &Bodies,
    groups: Vec<(String, Vec<usize>)>,
    options: FreeOptions,
    with_proofs: bool,
) -> Result<Vec<GroupRemoval>, Failure> {
    let compute = |(name, group): (String, Vec<usize>)| {
        let removal = RemovalPair::new(bodies, &group)?;
        let free = removal.free_directions(options, &AtomicBool::new(false))?;
        let proof = with_proofs.then(|| {
            let [moving, fixed] = removal.solids();
            ProofFile::of_free_directions(&free, [&[moving], &[fixed]])
        });
        let proof_failure =
            |error: colltrans::ProofFileError| Failure::new(Code::Query, error.to_string());
        let parts = bodies.assembly().part_names(&group).into_iter().map(str::to_owned).collect();
        let record = removal.to_record(bodies, &free);
        Ok(GroupRemoval { name, parts, record, proof: proof.transpose().map_err(proof_failure)? })
    };
    groups.into_iter().map(compute).collect()
}

impl GroupRemoval {
    /// Returns the JSON object of the group.
    pub(super) fn json(&self) -> Value {
        let mut object = json!(self.record);
        object["parts"] = json!(self.parts);
        object
    }

    /// Appends the answer as text.
    pub(super) fn push_text(&self, text: &mut String) {
        let _ = writeln!(
            text,
            "free directions of {}: {}",
            escape_line(&self.name),
            self.record.outcome
        );
        directions::push_directions(text, &self.record);
    }
}
