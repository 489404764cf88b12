//! What a search did: the library's recording, as a page reads it.

use colltrans::observe::{Event, Recording};
use colltrans::{NarrowFrom, Narrowing, Options, Solver, Tracker};
use glam::DVec3;
use serde_json::{Value, json};

use crate::body::Hull;
use crate::convex::{query, work};
use crate::desk::{Answer, Refusal};
use crate::question::Search;

pub(crate) fn search(bodies: [&Hull; 2], asked: &Search) -> Result<Answer, Refusal> {
    let mut cast = query(bodies, &asked.pair)?;
    if let Some(gap) = asked.from_center {
        let narrowing = Narrowing { start: NarrowFrom::Center, gap };
        let options = Options { narrowing, ..cast.options() };
        cast = cast.with_options(options).map_err(|error| error.to_string())?;
    }
    let mut recording = Recording::default();
    let outcome = cast.first_contact_observed(&mut recording).map_err(|error| error.to_string())?;
    let events: Vec<Value> = recording.events().iter().filter_map(event).collect();
    let solver = if cast.options().solver == Solver::Cta { Solver::Cta } else { Solver::Portal };
    let mut told = json!({
        "events": events,
        "steps": work(solver, &outcome.steps()),
    });
    if let Some(before) = &asked.after {
        let first = query(bodies, before)?;
        let (mut tracker, mut seen) = (Tracker::new(), Recording::default());
        let mut outcome = None;
        for asked in [&first, &cast] {
            seen.clear();
            let answered = tracker.first_contact_observed(asked, &mut seen);
            outcome = Some(answered.map_err(|error| error.to_string())?);
        }
        let steps = outcome.map(|outcome| outcome.steps()).unwrap_or_default();
        told["tracked"] = json!({
            "steps": work(solver, &steps),
            "from": format!("{:?}", steps.started_from).to_lowercase(),
            "events": seen.events().iter().filter_map(event).collect::<Vec<_>>(),
        });
    }
    Ok(Answer::of(&told))
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
