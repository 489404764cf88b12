//! The bodies in use, and what is asked about them.

use std::path::Path;

use colltrans::ConvexPolyhedron;
use colltrans_mesh::Format;
use colltrans_mesh::body::{self, BodyOptions};
use serde_json::json;

use super::question::{Question, Slot};
use super::{levels, search};
use crate::Answers;
use crate::answer::{Answer, Refusal};

/// Two convex bodies, as files made them.
#[derive(Debug, Default)]
pub struct State([Option<ConvexPolyhedron>; 2]);

impl Answers for State {
    /// Answers one question: `place`, a body of the file that comes with it; `search`, what a search does;
    /// `levels`, the function that it minimises.
    fn ask(&mut self, question: &[u8], file: Vec<u8>) -> Answer {
        let answered = match serde_json::from_slice(question) {
            Err(error) => Err(format!("the question cannot be read: {error}")),
            Ok(Question::Place { slot, name, take }) => self.place(slot, &name, &take, file),
            Ok(Question::Search(asked)) => self.both().and_then(|p| search::search(p, &asked)),
            Ok(Question::Levels(asked)) => self.both().and_then(|p| levels::levels(p, &asked)),
        };
        answered.unwrap_or_else(|error| Refusal::from(error).answer())
    }
}

impl State {
    fn both(&self) -> Result<[&ConvexPolyhedron; 2], String> {
        match &self.0 {
            [Some(moving), Some(fixed)] => Ok([moving, fixed]),
            _ => Err("two bodies are needed".into()),
        }
    }

    /// As [`colltrans_mesh::body`] makes it for the page's library.
    fn place(
        &mut self,
        slot: Slot,
        name: &str,
        take: &str,
        file: Vec<u8>,
    ) -> Result<Answer, String> {
        let place = &mut self.0[slot as usize];
        *place = None;
        let options = match take {
            "convex" | "hull" => BodyOptions::default().with_hull(take == "hull"),
            other => return Err(format!("a body that is taken as {other} has no sections")),
        };
        let path = Path::new(name);
        let format = Format::of_path(path).map_err(|error| error.to_string())?;
        let mesh = colltrans_mesh::parse(format, file, path).map_err(|error| error.to_string())?;
        let made = body::convex(&mesh, &options).map_err(|error| error.to_string())?;
        *place = Some(made.body);
        Ok(Answer::of(&json!({ "placed": true })))
    }
}
