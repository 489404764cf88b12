//! The bodies in use, and the questions about them.

use std::path::Path;

use colltrans::ConvexPolyhedron;
use colltrans_mesh::Format;
use colltrans_mesh::body::{self, BodyOptions};
use serde_json::json;

use super::question::{Question, Slot};
use super::{levels, search};
use crate::Answers;
use crate::answer::{Answer, Refusal};
use crate::shape::body_of_name;

/// Two convex bodies, built from files or names.
#[derive(Debug, Default)]
pub struct State([Option<ConvexPolyhedron>; 2]);

impl Answers for State {
    /// Answers one question: `place` builds a body from the attached file; `search` records a search;
    /// `levels` evaluates the function that the search minimises.
    fn ask(&mut self, question: &[u8], file: Vec<u8>) -> Answer {
        let answered = match serde_json::from_slice(question) {
            Err(error) => Err(format!("the question cannot be read: {error}")),
            Ok(Question::Place { slot, name, take }) => self.place(slot, &name, &take, file),
            Ok(Question::Search(asked)) => {
                self.both().and_then(|p| search::search_answer(p, &asked))
            }
            Ok(Question::Levels(asked)) => {
                self.both().and_then(|p| levels::levels_answer(p, &asked))
            }
        };
        answered.unwrap_or_else(|error| Refusal::from(error).into_answer())
    }
}

impl State {
    fn both(&self) -> Result<[&ConvexPolyhedron; 2], String> {
        match &self.0 {
            [Some(moving), Some(fixed)] => Ok([moving, fixed]),
            _ => Err("two bodies are needed".into()),
        }
    }

    /// Builds the body as [`colltrans_mesh::body`] does for the module `page`. Rounded bodies are refused, because
    /// levels are those of polygons.
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
            other => return Err(format!("a body used as {other} has no sections")),
        };
        let body = if let Some(built) = body_of_name(name, &file) {
            built?
        } else {
            let path = Path::new(name);
            let format = Format::from_path(path).map_err(|error| error.to_string())?;
            let mesh =
                colltrans_mesh::parse(format, file, path).map_err(|error| error.to_string())?;
            body::convex(&mesh, &options).map_err(|error| error.to_string())?.body
        };
        if body.radius() > 0.0 {
            return Err(format!("{name}: a rounded body has no polygons as sections"));
        }
        *place = Some(body);
        Ok(Answer::from_facts(&json!({ "placed": true })))
    }
}
