//! What a search did: the library's recording, as a page reads it.

use colltrans::observe::{Event, Recording};
use colltrans::{Cast, Focus, Outcome, Pose, Region, Solver, Steps, Tracker};
use glam::DVec3;
use serde::Serialize;
use serde_json::{Value, json};

use crate::answer::{Answer, Refusal};
use crate::body::Hull;
use crate::convex::query;
use crate::question::Search;

/// An answer to `search`.
#[derive(Serialize)]
struct Found {
    events: Vec<Value>,
    steps: Steps,
    /// In the neighbourhood of the solution of the query before.
    #[serde(skip_serializing_if = "Option::is_none")]
    region: Option<Around>,
    /// After the query before.
    #[serde(skip_serializing_if = "Option::is_none")]
    tracked: Option<Tracked>,
}

#[derive(Serialize)]
struct Around {
    /// Levels.
    center: [f64; 2],
    /// Half the side of the square, along axes as long as levels count.
    half: f64,
    /// The same as a length.
    delta: f64,
    steps: Steps,
    events: Vec<Value>,
}

#[derive(Serialize)]
struct Tracked {
    steps: Steps,
    events: Vec<Value>,
}

pub(crate) fn search(bodies: [&Hull; 2], asked: &Search) -> Result<Answer, Refusal> {
    let cast = query(bodies, &asked.pair)?;
    let mut recording = Recording::default();
    let outcome = cast.first_contact_observed(&mut recording).map_err(|error| error.to_string())?;
    let events = told_of(&recording);
    let solver = if cast.options().solver == Solver::Cta { Solver::Cta } else { Solver::Portal };
    let mut found = Found { events, steps: outcome.steps(), region: None, tracked: None };
    if let Some(before) = &asked.after {
        let first = query(bodies, before)?;
        if solver == Solver::Cta {
            found.region = region(&first, &cast)?;
        }
        let (mut tracker, mut seen) = (Tracker::new(), Recording::default());
        let mut outcome = None;
        for asked in [&first, &cast] {
            seen.clear();
            let answered = tracker.first_contact_observed(asked, &mut seen);
            outcome = Some(answered.map_err(|error| error.to_string())?);
        }
        let steps = outcome.map(|outcome| outcome.steps()).unwrap_or_default();
        found.tracked = Some(Tracked { steps, events: told_of(&seen) });
    }
    Ok(Answer::of(&found))
}

/// The minimisation again, in the neighbourhood `N(p)` of the solution `p` of the query before: a
/// square of pairs of levels around those of its contact points, whose half-side is how far those
/// have moved apart sideways (the paper, section III-D).
fn region(before: &Cast, cast: &Cast) -> Result<Option<Around>, Refusal> {
    let said = |error: colltrans::QueryError| error.to_string();
    let outcome = before.first_contact_observed(&mut Recording::default()).map_err(said)?;
    let Outcome::Contact(contact) = outcome else { return Ok(None) };
    let points = contact.points(before);
    let back = |pose: Pose, v: DVec3| pose.matrix().transpose() * (v - pose.translation());
    let p = back(before.moving_pose(), points.on_moving);
    let q = back(before.fixed_pose(), points.on_fixed);
    let apart = cast.fixed_pose().transform_point(q) - cast.moving_pose().transform_point(p);
    let half_side = apart.reject_from(cast.direction()).length();
    let focus = Focus::NONE.with_region(Region::Fixed(half_side));
    let (mut seen, mut tracker) =
        (Recording::default(), Tracker::new().with_focus(focus).map_err(said)?);
    tracker.first_contact_observed(before, &mut seen).map_err(said)?;
    seen.clear();
    let outcome = tracker.first_contact_observed(cast, &mut seen).map_err(said)?;
    let level = |axis: DVec3, pose: Pose, v: DVec3| axis.dot(pose.matrix() * v);
    let axes = seen.events().iter().find_map(|event| match event {
        Event::Sections(sections) => Some(sections.axes),
        _ => None,
    });
    let Some([a, b]) = axes else { return Ok(None) };
    Ok(Some(Around {
        center: [level(a, cast.moving_pose(), p), level(b, cast.fixed_pose(), q)],
        half: half_side * a.length(),
        delta: half_side,
        steps: outcome.steps(),
        events: told_of(&seen),
    }))
}

fn told_of(seen: &Recording) -> Vec<Value> {
    seen.events().iter().filter_map(event).collect()
}

fn array(v: DVec3) -> [f64; 3] {
    v.to_array()
}

fn event(event: &Event) -> Option<Value> {
    Some(match event {
        Event::Begun(frame) => {
            json!({ "begun": frame.world_from_shadow.to_cols_array_2d() })
        }
        Event::Support(support) => json!({
            "support": array(support.at),
            "normal": array(support.normal),
            "pair": [support.pair.moving, support.pair.fixed],
        }),
        Event::Portal(corners) => json!({ "portal": corners.map(array) }),
        Event::Sections(sections) => json!({
            "sections": sections.axes.map(array),
            "ranges": sections.ranges,
        }),
        Event::PlanarProblem(problem) => json!({
            "planar": problem.levels,
            "value": problem.value,
            "meets": problem.meets,
            "gradient": problem.gradient.to_array(),
            "shifted": problem.shifted,
        }),
        Event::Cut(cut) => json!({
            "cut": cut.gradient.to_array(),
            "origin": cut.origin.to_array(),
            "limit": cut.limit,
            "lower": cut.lower,
            "upper": cut.upper,
        }),
        _ => return None,
    })
}
