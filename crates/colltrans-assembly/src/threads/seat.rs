//! Finds the best position of a screw in its hole: on the axis of the hole, turned so that the threads
//! overlap least.
//!
//! - *Phase* of a point: `z / P - a / (2 pi)`, modulo 1, with the pitch `P`, the coordinate `z` along the
//!   axis and the angle `a` about it. It is constant along the helix.
//! - *Profile*: for each phase, the outer radius of the screw, or the inner radius of the hole about the axis
//!   of the hole. It is the median over all turns, so that run-outs have no effect.
//! - Turning the screw by `t` turns shifts its profile by `-t`.

use std::f64::consts::TAU;

use colltrans::Solid;
use glam::{DVec2, DVec3};

use super::surface::AxisFrame;
use super::{
    CREST_MARGIN, MAX_CREST_RATIO, Thread, axial_projection, common_range, lateral_vector,
};
use crate::boxes::value_range;

/// Number of cells of a profile.
const CELLS: usize = 128;
/// Maximum difference of equal overlaps and positions, as a share of the thread's depth.
const EQUAL: f64 = 0.02;
/// Maximum height of the profile of a hole without a thread, as a share of the thread's depth.
const MAX_PLAIN_HEIGHT: f64 = 0.25;

/// Best position of a screw in its hole, relative to its position in the files.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Seat {
    /// Displacement of the screw, perpendicular to the axis.
    pub lateral_offset: DVec3,
    /// Rotation of the screw about the axis in turns, from -0.5 to 0.5. It is 0 if no rotation is better.
    pub phase: f64,
    /// Radial overlap of the profiles in this position; negative for a clearance.
    pub overlap: f64,
    /// Whether the hole has a thread.
    pub threaded: bool,
    /// Travels of the screw along the axis and against it until its thread is out of the hole.
    pub exit_travels: [f64; 2],
}

impl Thread {
    /// Returns the best position of the screw; `None` without a helix, or if a profile has no samples.
    pub fn seat(&self, parts: [&Solid; 2]) -> Option<Seat> {
        let pitch = self.pitch?;
        let [point, axis] = self.axis;
        let [hole, crest] = self.radii;
        let depth = crest - hole;
        let (own, other) = (parts[self.screw], parts[1 - self.screw]);
        let range = common_range(own, other, axis)?;
        let flat = axial_projection(axis);
        let middle = flat(point);
        let about = |middle: DVec2| AxisFrame { axis, middle, range };
        let center = about(middle).whole_turns(pitch).fitted_center(
            other,
            MAX_CREST_RATIO * crest,
            f64::min,
        );
        let off = lateral_vector(axis, center - middle);
        let aside = if off.length() < EQUAL * depth { DVec3::ZERO } else { off };
        let outer = crest * (1.0 + CREST_MARGIN);
        let screw = median_profile(own, &about(middle), pitch, outer, f64::max)?;
        let wall = median_profile(other, &about(center), pitch, 2.0 * crest, f64::min)?;
        let [least, most] = value_range(wall.iter().copied());
        let (phase, overlap) = best_phase(&screw, &wall, EQUAL * depth);
        let [low, high] = hole_ends(other, axis, center, crest);
        let threaded = own.vertices().iter().filter(|p| {
            let r = flat(**p).distance(middle);
            r > hole && r <= outer
        });
        let [bottom, top] = value_range(threaded.map(|p| p.dot(axis)));
        Some(Seat {
            lateral_offset: aside,
            phase,
            overlap,
            threaded: most - least >= MAX_PLAIN_HEIGHT * depth,
            exit_travels: [high - bottom, top - low].map(|travel| travel.max(0.0)),
        })
    }
}

/// Returns for each phase the median over the turns of the radius that `outermost` selects among samples
/// within a distance. Empty cells take the value of the next filled one. Returns `None` without samples.
fn median_profile(
    solid: &Solid,
    about: &AxisFrame,
    pitch: f64,
    within: f64,
    outermost: impl Fn(f64, f64) -> f64,
) -> Option<Vec<f64>> {
    let [low, high] = about.range;
    let turns = ((high - low) / pitch.abs()).ceil().max(1.0) as usize;
    let mut all: Vec<Option<f64>> = vec![None; turns * CELLS];
    about.visit_samples(solid, within, pitch.abs() / CELLS as f64, |sample| {
        let phase = (sample.z / pitch - sample.angle / TAU).rem_euclid(1.0);
        let turn = ((sample.z - low) / pitch.abs()) as usize;
        let place = ((phase * CELLS as f64) as usize).min(CELLS - 1);
        let cell = &mut all[turn.min(turns - 1) * CELLS + place];
        *cell = Some(cell.map_or(sample.radius, |known| outermost(known, sample.radius)));
    });
    let median = |place: usize| {
        let own = (0..turns).filter_map(|turn| all[turn * CELLS + place]);
        let mut own: Vec<f64> = own.collect();
        own.sort_by(f64::total_cmp);
        own.get(own.len() / 2).copied()
    };
    let found: Vec<Option<f64>> = (0..CELLS).map(median).collect();
    let known = |place: usize| (0..CELLS).find_map(|k| found[(place + k) % CELLS]);
    (0..CELLS).map(known).collect()
}

/// Returns the range along an axis that a hole extends over within a radius: that of its vertices there and
/// of its end faces.
fn hole_ends(solid: &Solid, axis: DVec3, middle: DVec2, radius: f64) -> [f64; 2] {
    let flat = axial_projection(axis);
    let mut all = [f64::INFINITY, f64::NEG_INFINITY];
    for t in solid.triangles() {
        let corners = t.map(|v| solid.vertices()[v as usize]);
        if super::triangle_distance(middle, corners.map(flat)) > radius {
            continue;
        }
        let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        let is_end = normal.dot(axis).abs() > 0.9 * normal.length();
        for p in corners {
            if is_end || flat(p).distance(middle) <= MAX_CREST_RATIO * radius {
                all = [all[0].min(p.dot(axis)), all[1].max(p.dot(axis))];
            }
        }
    }
    all
}

/// Returns the rotation of the screw in turns with the least overlap, and that overlap. Among equal rotations
/// returns 0 if possible, otherwise the middle of their longest run.
fn best_phase(screw: &[f64], hole: &[f64], equal: f64) -> (f64, f64) {
    let overlap = |by: usize| {
        let over = (0..CELLS).map(|k| screw[(k + by) % CELLS] - hole[k]);
        over.fold(f64::NEG_INFINITY, f64::max)
    };
    let all: Vec<f64> = (0..CELLS).map(overlap).collect();
    let least = all.iter().copied().fold(f64::INFINITY, f64::min);
    let is_best = |k: usize| all[k % CELLS] <= least + equal;
    if is_best(0) {
        return (0.0, all[0]);
    }
    let mut longest = (0, 0);
    for first in (0..CELLS).filter(|&k| !is_best(k + CELLS - 1)) {
        let length = (0..CELLS).take_while(|k| is_best(first + k)).count();
        if length > longest.1 {
            longest = (first, length);
        }
    }
    let middle = (longest.0 + longest.1 / 2) % CELLS;
    let turns = middle as f64 / CELLS as f64;
    (if turns > 0.5 { turns - 1.0 } else { turns }, all[middle])
}
