//! The bodies in use, and what is answered about them.

use colltrans_mesh::Mesh;

use crate::answer::{Answer, Refusal};
use crate::body::{self, Part};
use crate::question::{Load, Question, Slot, Take};
use crate::{certify, convex, levels, search, solid};

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
        answer.unwrap_or_else(Refusal::told)
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
            Question::Certify(pair) => certify::certify(self.bodies()?, &pair),
            Question::Verify(pair, proof) => match self.bodies()? {
                [Part::Convex(moving), Part::Convex(fixed)] => {
                    convex::verify([moving, fixed], &pair, &proof)
                }
                bodies => certify::verify(bodies, &pair, &proof, &file),
            },
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
