//! `phi(x, y)` over a grid: the collision translation of two sections, each a flat body of its own.
//!
//! The slow and obvious way, and so a check of what the minimisation says of it: a section is the
//! hull of the points in which the body's edges cross a plane.
//!
//! Numbers of an answer: `phi` by moving level, then fixed level, in multiples of the direction
//! (`f64`); not a number where sections miss each other or are none. Then the sections' corners, in
//! the world, at their start: the JSON tells how many each has.

use colltrans::observe::Recording;
use colltrans::{Cast, ConvexPolyhedron, Outcome, Pose};
use glam::DVec3;
use serde_json::json;

use crate::answer::{Answer, Refusal};
use crate::body::Hull;
use crate::convex::query;
use crate::question::Levels;

/// Pairs of levels that are answered at once.
const MOST_PAIRS: usize = 1 << 14;

pub(crate) fn levels(bodies: [&Hull; 2], asked: &Levels) -> Result<Answer, Refusal> {
    if asked.at[0].len().saturating_mul(asked.at[1].len()) > MOST_PAIRS {
        return Err(format!("more than {MOST_PAIRS} pairs of levels").into());
    }
    let whole = query(bodies, &asked.pair)?;
    let cut = |body: &ConvexPolyhedron, pose: Pose, axis: [f64; 3], levels: &[f64]| {
        // The axis in the body's frame: a level is that of a point of it.
        let axis = pose.matrix().transpose() * DVec3::from_array(axis);
        levels.iter().map(|level| Section::new(body, &pose, axis, *level)).collect::<Vec<_>>()
    };
    let moving = cut(whole.moving(), whole.moving_pose(), asked.axes[0], &asked.at[0]);
    let fixed = cut(whole.fixed(), whole.fixed_pose(), asked.axes[1], &asked.at[1]);
    let mut values = Vec::with_capacity(moving.len() * fixed.len());
    for p in &moving {
        for q in &fixed {
            values.push(phi(p, q, &whole));
        }
    }
    let counts =
        |sections: &[Section]| sections.iter().map(|s| s.corners.len()).collect::<Vec<_>>();
    let mut answer = Answer::of(&json!({ "moving": counts(&moving), "fixed": counts(&fixed) }));
    let corners = moving.iter().chain(&fixed).flat_map(|s| &s.corners).flat_map(DVec3::to_array);
    values.into_iter().chain(corners).for_each(|x| answer.numbers.extend(x.to_le_bytes()));
    Ok(answer)
}

/// A section of a body, as a flat body.
struct Section {
    body: Option<ConvexPolyhedron>,
    /// In the world, once around.
    corners: Vec<DVec3>,
}

impl Section {
    fn new(whole: &ConvexPolyhedron, pose: &Pose, axis: DVec3, level: f64) -> Self {
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
        let body = ConvexPolyhedron::from_points(&points).ok();
        let corners = ring(&points, axis).into_iter().map(|p| pose.transform_point(p)).collect();
        Self { body, corners }
    }
}

/// The points of a convex polygon, ordered around its middle.
fn ring(points: &[DVec3], axis: DVec3) -> Vec<DVec3> {
    let middle = points.iter().sum::<DVec3>() / points.len().max(1) as f64;
    let (e, f) = axis.normalize_or_zero().any_orthonormal_pair();
    let mut around: Vec<(f64, DVec3)> =
        points.iter().map(|&p| ((p - middle).dot(f).atan2((p - middle).dot(e)), p)).collect();
    around.sort_by(|a, b| a.0.total_cmp(&b.0));
    around.into_iter().map(|(_, p)| p).collect()
}

fn phi(moving: &Section, fixed: &Section, whole: &Cast) -> f64 {
    let (Some(p), Some(q)) = (&moving.body, &fixed.body) else { return f64::NAN };
    let cast = Cast::new(p.at(whole.moving_pose()), q.at(whole.fixed_pose()), whole.direction());
    match cast.and_then(|cast| cast.first_contact_observed(&mut Recording::default())) {
        Ok(Outcome::Contact(contact)) => contact.translation,
        Ok(Outcome::Grazing(grazing)) => grazing.contact.translation,
        _ => f64::NAN,
    }
}
