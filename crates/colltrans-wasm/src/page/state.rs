//! The bodies in use, and the questions about them.

use colltrans_mesh::Mesh;
use colltrans_mesh::body::BodyKind;

use super::body::{self, Part};
use super::convex;
use super::question::{Load, Question, Slot};
#[cfg(feature = "min-gap")]
use super::{certify, solid};
use crate::Answers;
use crate::answer::{Answer, Refusal};
use crate::shape::body_of_name;

/// Number of bytes of a file above which its body is dropped before the next file is read, because both may
/// not fit.
const LARGE: usize = 64 << 20;

/// Two bodies, built from files or names.
#[derive(Debug, Default)]
pub struct State {
    moving: Place,
    fixed: Place,
}

/// The body of a slot, and the last file from which no body could be built.
///
/// A rejected file leaves the old body in place, with two exceptions that [`Refusal::gone`] reports: a large body is
/// dropped before the next file is read, and a body is dropped if its own file is rejected in another way.
#[derive(Debug, Default)]
struct Place {
    body: Option<(File, Part)>,
    offered: Option<File>,
}

/// A file that has been read. A body that a name describes has no bytes and no mesh.
#[derive(Debug)]
struct File {
    name: String,
    bytes: usize,
    mesh: Mesh,
}

impl Place {
    /// Builds a body. Without bytes it is the one that the name describes, if the feature `min-gap` is on. Otherwise
    /// the last rejected file, or the file in use, is used in another way.
    fn load(&mut self, load: Load, bytes: Vec<u8>) -> Result<Answer, Refusal> {
        if cfg!(feature = "min-gap")
            && let Some(built) = body_of_name(&load.name, &bytes)
        {
            let (part, answer) = body::shape(built?, &load.name, load.take)?;
            self.offered = None;
            self.body = Some((File { name: load.name, bytes: 0, mesh: Mesh::default() }, part));
            return Ok(answer);
        }
        let used = self.body.as_ref().map(|(file, _)| file);
        let known = self.offered.as_ref().or(used).is_some_and(|file| file.name == load.name);
        if !bytes.is_empty() || !known {
            self.offered = None;
            self.drop_large();
            let length = bytes.len();
            let mesh = body::read_mesh(&load.name, bytes)?;
            self.offered = Some(File { name: load.name, bytes: length, mesh });
        }
        let mut file = match self.offered.take() {
            Some(file) => file,
            None => self.body.take().map(|(file, _)| file).ok_or_else(|| "no file".to_owned())?,
        };
        match body::build_body(&file.mesh, &file.name, load.take) {
            Ok((part, answer)) => {
                if load.take == BodyKind::Convex {
                    // No other body will be built from the mesh.
                    file.mesh = Mesh::default();
                }
                self.body = Some((file, part));
                Ok(answer)
            }
            Err(refusal) => {
                self.offered = Some(file);
                Err(refusal)
            }
        }
    }

    fn drop_large(&mut self) {
        if self.body.as_ref().is_some_and(|(file, _)| file.bytes > LARGE) {
            self.body = None;
        }
    }
}

impl Answers for State {
    /// Answers one question. `file` has the attached bytes, if any.
    fn ask(&mut self, question: &[u8], file: Vec<u8>) -> Answer {
        let answer = match Question::read(question) {
            Ok(question) => self.answer(question, file),
            Err(error) => Err(format!("the question cannot be read: {error}").into()),
        };
        answer.unwrap_or_else(Refusal::into_answer)
    }
}

impl State {
    fn answer(&mut self, question: Question, file: Vec<u8>) -> Result<Answer, Refusal> {
        match question {
            Question::Load(load) => self.load(load, file),
            Question::Cast(pair) => {
                let bodies = self.bodies()?;
                match bodies {
                    [Part::Convex(moving), Part::Convex(fixed)] => {
                        convex::cast_answer([moving, fixed], &pair)
                    }
                    #[cfg(feature = "min-gap")]
                    _ => solid::cast_answer(bodies, &pair),
                }
            }
            #[cfg(feature = "min-gap")]
            Question::Certify(pair) => certify::certify_clearance(self.bodies()?, &pair),
            Question::Verify(pair, proof) => match self.bodies()? {
                [Part::Convex(moving), Part::Convex(fixed)] => {
                    convex::verify([moving, fixed], &pair, &proof)
                }
                #[cfg(feature = "min-gap")]
                bodies => certify::verify(bodies, &pair, &proof),
            },
        }
    }

    fn load(&mut self, load: Load, file: Vec<u8>) -> Result<Answer, Refusal> {
        let place = match load.slot {
            Slot::Moving => &mut self.moving,
            Slot::Fixed => &mut self.fixed,
        };
        let answer = place.load(load, file);
        answer.map_err(|refusal| Refusal { gone: place.body.is_none(), ..refusal })
    }

    fn bodies(&self) -> Result<[&Part; 2], Refusal> {
        let [Some(moving), Some(fixed)] =
            [&self.moving, &self.fixed].map(|place| place.body.as_ref().map(|(_, part)| part))
        else {
            return Err("two bodies are needed".to_owned().into());
        };
        Ok([moving, fixed])
    }
}
