//! `assembly --free`: all directions along which parts leave the others.

use std::fmt::Write as _;
use std::sync::atomic::AtomicBool;

use colltrans::ProofFile;
use colltrans::free::FreeOptions;
use colltrans::record::FreeRecord;
use colltrans_assembly::Bodies;
use colltrans_assembly::free::Removal;
use serde_json::{Value, json};

use crate::directions;
use crate::failure::{Code, Failure};
use crate::terminal::shown;

/// What is said of a group.
pub(super) struct Leaving {
    /// As it was asked for.
    pub(super) name: String,
    parts: Vec<String>,
    record: FreeRecord,
    /// About the parts as they are asked: shrunk, the group and the others as a body each.
    pub(super) proof: Option<ProofFile>,
}

/// What is said of all groups; with proofs if they are written.
pub(super) fn all(
    bodies: &Bodies,
    groups: Vec<(String, Vec<usize>)>,
    options: FreeOptions,
    with_proofs: bool,
) -> Result<Vec<Leaving>, Failure> {
    let of = |(name, group): (String, Vec<usize>)| {
        let removal = Removal::new(bodies, &group)?;
        let free = removal.directions(options, &AtomicBool::new(false))?;
        let proof = with_proofs.then(|| {
            let [moving, fixed] = removal.solids();
            ProofFile::of_free_directions(&free, [&[moving], &[fixed]])
        });
        let refused =
            |error: colltrans::ProofFileError| Failure::new(Code::Query, error.to_string());
        let parts = bodies.assembly().names(&group).into_iter().map(str::to_owned).collect();
        let record = removal.record(bodies, &free);
        Ok(Leaving { name, parts, record, proof: proof.transpose().map_err(refused)? })
    };
    groups.into_iter().map(of).collect()
}

impl Leaving {
    pub(super) fn json(&self) -> Value {
        let mut told = json!(self.record);
        told["parts"] = json!(self.parts);
        told
    }

    /// A few lines for people.
    pub(super) fn tell(&self, text: &mut String) {
        let _ = writeln!(text, "free directions of {}: {}", shown(&self.name), self.record.outcome);
        directions::told(text, &self.record);
    }
}
