//! Where a screw sits best in its hole: on the hole's own axis, and turned so that the threads overlap least.
//!
//! Notation: the *phase* of a point is `z / P - a / (2 pi)`, modulo 1, with the pitch `P`, its place `z` along the axis
//! and its angle `a` about it: along the helix it stays as it is. The *profile* is, by phase, how far the screw reaches
//! from its axis, and how near the hole comes to its own one: of all turns the median, so that run-outs do not decide.
//! To turn the screw by `t` turns moves its profile by `-t`.

use std::f64::consts::TAU;

use colltrans::Solid;
use glam::{DVec2, DVec3};

use super::surface::About;
use super::{OVER, Thread, WIDEST, common, flattened, inverse};
use crate::boxes::span;

/// Places of a profile.
const PLACES: usize = 128;
/// Overlaps and places that differ by less than this share of the thread's depth are equal.
const EQUAL: f64 = 0.02;
/// A hole whose profile is flatter than this share of the thread's depth has none.
const PLAIN: f64 = 0.25;

/// Where a screw sits best in its hole, as the meshes have them.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Seat {
    /// By how much the screw is put aside for it, across the axis.
    pub aside: DVec3,
    /// By how many turns it is turned for it, about the axis; from -0.5 to 0.5, and 0 if that is as good.
    pub phase: f64,
    /// By how much the threads overlap there, across the axis, in their profiles; negative if there is play.
    pub overlap: f64,
    /// Whether the hole has a thread, too.
    pub threaded: bool,
    /// How far the screw has to go along the axis, and against it, until its thread is out of the hole.
    pub ways: [f64; 2],
}

impl Thread {
    /// Where the screw sits best; `None` if there is no helix.
    pub fn seat(&self, parts: [&Solid; 2]) -> Option<Seat> {
        let pitch = self.pitch?;
        let [point, axis] = self.axis;
        let [hole, crest] = self.radii;
        let depth = crest - hole;
        let (own, other) = (parts[self.screw], parts[1 - self.screw]);
        let range = common(own, other, axis)?;
        let flat = flattened(axis);
        let middle = flat(point);
        let about = |middle: DVec2| About { axis, middle, range };
        let center = about(middle).whole(pitch).centered(other, WIDEST * crest, f64::min);
        let off = inverse(axis, center - middle);
        let aside = if off.length() < EQUAL * depth { DVec3::ZERO } else { off };
        let outer = crest * (1.0 + OVER);
        let screw = profile(own, &about(middle), pitch, outer, f64::max)?;
        let wall = profile(other, &about(center), pitch, 2.0 * crest, f64::min)?;
        let [least, most] = span(wall.iter().copied());
        let (phase, overlap) = best(&screw, &wall, EQUAL * depth);
        let [low, high] = ends(other, axis, center, crest);
        let threaded = own.vertices().iter().filter(|p| {
            let r = flat(**p).distance(middle);
            r > hole && r <= outer
        });
        let [bottom, top] = span(threaded.map(|p| p.dot(axis)));
        Some(Seat {
            aside,
            phase,
            overlap,
            threaded: most - least >= PLAIN * depth,
            ways: [high - bottom, top - low].map(|way| way.max(0.0)),
        })
    }
}

/// By place, of the facets within a distance, the median over the turns of what is `outermost` there.
fn profile(
    solid: &Solid,
    about: &About,
    pitch: f64,
    within: f64,
    outermost: impl Fn(f64, f64) -> f64,
) -> Option<Vec<f64>> {
    let [low, high] = about.range;
    let turns = ((high - low) / pitch.abs()).ceil().max(1.0) as usize;
    let mut all: Vec<Option<f64>> = vec![None; turns * PLACES];
    about.look(solid, within, pitch.abs() / PLACES as f64, |seen| {
        let phase = (seen.z / pitch - seen.angle / TAU).rem_euclid(1.0);
        let turn = ((seen.z - low) / pitch.abs()) as usize;
        let place = ((phase * PLACES as f64) as usize).min(PLACES - 1);
        let cell = &mut all[turn.min(turns - 1) * PLACES + place];
        *cell = Some(cell.map_or(seen.radius, |known| outermost(known, seen.radius)));
    });
    let median = |place: usize| {
        let own = (0..turns).filter_map(|turn| all[turn * PLACES + place]);
        let mut own: Vec<f64> = own.collect();
        own.sort_by(f64::total_cmp);
        own.get(own.len() / 2).copied()
    };
    let found: Vec<Option<f64>> = (0..PLACES).map(median).collect();
    let known = |place: usize| (0..PLACES).find_map(|k| found[(place + k) % PLACES]);
    (0..PLACES).map(known).collect()
}

/// From where to where along an axis a hole is, within a radius: its vertices there, and its end faces.
fn ends(solid: &Solid, axis: DVec3, middle: DVec2, radius: f64) -> [f64; 2] {
    let flat = flattened(axis);
    let mut all = [f64::INFINITY, f64::NEG_INFINITY];
    for t in solid.triangles() {
        let corners = t.map(|v| solid.vertices()[v as usize]);
        if super::distance(middle, corners.map(flat)) > radius {
            continue;
        }
        let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        let is_end = normal.dot(axis).abs() > 0.9 * normal.length();
        for p in corners {
            if is_end || flat(p).distance(middle) <= WIDEST * radius {
                all = [all[0].min(p.dot(axis)), all[1].max(p.dot(axis))];
            }
        }
    }
    all
}

/// By how many turns the screw is turned for the least overlap, and how much that is: in the middle of the longest run of
/// equals, but not at all if that is one of them.
fn best(screw: &[f64], hole: &[f64], equal: f64) -> (f64, f64) {
    let overlap = |by: usize| {
        let over = (0..PLACES).map(|k| screw[(k + by) % PLACES] - hole[k]);
        over.fold(f64::NEG_INFINITY, f64::max)
    };
    let all: Vec<f64> = (0..PLACES).map(overlap).collect();
    let least = all.iter().copied().fold(f64::INFINITY, f64::min);
    let is_best = |k: usize| all[k % PLACES] <= least + equal;
    if is_best(0) {
        return (0.0, all[0]);
    }
    let mut longest = (0, 0);
    for first in (0..PLACES).filter(|&k| !is_best(k + PLACES - 1)) {
        let length = (0..PLACES).take_while(|k| is_best(first + k)).count();
        if length > longest.1 {
            longest = (first, length);
        }
    }
    let middle = (longest.0 + longest.1 / 2) % PLACES;
    let turns = middle as f64 / PLACES as f64;
    (if turns > 0.5 { turns - 1.0 } else { turns }, all[middle])
}
