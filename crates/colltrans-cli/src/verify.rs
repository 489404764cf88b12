//! `colltrans verify`: checks the proofs that `--save-proof` writes.

use std::fmt::Write as _;
use std::path::Path;

use colltrans::record::FreeRecord;
use colltrans::{AnyNear, DistanceStatement, ProofFile, Proven, Statement};
use serde_json::{Map, Value, json};

use crate::args::VerifyArguments;
use crate::directions;
use crate::failure::{Code, Failure, print, print_json};
use crate::inputs::read_text;
use crate::terminal::escape_line;

/// Checks proofs, and prints their statements. Files after one that fails are checked, too.
///
/// # Errors
/// A file cannot be read, or its proof does not hold.
pub(crate) fn run(arguments: &VerifyArguments) -> Result<(), Failure> {
    let VerifyArguments { proofs, json } = arguments;
    if let [file] = &proofs[..] {
        return verify(file, *json, false);
    }
    let mut failed = Vec::new();
    for file in proofs {
        match verify(file, *json, true) {
            Err(failure) if failure.code() == Code::Output => return Err(failure),
            Err(failure) => {
                failure.print_messages();
                failed.push(failure.code());
            }
            Ok(()) => {}
        }
    }
    // A proof that does not hold is more important than a file without one.
    let code = failed.iter().copied().find(|code| *code == Code::Refused);
    match code.or(failed.first().copied()) {
        None => Ok(()),
        Some(code) => {
            let (count, of) = (failed.len(), proofs.len());
            Err(Failure::new(code, format!("{count} of {of} files are not verified")))
        }
    }
}

/// Checks a proof, and prints its statement, after the name of the file if it is one of several.
fn verify(file: &Path, as_json: bool, is_one_of_several: bool) -> Result<(), Failure> {
    let place = file.display();
    let text = read_text(file)?;
    let proof = ProofFile::from_json(&text)
        .map_err(|error| Failure::new(Code::Input, format!("{place}: {error}")))?;
    let name = is_one_of_several.then(|| place.to_string());
    let print_object = |mut answer: Value| {
        if let Some(name) = &name {
            answer["file"] = json!(name);
        }
        print_json(&format!("{answer}\n"))
    };
    let proven = match proof.check() {
        Ok(proven) => proven,
        Err(error) => {
            let error = error.to_string();
            if as_json {
                print_object(json!({ "holds": false, "message": error }))?;
            }
            let message = format!("{place}: the proof does not hold: {error}");
            return Err(Failure::new(Code::Refused, message));
        }
    };
    let statement = proof.to_string();
    let free = match &proven {
        Proven::Directions(free) => Some(FreeRecord::from_directions(free, |_| [None, None])),
        _ => None,
    };
    if as_json {
        return print_object(statement_json(
            &proof,
            proven.time_bounds(),
            free.as_ref(),
            &statement,
        ));
    }
    let mut line = name.map_or_else(String::new, |name| format!("{}: ", escape_line(name)));
    let _ = write!(line, "holds: {statement}");
    if let Some(free) = &free {
        let _ = write!(line, ": {}", directions::verified_text(free));
    }
    print(&format!("{line}\n"))
}

/// Returns the proven statement with the fields of answers.
fn statement_json(
    proof: &ProofFile,
    time: Option<[f64; 2]>,
    free: Option<&FreeRecord>,
    statement: &str,
) -> Value {
    let mut fields = Map::new();
    let mut put = |name: &str, value: Value| fields.insert(name.into(), value);
    put("holds", json!(true));
    if let Some(count) = proof.obstacle_count() {
        put("obstacles", json!(count));
    }
    match proof.statement() {
        Statement::Contacts(contacts) => {
            let [first, last] = contacts.bounds();
            first.map(|bounds| put("translation_bounds", json!(bounds)));
            last.map(|bounds| put("exit_bounds", json!(bounds)));
            contacts.slide.map(|slide| put("overlap", json!(slide.overlap)));
        }
        Statement::Separation(separation) => {
            put("margin", json!(separation.margin));
        }
        Statement::Clearance(clearance) => {
            put("tolerance", json!(clearance.certificate.tolerance));
            if let Some(stop) = clearance.stop {
                put("translation_bounds", json!(stop.translation.bounds()));
                put("facets", json!(stop.facets));
            }
            clearance.separation.map(|plane| put("margin", json!(plane.margin)));
        }
        Statement::Distance(DistanceStatement { gap, near }) => {
            gap.map(|gap| put("lower", json!(gap.gap)));
            near.map(|near| put("upper", json!(near.distance)));
        }
        Statement::Depth(depth) => {
            put("lower", json!(depth.lower));
            put("upper", json!(depth.upper));
        }
        Statement::SolidDistance(proof) => {
            put("lower", json!(proof.lower));
            put("upper", json!(proof.near.distance()));
        }
        Statement::SolidDepth(proof) => {
            put("lower", json!(proof.lower));
            put("upper", json!(proof.upper));
        }
        Statement::SolidCommonPart(of) => {
            put("volume", json!(of.volume));
            of.bounds.map(|bounds| put("bounds", json!(bounds)));
            of.point.map(|point| put("point", json!(point)));
            of.relation.map(|relation| put("relation", json!(relation)));
        }
        Statement::FreeDirections(of) => {
            put("tolerance", json!(of.tolerance));
        }
        Statement::Nearest(of) => {
            put("obstacle", json!(of.obstacle));
            put("lower", json!(of.lower));
            put("upper", json!(of.near.distance()));
        }
        Statement::Within(of) => {
            let near =
                |(id, near): &(_, AnyNear)| json!({ "obstacle": id, "upper": near.distance() });
            put("length", json!(of.length));
            put("closer", of.closer.iter().map(near).collect());
            if !of.undecided.is_empty() {
                let open = of.undecided.iter().map(|id| json!({ "obstacle": id }));
                put("undecided", open.collect());
            }
        }
        Statement::SceneClearance(of) => {
            of.stop.map(|stop| put("obstacle", json!(stop)));
            of.lower.is_finite().then(|| put("distance", json!(of.lower)));
        }
        Statement::Motions(_) => {}
        Statement::Path(of) => {
            put("pairs", json!(of.pairs));
        }
    }
    let inverted = proof.inverted_facets();
    (inverted != [0; 2]).then(|| put("inverted", json!(inverted)));
    if let Some([lower, upper]) = time {
        let upper = upper.is_finite().then_some(upper);
        put("time", json!({ "lower": lower, "upper": upper }));
    }
    if let Some(free) = free {
        put("outcome", json!(free.outcome));
        put("free_share", json!(free.free_share));
        put("undecided_share", json!(free.undecided_share));
    }
    put("statement", json!(statement));
    Value::Object(fields)
}
