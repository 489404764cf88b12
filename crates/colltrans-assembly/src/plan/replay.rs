//! Check of a step before it is reported, independent of the search that found it.

use colltrans::Bounded;
use colltrans::solid::{StartOverlap, Workspace};
use glam::DVec3;

use super::Way;
use super::order::Order;
use super::several::Aside;
use super::shadow::{NOTHING, larger};
use crate::bodies::Bodies;
use crate::error::AssemblyError;

/// Positions that are tested for overlaps, as fractions of the travel.
const PLACES: [f64; 6] = [0.01, 0.1, 0.3, 0.55, 0.8, 1.0];

/// Returns the distance that a removed group travels until it is beyond the other parts.
///
/// # Errors
/// Returns [`AssemblyError::Replay`] if a part blocks the step.
pub(super) fn checked(
    bodies: &Bodies,
    way: &Way,
    (order, others): (&Order, &[usize]),
    start: StartOverlap,
) -> Result<Bounded, AssemblyError> {
    match &way.aside {
        None => straight(bodies, way, order, start),
        Some(aside) => several(bodies, aside, others),
    }
}

/// Checks a single move by casts of all pairs ahead and by overlap tests at a few positions.
fn straight(
    bodies: &Bodies,
    way: &Way,
    order: &Order,
    start: StartOverlap,
) -> Result<Bounded, AssemblyError> {
    let d = way.direction;
    let travel = order.bounded_travel(&way.parts, d);
    let mut workspace = Workspace::default();
    let ahead = bodies.pairs_ahead(&way.parts, d, order.there());
    let mut all = ahead.iter();
    if let Some(&pair) = all.find(|pair| bodies.meets(**pair, d, start, &mut workspace)) {
        return Err(refused(bodies, pair, d, 0.0));
    }
    for &[a, b] in &ahead {
        let overlapping = bodies.lets_pass(a, b, start);
        let place = PLACES.iter().map(|share| share * travel.value);
        let met = |t: &f64| bodies.overlaps_displaced(a, d * *t, b);
        if let Some(t) = place.filter(|t| *t > 0.0).find(met).filter(|_| !overlapping) {
            return Err(refused(bodies, [a, b], d, t));
        }
    }
    Ok(travel)
}

/// Checks a path of several moves by overlap tests at a few positions. Its proofs were checked before.
fn several(bodies: &Bodies, aside: &Aside, others: &[usize]) -> Result<Bounded, AssemblyError> {
    let mut all = [&aside.parts[..], others].concat();
    all.sort_unstable();
    let mut at = vec![DVec3::ZERO; bodies.len()];
    let pairs = |moving: &[usize]| {
        let outside = all.iter().filter(|part| !moving.contains(part));
        let outside: Vec<usize> = outside.copied().collect();
        moving.iter().flat_map(|&a| outside.iter().map(move |&b| [a, b])).collect::<Vec<_>>()
    };
    let look = |[a, b]: [usize; 2], by: DVec3, motion: DVec3| {
        // Parts that overlap at the start move as one, or the step was rejected.
        let met = |share: &&f64| bodies.overlaps_displaced(a, by + motion * **share, b);
        let found = PLACES.iter().find(met);
        let length = motion.length();
        let why = |share| refused(bodies, [a, b], motion / length, share * length);
        found.map_or(Ok(()), |share| Err(why(share)))
    };
    for (leg, motion) in aside.legs.iter().zip(&aside.motions) {
        for [a, b] in pairs(&leg.parts) {
            look([a, b], at[a] - at[b], *motion)?;
        }
        for &part in &leg.parts {
            at[part] += *motion;
        }
    }
    let (d, leaving) = (aside.direction, pairs(&aside.parts));
    let past = |travel, &[a, b]: &[usize; 2]| {
        larger(travel, bodies.past_displaced(a, at[a] - at[b], b, d))
    };
    let travel = leaving.iter().fold(NOTHING, past);
    for [a, b] in leaving {
        look([a, b], at[a] - at[b], d * travel.value)?;
    }
    Ok(travel)
}

fn refused(bodies: &Bodies, pair: [usize; 2], d: DVec3, t: f64) -> AssemblyError {
    let [a, b] = pair.map(|k| bodies.assembly().parts()[k].name());
    let facts = format!("{a} meets {b} after {t} along {:?}", d.to_array());
    AssemblyError::Replay { facts }
}
