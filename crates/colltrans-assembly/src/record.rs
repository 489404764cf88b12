//! Results as JSON, for the command line and for web pages.
//!
//! Parts are referred to by name. Directions have length 1. `colltrans help json` lists the fields,
//! and `docs/answers.schema.json` defines them.

use colltrans::solid::ShellKind;
use glam::DVec3;
use serde_json::{Value, json};

use crate::bodies::{Bodies, Fit};
use crate::fasteners::{Fastener, Unscrewing};
use crate::hints::Hint;
use crate::liaisons::Liaison;
use crate::map::{Region, RemovalMap};
use crate::matrix::{ContactMatrix, PairContact};
use crate::part::{Assembly, Part};
use crate::plan::{Interlocked, Leg, PathSearch, Plan, Step, ToleratedContact, Turn, TurnProof};
use crate::roles::{PairFit, PairTolerance, Role};
use crate::start::{Overlap, Start};
use crate::suggest::Suggestion;
use crate::travel::PartTravel;

/// Returns a part as given in the file.
pub fn part_json(part: &Part) -> Value {
    let bounds = part.solid().volume_bounds();
    // Open surfaces have no volume.
    let volume = bounds.map(|_| part.solid().volume());
    let mut object = json!({
        "name": part.name(), "facets": part.facet_count(), "volume": volume, "volume_bounds": bounds
    });
    if part.is_surface() {
        let count =
            |kind: ShellKind| (kind.name().to_owned(), part.solid().report().shell_count(kind));
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
pub fn overlaps_json(assembly: &Assembly, start: &Start) -> Value {
    let to_json = |o: &Overlap| {
        json!({
            "parts": assembly.part_names(&o.parts),
            "least_tolerance": o.depth,
            "remains": o.remains_with_fit,
        })
    };
    start.overlaps.iter().map(to_json).collect()
}

/// Returns the suggested roles and tolerances of overlapping pairs.
pub fn suggestions_json(assembly: &Assembly, suggestions: &[Suggestion]) -> Value {
    let to_json = |s: &Suggestion| {
        json!({
            "parts": assembly.part_names(&s.parts),
            "role": s.fit.role.map(Role::name),
            "tolerance": s.fit.tolerance,
            "why": s.reason,
        })
    };
    suggestions.iter().map(to_json).collect()
}

/// Returns the hints about parts, for example about identical ones.
pub fn hints_json(assembly: &Assembly, hints: &[Hint]) -> Value {
    let to_json = |hint: &Hint| {
        json!({
            "kind": hint.kind.name(),
            "parts": assembly.part_names(&hint.parts),
            "words": hint.description,
        })
    };
    hints.iter().map(to_json).collect()
}

/// Returns the pairs with a fit of their own and the contacts that it tolerates.
pub fn pairs_json(bodies: &Bodies) -> Value {
    let to_json = |(parts, fit): ([usize; 2], PairFit)| {
        let tolerated = bodies.tolerated_contacts(parts)?;
        Some(passed_json(bodies.assembly(), &ToleratedContact { parts, role: fit.role, tolerated }))
    };
    bodies.assembly().pair_fits().filter_map(to_json).collect()
}

/// Returns the pairs that touch.
pub fn liaisons_json(assembly: &Assembly, liaisons: &[Liaison]) -> Value {
    let to_json = |l: &Liaison| {
        json!({
            "parts": assembly.part_names(&l.parts),
            "area": l.area(),
            "area_bounds": l.area_bounds(),
            "center": l.centroid().to_array(),
        })
    };
    liaisons.iter().map(to_json).collect()
}

/// Returns how far one part moves along unit direction `d` until another part stops it.
pub fn part_travel_json(bodies: &Bodies, part: usize, d: DVec3, room: &PartTravel) -> Value {
    let mut object = free_travel_json(bodies, d, room);
    object["part"] = json!(bodies.assembly().parts()[part].name());
    let PartTravel::Blocked { stop, .. } = room else { return object };
    let name = match bodies.fit() {
        Fit::Tolerance(_) | Fit::Chords { .. } => {
            object["translation"] = json!(stop.translation.value);
            object["translation_bounds"] = json!(stop.translation.bounds());
            "offset_distance"
        }
        Fit::MinGap(_) => "kept_distance",
    };
    object[name] = json!(stop.shrunk_translation.value);
    object[format!("{name}_bounds")] = json!(stop.shrunk_translation.bounds());
    object["point"] = json!(stop.point.to_array());
    object["normal"] = json!(stop.normal.to_array());
    object
}

/// Returns the outcome, distance and blocking part of a motion, without details of the contact.
fn free_travel_json(bodies: &Bodies, d: DVec3, room: &PartTravel) -> Value {
    let distance = room.safe_distance();
    json!({
        "direction": d.to_array(),
        "outcome": room.outcome_name(),
        "distance": distance.is_finite().then_some(distance),
        "by": room.blocker().map(|k| bodies.assembly().parts()[k].name()),
    })
}

/// Returns the ordered pairs that are not free along a direction of a matrix.
pub fn contacts_json(assembly: &Assembly, matrix: &ContactMatrix, direction: usize) -> Value {
    let name = |part: usize| assembly.parts()[part].name();
    let to_json = |m: &PairContact| {
        json!({
            "moving": name(m.moving),
            "fixed": name(m.fixed),
            "outcome": if m.stop.is_some() { "blocked" } else { "overlapping" },
            "distance": m.safe_distance(),
        })
    };
    matrix.contacts_along(direction).iter().map(to_json).collect()
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
/// | `left` | the parts that stay and were to be removed: fixed, not moved by any direction, or an interlocked rest |
/// | `stuck` | the interlocked groups |
/// | `wanted` | the requested removal, if any |
pub fn plan_json(bodies: &Bodies, plan: &Plan) -> Value {
    let steps = plan.steps.iter().enumerate().map(|(k, step)| {
        let mut object = step_json(bodies.assembly(), step);
        let names = |parts: &[usize]| bodies.assembly().part_names(parts).join(", ");
        let reasons = plan.unproven_reasons(bodies, &(k..k + 1), names);
        if !reasons.is_empty() {
            object["unproven"] = json!(reasons);
        }
        object
    });
    let steps: Vec<Value> = steps.collect();
    let stuck: Vec<Value> = plan.interlocked.iter().map(|s| stuck_json(bodies, s)).collect();
    let names = |parts: &[usize]| json!(bodies.assembly().part_names(parts));
    let stages = plan.stages().into_iter().map(|stage| {
        let takes = plan.describe_stage(bodies.assembly(), &stage);
        let (first, last) = (stage.start, stage.end - 1);
        json!({ "takes": takes, "steps": [first, last], "travel": plan.stage_travel(&stage) })
    });
    let stages: Vec<Value> = stages.collect();
    let put = |(step, after): (usize, Vec<usize>)| json!({ "step": step, "after": after });
    let mut object = json!({
        "plan": steps,
        "stages": stages,
        "rounds": plan.parallel_rounds(),
        "assembly": plan.assembly_sequence().into_iter().map(put).collect::<Vec<_>>(),
        "last": names(&plan.base),
        "left": names(plan.parts_left()),
        "stuck": stuck,
    });
    if let Some(wanted) = &plan.selection {
        object["wanted"] = json!({
            "parts": names(&wanted.parts),
            "others": names(&wanted.others),
            "fasteners": names(&wanted.fasteners),
            "obstacles": names(&wanted.obstacles),
            "least": wanted.is_minimal,
            "out": wanted.is_complete,
        });
    }
    object
}

/// Returns a step of a plan.
fn step_json(assembly: &Assembly, step: &Step) -> Value {
    let mut object = json!({
        "parts": assembly.part_names(&step.parts),
        "direction": step.direction.to_array(),
        "travel": step.travel.value,
        "travel_bounds": step.travel.bounds(),
        "path": path_json(assembly, &step.path),
    });
    if let Some(name) = assembly.constraints().group_name(&step.parts) {
        object["subassembly"] = json!(name);
    }
    if !step.return_legs.is_empty() {
        object["back"] = path_json(assembly, &step.return_legs);
    }
    if let Some(turns) = &step.unscrewing {
        object["unscrew"] = unscrewing_json(turns);
    }
    if let Some(reach) = &step.tool {
        object["tool"] = json!({
            "name": reach.tool,
            "reaches": reach.blockers.is_empty(),
            "blockers": assembly.part_names(&reach.blockers),
            "words": reach.describe(assembly),
        });
    }
    if !step.ignored.is_empty() {
        let pairs: Vec<_> = step.ignored.iter().map(|pair| assembly.part_names(pair)).collect();
        object["ignored"] = json!(pairs);
    }
    if !step.tolerated.is_empty() {
        object["passed"] =
            step.tolerated.iter().map(|passed| passed_json(assembly, passed)).collect();
    }
    for (name, parts) in [("falls", &step.falling), ("off_balance", &step.off_balance)] {
        if !parts.is_empty() {
            object[name] = json!(assembly.part_names(parts));
        }
    }
    object["after"] = json!(step.predecessors);
    if let Some(within) = step.group_step {
        object["within"] = json!(within);
    }
    if !step.surfaces.is_empty() {
        object["surfaces"] = json!(assembly.part_names(&step.surfaces));
    }
    object
}

/// Returns the turns of a plain thread.
fn unscrewing_json(turns: &Unscrewing) -> Value {
    json!({
        "length": turns.length,
        "turns": turns.turns(),
        "pitch": turns.pitch,
        "standard": turns.standard.map(|size| format!("M{size}")),
        "words": turns.words(),
    })
}

/// Returns a fastener: kind, designation, sizes, axis, head, drive and thread.
pub fn fastener_json(fastener: &Fastener) -> Value {
    let mut object = json!({
        "kind": fastener.kind.name(),
        "size": fastener.designation,
        "diameter": fastener.diameter,
        "length": fastener.length,
        "width": fastener.width,
        "axis": fastener.axis.map(|v| v.to_array()),
        "words": fastener.details(),
    });
    if let Some(size) = fastener.metric {
        object["metric"] = json!(format!("M{size}"));
    }
    if let Some(head) = fastener.head {
        object["head"] = json!({ "form": head.name(), "height": fastener.head_height });
    }
    if let Some((drive, width)) = fastener.drive {
        object["drive"] = json!({ "form": drive.name(), "width": width });
    }
    if let Some(pitch) = fastener.pitch {
        object["pitch"] = json!(pitch);
    }
    if fastener.needs_name {
        object["by_name"] = json!(true);
    }
    object
}

/// Returns the contacts of a pair that a step tolerates.
fn passed_json(assembly: &Assembly, passed: &ToleratedContact) -> Value {
    let mut object = json!({
        "parts": assembly.part_names(&passed.parts),
        "role": passed.role.map(Role::name),
        "words": passed.tolerated.describe(passed.role),
    });
    match passed.tolerated {
        PairTolerance::Within(length) | PairTolerance::Snap(length) => {
            object["tolerance"] = json!(length);
        }
        PairTolerance::Core(radius) => object["core_radius"] = json!(radius),
        PairTolerance::Crossing | PairTolerance::Glued => (),
    }
    object
}

/// Returns the moves of a path.
fn path_json(assembly: &Assembly, legs: &[Leg]) -> Value {
    let to_json = |leg: &Leg| {
        let mut object = json!({
            "parts": assembly.part_names(&leg.parts),
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
        "phase": turn.initial_turns,
        "aside": turn.offset.to_array(),
        "words": turn.describe(),
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
fn moves_json(moves: &PathSearch) -> Value {
    match moves {
        PathSearch::NotSearched(why) => json!({ "not_asked": why }),
        PathSearch::ConstraintsViolated => json!({ "not_kept": true }),
        PathSearch::Proven { cells } => json!({ "proven": cells }),
        PathSearch::Enclosed => json!({ "enclosed": true }),
        PathSearch::NotFound { effort, searched } => json!({
            "effort": effort,
            "directions": searched.directions,
            "places": searched.places,
            "complete": searched.complete,
        }),
    }
}

/// Returns an interlocked group.
fn stuck_json(bodies: &Bodies, stuck: &Interlocked) -> Value {
    let assembly = bodies.assembly();
    let set = |(parts, d): &(Vec<usize>, DVec3)| json!({ "parts": assembly.part_names(parts), "direction": d.to_array() });
    let holds = stuck.blocking_sets.iter().map(|hold| {
        let least: Vec<Value> = hold.sets.iter().map(set).collect();
        json!({ "part": assembly.parts()[hold.part].name(), "least": least })
    });
    let mut object = json!({
        "parts": assembly.part_names(&stuck.parts),
        "because": stuck.explain(bodies),
        "directions": stuck.tested_directions,
        "proof": match stuck.proof_cells {
            Some(cells) => json!({ "proven": cells }),
            None => json!({ "asked": stuck.tested_directions }),
        },
        "moves": moves_json(&stuck.path_search),
        "holds": holds.collect::<Vec<_>>(),
    });
    if stuck.is_constrained {
        object["constrained"] = json!(true);
    }
    object
}

/// Returns a removal map without its samples: free regions with points of their borders, isolated free
/// directions, and either the exact result or the reason why the map is only sampled.
pub fn regions_json(assembly: &Assembly, map: &RemovalMap) -> Value {
    let region = |r: &Region| {
        let border: Vec<[f64; 3]> = r.border.iter().map(DVec3::to_array).collect();
        json!({ "solid_angle": r.solid_angle, "center": r.center.to_array(), "border": border })
    };
    let mut object = json!({
        "parts": assembly.part_names(&map.group),
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
pub fn map_json(bodies: &Bodies, map: &RemovalMap) -> Value {
    let mut object = regions_json(bodies.assembly(), map);
    let samples = map.sphere.directions.iter().zip(&map.travels);
    object["samples"] = samples.map(|(d, room)| free_travel_json(bodies, *d, room)).collect();
    object
}
