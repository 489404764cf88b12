//! Least tolerance at which two overlapping solids do not overlap.
//!
//! 1. Compute the tolerance at which one place of overlap disappears. The gap of two facets, along a normal of one
//!    or across an edge of each, is nearly linear in the tolerance. Secants estimate where it is 0, and exact tests
//!    bracket and bisect the tolerance around the estimate.
//! 2. Test the bodies at that tolerance. It is the result if the plane that separates the facets separates the
//!    bodies, or if they do not overlap elsewhere. Otherwise repeat step 1 for the next place.
//! 3. At large tolerances facets may begin to overlap again, so one place is not enough. Then the tolerance is
//!    doubled until the bodies do not overlap. The tolerance at which the last place disappears and the middle of the
//!    bracket narrow it in turns. Each step tests the bodies: first the last place, then a plane between convex bodies,
//!    then all facets.

use super::{SolidScene, check_thickness};
use crate::body::Solid;
use crate::solve::hulls::HullPair;
use crate::solve::overlap::{self, Overlap};
use crate::solve::parted;
use crate::solve::scene::PairFrame;
use crate::solve::separate;
use crate::solve::steps::SolidSteps;
use colltrans_convex::cast::Cast;

/// Relative accuracy of the least tolerance.
const RELATIVE_ACCURACY: f64 = 1e-12;
/// Absolute accuracy of the least tolerance, in noises. A tolerance that is larger by this amount separates facets
/// clearly.
const ACCURACY_NOISES: f64 = 4.0;
/// Maximum number of bisections of a tolerance.
const MAX_BISECTIONS: usize = 128;
/// Maximum number of secant steps for one place.
const MAX_SECANTS: usize = 12;
/// Maximum number of places that are tested alone, before the bodies are tested at each tolerance.
const MAX_PLACES: usize = 24;

/// Computes an upper bound of the least tolerance, 0 if the nominal bodies do not overlap. A known `place` of
/// overlap saves the first search. `None` if every sufficient tolerance leaves nothing of a body, or if overlapping
/// bodies have open shells. Adds the work to `steps`.
pub(crate) fn least_tolerance_from(
    cast: &Cast<'_, Solid>,
    place: Option<Overlap>,
    steps: &mut SolidSteps,
) -> Option<f64> {
    let nominal = cast.scene_with_tolerance(0.0);
    let known = place.filter(|&place| overlap::is_overlap(&nominal, place));
    let Some(mut place) = known.or_else(|| overlap::find_overlap(&nominal, steps)) else {
        return Some(0.0);
    };
    if !(cast.moving().is_closed() && cast.fixed().is_closed()) {
        return None;
    }
    // A closed body that is offset by more than its thickness turns inside out.
    let vanishes = |tolerance: f64| check_thickness(cast, tolerance).is_err();
    let shrunk = |tolerance: f64| nominal.with_offsets(tolerance / 2.0, tolerance / 2.0);
    // As long as the offset turns nothing inside out, a larger tolerance does not create an overlap.
    let max_offset_tolerance = 2.0
        * cast
            .moving()
            .offset_field()
            .max_rate_amount
            .min(cast.fixed().offset_field().max_rate_amount);
    let mut overlapping = 0.0;
    for _ in 0..MAX_PLACES {
        let ends = [overlapping, max_offset_tolerance];
        let Some(least) = place_tolerance(&nominal, place, ends, &mut steps.leaves) else { break };
        if vanishes(least) {
            break;
        }
        let clear = least + ACCURACY_NOISES * nominal.noise;
        if facets_separate_bodies(&shrunk(clear), place) {
            return Some(clear);
        }
        let Some(next) = overlap::find_overlap(&shrunk(least), steps) else { return Some(least) };
        (place, overlapping) = (next, least);
    }
    let convex = !nominal.has_min_gap() && HullPair::of_convex(&cast.setting.bodies).is_some();
    let mut between = None;
    let mut overlap_at = |tolerance, last: Overlap, steps: &mut SolidSteps| {
        if vanishes(tolerance) {
            return None;
        }
        let smaller = shrunk(tolerance);
        steps.leaves += 1;
        if overlap::is_overlap(&smaller, last) {
            return Some(last);
        }
        if convex && let Some(normal) = parted::separating_normal(&smaller, between) {
            between = Some(normal);
            return None;
        }
        overlap::find_overlap(&smaller, steps)
    };
    let mut is_free = |tolerance| {
        let found = overlap_at(tolerance, place, steps);
        place = found.unwrap_or(place);
        found.is_none()
    };
    let ends = bracket_by_doubling([overlapping, nominal.size()], nominal.noise, &mut is_free)?;
    let least = narrow(&nominal, (place, !convex), ends, steps, overlap_at);
    (!vanishes(least)).then_some(least)
}

/// Narrows a bracket of [`bracket_by_doubling`] to the accuracy and returns its upper end. `place` shows an overlap at its
/// lower end, and `overlap_at` returns a place that does at another tolerance.
///
/// A test that finds no overlap is the most expensive one, because it visits all facets that are near each other. It is
/// the last one at the tolerance at which the deepest place disappears. Without `by_places` the search only bisects: it is
/// faster for convex bodies, which a plane separates.
fn narrow(
    nominal: &PairFrame,
    (mut place, by_places): (Overlap, bool),
    [mut low, mut high]: [f64; 2],
    steps: &mut SolidSteps,
    mut overlap_at: impl FnMut(f64, Overlap, &mut SolidSteps) -> Option<Overlap>,
) -> f64 {
    for _ in 0..MAX_BISECTIONS {
        let gone = by_places
            .then(|| place_tolerance(nominal, place, [low, high], &mut steps.leaves))
            .flatten();
        if let Some(gone) = gone.filter(|gone| low < *gone && *gone < high) {
            let Some(found) = overlap_at(gone, place, steps) else { return gone };
            (place, low) = (found, gone);
        }
        let middle = low + 0.5 * (high - low);
        let is_close = high - low <= tolerance_accuracy(high, nominal.noise);
        if is_close || middle <= low || middle >= high {
            break;
        }
        match overlap_at(middle, place, steps) {
            Some(found) => (place, low) = (found, middle),
            None => high = middle,
        }
    }
    high
}

/// Checks whether the plane with the widest gap between the two facets of a place separates the bodies. Returns
/// `false` for a shell.
fn facets_separate_bodies(scene: &PairFrame, place: Overlap) -> bool {
    let plane = overlap::widest_separation(scene, place);
    plane.is_some_and(|(gap, normal)| {
        gap > scene.min_gap() && separate::is_separating(scene, normal)
    })
}

/// Computes an upper bound of the tolerance from which on a place shows no overlap. At the tolerance `overlapping`
/// the bodies are known to overlap. `None` if the estimate is beyond `max_offset_tolerance`, or if the place shows an
/// overlap at all tested tolerances. The result may lie slightly beyond `max_offset_tolerance`. Therefore the caller
/// tests the bodies at this result. Adds the number of tests of the place to `tests`.
fn place_tolerance(
    nominal: &PairFrame,
    place: Overlap,
    [overlapping, max_offset_tolerance]: [f64; 2],
    tests: &mut u32,
) -> Option<f64> {
    let shrunk = |tolerance: f64| nominal.with_offsets(tolerance / 2.0, tolerance / 2.0);
    let mut is_gone = |tolerance| {
        *tests += 1;
        tolerance > overlapping && !overlap::is_overlap(&shrunk(tolerance), place)
    };
    let gap = |tolerance| {
        let widest = overlap::widest_separation(&shrunk(tolerance), place);
        widest.map(|(gap, _)| gap - nominal.min_gap())
    };
    let (ends, noise) = ([overlapping, max_offset_tolerance], nominal.noise);
    let ends = match secant_root(gap, overlapping, noise) {
        Some(guess) if guess < max_offset_tolerance => {
            bracket_around(guess, ends, noise, &mut is_gone)?
        }
        Some(_) => return None,
        None => bracket_by_doubling(ends, noise, &mut is_gone)?,
    };
    Some(bisect(ends, noise, is_gone))
}

/// Estimates by secants where a gap that grows with the tolerance is 0, starting at the tolerance `from`. `None` if
/// a gap is `None`, a step is not finite, or the estimate is not above `from`.
fn secant_root(gap: impl Fn(f64) -> Option<f64>, from: f64, noise: f64) -> Option<f64> {
    let (mut last, mut before) = (from, gap(from)?);
    let mut at = from + before.abs().max(noise);
    for _ in 0..MAX_SECANTS {
        let now = gap(at)?;
        let step = now * (at - last) / (now - before);
        if !step.is_finite() {
            return None;
        }
        (last, before, at) = (at, now, at - step);
        if step.abs() <= ACCURACY_NOISES * noise {
            break;
        }
    }
    (at > from).then_some(at)
}

/// Returns the accuracy, a length, to which a tolerance is computed.
fn tolerance_accuracy(tolerance: f64, noise: f64) -> f64 {
    (RELATIVE_ACCURACY * tolerance).max(ACCURACY_NOISES * noise)
}

/// Brackets the tolerance at which a condition begins to hold, near a guess. The distance from the guess grows by a
/// factor of 4 in each step. The condition must not hold at the lower end of the range. Returns a tolerance at which it
/// does not hold, possibly that end, and one at which it does. The latter may exceed the upper end by less than the
/// last step. `None` if the condition does not hold up to the upper end.
fn bracket_around(
    guess: f64,
    [mut low, last]: [f64; 2],
    noise: f64,
    holds: &mut impl FnMut(f64) -> bool,
) -> Option<[f64; 2]> {
    let mut width = 0.5 * tolerance_accuracy(guess, noise);
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

/// Brackets the tolerance at which a condition begins to hold, by doubling the lower end of the range or the noise. The
/// first step is tested even if it is beyond the upper end. `None` if the condition does not hold up to the upper end.
fn bracket_by_doubling(
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

/// Bisects a bracket of [`bracket_around`] or [`bracket_by_doubling`] to the accuracy and returns its upper end.
fn bisect([mut low, mut high]: [f64; 2], noise: f64, mut holds: impl FnMut(f64) -> bool) -> f64 {
    for _ in 0..MAX_BISECTIONS {
        let middle = low + 0.5 * (high - low);
        if high - low <= tolerance_accuracy(high, noise) || middle <= low || middle >= high {
            break;
        }
        *(if holds(middle) { &mut high } else { &mut low }) = middle;
    }
    high
}
