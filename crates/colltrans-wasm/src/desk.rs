//! The bodies in use, and what is answered about them.

use colltrans_mesh::Mesh;
use serde_json::{Value, json};

use crate::body::{self, Part};
use crate::question::{Load, Question, Slot, Take};
use crate::{convex, levels, search, solid};

/// An answer: JSON, and numbers in binary (little-endian) whose layout the JSON tells.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Answer {
    /// JSON: an object, with a field `error` where there is no answer.
    pub text: Vec<u8>,
    /// Numbers that would be long as text.
    pub numbers: Vec<u8>,
}

/// Why there is no answer.
#[derive(Debug)]
pub(crate) struct Refusal {
    /// For people.
    pub(crate) error: String,
    /// What the same file could be taken as instead.
    pub(crate) instead: Vec<&'static str>,
}

impl From<String> for Refusal {
    fn from(error: String) -> Self {
        Self { error, instead: Vec::new() }
    }
}

impl Answer {
    pub(crate) fn of(facts: &Value) -> Self {
        Self { text: facts.to_string().into_bytes(), numbers: Vec::new() }
    }
}

/// Two bodies, as files made them.
#[derive(Debug, Default)]
pub struct Desk {
    moving: Option<Loaded>,
    fixed: Option<Loaded>,
}

/// A file, read once, and the body made of it.
#[derive(Debug)]
struct Loaded {
    name: String,
    mesh: Mesh,
    part: Option<Part>,
}

impl Desk {
    /// Answers one question; `file` holds the bytes that come with it, if any.
    pub fn ask(&mut self, question: &[u8], file: Vec<u8>) -> Answer {
        let answer = match Question::read(question) {
            Ok(question) => self.answer(question, file),
            Err(error) => Err(format!("the question cannot be read: {error}").into()),
        };
        answer.unwrap_or_else(|Refusal { error, instead }| {
            Answer::of(&json!({ "error": error, "instead": instead }))
        })
    }

    fn answer(&mut self, question: Question, file: Vec<u8>) -> Result<Answer, Refusal> {
        match question {
            Question::Load(load) => self.load(load, file),
            Question::Cast(pair) => {
                let bodies = self.bodies()?;
                match bodies {
                    [Part::Convex(moving), Part::Convex(fixed)] => {
                        convex::cast([moving, fixed], &pair)
                    }
                    _ => solid::cast(bodies, &pair),
                }
            }
            Question::Verify(pair, proof) => convex::verify(self.convex()?, &pair, &proof),
            Question::Search(asked) => search::search(self.convex()?, &asked),
            Question::Levels(asked) => levels::levels(self.convex()?, &asked),
        }
    }

    /// A file without bytes is the one that the slot has, taken in another way.
    fn load(&mut self, load: Load, file: Vec<u8>) -> Result<Answer, Refusal> {
        let slot = match load.slot {
            Slot::Moving => &mut self.moving,
            Slot::Fixed => &mut self.fixed,
        };
        if !file.is_empty() || slot.as_ref().is_none_or(|known| known.name != load.name) {
            // The old one goes first: both may be large.
            *slot = None;
            let mesh = body::read(&load.name, file)?;
            *slot = Some(Loaded { name: load.name, mesh, part: None });
        }
        let Some(known) = slot else { return Err("no file was given".to_owned().into()) };
        known.part = None;
        let (part, answer) = body::build(&known.mesh, &known.name, load.take)?;
        if load.take == Take::Convex {
            // Nothing else will be made of it.
            known.mesh = Mesh::default();
        }
        known.part = Some(part);
        Ok(answer)
    }

    fn bodies(&self) -> Result<[&Part; 2], Refusal> {
        let [Some(moving), Some(fixed)] = [&self.moving, &self.fixed]
            .map(|slot| slot.as_ref().and_then(|known| known.part.as_ref()))
        else {
            return Err("two bodies are needed".to_owned().into());
        };
        Ok([moving, fixed])
    }

    fn convex(&self) -> Result<[&body::Hull; 2], Refusal> {
        match self.bodies()? {
            [Part::Convex(moving), Part::Convex(fixed)] => Ok([moving, fixed]),
            _ => Err("only casts between convex bodies have this".to_owned().into()),
        }
    }
}
