//! The helix of a thread: how far its crest climbs in a turn, found from the outermost points of the screw.
//!
//! On a thread of `n` starts whose crests are `p` apart, the radius is a function of `z / p - n a / (2 pi)`, with the
//! place `z` along the axis and the angle `a` about it. So it is correlated with the wave of that phase, as with that of
//! no other `p` and `n`: rings do not depend on the angle, and splines not on the place. `n` is negative of a
//! left-handed thread; the pitch, or lead, is `n p`.

use std::f64::consts::TAU;

use colltrans::Solid;
use glam::{DVec2, DVec3};

use super::surface::{AROUND, About, around};
use super::{flattened, inverse};

/// Starts that are tried, of either hand.
const STARTS: i32 = 4;
/// So strong a correlation is a helix (of a triangle 0.8, of narrow ridges 0.55), ...
const LEAST: f64 = 0.35;
/// ... and so many times as strong as that with rings and splines.
const BEYOND: f64 = 1.5;
/// In a turn a crest climbs by no more than this share of its way around: what is steeper is a spline rather than a thread.
const STEEPEST: f64 = 1.0;
/// A thread's crests are no nearer than this many depths of it; of usual ones 1.6.
const NEAREST: f64 = 0.8;
/// Frequencies are tried so close: shares of the inverse length.
const STEPS: f64 = 8.0;
/// Waves of rows that are this share as high as the median are those of whole crests.
const STRONG: f64 = 0.9;
/// Middles are compared that are so many turns apart at least.
const APART: f64 = 0.5;
/// Rows along the axis: so many in a depth, but not more than these.
const ALONG: f64 = 5.0;
const MOST_ALONG: usize = 512;

/// How far the crest climbs in a turn; `None` if there is no helix. `radii` are those of the hole and the crest.
pub(super) fn pitch(screw: &Solid, about: &About, radii: [f64; 2]) -> Option<f64> {
    let [low, high] = about.range;
    let (length, depth) = (high - low, radii[1] - radii[0]);
    if !(length > 0.0 && depth > 0.0) {
        return None;
    }
    let rows = ((ALONG * length / depth).ceil() as usize).clamp(8, MOST_ALONG);
    let outermost = about.envelope(screw, radii[1], rows, f64::max);
    let known = || outermost.iter().flatten().flatten();
    let mean = known().sum::<f64>() / known().count().max(1) as f64;
    let whole: f64 = known().map(|r| (r - mean).abs()).sum();
    if whole == 0.0 {
        return None;
    }
    // By number of starts, the waves around of each row.
    let waves = |starts: i32| -> Vec<DVec2> {
        let turn = |column| around(column).to_angle();
        let wave_of = |row: &[Option<f64>; AROUND]| {
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
        sum.length() / whole
    };
    let step = 1.0 / (STEPS * length);
    // A crest goes half around at least, and has four rows.
    let last = (length / (NEAREST * depth)).min(rows as f64 / 4.0) * STEPS;
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
    // Where a thread ends, a part of a crest is seen, whose middle is not on the helix.
    let whole_crests = strong(&own);
    let frequency = peak(f64::from(k) * step, step, |f| strength(&whole_crests, f));
    let found = strength(&own, frequency);
    let others = strength(&waves(0), frequency).max(strength(&own, 0.0));
    let climb = f64::from(starts) / frequency;
    let steep = climb.abs() > STEEPEST * TAU * radii[1];
    let sound = k > 0 && found >= LEAST && found >= BEYOND * others && !steep;
    sound.then_some(climb)
}

/// The waves that are nearly as high as most, and nothing elsewhere.
fn strong(waves: &[DVec2]) -> Vec<DVec2> {
    let mut heights: Vec<f64> =
        waves.iter().map(|wave| wave.length()).filter(|h| *h > 0.0).collect();
    heights.sort_by(f64::total_cmp);
    let least = STRONG * heights.get(heights.len() / 2).copied().unwrap_or(0.0);
    waves.iter().map(|wave| if wave.length() >= least { *wave } else { DVec2::ZERO }).collect()
}

/// The axis of a screw of that pitch, through a point, more closely than it is known: through its middles in the first turns
/// and in the last ones. Where a thread ends within these that is no better: see how wide its crest is then.
pub(super) fn straightened(screw: &Solid, about: &About, pitch: f64, crest: f64) -> [DVec3; 2] {
    let mut about = *about;
    let turn = pitch.abs();
    for _ in 0..2 {
        let [low, high] = about.range;
        let turns = ((high - low) / (2.0 * turn)).floor().max(1.0) * turn;
        let apart = high - low - turns;
        if apart < APART * turn {
            break;
        }
        let center = |range| About { range, ..about }.centered(screw, crest, f64::max);
        let [first, last] = [[low, low + turns], [high - turns, high]].map(center);
        let point = about.axis * low.midpoint(high) + inverse(about.axis, (first + last) * 0.5);
        let axis = (about.axis + inverse(about.axis, last - first) / apart).normalize();
        let half = (high - low) / 2.0;
        let z = point.dot(axis);
        about = About { axis, middle: flattened(axis)(point), range: [z - half, z + half] };
    }
    let middle = about.whole(pitch).centered(screw, crest, f64::max);
    [about.axis * about.range[0] + inverse(about.axis, middle), about.axis]
}

/// The peak near a place, by halving.
fn peak(mut at: f64, mut by: f64, strength: impl Fn(f64) -> f64) -> f64 {
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
