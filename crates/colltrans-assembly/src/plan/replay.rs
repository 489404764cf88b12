//! Check of a step before it is reported, independent of the search that found it.

use colltrans::Bounded;
use colltrans::solid::{StartOverlap, Workspace};
use glam::DVec3;

use super::GroupRemoval;
use super::multi_move::MovePath;
use super::order::Order;
use super::shadow::{ZERO_TRAVEL, max_bounded};
use crate::bodies::Bodies;
use crate::error::AssemblyError;

/// Positions that are tested for overlaps, as fractions of the travel.
const POSITIONS: [f64; 6] = [0.01, 0.1, 0.3, 0.55, 0.8, 1.0];

/// Returns the distance that a removed group travels until it is beyond the other parts.
///
/// # Errors
/// Returns [`AssemblyError::Replay`] if a part blocks the step.
pub(super) fn checked_travel(
    bodies: &Bodies,
    removal: &GroupRemoval,
    (order, others): (&Order, &[usize]),
    start: StartOverlap,
) -> Result<Bounded, AssemblyError> {
    match &removal.path {
        None => straight_travel(bodies, removal, order, start),
        Some(path) => path_travel(bodies, path, others, start),
    }
}

/// Checks a single move by casts of all pairs ahead and by overlap tests at a few positions.
fn straight_travel(
    bodies: &Bodies,
    removal: &GroupRemoval,
    order: &Order,
    start: StartOverlap,
) -> Result<Bounded, AssemblyError> {
    let d = removal.direction;
    let travel = order.bounded_travel(&removal.parts, d);
    let mut workspace = Workspace::default();
    let ahead = bodies.pairs_ahead(&removal.parts, d, order.present());
    let mut all = ahead.iter();
    if let Some(&pair) = all.find(|pair| bodies.ever_meets(**pair, d, start, &mut workspace)) {
        return Err(replay_error(bodies, pair, d, 0.0));
    }
    for &[a, b] in &ahead {
        let overlapping = bodies.disregards_contacts(a, b, start);
        let place = POSITIONS.iter().map(|share| share * travel.value);
        let met = |t: &f64| bodies.overlaps_displaced(a, d * *t, b);
        if let Some(t) = place.filter(|t| *t > 0.0).find(met).filter(|_| !overlapping) {
            return Err(replay_error(bodies, [a, b], d, t));
        }
    }
    Ok(travel)
}

/// Checks a path of several moves by overlap tests at a few positions. Its proofs were checked before.
fn path_travel(
    bodies: &Bodies,
    path: &MovePath,
    others: &[usize],
    start: StartOverlap,
) -> Result<Bounded, AssemblyError> {
    let mut all = [&path.parts[..], others].concat();
    all.sort_unstable();
    let mut at = vec![DVec3::ZERO; bodies.len()];
    let pairs = |moving: &[usize]| {
        let outside = all.iter().filter(|part| !moving.contains(part));
        let outside: Vec<usize> = outside.copied().collect();
        moving.iter().flat_map(|&a| outside.iter().map(move |&b| [a, b])).collect::<Vec<_>>()
    };
    let examine = |[a, b]: [usize; 2], by: DVec3, motion: DVec3| {
        // Parts that overlap at the start move as one, or their overlap is ignored.
        let skipped = bodies.disregards_contacts(a, b, start);
        let met = |share: &&f64| !skipped && bodies.overlaps_displaced(a, by + motion * **share, b);
        let found = POSITIONS.iter().find(met);
        let length = motion.length();
        let why = |share| replay_error(bodies, [a, b], motion / length, share * length);
        found.map_or(Ok(()), |share| Err(why(share)))
    };
    for (leg, motion) in path.legs.iter().zip(&path.motions) {
        for [a, b] in pairs(&leg.parts) {
            examine([a, b], at[a] - at[b], *motion)?;
        }
        for &part in &leg.parts {
            at[part] += *motion;
        }
    }
    let (d, leaving) = (path.direction, pairs(&path.parts));
    let past = |travel, &[a, b]: &[usize; 2]| {
        max_bounded(travel, bodies.travel_beyond_displaced(a, at[a] - at[b], b, d))
    };
    let travel = leaving.iter().fold(ZERO_TRAVEL, past);
    for [a, b] in leaving {
        examine([a, b], at[a] - at[b], d * travel.value)?;
    }
    Ok(travel)
}

fn replay_error(bodies: &Bodies, pair: [usize; 2], d: DVec3, t: f64) -> AssemblyError {
    let [a, b] = pair.map(|k| bodies.assembly().parts()[k].name());
    let facts = format!("{a} meets {b} after {t} along {:?}", d.to_array());
    AssemblyError::Replay { facts }
}
