//! Two bodies, built from files or names as [`colltrans_mesh::body`] builds them for the module `page`.

use std::path::Path;

use colltrans::solid::AsSolid;
use colltrans::{ConvexPolyhedron, QueryError, Solid};
use colltrans_mesh::Format;
use colltrans_mesh::body::{self, BodyError, BodyOptions, Loaded};
use serde::Deserialize;
use serde_json::json;

use crate::answer::Answer;
use crate::shape::body_of_name;

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Slot {
    Moving,
    Fixed,
}

/// Two bodies, built from files or names.
#[derive(Debug, Default)]
pub(crate) struct Places([Option<Part>; 2]);

#[derive(Debug)]
#[expect(clippy::large_enum_variant, reason = "there are two values")]
pub(crate) enum Part {
    Convex(Loaded<ConvexPolyhedron>),
    Solid(Loaded<Solid>),
}

impl Part {
    /// Builds a body from a mesh file.
    fn from_file(name: &str, take: &str, file: Vec<u8>) -> Result<Self, String> {
        let path = Path::new(name);
        let format = Format::from_path(path).map_err(|error| error.to_string())?;
        let mesh = colltrans_mesh::parse(format, file, path).map_err(|error| error.to_string())?;
        let options = BodyOptions::default().with_hull(take == "hull").with_open(take == "open");
        let words = |error: BodyError| error.to_string();
        match take {
            "convex" | "hull" => body::convex(&mesh, &options).map(Self::Convex).map_err(words),
            "solid" | "open" => body::solid(&mesh, &options).map(Self::Solid).map_err(words),
            other => {
                Err(format!("unknown kind of body {other}; known kinds: convex, hull, solid, open"))
            }
        }
    }

    /// Returns the body as a solid, a point or a segment as one facet without area.
    pub(crate) fn solid(&self) -> Result<&Solid, QueryError> {
        Ok(match self {
            Self::Convex(of) => of.body.as_surface()?,
            Self::Solid(of) => &of.body,
        })
    }
}

impl Places {
    /// Replaces a body by that of a file, or by the body that the name describes. If this fails, the slot is empty.
    pub(crate) fn place(
        &mut self,
        slot: Slot,
        name: &str,
        take: &str,
        file: Vec<u8>,
    ) -> Result<Answer, String> {
        let body = &mut self.0[slot as usize];
        *body = None;
        *body = Some(match body_of_name(name, &file) {
            Some(built) => {
                let (body, precision, notes) = (built?, 0.0, Vec::new());
                Part::Convex(Loaded { body, precision, notes })
            }
            None => Part::from_file(name, take, file)?,
        });
        Ok(Answer::from_facts(&json!({ "placed": true })))
    }

    /// Returns both bodies.
    pub(crate) fn both(&self) -> Result<[&Part; 2], String> {
        match &self.0 {
            [Some(moving), Some(fixed)] => Ok([moving, fixed]),
            _ => Err("two bodies are needed".into()),
        }
    }
}
