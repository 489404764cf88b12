//! The bodies in use, and their distance.

use colltrans::record::{Ending, PairQuestion, Record};
use colltrans::{Pair, QueryError, Solid};
use serde::{Deserialize, Serialize};

use crate::Answers;
use crate::answer::{Answer, Refusal};
use crate::placing::{Part, Places, Slot};
use crate::pose::pose;

/// A question.
#[derive(Deserialize)]
#[serde(tag = "do", rename_all = "snake_case")]
enum Question {
    /// Builds a body from the attached file, or the one that the name describes.
    Place { slot: Slot, name: String, take: String },
    /// Computes the distance of the bodies. Poses are `x,y,z,qx,qy,qz,qw`.
    Distance { moving_pose: [f64; 7], fixed_pose: [f64; 7] },
}

/// Two bodies, built from files or names.
#[derive(Debug, Default)]
pub struct State(Places);

/// The answer about two bodies at their poses.
#[derive(Serialize)]
struct PairAnswer {
    /// Their distance.
    distance: Record,
    /// The depth of their overlap, if they meet.
    #[serde(skip_serializing_if = "Option::is_none")]
    depth: Option<Record>,
}

impl Answers for State {
    /// Answers one question: `place` builds a body from the attached file; `distance` measures both bodies at
    /// their poses.
    fn ask(&mut self, question: &[u8], file: Vec<u8>) -> Answer {
        let answered = match serde_json::from_slice(question) {
            Err(error) => Err(format!("the question cannot be read: {error}")),
            Ok(Question::Place { slot, name, take }) => self.0.place(slot, &name, &take, file),
            Ok(Question::Distance { moving_pose, fixed_pose }) => {
                self.distance(moving_pose, fixed_pose)
            }
        };
        answered.unwrap_or_else(|error| Refusal::from(error).into_answer())
    }
}

impl State {
    fn distance(&self, moving_pose: [f64; 7], fixed_pose: [f64; 7]) -> Result<Answer, String> {
        let [moving, fixed] = self.0.both()?;
        let poses = [pose(moving_pose, "moving")?, pose(fixed_pose, "fixed")?];
        let answer = match (moving, fixed) {
            (Part::Convex(p), Part::Convex(q)) => {
                Pair::new(p.body.at(poses[0]), q.body.at(poses[1])).and_then(|pair| convex(&pair))
            }
            _ => moving
                .solid()
                .and_then(|p| Pair::new(p.at(poses[0]), fixed.solid()?.at(poses[1])))
                .and_then(|pair| solids(&pair)),
        };
        Ok(Answer::from_facts(&answer.map_err(|error| error.to_string())?))
    }
}

fn convex(pair: &Pair<'_>) -> Result<PairAnswer, QueryError> {
    let distance = PairQuestion::Distance.answer(pair)?.record(pair);
    let meets = distance.outcome() == Ending::Meeting;
    let depth = meets.then(|| PairQuestion::Depth.answer(pair)).transpose()?;
    Ok(PairAnswer { distance, depth: depth.map(|depth| depth.record(pair)) })
}

fn solids(pair: &Pair<'_, Solid>) -> Result<PairAnswer, QueryError> {
    let distance = PairQuestion::Distance.answer_solids(pair)?.record(pair)?;
    let meets = distance.outcome() == Ending::Meeting;
    let depth = meets.then(|| PairQuestion::Depth.answer_solids(pair)?.record(pair)).transpose()?;
    Ok(PairAnswer { distance, depth })
}
