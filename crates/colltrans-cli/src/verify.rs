//! `colltrans verify`: checks the proofs that `--save-proof` writes.

use colltrans::free::FreeDirections;
use colltrans::motion::path::{PathFileError, PathProofFile};
use colltrans::motion::{MotionProofFile, MotionProofFiles, SolidMotionProofFile};
use colltrans::record::FreeRecord;
use colltrans::{
    CaseError, CertificateError, DistanceStatement, ProofFile, SceneProof, SceneStatement,
    Statement,
};
use serde_json::{Map, Value, json};

use crate::args::VerifyArguments;
use crate::directions;
use crate::failure::{Code, Failure, print, print_json};

pub(crate) fn run(arguments: &VerifyArguments) -> Result<(), Failure> {
    let place = arguments.proof.display();
    let input = |what: String| Failure::new(Code::Input, format!("{place}: {what}"));
    let text = colltrans_mesh::file::text(&arguments.proof)
        .map_err(|error| input(format!("cannot be read: {error}")))?;
    let proof = Saved::read(&text).map_err(|error| input(error.to_string()))?;
    match proof.check() {
        Ok(free) if arguments.json => print_json(&format!("{}\n", proof.told(free.as_ref()))),
        Ok(None) => print(&format!("holds: {}\n", proof.words())),
        Ok(Some(free)) => {
            print(&format!("holds: {}: {}\n", proof.words(), directions::verified(&free)))
        }
        Err(error) => {
            if arguments.json {
                let told = json!({ "holds": false, "message": error });
                print_json(&format!("{told}\n"))?;
            }
            Err(Failure::new(Code::Refused, format!("{place}: the proof does not hold: {error}")))
        }
    }
}

/// A proof of either format.
enum Saved {
    Two(Box<ProofFile>),
    Many(Box<SceneProof>),
    Motion(Box<MotionProofFile>),
    Motions(Box<MotionProofFiles>),
    SolidMotion(Box<SolidMotionProofFile>),
    Path(Box<PathProofFile>),
}

impl Saved {
    /// The first format that it is in.
    fn read(text: &str) -> Result<Self, PathFileError> {
        let other = |error: &CaseError| matches!(error, CaseError::Format { .. });
        let first = match ProofFile::from_json(text) {
            Err(error) if other(&error) => error,
            proof => return Ok(Self::Two(Box::new(proof?))),
        };
        match SceneProof::from_json(text) {
            Err(error) if other(&error) => {}
            proof => return Ok(Self::Many(Box::new(proof?))),
        }
        match MotionProofFile::from_json(text) {
            Err(error) if other(&error) => {}
            proof => return Ok(Self::Motion(Box::new(proof?))),
        }
        match MotionProofFiles::from_json(text) {
            Err(error) if other(&error) => {}
            proof => return Ok(Self::Motions(Box::new(proof?))),
        }
        match SolidMotionProofFile::from_json(text) {
            Err(error) if other(&error) => {}
            proof => return Ok(Self::SolidMotion(Box::new(proof?))),
        }
        match PathProofFile::from_json(text) {
            Err(PathFileError::Case(error)) if other(&error) => Err(first.into()),
            proof => Ok(Self::Path(Box::new(proof?))),
        }
    }

    /// Checks it; what it says of all directions, if that is what it is about.
    fn check(&self) -> Result<Option<FreeRecord>, String> {
        match self {
            Self::Two(proof) => checked(proof).map_err(|error| error.to_string()),
            Self::Many(proof) => proof.check().map(|()| None).map_err(|error| error.to_string()),
            Self::Motion(proof) => proof.check().map(|_| None).map_err(|error| error.to_string()),
            Self::Motions(proof) => proof.check().map(|_| None).map_err(|error| error.to_string()),
            Self::SolidMotion(proof) => {
                proof.check().map(|_| None).map_err(|error| error.to_string())
            }
            Self::Path(proof) => proof.check().map(|_| None).map_err(|error| error.to_string()),
        }
    }

    fn words(&self) -> String {
        match self {
            Self::Two(proof) => proof.to_string(),
            Self::Many(proof) => proof.to_string(),
            Self::Motion(proof) => proof.to_string(),
            Self::Motions(proof) => proof.to_string(),
            Self::SolidMotion(proof) => proof.to_string(),
            Self::Path(proof) => proof.to_string(),
        }
    }

    fn told(&self, free: Option<&FreeRecord>) -> Value {
        match self {
            Self::Two(proof) => told(proof, free),
            Self::Many(proof) => told_of_many(proof),
            Self::Motion(proof) => {
                told_of_time(&proof.to_string(), proof.check().unwrap_or_default())
            }
            Self::Motions(proof) => {
                told_of_time(&proof.to_string(), proof.check().unwrap_or_default())
            }
            Self::SolidMotion(proof) => {
                told_of_time(&proof.to_string(), proof.check().unwrap_or_default())
            }
            Self::Path(proof) => {
                let mut told = told_of_time(&proof.to_string(), proof.check().unwrap_or_default());
                told["pairs"] = json!(proof.statement().pairs);
                told
            }
        }
    }
}

/// What is proven of a time.
fn told_of_time(statement: &str, [lower, upper]: [f64; 2]) -> Value {
    let upper = upper.is_finite().then_some(upper);
    json!({ "holds": true, "statement": statement, "time": { "lower": lower, "upper": upper } })
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
