//! Detects the helix of a thread: the rise of its crest in a turn, from the outermost points of the screw.
//!
//! On a thread of `n` starts whose crests are `p` apart, the radius is a function of the phase `z / p - n a /
//! (2 pi)`, with the coordinate `z` along the axis and the angle `a` about it. Therefore the radius
//! correlates with the wave of this phase more than with that of any other `p` and `n`. Rings do not depend
//! on the angle, and splines do not depend on `z`. A left-handed thread has a negative `n`. The pitch (lead)
//! is `n p`.

use std::f64::consts::TAU;

use colltrans::Solid;
use glam::{DVec2, DVec3};

use super::surface::{AxisFrame, COLUMNS, column_direction};
use super::{axial_projection, lateral_vector};

/// Maximum number of starts, for either hand.
const STARTS: i32 = 4;
/// Minimum correlation of a helix. A triangular profile reaches 0.8, narrow ridges 0.55.
const MIN_CORRELATION: f64 = 0.35;
/// Minimum ratio of this correlation and those with rings and splines.
const MIN_ADVANTAGE: f64 = 1.5;
/// Maximum rise of a crest in a turn, as a share of its circumference. Steeper shapes are splines.
const MAX_RISE: f64 = 1.0;
/// Minimum distance of crests, in multiples of the thread's depth. Usual threads have 1.6.
const MIN_CREST_DISTANCE: f64 = 0.8;
/// Number of frequencies tried in the inverse of the length.
const STEPS: f64 = 8.0;
/// Minimum amplitude of a row with a whole crest, as a share of the median amplitude.
const MIN_AMPLITUDE: f64 = 0.9;
/// Minimum distance of two centres that are compared, in turns.
const MIN_CENTER_DISTANCE: f64 = 0.5;
/// Number of rows along the axis within a depth of the thread.
const ROWS_PER_DEPTH: f64 = 5.0;
/// Maximum number of rows along the axis.
const MAX_ROWS: usize = 512;

/// Returns the rise of the crest in a turn; `None` if no helix is detected. `radii` are those of the hole and
/// the crest.
pub(super) fn pitch(screw: &Solid, about: &AxisFrame, radii: [f64; 2]) -> Option<f64> {
    let [low, high] = about.range;
    let (length, depth) = (high - low, radii[1] - radii[0]);
    if !(length > 0.0 && depth > 0.0) {
        return None;
    }
    let rows = ((ROWS_PER_DEPTH * length / depth).ceil() as usize).clamp(8, MAX_ROWS);
    let outermost = about.envelope(screw, radii[1], rows, f64::max);
    let known = || outermost.iter().flatten().flatten();
    let mean = known().sum::<f64>() / known().count().max(1) as f64;
    let total: f64 = known().map(|r| (r - mean).abs()).sum();
    if total == 0.0 {
        return None;
    }
    // For a number of starts, the wave about the axis of each row.
    let waves = |starts: i32| -> Vec<DVec2> {
        let turn = |column| column_direction(column).to_angle();
        let wave_of = |row: &[Option<f64>; COLUMNS]| {
            let cells = row.iter().enumerate().filter_map(|(column, r)| Some((column, (*r)?)));
            let wave =
                |(column, r)| (r - mean) * DVec2::from_angle(-f64::from(starts) * turn(column));
            cells.map(wave).sum()
        };
        outermost.iter().map(wave_of).collect()
    };
    let strength = |waves: &[DVec2], frequency: f64| {
        let turn = DVec2::from_angle(TAU * frequency * length / rows as f64);
        let (mut at, mut sum) = (DVec2::X, DVec2::ZERO);
        for wave in waves {
            sum += at.rotate(*wave);
            at = at.rotate(turn);
        }
        sum.length() / total
    };
    let step = 1.0 / (STEPS * length);
    // The frequency is limited by the minimum distance of crests and by four rows for each crest.
    let last = (length / (MIN_CREST_DISTANCE * depth)).min(rows as f64 / 4.0) * STEPS;
    let mut best = (0.0, 0, 0);
    for starts in (-STARTS..=STARTS).filter(|n| *n != 0) {
        let waves = waves(starts);
        for k in (STEPS / 2.0) as i32..=last as i32 {
            let found = strength(&waves, f64::from(k) * step);
            if found > best.0 {
                best = (found, k, starts);
            }
        }
    }
    let (_, k, starts) = best;
    let own = waves(starts);
    // At its ends, a thread shows parts of crests, whose middles are not on the helix.
    let whole_crests = full_crest_waves(&own);
    let frequency = maximum_near(f64::from(k) * step, step, |f| strength(&whole_crests, f));
    let found = strength(&own, frequency);
    let others = strength(&waves(0), frequency).max(strength(&own, 0.0));
    let climb = f64::from(starts) / frequency;
    let is_steep = climb.abs() > MAX_RISE * TAU * radii[1];
    let is_helix =
        k > 0 && found >= MIN_CORRELATION && found >= MIN_ADVANTAGE * others && !is_steep;
    is_helix.then_some(climb)
}

/// Returns the waves with at least [`MIN_AMPLITUDE`] of the median amplitude, and zero in other rows.
fn full_crest_waves(waves: &[DVec2]) -> Vec<DVec2> {
    let mut amplitudes: Vec<f64> =
        waves.iter().map(|wave| wave.length()).filter(|h| *h > 0.0).collect();
    amplitudes.sort_by(f64::total_cmp);
    let least = MIN_AMPLITUDE * amplitudes.get(amplitudes.len() / 2).copied().unwrap_or(0.0);
    waves.iter().map(|wave| if wave.length() >= least { *wave } else { DVec2::ZERO }).collect()
}

/// Returns a refined axis of a screw with this pitch, as a point and a unit direction. The axis passes
/// through the centres of the first and of the last turns of the range. The result is not better if the
/// thread ends within these turns; the caller compares the widths of the crests.
pub(super) fn refined_axis(screw: &Solid, about: &AxisFrame, pitch: f64, crest: f64) -> [DVec3; 2] {
    let mut about = *about;
    let turn = pitch.abs();
    for _ in 0..2 {
        let [low, high] = about.range;
        let turns = ((high - low) / (2.0 * turn)).floor().max(1.0) * turn;
        let apart = high - low - turns;
        if apart < MIN_CENTER_DISTANCE * turn {
            break;
        }
        let center = |range| AxisFrame { range, ..about }.fitted_center(screw, crest, f64::max);
        let [first, last] = [[low, low + turns], [high - turns, high]].map(center);
        let point =
            about.axis * low.midpoint(high) + lateral_vector(about.axis, (first + last) * 0.5);
        let axis = (about.axis + lateral_vector(about.axis, last - first) / apart).normalize();
        let half = (high - low) / 2.0;
        let z = point.dot(axis);
        about =
            AxisFrame { axis, middle: axial_projection(axis)(point), range: [z - half, z + half] };
    }
    let middle = about.whole_turns(pitch).fitted_center(screw, crest, f64::max);
    [about.axis * about.range[0] + lateral_vector(about.axis, middle), about.axis]
}

/// Returns a local maximum of `strength` near a frequency, by steps that are halved.
fn maximum_near(mut at: f64, mut by: f64, strength: impl Fn(f64) -> f64) -> f64 {
    for _ in 0..48 {
        let [left, middle, right] = [at - by, at, at + by].map(&strength);
        if left > middle && left >= right {
            at -= by;
        } else if right > middle {
            at += by;
        } else {
            by *= 0.5;
        }
    }
    at
}
