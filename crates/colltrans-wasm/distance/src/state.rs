//! The bodies in use, and how far they are apart.

use std::path::Path;

use colltrans::record::{Ending, PairQuestion, Record};
use colltrans::solid::AsSolid;
use colltrans::{ConvexPolyhedron, Pair, QueryError, Solid};
use colltrans_mesh::body::{self, BodyOptions};
use colltrans_mesh::{Format, Mesh};
use serde::{Deserialize, Serialize};
use serde_json::json;

use crate::answer::{Answer, Refusal};
use crate::pose::pose;

/// One question.
#[derive(Deserialize)]
#[serde(tag = "do", rename_all = "snake_case")]
enum Question {
    /// The file that comes with it becomes a body.
    Place { slot: Slot, name: String, take: String },
    /// How far are the bodies apart? Poses are `x,y,z,qx,qy,qz,qw`.
    Distance { moving_pose: [f64; 7], fixed_pose: [f64; 7] },
}

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Slot {
    Moving,
    Fixed,
}

/// Two bodies, as files made them.
#[derive(Debug, Default)]
pub struct State([Option<Part>; 2]);

#[derive(Debug)]
enum Part {
    Convex(ConvexPolyhedron),
    Solid(Solid),
}

/// The answer about two bodies where they are.
#[derive(Serialize)]
struct PairAnswer {
    /// How far they are apart.
    distance: Record,
    /// How deep they overlap, if they meet.
    #[serde(skip_serializing_if = "Option::is_none")]
    depth: Option<Record>,
}

impl Part {
    /// As [`colltrans_mesh::body`] makes it for the page's library.
    fn of(mesh: &Mesh, take: &str) -> Result<Self, String> {
        let options = BodyOptions::default().with_hull(take == "hull").with_open(take == "open");
        let words = |error: body::Refused| error.to_string();
        match take {
            "convex" | "hull" => {
                body::convex(mesh, &options).map(|made| Self::Convex(made.body)).map_err(words)
            }
            "solid" | "open" => {
                body::solid(mesh, &options).map(|made| Self::Solid(made.body)).map_err(words)
            }
            other => Err(format!("a mesh cannot be taken as {other}")),
        }
    }

    fn solid(&self) -> Result<&Solid, QueryError> {
        Ok(match self {
            Self::Convex(body) => body.as_solid()?,
            Self::Solid(solid) => solid,
        })
    }
}

impl State {
    /// Answers one question: `place`, a body of the file that comes with it; `distance`, of both bodies
    /// where they are.
    pub fn ask(&mut self, question: &[u8], file: Vec<u8>) -> Answer {
        let answered = match serde_json::from_slice(question) {
            Err(error) => Err(format!("the question cannot be read: {error}")),
            Ok(Question::Place { slot, name, take }) => self.place(slot, &name, &take, file),
            Ok(Question::Distance { moving_pose, fixed_pose }) => {
                self.distance(moving_pose, fixed_pose)
            }
        };
        answered.unwrap_or_else(|error| Refusal::from(error).answer())
    }

    fn place(
        &mut self,
        slot: Slot,
        name: &str,
        take: &str,
        file: Vec<u8>,
    ) -> Result<Answer, String> {
        let body = &mut self.0[slot as usize];
        *body = None;
        let path = Path::new(name);
        let format = Format::of_path(path).map_err(|error| error.to_string())?;
        let mesh = colltrans_mesh::parse(format, file, path).map_err(|error| error.to_string())?;
        *body = Some(Part::of(&mesh, take)?);
        Ok(Answer::of(&json!({ "placed": true })))
    }

    fn distance(&self, moving_pose: [f64; 7], fixed_pose: [f64; 7]) -> Result<Answer, String> {
        let [Some(moving), Some(fixed)] = &self.0 else {
            return Err("two bodies are needed".into());
        };
        let poses = [pose(moving_pose, "moving")?, pose(fixed_pose, "fixed")?];
        let answer = match (moving, fixed) {
            (Part::Convex(p), Part::Convex(q)) => {
                Pair::new(p.at(poses[0]), q.at(poses[1])).and_then(|pair| convex(&pair))
            }
            _ => moving
                .solid()
                .and_then(|p| Pair::new(p.at(poses[0]), fixed.solid()?.at(poses[1])))
                .and_then(|pair| solids(&pair)),
        };
        Ok(Answer::of(&answer.map_err(|error| error.to_string())?))
    }
}

fn convex(pair: &Pair<'_>) -> Result<PairAnswer, QueryError> {
    let distance = PairQuestion::Distance.ask(pair)?.record(pair);
    let meets = distance.outcome == Ending::Meeting;
    let depth = meets.then(|| PairQuestion::Depth.ask(pair)).transpose()?;
    Ok(PairAnswer { distance, depth: depth.map(|depth| depth.record(pair)) })
}

fn solids(pair: &Pair<'_, Solid>) -> Result<PairAnswer, QueryError> {
    let distance = PairQuestion::Distance.ask_solids(pair)?.record(pair)?;
    let meets = distance.outcome == Ending::Meeting;
    let depth = meets.then(|| PairQuestion::Depth.ask_solids(pair)?.record(pair)).transpose()?;
    Ok(PairAnswer { distance, depth })
}
