//! `colltrans verify`: checks the proofs that `--save-proof` writes.

use std::fmt::Display;

use colltrans::motion::path::{PathFileError, PathProofFile};
use colltrans::motion::{MotionProofFile, MotionProofFiles, SolidMotionProofFile};
use colltrans::record::FreeRecord;
use colltrans::{CaseError, DistanceStatement, ProofFile, SceneProof, SceneStatement, Statement};
use serde_json::{Map, Value, json};

use crate::args::VerifyArguments;
use crate::directions;
use crate::failure::{Code, Failure, print, print_json};
use crate::inputs::read_text;

pub(crate) fn run(arguments: &VerifyArguments) -> Result<(), Failure> {
    let place = arguments.proof.display();
    let text = read_text(&arguments.proof)?;
    let checked = Verified::check(&text)
        .map_err(|error| Failure::new(Code::Input, format!("{place}: {error}")))?;
    match checked {
        Ok(of) if arguments.json => print_json(&format!("{}\n", of.json)),
        Ok(of) => print(&format!("holds: {}\n", of.words)),
        Err(error) => {
            if arguments.json {
                let told = json!({ "holds": false, "message": error });
                print_json(&format!("{told}\n"))?;
            }
            Err(Failure::new(Code::Refused, format!("{place}: the proof does not hold: {error}")))
        }
    }
}

/// Statement of a proof that holds.
struct Verified {
    words: String,
    /// Fields of answers.
    json: Value,
}

/// Statement of a proof, or the reason why the proof does not hold.
type Checked = Result<Verified, String>;

/// Result of reading a text as a proof and checking it.
type Reading = Result<Checked, PathFileError>;

impl Verified {
    /// Checks a proof of any format. Fails if the text is not a proof.
    fn check(text: &str) -> Reading {
        let readers: [fn(&str) -> Reading; 6] = [
            |text| Ok(Self::of_two(&ProofFile::from_json(text)?)),
            |text| Ok(Self::of_many(&SceneProof::from_json(text)?)),
            |text| Ok(Self::of_time(&MotionProofFile::from_json(text)?, MotionProofFile::check)),
            |text| Ok(Self::of_time(&MotionProofFiles::from_json(text)?, MotionProofFiles::check)),
            |text| {
                let proof = SolidMotionProofFile::from_json(text)?;
                Ok(Self::of_time(&proof, SolidMotionProofFile::check))
            },
            |text| Ok(Self::of_path(&PathProofFile::from_json(text)?)),
        ];
        let is_other =
            |found: &Reading| matches!(found, Err(PathFileError::Case(CaseError::Format { .. })));
        let first = readers[0](text);
        if !is_other(&first) {
            return first;
        }
        let mut rest = readers[1..].iter().map(|read| read(text));
        rest.find(|found| !is_other(found)).unwrap_or(first)
    }

    fn of_path(proof: &PathProofFile) -> Checked {
        let mut of = Self::of_time(proof, PathProofFile::check)?;
        of.json["pairs"] = json!(proof.statement().pairs);
        Ok(of)
    }

    fn of_time<P: Display, E: Display>(
        proof: &P,
        check: impl FnOnce(&P) -> Result<[f64; 2], E>,
    ) -> Checked {
        let [lower, upper] = check(proof).map_err(|error| error.to_string())?;
        let words = proof.to_string();
        let time = json!({ "lower": lower, "upper": upper.is_finite().then_some(upper) });
        let json = json!({ "holds": true, "statement": words, "time": time });
        Ok(Self { words, json })
    }

    fn of_many(proof: &SceneProof) -> Checked {
        proof.check().map_err(|error| error.to_string())?;
        Ok(Self { words: proof.to_string(), json: told_of_many(proof) })
    }

    fn of_two(proof: &ProofFile) -> Checked {
        let Some(free) = proof.free_directions() else {
            proof.check().map_err(|error| error.to_string())?;
            return Ok(Self { words: proof.to_string(), json: told(proof, None) });
        };
        let free = free.map_err(|error| error.to_string())?;
        let record = FreeRecord::of(&free, |_| [None, None]);
        let words = format!("{proof}: {}", directions::verified(&record));
        Ok(Self { words, json: told(proof, Some(&record)) })
    }
}

/// What is proven of one body among many, in the fields of answers.
fn told_of_many(proof: &SceneProof) -> Value {
    let mut told = json!({
        "holds": true, "statement": proof.to_string(), "obstacles": proof.obstacles(),
    });
    match proof.statement() {
        SceneStatement::Nearest(of) => {
            told["obstacle"] = json!(of.obstacle);
            told["lower"] = json!(of.lower);
            told["upper"] = json!(of.near.distance());
        }
        SceneStatement::Within(of) => {
            let closer = of
                .closer
                .iter()
                .map(|(id, near)| json!({ "obstacle": id, "upper": near.distance() }));
            told["length"] = json!(of.length);
            told["closer"] = closer.collect();
            if !of.undecided.is_empty() {
                told["undecided"] =
                    of.undecided.iter().map(|id| json!({ "obstacle": id })).collect();
            }
        }
        SceneStatement::Clearance(of) => {
            if let Some(stop) = of.stop {
                told["obstacle"] = json!(stop);
            }
            if of.lower.is_finite() {
                told["distance"] = json!(of.lower);
            }
        }
    }
    told
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
