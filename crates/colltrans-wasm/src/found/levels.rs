//! Computes `phi(x, y)` over a grid: the collision translation of two sections, each treated as a flat body.
//!
//! This slow and simple method checks the values of the minimisation. A section is the hull of the points in
//! which edges of the body cross a plane.
//!
//! Numbers of an answer: `phi` by moving level, then fixed level, in multiples of the direction (`f64`); NaN
//! if the sections miss each other or do not exist. The JSON has their count.

use colltrans::observe::Recording;
use colltrans::{Cast, ConvexPolyhedron, Outcome, Pose};
use glam::DVec3;
use serde_json::json;

use super::question::Levels;
use crate::answer::Answer;

/// Maximum number of pairs of levels in a question.
const MOST_PAIRS: usize = 1 << 14;

/// Answers the question `levels`.
pub(crate) fn levels_answer(
    bodies: [&ConvexPolyhedron; 2],
    asked: &Levels,
) -> Result<Answer, String> {
    if asked.moving.len().saturating_mul(asked.fixed.len()) > MOST_PAIRS {
        return Err(format!("more than {MOST_PAIRS} pairs of levels"));
    }
    let whole = asked.pair.query(bodies)?;
    let cut = |body: &ConvexPolyhedron, pose: Pose, axis: [f64; 3], levels: &[f64]| {
        // The axis in the body frame, in which levels are measured.
        let axis = pose.matrix().transpose() * DVec3::from_array(axis);
        levels.iter().map(|&level| section(body, axis, level)).collect::<Vec<_>>()
    };
    let moving = cut(bodies[0], whole.moving_pose(), asked.moving_axis, &asked.moving);
    let fixed = cut(bodies[1], whole.fixed_pose(), asked.fixed_axis, &asked.fixed);
    let mut answer = Answer::from_facts(&json!({ "values": moving.len() * fixed.len() }));
    for p in &moving {
        for q in &fixed {
            let value = p
                .as_ref()
                .zip(q.as_ref())
                .map_or(f64::NAN, |(p, q)| section_translation(p, q, &whole));
            answer.numbers.extend(value.to_le_bytes());
        }
    }
    Ok(answer)
}

/// Computes a section of a body as a flat body; `None` if there is none.
fn section(whole: &ConvexPolyhedron, axis: DVec3, level: f64) -> Option<ConvexPolyhedron> {
    let vertices = whole.vertices();
    let mut points = Vec::new();
    for v in 0..vertices.len() as u32 {
        let from = vertices[v as usize];
        let low = axis.dot(from);
        if low > level {
            continue;
        }
        if low == level {
            points.push(from);
        }
        for &w in whole.neighbours(v) {
            let to = vertices[w as usize];
            let high = axis.dot(to);
            if high > level {
                points.push(from.lerp(to, (level - low) / (high - low)));
            }
        }
    }
    ConvexPolyhedron::from_points(&points).ok()
}

/// Computes the collision translation of two sections; NaN if they miss each other.
fn section_translation(moving: &ConvexPolyhedron, fixed: &ConvexPolyhedron, whole: &Cast) -> f64 {
    let (p, q) = (moving.at(whole.moving_pose()), fixed.at(whole.fixed_pose()));
    let cast = Cast::new(p, q, whole.direction());
    match cast.and_then(|cast| cast.first_contact_observed(&mut Recording::default())) {
        Ok(Outcome::Contact(contact)) => contact.translation,
        Ok(Outcome::Grazing(grazing)) => grazing.contact.translation,
        _ => f64::NAN,
    }
}
