//! A step, checked once more before it is reported.

use colltrans::Bounded;
use colltrans::solid::{StartOverlap, Workspace};
use glam::DVec3;

use super::Way;
use crate::bodies::{Bodies, Room};
use crate::error::AssemblyError;

/// Places on the way, as shares of the travel.
const PLACES: [f64; 6] = [0.01, 0.1, 0.3, 0.55, 0.8, 1.0];

/// How far the group must go until it never meets the others again.
///
/// # Errors
/// Something is in the way after all.
pub(super) fn checked(
    bodies: &Bodies,
    way: &Way,
    others: &[usize],
    start: StartOverlap,
) -> Result<Bounded, AssemblyError> {
    let d = way.direction;
    let mut workspace = Workspace::default();
    let mut travel = Bounded { value: 0.0, lower: 0.0, upper: 0.0 };
    let mut there = vec![false; bodies.len()];
    for &part in others {
        there[part] = true;
    }
    let ahead: Vec<[usize; 2]> = way
        .parts
        .iter()
        .flat_map(|&a| bodies.ahead(a, d).into_iter().map(move |(_, b)| [a, b]))
        .filter(|[_, b]| there[*b])
        .collect();
    for &pair in &ahead {
        if bodies.room(pair, d, None, start, &mut workspace) != Room::Free {
            return Err(refused(bodies, pair, d, 0.0));
        }
    }
    for &a in &way.parts {
        for &b in others {
            travel = larger(travel, bodies.past(a, b, d));
        }
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

/// The larger one of two numbers.
fn larger(a: Bounded, b: Bounded) -> Bounded {
    Bounded {
        value: a.value.max(b.value),
        lower: a.lower.max(b.lower),
        upper: a.upper.max(b.upper),
    }
}

fn refused(bodies: &Bodies, pair: [usize; 2], d: DVec3, t: f64) -> AssemblyError {
    let [a, b] = pair.map(|k| bodies.assembly().parts()[k].name());
    let facts = format!("{a} meets {b} after {t} along {:?}", d.to_array());
    AssemblyError::Replay { facts }
}
