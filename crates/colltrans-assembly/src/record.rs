//! What was found out, as JSON: the same in the files of the command line and on a page.
//!
//! Parts are told by their names, directions have length 1; `docs/guide/assemblies.md` describes the fields,
//! `docs/answers.schema.json` holds them.

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

/// A part as the file has it.
pub fn part(part: &Part) -> Value {
    let bounds = part.solid().volume_bounds();
    // What is open has none.
    let volume = bounds.map(|_| part.solid().volume());
    let mut told = json!({
        "name": part.name(), "facets": part.facets(), "volume": volume, "volume_bounds": bounds
    });
    if part.is_surface() {
        let count = |kind: ShellKind| (kind.name().to_owned(), part.solid().report().count(kind));
        told["shells"] = ShellKind::ALL.into_iter().map(count).collect();
    }
    if let Some(error) = part.chord_error() {
        told["chord_error"] = json!(error);
    }
    if !part.defects().is_empty() {
        told["defects"] = json!(part.defects());
    }
    told
}

/// Pairs that overlap as the files have them.
pub fn overlaps(assembly: &Assembly, start: &Start) -> Value {
    let told = |o: &Overlap| {
        json!({
            "parts": assembly.names(&o.parts),
            "least_tolerance": o.depth,
            "remains": o.remains,
        })
    };
    start.overlaps.iter().map(told).collect()
}

/// What pairs that overlap may be to each other.
pub fn suggestions(assembly: &Assembly, suggestions: &[Suggestion]) -> Value {
    let told = |s: &Suggestion| {
        json!({
            "parts": assembly.names(&s.parts),
            "role": s.fit.role.map(Role::name),
            "tolerance": s.fit.tolerance,
            "why": s.why,
        })
    };
    suggestions.iter().map(told).collect()
}

/// What looks odd about parts, and which are identical.
pub fn hints(assembly: &Assembly, hints: &[Hint]) -> Value {
    let told = |hint: &Hint| {
        json!({
            "kind": hint.kind.name(),
            "parts": assembly.names(&hint.parts),
            "words": hint.words,
        })
    };
    hints.iter().map(told).collect()
}

/// Pairs that have a fit of their own, and what is let pass of them.
pub fn pairs(bodies: &Bodies) -> Value {
    let told = |(parts, fit): ([usize; 2], PairFit)| {
        let tolerated = bodies.tolerated(parts)?;
        Some(passed(bodies.assembly(), &Passed { parts, role: fit.role, tolerated }))
    };
    bodies.assembly().pairs().filter_map(told).collect()
}

/// Pairs that touch.
pub fn liaisons(assembly: &Assembly, liaisons: &[Liaison]) -> Value {
    let told = |l: &Liaison| {
        json!({
            "parts": assembly.names(&l.parts),
            "area": l.area(),
            "area_bounds": l.area_bounds(),
            "center": l.center().to_array(),
        })
    };
    liaisons.iter().map(told).collect()
}

/// How far a part goes alone.
pub fn room(bodies: &Bodies, part: usize, d: DVec3, room: &PartRoom) -> Value {
    let mut told = sample(bodies, d, room);
    told["part"] = json!(bodies.assembly().parts()[part].name());
    let PartRoom::Blocked { stop, .. } = room else { return told };
    let name = match bodies.fit() {
        Fit::Tolerance(_) | Fit::Chords { .. } => {
            told["translation"] = json!(stop.translation.value);
            told["translation_bounds"] = json!(stop.translation.bounds());
            "shrunk_distance"
        }
        Fit::Apart(_) => "kept_distance",
    };
    told[name] = json!(stop.displaced.value);
    told[format!("{name}_bounds")] = json!(stop.displaced.bounds());
    told["point"] = json!(stop.point.to_array());
    told["normal"] = json!(stop.normal.to_array());
    told
}

fn sample(bodies: &Bodies, d: DVec3, room: &PartRoom) -> Value {
    let distance = room.distance();
    json!({
        "direction": d.to_array(),
        "outcome": room.outcome(),
        "distance": distance.is_finite().then_some(distance),
        "by": room.by().map(|k| bodies.assembly().parts()[k].name()),
    })
}

/// The ordered pairs that are not free along a direction of a matrix.
pub fn meetings(assembly: &Assembly, matrix: &Matrix, direction: usize) -> Value {
    let name = |part: usize| assembly.parts()[part].name();
    let told = |m: &Meeting| {
        json!({
            "moving": name(m.moving),
            "fixed": name(m.fixed),
            "outcome": if m.stop.is_some() { "blocked" } else { "overlapping" },
            "distance": m.distance(),
        })
    };
    matrix.meetings(direction).iter().map(told).collect()
}

/// The fields of a plan: `plan` (its steps), `stages` (those that are told as one, by the first and last one), `rounds`
/// (those that may go at once), `assembly` (how it is put together), `last`, `left`, `stuck`.
pub fn plan(bodies: &Bodies, plan: &Plan) -> Value {
    let steps: Vec<Value> = plan.steps.iter().map(|s| step(bodies.assembly(), s)).collect();
    let stuck: Vec<Value> = plan.stuck.iter().map(|s| self::stuck(bodies, s)).collect();
    let names = |parts: &[usize]| json!(bodies.assembly().names(parts));
    let stages = plan.stages().into_iter().map(|stage| {
        let takes = plan.takes(bodies.assembly(), &stage);
        let (first, last) = (stage.start, stage.end - 1);
        json!({ "takes": takes, "steps": [first, last], "travel": plan.travel(&stage) })
    });
    let stages: Vec<Value> = stages.collect();
    let put = |(step, after): (usize, Vec<usize>)| json!({ "step": step, "after": after });
    let mut told = json!({
        "plan": steps,
        "stages": stages,
        "rounds": plan.rounds(),
        "assembly": plan.assembly().into_iter().map(put).collect::<Vec<_>>(),
        "last": names(&plan.last),
        "left": names(&plan.left),
        "stuck": stuck,
    });
    if let Some(wanted) = &plan.wanted {
        told["wanted"] = json!({
            "parts": names(&wanted.parts),
            "others": names(&wanted.others),
            "least": wanted.least,
            "out": wanted.out,
        });
    }
    told
}

fn step(assembly: &Assembly, step: &Step) -> Value {
    let mut told = json!({
        "parts": assembly.names(&step.parts),
        "direction": step.direction.to_array(),
        "travel": step.travel.value,
        "travel_bounds": step.travel.bounds(),
        "path": legs(assembly, &step.path),
    });
    if let Some(name) = assembly.constraints().name(&step.parts) {
        told["subassembly"] = json!(name);
    }
    if !step.back.is_empty() {
        told["back"] = legs(assembly, &step.back);
    }
    if !step.ignored.is_empty() {
        let pairs: Vec<_> = step.ignored.iter().map(|pair| assembly.names(pair)).collect();
        told["ignored"] = json!(pairs);
    }
    if !step.passed.is_empty() {
        told["passed"] = step.passed.iter().map(|passed| self::passed(assembly, passed)).collect();
    }
    for (name, parts) in [("falls", &step.falls), ("off_balance", &step.off_balance)] {
        if !parts.is_empty() {
            told[name] = json!(assembly.names(parts));
        }
    }
    told["after"] = json!(step.after);
    if let Some(within) = step.within {
        told["within"] = json!(within);
    }
    if !step.surfaces.is_empty() {
        told["surfaces"] = json!(assembly.names(&step.surfaces));
    }
    told
}

fn passed(assembly: &Assembly, passed: &Passed) -> Value {
    let mut told = json!({
        "parts": assembly.names(&passed.parts),
        "role": passed.role.map(Role::name),
        "words": passed.tolerated.words(passed.role),
    });
    match passed.tolerated {
        Tolerated::Within(length) | Tolerated::Bent(length) => told["tolerance"] = json!(length),
        Tolerated::Core(radius) => told["core_radius"] = json!(radius),
        Tolerated::Crossing | Tolerated::AsOne => (),
    }
    told
}

fn legs(assembly: &Assembly, legs: &[Leg]) -> Value {
    let told = |leg: &Leg| {
        let mut told = json!({
            "parts": assembly.names(&leg.parts),
            "direction": leg.direction.to_array(),
            "travel": leg.travel,
        });
        if let Some(turn) = &leg.turn {
            told["turn"] = self::turn(leg, turn);
        }
        told
    };
    legs.iter().map(told).collect()
}

fn turn(leg: &Leg, turn: &Turn) -> Value {
    let mut told = json!({
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
            told["proof"] = json!({ "tolerance": tolerance, "pairs": pairs });
        }
        Err(why) => told["not_proven"] = json!(why),
    }
    told
}

fn moves(moves: &Moves) -> Value {
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

fn stuck(bodies: &Bodies, stuck: &Stuck) -> Value {
    let assembly = bodies.assembly();
    let set = |(parts, d): &(Vec<usize>, DVec3)| json!({ "parts": assembly.names(parts), "direction": d.to_array() });
    let holds = stuck.holds.iter().map(|hold| {
        let least: Vec<Value> = hold.by.iter().map(set).collect();
        json!({ "part": assembly.parts()[hold.part].name(), "least": least })
    });
    let mut told = json!({
        "parts": assembly.names(&stuck.parts),
        "because": stuck.because(bodies),
        "directions": stuck.directions,
        "proof": match stuck.proven {
            Some(cells) => json!({ "proven": cells }),
            None => json!({ "asked": stuck.directions }),
        },
        "moves": moves(&stuck.moves),
        "holds": holds.collect::<Vec<_>>(),
    });
    if stuck.constrained {
        told["constrained"] = json!(true);
    }
    told
}

/// A removal map without its samples: free regions with points of their borders, isolated directions, and all that is
/// free, exactly; or why it is sampled.
pub fn regions(assembly: &Assembly, map: &RemovalMap) -> Value {
    let region = |r: &Region| {
        let border: Vec<[f64; 3]> = r.border.iter().map(DVec3::to_array).collect();
        json!({ "solid_angle": r.solid_angle, "center": r.center.to_array(), "border": border })
    };
    let mut told = json!({
        "parts": assembly.names(&map.group),
        "free_share": map.free_share(),
        "regions": map.regions.iter().map(region).collect::<Vec<_>>(),
        "isolated": map.isolated.iter().map(DVec3::to_array).collect::<Vec<_>>(),
    });
    match &map.cover {
        Ok(cover) => told["exactly"] = json!(cover.record),
        Err(why) => told["sampled"] = json!(why),
    }
    told
}

/// A removal map with all its samples.
pub fn map(bodies: &Bodies, map: &RemovalMap) -> Value {
    let mut told = regions(bodies.assembly(), map);
    let samples = map.sphere.directions.iter().zip(&map.rooms);
    told["samples"] = samples.map(|(d, room)| sample(bodies, *d, room)).collect();
    told
}
