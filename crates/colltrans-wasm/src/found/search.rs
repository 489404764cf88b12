//! What a search did: the library's recording, as a page reads it.

use colltrans::observe::{Event, Recording, Touch};
use colltrans::{
    Cast, ConvexPolyhedron, Focus, Outcome, Pose, QueryError, Solver, Steps, Tracker, cta,
};
use glam::{DVec2, DVec3};
use serde::Serialize;
use serde_json::{Value, json};

use super::question::Search;
use crate::answer::Answer;

/// An answer to `search`.
#[derive(Serialize)]
struct Found {
    events: Vec<Value>,
    steps: Steps,
    /// In the neighbourhood of the solution of the query before.
    #[serde(skip_serializing_if = "Option::is_none")]
    region: Option<Around>,
    /// Of a tracker, after the query before.
    #[serde(skip_serializing_if = "Option::is_none")]
    tracked: Option<Steps>,
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

pub(crate) fn search(bodies: [&ConvexPolyhedron; 2], asked: &Search) -> Result<Answer, String> {
    let cast = asked.pair.query(bodies)?;
    let before = asked.after.as_ref().map(|before| before.query(bodies)).transpose()?;
    found(&cast, before.as_ref()).map(|found| Answer::of(&found)).map_err(|error| error.to_string())
}

fn found(cast: &Cast, before: Option<&Cast>) -> Result<Found, QueryError> {
    let mut recording = Recording::default();
    let steps = cast.first_contact_observed(&mut recording)?.steps();
    let mut found = Found { events: told_of(&recording), steps, region: None, tracked: None };
    let Some(before) = before else { return Ok(found) };
    if cast.options().solver == Solver::Cta {
        found.region = region(before, cast)?;
    }
    let mut tracker = Tracker::new();
    tracker.first_contact_observed(before, &mut Recording::default())?;
    let outcome = tracker.first_contact_observed(cast, &mut Recording::default())?;
    found.tracked = Some(outcome.steps());
    Ok(found)
}

/// The minimisation again, in the neighbourhood `N(p)` of the solution `p` of the query before: a
/// square of pairs of levels around those of its contact points, whose half-side is how far those
/// have moved apart sideways (the paper, section III-D).
fn region(before: &Cast, cast: &Cast) -> Result<Option<Around>, QueryError> {
    let outcome = before.first_contact_observed(&mut Recording::default())?;
    let Outcome::Contact(contact) = outcome else { return Ok(None) };
    let points = contact.points(before);
    let back = |pose: Pose, v: DVec3| pose.matrix().transpose() * (v - pose.translation());
    let p = back(before.moving_pose(), points.on_moving);
    let q = back(before.fixed_pose(), points.on_fixed);
    let apart = cast.fixed_pose().transform_point(q) - cast.moving_pose().transform_point(p);
    let half_side = apart.reject_from(cast.direction()).length();
    let focus = Focus::NONE.with_region(cta::Region::Fixed(half_side));
    let (mut seen, mut tracker) = (Recording::default(), Tracker::new().with_focus(focus)?);
    tracker.first_contact_observed(before, &mut seen)?;
    seen.clear();
    let outcome = tracker.first_contact_observed(cast, &mut seen)?;
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

fn touch(touch: Touch) -> &'static str {
    match touch {
        Touch::Edges => "edges",
        Touch::Vertex => "vertex",
        Touch::Separated => "separated",
        Touch::Hidden => "hidden",
    }
}

fn event(event: &Event) -> Option<Value> {
    Some(match event {
        Event::Begun(frame) => {
            json!({ "begun": frame.world_from_shadow.to_cols_array_2d() })
        }
        Event::Support(support) => json!({
            "support": support.at.to_array(),
            "normal": support.normal.to_array(),
            "pair": [support.pair.moving, support.pair.fixed],
        }),
        Event::Portal(corners) => json!({ "portal": corners.map(|v| v.to_array()) }),
        Event::Sections(sections) => json!({
            "sections": sections.axes.map(|v| v.to_array()),
            "ranges": sections.ranges,
        }),
        Event::PlanarProblem(problem) => json!({
            "planar": problem.levels,
            "value": problem.value,
            "touch": touch(problem.touch),
            "gradient": problem.gradient.to_array(),
            "best": problem.best,
            "shifted": problem.shifted,
        }),
        Event::Cell(corners) => {
            json!({ "cell": corners.iter().map(DVec2::to_array).collect::<Vec<_>>() })
        }
        Event::ExitTest(solved) => json!({ "solved": solved }),
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
