//! Proofs as files: what `--save-proof` writes and `colltrans verify` checks.

use std::path::Path;

use colltrans::free::FreeDirections;
use colltrans::record::FreeRecord;
use colltrans::{CertificateError, DistanceStatement, ProofFile, Statement};
use serde_json::{Map, Value, json};

use crate::args::VerifyArguments;
use crate::directions;
use crate::failure::{Code, Failure, print, print_json};
use crate::inputs::refuse_overwriting;
use crate::outputs;

/// A proof must not take the place of what is read, nor of the picture.
pub(crate) fn refuse_proof(
    proof: Option<&Path>,
    picture: Option<&Path>,
    inputs: &[&Path],
) -> Result<(), Failure> {
    let Some(proof) = proof else { return Ok(()) };
    if picture == Some(proof) {
        return Err(Failure::new(Code::Usage, "--save-proof and --picture name one file"));
    }
    refuse_overwriting(proof, inputs, "give the proof another name")
}

pub(crate) fn save(path: &Path, proof: &ProofFile) -> Result<(), Failure> {
    outputs::write(path, format!("{}\n", proof.to_json()).as_bytes())
}

pub(crate) fn verify(arguments: &VerifyArguments) -> Result<(), Failure> {
    let place = arguments.proof.display();
    let input = |what: String| Failure::new(Code::Input, format!("{place}: {what}"));
    let text = colltrans_mesh::file::text(&arguments.proof)
        .map_err(|error| input(format!("cannot be read: {error}")))?;
    let proof = ProofFile::from_json(&text).map_err(|error| input(error.to_string()))?;
    match checked(&proof) {
        Ok(free) if arguments.json => print_json(&format!("{}\n", told(&proof, free.as_ref()))),
        Ok(None) => print(&format!("holds: {proof}\n")),
        Ok(Some(free)) => print(&format!("holds: {proof}: {}\n", directions::verified(&free))),
        Err(error) => {
            if arguments.json {
                let told = json!({ "holds": false, "message": error.to_string() });
                print_json(&format!("{told}\n"))?;
            }
            Err(Failure::new(Code::Refused, format!("{place}: the proof does not hold: {error}")))
        }
    }
}

/// Checks it; what it says of all directions, if that is what it is about.
fn checked(proof: &ProofFile) -> Result<Option<FreeRecord>, CertificateError> {
    let record = |free: FreeDirections<'_>| FreeRecord::of(&free, |_| [None, None]);
    match proof.free_directions() {
        Some(free) => Ok(Some(record(free?))),
        None => proof.check().map(|()| None),
    }
}

/// What is proven, in the fields of answers.
fn told(proof: &ProofFile, free: Option<&FreeRecord>) -> Value {
    let mut fields = Map::new();
    let mut say = |name: &str, value: Value| fields.insert(name.into(), value);
    say("holds", json!(true));
    match proof.statement() {
        Statement::Contacts(contacts) => {
            let [first, last] = contacts.bounds();
            first.map(|bounds| say("translation_bounds", json!(bounds)));
            last.map(|bounds| say("exit_bounds", json!(bounds)));
            contacts.slide.map(|slide| say("overlap", json!(slide.overlap)));
        }
        Statement::Separation(separation) => {
            say("margin", json!(separation.margin));
        }
        Statement::Clearance(statement) => {
            say("tolerance", json!(statement.certificate.tolerance));
            if let Some(stop) = statement.stop {
                say("translation_bounds", json!(stop.translation.bounds()));
                say("facets", json!(stop.facets));
            }
            statement.separation.map(|plane| say("margin", json!(plane.margin)));
            let inverted = proof.inverted();
            (inverted != [0; 2]).then(|| say("inverted", json!(inverted)));
        }
        Statement::Distance(DistanceStatement { gap, near }) => {
            gap.map(|gap| say("lower", json!(gap.gap)));
            near.map(|near| say("upper", json!(near.distance)));
        }
        Statement::Depth(depth) => {
            say("lower", json!(depth.lower));
            say("upper", json!(depth.upper));
        }
        Statement::SolidDistance(proof) => {
            say("lower", json!(proof.lower));
            say("upper", json!(proof.near.distance()));
        }
        Statement::FreeDirections(of) => {
            say("tolerance", json!(of.tolerance));
            free.map(|free| say("outcome", json!(free.outcome)));
            free.map(|free| say("free_share", json!(free.free_share)));
            free.map(|free| say("undecided_share", json!(free.undecided_share)));
        }
    }
    say("statement", json!(proof.to_string()));
    Value::Object(fields)
}
