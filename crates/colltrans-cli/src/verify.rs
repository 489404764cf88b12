//! `colltrans verify`: checks the proofs that `--save-proof` writes.

use colltrans::record::FreeRecord;
use colltrans::{AnyNear, DistanceStatement, ProofFile, Proven, Statement};
use serde_json::{Map, Value, json};

use crate::args::VerifyArguments;
use crate::directions;
use crate::failure::{Code, Failure, print, print_json};
use crate::inputs::read_text;

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
                let told = json!({ "holds": false, "message": error });
                print_json(&format!("{told}\n"))?;
            }
            Err(Failure::new(Code::Refused, format!("{place}: the proof does not hold: {error}")))
        }
    }
}

/// Prints the statement of a proof that holds, in words or in the fields of answers.
fn print_statement(proof: &ProofFile, proven: &Proven<'_>, as_json: bool) -> Result<(), Failure> {
    let words = proof.to_string();
    let free = match proven {
        Proven::Directions(free) => Some(FreeRecord::of(free, |_| [None, None])),
        _ => None,
    };
    if as_json {
        return print_json(&format!("{}\n", told(proof, proven.time(), free.as_ref(), &words)));
    }
    match &free {
        Some(free) => print(&format!("holds: {words}: {}\n", directions::verified(free))),
        None => print(&format!("holds: {words}\n")),
    }
}

/// What is proven, in the fields of answers.
fn told(
    proof: &ProofFile,
    time: Option<[f64; 2]>,
    free: Option<&FreeRecord>,
    words: &str,
) -> Value {
    let mut fields = Map::new();
    let mut say = |name: &str, value: Value| fields.insert(name.into(), value);
    say("holds", json!(true));
    if let Some(count) = proof.obstacles() {
        say("obstacles", json!(count));
    }
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
        }
        Statement::Nearest(of) => {
            say("obstacle", json!(of.obstacle));
            say("lower", json!(of.lower));
            say("upper", json!(of.near.distance()));
        }
        Statement::Within(of) => {
            let near =
                |(id, near): &(_, AnyNear)| json!({ "obstacle": id, "upper": near.distance() });
            say("length", json!(of.length));
            say("closer", of.closer.iter().map(near).collect());
            if !of.undecided.is_empty() {
                let open = of.undecided.iter().map(|id| json!({ "obstacle": id }));
                say("undecided", open.collect());
            }
        }
        Statement::SceneClearance(of) => {
            of.stop.map(|stop| say("obstacle", json!(stop)));
            of.lower.is_finite().then(|| say("distance", json!(of.lower)));
        }
        Statement::Motions(_) => {}
        Statement::Path(of) => {
            say("pairs", json!(of.pairs));
        }
    }
    let inverted = proof.inverted();
    (inverted != [0; 2]).then(|| say("inverted", json!(inverted)));
    if let Some([lower, upper]) = time {
        let upper = upper.is_finite().then_some(upper);
        say("time", json!({ "lower": lower, "upper": upper }));
    }
    if let Some(free) = free {
        say("outcome", json!(free.outcome));
        say("free_share", json!(free.free_share));
        say("undecided_share", json!(free.undecided_share));
    }
    say("statement", json!(words));
    Value::Object(fields)
}
