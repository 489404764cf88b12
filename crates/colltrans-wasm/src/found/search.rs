//! The recording of a search as the page reads it.

use colltrans::observe::{Event, Recording, SectionContact};
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
    /// The search in the neighbourhood of the solution of the previous query.
    #[serde(skip_serializing_if = "Option::is_none")]
    region: Option<Around>,
    /// The steps of a tracker after the previous query.
    #[serde(skip_serializing_if = "Option::is_none")]
    tracked: Option<Steps>,
}

#[derive(Serialize)]
struct Around {
    /// The levels at the centre of the square.
    center: [f64; 2],
    /// Half the side of the square, in levels along axes of any length.
    half: f64,
    /// Half the side of the square as a length.
    delta: f64,
    steps: Steps,
    events: Vec<Value>,
}

/// Answers the question `search`.
pub(crate) fn search_answer(
    bodies: [&ConvexPolyhedron; 2],
    asked: &Search,
) -> Result<Answer, String> {
    let cast = asked.pair.query(bodies)?;
    let before = asked.after.as_ref().map(|before| before.query(bodies)).transpose()?;
    record_search(&cast, before.as_ref())
        .map(|found| Answer::from_facts(&found))
        .map_err(|error| error.to_string())
}

/// Records a search, and the searches of a tracker after a previous query.
fn record_search(cast: &Cast, before: Option<&Cast>) -> Result<Found, QueryError> {
    let mut recording = Recording::default();
    let steps = cast.first_contact_observed(&mut recording)?.steps();
    let mut found = Found { events: event_values(&recording), steps, region: None, tracked: None };
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

/// Repeats the minimisation in the neighbourhood `N(p)` of the solution `p` of the previous query (the paper,
/// section III-D).
///
/// The neighbourhood is a square of pairs of levels around those of the contact points. Its half-side is the
/// lateral distance by which these points have moved apart.
fn region(before: &Cast, cast: &Cast) -> Result<Option<Around>, QueryError> {
    let outcome = before.first_contact_observed(&mut Recording::default())?;
    let Outcome::Contact(contact) = outcome else { return Ok(None) };
    let points = contact.witness_points(before);
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
        events: event_values(&seen),
    }))
}

/// Converts the events of a recording to JSON.
fn event_values(seen: &Recording) -> Vec<Value> {
    seen.events().iter().filter_map(event_value).collect()
}

/// Returns the name of a kind of contact of two sections.
fn touch_name(touch: SectionContact) -> &'static str {
    match touch {
        SectionContact::Edges => "edges",
        SectionContact::Vertex => "vertex",
        SectionContact::Separated => "separated",
        SectionContact::Hidden => "hidden",
    }
}

/// Converts an event to JSON; `None` for events that the page does not show.
fn event_value(event: &Event) -> Option<Value> {
    Some(match event {
        Event::SearchStarted(frame) => {
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
            "touch": touch_name(problem.touch),
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
