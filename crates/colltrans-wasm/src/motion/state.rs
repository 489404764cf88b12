//! The bodies in use, and their first contact.

use colltrans::motion::{Motion, MotionCast, MotionContact, MotionOutcome, MotionProofError};
use colltrans::record::MotionRecord;
use colltrans::{Body, Features, Pose, QueryError, Solid};
use colltrans_mesh::body::between_motions;
use glam::DVec3;
use serde::{Deserialize, Serialize};
use serde_json::json;

use super::places::{Part, Places, Slot};
use crate::Answers;
use crate::answer::{Answer, Refusal};
use crate::highlight::{ContactHighlight, FeatureHighlight};
use crate::pose::pose;

/// A question.
#[derive(Deserialize)]
#[serde(tag = "do", rename_all = "snake_case")]
enum Question {
    /// Builds a body from the attached file, or the one that the name describes.
    Place { slot: Slot, name: String, take: String },
    /// Computes the first contact.
    Motion(Request),
    /// Builds the proof of the first contact and checks it.
    Prove(Request),
}

/// The motions of the bodies, and the poses of bodies at rest. Poses are `x,y,z,qx,qy,qz,qw`.
#[derive(Deserialize)]
struct Request {
    moving_pose: [f64; 7],
    fixed_pose: [f64; 7],
    #[serde(default)]
    moving_motion: Option<Kind>,
    #[serde(default)]
    fixed_motion: Option<Kind>,
    /// A minimum gap.
    #[serde(default)]
    min_gap: f64,
    /// For convex bodies a tolerated depth, which excludes a gap; for solids their tolerance. The default is no depth
    /// for convex bodies, and a tolerance that follows from the files for solids.
    #[serde(default)]
    tolerance: Option<f64>,
}

/// A motion as in a line of a batch; angles are in radians.
#[derive(Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
enum Kind {
    Turn { point: [f64; 3], axis: [f64; 3], angle: f64 },
    Screw { point: [f64; 3], axis: [f64; 3], angle: f64, rise: f64 },
}

impl Kind {
    /// Builds the motion from a pose.
    fn motion_from(&self, start: Pose) -> Result<Motion, String> {
        let v = DVec3::from_array;
        let motion = match *self {
            Self::Turn { point, axis, angle } => {
                Motion::rotation_about(start, v(point), v(axis), angle)
            }
            Self::Screw { point, axis, angle, rise } => {
                Motion::screw(start, v(point), v(axis), angle, rise)
            }
        };
        motion.map_err(|error| error.to_string())
    }
}

/// Two bodies, built from files or names.
#[derive(Debug, Default)]
pub struct State(Places);

/// The answer. Fields that do not apply are omitted.
#[derive(Serialize)]
struct MotionAnswer {
    /// The kind of the bodies: `convex` or `solid`.
    kind: &'static str,
    record: MotionRecord,
    /// The pose of the moving body at the lower bound.
    #[serde(skip_serializing_if = "Option::is_none")]
    pose: Option<[f64; 7]>,
    /// The features in contact.
    #[serde(skip_serializing_if = "Option::is_none")]
    lit: Option<ContactHighlight>,
}

/// A query between bodies of either kind.
enum Query<'a> {
    Convex(MotionCast<'a>),
    Solid(MotionCast<'a, Solid>),
}

impl Answers for State {
    /// Answers one question: `place` builds a body from the attached file; `motion` computes the first
    /// contact; `prove` checks its proof.
    fn ask(&mut self, question: &[u8], file: Vec<u8>) -> Answer {
        let answered = match serde_json::from_slice(question) {
            Err(error) => Err(format!("the question cannot be read: {error}")),
            Ok(Question::Place { slot, name, take }) => self.0.place(slot, &name, &take, file),
            Ok(Question::Motion(asked)) => self.answer_with(&asked, first_contact),
            Ok(Question::Prove(asked)) => self.answer_with(&asked, prove_contact),
        };
        answered.unwrap_or_else(|error| Refusal::from(error).into_answer())
    }
}

impl State {
    /// Answers a question about the cast of both bodies.
    fn answer_with(
        &self,
        asked: &Request,
        answer: impl FnOnce(&Query<'_>) -> Result<Answer, String>,
    ) -> Result<Answer, String> {
        let parts = self.0.both()?;
        let motions = asked.motions()?;
        answer(&asked.query(parts, &motions)?)
    }
}

impl Request {
    fn motions(&self) -> Result<[Motion; 2], String> {
        let motion = |kind: Option<&Kind>, start: Pose| {
            kind.map_or(Ok(Motion::at_rest(start)), |kind| kind.motion_from(start))
        };
        let (moving, fixed) = (pose(self.moving_pose, "moving")?, pose(self.fixed_pose, "fixed")?);
        Ok([
            motion(self.moving_motion.as_ref(), moving)?,
            motion(self.fixed_motion.as_ref(), fixed)?,
        ])
    }

    fn query<'a>(
        &self,
        [moving, fixed]: [&'a Part; 2],
        [moves, other]: &'a [Motion; 2],
    ) -> Result<Query<'a>, String> {
        let query = if let (Part::Convex(p), Part::Convex(q)) = (moving, fixed) {
            let cast = MotionCast::new(p.body.with_motion(moves), q.body.with_motion(other));
            match self.tolerance {
                Some(_) if self.min_gap > 0.0 => {
                    return Err("a gap and a tolerance are both given; convex bodies accept only one of them".into());
                }
                Some(depth) => cast.and_then(|cast| cast.with_tolerance(depth)),
                None => cast.and_then(|cast| cast.with_min_gap(self.min_gap)),
            }
            .map(Query::Convex)
        } else {
            let precisions = [precision(moving), precision(fixed)];
            moving
                .solid()
                .and_then(|p| {
                    let (p, q) = (p.with_motion(moves), fixed.solid()?.with_motion(other));
                    between_motions(p, q, precisions, self.tolerance)
                })
                .and_then(|cast| cast.with_min_gap(self.min_gap))
                .map(Query::Solid)
        };
        query.map_err(|error| error.to_string())
    }
}

const fn precision(part: &Part) -> f64 {
    match part {
        Part::Convex(of) => of.precision,
        Part::Solid(of) => of.precision,
    }
}

fn first_contact(query: &Query<'_>) -> Result<Answer, String> {
    let message = |error: QueryError| error.to_string();
    Ok(Answer::from_facts(&match query {
        Query::Convex(cast) => {
            let outcome = cast.first_contact().map_err(message)?;
            motion_answer(
                "convex",
                MotionRecord::from_outcome(&outcome, cast),
                &outcome,
                cast.bodies(),
            )
        }
        Query::Solid(cast) => {
            let outcome = cast.first_contact().map_err(message)?;
            motion_answer("solid", MotionRecord::of_solids(&outcome, cast), &outcome, cast.bodies())
        }
    }))
}

/// Builds the answer of an outcome.
fn motion_answer<P, B: Body>(
    kind: &'static str,
    record: MotionRecord,
    outcome: &MotionOutcome<P>,
    bodies: [&B; 2],
) -> MotionAnswer {
    let (MotionOutcome::Contact(at) | MotionOutcome::Grazing(at) | MotionOutcome::Undecided(at)) =
        outcome
    else {
        return MotionAnswer { kind, record, pose: None, lit: None };
    };
    let MotionContact { poses, features, .. } = at;
    let lit = features.map(|Features { moving, fixed }| ContactHighlight {
        moving: FeatureHighlight::from_feature(moving, bodies[0]),
        fixed: FeatureHighlight::from_feature(fixed, bodies[1]),
    });
    MotionAnswer { kind, record, pose: Some(pose_numbers(poses[0])), lit }
}

/// Returns a pose as seven numbers.
fn pose_numbers(pose: Pose) -> [f64; 7] {
    let (at, turn) = (pose.translation(), pose.rotation());
    [at.x, at.y, at.z, turn.x, turn.y, turn.z, turn.w]
}

/// Builds the proof and checks it without a search.
fn prove_contact(query: &Query<'_>) -> Result<Answer, String> {
    let message = |error: QueryError| error.to_string();
    let (checked, entries) = match query {
        Query::Convex(cast) => {
            let outcome = cast.first_contact().map_err(message)?;
            let proof = outcome.proof();
            (cast.verify(proof), proof.plane_count())
        }
        Query::Solid(cast) => {
            let outcome = cast.certified_first_contact().map_err(message)?;
            let proof = outcome.proof();
            (cast.verify(proof), proof.spans.iter().map(|span| span.cover.len()).sum())
        }
    };
    Ok(check_answer(checked, entries))
}

/// Returns the result of a check.
fn check_answer(checked: Result<[f64; 2], MotionProofError>, entries: usize) -> Answer {
    Answer::from_facts(&match checked {
        // An infinite bound, which claims no contact, is written as null.
        Ok(proven) => json!({ "holds": true, "proven": proven, "entries": entries }),
        Err(error) => json!({ "holds": false, "because": error.to_string() }),
    })
}
