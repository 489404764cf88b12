//! Results as JSON, for the command line and for web pages.
//!
//! Parts are referred to by name. Directions have length 1. `docs/guide/assemblies.md` describes the fields,
//! and `docs/answers.schema.json` defines them.

use colltrans::solid::ShellKind;
use glam::DVec3;
use serde_json::{Value, json};

use crate::bodies::{Bodies, Fit};
use crate::hints::Hint;
use crate::liaisons::Liaison;
use crate::map::{Region, RemovalMap};
use crate::matrix::{Matrix, Meeting};
use crate::part::{Assembly, Part};
use crate::plan::{Leg, Moves, Passed, Plan, Step, Stuck, Turn, TurnProof};
use crate::roles::{PairFit, Role, Tolerated};
use crate::rooms::PartRoom;
use crate::start::{Overlap, Start};
use crate::suggest::Suggestion;

/// Returns a part as given in the file.
pub fn part(part: &Part) -> Value {
    let bounds = part.solid().volume_bounds();
    // Open surfaces have no volume.
    let volume = bounds.map(|_| part.solid().volume());
    let mut object = json!({
        "name": part.name(), "facets": part.facets(), "volume": volume, "volume_bounds": bounds
    });
    if part.is_surface() {
        let count = |kind: ShellKind| (kind.name().to_owned(), part.solid().report().count(kind));
        object["shells"] = ShellKind::ALL.into_iter().map(count).collect();
    }
    if let Some(error) = part.chord_error() {
        object["chord_error"] = json!(error);
    }
    if !part.defects().is_empty() {
        object["defects"] = json!(part.defects());
    }
    object
}

/// Returns the pairs that overlap at the start.
pub fn overlaps(assembly: &Assembly, start: &Start) -> Value {
    let to_json = |o: &Overlap| {
        json!({
            "parts": assembly.names(&o.parts),
            "least_tolerance": o.depth,
            "remains": o.remains,
        })
    };
    start.overlaps.iter().map(to_json).collect()
}

/// Returns the suggested roles and tolerances of overlapping pairs.
pub fn suggestions(assembly: &Assembly, suggestions: &[Suggestion]) -> Value {
    let to_json = |s: &Suggestion| {
        json!({
            "parts": assembly.names(&s.parts),
            "role": s.fit.role.map(Role::name),
            "tolerance": s.fit.tolerance,
            "why": s.why,
        })
    };
    suggestions.iter().map(to_json).collect()
}

/// Returns the hints about parts, for example about identical ones.
pub fn hints(assembly: &Assembly, hints: &[Hint]) -> Value {
    let to_json = |hint: &Hint| {
        json!({
            "kind": hint.kind.name(),
            "parts": assembly.names(&hint.parts),
            "words": hint.words,
        })
    };
    hints.iter().map(to_json).collect()
}

/// Returns the pairs with a fit of their own and the contacts that it tolerates.
pub fn pairs(bodies: &Bodies) -> Value {
    let to_json = |(parts, fit): ([usize; 2], PairFit)| {
        let tolerated = bodies.tolerated(parts)?;
        Some(passed_json(bodies.assembly(), &Passed { parts, role: fit.role, tolerated }))
    };
    bodies.assembly().pairs().filter_map(to_json).collect()
}

/// Returns the pairs that touch.
pub fn liaisons(assembly: &Assembly, liaisons: &[Liaison]) -> Value {
    let to_json = |l: &Liaison| {
        json!({
            "parts": assembly.names(&l.parts),
            "area": l.area(),
            "area_bounds": l.area_bounds(),
            "center": l.center().to_array(),
        })
    };
    liaisons.iter().map(to_json).collect()
}

/// Returns how far one part moves along unit direction `d` until another part stops it.
pub fn room(bodies: &Bodies, part: usize, d: DVec3, room: &PartRoom) -> Value {
    let mut object = free_travel_json(bodies, d, room);
    object["part"] = json!(bodies.assembly().parts()[part].name());
    let PartRoom::Blocked { stop, .. } = room else { return object };
    let name = match bodies.fit() {
        Fit::Tolerance(_) | Fit::Chords { .. } => {
            object["translation"] = json!(stop.translation.value);
            object["translation_bounds"] = json!(stop.translation.bounds());
            "shrunk_distance"
        }
        Fit::Apart(_) => "kept_distance",
    };
    object[name] = json!(stop.displaced.value);
    object[format!("{name}_bounds")] = json!(stop.displaced.bounds());
    object["point"] = json!(stop.point.to_array());
    object["normal"] = json!(stop.normal.to_array());
    object
}

/// Returns the outcome, distance and blocking part of a motion, without details of the contact.
fn free_travel_json(bodies: &Bodies, d: DVec3, room: &PartRoom) -> Value {
    let distance = room.distance();
    json!({
        "direction": d.to_array(),
        "outcome": room.outcome(),
        "distance": distance.is_finite().then_some(distance),
        "by": room.by().map(|k| bodies.assembly().parts()[k].name()),
    })
}

/// Returns the ordered pairs that are not free along a direction of a matrix.
pub fn meetings(assembly: &Assembly, matrix: &Matrix, direction: usize) -> Value {
    let name = |part: usize| assembly.parts()[part].name();
    let to_json = |m: &Meeting| {
        json!({
            "moving": name(m.moving),
            "fixed": name(m.fixed),
            "outcome": if m.stop.is_some() { "blocked" } else { "overlapping" },
            "distance": m.distance(),
        })
    };
    matrix.meetings(direction).iter().map(to_json).collect()
}

/// Returns the fields of a plan.
///
/// | field | content |
/// |---|---|
/// | `plan` | the steps |
/// | `stages` | ranges of steps that are described as one, as the first and the last step |
/// | `rounds` | steps that can be done at the same time |
/// | `assembly` | the steps in the order of assembly, with those that each needs |
/// | `last` | the parts from which all others were removed; empty if parts are left |
/// | `left` | the parts that stay: fixed, or not moved by any direction |
/// | `stuck` | the interlocked groups |
/// | `wanted` | the requested removal, if any |
pub fn plan(bodies: &Bodies, plan: &Plan) -> Value {
    let steps: Vec<Value> = plan.steps.iter().map(|s| step_json(bodies.assembly(), s)).collect();
    let stuck: Vec<Value> = plan.stuck.iter().map(|s| stuck_json(bodies, s)).collect();
    let names = |parts: &[usize]| json!(bodies.assembly().names(parts));
    let stages = plan.stages().into_iter().map(|stage| {
        let takes = plan.takes(bodies.assembly(), &stage);
        let (first, last) = (stage.start, stage.end - 1);
        json!({ "takes": takes, "steps": [first, last], "travel": plan.travel(&stage) })
    });
    let stages: Vec<Value> = stages.collect();
    let put = |(step, after): (usize, Vec<usize>)| json!({ "step": step, "after": after });
    let mut object = json!({
        "plan": steps,
        "stages": stages,
        "rounds": plan.rounds(),
        "assembly": plan.assembly().into_iter().map(put).collect::<Vec<_>>(),
        "last": names(&plan.last),
        "left": names(&plan.left),
        "stuck": stuck,
    });
    if let Some(wanted) = &plan.wanted {
        object["wanted"] = json!({
            "parts": names(&wanted.parts),
            "others": names(&wanted.others),
            "least": wanted.least,
            "out": wanted.out,
        });
    }
    object
}

/// Returns a step of a plan.
fn step_json(assembly: &Assembly, step: &Step) -> Value {
    let mut object = json!({
        "parts": assembly.names(&step.parts),
        "direction": step.direction.to_array(),
        "travel": step.travel.value,
        "travel_bounds": step.travel.bounds(),
        "path": path_json(assembly, &step.path),
    });
    if let Some(name) = assembly.constraints().name(&step.parts) {
        object["subassembly"] = json!(name);
    }
    if !step.back.is_empty() {
        object["back"] = path_json(assembly, &step.back);
    }
    if !step.ignored.is_empty() {
        let pairs: Vec<_> = step.ignored.iter().map(|pair| assembly.names(pair)).collect();
        object["ignored"] = json!(pairs);
    }
    if !step.passed.is_empty() {
        object["passed"] = step.passed.iter().map(|passed| passed_json(assembly, passed)).collect();
    }
    for (name, parts) in [("falls", &step.falls), ("off_balance", &step.off_balance)] {
        if !parts.is_empty() {
            object[name] = json!(assembly.names(parts));
        }
    }
    object["after"] = json!(step.after);
    if let Some(within) = step.within {
        object["within"] = json!(within);
    }
    if !step.surfaces.is_empty() {
        object["surfaces"] = json!(assembly.names(&step.surfaces));
    }
    object
}

/// Returns the contacts of a pair that a step tolerates.
fn passed_json(assembly: &Assembly, passed: &Passed) -> Value {
    let mut object = json!({
        "parts": assembly.names(&passed.parts),
        "role": passed.role.map(Role::name),
        "words": passed.tolerated.words(passed.role),
    });
    match passed.tolerated {
        Tolerated::Within(length) | Tolerated::Bent(length) => object["tolerance"] = json!(length),
        Tolerated::Core(radius) => object["core_radius"] = json!(radius),
        Tolerated::Crossing | Tolerated::AsOne => (),
    }
    object
}

/// Returns the moves of a path.
fn path_json(assembly: &Assembly, legs: &[Leg]) -> Value {
    let to_json = |leg: &Leg| {
        let mut object = json!({
            "parts": assembly.names(&leg.parts),
            "direction": leg.direction.to_array(),
            "travel": leg.travel,
        });
        if let Some(turn) = &leg.turn {
            object["turn"] = turn_json(leg, turn);
        }
        object
    };
    legs.iter().map(to_json).collect()
}

/// Returns a move along a screw.
fn turn_json(leg: &Leg, turn: &Turn) -> Value {
    let mut object = json!({
        "point": turn.point.to_array(),
        "axis": leg.direction.to_array(),
        "turns": turn.turns,
        "pitch": leg.travel / turn.turns,
        "phase": turn.phase,
        "aside": turn.aside.to_array(),
        "words": turn.words(),
    });
    match &turn.proof {
        Ok(TurnProof { tolerance, pairs, .. }) => {
            object["proof"] = json!({ "tolerance": tolerance, "pairs": pairs });
        }
        Err(why) => object["not_proven"] = json!(why),
    }
    object
}

/// Returns the result of the search for paths of several moves.
fn moves_json(moves: &Moves) -> Value {
    match moves {
        Moves::NotAsked(why) => json!({ "not_asked": why }),
        Moves::NotKept => json!({ "not_kept": true }),
        Moves::Proven { cells } => json!({ "proven": cells }),
        Moves::NotFound { legs, searched } => json!({
            "legs": legs,
            "directions": searched.directions,
            "places": searched.places,
            "complete": searched.complete,
        }),
    }
}

/// Returns an interlocked group.
fn stuck_json(bodies: &Bodies, stuck: &Stuck) -> Value {
    let assembly = bodies.assembly();
    let set = |(parts, d): &(Vec<usize>, DVec3)| json!({ "parts": assembly.names(parts), "direction": d.to_array() });
    let holds = stuck.holds.iter().map(|hold| {
        let least: Vec<Value> = hold.by.iter().map(set).collect();
        json!({ "part": assembly.parts()[hold.part].name(), "least": least })
    });
    let mut object = json!({
        "parts": assembly.names(&stuck.parts),
        "because": stuck.because(bodies),
        "directions": stuck.directions,
        "proof": match stuck.proven {
            Some(cells) => json!({ "proven": cells }),
            None => json!({ "asked": stuck.directions }),
        },
        "moves": moves_json(&stuck.moves),
        "holds": holds.collect::<Vec<_>>(),
    });
    if stuck.constrained {
        object["constrained"] = json!(true);
    }
    object
}

/// Returns a removal map without its samples: free regions with points of their borders, isolated free
/// directions, and either the exact result or the reason why the map is only sampled.
pub fn regions(assembly: &Assembly, map: &RemovalMap) -> Value {
    let region = |r: &Region| {
        let border: Vec<[f64; 3]> = r.border.iter().map(DVec3::to_array).collect();
        json!({ "solid_angle": r.solid_angle, "center": r.center.to_array(), "border": border })
    };
    let mut object = json!({
        "parts": assembly.names(&map.group),
        "free_share": map.free_share(),
        "regions": map.regions.iter().map(region).collect::<Vec<_>>(),
        "isolated": map.isolated.iter().map(DVec3::to_array).collect::<Vec<_>>(),
    });
    match &map.cover {
        Ok(cover) => object["exactly"] = json!(cover.record),
        Err(why) => object["sampled"] = json!(why),
    }
    object
}

/// Returns a removal map with all its samples.
pub fn map(bodies: &Bodies, map: &RemovalMap) -> Value {
    let mut object = regions(bodies.assembly(), map);
    let samples = map.sphere.directions.iter().zip(&map.rooms);
    object["samples"] = samples.map(|(d, room)| free_travel_json(bodies, *d, room)).collect();
    object
}
