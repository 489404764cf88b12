//! How much solids overlap: the least tolerance with which they do not.
//!
//! The place that shows an overlap is asked first, alone, with which tolerance it is gone. Two facets are parted along a
//! normal of one of them or across two edges; how far they are apart is nearly linear in the tolerance, so secants
//! guess where that is 0, and what is decided exactly on either side of the guess holds it. With that the bodies are
//! asked: where the plane that parts the facets parts all of them, or no others overlap, that is it; else the other place
//! is next. Where the tolerance is not small, facets may come to overlap again: there it is doubled and halved, and the
//! bodies are asked each time, unless the last place tells, or of convex ones a plane between them.

use super::{SolidScene, check_left, hulls};
use crate::body::Solid;
use crate::solve::overlap::{self, Overlap};
use crate::solve::parted;
use crate::solve::scene::Scene;
use crate::solve::separate;
use crate::solve::steps::SolidSteps;
use colltrans_convex::cast::Cast;

/// The least tolerance is found to this share of itself, or so many noises; as many more part bodies clearly.
const ACCURACY: f64 = 1e-12;
const NOISES: f64 = 4.0;
/// Doublings and halvings of a tolerance, and secants towards it.
const MOST_HALVINGS: usize = 128;
const MOST_SECANTS: usize = 12;
/// Places of an overlap that are asked for their tolerance, one after the other; then the bodies are asked each time.
const MOST_PLACES: usize = 24;

/// The same of bodies that overlap in a place, which is looked for if none is known.
pub(crate) fn least_tolerance_from(
    cast: &Cast<'_, Solid>,
    place: Option<Overlap>,
    steps: &mut SolidSteps,
) -> Option<f64> {
    let bare = cast.scene(0.0);
    let known = place.filter(|&place| overlap::is_overlap(&bare, place));
    let Some(mut place) = known.or_else(|| overlap::find(&bare, steps)) else {
        return Some(0.0);
    };
    if !(cast.moving().is_closed() && cast.fixed().is_closed()) {
        return None;
    }
    // Shrunk by more than there is of it, a body is inside out.
    let vanishes = |tolerance: f64| check_left(cast, tolerance).is_err();
    let shrunk = |tolerance: f64| bare.shrunk(tolerance / 2.0, tolerance / 2.0);
    // As long as shrinking turns nothing inside out, what is free with one tolerance is so with more.
    let most = 2.0 * cast.moving().shrinking().most.min(cast.fixed().shrinking().most);
    let mut overlapping = 0.0;
    for _ in 0..MOST_PLACES {
        let ends = [overlapping, most];
        let Some(least) = least_of(&bare, place, ends, &mut steps.leaves) else { break };
        if vanishes(least) {
            break;
        }
        let clear = least + NOISES * bare.noise;
        if are_parted(&shrunk(clear), place) {
            return Some(clear);
        }
        let Some(next) = overlap::find(&shrunk(least), steps) else { return Some(least) };
        (place, overlapping) = (next, least);
    }
    let convex = !bare.keeps() && hulls::are_convex(cast);
    let mut between = None;
    let mut is_free = |tolerance| {
        if vanishes(tolerance) {
            return true;
        }
        let smaller = shrunk(tolerance);
        steps.leaves += 1;
        if overlap::is_overlap(&smaller, place) {
            return false;
        }
        if convex && let Some(normal) = parted::plane(&smaller, between) {
            between = Some(normal);
            return true;
        }
        let found = overlap::find(&smaller, steps);
        place = found.unwrap_or(place);
        found.is_none()
    };
    let ends = doubled([overlapping, bare.size()], bare.noise, &mut is_free)?;
    let least = halved(ends, bare.noise, is_free);
    (!vanishes(least)).then_some(least)
}

/// Whether the plane that parts the facets of a place has all of the bodies on either side.
fn are_parted(scene: &Scene, place: Overlap) -> bool {
    let plane = overlap::widest(scene, place);
    plane.is_some_and(|(gap, normal)| gap > 0.0 && separate::parts(scene, normal))
}

/// The tolerance from which on a place shows no overlap, from above, of which one is known with which it does; `None` if
/// that is beyond the second one. Counts its looks at the place.
fn least_of(
    bare: &Scene,
    place: Overlap,
    [overlapping, most]: [f64; 2],
    looks: &mut u32,
) -> Option<f64> {
    let shrunk = |tolerance: f64| bare.shrunk(tolerance / 2.0, tolerance / 2.0);
    let mut is_gone = |tolerance| {
        *looks += 1;
        tolerance > overlapping && !overlap::is_overlap(&shrunk(tolerance), place)
    };
    let gap = |tolerance| overlap::widest(&shrunk(tolerance), place).map(|(gap, _)| gap);
    let (ends, noise) = ([overlapping, most], bare.noise);
    let ends = match guess(gap, overlapping, noise) {
        Some(guess) if guess < most => around(guess, ends, noise, &mut is_gone)?,
        Some(_) => return None,
        None => doubled(ends, noise, &mut is_gone)?,
    };
    Some(halved(ends, noise, is_gone))
}

/// By secants, where a gap that grows with the tolerance is 0.
fn guess(gap: impl Fn(f64) -> Option<f64>, from: f64, noise: f64) -> Option<f64> {
    let (mut last, mut before) = (from, gap(from)?);
    let mut at = from + before.abs().max(noise);
    for _ in 0..MOST_SECANTS {
        let now = gap(at)?;
        let step = now * (at - last) / (now - before);
        if !step.is_finite() {
            return None;
        }
        (last, before, at) = (at, now, at - step);
        if step.abs() <= NOISES * noise {
            break;
        }
    }
    (at > from).then_some(at)
}

fn accuracy(tolerance: f64, noise: f64) -> f64 {
    (ACCURACY * tolerance).max(NOISES * noise)
}

/// Two tolerances near a guess, with the first of which something does not hold and with the second it does, where none
/// up to the first end does; `None` if it does not up to the last one.
fn around(
    guess: f64,
    [mut low, last]: [f64; 2],
    noise: f64,
    holds: &mut impl FnMut(f64) -> bool,
) -> Option<[f64; 2]> {
    let mut width = 0.5 * accuracy(guess, noise);
    let mut high = guess + width;
    if holds(high) {
        while guess - width > low {
            if !holds(guess - width) {
                return Some([guess - width, high]);
            }
            high = guess - width;
            width *= 4.0;
        }
        return Some([low, high]);
    }
    while high <= last {
        low = high;
        width *= 4.0;
        high = guess + width;
        if holds(high) {
            return Some([low, high]);
        }
    }
    None
}

/// The same, doubled from the noise, or the first end, on.
fn doubled(
    [mut low, last]: [f64; 2],
    noise: f64,
    holds: &mut impl FnMut(f64) -> bool,
) -> Option<[f64; 2]> {
    let mut high = (2.0 * low).max(noise);
    while !holds(high) {
        (low, high) = (high, 2.0 * high);
        if high > last {
            return None;
        }
    }
    Some([low, high])
}

/// Halved between two such, the last one.
fn halved([mut low, mut high]: [f64; 2], noise: f64, mut holds: impl FnMut(f64) -> bool) -> f64 {
    for _ in 0..MOST_HALVINGS {
        let middle = low + 0.5 * (high - low);
        if high - low <= accuracy(high, noise) || middle <= low || middle >= high {
            break;
        }
        *(if holds(middle) { &mut high } else { &mut low }) = middle;
    }
    high
}
