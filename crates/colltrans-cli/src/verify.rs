//! `colltrans verify`: checks the proofs that `--save-proof` writes.

use colltrans::record::FreeRecord;
use colltrans::{AnyNear, DistanceStatement, ProofFile, Proven, Statement};
use serde_json::{Map, Value, json};

use crate::args::VerifyArguments;
use crate::directions;
use crate::failure::{Code, Failure, print, print_json};
use crate::inputs::read_text;

/// Checks a proof, and prints its statement.
///
/// # Errors
/// The file cannot be read, or the proof does not hold.
pub(crate) fn run(arguments: &VerifyArguments) -> Result<(), Failure> {
    let place = arguments.proof.display();
    let text = read_text(&arguments.proof)?;
    let proof = ProofFile::from_json(&text)
        .map_err(|error| Failure::new(Code::Input, format!("{place}: {error}")))?;
    match proof.check() {
        Ok(proven) => print_statement(&proof, &proven, arguments.json),
        Err(error) => {
            let error = error.to_string();
            if arguments.json {
                let answer = json!({ "holds": false, "message": error });
                print_json(&format!("{answer}\n"))?;
            }
            Err(Failure::new(Code::Refused, format!("{place}: the proof does not hold: {error}")))
        }
    }
}

/// Prints the statement of a proof that holds, as text or as JSON.
fn print_statement(proof: &ProofFile, proven: &Proven<'_>, as_json: bool) -> Result<(), Failure> {
    let statement = proof.to_string();
    let free = match proven {
        Proven::Directions(free) => Some(FreeRecord::from_directions(free, |_| [None, None])),
        _ => None,
    };
    if as_json {
        return print_json(&format!(
            "{}\n",
            statement_json(proof, proven.time_bounds(), free.as_ref(), &statement)
        ));
    }
    match &free {
        Some(free) => print(&format!("holds: {statement}: {}\n", directions::verified_text(free))),
        None => print(&format!("holds: {statement}\n")),
    }
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
